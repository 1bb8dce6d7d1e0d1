# SPDX-License-Identifier: Apache-2.0
"""Platonic and Archimedean solids by Wythoff's construction: the images of one point in a kaleidoscope of three mirrors (Coxeter,
Regular Polytopes, 1973, chapter 5). Edges are 1 long, the center is the origin."""

from __future__ import annotations

import math
from itertools import combinations
from typing import TYPE_CHECKING, Any

import numpy as np

from iota.shapelib.convex import distinct, hull
from iota.shapelib.surface import Surface

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Array = NDArray[Any]  # of float64; sums and products of NumPy are typed loosely

# By p of the kaleidoscope [p, 3], and the mirrors that the point is not on.
UNIFORM: dict[str, tuple[int, tuple[int, int, int]]] = {
    "tetrahedron": (3, (1, 0, 0)),
    "cube": (4, (1, 0, 0)),
    "octahedron": (4, (0, 0, 1)),
    "dodecahedron": (5, (1, 0, 0)),
    "icosahedron": (5, (0, 0, 1)),
    "truncated tetrahedron": (3, (1, 1, 0)),
    "cuboctahedron": (4, (0, 1, 0)),
    "truncated cube": (4, (1, 1, 0)),
    "truncated octahedron": (4, (0, 1, 1)),
    "rhombicuboctahedron": (4, (1, 0, 1)),
    "truncated cuboctahedron": (4, (1, 1, 1)),
    "icosidodecahedron": (5, (0, 1, 0)),
    "truncated dodecahedron": (5, (1, 1, 0)),
    "truncated icosahedron": (5, (0, 1, 1)),
    "rhombicosidodecahedron": (5, (1, 0, 1)),
    "truncated icosidodecahedron": (5, (1, 1, 1)),
}
SNUB = {"snub cube": 4, "snub dodecahedron": 5}


def uniform_points(name: str) -> Array:
    """The corners, (n, 3)."""
    if name in SNUB:
        return _snub(SNUB[name])
    p, active = UNIFORM[name]
    mirrors = _mirrors(p)
    seed = np.linalg.solve(mirrors, np.array(active) / 2)  # the distance to each mirror image is 1 or 0
    return _orbit(seed, [_reflection(normal) for normal in mirrors])


def uniform(name: str) -> Surface:
    """By one of the names above."""
    return hull(uniform_points(name))


def _mirrors(p: int) -> Array:
    """The unit normals of mirrors that meet at angles of 180 / p, 60 and 90 degrees: the rows."""
    x, y = -math.cos(math.pi / p), -math.cos(math.pi / 3)
    a = np.array([1.0, 0, 0])
    b = np.array([x, math.sqrt(1 - x * x), 0])
    c_y = y / b[1]
    return np.array([a, b, [0, c_y, math.sqrt(1 - c_y**2)]])


def _reflection(normal: Array) -> Array:
    return np.asarray(np.eye(3) - 2 * np.outer(normal, normal))


def _orbit(seed: Array, generators: list[Array]) -> Array:
    found = seed[None]
    while True:
        larger = distinct(np.concatenate([found, *(found @ g.T for g in generators)]))
        if len(larger) == len(found):
            return np.asarray(found)
        found = larger


def _snub(p: int) -> Array:
    """The images under rotations alone, of a point with equal distances to its three nearest ones: Newton's method on its
    place, with differences for derivatives."""
    mirrors = _mirrors(p)
    turns = [_reflection(mirrors[i]) @ _reflection(mirrors[j]) for i, j in combinations(range(3), 2)]
    corners = np.linalg.inv(mirrors).T  # rows: intersections of two mirrors
    corners = corners / np.linalg.norm(corners, axis=1)[:, None]

    def place(weights: Array) -> Array:
        return np.asarray(weights @ corners)

    def miss(free: Array) -> Array:
        at = place(np.array([1.0, *free]))
        lengths = [np.linalg.norm(at - turn @ at) for turn in turns]
        return np.array([lengths[0] - lengths[1], lengths[1] - lengths[2]])

    free = np.array([1.0, 1.0])
    for _ in range(50):
        now, step = miss(free), 1e-7
        slope = np.stack([(miss(free + step * e) - now) / step for e in np.eye(2)], axis=1)
        free -= np.linalg.solve(slope, now)
    at = place(np.array([1.0, *free]))
    points = _orbit(at, turns)
    return np.asarray(points / np.linalg.norm(at - turns[0] @ at))
