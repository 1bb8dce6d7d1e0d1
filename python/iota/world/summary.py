# SPDX-License-Identifier: Apache-2.0
"""Statistics of a run."""

from __future__ import annotations

import time
from dataclasses import asdict, dataclass

from iota._core import StepReport, System


@dataclass
class RunSummary:
    """Result of a run. dt_s: length of the last step. iterations_mean: per articulate and step; worst_gap_m: largest
    hinge separation or rigidity error."""

    steps: int
    dt_s: float
    simulated_s: float
    cpu_s: float
    worst_gap_m: float
    energy_start_j: float
    energy_end_j: float
    energy_max_j: float
    iterations_mean: float
    iterations_max: int
    fallbacks: int
    articulates: int
    structure_version: int

    def as_dict(self) -> dict[str, float]:
        return asdict(self)


class Tally:
    """Sums up step reports."""

    def __init__(self, system: System) -> None:
        self._system = system
        self._dt = self._simulated = 0.0
        energy = system.energy.total
        self._start = self._end = self._max = energy
        self._steps = self._fallbacks = self._iterations_max = 0
        self._iterations = self._gap = 0.0
        self._cpu = time.process_time()

    def add(self, report: StepReport, dt: float) -> None:
        self._steps += 1
        self._dt = dt
        self._simulated += dt
        self._end = report.energy.total
        self._max = max(self._max, self._end)
        self._gap = max(self._gap, report.worst_gap)
        self._iterations += report.iterations_mean
        self._iterations_max = max(self._iterations_max, report.iterations_max)
        self._fallbacks += report.fallbacks

    def summary(self) -> RunSummary:
        return RunSummary(
            steps=self._steps,
            dt_s=self._dt,
            simulated_s=self._simulated,
            cpu_s=time.process_time() - self._cpu,
            worst_gap_m=self._gap,
            energy_start_j=self._start,
            energy_end_j=self._end,
            energy_max_j=self._max,
            iterations_mean=self._iterations / max(self._steps, 1),
            iterations_max=self._iterations_max,
            fallbacks=self._fallbacks,
            articulates=self._system.articulate_count,
            structure_version=self._system.structure_version,
        )
