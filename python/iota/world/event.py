# SPDX-License-Identifier: Apache-2.0
"""The argument of callbacks."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from iota._core import Body, Broken, ContactEvent, StopEvent, System, Vec3
from iota.world.notices import Notices, Place


@dataclass(frozen=True)
class Hand:
    """The state of a pointer besides its ray. rotation: of the hand or controller, quaternion x y z w; its ray is along -z. buttons: how
    far each is pressed, 0 to 1, in the order of WebXR or of the gamepad. axes: x and y of each stick, -1 to 1, as browsers have
    them. joints: of a bare hand, (25, 3) in the order of WebXR, world, m; otherwise (0, 3)."""

    rotation: tuple[float, float, float, float]
    buttons: tuple[float, ...]
    axes: tuple[float, ...]
    joints: NDArray[np.float64] = field(compare=False)

    @property
    def trigger(self) -> float:
        """How far the trigger, the pinch or the mouse button is pressed, 0 to 1."""
        return self.buttons[0] if self.buttons else 0.0

    @property
    def grip(self) -> float:
        """How far the grip button is pressed, 0 to 1."""
        return self.buttons[1] if len(self.buttons) > 1 else 0.0

    @property
    def stick(self) -> tuple[float, float]:
        """The stick of a controller, or the left one of a gamepad: to the right and away, -1 to 1."""
        return (self.axes[0], -self.axes[1]) if len(self.axes) > 1 else (0.0, 0.0)


@dataclass(frozen=True)
class Event:
    """The argument of callbacks. name: of the action, or of the event. client: number of the user, 0 for none. target:
    the body of the event, for actions the held or selected one; None without a body.

    point: where a pointer hit the body, or the place of a hand, world, m; None without a hit. origin, direction: of the
    pointer's ray, if known. pointer: "mouse", "touch 1", "left", "right". phase: "start", "update" or "end" of a drag
    or hover, "start" or "end" of a stop or contact. contact, other: the ContactEvent, and its body of side b; None if that
    is gone. hold: number of the hand. key: that was pressed or released. stop,
    broken: the StopEvent or Broken. hand: of a moved pointer. reason: why a drag ended: "released", "left" (the page was
    closed), "destroyed" (the body; then target is None) or "reset" (also by undo and rewind)."""

    system: System
    name: str
    client: int = 0
    target: Body | None = None
    point: Vec3 | None = None
    origin: Vec3 | None = None
    direction: Vec3 | None = None
    pointer: str = ""
    phase: str = ""
    hold: int = 0
    key: str = ""
    stop: StopEvent | None = None
    broken: Broken | None = None
    contact: ContactEvent | None = None
    other: Body | None = None
    hand: Hand | None = None
    reason: str = ""
    notices: Notices = field(default_factory=Notices, repr=False, compare=False)

    @property
    def body(self) -> Body:
        """The held or selected body. Raises LookupError without one (`target` is None). An action with on="body" always
        has one."""
        if self.target is None:
            raise LookupError(f"the event {self.name!r} is on no body")
        return self.target

    def notice(
        self,
        title: str,
        text: str = "",
        hint: str = "",
        level: str = "info",
        seconds: float | None = None,
        id: str = "",
        place: Place = "free",
    ) -> None:
        """Shows a small card to the user of the event, or on all pages if it has no user. level: "info", "warning" or
        "error". seconds, id, place: as in `world.users.notice`."""
        self.notices.send(title, text, hint, level, self.client, seconds=seconds, id=id, place=place)
