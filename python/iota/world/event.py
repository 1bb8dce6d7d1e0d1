# SPDX-License-Identifier: Apache-2.0
"""What a callback is given."""

from __future__ import annotations

from dataclasses import dataclass, field

from iota._core import Body, Broken, ContactEvent, System, Vec3
from iota.world.notices import Notices


@dataclass(frozen=True)
class Event:
    """What a callback is given. name: of the action, or of what happened. client: whose it is, 0 for no user's. target: the
    body that it is on, for actions the held or selected one; None where there is none.

    point: where a pointer hit the body, or where a hand is, world, m; None where nothing was hit. origin, direction: of the
    pointer's ray, where it is known. pointer: "mouse", "touch 1", "left", "right". phase: "start", "update" or "end" of a
    drag or hover, "start" or "end" of a contact. hold: number of the hand. key: that was pressed or let go. contact, broken:
    what has met or parted, and what has broken."""

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
    contact: ContactEvent | None = None
    broken: Broken | None = None
    notices: Notices = field(default_factory=Notices, repr=False, compare=False)

    @property
    def body(self) -> Body:
        """The held or selected body. Raises LookupError where there is none: `target` is None then. An action with
        on="body" always has one."""
        if self.target is None:
            raise LookupError(f"the event {self.name!r} is on no body")
        return self.target

    def notice(self, title: str, text: str = "", hint: str = "", level: str = "info") -> None:
        """Shows a small card to the user whose event it is; on all pages where it is no user's. level: "info", "warning"
        or "error"."""
        self.notices.send(title, text, hint, level, self.client)
