# SPDX-License-Identifier: Apache-2.0
"""`iota run --prompt`: Python on a running world.

The world runs on the main thread, where signals can interrupt a statement; the prompt waits for input on another one.
"""

from __future__ import annotations

import code
import importlib
import signal
import sys
import threading
from collections.abc import Callable
from contextlib import suppress
from types import CodeType, FrameType
from typing import Any

from iota.world import World
from iota.world.callbacks import print_on_terminal
from iota.world.options import current

BANNER = "The world runs. `world`, `system` and the names of the script are here; Ctrl-D ends it."
LONGEST = 10.0  # s, of a statement


class StatementEnded(Exception):
    """A statement that took too long."""


class Prompt(code.InteractiveConsole):
    """Runs each statement on the world's own thread, between two steps, so that it may use the system. Ctrl-C ends a
    statement, and so does the time of `LONGEST`: the world waits for it."""

    def __init__(self, world: World, names: dict[str, Any]) -> None:
        super().__init__({**names, "world": world, "system": world.system})
        self._world = world
        self._is_busy = False

    def runcode(self, code: CodeType) -> None:
        with suppress(StatementEnded, KeyboardInterrupt):  # that came when it had just ended
            self._world.call(lambda: self._run_here(lambda: super(Prompt, self).runcode(code)))

    def interrupt(self, number: int, frame: FrameType | None) -> None:
        """Handles Ctrl-C."""
        if self._is_busy:
            raise KeyboardInterrupt
        print_on_terminal("\n(Ctrl-D ends the world)\n")

    def _run_here(self, statement: Callable[[], None]) -> None:
        signal.signal(signal.SIGALRM, _end_statement)
        signal.setitimer(signal.ITIMER_REAL, LONGEST)
        self._is_busy = True
        try:
            self._world._guard.call("The statement at the prompt", statement)
        finally:
            self._is_busy = False
            signal.setitimer(signal.ITIMER_REAL, 0)


def _end_statement(number: int, frame: FrameType | None) -> None:
    raise StatementEnded(
        f"it was ended after {LONGEST:g} s, in which the world stood still. Do long work in pieces, as by world.every"
    )


def drive(world: World) -> None:
    """Runs a world until the prompt ends by Ctrl-D or `exit()`."""
    with suppress(ImportError):
        importlib.import_module("readline")  # for its history and keys
    prompt = Prompt(world, current().names or names_of_caller())

    def converse() -> None:
        try:
            with suppress(SystemExit):
                prompt.interact(BANNER, exitmsg="")
        finally:
            world.stop()

    world.serve()
    world._announce(show=False)
    before = signal.signal(signal.SIGINT, prompt.interrupt)
    try:
        threading.Thread(target=converse, name="iota-prompt", daemon=True).start()
        world._run_served()
    finally:
        signal.signal(signal.SIGINT, before)


def names_of_caller() -> dict[str, Any]:
    """The names of the script that called `world.run()`."""
    frame = sys._getframe()
    while frame.f_back is not None and frame.f_globals["__name__"].split(".")[0] == "iota":
        frame = frame.f_back
    return dict(frame.f_globals)
