# SPDX-License-Identifier: Apache-2.0
"""A ball, an action and a panel of controls, for browser tests of roles; prints the addresses of guests and viewers, and what they do."""

from __future__ import annotations

import json

import iota


def tell(**what: object) -> None:
    print(json.dumps(what), flush=True)


def build() -> iota.World:
    system = iota.System(gravity=(0, 0, 0))
    system.body(shape=iota.Sphere(0.4), mass=1.0, position=(0, 1, 0))
    system.damping = 5.0
    world = iota.World(system, title="roles")

    @world.controls.action("push", key="b", label="Push")
    def push(event: iota.Event) -> None:
        tell(pushed_by=event.client)

    slider = world.controls.slider("force", 0, 1)

    @slider.on_change
    def slide(event: iota.Event) -> None:
        tell(slid_by=event.client)

    @world.controls.button("again")
    def press(event: iota.Event) -> None:
        tell(pressed_by=event.client)

    told: list[bool] = []

    @world.every(0.05)
    def report() -> None:
        if not told and world.pages.link("guest") is not None:
            told.append(True)
            tell(guest=world.pages.link("guest"), viewer=world.pages.link("viewer"))

    return world
