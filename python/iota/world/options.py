# SPDX-License-Identifier: Apache-2.0
"""Options of the command line, which override the arguments of a script's World."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from iota.world.lan import Lan
    from iota.world.server import Server
    from iota.world.summary import RunSummary
    from iota.world.view import View


@dataclass
class RunOptions:
    """None: the script's value. drive: runs a World instead of in real time, see `iota.film`. view: as of `World.run`.
    record: a file for what pages show, see `Pages.record`. kept: a file for the state in which a world ends and the next
    one begins, see `iota.world.keeping`. keep, fresh: of `World.keep`. make_server: called as `Server`. on_serve: is told the World that is served. names: of the module whose build() made the World. `ran`, `summary`: set by the
    World that ran."""

    port: int | None = None
    seconds: float | None = None
    open: bool | None = None
    headless: bool = False
    lan: Lan | None = None
    drive: Callable[[Any], None] | None = None
    view: View | None = None
    record: Path | None = None
    kept: Path | None = None
    keep: Path | None = None
    fresh: bool = False
    make_server: Callable[..., Server] | None = None
    on_serve: Callable[[Any], None] | None = None
    names: dict[str, Any] | None = None
    ran: bool = False
    summary: RunSummary | None = None


_current = RunOptions()


def current() -> RunOptions:
    return _current


@contextmanager
def use(options: RunOptions) -> Iterator[RunOptions]:
    """Applies `options` to all Worlds that run inside the with block."""
    global _current
    before, _current = _current, options
    try:
        yield options
    finally:
        _current = before
