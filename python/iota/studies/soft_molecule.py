# SPDX-License-Identifier: Apache-2.0
"""The same molecule with springs for bonds: it hangs longer than the rigid one, which is beside it. 1 m is 0.77 nm."""

from __future__ import annotations

from itertools import combinations

import numpy as np

import iota
from iota import looks
from iota.studies.molecule import NAIL, hang, present, stand

BESIDE = iota.Vec3(-0.85, 0, 0)  # m, from the soft ring to the rigid one
ROOM = 0.22  # m, a little more than a bond: nearer, atoms without one push each other away


def build() -> iota.World:
    """The world of the study."""
    system = iota.System(damping=0.3)
    world = iota.World(system, title="soft molecule: C8H16 on springs hangs longer; 1 m is 0.77 nm")
    atoms = system.array(hang_softly(world).points)
    hang(world, "rigid", NAIL + BESIDE)
    stand(world, NAIL + BESIDE)
    present(world)
    world.draw_ties("spring", looks.capsule(0.012, "rubber", color="#c8842c"))

    @world.action("nudge", key="n", help="pushes the soft ring to the side", on="world")
    def nudge() -> None:
        # About the nail, as a rigid one would turn: a push of single atoms makes the springs ring.
        atoms.velocities += 1.6 * np.cross((0, 0, 1), atoms.positions - np.asarray(NAIL))

    return world


def hang_softly(world: iota.World, nail: iota.Vec3 = NAIL) -> iota.builder.Realized:
    """The ring on a nail; atoms without a bond push each other away."""
    made = hang(world, "soft", nail)
    for p, q in combinations(made.points, 2):
        if abs(p.position - q.position) > ROOM:
            world.system.bond(p, q, "energy = 0.5*k*max(r0 - r, 0)^2", k=20, r0=ROOM)
    return made
