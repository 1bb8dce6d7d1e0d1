# SPDX-License-Identifier: Apache-2.0
"""Sixty carbon atoms in a cage of springs breathe; b gives a breath, c mends the ball, v looks from within, and back. 1 m is 0.71 nm."""

from __future__ import annotations

import math

import numpy as np

import iota
from iota import looks, shapelib

RADIUS = 0.5  # m
CENTER = iota.Vec3(0, 1.3, 0)
PERIOD = 1.6  # s, of a breath
# From a particle at the center to each atom: it keeps the cage from collapsing.
PRESSURE = "energy = 0.5*k*(r - r0)^2"
# 1/s; m/s of the atoms below which it takes another breath by itself; s between two looks
TIRES, CALM, EVERY = 0.12, 0.06, 1.0
SHARE = 0.5  # of the stiffness against breathing is the center's, the rest that of the cage's springs


def build() -> iota.World:
    """The world of the study."""
    system = iota.System(gravity=(0, 0, 0), damping=TIRES)
    world = iota.World(system, title="bucky: sixty carbon atoms breathe; 1 m is 0.71 nm")
    atoms = system.array(make(system).points[:60])
    whole = system.positions
    breathe(atoms, 0.22)
    present(world)

    @world.action("breathe", key="b", help="sends a breath through the ball", on="world")
    def breath() -> None:
        breathe(atoms, 0.15)

    @world.every(EVERY)
    def breath_by_itself() -> None:
        speeds = np.linalg.norm(system.velocities, axis=1)
        if world.users.held() is None and math.sqrt(float((speeds**2).mean())) < CALM:
            breathe(atoms, 0.2)

    @world.action("mend", key="c", help="puts all atoms back in place", on="world")
    def mend() -> None:
        with system.edit():
            system.positions, system.velocities = whole, np.zeros_like(whole)

    outside = world.camera
    inside = iota.Camera(position=tuple(CENTER + (0, 0, 0.15)), target=tuple(CENTER + (1, 0.3, -1)))

    @world.action("within", key="v", help="looks from within, and from outside again", on="world")
    def within() -> None:
        world.camera = outside if world.camera == inside else inside

    return world


def make(system: iota.System, center: iota.Vec3 = CENTER) -> iota.builder.Realized:
    """The cage around a particle that is nailed, the last one."""
    cage = shapelib.polyhedron("fullerene 60", "soft", scale=RADIUS, mass=0.72, at=center, damping=0.0, radius=0.035)
    tune(cage)
    middle = cage.point(center, mass=1.0)
    for atom in range(60):
        cage.bond(middle, atom, PRESSURE, k=SHARE * breathing_stiffness() / 60, r0=RADIUS)
    cage.points.radius[:60], cage.points.color[:60] = 0.035, (0.25, 0.28, 0.32)
    cage.points.radius[60], cage.points.color[60] = 0.02, (0.9, 0.5, 0.1)
    made = cage.realize(system)
    made.points[60].nail()
    return made


def breathing_stiffness() -> float:
    """N/m, against a change of the radius: that which gives the mass of all atoms the period."""
    return 0.72 * (2 * math.pi / PERIOD) ** 2


def tune(cage: shapelib.Imported) -> None:
    """Makes the cage's springs so stiff that together they are the rest of the stiffness against breathing, to which a spring of
    length L and stiffness k adds k (L / R)^2."""
    ends = np.array([(bond.p, bond.q) for bond in cage.bonds])
    length = np.linalg.norm(cage.points.position[ends[:, 0]] - cage.points.position[ends[:, 1]], axis=1)
    names = ["stiffness" if "stiffness" in bond.parameters else "k" for bond in cage.bonds]
    present = [float(bond.parameters[name] or 0) for bond, name in zip(cage.bonds, names, strict=True)]
    factor = (1 - SHARE) * breathing_stiffness() / float(np.dot(present, (length / RADIUS) ** 2))
    for bond, name, k in zip(cage.bonds, names, present, strict=True):
        bond.parameters[name] = factor * k


def breathe(atoms: iota.ParticleArray, speed: float, center: iota.Vec3 = CENTER) -> None:
    """Pushes all atoms outwards. speed: m/s; a little less above than below: no breath is quite even."""
    velocities = atoms.velocities
    way = atoms.positions - np.asarray(center)
    velocities += speed / RADIUS * way * (1 - 0.3 * way[:, 1:2] / RADIUS)
    atoms.velocities = velocities


def present(world: iota.World) -> None:
    """The cage's springs, its stand, and where one stands in front of it."""
    world.draw_ties("spring", looks.cylinder(0.012, "brass"))
    stand(world)
    world.stage("studio")
    world.camera = iota.Camera(position=(1.2, 1.5, 2.5), target=(CENTER.x, 1.02, CENTER.z))


def stand(world: iota.World, center: iota.Vec3 = CENTER) -> None:
    """A ring that does not move, of the ball's size at rest: what breathes is the ball, not the camera."""
    x, y, z = center
    world.add_static(looks.torus(RADIUS + 0.19, 0.008, "steel"), (x, y, z))
    world.add_strut((x, 0, z), (x, y - RADIUS - 0.19, z), looks.cylinder(0.015, "steel"))
    world.add_static(looks.cylinder(0.16, "steel", length=0.02), (x, 0.01, z), (0, 0, 0.5**0.5, 0.5**0.5))
