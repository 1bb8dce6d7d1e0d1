# SPDX-License-Identifier: Apache-2.0
"""Pictures taken by pages."""

from __future__ import annotations

from iota._protocol import Picture


class Pictures:
    """Assembles them from their parts."""

    def __init__(self) -> None:
        self._parts: dict[int, list[bytes]] = {}
        self._ready: dict[int, bytes] = {}
        self._number = 0

    def ask(self) -> int:
        """The number of a new request."""
        self._number += 1
        self._parts[self._number] = []
        return self._number

    def take(self, part: Picture) -> None:
        parts = self._parts.get(part.request)
        if parts is None:
            return
        parts.append(part.data)
        if part.is_last:
            self._ready[part.request] = b"".join(self._parts.pop(part.request))

    def ready(self, number: int) -> bytes | None:
        """A PNG file, empty if the page could not make one; None until it arrives."""
        return self._ready.pop(number, None)

    def forget(self, number: int) -> None:
        self._parts.pop(number, None)
        self._ready.pop(number, None)
