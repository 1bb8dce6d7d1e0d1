# SPDX-License-Identifier: Apache-2.0
"""A laboratory to walk through: a ladder before a monitor and a cradle on a desk, both to play with. v goes to the next view."""

from __future__ import annotations

import iota
from iota import looks
from iota.studies import _laboratory, cradle, ladder
from iota.studies._laboratory import TOP

LADDER = iota.Vec3(-0.3, 1.46, 0.02)  # the axle of its top block, m
CRADLE = iota.Vec3(0.14, TOP, 0.14)
VIEWS = (
    iota.Camera(position=(0.3, 1.45, 1.5), target=(-0.1, 1.12, -0.1)),
    iota.Camera(position=(0.05, 1.4, 1.0), target=(LADDER.x, 1.25, 0)),
    iota.Camera(position=(0.35, 1.1, 0.85), target=(CRADLE.x, TOP + 0.1, CRADLE.z)),
)


def build() -> iota.World:
    """The world of the study."""
    world = iota.World(iota.System(damping=0.06), title="lab: two toys in a room of 9 x 7 m", dt=1 / 240, ground=None)
    room = _laboratory.Furniture()
    _laboratory.screen(room, (LADDER.x, TOP, LADDER.z - 0.07), 0.44, 0.7, lift=0.1)
    room.show(world)
    _laboratory.furnish(world)
    world.add_strut(tuple(LADDER - (0, 0, 0.06)), tuple(LADDER + (0, 0, 0.035)), looks.cylinder(0.003, "steel"))
    blocks = ladder.Ladder(world, 7, LADDER)
    story = ladder.add_actions(world, blocks)
    cradle.add_actions(world, cradle.Cradle(world, CRADLE), on_lift=story.touch)
    world.camera = VIEWS[0]
    world.levels.manage(blocks.axle.a, levels=("full", "frozen"), name="ladder")
    world.levels.budget_ms = 4.0

    @world.action("view", key="v", help="looks at the ladder, at the cradle, at the whole room", on="world")
    def next_view() -> None:
        world.camera = VIEWS[(VIEWS.index(world.camera) + 1) % len(VIEWS)]

    return world
