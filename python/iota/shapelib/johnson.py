# SPDX-License-Identifier: Apache-2.0
"""Johnson solids (Johnson, Convex polyhedra with regular faces, 1966): caps and belts set on each other, pieces added to,
turned on and cut from uniform polyhedra. All edges have length 1. Those outside of these families (J84 to J92) are
roots of equations: coordinates that make edges 1 long, by Newton's method."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
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

LAST = 92


def johnson(number: int) -> Surface:
    """J1 to J92, in Johnson's numbering. Raises ValueError."""
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
    if number in MADE:
        return MADE[number]()
    raise ValueError(f"there are Johnson solids from J1 to J{LAST}, not J{number}")


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

Place = tuple[float, float, float]
GOLDEN = (1 + math.sqrt(5)) / 2


@dataclass(frozen=True)
class Solved:
    """Corners by letters, as functions of unknowns; `near`: what these are nearly. Each edge, two letters, is an
    equation: its length is 1. Mirrors in x = 0 and y = 0 give the other corners, and, with `turns`, turning by a full
    turn over that number with z reversed."""

    corners: Callable[..., dict[str, Place]]
    edges: str
    near: tuple[float, ...]
    turns: int = 1

    def surface(self) -> Surface:
        def miss(unknown: Array) -> Array:
            at = {name: np.array(place) for name, place in self.corners(*unknown).items()}
            return np.array([np.linalg.norm(at[edge[0]] - at[edge[1]]) - 1 for edge in self.edges.split()])

        unknown = np.array(self.near)
        for _ in range(12):
            slope = [(miss(unknown + 1e-6 * e) - miss(unknown - 1e-6 * e)) / 2e-6 for e in np.eye(len(unknown))]
            unknown = unknown - np.linalg.solve(np.stack(slope, axis=1), miss(unknown))
        return hull(_images(list(self.corners(*unknown).values()), self.turns))


def _images(places: list[Place], turns: int) -> Array:
    """The images of corners under the symmetry that `Solved` describes."""
    points = np.array([[sx * x, sy * y, z] for x, y, z in places for sx in (1, -1) for sy in (1, -1)])
    found = []
    for turn in range(turns):
        c, s = math.cos(2 * math.pi * turn / turns), math.sin(2 * math.pi * turn / turns)
        found.append(points @ np.array([[c, s, 0], [-s, c, 0], [0, 0, (-1) ** turn]]))
    return np.concatenate(found)


DIAGONAL = math.sqrt(0.5)
SOLVED: dict[int, Solved] = {
    # Snub disphenoid.
    84: Solved(
        lambda s, t, r: {"A": (0.5, 0, -s), "B": (t, 0, r), "C": (0, t, -r)}, "AB AC BC", (0.78, 0.64, 0.21), turns=4
    ),
    # Snub square antiprism.
    85: Solved(
        lambda u, r, v: {"A": (DIAGONAL, 0, u), "B": (DIAGONAL * r, DIAGONAL * r, v), "C": (r, 0, -v)}, "AB AC BC",
        (0.7, 1.1, 0.2), turns=8,
    ),
    # Sphenocorona.
    86: Solved(
        lambda k, u, p, q, d: {"A": (0, 0.5, u), "B": (k, 0.5, 0), "C": (0, p, q), "D": (0.5, 0, d)}, "AB AC BC BD CD",
        (0.85, 0.52, 0.79, -0.43, -0.79),
    ),
    # Sphenomegacorona.
    88: Solved(
        lambda k, u, p, q, d, s, t: {
            "A": (0, 0.5, u), "B": (k, 0.5, 0), "C": (0, p, q), "D": (0.5, 0, d), "E": (0, s, t),
        },
        "AB AC BC BD CE BE DE", (0.59, 0.8, 1.28, 0.18, -0.86, 0.85, -0.72),
    ),
    # Hebesphenomegacorona.
    89: Solved(
        lambda k, u, p, q, d, s, t: {
            "A": (0.5, 0.5, u), "B": (0.5 + k, 0.5, 0), "C": (0, p, q), "D": (0.5, 0, d), "E": (0, s, t),
        },
        "AB AC BC BD CE BE DE", (0.22, 0.98, 1.1, 0.35, -0.84, 0.84, -0.61),
    ),
    # Disphenocingulum; D and E are images of A and C.
    90: Solved(
        lambda a, u, r, t, s: {
            "A": (0.5, a, u), "B": (0.5, 0, r), "C": (t, 0, s), "D": (a, 0.5, -u), "E": (0, t, -s),
        },
        "AB BC AC AD AE", (0.77, 0.46, 1.1, 1.13, 0.33), turns=4,
    ),
}  # fmt: skip


def _augmented_sphenocorona() -> Surface:
    solid = SOLVED[86].surface()
    return _augmented(solid, [next(at for at, face in enumerate(solid.faces) if len(face) == 4)])


def _bilunabirotunda() -> Surface:
    return hull(_images([(0.5, GOLDEN / 2, 0.5), (0, 0.5, GOLDEN**2 / 2), (GOLDEN / 2, 0, 0)], turns=2))


def _triangular_hebesphenorotunda() -> Surface:
    """The part of an icosidodecahedron above its hexagon about an axis through a triangle, over a smaller hexagon."""
    own = uniform("icosidodecahedron")
    triangle = own.vertices[next(face for face in own.faces if len(face) == 3)]
    z = triangle.mean(axis=0)
    x = triangle[0] - z
    x, z = x / np.linalg.norm(x), z / np.linalg.norm(z)
    points = own.vertices @ np.stack([x, np.cross(z, x), z], axis=1)
    upper = points[points[:, 2] > 1e-6]
    # The edge below the triangle's first corner is over an edge of the hexagon: a square is between them.
    edge = max((place for place in upper if abs(place[1] - 0.5) < 1e-6), key=lambda place: float(place[0]))
    height = edge[2] - math.sqrt(1 - (edge[0] - math.sqrt(0.75)) ** 2)
    return hull(np.concatenate([upper, ring(6, height)]))


MADE: dict[int, Callable[[], Surface]] = {
    **{number: solved.surface for number, solved in SOLVED.items()},
    87: _augmented_sphenocorona, 91: _bilunabirotunda, 92: _triangular_hebesphenorotunda,
}  # fmt: skip
