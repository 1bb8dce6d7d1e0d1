# SPDX-License-Identifier: Apache-2.0
"""Thesis, Fig. E.1: one rigid body of two particles, falling."""

import iota

system = iota.System(gravity=(0, -1))  # z defaults to 0

body1 = system.body()
particle1 = body1.particle()  # at the origin
particle2 = body1.particle((30, 0, 0))

# Something to be seen between them; the body is rigid without it.
system.cosmetic_bond(particle1, particle2)

iota.World(system, title="Appendix E.1", ground=None).run()
