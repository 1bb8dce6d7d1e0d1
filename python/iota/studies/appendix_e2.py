# SPDX-License-Identifier: Apache-2.0
"""Appendix E.2 of the thesis: two particles, connected by a force function of the script, swing about 20 m of distance."""

from __future__ import annotations

import iota
from iota.studies.appendix_e1 import GROUND, SCALE, present


def build() -> iota.World:
    """The world of the study."""
    system = iota.System(gravity=(0, -1))
    particle1 = system.body().particle()
    particle2 = system.body().particle((30, 0, 0))
    system.bond(particle1, particle2, force_function1)
    world = present(iota.World(system, title=f"Appendix E.2: a force swings two particles; {SCALE}", ground=GROUND))
    world.drawings.line(particle1, particle2)
    return world


def force_function1(bond: iota.types.BondState) -> iota.Vec3:
    """The force on the first particle (N); the second one gets the opposite."""
    return 2.0 * (bond.distance - 20) * bond.direction
