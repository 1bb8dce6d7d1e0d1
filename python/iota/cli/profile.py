# SPDX-License-Identifier: Apache-2.0
"""`iota profile`: the time that each part of a world takes."""

from __future__ import annotations

import argparse
import json
import time
from pathlib import Path
from typing import Any

from iota._core import System
from iota.cli import run
from iota.cli.failure import Failure
from iota.cli.plot import COLORS, check, save
from iota.world import World
from iota.world.options import RunOptions, use

FRAMES = 60  # for pages, per simulated second


def profile(arguments: argparse.Namespace) -> None:
    """Runs a study or a script as fast as possible, with frames for pages, and prints the time of each part."""
    rows: list[dict[str, Any]] = []
    forces: list[str] = []
    if arguments.plot is not None:
        check(arguments.plot)

    def drive(world: World) -> None:
        world.serve()
        world._state.costs.is_detailed = True
        begun = time.perf_counter()
        steps = max(1, round(1 / FRAMES / world.dt))
        first = world.system.step_count
        while world.system.step_count - first < arguments.seconds / world.dt:
            world.advance(steps)
        wall = time.perf_counter() - begun
        rows.extend(rows_of(world.clock.costs, wall, world.system.step_count - first))
        if world.levels.budget_ms is not None:
            forces.append(str(world.levels))
        if isinstance(world.system, System) and len(costs := world.system.profile()):
            forces.append(str(costs))

    options = RunOptions(port=0, open=False, drive=drive)
    with use(options), run.plain_failures(0):
        run.find(arguments.what)(None)
    if not rows:
        raise Failure(f"{arguments.what} made no World run: call world.run(), or define build() that returns a World")
    if arguments.json:
        print(json.dumps(rows))
    else:
        print(f"{'part':44} {'ms a step':>10} {'share':>7}")
        for row in rows:
            print(f"{row['part'][:44]:44} {row['ms']:10.4f} {100 * row['share']:6.1f} %")
        print(f"{'all of a step':44} {sum(row['ms'] for row in rows):10.4f}", *forces, sep="\n\n")
    if arguments.plot is not None:
        plot(rows, arguments.what, arguments.plot)


def rows_of(costs: dict[str, float], wall: float, steps: int) -> list[dict[str, Any]]:
    """The most expensive part first, and the remainder. ms: for each step."""
    rest = max(0.0, wall - sum(costs.values()))
    parts = [*sorted(costs.items(), key=lambda part: -part[1]), ("the rest", rest)]
    return [{"part": part, "ms": 1e3 * s / steps, "share": s / wall} for part, s in parts]


def plot(rows: list[dict[str, Any]], title: str, file: Path) -> None:
    """A pie chart, as in the thesis."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(6, 4), layout="constrained")
    axes = figure.subplots()
    shown = [row for row in rows if row["share"] > 0.005]
    labels = [f"{row['part']} ({100 * row['share']:.0f} %)" for row in shown]
    axes.pie(
        [row["share"] for row in shown], colors=[COLORS[i % len(COLORS)] for i in range(len(shown))], startangle=90
    )
    axes.legend(labels, loc="center left", bbox_to_anchor=(1, 0.5), frameon=False)
    axes.set_title(f"{title}: {sum(row['ms'] for row in rows):.2f} ms a step")
    save(figure, file)
