# SPDX-License-Identifier: Apache-2.0
"""A bridge of 200 m, and a lorry of 10 t that hangs from it on a rope."""

import iota

system = iota.System(damping=0.2)
world = iota.World(system, title="suspension bridge")
bridge = iota.builder.bridge(planks=40, length=200, width=6, thickness=0.5, sag=0.05, middle=(0, 60, 0))
bridge = bridge.realize(system, world)
middle = bridge.bodies[20]
lorry = system.body(shape=iota.Box((8, 3, 2.5)), mass=10_000, position=(middle.position.x, 25, 0), color="royalblue")
rope = system.rope(middle.attachment(middle.position), lorry.attachment(lorry.position + (0, 1.5, 0)))

world.draw_ties("rope", iota.looks.cylinder(0.2, "rope"))
world.run()
