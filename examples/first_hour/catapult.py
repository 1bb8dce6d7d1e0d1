# SPDX-License-Identifier: Apache-2.0
"""A catapult with a counterweight throws a ball at a tower: key f opens the latch."""

import iota

system = iota.System()
arm = system.body(shape=iota.Box((2, 0.08, 0.12)), density=400, position=(0.5, 1, 0), color="saddlebrown")
axle = system.revolute(arm, at=(0, 1, 0), axis=(0, 0, 1), limits=(-1.9, 1.0))
load = system.body(shape=iota.Box((0.4, 0.4, 0.4)), mass=300, position=(-0.5, 0.7, 0), color="dimgray")
system.revolute(load, arm, at=(-0.45, 1, 0), axis=(0, 0, 1))
latch = arm.attachment((1.45, 1, 0))
latch.nail()
ball = system.body(shape=iota.Sphere(0.12), mass=4, position=(1.35, 1.16, 0), color="black")
ball.material = iota.Material(rolling=0.05)
cup = system.weld(ball, arm)
tower = [
    system.body(shape=iota.Box((0.3, 0.3, 0.3)), density=80, position=(-11.2, 0.15 + 0.3 * i, 0), color="tomato")
    for i in range(5)
]

world = iota.World(system, title="catapult")
world.add_strut((0, 0, -0.2), (0, 1.05, -0.2), iota.looks.cylinder(0.05, "wood"))
world.add_strut((0, 0, 0.2), (0, 1.05, 0.2), iota.looks.cylinder(0.05, "wood"))
world.add_strut((0, 1, -0.25), (0, 1, 0.25), iota.looks.cylinder(0.03, "steel"))


@world.action("fire", key="f", help="opens the latch", on="world")
def fire():
    latch.release()


@world.on_step
def let_go():
    if cup.active and axle.angle.value > 0.6:
        cup.active = False


world.run()
