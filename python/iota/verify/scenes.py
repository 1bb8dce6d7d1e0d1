# SPDX-License-Identifier: Apache-2.0
"""Small scenes for several cases."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

import iota
from iota.verify.reference import Array


def string_of_links(
    system: iota.System, points: Array, link_mass: float = 1.0, velocities: Array | None = None
) -> list[iota.Particle]:
    """Two-point links hinged through the points (n + 1, 2 or 3); returns one particle of each of the n + 1 rings.

    Each link has half its mass at either end. The first point is nailed.
    """
    moving = np.zeros_like(points) if velocities is None else velocities
    ends: list[iota.Particle] = []
    for i in range(len(points) - 1):
        link = system.body()
        upper = link.particle(points[i], mass=link_mass / 2, velocity=moving[i])
        lower = link.particle(points[i + 1], mass=link_mass / 2, velocity=moving[i + 1])
        if ends:
            ends[-1].combine(upper)
        else:
            upper.nail()
            ends.append(upper)
        ends.append(lower)
    return ends


def masses_of(links: int, link_mass: float = 1.0) -> Array:
    """Masses of the rings of `string_of_links` below the nail: a link's mass each, half of it at the free end."""
    masses = np.full(links, link_mass)
    masses[-1] = link_mass / 2
    return masses


def hanging_points(top: Sequence[float], lengths: Iterable[float], angles: Iterable[float]) -> Array:
    """(n + 1, 3) from lengths and angles from straight down."""
    steps = [
        (length * np.sin(angle), -length * np.cos(angle), 0.0) for length, angle in zip(lengths, angles, strict=True)
    ]
    start = np.array([*top, 0.0][:3])
    return np.vstack([start, start + np.cumsum(steps, axis=0)])


def level_points(start: Sequence[float], links: int, length: float) -> Array:
    """(links + 1, 3), m: from a place along x, `length` apart."""
    along = length * np.arange(links + 1)
    return np.column_stack([start[0] + along, np.full_like(along, start[1]), np.zeros_like(along)])


def place(particle: iota.Particle) -> Array:
    return np.asarray(particle.position)


def places(particles: Sequence[iota.Particle]) -> Array:
    """(n, 3), m."""
    return np.array([p.position for p in particles])


def lengths_between(particles: Sequence[iota.Particle]) -> Array:
    """(n - 1,), m: from each to the next."""
    return np.asarray(np.linalg.norm(np.diff(places(particles), axis=0), axis=1))


def rigid_body(
    system: iota.System, points: Array, masses: Sequence[float] | Array, velocity: Sequence[float] | Array = (0, 0, 0),
    spin: Sequence[float] | Array = (0, 0, 0),
) -> list[iota.Particle]:  # fmt: skip
    """One body of the points (n, 3); spin: angular velocity about the center of mass, rad/s."""
    center = np.average(points, axis=0, weights=masses)
    body = system.body()
    return [
        body.particle(point, mass=mass, velocity=np.asarray(velocity) + np.cross(spin, point - center))
        for point, mass in zip(points, masses, strict=True)
    ]
