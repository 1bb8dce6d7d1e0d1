# SPDX-License-Identifier: Apache-2.0
"""What pages are told of a system, through a real server and a page without a browser."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from page_client import PageClient

import iota
from iota import _core
from iota.world.visuals import Visuals


class Shown:
    """A system, what the script says of its looks, and a page that shows it."""

    def __init__(self, system: iota.System, room: _core.Room, visuals: Visuals) -> None:
        self.system, self.room, self.visuals = system, room, visuals
        self.page: PageClient = None  # type: ignore[assignment]

    def publish(self) -> None:
        self.visuals.tell(self.room)
        self.room.publish(self.system)

    def look(self) -> int:
        """Brings the page up to date; how many records that took."""
        told, frames = self.page.told, self.page.pose_frames
        self.publish()
        self.page.wait_for(lambda: self.page.pose_frames > frames)
        return self.page.told - told

    @property
    def bodies(self) -> dict[int, dict[str, Any]]:
        return self.page.entities["body"]

    def parts(self, body: iota.Body) -> list[dict[str, Any]]:
        """Of a body, in all styles."""
        parts: list[dict[str, Any]] = self.page.visual_of(body.slot)["parts"]
        return parts


@contextmanager
def show(system: iota.System, visuals: Visuals | None = None) -> Iterator[Shown]:
    server = _core.Server(port=0, token="token")
    shown = Shown(system, server.open("default"), visuals or Visuals())
    try:
        shown.publish()
        with PageClient(server.url) as page:
            shown.page = page
            yield shown
    finally:
        shown.room.close(system)
        server.close()
