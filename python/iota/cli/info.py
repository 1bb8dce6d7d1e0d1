# SPDX-License-Identifier: Apache-2.0
"""`iota info`: tells about a journal, without its script."""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import Any

from iota._core import System
from iota.cli.failure import Failure
from iota.journal.folder import Folder
from iota.journal.reader import Found, JournalError, find_all
from iota.world.callbacks import plain


def info(arguments: argparse.Namespace) -> None:
    """Prints a few lines, or one JSON object."""
    told = facts(arguments.directory, read(arguments.directory)[-1])
    if arguments.json:
        print(json.dumps(told))
        return
    print(f"{arguments.directory}: the world {told['title']!r}, kept by iota {told['iota']}, begun {told['written']}")
    for name in ("time", "end", "bodies", "people", "controls", "state", "undo", "files", "damage"):
        if told[name]:
            print(plain(f"  {name + ':':10}{text_of(told[name])}"))


def read(directory: Path) -> list[Found]:
    """The states of a journal, the latest at the end. Raises Failure for a folder without one."""
    try:
        found = find_all(Folder(directory))
    except (JournalError, OSError) as error:
        raise Failure(str(error)) from None
    if not found:
        raise Failure(f"there is no journal in {directory}. iota run --keep {directory} makes one")
    return found


def facts(directory: Path, found: Found) -> dict[str, Any]:
    system = System()
    try:
        system.restore(found.snapshot)
    except ValueError as error:
        raise Failure(f"{directory}: {error}") from None
    header, world = found.header, found.world
    return {
        "title": header.get("title", ""),
        "iota": header.get("iota", ""),
        "written": header.get("written", ""),
        "time": f"{found.end or system.time:.2f} s",
        "end": "orderly" if found.is_orderly else "none: it runs, or was killed",
        "bodies": f"{len(system.bodies)} in the latest snapshot, of t = {system.time:.2f} s",
        "people": [f"{name or 'somebody'} ({role})" for name, role in world.get("people", ())],
        "controls": {name: value for name, value in world.get("controls", {}).items()},
        "state": world.get("state", {}),
        "undo": len(found.undo),
        "files": [f"{file.path.name} ({file.path.stat().st_size / 1000:.0f} kB)" for file in found.files],
        "damage": found.damage,
    }


def text_of(value: Any) -> str:
    if isinstance(value, dict):
        return ", ".join(f"{name} = {each}" for name, each in value.items())
    return ", ".join(map(str, value)) if isinstance(value, list) else str(value)
