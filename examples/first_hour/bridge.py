# SPDX-License-Identifier: Apache-2.0
"""A footbridge of planks, and a ball that rolls over it."""

import iota

system = iota.System(damping=0.1)
world = iota.World(system, title="bridge")
bridge = iota.builder.bridge(planks=12, length=3, width=0.6, sag=0.01, middle=(0, 1, 0)).realize(system, world)
ball = system.body(shape=iota.Sphere(0.12), mass=2, position=(-1.35, 1.2, 0), velocity=(2.5, 0, 0), color="crimson")
ball.material = iota.Material(rolling=0.01)

for x in (-2.2, 2.2):
    world.add_static(iota.looks.box((1.4, 1, 1), "wood"), (x, 0.45, 0))
world.run()
