# SPDX-License-Identifier: Apache-2.0
"""Appendix E.1 of the thesis: one rigid body of two particles, 30 m long, falls under a gentle gravity of 1 m/s^2."""

from __future__ import annotations

import iota
from iota import looks

GROUND = -40.0  # m
PIECE = 10.0  # of a post, m
SCALE = f"a piece of a post is {PIECE:g} m long"


def build() -> iota.World:
    """The world of the study."""
    system = iota.System(gravity=(0, -1))
    body1 = system.body()
    particle1 = body1.particle()
    particle2 = body1.particle((30, 0, 0))
    # Something to be seen between them; the body is rigid without it.
    system.cosmetic_bond(particle1, particle2)
    return present(
        iota.World(system, title=f"Appendix E.1: a rigid body of two particles falls; {SCALE}", ground=GROUND)
    )


def present(world: iota.World) -> iota.World:
    """The look of all three scripts of the appendix: balls with sticks between them, before a frame that shows how far
    they fall; a while after they have landed, they begin anew."""
    system = world.system
    world.draw([body for body in system.bodies if len(body.particles) > 1], looks.capsule(0.5, "brass"))
    for particle, color in zip(system.particles, ((0.9, 0.3, 0.2), (0.15, 0.5, 0.55)) * 2, strict=False):
        particle.radius, particle.color = 2.0, color
    world.draw_ties("spring", looks.capsule(0.3, "rope"))
    places = [particle.position.x for particle in system.particles]
    left, right = min(places) - 10, max(places) + 10
    for x in (left, right):
        for number in range(6):
            foot = GROUND + PIECE * number
            piece = looks.cylinder(0.8, "wood", color="#9c6a3c" if number % 2 else "#efe9dc")
            world.add_strut((x, foot, -20), (x, foot + PIECE, -20), piece)
    world.add_strut((left - 1, 20, -20), (right + 1, 20, -20), looks.cylinder(0.8, "wood"))
    middle = (left + right) / 2
    world.every(12.0)(lambda: None if world.users.held() else world.reset())
    world.stage("studio")
    world.camera = iota.Camera(position=(middle + 10, -5, 90), target=(middle, -13, 0))
    return world
