# SPDX-License-Identifier: Apache-2.0
"""Cards beside labels and controls, things at levels, and a key for each, for browser tests."""

from __future__ import annotations

import math

import iota


def build() -> iota.World:
    system = iota.System(gravity=(0, 0, 0))
    kept = [system.body(shape=iota.Sphere(0.2), mass=1.0, position=(0.6 * k, 0.5, 0)) for k in range(3)]
    far = [system.body(shape=iota.Sphere(0.2), mass=1.0, position=(0.6 * k, 1.2, 0)) for k in range(3)]
    world = iota.World(system, title="notices", ground=0.0, camera=iota.Camera((0.6, 1, 4), (0.6, 0.9, 0)))
    world.drawings.label("Which of these balls is the heaviest?", offset=(0.6, 2.25, 0))
    world.controls.slider("mass", 0, 1)
    world.levels.reach = 0.0
    world.levels.budget_ms = 1e3
    for ball in kept:
        world.levels.pin(ball)
    for ball in far:
        world.levels.manage(ball, significance=lambda thing: 1.0)
    notice = world.users.notice

    @world.on_key("1")
    def free() -> None:
        notice("Free", "It lies on nothing that matters.", seconds=math.inf, id="free")

    @world.on_key("2")
    def left() -> None:
        notice("Left", seconds=math.inf, id="left", place="left")

    @world.on_key("3")
    def again() -> None:
        notice("Left again", seconds=math.inf, id="left", place="bottom")

    @world.on_key("4")
    def close() -> None:
        world.users.close_notice("left")

    @world.on_key("5")
    def soon() -> None:
        notice("Soon over", seconds=0.7)

    @world.on_key("6")
    def reduce() -> None:
        world.levels.budget_ms = 1e-3

    return world
