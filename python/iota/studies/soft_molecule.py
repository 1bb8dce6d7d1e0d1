# SPDX-License-Identifier: Apache-2.0
"""The same molecule with springs for bonds: it hangs longer than it is. 1 m is 0.77 nm."""

from __future__ import annotations

from itertools import combinations

import iota
from iota import looks
from iota.studies.molecule import NAIL, hang, present

REPULSION = "energy = 0.5*k*max(r0 - r, 0)^2"
ROOM = 0.22  # m, a little more than a bond: nearer, atoms without one push each other away


def build() -> iota.World:
    """The world of the study."""
    system = iota.System(damping=0.3)
    world = iota.World(system, title="soft molecule: C8H16 on springs hangs longer; 1 m is 0.77 nm")
    hang_softly(world)
    present(world)
    world.draw_ties("spring", looks.capsule(0.012, "rubber", color="#c8842c"))

    @world.action("nudge", key="n", help="nudges what you hold, or what you have selected")
    def nudge(event: iota.Event) -> None:
        for particle in event.body.particles:
            particle.velocity += (1.5, 0, 0)

    return world


def hang_softly(world: iota.World, nail: iota.Vec3 = NAIL) -> iota.builder.Realized:
    """The ring on a nail; atoms without a bond push each other away."""
    made = hang(world, "soft", nail)
    for p, q in combinations(made.points, 2):
        if abs(p.position - q.position) > ROOM:
            world.system.bond(p, q, REPULSION, k=20, r0=ROOM)
    return made
