# SPDX-License-Identifier: Apache-2.0
"""The size of heaps whose contacts are solved exactly, as a level: it falls where steps take too long, and rises when there is room again."""

from __future__ import annotations

import math
from collections import deque

from iota._core import System

LEAST = 1 / 16  # of `System.budget_contacts`
RECENT, MANY = 16, 2  # steps, and how many of them may not be too long: a single one may be a blow, or another program
# Steps with room, more than others, before the share rises; up to so many, if it had to fall again soon.
CALM, LONGEST_CALM = 240, 3840
ROOM = 0.5  # of the time that a step may take


class ContactShare:
    """Sets `System.contacts_share` by the times of steps. Each change is an edit, as those of other levels are."""

    def __init__(self, system: System) -> None:
        self._system = system
        self._recent: deque[float] = deque(maxlen=RECENT)  # times of steps, in what they may take
        self._calm, self._wait = 0, CALM  # steps
        self._since_rise = LONGEST_CALM

    def look(self, ms: float, limit: float, room: float = ROOM) -> tuple[float, float] | None:
        """After each step. ms: that it took; limit: that it may take; room: the part of that below which more contacts may be exact.
        The share before and after a change."""
        share = self._system.contacts_share
        self._recent.append(ms / limit)
        self._since_rise += 1
        too_long = [time for time in self._recent if time > 1]
        if len(too_long) >= MANY:
            self._recent.clear()
            self._calm = 0
            if share <= LEAST or not self._are_contacts_costly():
                return None
            if self._since_rise < self._wait:
                self._wait = min(2 * self._wait, LONGEST_CALM)
            halvings = max(1, int(math.log2(min(too_long))))  # at once, or each would take two such steps more
            return self._change(share, max(share / 2**halvings, LEAST))
        if share == 1:
            return None
        self._calm = max(self._calm + (1 if ms < room * limit else -1), 0)
        if self._calm < self._wait:
            return None
        self._calm = self._since_rise = 0
        return self._change(share, min(2 * share, 1.0))

    def be_exact(self) -> None:
        """As no step has to be short."""
        self._recent.clear()
        self._calm, self._wait = 0, CALM
        if self._system.contacts_share != 1:
            self._system.contacts_share = 1

    def _change(self, before: float, after: float) -> tuple[float, float]:
        self._system.contacts_share = after
        return before, after

    def _are_contacts_costly(self) -> bool:
        """Whether the bodies that took most of the latest step touch something."""
        heaviest = max(self._system.islands(), key=lambda island: island.points * island.iterations, default=None)
        return heaviest is not None and any(body.contacts for body in heaviest.bodies)
