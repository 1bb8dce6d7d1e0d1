# SPDX-License-Identifier: Apache-2.0
"""One gusty wind on everything: a flag streams, the beads in a bowl slosh, the sparks of a fountain lean. Everything here is forces."""

from __future__ import annotations

import math

import numpy as np

import iota
from iota import looks

COLUMNS, ROWS, SPACING = 13, 8, 0.065  # of the flag; m
BEADS, BEAD = 80, 0.03  # radius, m
NEAR, STACKED = 0.07, 0.066  # m: so near, beads push each other away; between neighbors at the start
BOWL, WIRE = 0.26, 0.008  # radius, and that of its wire, m
MIDDLE = iota.Vec3(0.15, 1.05, 0)  # of the bowl, m
NOZZLE = iota.Vec3(0.85, 0.6, 0.1)  # of the fountain, m
WIND = iota.Vec3(4.0, 0.5, 0.5)  # m/s
DRAG = 0.025  # N s/m, of each particle: the lighter it is, the more it is moved


def build() -> iota.World:
    """The world of the study."""
    world = iota.World(
        iota.System(mode="robust", damping=0.05), title="weather: one wind for a flag of 0.8 m, beads and sparks"
    )
    # Gusts of two meters and less, the same for all three: a gust that lifts the flag goes on to the beads and the sparks.
    wind = world.system.field("current", velocity=WIND, drag=DRAG, speed=1.8, size=1.5, octaves=4, evolution=0.8)
    flag(world, iota.Vec3(-0.95, 1.75, 0))
    world.draw_ties("spring", [])
    beads(world, MIDDLE)
    fountain(world, NOZZLE)
    world.stage(ground="#8a9670")
    world.camera = iota.Camera(position=(0.1, 1.35, 3.0), target=(0.1, 0.92, 0))

    @world.action("calm", key="n", help="the wind drops, or comes back", on="world")
    def calm() -> None:
        wind.active = not wind.active

    @world.action("tear", key="b", button="b", help="tears what you hold out of its threads", on="body")
    def tear(event: iota.Event) -> None:
        for bond in list(world.system.bonds):
            if event.body in (end.body for end in bond.ends):
                bond.destroy()

    return world


def point(system: iota.System, place: iota.Vec3, mass: float, radius: float) -> iota.Particle:
    """A body of one particle."""
    particle = system.body().particle(place, mass)
    particle.radius = radius
    return particle


def flag(world: iota.World, corner: iota.Vec3, color: str = "#c8842c") -> iota.Group:
    """A cloth of springs on a pole. It tears where somebody pulls too hard. Returns its particles, for a wind."""
    system, cloth = world.system, iota.builder.Structure()
    row, column = np.indices((ROWS, COLUMNS))
    places = np.asarray(corner) + SPACING * np.stack([column, -row, 0 * row], axis=-1)
    knots = np.array(cloth.points.add(places.reshape(-1, 3), mass=0.004)).reshape(ROWS, COLUMNS)
    along = zip(knots[:, :-1].flat, knots[:, 1:].flat, strict=True)
    down = zip(knots[:-1].flat, knots[1:].flat, strict=True)
    for p, q in (*along, *down):
        cloth.bond(p, q, "spring", stiffness=60, damping=0.02, break_force=6)
    cloth.nail(*knots[:, 0])
    cloth.group("cloth", knots.flat)
    cloth.points.radius[:], cloth.points.color[:] = 0.001, (0.78, 0.52, 0.17)
    made = cloth.realize(system)
    cells = [(int(knots[r, c]), int(knots[r + 1, c])) for r in range(ROWS - 1) for c in range(COLUMNS - 1)]
    triangles = [t for k, below in cells for t in ((k, below, k + 1), (k + 1, below, below + 1))]
    world.surface(list(made.points), triangles, threads=made.bonds, material="rubber", color=color)
    world.add_strut(
        tuple(corner + (-0.012, 0.06, 0)), (corner.x - 0.012, 0.0, corner.z), looks.cylinder(0.012, "steel")
    )
    return made.groups["cloth"]


def fountain(world: iota.World, nozzle: iota.Vec3) -> None:
    """Sparks that are born, age, change their color and die."""
    spout = world.system.emitter(
        rate=400, source=iota.Sphere(0.01), position=nozzle, velocity=(0, 4.2, 0), velocity_spread=0.45,
        lifetime=1.0, lifetime_spread=0.15, mass=0.08,
        curve=[(0, 0.007, (1, 0.95, 0.6)), (0.5, 0.012, (1, 0.5, 0.1)), (1, 0.004, (0.35, 0.05, 0.1))],
    )  # fmt: skip
    world.add_strut((nozzle.x, 0, nozzle.z), (nozzle.x, nozzle.y - 0.02, nozzle.z), looks.cylinder(0.03, "brass"))

    @world.action("fountain", key="u", help="turns the fountain off and on", on="world")
    def turn() -> None:
        spout.active = not spout.active


def beads(world: iota.World, middle: iota.Vec3) -> None:
    """Beads that push each other away, in a bowl that they cannot leave: a pairwise law and an inequality each."""
    system = world.system
    group = system.group("beads")
    room = BOWL - WIRE - BEAD
    # As balls are stacked: the lowest places of a lattice.
    i, j, k = np.indices((13, 13, 13)).reshape(3, -1) - 6
    lattice = STACKED * np.stack([i + (j + k) % 2 / 2, (2 / 3) ** 0.5 * k, 3**0.5 / 2 * (j + k % 2 / 3)], axis=1)
    inside = [place for place in lattice.tolist() if math.hypot(*place) < room]
    for number, place in enumerate(sorted(inside, key=lambda at: (at[1], math.hypot(*at)))[:BEADS]):
        bead = point(system, middle + place, mass=0.05, radius=BEAD)
        system.inside(bead, iota.Sphere(room), at=middle)
        group.add(bead)
        bead.color = (0.15, 0.45 + 0.4 * number / BEADS, 0.75)
    system.pair_force("soft_repulsion", cutoff=NEAR, group=group, stiffness=400, length=NEAR)
    system.field("wind", group=group, drag=0.2)
    world.add_static(looks.torus(BOWL, WIRE, "steel"), tuple(middle), (0.5**0.5, 0, 0, 0.5**0.5))
    world.surface(*half_ball(BOWL), at=middle, color="#a9d0dfa0", material="glass")
    world.add_strut((middle.x, 0, middle.z), (middle.x, middle.y - BOWL, middle.z), looks.cylinder(0.02, "steel"))


def half_ball(
    radius: float, around: int = 48, rows: int = 12
) -> tuple[list[tuple[float, float, float]], list[tuple[int, int, int]]]:
    """The lower half of a ball: points, m, and triangles."""
    points, triangles = [(0.0, -radius, 0.0)], [(0, 1 + k, 1 + (k + 1) % around) for k in range(around)]
    for row in range(1, rows + 1):
        a = math.pi / 2 * row / rows
        turns = [2 * math.pi * k / around for k in range(around)]
        points += [
            (radius * math.sin(a) * math.cos(b), -radius * math.cos(a), radius * math.sin(a) * math.sin(b))
            for b in turns
        ]
    for row in range(rows - 1):
        for k in range(around):
            i, j = 1 + row * around + k, 1 + row * around + (k + 1) % around
            triangles += [(i, i + around, j), (j, i + around, j + around)]
    return points, triangles
