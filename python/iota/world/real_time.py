# SPDX-License-Identifier: Apache-2.0
"""Paces fixed steps to real time. The engine itself reads no clock."""

from __future__ import annotations

import time
from collections.abc import Callable

from iota.world.clock import Clock

MAX_CATCH_UP = 4  # steps
QUIET = 0.1  # s, between frames of a world in which nothing happens
MOST_TOGETHER = 2  # steps, so that a late one leaves time to catch up


class RealTime:
    """The number of due steps, and the time to sleep. Time that cannot be caught up is dropped: slow motion."""

    def __init__(self, clock: Clock, frame: float = 1 / 60) -> None:
        self._clock = clock
        self.frame = frame
        self.restart()

    def restart(self) -> None:
        self._last = self._next_frame = self._last_frame = time.perf_counter()
        self._owed = 0.0

    def due(self) -> int:
        """The number of steps to take now."""
        now = time.perf_counter()
        passed, self._last = now - self._last, now
        if not self._runs():
            self._owed = 0.0
            return 0
        self._owed += passed * self._clock.speed / self._clock.dt
        steps = int(self._owed)
        self._owed -= steps
        taken = min(steps, MAX_CATCH_UP)
        if steps:
            self._clock._take_pace(taken / steps)
        return taken

    def frame_due(self, has_news: bool = True) -> bool:
        """True once a frame; without news ten times a second, for who has just come."""
        now = time.perf_counter()
        if now < self._next_frame:
            return False
        self._next_frame = max(self._next_frame + self.frame, now)
        if not has_news and now < self._last_frame + QUIET:
            return False
        self._last_frame = now
        return True

    def sleep(self, wait: Callable[[float], None] | None = None) -> None:
        """Sleeps until the next step is due, or the next frame if steps are rarer. wait: sleeps for so many seconds in which
        nothing happens; with it, frames are rare, see `frame_due`. Of steps that are shorter than a frame a few are
        taken together, since each time the thread wakes up costs more than a step of a small world."""
        now = time.perf_counter()
        until = self._next_frame if wait is None else max(self._next_frame, self._last_frame + QUIET)
        if self._runs():
            interval = self._clock.dt / self._clock.speed
            together = min(MOST_TOGETHER, int(self.frame / interval * (1 + 1e-9)))
            steps = self._last + (max(together, 1) - self._owed) * interval
            until = steps if together else min(until, steps)
        if until > now:
            (wait or time.sleep)(until - now)

    def _runs(self) -> bool:
        return not self._clock.paused and self._clock.speed > 0
