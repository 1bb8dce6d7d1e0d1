# SPDX-License-Identifier: Apache-2.0
"""Steps of worlds in which contact holds."""

from __future__ import annotations

from collections.abc import Iterator

import iota


def solved_steps(world: iota.World, seconds: float, gap: float = 1e-6) -> Iterator[iota.types.StepReport]:
    """The reports of steps that are all solved, with gaps below `gap`, m."""
    for _ in range(round(seconds / world.dt)):
        report = world.step()
        assert report is not None and report.unconverged == 0 and report.worst_gap < gap
        yield report


def run_solved(world: iota.World, seconds: float, gap: float = 1e-6) -> None:
    for _ in solved_steps(world, seconds, gap):
        pass
