# SPDX-License-Identifier: Apache-2.0
"""Sun, Earth and Mars in units that suit them: millions of km, days, masses of the Sun."""

import math

import iota

G = 6.674e-11 * 1.989e30 * 86400**2 / 1e27  # (1e6 km)^3 / (solar mass day^2)
system = iota.System(gravity=(0, 0, 0))


def planet(name, distance, mass, radius, color):
    speed = math.sqrt(G / distance) if distance else 0
    body = system.body()
    body.name = name
    return body.particle((distance, 0, 0), mass, velocity=(0, 0, -speed), radius=radius, color=color)


sun = planet("Sun", 0, 1, 12, "gold")
earth = planet("Earth", 149.6, 3.0e-6, 5, "dodgerblue")
mars = planet("Mars", 227.9, 3.2e-7, 4, "orangered")
for each in (earth, mars):
    system.bond(sun, each, "gravity", strength=G)

world = iota.World(system, title="planets", dt=0.25, ground=None)
world.clock.speed = 10
for each in (sun, earth, mars):
    world.label(each.body.name, at=each, offset=(0, 18, 0))
    world.drawings.trace(each, color="white")
world.camera = iota.Camera(position=(0, 350, 420), target=(0, 0, 0))
world.drawings.stage(sky="black", horizon="black", ground="black", light=0.5)
world.run()
