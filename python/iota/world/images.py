# SPDX-License-Identifier: Apache-2.0
"""The images that pages need: those of the textures of all that is drawn."""

from __future__ import annotations

from collections.abc import Hashable

from iota._core import Room
from iota.textures import Texture
from iota.world.records import encode


class Images:
    """The textures in use; each is sent once, however many use it."""

    def __init__(self) -> None:
        self._used: dict[Hashable, Texture] = {}
        self._slots: dict[str, int] = {}  # of those that were sent, by name
        self._next = 0
        self._is_changed = False

    def use(self, user: Hashable, texture: Texture | None) -> None:
        """Says which texture a thing or a look needs from now on."""
        if self._used.get(user) == texture:
            return
        if texture is None:
            del self._used[user]
        else:
            self._used[user] = texture
        self._is_changed = True

    def tell_anew(self) -> None:
        """Forgets what was sent: the next room is empty."""
        self._slots.clear()
        self._is_changed = True

    def tell(self, room: Room) -> None:
        """Sends new ones, and destroys those that nothing needs."""
        if not self._is_changed:
            return
        self._is_changed = False
        needed = {texture.name: texture for texture in self._used.values()}
        for name, texture in needed.items():
            if name in self._slots:
                continue
            slot = self._slots[name] = self._next
            self._next += 1
            u, v = texture.repeat
            record = {"name": name, "image": texture.image, "repeat_u": u, "repeat_v": v}
            room.set_entity("texture", slot, 1, encode("texture", record))
        for name in [name for name in self._slots if name not in needed]:
            room.destroy_entity("texture", self._slots.pop(name), 1)
