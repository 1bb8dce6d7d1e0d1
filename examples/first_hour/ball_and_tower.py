# SPDX-License-Identifier: Apache-2.0
"""A ball is thrown at a tower of ten boxes, which falls."""

import iota

system = iota.System()
tower = [
    system.body(
        shape=iota.Box((0.3, 0.2, 0.3)), density=400, position=(0, 0.1 + 0.2 * i, 0), color=("tan", "peru")[i % 2]
    )
    for i in range(10)
]
ball = system.body(shape=iota.Sphere(0.15), mass=20, position=(-4, 1.2, 0), velocity=(8, 2, 0), color="black")
ball.material = iota.Material(rolling=0.05)

world = iota.World(system, title="ball and tower")
world.run()
