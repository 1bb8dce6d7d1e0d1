# SPDX-License-Identifier: Apache-2.0
"""A chain of hinged links."""

from __future__ import annotations

import math

import numpy as np

from iota._core import Vec3
from iota.builder.dressing import Dress, dress
from iota.builder.parts import RigidBody
from iota.builder.points import Vector
from iota.builder.structure import Structure


def chain(
    links: int = 24,
    length: float = 2.4,
    radius: float = 0.012,
    top: Vector = (0, 2.6, 0),
    direction: Vector = (0, -1, 0),
    mass: float = 1.2,
    rods: bool = False,
    nailed: bool = True,
    look: Dress | None = None,
) -> Structure:
    """A straight chain: its bodies are the links from the top; each has two points, the upper one first.

    links: at least 1. length: of the whole chain, m. mass: of the whole chain, kg. top: of the first link, m.
    direction: from top to end. rods: links are solid cylinders of `radius` m instead of two point masses. nailed: the
    top is nailed. look: of each "link". Raises ValueError.

        links = iota.builder.chain(links=24, length=2.4).realize(system).bodies
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
    structure = Structure()
    ends = np.arange(1, 2 * links + 1) // 2  # 0, 1, 1, 2, 2, ...: a link begins at the end of the one before it
    structure.points.add(np.asarray(start) + np.outer(ends, np.asarray(step)), mass / links / 2)
    rod = (mass / links, radius) if rods else None
    structure.bodies = [RigidBody([p, p + 1], rod=rod) for p in range(0, 2 * links, 2)]
    structure.hinges = [(p, p + 1) for p in range(1, 2 * links - 1, 2)]
    if nailed:
        structure.nail(0)
    if look is not None:
        for body in structure.bodies:
            body.look = "link"
        dress(structure, {"link": None}, look)
    return structure
