# SPDX-License-Identifier: Apache-2.0
"""Things that come into sight, and have done meanwhile what they would have done."""

from __future__ import annotations

import time
from collections import deque
from dataclasses import dataclass, field

from iota._core import Body, Places, System
from iota.levels.arrays import Arrays
from iota.levels.catching_up import CatchUp
from iota.levels.connections import Connections
from iota.levels.managed import Managed
from iota.levels.stiffness import Clothes
from iota.levels.things import Things
from iota.levels.ties import Tie

MISSED = 0.25  # s: a thing that was frozen for less has missed nothing; its last stride is over then
CATCH_UP = 2.0  # ms in a step, for what frozen things would have done, if it must be done at once


@dataclass(eq=False)
class Arrival:
    """Things that were frozen out of sight and soon are in it: what they would have done is found in pieces."""

    thing: Managed
    things: list[Managed] = field(default_factory=list)
    bodies: list[Body] = field(default_factory=list)
    found: CatchUp | None = None


class Arrivals:
    """The things that come into sight, in the order in which they do."""

    def __init__(
        self, system: System, things: Things, connections: Connections, arrays: Arrays, visuals: Clothes
    ) -> None:
        self._system, self._things, self._connections, self._arrays = system, things, connections, arrays
        self._visuals = visuals
        self._coming: deque[Arrival] = deque()
        self._places: Places | None = None  # made when it is asked
        self.ms_left = 0.0  # in this step, for what must be done at once

    def __bool__(self) -> bool:
        return bool(self._coming)

    def clear(self) -> None:
        """The work that has begun is in vain."""
        self._coming.clear()

    def catch_up(self, thing: Managed) -> None:
        """A thing that was frozen out of sight has done what it would have done, unless this step has had enough of that. So have all that
        joints tie to it, if all of that was."""
        coming = self._coming_of(thing)
        if coming is None:
            if not self._arrays.has_missed(thing):
                return
            coming = Arrival(thing)
        else:
            self._coming.remove(coming)
        if self.ms_left <= 0:
            self._begin(coming, is_late=True)
            return
        began = time.process_time()
        if self._begin(coming) and coming.found is not None:
            coming.found.go_on()
            self._end(coming)
        self.ms_left -= 1e3 * (time.process_time() - began)

    def _begin(self, coming: Arrival, is_late: bool = False) -> bool:
        """Copies what comes, once. False if it has missed nothing, or goes on from where it was."""
        if coming.found is not None:
            return True
        thing = coming.thing
        if not thing.root.alive or thing.level.stride != 0 or not self._arrays.has_missed(thing):
            return False
        if thing._welds and not is_late:  # frozen, it costs nothing apart
            thing._set_stiff(False, self._visuals)
            self._arrays.find_points_of(thing)
        coming.things, coming.bodies, ties = [thing], thing.bodies, list[Tie]()
        if self._connections.is_jointed_by_now(thing, coming.bodies):
            coming.bodies, ties = self._connections.all_ties().around(coming.bodies)
            found = (self._things.of_root(body) for body in coming.bodies)
            coming.things = list(dict.fromkeys(each for each in found if each is not None))
        seconds = min((self._arrays.take_missed(each, self._system.time) for each in coming.things), default=0.0)
        if is_late or (thing.is_jointed and any(body.stride != 0 for body in coming.bodies)):
            return False
        if not (seconds > MISSED and all(each._stand_in is None for each in coming.things)):
            return False
        self._places = self._places or Places(self._system)
        coming.found = CatchUp(self._system, coming.bodies, seconds, ties, self._places)
        return True

    def _end(self, coming: Arrival) -> None:
        """Puts a thing where it would have come."""
        is_whole = all(body.alive and body.stride == 0 for body in coming.bodies)
        if is_whole and coming.found is not None and coming.found.finish():
            for each in coming.things:
                each._set_stride(each.level.stride)

    def wait_for(self, thing: Managed) -> None:
        """It is found in pieces where it would have come."""
        if self._coming_of(thing) is None:
            self._coming.append(Arrival(thing))

    def _coming_of(self, thing: Managed) -> Arrival | None:
        return next((each for each in self._coming if thing is each.thing or thing in each.things), None)

    def go_on(self, ms: float) -> None:
        """Finds where they would have come, for so long."""
        until = time.process_time() + 1e-3 * ms
        while self._coming:
            coming = self._coming[0]
            is_late = coming.found is None and self._arrays.is_seen(coming.thing)
            if self._begin(coming, is_late) and coming.found is not None:
                if not coming.found.go_on(until):
                    return
                self._end(coming)
            self._coming.popleft()
            if time.process_time() > until:
                return
