# SPDX-License-Identifier: Apache-2.0
"""The looks of bodies: the classes given by the script, as sent to pages."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from iota._core import Body, Capsule, Cylinder, DrawnPart, Room, Sphere, Torus, Vec3
from iota.arguments import SHORT
from iota.looks import Look, Looks, color_number
from iota.simulator import SimulatedBody
from iota.textures import Texture
from iota.world.things import vector


@dataclass(frozen=True)
class Camera:
    """The first view: place of the camera and its target, m."""

    position: Sequence[float] = (2.5, 1.6, 3.5)
    target: Sequence[float] = (0.0, 1.2, 0.0)

    def __post_init__(self) -> None:
        for name in ("position", "target"):
            try:
                object.__setattr__(self, name, tuple(vector(getattr(self, name))))
            except (TypeError, ValueError) as error:
                raise type(error)(f"{name}: {error}") from None
        if self.position == self.target:
            raise ValueError(f"a camera needs a target elsewhere than its position, not {self.position} twice")


def camera_or_none(given: Any) -> Camera | None:
    """Raises TypeError for anything else."""
    if not (given is None or isinstance(given, Camera)):
        raise TypeError(f"camera must be a Camera, as in iota.Camera((3, 2, 3), (0, 1, 0)), not {SHORT.repr(given)}")
    return given


@dataclass(frozen=True, eq=False)
class Static:
    """A fixed shape without physics, see `World.add_static`; the ground is one too, of a HalfSpace. position: m. rotation:
    quaternion x y z w."""

    look: Look
    position: Vec3
    rotation: tuple[float, ...] = (0.0, 0.0, 0.0, 1.0)


def listed(style: Look | list[Look]) -> list[Look]:
    return style if isinstance(style, list) else [style]


def part_of(described: dict[str, Any], style: str = "*", **place: Any) -> DrawnPart:
    """Encodes a result of `Look.describe` for pages. place: replaces its offset and rotation."""
    where = described | place
    color = described.get("color")
    return DrawnPart(
        described.get("kind", "solid"),
        described.get("sizes", []),
        look=style,
        material=described["material"],
        color=None if color is None else color_number(color),
        offset=tuple(where["offset"]),
        rotation=tuple(where["rotation"]),
        turn=described.get("turn", 0.0),
        vertices=described.get("vertices", []),
        triangles=described.get("triangles", []),
    )


class Scene:
    """Classes of bodies and their looks."""

    def __init__(self) -> None:
        self.classes: dict[str, Looks] = {}
        self._class_of: dict[Body | SimulatedBody, tuple[str, int]] = {}
        self._untold: dict[Body | SimulatedBody, tuple[str, int]] = {}
        self._drawn: set[Body | SimulatedBody] = set()

    def assign(self, bodies: Iterable[Body | SimulatedBody], name: str) -> None:
        for index, body in enumerate(bodies):
            self._class_of[body] = self._untold[body] = (name, index % 2)
            self._drawn.add(body)

    def looks_of(self, body: Body) -> Looks | None:
        return self.classes[self._class_of[body][0]] if body in self._class_of else None

    def dress_alike(self, body: Body, like: Body) -> None:
        """Gives a body the look of another one."""
        if like in self._class_of:
            name, odd = self._class_of[like]
            self._class_of[body] = self._untold[body] = (name, 1 - odd)
            self._drawn.add(body)

    def thickness_of(self, body: Body) -> float | None:
        """Radius of a body's look, m, if it is round about the body's line; None otherwise."""
        if body not in self._class_of:
            return None
        radii = []
        for drawn in self.classes[self._class_of[body][0]].values():
            for look in listed(drawn):
                if isinstance(look.shape, Capsule | Cylinder | Sphere):
                    radii.append(look.shape.radius)
                elif isinstance(look.shape, Torus):
                    radii.append(look.shape.radius + look.shape.tube)
        return min(radii, default=None)

    def take_drawn(self) -> set[Body | SimulatedBody]:
        """The bodies that were given a look since the last call."""
        drawn, self._drawn = self._drawn, set()
        return drawn

    def textures(self) -> Iterator[Texture]:
        """The images on them."""
        for looks in self.classes.values():
            for drawn in looks.values():
                yield from (look.texture for look in listed(drawn) if look.texture is not None)

    def tell_anew(self) -> None:
        """Forgets what was sent: the next room is empty."""
        self._untold = dict(self._class_of)

    def tell(self, room: Room, statics: Iterable[Static] = ()) -> None:
        """Sends all that was not sent yet. statics: shapes without physics."""
        for name, looks in self.classes.items():
            parts = [part_of(look.describe(), style) for style, drawn in looks.items() for look in listed(drawn)]
            room.set_class(name, parts)
        for body, (name, odd) in self._untold.items():
            if isinstance(body, SimulatedBody):
                room.assign_slot(body.slot, body.generation, name, odd=bool(odd))
            else:
                room.assign(body, name, odd=bool(odd))
        self._untold.clear()
        room.set_statics([part_of(s.look.describe(), offset=tuple(s.position), rotation=s.rotation) for s in statics])
