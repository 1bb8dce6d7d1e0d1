# SPDX-License-Identifier: Apache-2.0
"""Makers of long, thin structures: rope, ring, snake."""

from __future__ import annotations

import math

import numpy as np

from iota import looks
from iota._core import Capsule
from iota.builder.chain import chain
from iota.builder.dressing import Dress, check, check_counts, dress, place
from iota.builder.parts import RigidBody
from iota.builder.points import Vector
from iota.builder.structure import Structure


def rope(
    length: float = 2.0,
    pieces: int = 40,
    radius: float = 0.01,
    top: Vector = (0, 2.5, 0),
    direction: Vector = (0, -1, 0),
    density: float = 900.0,
    nailed: bool = True,
    look: Dress | None = None,
) -> Structure:
    """Short hinged rods: the rope keeps its length and bends freely. length, radius: m. density: kg/m^3. Bodies:
    "piece".

    iota.builder.rope(length=3, top=(0, 3, 0)).realize(system, world)
    """
    check(length=length, radius=radius, density=density)
    check_counts(pieces=pieces)
    mass = density * math.pi * radius**2 * length
    made = chain(pieces, length, radius, top, direction, mass, rods=True, nailed=nailed)
    for body in made.bodies:
        body.look = "piece"
    return dress(made, {"piece": looks.capsule(radius, "rope")}, look)


def ring(
    links: int = 24,
    radius: float = 0.4,
    tube: float = 0.012,
    center: Vector = (0, 1.5, 0),
    mass: float = 1.0,
    look: Dress | None = None,
) -> Structure:
    """A closed chain of rods, a circle in the x-y plane. radius, tube: m. mass: of all, kg. Bodies: "link"."""
    check(radius=radius, tube=tube, mass=mass)
    check_counts(3, links=links)
    angle = 2 * math.pi * (np.arange(1, 2 * links + 1) // 2) / links
    made = Structure()
    circle = np.stack([np.sin(angle), np.cos(angle), 0 * angle], axis=1)
    made.points.add(place("center", center) + radius * circle, mass / links / 2)
    made.bodies = [RigidBody([p, p + 1], rod=(mass / links, tube), look="link") for p in range(0, 2 * links, 2)]
    made.hinges = [(p, (p + 1) % (2 * links)) for p in range(1, 2 * links, 2)]
    return dress(made, {"link": looks.capsule(tube, "steel")}, look)


def snake(
    segments: int = 12,
    length: float = 1.2,
    radius: float = 0.03,
    head: Vector = (0, 0.05, 0),
    stiffness: float = 0.5,
    density: float = 1000.0,
    look: Dress | None = None,
) -> Structure:
    """Capsules in a row along -x, each hinged to the one before about a vertical axis, with a spring that a script may
    bend: `made["joint 3"].angle.spring = (k, c, rest)`. length, radius: m. stiffness: N m/rad. Bodies: "segment"."""
    check(length=length, radius=radius, stiffness=stiffness, density=density)
    check_counts(2, segments=segments)
    piece, first = length / segments, place("head", head)
    made = Structure()
    for number in range(segments):
        middle = tuple((first - [(number + 0.5) * piece, 0, 0]).tolist())
        shape = Capsule(radius, max(piece - 2 * radius, 0.05 * piece))
        made.body(shape=shape, density=density, position=middle, name=f"segment {number}", look="segment")
        if number:
            joint = tuple((first - [number * piece, 0, 0]).tolist())
            spring = (stiffness, 0.1 * stiffness, 0.0)
            made.joint("revolute", number, number - 1, name=f"joint {number}", at=joint, axis=(0, 1, 0), spring=spring)
    return dress(made, {"segment": looks.solid("rubber")}, look)
