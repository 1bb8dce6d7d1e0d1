# SPDX-License-Identifier: Apache-2.0
"""The distance of two convex shapes from their support functions alone. It shares no code and no method with the engine."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from scipy.optimize import nnls

import iota

Array = np.ndarray[Any, np.dtype[np.float64]]
Support = Callable[[Array], Array]  # direction -> the farthest point of the shape


def support_of(shape: Any) -> tuple[Support, float]:
    """Of a shape in its own frame, without the ball of this radius that is rolled around it, m."""
    if isinstance(shape, iota.Sphere):
        return lambda _: np.zeros(3), shape.radius
    if isinstance(shape, iota.Capsule):
        return lambda d: np.array([np.copysign(shape.length / 2, d[0]), 0, 0]), shape.radius
    if isinstance(shape, iota.Box):
        half = np.array(shape.size) / 2
        return lambda d: np.copysign(half, d), 0.0
    if isinstance(shape, iota.Ellipsoid):
        squares = (np.array(shape.size) / 2) ** 2
        return lambda d: squares * d / np.sqrt(squares @ (d * d)), 0.0
    if isinstance(shape, iota.Cylinder):
        return lambda d: np.append(np.copysign(shape.length / 2, d[0]), _rim(shape.radius, d)), 0.0
    if isinstance(shape, iota.Cone):
        tip = np.array([shape.length / 2, 0, 0])

        def of_cone(d: Array) -> Array:
            base = np.append(-shape.length / 2, _rim(shape.radius, d))
            return base if base @ d > tip @ d else tip

        return of_cone, 0.0
    corners = np.array(shape.vertices)
    return lambda d: corners[np.argmax(corners @ d)], 0.0


def _rim(radius: float, d: Array) -> Array:
    across = float(np.hypot(d[1], d[2]))
    return radius * d[1:] / across if across > 0 else np.zeros(2)


def distance(a: Any, place_a: Array, turn_a: Array, b: Any, place_b: Array, turn_b: Array) -> tuple[float, Array]:
    """The distance, m, negative by the radii alone, and the unit normal from b to a. turn_a, turn_b: (3, 3), to the world.

    The point of the difference of both that is nearest to the origin: least squares with weights that are not negative over
    points of its surface, to which the farthest one against the latest result is added until none is farther.
    """
    (of_a, radius_a), (of_b, radius_b) = support_of(a), support_of(b)

    def farthest(d: Array) -> Array:
        first, second = of_a(turn_a.T @ d), of_b(-turn_b.T @ d)
        return np.asarray(place_a + turn_a @ first - place_b - turn_b @ second)

    points = [farthest(place_b - place_a)]
    nearest = points[0]
    for _ in range(200):
        size = float(np.linalg.norm(nearest))
        new = farthest(-nearest)
        if size == 0 or nearest @ (nearest - new) <= 1e-12 * size * max(size, 1e-9 * float(np.abs(points).max())):
            break
        points.append(new)
        # sum w p = 0 is asked for with sum w = 1, which counts for much more.
        scale = float(np.abs(points).max())
        matrix = np.vstack([np.array(points).T / scale, np.full(len(points), 1e5)])
        weights, _ = nnls(matrix, np.array([0, 0, 0, 1e5]))
        points = [p for p, w in zip(points, weights, strict=True) if w > 0]
        weights = weights[weights > 0]
        nearest = (weights / weights.sum()) @ np.array(points)
    return size - radius_a - radius_b, nearest / size if size > 0 else nearest
