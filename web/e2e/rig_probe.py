# SPDX-License-Identifier: Apache-2.0
"""A world for the browser test of ready parts: prints what they read after each change, in one line of JSON."""

from __future__ import annotations

import json

import iota


def build() -> iota.World:
    world = iota.World(iota.System(), title="rig", ground=0, camera=iota.Camera((0.4, 1.5, 1.7), (0.1, 1.1, 0)))
    button = world.push_button((-0.3, 1.2, 0), radius=0.05)
    switch = world.switch((0, 1.2, 0))
    drawer = world.drawer((0.3, 1.0, 0))
    table = world.table((0.1, 0, 0.55), size=(0.9, 0.4), height=0.9)
    ball = world.system.body(shape=iota.Sphere(0.05), mass=0.3, position=table.top + (-0.2, 0.05, 0), color="tomato")
    ball.material = iota.Material(rolling=0.05)
    world.tools.push()
    said = ""

    @world.on_frame
    def tell() -> None:
        nonlocal said
        now = {"pressed": button.pressed, "on": switch.is_on, "slide": round(drawer.slide, 2)}
        now |= {"ball": round(ball.position.z, 2), "paddles": sum(body.name == "paddle" for body in world.system.bodies)}
        if (text := json.dumps(now)) != said:
            said = text
            print(text, flush=True)

    return world
