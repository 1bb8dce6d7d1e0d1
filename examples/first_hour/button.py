# SPDX-License-Identifier: Apache-2.0
"""A button on a pedestal switches a lamp: press it with a finger, the mouse or Enter."""

import iota

system = iota.System()
world = iota.World(system, title="button: press it, and the lamp lights")
world.add_static(iota.looks.box((0.3, 1.0, 0.3), "wood", 0.01), (0, 0.5, 0))
world.add_static(iota.looks.cylinder(0.015, "steel", 0.5), (0.5, 0.25, 0), ("z", 90))
lamp = system.body("static", shape=iota.Sphere(0.09), position=(0.5, 0.58, 0), color="#454035")
light = world.drawings.light("point", at=(0.5, 0.58, 0.15), color="#ffd070", intensity=0, reach=1.0)
presses = world.label("0 times", at=(0, 1.35, 0), height=0.06)
count = 0


def press():
    global count
    count += 1
    presses.text = f"{count} times"
    lamp.color = "#ffe9a8" if count % 2 else "#454035"
    light.intensity = count % 2


button = world.push_button(at=(0, 1.0, 0), facing=(0, 1, 0), on_press=press, radius=0.06)
world.run()
