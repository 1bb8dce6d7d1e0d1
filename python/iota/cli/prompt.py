# SPDX-License-Identifier: Apache-2.0
"""`iota run --prompt`: Python on a running world."""

from __future__ import annotations

import code
import importlib
import sys
from contextlib import suppress
from types import CodeType
from typing import Any

from iota.world import World
from iota.world.options import current

BANNER = "The world runs. `world`, `system` and the names of the script are here; Ctrl-D ends it."


class Prompt(code.InteractiveConsole):
    """Runs each statement on the world's own thread, between two steps, so that it may use the system."""

    def __init__(self, world: World, names: dict[str, Any]) -> None:
        super().__init__({**names, "world": world, "system": world.system})
        self._world = world

    def runcode(self, code: CodeType) -> None:
        self._world.call(lambda: super(Prompt, self).runcode(code))


def drive(world: World) -> None:
    """Runs a world until the prompt ends by Ctrl-D or `exit()`."""
    with suppress(ImportError):
        importlib.import_module("readline")  # for its history and keys
    world.start()
    world._announce(show=False)
    try:
        with suppress(SystemExit):
            Prompt(world, current().names or names_of_caller()).interact(BANNER, exitmsg="")
    finally:
        world.stop()


def names_of_caller() -> dict[str, Any]:
    """Those of the script that called `world.run()`."""
    frame = sys._getframe()
    while frame.f_back is not None and frame.f_globals["__name__"].split(".")[0] == "iota":
        frame = frame.f_back
    return dict(frame.f_globals)
