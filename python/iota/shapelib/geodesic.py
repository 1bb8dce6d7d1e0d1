# SPDX-License-Identifier: Apache-2.0
"""Geodesic balls and icosahedral fullerenes, their duals (Caspar and Klug 1962; Goldberg 1937)."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from iota._core import Mesh
from iota.shapelib.convex import SAME, distinct
from iota.shapelib.surface import Surface
from iota.shapelib.uniform import uniform

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Array = NDArray[np.float64]

MOST = 20_000  # vertices


def geodesic(h: int, k: int = 0) -> Surface:
    """An icosahedron whose faces are divided into h^2 + h k + k^2 triangles each, projected on a sphere of radius 1: 10
    (h^2 + h k + k^2) + 2 vertices."""
    count = h * h + h * k + k * k
    if not (h >= 1 and k >= 0 and 10 * count + 2 <= MOST):
        raise ValueError(f"a geodesic ball has from 12 to {MOST} vertices, not {10 * count + 2}")
    base = uniform("icosahedron")
    # Points of the triangular lattice, as shares of the three corners 0, (h, k) and (-k, h + k) of a large triangle.
    shares = []
    for a in range(-k, h + 1):
        for b in range(h + 2 * k + 1):
            # a u + b v = s (h, k) + t (-k, h + k)
            s, t = (a * (h + k) + b * k) / count, (b * h - a * k) / count
            if min(s, t, 1 - s - t) > -SAME:
                shares.append((1 - s - t, s, t))
    points = np.concatenate([np.array(shares) @ base.vertices[face] for face in base.faces])
    points = distinct(points / np.linalg.norm(points, axis=1)[:, None])
    skin = Mesh.convex_hull(points)
    return Surface(skin.vertices, skin.triangles.tolist())


def fullerene(atoms: int) -> Surface:
    """A cage of 12 pentagons and hexagons with the symmetry of the icosahedron: 20 (h^2 + h k + k^2) corners, which are
    moved on a sphere of radius 1 to make the edges as equal as possible. Raises ValueError."""
    if atoms == 60:  # all edges are equal here
        solid = uniform("truncated icosahedron")
        solid.vertices /= np.linalg.norm(solid.vertices[0])
        return solid
    for h in range(1, math.isqrt(max(atoms, 0)) + 1):
        for k in range(h + 1):
            if 20 * (h * h + h * k + k * k) == atoms:
                return _cage(geodesic(h, k))
    sizes = sorted({20 * (h * h + h * k + k * k) for h in range(1, 5) for k in range(h + 1)})
    raise ValueError(
        f"fullerenes with the symmetry of an icosahedron have {', '.join(map(str, sizes[:9]))} ... atoms, not {atoms}"
    )


def _cage(ball: Surface) -> Surface:
    triangles = np.array(ball.faces)
    places = ball.vertices[triangles].mean(axis=1)
    places /= np.linalg.norm(places, axis=1)[:, None]
    around: list[list[int]] = [[] for _ in ball.vertices]
    for number, triangle in enumerate(ball.faces):
        for vertex in triangle:
            around[vertex].append(number)
    faces = []
    for vertex, members in enumerate(around):
        normal = ball.vertices[vertex]
        spokes = places[members] - normal
        x = spokes[0] - (spokes[0] @ normal) * normal
        angle = np.arctan2(spokes @ np.cross(normal, x), spokes @ x)
        faces.append([members[i] for i in np.argsort(angle)])
    cage = Surface(places, faces)
    edges = cage.edges()
    for _ in range(300):
        way = places[edges[:, 1]] - places[edges[:, 0]]
        length = np.linalg.norm(way, axis=1)
        move = 0.2 * way * (1 - length.mean() / length)[:, None]
        np.add.at(places, edges[:, 0], move)
        np.add.at(places, edges[:, 1], -move)
        places /= np.linalg.norm(places, axis=1)[:, None]
    return cage
