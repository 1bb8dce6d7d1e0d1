# SPDX-License-Identifier: Apache-2.0
"""The choice of what is reduced, and of what is restored."""

from __future__ import annotations

import time
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from iota._core import System
from iota.levels.arrays import HOLD, REFUSED, Arrays
from iota.levels.arrivals import CATCH_UP, MISSED, Arrivals
from iota.levels.connections import Connections
from iota.levels.level import frozen_level
from iota.levels.managed import Managed
from iota.levels.step_time import StepTime
from iota.levels.things import Things

HOLD_URGENT = 8  # steps between two changes of a thing; HOLD else
NEVER = 1 << 60  # steps
AIM, LOW = 0.05, 0.15  # of the budget, below what a usual step may take: aimed at; begin to restore
URGENT = 1.5  # times the budget
MOST, MOST_URGENT = 16, 128  # changes in a step
# Changes take at most these parts of the budget, and of a step; the rest waits for the next step.
SPEND, SPEND_URGENT = 0.1, 0.5

Change = Callable[[Managed, int, float, float, str], None]


class Choice:
    """Reduces things until a step takes less than it may, and restores them while there is room. change: sets the level of a thing, for a
    significance, with the ms that it is expected to save and a reason."""

    def __init__(
        self,
        system: System,
        things: Things,
        connections: Connections,
        arrays: Arrays,
        arrivals: Arrivals,
        step_time: StepTime,
        change: Change,
    ) -> None:
        self._system, self._things, self._connections, self._arrays = system, things, connections, arrays
        self._arrivals, self._time, self._change = arrivals, step_time, change
        self._until = 0.0  # s, of processor time

    def is_urgent(self, budget: float) -> bool:
        """Whether steps take much too long."""
        return self._time.ms > URGENT * budget

    def decide(self, budget: float) -> None:
        """Once in a step, or more rarely. budget: ms."""
        arrays, is_urgent = self._arrays, self.is_urgent(budget)
        spend = SPEND_URGENT * self._time.ms if is_urgent else SPEND * budget
        self._until = time.process_time() + 1e-3 * spend
        waited = arrays.now - arrays.changed
        if self._time.ms > self._time.full * budget:
            hold = HOLD_URGENT if is_urgent else HOLD
            free = (waited >= hold) & ~arrays.near & ~arrays.pinned & (arrays.level < arrays.lowest)
            self._reduce(
                np.nonzero(free)[0],
                self._time.ms - (self._time.full - AIM) * budget,
                max(MOST_URGENT if is_urgent else MOST, len(self._things.all) // 40),
            )
        elif self._time.ms < (self._time.full - LOW) * budget:
            free = (waited >= HOLD) & (arrays.level > 0)
            self._restore(np.nonzero(free)[0], (self._time.full - AIM) * budget - self._time.ms)

    def _reduce(self, rows: NDArray[np.intp], need: float, most: int) -> None:
        """The least loss of significance for each saved millisecond first."""
        arrays = self._arrays
        if not len(rows):
            return
        target = arrays.next_level(rows)
        here, there = arrays.share_now(rows), arrays.shares[rows, target]
        saved = self._time.ms_of_work * arrays.full_load[rows] * np.maximum(here - there, 0.0)
        lost = arrays.significance[rows] * (arrays.qualities[rows, arrays.level[rows]] - arrays.qualities[rows, target])
        worth = (target != arrays.level[rows]) & (saved > 1e-6 * need)
        rows, target, saved, lost = rows[worth], target[worth], saved[worth], lost[worth]
        order = np.argsort((lost + 1e-12) / saved, kind="stable")[:most]
        done = 0.0
        looked_at = set[Managed]()  # with others that are to be frozen with them
        for i in order:
            if done >= need or time.process_time() > self._until:
                break
            thing, significance = self._things.all[rows[i]], float(arrays.significance[rows[i]])
            if thing in looked_at:
                continue
            if thing.levels[target[i]].stride == 0:
                done += self._freeze(thing, significance, looked_at)
                continue
            tied = self._connections.tied_to(thing)
            if any(not arrays.is_free(each) for each in tied):
                continue
            self._change(thing, int(target[i]), significance, float(saved[i]), "over budget")
            done += float(saved[i])
            for each in tied:  # of what is solved together the shortest stride counts
                index = next((k for k, level in enumerate(each.levels) if level.is_like(thing.level)), None)
                if index is not None and index > each.index:
                    self._change(each, index, significance, 0.0, "over budget")
        self._time.ms -= done

    def _freeze(self, thing: Managed, significance: float, looked_at: set[Managed]) -> float:
        """Freezes it with all that is solved with it, as one that is not frozen would wake the others; or nothing. Returns the ms that are
        saved."""
        together = self._connections.solved_with(thing)
        looked_at.update(together.things)
        indices = {each: frozen_level(each.levels) for each in together.things}
        is_free = all(index is not None and self._arrays.may_have(each, index) for each, index in indices.items())
        if not (together.is_all and is_free):
            for each in together.things:
                self._arrays.keep_awake(each)
            return 0.0
        for each in together.touching:
            self._arrays.refuse_strides(each, NEVER)
        sum_saved = 0.0
        for each, index in indices.items():
            if index is not None and index > each.index:
                saved = self._time.ms_of_work * self._arrays.saved_at(each, index)
                self._change(each, index, significance, saved, "over budget")
                sum_saved += saved
        return sum_saved

    def _restore(self, rows: NDArray[np.intp], room: float) -> None:
        """The most significance for each millisecond first: many things at strides rather than few in full."""
        arrays = self._arrays
        if not len(rows):
            return
        unit = self._time.ms_of_work * arrays.full_load[rows]
        at, target, gain, cost = arrays.steps_up(rows, unit)
        order = np.argsort(-(gain + 1e-12) / (cost + 1e-9), kind="stable")
        order = order[np.cumsum(cost[order]) <= room]
        best: dict[int, int] = {}  # of rows, in order
        for i in order:
            best[int(at[i])] = int(target[i])
        here = arrays.share_now(rows)
        for i in list(best)[: max(MOST, len(self._things.all) // 60)]:
            row, index = int(rows[i]), best[i]
            if (
                room < CATCH_UP and arrays.missed(row, self._system.time) > MISSED
            ):  # first what it would have done, in pieces
                self._arrivals.wait_for(self._things.all[row])
                continue
            thing = self._things.all[row]
            if thing.index != arrays.level[row]:
                continue  # with another one
            if thing.level.stride == 0 and thing.levels[index].stride != 0:
                room -= self._unfreeze(thing, index, float(arrays.significance[row]), room)
            else:
                ms = float(unit[i] * max(arrays.shares[row, index] - here[i], 0.0))
                room -= ms
                self._change(thing, index, float(arrays.significance[row]), -ms, "time is left")
                self._time.ms += ms
            if time.process_time() > self._until:
                break

    def _unfreeze(self, thing: Managed, index: int, significance: float, room: float) -> float:
        """Brings a thing to a level with all that is solved with it, as that wakes, too: if there is room for them. Returns the ms that it costs."""
        together = self._connections.solved_with(thing)
        level, unit = thing.levels[index], self._time.ms_of_work
        targets = {thing: index}
        for each in together.things:
            if each.level.stride == 0:
                alike = (k for k, other in enumerate(each.levels) if other.is_like(level))
                targets.setdefault(each, next(alike, 0))
        costs = {each: -unit * self._arrays.saved_at(each, target) for each, target in targets.items()}
        cost = sum(costs.values())
        if len(targets) > 1 and cost > room:
            return 0.0
        for each, target in targets.items():
            self._change(each, target, significance, -costs[each], "time is left")
            if each in together.touching:
                self._arrays.refuse_strides(each, self._arrays.now + REFUSED)
        self._time.ms += cost
        return cost
