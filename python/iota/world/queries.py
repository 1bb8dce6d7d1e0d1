# SPDX-License-Identifier: Apache-2.0
"""Questions about places: what a ray meets, what is nearest, what is within a distance, what a shape overlaps."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

from iota._core import Body, HalfSpace, Places, Shape, System, Vec3
from iota.looks import Look
from iota.world.parts import Part
from iota.world.scene import Scene, Static
from iota.world.shown import Surface
from iota.world.things import Things, unit_quaternion, vector

Place = Sequence[float] | Vec3
Fixed = Static | Surface


@dataclass(frozen=True)
class Hit:
    """A place on a surface. body: None where it is something fixed. point: world, m. distance: from the start of the ray, or
    from the asked place, m; negative for a place inside. fixed: what `add_static`, `add_strut`, `surface` or `model`
    returned, or the ground, a Static of a HalfSpace; None on a body."""

    body: Body | None
    point: Vec3
    distance: float
    fixed: Fixed | None = None


class Queries(Part):
    """Questions about places. They know the shapes of solid bodies exactly, rods, ropes and balls of particles by
    `Body.radius`, with which they are drawn; and what is fixed without physics: the ground, shapes of `add_static` and
    `add_strut`, surfaces and models at a place of the world. Other drawn things are not met. bodies: only these;
    None: all but inactive ones and sparks, and all that is fixed. A tree of boxes finds them, which follows the motion:
    each question takes some 0.01 ms about 10 000 bodies or in a room of 300 000 triangles, the first one after a
    step up to 1 ms if all of them move, and after bodies came or went 0.5 ms. They raise TypeError for a World of another Simulator."""

    def __init__(self, system: System, scene: Scene, things: Things) -> None:
        self._system, self._scene, self._things = system, scene, things
        self._places: Places | None = None
        self._numbers: dict[Fixed, tuple[int, tuple[Any, ...]]] = {}  # among the places; with the contents of then
        self._fixed: dict[int, Fixed] = {}  # by number
        self._fixed_as_of: Any = None
        self._ground: Static | None = None

    def ray(
        self, origin: Place, direction: Place, farthest: float = math.inf, bodies: Iterable[Body] | None = None
    ) -> Hit | None:
        """The first thing that a ray meets, within `farthest` m; None without one. Raises ValueError for a direction of zero.

        hit = world.queries.ray(eye, (0, -1, 0))
        """
        return self._hit(self._index().ray(Vec3(*origin), Vec3(*direction), farthest, _listed(bodies)))

    def nearest(self, place: Place, bodies: Iterable[Body] | None = None) -> Hit | None:
        """The thing whose surface is nearest to a place; None in an empty world.

        hit = world.queries.nearest(hand, bodies=world.system.bodies)  # not the ground
        """
        return self._hit(self._index().nearest(Vec3(*place), _listed(bodies)))

    def within(self, place: Place, radius: float, bodies: Iterable[Body] | None = None) -> list[Body]:
        """The bodies of which a part is within `radius` m of a place: those that a ball there overlaps."""
        return self._index().within(Vec3(*place), radius, _listed(bodies))

    def overlap(
        self,
        shape: Shape,
        position: Place,
        rotation: Sequence[float] = (0, 0, 0, 1),
        bodies: Iterable[Body] | None = None,
    ) -> list[Body | Fixed]:
        """Everything that a shape at a place would touch: bodies, then fixed shapes. shape: a convex one, as Box, Sphere, Capsule,
        Cylinder, Cone or Ellipsoid; ValueError for others. position: of its origin, m. rotation: quaternion x y z w. A torus
        among the bodies counts by triangles, within a hundredth of its wire.

        if not world.queries.overlap(iota.Box((0.6, 0.4, 0.4)), place): put_down(crate)
        """
        index = self._index()
        found = index.overlap(shape, Vec3(*position), unit_quaternion(rotation), _listed(bodies))
        return [self._fixed[each] if isinstance(each, int) else each for each in found]

    def _hit(self, found: tuple[Body | int, Vec3, float] | None) -> Hit | None:
        if found is None:
            return None
        what, point, distance = found
        if isinstance(what, int):
            return Hit(None, point, distance, self._fixed[what])
        return Hit(what, point, distance)

    def _index(self) -> Places:
        scene = self._scene
        if self._places is None:
            if not isinstance(self._system, System):
                raise TypeError("questions about places need a System; this world has a simulator of its own")
            self._places = Places(self._system)
        as_of = (len(scene.statics), scene.ground, self._things.changes[Surface])
        if as_of != self._fixed_as_of:
            self._fixed_as_of = as_of
            self._know_fixed(self._places)
        return self._places

    def _know_fixed(self, places: Places) -> None:
        """Adds what is new, and removes what is gone: a large room beside a surface that changes stays as it is."""
        wanted = self._wanted()
        for fixed, (number, content) in list(self._numbers.items()):
            if fixed not in wanted or any(a is not b for a, b in zip(content, wanted[fixed], strict=True)):
                places.remove_fixed(number)
                del self._numbers[fixed]
        for fixed, content in wanted.items():
            if fixed not in self._numbers:
                self._numbers[fixed] = (_add(places, fixed), content)
        self._fixed = {number: fixed for fixed, (number, _) in self._numbers.items()}

    def _wanted(self) -> dict[Fixed, tuple[Any, ...]]:
        """All that is fixed, each with what makes it another one if it is assigned anew."""
        scene = self._scene
        wanted: dict[Fixed, tuple[Any, ...]] = {each: () for each in scene.statics if each.look.shape is not None}
        if scene.ground is not None:
            if self._ground is None or self._ground.position.y != scene.ground:
                self._ground = Static(Look(HalfSpace((0, 1, 0))), Vec3(0, scene.ground, 0))
            wanted[self._ground] = ()
        for thing in self._things:
            if isinstance(thing, Surface) and thing.visible and thing.is_in_world:
                wanted[thing] = (thing.points, thing.triangles, thing.at)
        return wanted


def _add(places: Places, fixed: Fixed) -> int:
    if isinstance(fixed, Surface):
        return places.add_fixed_surface(fixed.points, fixed.triangles, vector(fixed.at))
    assert fixed.look.shape is not None
    return places.add_fixed(fixed.look.shape, fixed.position, fixed.rotation)


def _listed(bodies: Iterable[Body] | None) -> list[Body] | None:
    return None if bodies is None else list(bodies)
