# SPDX-License-Identifier: Apache-2.0
"""The same molecule with springs for bonds: it hangs longer than the rigid one, which is beside it. 1 m is 0.77 nm."""

from __future__ import annotations

import math
from itertools import combinations

import numpy as np

import iota
from iota import looks
from iota.studies.molecule import NAIL, hang, present, stand

BESIDE = iota.Vec3(-0.85, 0, 0)  # m, from the soft ring to the rigid one
ROOM = 0.22  # m, a little more than a bond: nearer, atoms without one push each other away
BOND = "#d9902f"
# m/s of the atoms below which it is nudged by itself; s between two looks
CALM, EVERY = 0.04, 2.0
NANOMETERS = 0.77  # in a meter


def build() -> iota.World:
    """The world of the study."""
    system = iota.System(damping=0.3)
    world = iota.World(system, title="soft molecule: C8H16 on springs hangs longer; 1 m is 0.77 nm")
    soft = system.array(hang_softly(world).points)
    rigid = system.array(hang(world, "rigid", NAIL + BESIDE).points)
    present(world)
    stand(world, NAIL + BESIDE)
    # As wide as in the middle where the ends are as far apart as those of a bond between carbon atoms.
    world.draw_ties("spring", looks.ellipsoid((0.2, 0.06, 0.06), "rubber", color=BOND))
    middle = NAIL + BESIDE * 0.5
    world.camera = iota.Camera(position=(middle.x + 0.5, 1.05, 2.05), target=(middle.x, NAIL.y - 0.53, NAIL.z - 0.1))
    tell_lengths(world, {"soft": soft, "rigid": rigid})

    @world.action("nudge", key="n", help="pushes the soft ring to the side", on="world")
    def nudge() -> None:
        # About the nail, as a rigid one would turn: a push of single atoms makes the springs ring.
        soft.velocities += 1.6 * np.cross((0, 0, 1), soft.positions - np.asarray(NAIL))

    @world.every(EVERY)
    def nudge_by_itself() -> None:
        if world.users.held() is None and math.sqrt(float((soft.velocities**2).sum(axis=1).mean())) < CALM:
            nudge()

    return world


def tell_lengths(world: iota.World, rings: dict[str, iota.ParticleArray]) -> None:
    """How far each ring reaches down from its nail, on its stand."""
    labels = {
        name: world.drawings.label("", at=at + (0, 0.09 - NAIL.y, -0.25), height=0.03)
        for name, at in (("soft", NAIL), ("rigid", NAIL + BESIDE))
    }

    def tell() -> None:
        for name, ring in rings.items():
            reach = NAIL.y - float(ring.positions[:, 1].min())
            labels[name].text = f"{name}: {NANOMETERS * reach:.2f} nm"

    tell()
    world.every(0.1)(tell)


def hang_softly(world: iota.World, nail: iota.Vec3 = NAIL) -> iota.builder.Realized:
    """The ring on a nail; atoms without a bond push each other away."""
    made = hang(world, "soft", nail)
    for p, q in combinations(made.points, 2):
        if abs(p.position - q.position) > ROOM:
            world.system.bond(p, q, "energy = 0.5*k*max(r0 - r, 0)^2", k=20, r0=ROOM)
    return made
