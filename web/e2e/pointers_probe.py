# SPDX-License-Identifier: Apache-2.0
"""A ball, and what a script hears of pointers, as JSON lines, for browser tests."""

from __future__ import annotations

import json

import iota


def build() -> iota.World:
    system = iota.System(gravity=(0, 0, 0))
    ball = system.body(shape=iota.Sphere(0.3), mass=1.0, position=(0, 1, 0))
    ball.particles[0].nail()
    world = iota.World(system, title="pointers")
    world.camera = iota.Camera(position=(0, 1, 3), target=(0, 1, 0))

    @world.on_pointer
    def moved(event: iota.Event) -> None:
        hand = event.hand
        assert hand is not None and event.point is not None and event.origin is not None and event.direction is not None
        told = {
            "pointer": event.pointer,
            "at": [round(x, 3) for x in event.point],
            "ahead": [round(x, 3) for x in event.direction],
            "trigger": round(hand.trigger, 2),
            "grip": round(hand.grip, 2),
            "stick": [round(x, 2) for x in hand.stick],
            "joints": len(hand.joints),
        }
        print(json.dumps(told), flush=True)

    return world
