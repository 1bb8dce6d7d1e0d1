# SPDX-License-Identifier: Apache-2.0
"""Thesis, Fig. E.1: one rigid body of two particles, falling."""

import iota

system = iota.System(gravity=(0, -1))  # z defaults to 0

body1 = iota.Body(system)
particle1 = iota.Particle(body1)  # at the origin
particle2 = iota.Particle(body1, position=(30, 0, 0))

# Something to be seen between them; the body is rigid without it.
iota.CBond(particle1, particle2)

iota.World(system, title="Appendix E.1", ground=None).run()
