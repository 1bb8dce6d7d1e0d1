# SPDX-License-Identifier: Apache-2.0
"""Fixed steps against the wall clock. The engine itself reads no clock."""

from __future__ import annotations

import time

MAX_CATCH_UP = 4  # steps


class Pacer:
    """How many steps are due now, and how long to sleep. Time that cannot be caught up is let go: slow motion, no spiral.

    behind: share of real time that is reached, smoothed; 1 when all is well.
    """

    def __init__(self, dt: float, frame: float = 1 / 60) -> None:
        self.dt, self.frame = dt, frame
        self.speed = 1.0
        self.reached = 1.0
        self.restart()

    def restart(self) -> None:
        self._last = self._next_frame = time.perf_counter()
        self._owed = 0.0

    def due(self, paused: bool) -> int:
        """Steps to take now."""
        now = time.perf_counter()
        passed, self._last = now - self._last, now
        if paused or self.speed <= 0:
            self._owed = 0.0
            return 0
        self._owed += passed * self.speed / self.dt
        steps = int(self._owed)
        self._owed -= steps
        taken = min(steps, MAX_CATCH_UP)
        if steps:
            self.reached += 0.02 * (taken / steps - self.reached)
        return taken

    def frame_due(self) -> bool:
        """True once a frame."""
        now = time.perf_counter()
        if now < self._next_frame:
            return False
        self._next_frame = max(self._next_frame + self.frame, now)
        return True

    def sleep(self, paused: bool) -> None:
        """Until the next step or frame is due."""
        now = time.perf_counter()
        until = self._next_frame
        if not paused and self.speed > 0:
            until = min(until, self._last + (1 - self._owed) * self.dt / self.speed)
        if until > now:
            time.sleep(until - now)
