# SPDX-License-Identifier: Apache-2.0
"""Newton's cradle: five steel balls hang side by side, and the blow of one goes through to the last."""

import math

import iota

system = iota.System()
steel = iota.Material(friction=0, restitution=1)
balls = []
for number, degrees in enumerate((-35, 0, 0, 0, 0)):
    x, angle = 0.202 * number, math.radians(degrees)  # 2 mm apart, so that one blow follows the other
    ball = system.body(
        shape=iota.Sphere(0.1),
        density=7800,
        position=(x + math.sin(angle), 1.5 - math.cos(angle), 0),
        orientation=("z", degrees),
        attachments=[(0, 1, 0)],
        material=steel,
    )
    ball.attachments[0].nail()
    balls.append(ball)

world = iota.World(system, title="Newton's cradle", dt=1 / 1000)
world.draw(balls, iota.looks.solid("steel"))
for ball in balls:
    world.drawings.strut(ball.attachments[0], ball, iota.looks.cylinder(0.006, "steel"))
world.add_strut((-0.2, 1.52, 0), (1, 1.52, 0), iota.looks.cylinder(0.02, "wood"))
world.controls.plot("speed", {"first": lambda: balls[0].velocity.x, "last": lambda: balls[-1].velocity.x}, unit="m/s")
world.run()
