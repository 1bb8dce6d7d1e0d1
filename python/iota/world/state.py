# SPDX-License-Identifier: Apache-2.0
"""What the parts of a world share."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from iota._core import System
from iota.world.actions import Actions
from iota.world.clock import Clock
from iota.world.hands import Hands
from iota.world.notices import Notices
from iota.world.scene import Camera, Scene


@dataclass
class State:
    """A world: what it simulates, how it is shown, how it runs, who is there."""

    system: System
    clock: Clock
    title: str
    look: str | None = None  # that pages start with
    ground: float | None = 0.0  # m
    camera: Camera | None = None
    statics: list[dict[str, Any]] = field(default_factory=list)
    actions: Actions = field(default_factory=Actions)
    notices: Notices = field(default_factory=Notices)
    step_ms: float = 0.0  # what a step takes, smoothed
    is_changed: bool = True  # what pages were told of it, poses apart, does not hold any more

    def __post_init__(self) -> None:
        self.scene = Scene(self.system)
        self.hands = Hands(self.system)
