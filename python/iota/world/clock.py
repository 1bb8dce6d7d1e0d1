# SPDX-License-Identifier: Apache-2.0
"""The time of a world: the length of its steps, its speed, its timed events."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, TypeVar

from iota._core import System
from iota.world.callbacks import Hook, is_decorator
from iota.world.costs import Costs
from iota.world.parts import Part
from iota.world.schedule import Schedule

Callback = TypeVar("Callback", bound=Callable[..., Any])
MAX_SPEED = 10.0


class Clock(Part):
    """Time: the length of a step, pauses, the speed, timed events.

    world.clock.speed = 0.5

    @world.clock.every(1.0)
    def tick(): print(world.system.time)
    """

    def __init__(self, dt: float, system: System, schedule: Schedule, costs: Costs) -> None:
        self._system, self._schedule, self._costs = system, schedule, costs
        self.dt, self.speed = dt, 1.0
        self._paused = False
        self._reached = 1.0

    @property
    def dt(self) -> float:
        """Length of a step, s; above 0, at most 1. A new value is used from the next step on."""
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

    @property
    def paused(self) -> bool:
        """While True, no steps are made; users' hands and edits of the script still act."""
        return self._paused

    @paused.setter
    def paused(self, value: bool) -> None:
        self._paused = value

    @property
    def reached_speed(self) -> float:
        """Achieved share of that speed, smoothed; below 1 the world runs in slow motion."""
        return self._reached

    @property
    def costs(self) -> dict[str, float]:
        """Seconds that each part of the world has taken since it was made: "simulator", "pages", "script: ..." for each
        of the script's functions. `iota profile` prints them as a table, with the parts of the simulator."""
        return dict(self._costs.seconds)

    def at(self, time: float) -> Callable[[Callback], Callback]:
        """Decorator: calls a function once at a simulated time (s). If registered before `run`, it is restored by a
        reset."""
        return self._timer(time, None)

    def after(self, delay: float) -> Callable[[Callback], Callback]:
        """Decorator: calls a function once, `delay` simulated seconds from now."""
        return self._timer(self._system.time + delay, None)

    def every(self, period: float, start: float | None = None) -> Callable[[Callback], Callback]:
        """Decorator: calls a function every `period` simulated seconds, first at `start` (default: one period from now)."""
        is_decorator(f"world.every({period:g})", start)
        return self._timer(self._system.time + period if start is None else start, period)

    def _timer(self, time: float, period: float | None) -> Callable[[Callback], Callback]:
        def register(function: Callback) -> Callback:
            self._schedule.add(time, Hook.of(function), period)
            return function

        return register

    def _take_pace(self, share: float) -> None:
        """share: of the due steps, those that were taken."""
        self._reached += 0.02 * (share - self._reached)
