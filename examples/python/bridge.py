# SPDX-License-Identifier: Apache-2.0
"""A rope bridge: planks as one piece of data, repeated, then put into a system and drawn."""

import iota

plank = iota.builder.Structure()
left, right = plank.point((-0.15, 0, 0), mass=0), plank.point((0.15, 0, 0), mass=0)
plank.body(left, right, shape=iota.Box((0.28, 0.03, 0.6)), density=600, look="wood")
plank.looks["wood"] = iota.looks.solid("wood")

bridge = iota.builder.Structure()
for number in range(10):
    first, _ = bridge.merge(plank + (0.3 * number, 1.5, 0))
    if number:
        bridge.hinge(first - 1, first)
bridge.nail(0, len(bridge.points) - 1)

system = iota.System(damping=0.2)
world = iota.World(system, title="bridge")
bridge.realize(system, world)
world.run()
