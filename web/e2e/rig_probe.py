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
    said = ""

    @world.on_frame
    def tell() -> None:
        nonlocal said
        now = {"pressed": button.pressed, "on": switch.is_on, "slide": round(drawer.slide, 2)}
        if (text := json.dumps(now)) != said:
            said = text
            print(text, flush=True)

    return world
