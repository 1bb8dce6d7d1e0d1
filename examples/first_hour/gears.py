# SPDX-License-Identifier: Apache-2.0
"""Two gears of a watch, 1.2 mm and 2.4 mm, driven by a motor."""

import iota

system = iota.System()
wheels = []
for x, radius, color in ((0, 0.6e-3, "gold"), (1.8e-3, 1.2e-3, "silver")):
    wheel = system.body(
        shape=iota.Cylinder(radius, 0.3e-3), density=8500, position=(x, 0.05, 0), orientation=("y", 90), color=color
    )
    wheels.append(system.revolute(wheel, at=(x, 0.05, 0), axis=(0, 0, 1)))
wheels[0].angle.motor = (3, 1e-6)
system.gear(wheels[0].angle, wheels[1].angle, -0.5)

world = iota.World(system, title="gears", ground=None)
world.run()
