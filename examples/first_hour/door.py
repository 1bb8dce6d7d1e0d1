# SPDX-License-Identifier: Apache-2.0
"""A door with a lever handle: take the handle, and pull it towards you."""

import iota

system = iota.System()
world = iota.World(system, title="door: take its handle and pull; 2 m high")
door = world.door(at=(0, 0, 0), label="office", color="#7fa08c")
for x in (-1.04, 1.04):
    world.wall(at=(x, 0, 0), size=(1.0, 2.4))
sign = world.label("shut", at=(0, 2.3, 0.1), height=0.08)


@world.on_step
def tell():
    sign.text = "open" if door.is_open else "shut"


world.run()
