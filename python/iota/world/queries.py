# SPDX-License-Identifier: Apache-2.0
"""Questions about places: what a ray or a shape meets on its way, what is nearest, what a shape overlaps, how far two bodies are apart."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from iota._core import Body, Places, Shape, System, Vec3
from iota.arguments import SHORT
from iota.world.parts import Part
from iota.world.scene import Scene
from iota.world.things import Rotation, unit_quaternion

Place = Sequence[float] | Vec3
Rows = Sequence[Place] | Place | NDArray[np.float64]


@dataclass(frozen=True)
class Hit:
    """A place on the surface of a body. point: world, m. distance: from the start of the ray, or from the asked place, m;
    negative for a place inside."""

    body: Body
    point: Vec3
    distance: float


@dataclass(frozen=True)
class Hits:
    """Answers to n questions. slots: (n,), `Body.slot`, -1 without an answer. points: (n, 3), places on the surfaces, world, m.
    distances: (n,), m, as in `Hit`. Both are infinite without an answer."""

    slots: NDArray[np.int64]
    points: NDArray[np.float64]
    distances: NDArray[np.float64]


@dataclass(frozen=True)
class Gap:
    """Two bodies. distance: of their surfaces, m, 0 where they overlap. point, other_point: of each, the place that is nearest to
    the other one, world, m; where they overlap, one place that is in both or near it."""

    distance: float
    point: Vec3
    other_point: Vec3


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
        """The bodies that a shape at a place would touch. shape: a convex one, as Box, Sphere, Capsule, Cylinder, Cone,
        Ellipsoid or Mesh.convex_hull; ValueError for others. position: of its origin, m. rotation: see `Drawings.shape`. A torus among the bodies
        counts by triangles, within a hundredth of its wire.

        if not world.queries.overlap(iota.Box((0.6, 0.4, 0.4)), place): put_down(crate)
        """
        return self._index().overlap(shape, Vec3(*position), unit_quaternion(rotation), _listed(bodies))

    def cast(
        self,
        shape: Shape,
        position: Place,
        direction: Place,
        farthest: float = math.inf,
        rotation: Rotation = (0, 0, 0, 1),
        bodies: Iterable[Body] | None = None,
    ) -> Hit | None:
        """The first thing that a shape meets which goes straight, without turning, at most `farthest` m; None without one. The
        hit has the place where they touch, and how far the shape goes: 0 if it overlaps the body where it begins. shape, position,
        rotation: see `overlap`. Raises ValueError for a direction of zero.

        hit = world.queries.cast(iota.Sphere(0.3), eye, looking, farthest=10)  # room for a head
        """
        return self._hit(
            self._index().cast(
                shape, Vec3(*position), Vec3(*direction), farthest, unit_quaternion(rotation), _listed(bodies)
            )
        )

    def gap(self, body: Body, other: Body) -> Gap:
        """How far two bodies are apart, and where they are nearest to each other. Shapes count as in `overlap`. Raises ValueError
        for one body with itself. The force between two that touch is `Body.force_from`.

        if world.queries.gap(gripper, part).distance < 0.01: slow_down()
        """
        return Gap(*self._index().gap(body, other))

    def rays(
        self,
        origins: Rows,
        directions: Rows,
        farthest: float = math.inf,
        bodies: Iterable[Body] | None = None,
    ) -> Hits:
        """Many rays, several times as fast as `ray` for each. origins, directions: (n, 3), or (3,) for one that all have.

        ways = np.c_[np.cos(angles), 0 * angles, np.sin(angles)]
        depths = world.queries.rays(scanner.position, ways, farthest=20).distances
        """
        starts, ways = _rows(origins), _rows(directions)
        if len(starts) != len(ways) and 1 not in (len(starts), len(ways)):
            raise ValueError(f"rays need a direction for each origin, or one for all: {len(starts)} and {len(ways)}")
        starts, ways = np.broadcast_arrays(starts, ways)
        return Hits(*self._index().rays(starts, ways, len(starts), farthest, _listed(bodies)))

    def nearest_each(self, places: Rows, bodies: Iterable[Body] | None = None) -> Hits:
        """The nearest thing of each of many places, several times as fast as `nearest` for each. places: (n, 3)."""
        rows = _rows(places)
        return Hits(*self._index().nearest_each(rows, len(rows), _listed(bodies)))

    def _hit(self, found: tuple[Body, Vec3, float] | None) -> Hit | None:
        return None if found is None else Hit(*found)

    def _index(self) -> Places:
        if self._places is None:
            if not isinstance(self._system, System):
                raise TypeError("questions about places need a System; this world has a simulator of its own")
            self._places = Places(self._system)
        self._scene.find_ground()
        return self._places


def _rows(vectors: Rows) -> NDArray[np.float64]:
    """(n, 3), also of one vector."""
    try:
        rows = np.atleast_2d(np.asarray(vectors, float))
    except (TypeError, ValueError):
        raise ValueError(
            f"places and directions must be rows of three numbers, (n, 3), not {SHORT.repr(vectors)}"
        ) from None
    if rows.ndim != 2 or rows.shape[1] != 3:
        raise ValueError(f"places and directions must be rows of three numbers, (n, 3), not of the shape {rows.shape}")
    if not np.isfinite(rows).all():
        raise ValueError("places and directions must be finite")
    return rows


def _listed(bodies: Iterable[Body] | None) -> list[Body] | None:
    return None if bodies is None else list(bodies)
