# SPDX-License-Identifier: Apache-2.0
"""What a callback is given."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from iota._core import Body, System

if TYPE_CHECKING:
    from iota.world.world import World


@dataclass(frozen=True)
class Event:
    """What a callback is given. name: of the action, or of what happened. client: whose it is, 0 for no user's."""

    world: World
    name: str
    client: int = 0
    target: Body | None = None

    @property
    def system(self) -> System:
        return self.world.system

    @property
    def body(self) -> Body:
        """The held or selected body. Raises LookupError where there is none: `target` is None then. An action with
        on="body" always has one."""
        if self.target is None:
            raise LookupError(f"the event {self.name!r} is on no body")
        return self.target
