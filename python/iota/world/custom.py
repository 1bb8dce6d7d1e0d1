# SPDX-License-Identifier: Apache-2.0
"""Things that a script adds with code of its own: objects of classes that its JavaScript modules define, and sounds."""

from __future__ import annotations

import json
import math
from typing import Any

from iota.sounds import SoundFile
from iota.world.things import Field, Place, Thing, anchor, length, place, place_of, text, unit_quaternion

MOST_VALUES = 65_536  # bytes, as JSON


class Custom(Thing):
    """An object of a class that a module of the script defines, see `Drawings.custom`. values: its data, a dictionary of what JSON
    can hold; assign a new one to change it. at, rotation: its frame, as of a shape."""

    kind = "custom"
    class_name, at, rotation = Field(text), Field(place), Field(unit_quaternion)

    @staticmethod
    def _checked(value: Any) -> dict[str, Any]:
        """A copy of it, as pages get it."""
        try:
            written = json.dumps(dict(value), allow_nan=False)
        except (TypeError, ValueError) as error:
            raise ValueError(
                f"must be a dictionary of finite numbers, texts, lists and dictionaries: {error}"
            ) from None
        if len(written) > MOST_VALUES:
            raise ValueError(f"may have {MOST_VALUES} bytes at most, not {len(written)}")
        return json.loads(written)  # type: ignore[no-any-return]

    values = Field(_checked)

    def _record(self) -> dict[str, Any] | None:
        at = anchor(self.at)
        if at is None:
            return None
        return {"class_name": self.class_name, "at": at, "rotation": self.rotation, "values": json.dumps(self.values)}


class Sound(Thing):
    """A sound of the script, see `Drawings.sound`. reach: distance up to which it is not fainter, m; 0: half the diagonal of the
    scene."""

    kind = "sound"
    reach = Field(length)

    def __init__(self, things: Any, file: SoundFile, **values: Any) -> None:
        self._file = file
        super().__init__(things, **values)

    def play(self, at: Place, volume: float = 1.0) -> None:
        """Plays it once on all pages, at a particle, a body or a place (m). volume: from 0 to 10."""
        self._things_or_raise().play(f"#{self._file.name}", place_of(at), checked_volume(volume))

    def _things_or_raise(self) -> Any:
        if self._things is None:
            raise RuntimeError("the sound was destroyed")
        return self._things

    def _record(self) -> dict[str, Any] | None:
        return {"name": self._file.name, "file": self._file.data, "reach": self.reach}


def checked_volume(volume: float) -> float:
    if not (math.isfinite(volume) and 0 <= volume <= 10):
        raise ValueError(f"volume must be from 0 to 10, not {volume}")
    return float(volume)
