# SPDX-License-Identifier: Apache-2.0
"""The argument of callbacks."""

from __future__ import annotations

from dataclasses import dataclass, field

from iota._core import Body, Broken, ContactEvent, System, Vec3
from iota.world.notices import Notices


@dataclass(frozen=True)
class Event:
    """The argument of callbacks. name: of the action, or of the event. client: number of the user, 0 for none. target:
    the body of the event, for actions the held or selected one; None without a body.

    point: where a pointer hit the body, or the place of a hand, world, m; None without a hit. origin, direction: of the
    pointer's ray, if known. pointer: "mouse", "touch 1", "left", "right". phase: "start", "update" or "end" of a drag
    or hover, "start" or "end" of a contact. hold: number of the hand. key: that was pressed or released. contact,
    broken: the ContactEvent or Broken."""

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
        """The held or selected body. Raises LookupError without one (`target` is None). An action with on="body" always
        has one."""
        if self.target is None:
            raise LookupError(f"the event {self.name!r} is on no body")
        return self.target

    def notice(self, title: str, text: str = "", hint: str = "", level: str = "info") -> None:
        """Shows a small card to the user of the event, or on all pages if it has no user. level: "info", "warning" or
        "error"."""
        self.notices.send(title, text, hint, level, self.client)
