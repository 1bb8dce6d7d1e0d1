# SPDX-License-Identifier: Apache-2.0
"""Timed events, in simulated time."""

from __future__ import annotations

import heapq
import math
from collections.abc import Iterator
from dataclasses import dataclass, field

from iota.world.callbacks import Hook


@dataclass(order=True)
class Task:
    """A hook and its due time; tasks due at one time run in the order of registration."""

    time: float
    order: int
    hook: Hook = field(compare=False)
    period: float | None = field(compare=False, default=None)


class Schedule:
    """Tasks by time. `rewind` restores those registered before `begin`; later ones belong to their run only."""

    def __init__(self) -> None:
        self._waiting: list[Task] = []
        self._plan: list[Task] = []
        self._order = 0
        self._begun = False
        self._run = 0

    def add(self, time: float, hook: Hook, period: float | None = None) -> None:
        if not math.isfinite(time):
            raise ValueError(f"the time of an event must be finite, not {time} s")
        if period is not None and not (math.isfinite(period) and period > 0):
            raise ValueError(f"the period of an event must be finite and above 0 s, not {period}")
        self._order += 1
        task = Task(time, self._order, hook, period)
        if not self._begun:
            self._plan.append(task)
        heapq.heappush(self._waiting, task)

    def begin(self) -> None:
        self._begun = True

    def skip(self, time: float) -> None:
        """Goes to a time without the tasks before it."""
        waiting, self._waiting = self._waiting, []
        for task in waiting:
            if task.time <= time and task.period is not None:
                periods = math.floor((time - task.time) / task.period) + 1
                task = Task(task.time + periods * task.period, task.order, task.hook, task.period)
            if task.time > time:
                heapq.heappush(self._waiting, task)

    def rewind(self) -> None:
        """Restores the tasks at `begin`; a call of `due` that is under way ends."""
        self._run += 1
        self._waiting = list(self._plan)
        heapq.heapify(self._waiting)

    def due(self, time: float) -> Iterator[Task]:
        """Removes the due tasks; a periodic task is scheduled again before its call, so that it may raise. After a task
        that has rewound the schedule, `time` is no longer the time of the world."""
        run = self._run
        while run == self._run and self._waiting and self._waiting[0].time <= time:
            task = heapq.heappop(self._waiting)
            if task.period is not None:
                # Relative to the task's own time, so without drift.
                again = Task(task.time + task.period, task.order, task.hook, task.period)
                heapq.heappush(self._waiting, again)
            yield task

    def drop(self, hook: Hook) -> None:
        """Removes a hook until the next rewind."""
        self._waiting = [task for task in self._waiting if task.hook is not hook]
        heapq.heapify(self._waiting)
