# SPDX-License-Identifier: Apache-2.0
"""The height and the material of the ground of a world."""

from __future__ import annotations

import math

import numpy as np

from iota._core import Body, Material, Solid, System
from iota.frames import axes_of
from iota.simulator import Simulator

STANDING = 1e-3  # share of its height, by which a body that stands may miss the ground
MATERIAL = Material(friction=0.6)  # of the ground, and of what can move, unless the script gives another one


def level_below(system: System | Simulator) -> float:
    """Height of a ground below all bodies and the reach of those that hang from nails, m: at most 0. Where a solid stands on 0, what
    hangs may reach further down."""
    places = system.positions
    if not len(places):
        return 0.0
    size = float(np.linalg.norm(np.ptp(places, axis=0)))
    lowest = float(places[:, 1].min())
    if isinstance(system, System) and not (lowest >= 0 and any(map(stands_on_zero, system.bodies))):
        for part in system.articulates:
            particles = [p for body in part for p in body.particles]
            nails = [p.position for p in particles if p.is_nailed]
            if len(nails) == 1:  # it can swing
                lowest = min(lowest, nails[0].y - max(abs(p.position - nails[0]) for p in particles))
    return 0.0 if lowest >= -1e-6 * size else lowest - 0.1 * size


def stands_on_zero(body: Body) -> bool:
    """Whether the lowest place of one of its solids is at height 0."""
    return any(abs(bottom) <= STANDING * height for bottom, height in map(_upright, body.solids) if height < math.inf)


def _upright(solid: Solid) -> tuple[float, float]:
    """Height of its lowest place, and its own height, m; of the box around it, if it leans."""
    low, high = solid.shape.bounds
    axes = axes_of(solid.orientation)[1]
    ends = np.array([list(low), list(high)]) * axes
    bottom, top = ends.min(axis=0).sum(), ends.max(axis=0).sum()
    return float(solid.position.y + bottom), float(top - bottom)
