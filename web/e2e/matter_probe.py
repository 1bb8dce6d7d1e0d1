# SPDX-License-Identifier: Apache-2.0
"""Balls and boxes of metal, plastic and wood at rest over the ground, for browser tests of light and matter. Key n: other surroundings."""

from __future__ import annotations

import iota
from iota import looks


def build() -> iota.World:
    system = iota.System(gravity=(0, 0, 0))
    world = iota.World(system, title="matter", ground=0.0)
    world.camera = iota.Camera(position=(0, 0.75, 3.2), target=(0, 0.35, 0))
    ball = iota.Sphere(0.3)
    for x, look in (
        (-0.75, looks.solid("steel")),
        (0.0, looks.solid("paint", "#c8322b")),
        (0.75, looks.solid("brass")),
    ):
        world.draw(system.body(shape=ball, mass=1.0, position=(x, 0.3, 0)), look)
    box = iota.Box((0.5, 0.24, 0.3))
    for x, look in (
        (-1.3, looks.solid("wood")),
        (-0.38, looks.solid("steel")),
        (0.38, looks.solid("paint", "#2f6fb0")),
        (1.3, looks.solid("paint")),
    ):
        world.draw(system.body(shape=box, mass=1.0, position=(x, 0.12, 0.75)), look)
    warm = world.drawings.stage(sky="#40608a", horizon="#e0a870", ground="#3f7a3a")
    warm.visible = False

    @world.on_key("n")
    def evening() -> None:
        warm.visible = not warm.visible

    return world


if __name__ == "__main__":
    build().run()
