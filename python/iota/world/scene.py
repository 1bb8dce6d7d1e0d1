# SPDX-License-Identifier: Apache-2.0
"""How bodies are drawn: builds the page's scene from the classes that the script gave them."""

from __future__ import annotations

import json
import warnings
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np

from iota._core import Body, Box, Mesh, Particle, Shape, Solid, System, Vec3
from iota.looks import Look, Looks, capsule, sphere
from iota.world import ties
from iota.world.frames import Quaternion, into_frame, relative_turn, turn_from_x, turned


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
    center, size = (low + high) / 2, max(float(np.linalg.norm(high - low)), 1.0)
    eye = center + size * np.array([0.6, 0.25, 1.2])
    return Camera(tuple(map(float, eye)), tuple(map(float, center)))


def is_solid(looks: Looks) -> bool:
    """Whether a class only says what bodies given by shape are made of (`looks.solid`)."""
    return any(look.shape is None for style in looks.values() for look in listed(style))


def listed(style: Look | list[Look]) -> list[Look]:
    return style if isinstance(style, list) else [style]


def solid_looks(
    shape: Shape, material: str, color: str | None, offset: list[float], rotation: list[float]
) -> list[Look]:
    """What the page draws for a solid: its shape; of a mesh that is too large, its box, with a warning."""
    if isinstance(shape, Mesh) and not len(shape.triangles):  # its triangles are with the system that it was made in
        return []
    try:
        return [Look(shape, material, color, offset, rotation)]
    except ValueError as error:
        warnings.warn(f"{error}; its box is drawn instead", stacklevel=2)
        assert isinstance(shape, Mesh)
        low, high = shape.vertices.min(axis=0), shape.vertices.max(axis=0)
        middle = Vec3(*offset) + turned(rotation, Vec3(*(low + high) / 2))
        return [Look(Box(tuple(high - low)), material, color, list(middle), rotation)]


class Scene:
    """Classes of bodies and their looks. `describe` gives the page's "bodies" and "classes"."""

    def __init__(self, system: System) -> None:
        self._system = system
        self._class_of: dict[Body, tuple[str, int]] = {}
        self.classes: dict[str, Looks] = {}
        self._thickness: float | None = None
        self._solid_names: dict[str, str] = {}

    def assign(self, bodies: Iterable[Body], name: str) -> None:
        for index, body in enumerate(bodies):
            self._class_of[body] = (name, index % 2)

    def describe(self) -> tuple[str, str]:
        """JSON texts of "classes" and "bodies"."""
        classes: dict[str, Any] = {**ties.default_looks(self._scale()), **self.classes}
        bodies = [self._describe_body(body, classes) for body in self._system.bodies if not body.is_spark]
        drawable = {name: looks for name, looks in classes.items() if not is_solid(looks)}
        return json.dumps(drawable, default=Look.describe, separators=(",", ":")), json.dumps(
            bodies, separators=(",", ":")
        )

    def _describe_body(self, body: Body, classes: dict[str, Any]) -> dict[str, Any]:
        particles = body.particles
        name, odd = self._class_of.get(body, (None, 0))
        kind = "dynamic" if body.kind == "resting" else body.kind  # drawn alike, and sent once
        entry: dict[str, Any] = {"body": body.slot, "odd": odd, "kind": kind}
        if len(particles) == 2:
            entry["length"] = abs(particles[1].position - particles[0].position)
        solids = body.solids
        if solids and (name is None or len(solids) > 1 or is_solid(classes.get(name, {}))):
            name = self._solid_class(body, solids, classes, name)
        elif name is None or (len(particles) > 2 and name in classes and not solids):
            name = self._own_class(body, particles, classes, name)
        entry["class"] = name
        return entry

    def _own_class(self, body: Body, particles: list[Particle], classes: dict[str, Any], base: str | None) -> str:
        """A class for one body: by its particles, in the style of the class it had."""
        thickness = self._scale()
        if len(particles) == 1:
            return self._particle_class(particles[0], thickness, classes)
        if len(particles) == 2:
            return self._shared("(rod)", capsule(thickness), classes)
        styles = classes.get(base or "", {"*": capsule(thickness)})
        name = f"(body {body.slot})"
        classes[name] = {look: self._compound(body, particles, style) for look, style in styles.items()}
        return name

    def _solid_class(self, body: Body, solids: list[Solid], classes: dict[str, Any], base: str | None) -> str:
        """A class for a body given by shape: its shapes where they are, in the materials of the class it had."""
        styles = classes.get(base or "", {"*": Look(None)})
        center, orientation = body.center_of_mass, body.orientation
        shapes = {look: self._solids(center, orientation, solids, style) for look, style in styles.items()}
        # Bodies of one shape share a class, so that the page draws them together.
        text = json.dumps(shapes, default=Look.describe)
        name = self._solid_names.setdefault(text, f"(solid {len(self._solid_names) + 1})")
        classes[name] = shapes
        return name

    def _solids(
        self, center: Vec3, orientation: Quaternion, solids: list[Solid], style: Look | list[Look]
    ) -> list[Look]:
        like = listed(style)[0]
        looks: list[Look] = []
        for solid in solids:
            offset = into_frame(solid.position, center, orientation)
            turn = relative_turn(orientation, solid.orientation)
            place = [round(v, 6) + 0.0 for v in offset], [round(v, 6) + 0.0 for v in turn]
            looks += solid_looks(solid.shape, like.material, like.color, *place)
        return looks

    def _particle_class(self, particle: Any, thickness: float, classes: dict[str, Any]) -> str:
        """A ball; one with attributes has its radius and color, in steps, so that many share a class."""
        if not getattr(particle, "has_attributes", False):
            return self._shared("(particle)", sphere(2 * thickness), classes)
        radius = float(f"{particle.radius:.1g}") or 2 * thickness
        red, green, blue = (round(c * 7) * 255 // 7 for c in particle.color[:3])
        color = f"#{red:02x}{green:02x}{blue:02x}"
        return self._shared(f"(particle {radius:g} {color})", sphere(radius, "paint", color=color), classes)

    @staticmethod
    def _shared(name: str, look: Look, classes: dict[str, Any]) -> str:
        classes.setdefault(name, {"*": look})
        return name

    def _compound(self, body: Body, particles: list[Particle], style: Look | list[Look]) -> list[Look]:
        """Capsules along the body's cosmetic bonds, or from particle to particle in their order where it has none."""
        like = listed(style)[0]
        radius = getattr(like.shape, "tube", None) or getattr(like.shape, "radius", None) or self._scale()
        lines = [(p, q) for p, q in self._system.cosmetic_lines if p.body == body and q.body == body]
        center, orientation = body.center_of_mass, body.orientation
        looks: list[Look] = []
        for p, q in lines or list(pairwise(particles)):
            start, end = (into_frame(r.position, center, orientation) for r in (p, q))
            length = abs(end - start)
            if length > 0:
                place, turn = (start + end) * 0.5, turn_from_x((end - start).unit())
                looks.append(
                    capsule(radius, like.material, length=length, offset=list(place), rotation=turn, color=like.color)
                )
        return looks or [sphere(radius, like.material, color=like.color)]

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
