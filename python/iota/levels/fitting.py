# SPDX-License-Identifier: Apache-2.0
"""Finds the nearest place at which bodies that come into the world overlap nothing."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from itertools import product

from iota._core import Body, Box, Capsule, Mesh, Places, Shape, Sphere, System, Torus, Vec3
from iota.frames import turn_from_x, turned

TOUCH = 1e-3  # m: nearer than this, what rests on something overlaps it
HALVINGS = 12  # of the way
Outline = tuple[Body, Shape, Vec3, Sequence[float]]  # of a body: a shape, its place and its orientation


def way_out(
    system: System, bodies: Sequence[Body], present: Collection[Body], extent: float, offset: Vec3 | None = None
) -> Vec3:
    """How far bodies have to be moved so that they overlap none of those of the system that they may touch, m: upwards if that is enough; zero
    if there is no such place within `extent`, m. bodies: perhaps of another system, and elsewhere by the offset, m. present: those of the
    system that do not count, as they are about to go."""
    start = offset or Vec3()
    places, outlines = Places(system), [each for body in bodies for each in _outlines(body)]
    passing, known = passing_pairs(system, bodies), dict[tuple[Body, Body], bool]()

    def is_free(way: Vec3) -> bool:
        for body, shape, place, turn in outlines:
            for other in places.overlap(shape, place + start + way, turn, None):
                if other in present:
                    continue
                if (body, other) not in known:
                    known[body, other] = frozenset((body, other)) not in passing and _may_touch(system, body, other)
                if known[body, other]:
                    return False
        return True

    if is_free(Vec3()):
        return Vec3()
    ways = list(_directions(system))
    if any(is_free(way * TOUCH) for way in ways):
        return Vec3()
    found: list[Vec3] = []
    for way in ways:
        far = extent
        if not is_free(way * far):
            continue
        near = 0.0
        for _ in range(HALVINGS):
            middle = (near + far) / 2
            near, far = (near, middle) if is_free(way * middle) else (middle, far)
        found.append(way * far)
        if way is ways[0]:
            break
    return min(found, key=abs, default=Vec3())


def _directions(system: System) -> Iterator[Vec3]:
    """Up, and then all others of a die's faces, edges and corners, but for those that lead down."""
    up = up_of(system)
    yield up
    for x, y, z in product((-1, 0, 1), repeat=3):
        way = Vec3(x, y, z)
        if abs(way) > 0 and way.dot(up) > -1e-9:
            yield way.unit()


def up_of(system: System) -> Vec3:
    """Against gravity."""
    return -system.gravity.unit() if abs(system.gravity) > 0 else Vec3(0, 1, 0)


def _outlines(body: Body) -> Iterator[Outline]:
    for solid in body.solids:
        shape, offset = _convex(solid.shape)
        yield body, shape, solid.position + turned(solid.orientation, offset), solid.orientation
    if body.solids:
        return
    particles, radius = body.particles, body.radius
    if radius <= 0:
        return
    if len(particles) == 2:
        p, q = (each.position for each in particles)
        if (length := abs(q - p)) > 0:
            yield body, Capsule(radius, length), (p + q) / 2, turn_from_x((q - p) / length)
            return
    for particle in particles:
        yield body, Sphere(radius), particle.position, (0, 0, 0, 1)


def _convex(shape: Shape) -> tuple[Shape, Vec3]:
    """A convex shape around another one, and where its middle is in that."""
    if isinstance(shape, Mesh):
        return Mesh.convex_hull(shape.vertices), Vec3()
    if isinstance(shape, Torus):
        low, high = shape.bounds
        return Box(list(high - low)), (low + high) / 2
    return shape, Vec3()


def passing_pairs(system: System, bodies: Sequence[Body]) -> set[frozenset[Body]]:
    """Pairs that pass through each other, of one of the bodies at least."""
    own, found = set(bodies), set[frozenset[Body]]()
    for pair in system.ignored_contacts:
        a, b = (
            {side} if isinstance(side, Body) else {p.body for p in side.particles} for side in pair if side is not None
        )
        found |= {frozenset((p, q)) for p in a & own for q in b} | {frozenset((p, q)) for p in b & own for q in a}
    return found


def _may_touch(system: System, body: Body, other: Body) -> bool:
    own, its = body.material or system.usual_material, other.material or system.usual_material
    if own is None or its is None:
        return False
    is_fixed = other.kind == "static"
    return own.touches in (("all", "obstacles") if is_fixed else ("all",)) and (
        its.touches == "all" or (is_fixed and its.touches == "obstacles")
    )


def work_of_gravity(system: System, mass: float, way: Vec3) -> float:
    """Work to lift a mass by a way, at least 0, J."""
    return max(0.0, -mass * system.gravity.dot(way))
