# SPDX-License-Identifier: Apache-2.0
"""A chain of hinged links."""

from __future__ import annotations

import math
from collections.abc import Sequence

from iota._core import Body, Particle, System, Vec3


def chain(
    system: System,
    links: int = 24,
    length: float = 2.4,
    radius: float = 0.012,
    top: Sequence[float] = (0, 2.6, 0),
    direction: Sequence[float] = (0, -1, 0),
    mass: float = 1.2,
    rods: bool = False,
    nailed: bool = True,
) -> list[Body]:
    """Makes a straight chain and returns its links from the top; each has two particles, the upper one first.

    links: at least 1. length: of the whole chain, m. mass: of the whole chain, kg. top: of the first link, m.
    direction: from top to end. rods: links are solid cylinders of `radius` m instead of two point masses. nailed: the
    top is held. Raises ValueError.

        links = iota.builder.chain(system, links=24, length=2.4)
    """
    if not (isinstance(links, int) and links >= 1):
        raise ValueError(f"links must be a whole number from 1 up, not {links!r}")
    if not 0 < length <= 1e6:
        raise ValueError(f"length must be above 0 m and at most 1e6 m, not {length}")
    if not 2e-12 <= mass / links <= 1e15:
        raise ValueError(f"mass must give each of {links} links between 2e-12 and 1e15 kg, not {mass / links}")
    start, way = Vec3(*top), Vec3(*direction)
    if not abs(start) <= 1e8:
        raise ValueError(f"top must be finite and at most 1e8 m from the origin, not {tuple(top)}")
    if not 0 < abs(way) < math.inf:
        raise ValueError(f"direction must not be zero, and finite: {tuple(direction)}")
    step = way.unit() * (length / links)
    if start + step == start:
        raise ValueError(f"links of {length / links} m are lost in round-off at {tuple(top)}")
    if rods and not 0 < radius <= 1e6:
        raise ValueError(f"radius must be above 0 and at most 1e6 m, not {radius}")
    bodies: list[Body] = []
    end: Particle | None = None
    for index in range(links):
        body = system.body()
        upper = body.particle(start + step * index, mass=mass / links / 2)
        lower = body.particle(start + step * (index + 1), mass=mass / links / 2)
        if rods:
            body.set_rod(mass / links, radius)
        if end is not None:
            end.combine(upper)
        elif nailed:
            upper.nail()
        end = lower
        bodies.append(body)
    return bodies
