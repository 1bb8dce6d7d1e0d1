# SPDX-License-Identifier: Apache-2.0
"""Johnson solids (Johnson, Convex polyhedra with regular faces, 1966): caps and belts set on each other, pieces added to,
turned on and cut from uniform polyhedra. All edges have length 1. Those outside of these families (J84 to J92) are
roots of equations; the first four of them are included."""

from __future__ import annotations

import math
from collections.abc import Callable
from itertools import combinations
from typing import TYPE_CHECKING, Any

import numpy as np

from iota.shapelib.convex import hull
from iota.shapelib.surface import Surface
from iota.shapelib.uniform import uniform, uniform_points

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Array = NDArray[Any]  # of float64; sums and products of NumPy are typed loosely


def ring(n: int, height: float = 0.0, turn: float = 0.0) -> Array:
    """A regular polygon normal to z; at turn 0 one edge faces +x."""
    radius = 1 / (2 * math.sin(math.pi / n))
    angle = (2 * np.arange(n) + 1) * math.pi / n + turn
    return np.stack([radius * np.cos(angle), radius * np.sin(angle), np.full(n, height)], axis=1)


def pyramid(n: int) -> Array:
    """Its apex, over a ring of n at height 0."""
    return np.array([[0, 0, math.sqrt(1 - 1 / (4 * math.sin(math.pi / n) ** 2))]])


def cupola(n: int) -> Array:
    """Its smaller polygon, over a ring of 2 n at height 0. One of 2 is a wedge."""
    return ring(n, math.sqrt(1 - 1 / (4 * math.sin(math.pi / n) ** 2)))


def rotunda(_: int = 5) -> Array:
    """Half an icosidodecahedron, over a ring of 10 at height 0."""
    points = uniform_points("icosidodecahedron")
    face = next(face for face in uniform("icosidodecahedron").faces if len(face) == 5)
    own = hull(points).vertices
    z = own[face].mean(axis=0)
    z /= np.linalg.norm(z)
    y = own[face[0]] - own[face[1]]  # normal to an edge
    y /= np.linalg.norm(y)
    turned = own @ np.stack([np.cross(y, z), y, z], axis=1)
    return np.asarray(turned[turned[:, 2] > 1e-6])


CAPS: dict[str, tuple[Callable[[int], Array] | None, int]] = {
    "": (None, 1), "pyramid": (pyramid, 1), "cupola": (cupola, 2), "rotunda": (rotunda, 2),
}  # fmt: skip

# number: n, cap above, belt, cap below, whether the lower cap is turned by half a step relative to the mirror image
STACKS: dict[int, tuple[int, str, str, str, bool]] = {
    1: (4, "pyramid", "", "", False), 2: (5, "pyramid", "", "", False), 3: (3, "cupola", "", "", False),
    4: (4, "cupola", "", "", False), 5: (5, "cupola", "", "", False), 6: (5, "rotunda", "", "", False),
    7: (3, "pyramid", "prism", "", False), 8: (4, "pyramid", "prism", "", False),
    9: (5, "pyramid", "prism", "", False), 10: (4, "pyramid", "antiprism", "", False),
    11: (5, "pyramid", "antiprism", "", False), 12: (3, "pyramid", "", "pyramid", False),
    13: (5, "pyramid", "", "pyramid", False), 14: (3, "pyramid", "prism", "pyramid", False),
    15: (4, "pyramid", "prism", "pyramid", False), 16: (5, "pyramid", "prism", "pyramid", False),
    17: (4, "pyramid", "antiprism", "pyramid", False), 18: (3, "cupola", "prism", "", False),
    19: (4, "cupola", "prism", "", False), 20: (5, "cupola", "prism", "", False),
    21: (5, "rotunda", "prism", "", False), 22: (3, "cupola", "antiprism", "", False),
    23: (4, "cupola", "antiprism", "", False), 24: (5, "cupola", "antiprism", "", False),
    25: (5, "rotunda", "antiprism", "", False), 26: (2, "cupola", "", "cupola", True),
    27: (3, "cupola", "", "cupola", False), 28: (4, "cupola", "", "cupola", False),
    29: (4, "cupola", "", "cupola", True), 30: (5, "cupola", "", "cupola", False),
    31: (5, "cupola", "", "cupola", True), 32: (5, "cupola", "", "rotunda", False),
    33: (5, "cupola", "", "rotunda", True), 34: (5, "rotunda", "", "rotunda", False),
    35: (3, "cupola", "prism", "cupola", False), 36: (3, "cupola", "prism", "cupola", True),
    37: (4, "cupola", "prism", "cupola", True), 38: (5, "cupola", "prism", "cupola", False),
    39: (5, "cupola", "prism", "cupola", True), 40: (5, "cupola", "prism", "rotunda", False),
    41: (5, "cupola", "prism", "rotunda", True), 42: (5, "rotunda", "prism", "rotunda", False),
    43: (5, "rotunda", "prism", "rotunda", True), 44: (3, "cupola", "antiprism", "cupola", False),
    45: (4, "cupola", "antiprism", "cupola", False), 46: (5, "cupola", "antiprism", "cupola", False),
    47: (5, "cupola", "antiprism", "rotunda", False), 48: (5, "rotunda", "antiprism", "rotunda", False),
}  # fmt: skip

# number: base, which faces of how many corners get a cap; faces are chosen by their arrangement, see `_choose`
AUGMENTED: dict[int, tuple[str, int, int, str]] = {
    49: ("prism 3", 4, 1, ""), 50: ("prism 3", 4, 2, ""), 51: ("prism 3", 4, 3, ""), 52: ("prism 5", 4, 1, ""),
    53: ("prism 5", 4, 2, "meta"), 54: ("prism 6", 4, 1, ""), 55: ("prism 6", 4, 2, "para"),
    56: ("prism 6", 4, 2, "meta"), 57: ("prism 6", 4, 3, "meta"), 58: ("dodecahedron", 5, 1, ""),
    59: ("dodecahedron", 5, 2, "para"), 60: ("dodecahedron", 5, 2, "meta"), 61: ("dodecahedron", 5, 3, "meta"),
    65: ("truncated tetrahedron", 6, 1, ""), 66: ("truncated cube", 8, 1, ""), 67: ("truncated cube", 8, 2, "para"),
    68: ("truncated dodecahedron", 10, 1, ""), 69: ("truncated dodecahedron", 10, 2, "para"),
    70: ("truncated dodecahedron", 10, 2, "meta"), 71: ("truncated dodecahedron", 10, 3, "meta"),
}  # fmt: skip

# number: how many caps of the rhombicosidodecahedron are turned, how many cut off, their arrangement
GYRATED: dict[int, tuple[int, int, str]] = {
    72: (1, 0, ""), 73: (2, 0, "para"), 74: (2, 0, "meta"), 75: (3, 0, "meta"), 76: (0, 1, ""), 77: (1, 1, "para"),
    78: (1, 1, "meta"), 79: (2, 1, "meta"), 80: (0, 2, "para"), 81: (0, 2, "meta"), 82: (1, 2, "meta"), 83: (0, 3, "meta"),
}  # fmt: skip

LAST = 87


def johnson(number: int) -> Surface:
    """J1 to J87, in Johnson's numbering. Raises ValueError."""
    if number in STACKS:
        return hull(_stacked(*STACKS[number]))
    if number in AUGMENTED:
        name, corners, count, how = AUGMENTED[number]
        base = hull(prism(int(name[6:]))) if name.startswith("prism") else uniform(name)
        faces = [face for face in range(len(base.faces)) if len(base.faces[face]) == corners]
        normals = np.array([_normal(base, face) for face in faces])
        return _augmented(base, [faces[i] for i in _choose(normals, count, how)])
    if number in GYRATED:
        return _gyrated(*GYRATED[number])
    if number in (62, 63, 64):
        points = uniform_points("icosahedron")
        off = _choose(points / np.linalg.norm(points, axis=1)[:, None], 2 if number == 62 else 3, "meta")
        solid = hull(np.delete(points, off, axis=0))
        if number < 64:
            return solid
        pentagons = [set(face) for face in solid.faces if len(face) == 5]
        middle = next(
            at for at, face in enumerate(solid.faces) if all(len(five & set(face)) == 2 for five in pentagons)
        )
        return _augmented(solid, [middle])
    if number in ROOTS:
        return ROOTS[number]()
    raise ValueError(f"Johnson solids are computed from J1 to J{LAST}, not J{number}")


def prism(n: int) -> Array:
    """Its corners, about the origin."""
    return np.concatenate([ring(n, 0.5), ring(n, -0.5)])


def antiprism(n: int) -> Array:
    """Its corners, about the origin."""
    height = math.sqrt(1 - 1 / (4 * math.cos(math.pi / (2 * n)) ** 2)) / 2
    return np.concatenate([ring(n, height), ring(n, -height, math.pi / n)])


def _stacked(n: int, above: str, belt: str, below: str, is_turned: bool) -> Array:
    make, times = CAPS[above]
    sides = n * times
    twist, depth = 0.0, 0.0
    rings = [ring(sides)]
    if belt == "prism":
        depth = 1.0
    elif belt == "antiprism":
        depth, twist = math.sqrt(1 - 1 / (4 * math.cos(math.pi / (2 * sides)) ** 2)), math.pi / sides
    if belt:
        rings.append(ring(sides, -depth, twist))
    assert make is not None
    parts = [make(n), *rings]
    other, _ = CAPS[below]
    if other is not None:
        cap = other(n) * [1, 1, -1]
        turn = twist + (math.pi / n if is_turned else 0.0)
        c, s = math.cos(turn), math.sin(turn)
        parts.append(cap @ np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]]) - [0, 0, depth])
    return np.concatenate(parts)


def _normal(surface: Surface, face: int) -> Array:
    a, b, c = surface.vertices[surface.faces[face][:3]]
    normal = np.cross(b - a, c - a)
    return np.asarray(normal / np.linalg.norm(normal))


def _choose(directions: Array, count: int, how: str) -> list[int]:
    """A number of the directions: "para", opposite ones; "meta", the nearest ones that are neither neighbors nor
    opposite; "", any."""
    dots = directions @ directions.T
    nearest = np.sort(dots, axis=1)[:, -2].max()
    for chosen in combinations(range(len(directions)), count):
        between = [dots[i, j] for i, j in combinations(chosen, 2)]
        if how == "para" and not all(dot < -0.999 for dot in between):
            continue
        if how == "meta" and not all(-0.999 < dot < nearest - 1e-3 for dot in between):
            continue
        return list(chosen)
    raise AssertionError((count, how))


def _augmented(base: Surface, faces: list[int]) -> Surface:
    """A pyramid on faces of up to five corners, a cupola on larger ones: its squares at the triangles around."""
    points = [base.vertices]
    for at in faces:
        face = base.faces[at]
        n = len(face)
        corners, normal = base.vertices[face], _normal(base, at)
        middle = corners.mean(axis=0)
        if n <= 5:
            points.append(middle + pyramid(n)[0, 2] * normal[None])
            continue
        triangle = next(
            i for i in range(n)
            if any(len(other) == 3 and {face[i], face[(i + 1) % n]} <= set(other) for other in base.faces)
        )  # fmt: skip
        x = (corners[triangle] + corners[(triangle + 1) % n]) / 2 - middle
        x /= np.linalg.norm(x)
        points.append(middle + cupola(n // 2) @ np.stack([x, np.cross(normal, x), normal]))
    return hull(np.concatenate(points))


def _gyrated(turned: int, cut: int, how: str) -> Surface:
    solid = uniform("rhombicosidodecahedron")
    faces = [face for face in solid.faces if len(face) == 5]
    axes = np.array([solid.vertices[face].mean(axis=0) for face in faces])
    axes /= np.linalg.norm(axes, axis=1)[:, None]
    chosen = _choose(axes, turned + cut, how)
    points = solid.vertices.copy()
    for number in chosen[:turned]:
        axis, own = axes[number], points[faces[number]]
        along = np.outer(own @ axis, axis)
        c, s = math.cos(math.pi / 5), math.sin(math.pi / 5)
        points[faces[number]] = along + c * (own - along) + s * np.cross(axis, own)
    off = [vertex for number in chosen[turned:] for vertex in faces[number]]
    return hull(np.delete(points, off, axis=0))


# --- roots of equations -----------------------------------------------------------------------------------------------


def _root(polynomial: list[float], near: float) -> float:
    """The real root of a polynomial, highest power first, that is nearest to a number."""
    roots = np.roots(polynomial)
    real = roots[np.abs(roots.imag) < 1e-9].real
    return float(real[np.argmin(np.abs(real - near))])


def _snub_disphenoid() -> Surface:
    q = _root([2, 11, 4, -1], 0.169)
    r, s, t = math.sqrt(q), math.sqrt((1 - q) / (2 * q)), math.sqrt(2 - 2 * q)
    points = [(t, r, 0), (-t, r, 0), (0, -r, t), (0, -r, -t), (1, -s, 0), (-1, -s, 0), (0, s, 1), (0, s, -1)]
    return hull(np.array(points) / 2)


def _snub_square_antiprism() -> Surface:
    """Two squares and, between them, two rings of four: its three unknown lengths by Newton's method."""

    def rings(unknown: Array) -> Array:
        radius, outer, inner = unknown
        corner = math.sqrt(0.5)
        quarter = np.arange(4) * math.pi / 2

        def level(r: float, z: float, turn: float) -> Array:
            return np.stack([r * np.cos(quarter + turn), r * np.sin(quarter + turn), np.full(4, z)], axis=1)

        return np.concatenate(
            [
                level(corner, outer, 0), level(radius, inner, math.pi / 4), level(radius, -inner, 0),
                level(corner, -outer, math.pi / 4),
            ]
        )  # fmt: skip

    def miss(unknown: Array) -> Array:
        p = rings(unknown)
        return np.array([np.linalg.norm(p[a] - p[b]) - 1 for a, b in ((0, 4), (0, 8), (4, 8))])

    unknown = np.array([1.1, 0.7, 0.2])
    for _ in range(60):
        now = miss(unknown)
        slope = np.stack([(miss(unknown + 1e-7 * e) - now) / 1e-7 for e in np.eye(3)], axis=1)
        unknown = unknown - np.linalg.solve(slope, now)
    return hull(rings(unknown))


def _sphenocorona() -> Surface:
    k = _root([60, -48, -100, 56, 23], 0.85273)
    u = math.sqrt(1 - k * k)
    quarter = [
        (0, 1, 2 * u), (2 * k, 1, 0), (0, 1 + math.sqrt(3 - 4 * k * k) / u, (1 - 2 * k * k) / u),
        (1, 0, -math.sqrt(2 + 4 * k - 4 * k * k)),
    ]  # fmt: skip
    return hull(np.array([(sx * x, sy * y, z) for x, y, z in quarter for sx in (1, -1) for sy in (1, -1)]) / 2)


def _augmented_sphenocorona() -> Surface:
    solid = _sphenocorona()
    return _augmented(solid, [next(at for at, face in enumerate(solid.faces) if len(face) == 4)])


ROOTS: dict[int, Callable[[], Surface]] = {
    84: _snub_disphenoid, 85: _snub_square_antiprism, 86: _sphenocorona, 87: _augmented_sphenocorona,
}  # fmt: skip
