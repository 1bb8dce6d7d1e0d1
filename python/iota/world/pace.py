# SPDX-License-Identifier: Apache-2.0
"""Limits how often each user's page calls functions of the script, and how long these take, so that no page and no number
of pages can hold the world for all."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass

ACTIONS = 30.0  # a second of one page, and at once
WORK = 0.5  # of the time: what the functions called by all pages together may take
MOST_WORK = 1.0  # s, that they may take at once
RECENT = 1.0  # s, since a page did something: those that did share WORK


@dataclass
class _Allowance:
    left: float
    at: float  # s
    is_told: bool = False


class Pace:
    """30 actions a second of each page, or more messages that count as a share of an action. Work counts, too: half of the
    time, divided by the pages that are acting. now: s."""

    def __init__(self, now: Callable[[], float] = time.monotonic) -> None:
        self._now = now
        self._of: dict[int, _Allowance] = {}
        self._work, self._work_at = 0.0, now()  # s, of all pages, less what is allowed since

    def allows(self, client: int, share: float) -> bool:
        """share: of an action that a message counts as; 0: it is always allowed."""
        if share == 0:
            return True
        now = self._now()
        known = self._of.setdefault(client, _Allowance(ACTIONS, now))
        known.left = min(ACTIONS, known.left + ACTIONS * (now - known.at))
        known.at = now
        if known.left < share or self._work_now() > MOST_WORK:
            return False
        known.left -= share
        if known.left > ACTIONS / 2:
            known.is_told = False
        return True

    def charge(self, client: int, seconds: float) -> None:
        """Counts the time that a message of a page has taken."""
        self._work = self._work_now() + seconds
        known = self._of.get(client)
        if known is not None:
            acting = sum(self._work_at - each.at < RECENT for each in self._of.values())
            known.left -= ACTIONS / WORK * acting * seconds

    def _work_now(self) -> float:
        now = self._now()
        self._work = max(0.0, self._work - WORK * (now - self._work_at))
        self._work_at = now
        return self._work

    def is_first_refusal(self, client: int) -> bool:
        """True once for each time that a page is too fast."""
        known = self._of[client]
        was_told, known.is_told = known.is_told, True
        return not was_told

    def forget(self, client: int) -> None:
        self._of.pop(client, None)
