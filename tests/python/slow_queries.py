# SPDX-License-Identifier: Apache-2.0
"""Answers to questions about places without an index, one body after the other: the twin of iota.world.queries."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from iota._core import Body, HalfSpace, Mesh, Vec3
from iota.frames import axes_of
from iota.world.queries import Hit, Place
from iota.world.world import World

CLOSE = 1e-6  # of the body's size: a ray that comes so near has met it
MOST_MARCHES = 256


class SlowQueries:
    def __init__(self, world: World) -> None:
        self._system = world.system

    def ray(
        self, origin: Place, direction: Place, farthest: float = math.inf, bodies: Iterable[Body] | None = None
    ) -> Hit | None:
        """The first body that a ray meets, within `farthest` m; None without one. Raises ValueError for a direction of zero.

        hit = world.queries.ray(eye, (0, -1, 0))
        """
        start, along = np.array(list(Vec3(*origin))), np.array(list(Vec3(*direction)))
        length = float(np.linalg.norm(along))
        if not length > 0:
            raise ValueError("the direction of a ray must not be zero")
        along /= length
        best: Hit | None = None
        for shape in self._shapes(bodies):
            middle = float((shape.center - start) @ along)
            aside = float(np.linalg.norm(start + middle * along - shape.center))
            limit = farthest if best is None else best.distance
            if aside > shape.reach or middle + shape.reach < 0 or middle - shape.reach > limit:
                continue
            at = max(0.0, middle - shape.reach) if math.isfinite(shape.reach) else 0.0
            close = CLOSE * (shape.reach if math.isfinite(shape.reach) else 1.0)
            for _ in range(MOST_MARCHES):
                apart = shape.distance(start + at * along)
                if apart <= close:
                    best = Hit(shape.body, Vec3(*(start + at * along)), at)
                    break
                at += apart
                if at > min(limit, middle + shape.reach):
                    break
        return best

    def nearest(self, place: Place, bodies: Iterable[Body] | None = None) -> Hit | None:
        """The body whose surface is nearest to a place; None without bodies."""
        start = np.array(list(Vec3(*place)))
        best: tuple[float, _Shape] | None = None
        for shape in self._shapes(bodies):
            if best is None or float(np.linalg.norm(shape.center - start)) - shape.reach < best[0]:
                apart = shape.distance(start)
                best = (apart, shape) if best is None or apart < best[0] else best
        if best is None:
            return None
        apart, shape = best
        return Hit(shape.body, Vec3(*shape.closest(start)), apart)

    def within(self, place: Place, radius: float, bodies: Iterable[Body] | None = None) -> list[Body]:
        """The bodies of which a part is within `radius` m of a place: those that a ball there overlaps."""
        start = np.array(list(Vec3(*place)))
        if not radius >= 0:
            raise ValueError(f"radius must be 0 m or more, not {radius}")
        found = (
            shape.body
            for shape in self._shapes(bodies)
            if float(np.linalg.norm(shape.center - start)) - shape.reach <= radius and shape.distance(start) <= radius
        )
        return list(dict.fromkeys(found))

    def _shapes(self, bodies: Iterable[Body] | None) -> Iterator[_Shape]:
        """The solids of bodies, and the lines of their particles."""
        if bodies is None:
            bodies = [body for body in self._system.bodies if body.kind != "inactive" and not body.is_spark]
        for body in bodies:
            for solid in body.solids:
                yield _Solid(body, solid)
            if not body.solids and body.particles:
                yield _Line(body, body.radius)


class _Shape:
    """A part of a body: its ball about `center` (m) with the radius `reach` (m) contains it."""

    body: Body
    center: NDArray[np.float64]
    reach: float

    def distance(self, place: NDArray[np.float64]) -> float:
        """From its surface, negative inside, m."""
        raise NotImplementedError

    def closest(self, place: NDArray[np.float64]) -> NDArray[np.float64]:
        """The nearest point of its surface, m."""
        raise NotImplementedError


class _Solid(_Shape):
    def __init__(self, body: Body, solid: Any) -> None:
        self.body, self._shape = body, solid.shape
        self.center = np.array(list(solid.position))
        self._axes = axes_of(solid.orientation)
        if isinstance(self._shape, Mesh):
            self.reach = float(np.linalg.norm(self._shape.vertices, axis=1).max())
        else:
            self.reach = math.inf if isinstance(self._shape, HalfSpace) else float(sum(self._shape.numbers))

    def distance(self, place: NDArray[np.float64]) -> float:
        return float(self._shape.distance((place - self.center) @ self._axes))

    def closest(self, place: NDArray[np.float64]) -> NDArray[np.float64]:
        local = self._shape.closest((place - self.center) @ self._axes)
        return np.asarray(self.center + self._axes @ np.array(list(local)))


class _Line(_Shape):
    """Particles: a ball, or straight pieces from each to the next."""

    def __init__(self, body: Body, radius: float) -> None:
        self.body, self._radius = body, radius
        self._points = np.array([list(particle.position) for particle in body.particles])
        self.center = self._points.mean(axis=0)
        self.reach = float(np.linalg.norm(self._points - self.center, axis=1).max()) + radius

    def distance(self, place: NDArray[np.float64]) -> float:
        return float(np.linalg.norm(place - self._middle_of(place))) - self._radius

    def closest(self, place: NDArray[np.float64]) -> NDArray[np.float64]:
        middle = self._middle_of(place)
        away = place - middle
        length = float(np.linalg.norm(away))
        away = away / length if length > 0 else np.array([0.0, 1.0, 0.0])
        return np.asarray(middle + self._radius * away)

    def _middle_of(self, place: NDArray[np.float64]) -> NDArray[np.float64]:
        """The nearest point of the line."""
        begins, ends = self._points, self._points
        if len(self._points) > 1:
            begins, ends = self._points[:-1], self._points[1:]
        spans = ends - begins
        squared = np.maximum((spans * spans).sum(axis=1), 1e-300)
        share = np.clip(((place - begins) * spans).sum(axis=1) / squared, 0, 1)
        points = begins + share[:, None] * spans
        return np.asarray(points[np.linalg.norm(place - points, axis=1).argmin()])
