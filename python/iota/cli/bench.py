# SPDX-License-Identifier: Apache-2.0
"""`iota bench chain`: the cost of a step of a chain, through Python.

The chain is straight and level, nailed at one end, and released; links of 0.1 m and 0.1 kg. Time is processor time of
the steps alone, after a warm-up; gap, energy and iterations are those of the timed steps.
"""

from __future__ import annotations

import argparse
import json
import platform
import time
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from typing import Literal

import iota
from iota.builder import chain

LINKS = (8, 64, 512, 4096, 16384)
STEP_RATES = (60, 120)
MODES: tuple[Literal["robust", "energy_keeping"], ...] = ("robust", "energy_keeping")
WARM_UP = 20  # steps
LEAST_STEPS, MOST_SECONDS, CPU_SECONDS = 20, 10.0, 0.4


@dataclass
class Case:
    """One row. energy_change: of the total, over the largest kinetic energy seen."""

    links: int
    kind: str
    mode: str
    dt_s: float
    steps: int
    us_per_link_step: float
    worst_gap_m: float
    energy_change: float
    iterations_mean: float
    fallbacks: int


def run(arguments: argparse.Namespace) -> None:
    cases = []
    if not arguments.json:
        print(
            f"{'links':>6} {'kind':9} {'mode':14} {'1/dt':>5} {'us/link':>8} {'gap m':>9} {'dE/K':>9} {'iter':>5} fallbacks"
        )
    for case in measure_all(arguments.links):
        cases.append(asdict(case))
        if not arguments.json:
            print(
                f"{case.links:6} {case.kind:9} {case.mode:14} {round(1 / case.dt_s):5} {case.us_per_link_step:8.3f} "
                f"{case.worst_gap_m:9.1e} {case.energy_change:9.1e} {case.iterations_mean:5.2f} {case.fallbacks}",
                flush=True,
            )
    if arguments.json:
        print(json.dumps({"iota": iota.__version__, "machine": platform.machine(), "cases": cases}))


def measure_all(links: list[int]) -> Iterator[Case]:
    for count in links:
        for kind in ("two_point", "rod"):
            system = iota.System()
            chain(count, 0.1 * count, 0.005, (0, 0, 0), (1, 0, 0), 0.1 * count, rods=kind == "rod").realize(system)
            start = system.snapshot()
            for mode in MODES:
                for rate in STEP_RATES:
                    system.restore(start)
                    system.mode = mode
                    yield measure(system, count, kind, 1 / rate)


def measure(system: iota.System, links: int, kind: str, dt: float) -> Case:
    """Steps until the processor time, or 10 simulated seconds, have passed."""
    for _ in range(WARM_UP):
        system.step(dt)
    energy, kinetic, gap, iterations, fallbacks, steps = system.energy.total, 0.0, 0.0, 0.0, 0, 0
    spent = 0.0
    while steps < LEAST_STEPS or (spent < CPU_SECONDS and system.time < MOST_SECONDS):
        began = time.thread_time()
        report = system.step(dt)
        spent += time.thread_time() - began
        steps += 1
        kinetic = max(kinetic, report.energy.kinetic)
        gap = max(gap, report.worst_gap)
        iterations += report.iterations_mean
        fallbacks += report.fallbacks
    return Case(
        links=links,
        kind=kind,
        mode=system.mode,
        dt_s=dt,
        steps=steps,
        us_per_link_step=spent / steps / links * 1e6,
        worst_gap_m=gap,
        energy_change=(system.energy.total - energy) / kinetic if kinetic else 0.0,
        iterations_mean=iterations / steps,
        fallbacks=fallbacks,
    )
