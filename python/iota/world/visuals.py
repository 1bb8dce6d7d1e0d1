# SPDX-License-Identifier: Apache-2.0
"""The visuals that the script gives to bodies, as sent to pages."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Any

from iota._core import Body, Capsule, Cylinder, DrawnPart, Room, Sphere, Torus
from iota.colors import color_number
from iota.looks import Look, Looks
from iota.simulator import SimulatedBody
from iota.textures import Texture

TIES = ("spring", "rope", "rod")  # drawn between two points, by visuals of these names


def listed(drawn: Look | list[Look]) -> list[Look]:
    return drawn if isinstance(drawn, list) else [drawn]


def part_of(described: dict[str, Any], style: str) -> DrawnPart:
    """Encodes a result of `Look.describe` for pages."""
    color = described.get("color")
    return DrawnPart(
        described.get("kind", "solid"),
        described.get("sizes", []),
        style=style,
        material=described["material"],
        color=None if color is None else color_number(color),
        offset=tuple(described["offset"]),
        rotation=tuple(described["rotation"]),
        turn=described.get("turn", 0.0),
        vertices=described.get("vertices", []),
        triangles=described.get("triangles", []),
    )


def radius_of(looks: Looks) -> float | None:
    """The least radius of round looks, m; None without one. A torus lies about a body's line with its outer radius."""
    radii = []
    for drawn in looks.values():
        for look in listed(drawn):
            if isinstance(look.shape, Capsule | Cylinder | Sphere):
                radii.append(look.shape.radius)
            elif isinstance(look.shape, Torus):
                radii.append(look.shape.radius + look.shape.tube)
    return min(radii, default=None)


class Visuals:
    """Named looks, each for all styles, and the bodies that are drawn with them. version: rises when pages need what was not
    sent yet."""

    def __init__(self) -> None:
        self.version = 0
        self.looks: dict[str, Looks] = {}
        self._visual_of: dict[Body | SimulatedBody, tuple[str, int]] = {}
        self._untold: dict[Body | SimulatedBody, tuple[str, int]] = {}

    @property
    def styles(self) -> list[str]:
        """The names of styles that looks are given for, in the order of their first use."""
        return list(dict.fromkeys(name for looks in self.looks.values() for name in looks if name != "*"))

    def assign(self, bodies: Iterable[Body | SimulatedBody], name: str) -> None:
        """Draws bodies with a visual."""
        for index, body in enumerate(bodies):
            self._dress(body, name, index % 2)
        self.version += 1

    def assign_ties(self, kind: str, looks: Looks) -> None:
        """kind: one of TIES."""
        self.looks[kind] = looks
        self.version += 1

    def name_of(self, looks: Looks) -> str:
        """The visual with these looks; makes it if there is none."""
        for name, known in self.looks.items():
            if known == looks and name not in TIES:
                return name
        name = f"visual {len(self.looks) + 1}"
        self.looks[name] = looks
        return name

    def _dress(self, body: Body | SimulatedBody, name: str, odd: int) -> None:
        self._visual_of[body] = self._untold[body] = (name, odd)

    def looks_of(self, body: Body) -> Looks | None:
        return self.looks[self._visual_of[body][0]] if body in self._visual_of else None

    def dress_alike(self, body: Body, like: Body) -> None:
        """Gives a body the look of another one."""
        if like in self._visual_of:
            name, odd = self._visual_of[like]
            self._dress(body, name, 1 - odd)
            self.version += 1

    def hand_over(self, former: Body, body: Body) -> None:
        """Gives a body the look of the one that it was."""
        if former in self._visual_of:
            self._dress(body, *self._visual_of[former])
            self.version += 1

    def textures(self) -> Iterator[Texture]:
        """The images on them."""
        for looks in self.looks.values():
            for drawn in looks.values():
                yield from (look.texture for look in listed(drawn) if look.texture is not None)

    def tell_anew(self) -> None:
        """Forgets what was sent: the next room is empty."""
        self._untold = dict(self._visual_of)

    def tell(self, room: Room) -> None:
        """Sends all that was not sent yet."""
        for name, looks in self.looks.items():
            parts = [part_of(look.describe(), style) for style, drawn in looks.items() for look in listed(drawn)]
            room.set_visual(name, parts)
        for body, (name, odd) in self._untold.items():
            if isinstance(body, SimulatedBody):
                room.assign_slot(body.slot, body.generation, name, odd=bool(odd))
            else:
                room.assign(body, name, odd=bool(odd))
        self._untold.clear()
