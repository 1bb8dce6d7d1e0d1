# SPDX-License-Identifier: Apache-2.0
"""Thesis, Fig. E.2: two particles, connected by a force function of the script."""

import iota

system = iota.System(gravity=(0, -1))  # z defaults to 0

body1 = system.body()
particle1 = body1.particle()

body2 = system.body()
particle2 = body2.particle((30, 0, 0))


def force_function1(bond: iota.types.BondState) -> iota.Vec3:
    """The force on the first particle (N); the second one gets the opposite."""
    return 2.0 * (bond.distance - 20) * bond.direction


system.bond(particle1, particle2, force_function1)

iota.World(system, title="Appendix E.2", ground=None).run()
