# SPDX-License-Identifier: Apache-2.0
"""The same molecule with springs for bonds: it hangs longer than the rigid one, whose outline is beside it. 1 m is 0.77 nm."""

from __future__ import annotations

from itertools import combinations

import numpy as np

import iota
from iota import looks, shapelib
from iota.studies.molecule import FILE, NAIL, SCALE, hang, present

REPULSION = "energy = 0.5*k*max(r0 - r, 0)^2"
OUTLINE = "#2f9d92"
BESIDE = iota.Vec3(-0.66, 0, 0)  # m, from the soft ring to the outline
NUDGE = 1.6  # rad/s, of a push
CALM = 0.05  # m/s; slower, it is pushed by itself
ROOM = 0.22  # m, a little more than a bond: nearer, atoms without one push each other away


def build() -> iota.World:
    """The world of the study."""
    system = iota.System(damping=0.3)
    world = iota.World(system, title="soft molecule: C8H16 on springs hangs longer; 1 m is 0.77 nm")
    hang_softly(world)
    present(world)
    outline(world)
    world.draw_ties("spring", looks.capsule(0.012, "rubber", color="#c8842c"))

    @world.action("nudge", key="n", help="pushes the ring to the side", on="world")
    def nudge() -> None:
        arms = system.positions - np.asarray(NAIL)
        # About the nail, as a rigid one would turn: a push of single atoms makes the springs ring.
        system.velocities += NUDGE * np.stack([-arms[:, 1], arms[:, 0], np.zeros(len(arms))], axis=1)

    @world.every(8.0)
    def nudge_by_itself() -> None:
        speeds = np.linalg.norm(system.velocities, axis=1)
        if world.users.held() is None and speeds.max() < CALM:
            nudge()

    return world


def outline(world: iota.World) -> None:
    """The rigid ring as it hangs at rest, by lines beside the soft one, and how deep it hangs."""
    places = at_rest() + np.asarray(BESIDE)
    for p, q in shapelib.molecule(FILE, "rigid", scale=SCALE).lines:
        world.drawings.line(places[[p, q]], radius=0.004, color=OUTLINE)
    x, y, z = places[np.argmin(places[:, 1])]
    world.drawings.line((x - 0.2, y, z), (NAIL.x + 0.3, y, z), color=OUTLINE)
    world.drawings.label("rigid", (x, y - 0.1, z))


def at_rest() -> np.ndarray:
    """Where the atoms of a rigid ring come to rest on the nail, (24, 3), m: its center of mass is below the nail."""
    points = shapelib.molecule(FILE, "rigid", scale=SCALE).points
    arms = points.position - points.position[1]
    down = np.average(arms, axis=0, weights=points.mass)
    places: np.ndarray = arms @ _turn(down / np.linalg.norm(down), np.array([0.0, -1.0, 0.0])).T + np.asarray(NAIL)
    return places


def _turn(start: np.ndarray, end: np.ndarray) -> np.ndarray:
    """The least rotation that turns one direction into another one, as a matrix."""
    x, y, z = np.cross(start, end)
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    turn: np.ndarray = np.eye(3) + cross + cross @ cross / (1 + start @ end)
    return turn


def hang_softly(world: iota.World, nail: iota.Vec3 = NAIL) -> iota.builder.Realized:
    """The ring on a nail; atoms without a bond push each other away."""
    made = hang(world, "soft", nail)
    for p, q in combinations(made.points, 2):
        if abs(p.position - q.position) > ROOM:
            world.system.bond(p, q, REPULSION, k=20, r0=ROOM)
    return made
