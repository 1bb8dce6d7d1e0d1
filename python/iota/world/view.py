# SPDX-License-Identifier: Apache-2.0
"""The interface of a VR component for `World`, to replace the page by another one.

docs/replaceable.md explains it; `iota.terminal.TerminalView` is an example.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Any


class View(ABC):
    """Shows a running world to one user, and passes on what that user does: `World.run(view=...)`.

    All are called on the thread that runs the world, with that `iota.World`. What a view needs is what scripts use too: `world.system` with its
    bodies and their particles and solids, `world.controls.actions`, `world.controls.act`, `world.clock.paused`, `world.reset()`, and
    `system.grip` for a hand.
    """

    def open(self, world: Any) -> None:  # noqa: B027
        """Before the first step."""

    @abstractmethod
    def frame(self, world: Any) -> None:
        """Takes the user's input and shows the present state: up to 60 times a second, between steps."""

    def notice(self, title: str, text: str, hint: str) -> None:  # noqa: B027
        """A card for the user."""

    def close(self) -> None:  # noqa: B027
        """When the world ends, also by an error."""
