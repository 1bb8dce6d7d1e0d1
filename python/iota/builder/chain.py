# SPDX-License-Identifier: Apache-2.0
"""A chain of hinged links."""

from __future__ import annotations

from collections.abc import Sequence

from iota._core import Body, Particle, System, Vec3, combine


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
    if not length > 0:
        raise ValueError(f"length must be above 0 m, not {length}")
    start, step = Vec3(*top), Vec3(*direction).unit() * (length / links)
    if abs(step) == 0:
        raise ValueError(f"direction must not be zero: {tuple(direction)}")
    bodies: list[Body] = []
    end: Particle | None = None
    for index in range(links):
        body = Body(system)
        upper = Particle(body, start + step * index, mass=mass / links / 2)
        lower = Particle(body, start + step * (index + 1), mass=mass / links / 2)
        if rods:
            body.set_rod(mass / links, radius)
        if end is not None:
            combine(end, upper)
        elif nailed:
            upper.nail()
        end = lower
        bodies.append(body)
    return bodies
