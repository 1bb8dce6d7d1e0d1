# SPDX-License-Identifier: Apache-2.0
"""Pictures taken by pages."""

from __future__ import annotations

import threading
import time
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path

from iota._core import Room
from iota._protocol import Picture
from iota.saving import replacing
from iota.world.clients import Clients

MOST_BYTES = 32 << 20  # of a picture
FIRST, EVERY = 5.0, 60.0  # s, from the first page to a portrait, and from one to the next
LATE = 30.0  # s, after which a picture does not come any more
PAINTERS = ("host", "guest", "viewer")  # a host sees what the page of another one has sent


@dataclass
class _Request:
    client: int
    data: bytearray = field(default_factory=bytearray)


class Pictures:
    """Assembles them from their parts."""

    def __init__(self) -> None:
        self._waiting: dict[int, _Request] = {}
        self._ready: dict[int, bytes] = {}
        self._number = 0

    def ask(self, client: int) -> int:
        """The number of a new request to a client."""
        self._number += 1
        self._waiting[self._number] = _Request(client)
        return self._number

    def take(self, client: int, part: Picture) -> None:
        """A part of another client's picture is ignored; one that is too large counts as none."""
        request = self._waiting.get(part.request)
        if request is None or request.client != client:
            return
        request.data += part.data
        if part.is_last or len(request.data) > MOST_BYTES:
            del self._waiting[part.request]
            self._ready[part.request] = bytes(request.data) if len(request.data) <= MOST_BYTES else b""

    def ready(self, number: int) -> bytes | None:
        """A PNG file, empty if the page could not make one; None until it arrives."""
        return self._ready.pop(number, None)

    def forget(self, number: int) -> None:
        self._waiting.pop(number, None)
        self._ready.pop(number, None)


class Portrait:
    """A picture of a world in a file, which its pages renew now and then."""

    def __init__(self, file: Path, pictures: Pictures, clients: Clients) -> None:
        self._file, self._pictures, self._clients = file, pictures, clients
        self._asked: int | None = None
        self._late_at = 0.0  # s
        self._next: float | None = None  # s; None without a page

    def look(self, room: Room) -> None:
        """On the thread of the world, at each frame."""
        now = time.monotonic()
        if self._asked is not None:
            self._look_for_picture(self._asked, now)
        elif not self._clients.by_id:
            self._next = None
        elif self._next is None:
            self._next = now + FIRST
        elif now >= self._next:
            self._next, self._late_at = now + EVERY, now + LATE
            painter = min(self._clients.by_id.values(), key=lambda client: PAINTERS.index(client.role))
            self._asked = self._pictures.ask(painter.id)
            room.ask_picture(painter.id, self._asked)

    def _look_for_picture(self, number: int, now: float) -> None:
        picture = self._pictures.ready(number)
        if picture is None and now < self._late_at:
            return
        self._asked = None
        self._pictures.forget(number)
        if picture:
            threading.Thread(target=self._write, args=(picture,), daemon=True).start()

    def _write(self, picture: bytes) -> None:
        with suppress(OSError), replacing(self._file) as fresh:  # a full disk: the journal tells of it
            fresh.write_bytes(picture)
