# SPDX-License-Identifier: Apache-2.0
"""Limits how often each user's page calls functions of the script, so that one page cannot hold the world for all."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass

ACTIONS = 30.0  # a second of one page, and at once


@dataclass
class _Allowance:
    left: float
    at: float  # s
    is_told: bool = False


class Pace:
    """30 actions a second of each page, or more messages that count as a share of an action. now: s."""

    def __init__(self, now: Callable[[], float] = time.monotonic) -> None:
        self._now = now
        self._of: dict[int, _Allowance] = {}

    def allows(self, client: int, share: float) -> bool:
        """share: of an action that a message counts as; 0: it is always allowed."""
        if share == 0:
            return True
        now = self._now()
        known = self._of.setdefault(client, _Allowance(ACTIONS, now))
        known.left = min(ACTIONS, known.left + ACTIONS * (now - known.at))
        known.at = now
        if known.left < share:
            return False
        known.left -= share
        if known.left > ACTIONS / 2:
            known.is_told = False
        return True

    def is_first_refusal(self, client: int) -> bool:
        """True once for each time that a page is too fast."""
        known = self._of[client]
        was_told, known.is_told = known.is_told, True
        return not was_told

    def forget(self, client: int) -> None:
        self._of.pop(client, None)
