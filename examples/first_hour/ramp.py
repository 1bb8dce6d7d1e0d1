# SPDX-License-Identifier: Apache-2.0
"""Six boxes slide down a ramp and come to rest on the ground."""

import iota

system = iota.System()
ramp = system.obstacle(iota.Box((3, 0.1, 1.5)), position=(0, 1, 0), orientation=("z", -35), color="peru")
boxes = [
    system.body(shape=iota.Box((0.25, 0.25, 0.25)), position=(-0.9, 2.2 + 0.4 * number, 0), color="tomato")
    for number in range(6)
]

world = iota.World(system, title="ramp")
world.run()
