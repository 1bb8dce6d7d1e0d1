# SPDX-License-Identifier: Apache-2.0
"""Two boxes on a table: push one against the other with the mouse."""

import iota

system = iota.System()
boxes = [
    system.body(shape=iota.Box((0.2, 0.2, 0.2)), density=500, position=(x, 0.9, 0), color=color)
    for x, color in ((-0.3, "tomato"), (0.1, "teal"))
]

world = iota.World(system, title="push")
world.add_static(iota.looks.box((1.4, 0.05, 0.8), "wood"), (0, 0.775, 0))
for x in (-0.6, 0.6):
    for z in (-0.3, 0.3):
        world.add_strut((x, 0, z), (x, 0.75, z), iota.looks.cylinder(0.03, "wood"))
world.run()
