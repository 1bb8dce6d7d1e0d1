# SPDX-License-Identifier: Apache-2.0
"""The same molecule with springs for bonds: it hangs longer than the rigid one, which is beside it. 1 m is 0.77 nm."""

from __future__ import annotations

from itertools import combinations

import numpy as np

import iota
from iota import looks
from iota.studies._stands import arm
from iota.studies.molecule import NAIL, hang, present

BESIDE = iota.Vec3(-0.85, 0, 0)  # m, from the soft ring to the rigid one
ROOM = 0.22  # m, a little more than a bond: nearer, atoms without one push each other away
CALM = 0.04  # m/s of the atoms: slower, the ring is nudged by itself


def build() -> iota.World:
    """The world of the study."""
    system = iota.System(damping=0.3)
    world = iota.World(system, title="soft molecule: C8H16 on springs hangs longer; 1 m is 0.77 nm")
    rings = {"soft": hang_softly(world), "rigid": hang(world, "rigid", NAIL + BESIDE)}
    soft, _ = atoms = [system.array(ring.points) for ring in rings.values()]
    present(world)
    arm(world, NAIL + BESIDE)
    # As wide as in the middle where the ends are as far apart as those of a bond between carbon atoms.
    world.draw_ties("spring", looks.ellipsoid((0.2, 0.06, 0.06), "rubber", color="#d9902f"))
    world.camera = iota.Camera(position=(0.08, 1.05, 2.05), target=tuple(NAIL + (-0.42, -0.53, -0.1)))
    labels = [world.drawings.label("", at=at + (0, 0.09 - NAIL.y, -0.25), height=0.03) for at in (NAIL, NAIL + BESIDE)]

    @world.every(0.1)
    def tell_lengths() -> None:
        for name, ring, label in zip(rings, atoms, labels, strict=True):
            label.text = f"{name}: {0.77 * (NAIL.y - ring.positions[:, 1].min()):.2f} nm"

    tell_lengths()

    @world.action("nudge", key="n", help="pushes the soft ring to the side", on="world")
    def nudge() -> None:
        # About the nail, as a rigid one would turn: a push of single atoms makes the springs ring.
        soft.velocities += 1.6 * np.cross((0, 0, 1), soft.positions - np.asarray(NAIL))

    @world.every(2.0)
    def nudge_what_is_calm() -> None:
        if world.users.held() is None and np.linalg.norm(soft.velocities, axis=1).mean() < CALM:
            nudge()

    return world


def hang_softly(world: iota.World, nail: iota.Vec3 = NAIL) -> iota.builder.Realized:
    """The ring on a nail; atoms without a bond push each other away."""
    made = hang(world, "soft", nail)
    for p, q in combinations(made.points, 2):
        if abs(p.position - q.position) > ROOM:
            world.system.bond(p, q, "energy = 0.5*k*max(r0 - r, 0)^2", k=20, r0=ROOM)
    return made
