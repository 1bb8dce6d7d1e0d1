# SPDX-License-Identifier: Apache-2.0
"""The height and the material of the ground of a world."""

from __future__ import annotations

import numpy as np

from iota._core import Material, System
from iota.simulator import Simulator

MATERIAL = Material(friction=0.6)  # of the ground, and of what can move, unless the script gives another one


def level_below(system: System | Simulator) -> float:
    """Height of a ground below all bodies and the reach of those that hang from nails, m: at most 0."""
    places = system.positions
    if not len(places):
        return 0.0
    size = float(np.linalg.norm(np.ptp(places, axis=0)))
    lowest = float(places[:, 1].min())
    if isinstance(system, System):
        for part in system.articulates:
            particles = [p for body in part for p in body.particles]
            nails = [p.position for p in particles if p.is_nailed]
            if len(nails) == 1:  # it can swing
                lowest = min(lowest, nails[0].y - max(abs(p.position - nails[0]) for p in particles))
    return 0.0 if lowest >= -1e-6 * size else lowest - 0.1 * size
