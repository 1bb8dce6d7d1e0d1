# SPDX-License-Identifier: Apache-2.0
"""Convex polyhedra from their corners."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from iota._core import Mesh
from iota.shapelib.nearest import near_pairs
from iota.shapelib.surface import Surface

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Array = NDArray[np.float64]

SAME = 1e-6  # for coordinates near 1


def distinct(points: Array) -> Array:
    """The points without duplicates, in their order."""
    pairs, _ = near_pairs(points, 10 * SAME)
    return np.delete(points, np.unique(pairs[:, 1]), axis=0)


def hull(points: Array) -> Surface:
    """The convex hull of points that are all corners of it; triangles in one plane are one face."""
    corners = distinct(points)
    mesh = Mesh.convex_hull(corners)
    vertices, triangles = mesh.vertices, mesh.triangles.astype(int)
    planes: list[tuple[Array, float]] = []
    for a, b, c in vertices[triangles]:
        normal = np.cross(b - a, c - a)
        normal /= np.linalg.norm(normal)
        height = float(normal @ a)
        if not any(normal @ n > 1 - SAME and abs(height - h) < 10 * SAME for n, h in planes):
            planes.append((normal, height))
    return Surface(vertices, [_around(vertices, normal, height) for normal, height in planes])


def _around(vertices: Array, normal: Array, height: float) -> list[int]:
    """The vertices in a plane, counter-clockwise as seen from the side of the normal."""
    members = np.flatnonzero(np.abs(vertices @ normal - height) < 10 * SAME)
    spokes = vertices[members] - vertices[members].mean(axis=0)
    x = spokes[0] / np.linalg.norm(spokes[0])
    angle = np.arctan2(spokes @ np.cross(normal, x), spokes @ x)
    return members[np.argsort(angle)].tolist()  # type: ignore[no-any-return]


def dual(surface: Surface) -> Surface:
    """The dual of a uniform polyhedron about the origin: its polar with respect to the sphere that touches its
    edges."""
    p, q = surface.vertices[surface.edges()[0]]
    radius = float(np.linalg.norm(p + q)) / 2
    corners = []
    for face in surface.faces:
        a, b, c = surface.vertices[face[:3]]
        normal = np.cross(b - a, c - a)
        normal /= np.linalg.norm(normal)
        corners.append(normal * radius**2 / (normal @ a))
    return hull(np.array(corners))
