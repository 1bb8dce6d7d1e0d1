# SPDX-License-Identifier: Apache-2.0
"""Appendix E.3 of the thesis: two bodies, connected by a hinge, fall and fold."""

from __future__ import annotations

import iota
from iota.studies.appendix_e1 import GROUND, SCALE, present


def build() -> iota.World:
    """The world of the study."""
    system = iota.System(gravity=(0, -1))
    body1 = system.body()
    particle1 = body1.particle()
    particle1a = body1.particle((-30, -35, 0))
    system.cosmetic_bond(particle1, particle1a)
    body2 = system.body()
    particle2 = body2.particle((0, 10, 0))
    particle2a = body2.particle((35, -25, 0))
    system.cosmetic_bond(particle2, particle2a)
    # A hinge. The two need not be at one place: they meet at once and stay together.
    particle1.combine(particle2)
    return present(iota.World(system, title=f"Appendix E.3: two bodies on a hinge fold; {SCALE}", ground=GROUND))
