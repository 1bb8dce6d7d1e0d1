# SPDX-License-Identifier: Apache-2.0
"""`iota import`."""

from __future__ import annotations

import argparse
import json
from pathlib import Path

import iota
from iota.cli.failure import Failure
from iota.cli.run import can_show_a_page
from iota.saving import replacing
from iota.world.callbacks import plain


def run(arguments: argparse.Namespace) -> None:
    """Reads a source, prints its content, and saves or shows it if requested."""
    from iota import shapelib

    options = {name: value for name in ("kind", "scale") if (value := getattr(arguments, name)) is not None}
    try:
        found = shapelib.load(arguments.source, **options)
        if wrong := found.problems():
            raise ValueError(f"{arguments.source}: {wrong[0]}")
    except TypeError as error:
        raise Failure(f"{arguments.source}: {error}") from None
    except (ValueError, ImportError) as error:
        raise Failure(str(error)) from None
    except MemoryError:
        raise Failure(f"{arguments.source}: there is not enough memory for it") from None
    if arguments.json:
        print(json.dumps({"title": found.title, "counts": found.counts, "notes": found.notes}))
    else:
        print(plain(found.title))
        for what, count in found.counts.items():
            print(plain(f"  {what}: {f'{count:.6g}' if isinstance(count, float) else count}"))
        for note in found.notes:
            print(plain(f"  note: {note}"))
    if arguments.save:
        save(found, arguments.save)
    if arguments.show:
        show(found, arguments.port)


def save(structure: iota.builder.Structure, path: str) -> None:
    try:
        with replacing(Path(path)) as fresh:
            fresh.write_text(json.dumps(structure.to_json()))
    except OSError as error:
        raise Failure(str(error)) from None


def show(structure: iota.shapelib.Imported, port: int | None) -> None:
    """Without gravity, so that it does not fall; machines, which have joints, have gravity."""
    system = iota.System(gravity=(0, -9.81 if structure.joints else 0, 0), damping=0.3)
    world = iota.World(system, title=structure.title)
    lowest = min(structure.points.position[:, 1], default=0.0)
    (structure + (0, 1 - lowest, 0)).realize(system, world)
    world.run(port=8080 if port is None else port, open=can_show_a_page())
