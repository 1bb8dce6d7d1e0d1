# SPDX-License-Identifier: Apache-2.0
"""A cloth on a bar; pull, and it tears. n lets the wind blow, b tears a knot out, c makes a new cloth."""

from __future__ import annotations

import iota
from iota import looks

CORNER = iota.Vec3(-0.6, 2.0, 0)
COLUMNS, ROWS, SPACING = 17, 13, 0.075  # m
TEAR = 6.0  # N, what a thread carries


def build() -> iota.World:
    """The world of the study."""
    system = iota.System(mode="robust", damping=0.2)
    world = iota.World(system, title="cloth: it hangs in the wind, and rips where it is pulled; 1.2 m wide")
    cloth = iota.builder.cloth(COLUMNS, ROWS, SPACING, CORNER, mass=0.3, stiffness=120, damping=0.05, tear=TEAR)
    cloth.points.radius[:] = 0.003
    made = cloth.realize(system)
    wind = system.field(
        "current", group=made.groups["cloth"], velocity=(0.3, 0, 1.2), drag=0.004, speed=1.0, size=0.6, evolution=1.0
    )
    present(world, made)

    @world.action("wind", key="n", help="the wind drops, or comes back", on="world")
    def blow() -> None:
        wind.active = not wind.active

    @world.action("tear", key="b", button="b", help="tears what you hold out of its threads")
    def tear(event: iota.Event) -> None:
        for bond in system.bonds:
            if event.body in (end.body for end in bond.ends):
                bond.destroy()

    @world.action("mend", key="c", button="a", help="a new cloth", on="world")
    def mend() -> None:
        world.reset()

    return world


def present(world: iota.World, made: iota.builder.Realized) -> None:
    """The cloth between its threads, and the frame with the bar that holds the upper edge."""
    world.draw_ties("spring", [])
    corners = [(row * COLUMNS + column, COLUMNS) for row in range(ROWS - 1) for column in range(COLUMNS - 1)]
    triangles = [t for k, below in corners for t in ((k, k + below, k + 1), (k + 1, k + below, k + below + 1))]
    world.surface(list(made.points), triangles, threads=made.bonds, color="#b0303a")
    world.drawings.paint([point.body for point in made.points], "#e8606a")  # they are in the shadow of their cloth
    left, right, y = CORNER.x - 0.3, CORNER.x + (COLUMNS - 1) * SPACING + 0.3, CORNER.y
    world.add_strut((left, y, 0), (right, y, 0), looks.cylinder(0.014, "wood"))
    for x in (left, right):
        world.add_strut((x, 0, 0), (x, y + 0.03, 0), looks.cylinder(0.02, "wood"))
        world.add_static(looks.box((0.06, 0.04, 0.5), "wood"), (x, 0.02, 0))
    world.camera = iota.Camera(position=(1.0, 1.5, 3.5), target=(0, 1.05, 0))
