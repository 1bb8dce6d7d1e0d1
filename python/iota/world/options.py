# SPDX-License-Identifier: Apache-2.0
"""What the command line lays over the arguments that a script gives to its World."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from iota.world.lan import Lan
    from iota.world.summary import RunSummary


@dataclass
class RunOptions:
    """None: what the script says. drive: runs a World in place of real time, see `iota.film`. `ran`, `summary`: filled in by the
    World that ran."""

    port: int | None = None
    seconds: float | None = None
    open: bool | None = None
    headless: bool = False
    lan: Lan | None = None
    drive: Callable[[Any], None] | None = None
    ran: bool = False
    summary: RunSummary | None = None


_current = RunOptions()


def current() -> RunOptions:
    return _current


@contextmanager
def use(options: RunOptions) -> Iterator[RunOptions]:
    """Lays `options` over all Worlds that run inside the with block."""
    global _current
    before, _current = _current, options
    try:
        yield options
    finally:
        _current = before
