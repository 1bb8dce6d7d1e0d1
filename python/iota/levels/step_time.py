# SPDX-License-Identifier: Apache-2.0
"""The processor time that steps take, and may take."""

from __future__ import annotations

from collections import deque

import numpy as np

FULL = 0.75  # of the budget: begin to reduce, at first
LEARNT, RARE, LEARN_EVERY = 2000, 0.998, 64  # steps; their quantile that the budget has to hold; steps
SPREADS = (1.15, 1.9)  # of a rare step, in usual ones: less is luck, more comes from other programs
SMOOTH, SLOW = 0.15, 0.03  # of the newest step in the smoothed time, and in that of a unit of work
DIFFERS = (
    0.3  # of the work of steps: less tells nothing of its price, as busy machines have both longer steps and less work
)
LEAST_PRICE = 0.2  # of the time of a step, divided by its work


class StepTime:
    """ms: the processor time of a step, smoothed; ms_of_work: what a unit of work adds to it; full: the share of the budget that a usual step may take."""

    def __init__(self) -> None:
        self.ms = self.ms_of_work = 0.0
        self.full = FULL
        self._latest_ms: tuple[float, ...] = ()
        self._ratios: deque[float] = deque(maxlen=LEARNT)  # of steps to the smoothed one
        self._simulated = self._work = 0.0  # ms, work: means
        self._together = self._spread = 0.0  # of work: covariance with these ms, variance

    def take(self, ms: float, simulated: float, work: float, step: int) -> None:
        """After each step. simulated: ms of it without management; work: of all things in it. The median of three counts: a single step that
        another process has held up is no load."""
        self._learn(ms, step)
        self._latest_ms = (*self._latest_ms[-2:], ms)
        ms = sorted(self._latest_ms)[len(self._latest_ms) // 2]
        self.ms = ms if self.ms == 0 else self.ms + SMOOTH * (ms - self.ms)
        if work > 0:
            self._price(simulated, work)

    def _price(self, simulated: float, work: float) -> None:
        """The time that a unit of work adds to a step, ms, by how steps of more work are longer. A step divided by its work would count what frozen things
        and management take as a part of each: where most is frozen, three times too much, so that things near the viewer stayed frozen although
        there was room for them."""
        if self._work == 0:
            self._simulated, self._work = simulated, work
            self.ms_of_work = simulated / work
            return
        more, longer = work - self._work, simulated - self._simulated
        self._simulated += SLOW * longer
        self._work += SLOW * more
        self._together += SLOW * ((1 - SLOW) * more * longer - self._together)
        self._spread += SLOW * ((1 - SLOW) * more * more - self._spread)
        most = self._simulated / self._work
        if self._spread > (DIFFERS * self._work) ** 2:
            self.ms_of_work += SLOW * (self._together / self._spread - self.ms_of_work)
        self.ms_of_work = min(max(self.ms_of_work, LEAST_PRICE * most), most)

    def _learn(self, ms: float, step: int) -> None:
        """Rare steps are to be within the budget, too: the more steps differ, the lower is what a usual one may take."""
        if self.ms <= 0:
            return
        self._ratios.append(ms / self.ms)
        count = len(self._ratios)
        if step % LEARN_EVERY == 0 and 4 * count >= LEARNT:
            rare = float(np.partition(np.array(self._ratios), int(RARE * count))[int(RARE * count)])
            self.full = 1 / min(max(rare, SPREADS[0]), SPREADS[1])
