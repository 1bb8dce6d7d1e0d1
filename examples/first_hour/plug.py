# SPDX-License-Identifier: Apache-2.0
"""A plug and its socket: bring the plug near, and the socket turns it and draws it in; pull hard to take it out."""

import iota

system = iota.System()
world = iota.World(system, title="plug: bring it to its socket; 0.7 m of table")
table = world.table(size=(0.7, 0.5))
world.wall(at=(0, 0, -0.28), size=(1.2, 1.3))
lead = world.plug_and_socket(at=(0.12, 1.0, -0.2), plug_at=(-0.2, 0.8, 0.12), cable_from=(0.28, 0.75, -0.18))
power = world.label("off", at=(0.12, 1.15, -0.15), height=0.04)


@world.on_step
def tell():
    power.text = "on" if lead.is_plugged else "off"


world.run()
