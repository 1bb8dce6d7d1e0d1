# SPDX-License-Identifier: Apache-2.0
"""Questions about places: what a ray meets, what is nearest, what is within a distance, what a shape overlaps."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from iota._core import Body, Places, Shape, System, Vec3
from iota.world.parts import Part
from iota.world.scene import Scene
from iota.world.things import Rotation, unit_quaternion

Place = Sequence[float] | Vec3


@dataclass(frozen=True)
class Hit:
    """A place on the surface of a body. point: world, m. distance: from the start of the ray, or from the asked place, m;
    negative for a place inside."""

    body: Body
    point: Vec3
    distance: float


class Queries(Part):
    """Questions about places. They know the shapes of solid bodies exactly, rods, ropes and balls of particles by
    `Body.radius`, with which they are drawn. What is fixed is a static body: the ground, what `add_static`, `add_strut` and
    `drawings.model(..., solid=True)` made. Other drawings are not met. bodies: only these; None: all but inactive ones and
    sparks. A tree of boxes finds them, which follows the motion: each question takes some 0.01 ms about 10 000 bodies or in a
    room of 300 000 triangles, the first one after a step up to 1 ms if all of them move, and after bodies came or went 0.5
    ms. They raise TypeError for a World of another Simulator."""

    def __init__(self, system: System, scene: Scene) -> None:
        self._system, self._scene = system, scene
        self._places: Places | None = None

    def ray(
        self, origin: Place, direction: Place, farthest: float = math.inf, bodies: Iterable[Body] | None = None
    ) -> Hit | None:
        """The first thing that a ray meets, within `farthest` m; None without one. Raises ValueError for a direction of zero.

        hit = world.queries.ray(eye, (0, -1, 0))
        """
        return self._hit(self._index().ray(Vec3(*origin), Vec3(*direction), farthest, _listed(bodies)))

    def nearest(self, place: Place, bodies: Iterable[Body] | None = None) -> Hit | None:
        """The thing whose surface is nearest to a place; None in an empty world.

        hit = world.queries.nearest(hand, bodies=gears)  # of these only
        """
        return self._hit(self._index().nearest(Vec3(*place), _listed(bodies)))

    def within(self, place: Place, radius: float, bodies: Iterable[Body] | None = None) -> list[Body]:
        """The bodies of which a part is within `radius` m of a place: those that a ball there overlaps."""
        return self._index().within(Vec3(*place), radius, _listed(bodies))

    def overlap(
        self,
        shape: Shape,
        position: Place,
        rotation: Rotation = (0, 0, 0, 1),
        bodies: Iterable[Body] | None = None,
    ) -> list[Body]:
        """The bodies that a shape at a place would touch. shape: a convex one, as Box, Sphere, Capsule, Cylinder, Cone or
        Ellipsoid; ValueError for others. position: of its origin, m. rotation: see `Drawings.shape`. A torus among the bodies
        counts by triangles, within a hundredth of its wire.

        if not world.queries.overlap(iota.Box((0.6, 0.4, 0.4)), place): put_down(crate)
        """
        return self._index().overlap(shape, Vec3(*position), unit_quaternion(rotation), _listed(bodies))

    def _hit(self, found: tuple[Body, Vec3, float] | None) -> Hit | None:
        return None if found is None else Hit(*found)

    def _index(self) -> Places:
        if self._places is None:
            if not isinstance(self._system, System):
                raise TypeError("questions about places need a System; this world has a simulator of its own")
            self._places = Places(self._system)
        self._scene.keep_ground()
        return self._places


def _listed(bodies: Iterable[Body] | None) -> list[Body] | None:
    return None if bodies is None else list(bodies)
