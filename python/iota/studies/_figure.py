# SPDX-License-Identifier: Apache-2.0
"""Jointed figures: tables of their parts, and what makes a figure of a table."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass

import iota
from iota.frames import Quaternion, one_after_another, turned

Place = tuple[float, float, float]
Range = tuple[float, float]
ALONG, UPRIGHT, AHEAD = (0.0, 0.0, 0.0, 1.0), (0.0, 0.0, 0.5**0.5, 0.5**0.5), (0.0, -(0.5**0.5), 0.0, 0.5**0.5)


@dataclass(frozen=True)
class Part:
    """A part of a figure that stands upright, looks along z, and has its left at positive x. at, turn: of its shape.

    inner: the earlier part that holds it at `joint`, by a knee that turns about x (`bends`), by a joint that turns about x and z (`sways`),
    by a hinge in all directions, or for good (`is_fixed`). hangs: further attachments. Lengths in m, angles in rad, masses in kg.
    """

    name: str
    shape: iota.Box | iota.Capsule | iota.Ellipsoid | iota.Sphere
    mass: float
    at: Place
    turn: Quaternion = UPRIGHT
    inner: str = ""
    joint: Place = (0.0, 0.0, 0.0)
    bends: Range | None = None
    sways: tuple[Range, Range] | None = None
    is_fixed: bool = False
    hangs: tuple[Place, ...] = ()

    @property
    def is_hinged(self) -> bool:
        return bool(self.inner) and not (self.bends or self.sways or self.is_fixed)


class Figure:
    """bodies: by the names of their parts. joints: those with limits, by the names of the parts that they hold.

    at: where the origin of the table is, m. turn: of the whole. dress(name, body): called for each part. friction: of its joints, N m.
    """

    def __init__(
        self,
        system: iota.System,
        parts: Iterable[Part],
        at: iota.Vec3,
        dress: Callable[[str, iota.Body], None],
        turn: Quaternion = ALONG,
        friction: float = 0.0,
        damping: float = 0.0,
    ) -> None:
        self.bodies: dict[str, iota.Body] = {}
        self.joints: dict[str, iota.Constraint] = {}
        self.hangs: list[iota.Particle] = []
        parts = list(parts)

        def place(point: Place) -> iota.Vec3:
            return turned(turn, iota.Vec3(*point)) + at

        for part in parts:
            hinges = [other.joint for other in parts if other.is_hinged and part.name in (other.name, other.inner)]
            frame = one_after_another(turn, part.turn)
            body = system.body(
                shape=part.shape, mass=part.mass, position=place(part.at), orientation=frame, damping=damping,
                attachments=[inside(part, point) for point in (*hinges, *part.hangs)],
            )  # fmt: skip
            dress(part.name, body)
            self.hangs += body.attachments[len(hinges) :]
            self.bodies[part.name] = body
            if part.inner:
                self._hold(system, part, place, turn, friction)

    @property
    def distinct(self) -> list[iota.Body]:
        """Each of its bodies once: a part that is fixed is of the body of its inner part."""
        return list(dict.fromkeys(self.bodies.values()))

    def _hold(
        self, system: iota.System, part: Part, place: Callable[[Place], iota.Vec3], turn: Quaternion, friction: float
    ) -> None:
        outer, inner, at = self.bodies[part.name], self.bodies[part.inner], place(part.joint)
        x, z = (turned(turn, iota.Vec3(*axis)) for axis in ((1, 0, 0), (0, 0, 1)))
        if part.is_fixed:
            inner.combine(outer)
            self.bodies[part.name] = inner
        elif part.bends:
            self.joints[part.name] = system.revolute(outer, inner, at=at, axis=x, limits=part.bends, friction=friction)
        elif part.sways:
            about_z = {"limits": part.sways[1], "friction": friction}
            self.joints[part.name] = system.universal(
                outer, inner, at=at, axis=x, second_axis=z, limits=part.sways[0], friction=friction, second_angle=about_z
            )  # fmt: skip
        else:
            nearest(inner, at).combine(nearest(outer, at))


def inside(part: Part, point: Place) -> Place:
    """A place of the figure in the frame of a part."""
    x, y, z, w = part.turn
    found = turned((-x, -y, -z, w), iota.Vec3(*point) - part.at)
    return found.x, found.y, found.z


def nearest(body: iota.Body, place: iota.Vec3) -> iota.Particle:
    """The attachment of a body that is nearest to a place."""
    return min(body.attachments, key=lambda particle: abs(particle.position - place))


def person(hook: Place) -> list[Part]:
    """A person of 1.75 m and 20 kg, as light as a mannequin, with its hips at the origin: eleven bodies. hook: where its chest can hang."""
    return [
        Part("hips", iota.Capsule(0.1, 0.14), 3.2, (0, 0, 0), ALONG),
        Part("chest", iota.Ellipsoid((0.42, 0.46, 0.25)), 6.0, (0, 0.26, 0), ALONG, "hips", (0, 0.14, 0),
             sways=((-0.4, 1.0), (-0.5, 0.5)), hangs=(hook,)),
        Part("head", iota.Capsule(0.095, 0.06), 1.4, (0, 0.63, 0.02), UPRIGHT, "chest", (0, 0.46, 0),
             sways=((-0.6, 0.7), (-0.6, 0.6))),
        Part("neck", iota.Capsule(0.045, 0.06), 0.2, (0, 0.5, 0), UPRIGHT, "head", is_fixed=True),
        *(part for side in (-1, 1) for part in limbs(side)),
    ]  # fmt: skip


def limbs(side: int) -> list[Part]:
    """An arm and a leg. side: 1 is the left one."""
    name, arm, leg = "left" if side > 0 else "right", 0.25 * side, 0.1 * side

    def outward(inner: float, outer: float) -> Range:
        return (-inner, outer) if side > 0 else (-outer, inner)

    return [
        Part(f"{name} arm", iota.Capsule(0.046, 0.19), 0.9, (arm, 0.27, 0), UPRIGHT, "chest", (arm, 0.38, 0),
             sways=((-2.8, 0.9), outward(0.1, 1.4))),
        Part(f"{name} hand", iota.Capsule(0.04, 0.27), 0.7, (arm, -0.01, 0), UPRIGHT, f"{name} arm", (arm, 0.15, 0),
             bends=(-2.3, 0.0)),
        Part(f"{name} thigh", iota.Capsule(0.072, 0.3), 1.8, (leg, -0.26, 0), UPRIGHT, "hips", (leg, -0.06, 0),
             sways=((-1.9, 0.4), outward(0.1, 0.8))),
        Part(f"{name} shank", iota.Capsule(0.052, 0.32), 1.0, (leg, -0.67, 0), UPRIGHT, f"{name} thigh", (leg, -0.47, 0),
             bends=(0.0, 2.3)),
        Part(f"{name} foot", iota.Capsule(0.045, 0.15), 0.3, (leg, -0.87, 0.06), AHEAD, f"{name} shank", is_fixed=True),
    ]  # fmt: skip
