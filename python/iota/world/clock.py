# SPDX-License-Identifier: Apache-2.0
"""Paces fixed steps to real time. The engine itself reads no clock."""

from __future__ import annotations

import math
import time

MAX_CATCH_UP = 4  # steps
MAX_SPEED = 10.0


class Clock:
    """The number of due steps, and the time to sleep. Time that cannot be caught up is dropped: slow motion.

    paused: no step is due. reached: achieved share of the requested speed, smoothed; 1 if the machine keeps up.
    """

    def __init__(self, dt: float, frame: float = 1 / 60) -> None:
        self.dt, self.speed = dt, 1.0
        self.frame = frame
        self.paused = False
        self.reached = 1.0
        self.restart()

    @property
    def dt(self) -> float:
        """Length of a step, s; above 0, at most 1."""
        return self._dt

    @dt.setter
    def dt(self, value: float) -> None:
        if not (math.isfinite(value) and 0 < value <= 1):
            raise ValueError(f"dt must be above 0 and at most 1 s, not {value}")
        self._dt = float(value)

    @property
    def speed(self) -> float:
        """Simulated seconds per real second, requested by users; 0 to 10."""
        return self._speed

    @speed.setter
    def speed(self, value: float) -> None:
        if not (math.isfinite(value) and 0 <= value <= MAX_SPEED):
            raise ValueError(f"speed must be from 0 to {MAX_SPEED:g} times real time, not {value}")
        self._speed = float(value)

    def restart(self) -> None:
        self._last = self._next_frame = time.perf_counter()
        self._owed = 0.0

    def due(self) -> int:
        """The number of steps to take now."""
        now = time.perf_counter()
        passed, self._last = now - self._last, now
        if not self._runs():
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

    def sleep(self) -> None:
        """Sleeps until the next step or frame is due."""
        now = time.perf_counter()
        until = self._next_frame
        if self._runs():
            until = min(until, self._last + (1 - self._owed) * self.dt / self.speed)
        if until > now:
            time.sleep(until - now)

    def _runs(self) -> bool:
        return not self.paused and self.speed > 0
