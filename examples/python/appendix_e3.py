# SPDX-License-Identifier: Apache-2.0
"""Thesis, Fig. E.3: two bodies, connected by a hinge."""

import iota

system = iota.System(gravity=(0, -1))

body1 = iota.Body(system)
particle1 = iota.Particle(body1)
particle1a = iota.Particle(body1, position=(-30, -35, 0))
iota.CBond(particle1, particle1a)

body2 = iota.Body(system)
particle2 = iota.Particle(body2, position=(0, 10, 0))
particle2a = iota.Particle(body2, position=(35, -25, 0))
iota.CBond(particle2, particle2a)

# A hinge. The two need not be at one place: they meet at once and stay together.
iota.combine(particle1, particle2)

iota.World(system, title="Appendix E.3", ground=None).run()
