# SPDX-License-Identifier: Apache-2.0
"""How bodies are drawn: builds the page's scene from the classes that the script gave them."""

from __future__ import annotations

import json
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np

from iota._core import Body, Particle, System, Vec3
from iota.looks import Looks, Shape, capsule, sphere

Quaternion = Sequence[float]


@dataclass(frozen=True)
class Camera:
    """Where a viewer starts: eye and point looked at, m."""

    position: Sequence[float] = (2.5, 1.6, 3.5)
    target: Sequence[float] = (0.0, 1.2, 0.0)


def fitting_camera(system: System) -> Camera:
    """Sees all particles from the front, a little from the side and above."""
    places = system.positions
    if not len(places):
        return Camera()
    low, high = places.min(axis=0), places.max(axis=0)
    centre, size = (low + high) / 2, max(float(np.linalg.norm(high - low)), 1.0)
    eye = centre + size * np.array([0.6, 0.25, 1.2])
    return Camera(tuple(map(float, eye)), tuple(map(float, centre)))


def into_frame(point: Vec3, centre: Vec3, orientation: Quaternion) -> Vec3:
    """World place -> the body's drawn frame."""
    x, y, z, w = orientation
    axis, arm = Vec3(-x, -y, -z), point - centre
    twice = axis.cross(arm) * 2.0
    return arm + twice * w + axis.cross(twice)


def turn_from_x(direction: Vec3) -> tuple[float, float, float, float]:
    """The shortest rotation that takes +x to a unit vector, as a quaternion x y z w."""
    if direction.x < -0.999999:
        return (0.0, 0.0, 1.0, 0.0)
    w = ((1 + direction.x) / 2) ** 0.5
    axis = Vec3(1, 0, 0).cross(direction) * (0.5 / w)
    return (axis.x, axis.y, axis.z, w)


class Scene:
    """Classes of bodies and their looks. `describe` gives the page's "bodies" and "classes"."""

    def __init__(self, system: System) -> None:
        self._system = system
        self._class_of: dict[Body, tuple[str, int]] = {}
        self.classes: dict[str, Looks] = {}
        self._thickness: float | None = None

    def assign(self, bodies: Iterable[Body], name: str) -> None:
        for index, body in enumerate(bodies):
            self._class_of[body] = (name, index % 2)

    def describe(self) -> tuple[str, str]:
        """JSON texts of "classes" and "bodies"."""
        classes: dict[str, Any] = dict(self.classes)
        bodies = [self._describe_body(body, classes) for body in self._system.bodies]
        return json.dumps(classes, separators=(",", ":")), json.dumps(bodies, separators=(",", ":"))

    def _describe_body(self, body: Body, classes: dict[str, Any]) -> dict[str, Any]:
        particles = body.particles
        name, odd = self._class_of.get(body, (None, 0))
        entry: dict[str, Any] = {"body": body.slot, "odd": odd, "kind": body.kind}
        if len(particles) == 2:
            entry["length"] = abs(particles[1].position - particles[0].position)
        if name is None or (len(particles) > 2 and name in classes):
            name = self._own_class(body, particles, classes, name)
        entry["class"] = name
        return entry

    def _own_class(self, body: Body, particles: list[Particle], classes: dict[str, Any], base: str | None) -> str:
        """A class for one body: by its particles, in the style of the class it had."""
        thickness = self._scale()
        if len(particles) == 1:
            return self._shared("(particle)", sphere(2 * thickness), classes)
        if len(particles) == 2:
            return self._shared("(rod)", capsule(thickness), classes)
        styles = classes.get(base or "", {"*": capsule(thickness)})
        name = f"(body {body.slot})"
        classes[name] = {look: self._compound(body, particles, style) for look, style in styles.items()}
        return name

    @staticmethod
    def _shared(name: str, shape: Shape, classes: dict[str, Any]) -> str:
        classes.setdefault(name, {"*": shape})
        return name

    def _compound(self, body: Body, particles: list[Particle], style: Shape | list[Shape]) -> list[Shape]:
        """Capsules along the body's cosmetic bonds, or from particle to particle in their order where it has none."""
        like = style[0] if isinstance(style, list) else style
        radius = float(like.get("tube") or like.get("radius") or self._scale())
        more = {"color": like["color"]} if "color" in like else {}
        lines = [(p, q) for p, q in self._system.cosmetic_lines if p.body == body and q.body == body]
        centre, orientation = body.centre_of_mass, body.orientation
        shapes: list[Shape] = []
        for p, q in lines or list(pairwise(particles)):
            start, end = (into_frame(r.position, centre, orientation) for r in (p, q))
            length = abs(end - start)
            if length > 0:
                place, turn = (start + end) * 0.5, turn_from_x((end - start).unit())
                shapes.append(
                    capsule(radius, like["material"], length=length, offset=list(place), rotation=turn, **more)
                )
        return shapes or [sphere(radius, like["material"], **more)]

    def _scale(self) -> float:
        """A radius that suits rods of this system, m: taken once, from their middle length."""
        if self._thickness is None:
            lengths = sorted(
                abs(ps[0].position - ps[1].position) for b in self._system.bodies if len(ps := b.particles) == 2
            )
            if lengths and lengths[len(lengths) // 2] > 0:
                self._thickness = 0.06 * lengths[len(lengths) // 2]
            else:
                places = self._system.positions
                extent = float(np.linalg.norm(np.ptp(places, axis=0))) if len(places) else 0.0
                self._thickness = 0.02 * extent if extent > 0 else 0.03
        return self._thickness
