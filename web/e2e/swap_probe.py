# SPDX-License-Identifier: Apache-2.0
"""A row of balls that a box stands in for: the key k has the viewer come and go."""

from __future__ import annotations

import iota
from iota.builder import Structure
from iota.world.levels import Level, Managed

NEAR, FAR = (0.0, 0.0, 1.0), (0.0, 0.0, 500.0)
BALLS = 4


def box(thing: Managed) -> Structure:
    made = Structure()
    made.body(shape=iota.Box((1.6, 0.34, 0.34)), mass=thing.mass, position=tuple(thing.position))
    return made


def main() -> None:
    system = iota.System(gravity=(0, 0, 0))
    world = iota.World(system, title="swap", ground=None)
    world.camera = iota.Camera(position=(0, 0.6, 4), target=(0, 0, 0))
    balls = [
        system.body(shape=iota.Sphere(0.2), mass=1, position=(0.4 * k - 0.6, 0, 0), attachments=[(-0.2, 0, 0), (0.2, 0, 0)])
        for k in range(BALLS)
    ]
    for left, right in zip(balls, balls[1:], strict=False):
        left.attachments[1].combine(right.attachments[0])
    eye = [NEAR]
    world.levels.viewers = lambda: eye
    world.levels.manage(balls[0].articulate, levels=["full", Level("far", share=0.1, quality=0.5, structure=box)])
    world.levels.budget_ms = 1e-6

    @world.action("swap", key="k", on="world")
    def swap() -> None:
        eye[0] = FAR if eye[0] == NEAR else NEAR

    world.run()


if __name__ == "__main__":
    main()
