# SPDX-License-Identifier: Apache-2.0
"""The costs of the parts of a step, for pages that show them."""

from __future__ import annotations

from iota._core import StepTimes
from iota.world.costs import Costs

EVERY = 16  # steps: of these one is timed
PARTS = ("forces", "analyze", "factor", "solve", "integrate")  # of the simulator
SHARE = 0.3  # of the newest values in the smoothed ones


def parts_of(times: StepTimes) -> dict[str, float]:
    """Seconds of each part of a timed step."""
    return {part: getattr(times, part) for part in PARTS}


class StepCosts:
    """Smoothed costs of a step, in ms by part: of the simulator from one timed step of 16, else means over these."""

    def __init__(self, costs: Costs) -> None:
        self.ms: dict[str, float] = {}
        self._costs = costs
        self._before: dict[str, float] | None = None

    def clear(self) -> None:
        self.ms.clear()
        self._before = None

    def take(self, times: StepTimes) -> None:
        """After a timed step."""
        now = {part: 1e3 * s for part, s in parts_of(times).items()}
        others = self._sum_others()
        if self._before is not None:
            now |= {part: 1e3 * (s - self._before.get(part, 0.0)) / EVERY for part, s in others.items()}
        self._before = others
        for part, ms in now.items():
            self.ms[part] = ms if part not in self.ms else self.ms[part] + SHARE * (ms - self.ms[part])

    def _sum_others(self) -> dict[str, float]:
        """Seconds so far of all but the simulator."""
        sums: dict[str, float] = {}
        for name, s in self._costs.seconds.items():
            part = name.partition(":")[0]
            if part != "simulator":
                sums[part] = sums.get(part, 0.0) + s
        return sums
