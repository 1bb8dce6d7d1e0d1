# SPDX-License-Identifier: Apache-2.0
"""The processor time that steps take, and may take."""

from __future__ import annotations

from collections import deque

import numpy as np

FULL = 0.75  # of the budget: begin to reduce, at first
LEARNT, RARE, LEARN_EVERY = 2000, 0.998, 64  # steps; their quantile that the budget has to hold; steps
SPREADS = (1.15, 1.9)  # of a rare step, in usual ones: less is luck, more comes from other programs
SMOOTH, SLOW = 0.15, 0.03  # of the newest step in the smoothed time, and in that of a unit of work


class StepTime:
    """ms: the processor time of a step, smoothed; ms_of_work: that of a unit of work; full: the share of the budget that a usual step may take."""

    def __init__(self) -> None:
        self.ms = self.ms_of_work = 0.0
        self.full = FULL
        self._latest_ms: tuple[float, ...] = ()
        self._ratios: deque[float] = deque(maxlen=LEARNT)  # of steps to the smoothed one

    def take(self, ms: float, work: float, step: int) -> None:
        """After each step; work: of all things in it. The median of three counts: a single step that another process has held up is no load."""
        self._learn(ms, step)
        self._latest_ms = (*self._latest_ms[-2:], ms)
        ms = sorted(self._latest_ms)[len(self._latest_ms) // 2]
        self.ms = ms if self.ms == 0 else self.ms + SMOOTH * (ms - self.ms)
        if work > 0:
            now = ms / work
            self.ms_of_work = now if self.ms_of_work == 0 else self.ms_of_work + SLOW * (now - self.ms_of_work)

    def _learn(self, ms: float, step: int) -> None:
        """Rare steps are to be within the budget, too: the more steps differ, the lower is what a usual one may take."""
        if self.ms <= 0:
            return
        self._ratios.append(ms / self.ms)
        count = len(self._ratios)
        if step % LEARN_EVERY == 0 and 4 * count >= LEARNT:
            rare = float(np.partition(np.array(self._ratios), int(RARE * count))[int(RARE * count)])
            self.full = 1 / min(max(rare, SPREADS[0]), SPREADS[1])
