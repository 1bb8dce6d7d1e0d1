# SPDX-License-Identifier: Apache-2.0
"""A rigid ring of atoms swings on a nail; two of its bonds break, and half of it falls. 1 m is 0.77 nm; b breaks, r mends."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import Literal

import iota
from iota import shapelib
from iota.studies._stands import arm
from iota.studies._story import Story

FILE = Path(__file__).with_name("cyclooctane.xyz")
SCALE = 0.13  # m for an angstrom
NAIL = iota.Vec3(0, 1.15, 0)
BREAKS = ((0, 7), (3, 4))  # bonds between carbon atoms
TIMES = (6.0, 9.0)  # s, when they break if nobody touches anything


def build(repeat: bool = True) -> iota.World:
    """The world of the study. repeat: begins anew some seconds after the ring has broken."""
    system = iota.System(damping=0.02)
    world = iota.World(system, title="molecule: a ring of C8H16 swings and breaks; 1 m is 0.77 nm")
    made = hang(world, "rigid")
    for atom in made.points:  # what falls comes to lie on the ground
        system.outside(atom, iota.HalfSpace((0, 1, 0)), at=(0, atom.radius, 0))
    present(world)

    def snap(p: int, q: int) -> None:
        ends = {made.points[p], made.points[q]}
        for bond in system.cosmetic_bonds:
            if set(bond.ends) == ends:
                bond.destroy()
                return

    story = Story(world, first=TIMES[0])
    for time, pair in zip(TIMES, BREAKS, strict=True):
        story.at(time - TIMES[0])(partial(snap, *pair))
    story.at(TIMES[1] - TIMES[0] + 4.0)(world.reset if repeat else lambda: None)

    @world.action("break", key="b", button="b", help="breaks the next bond of the ring", on="world")
    def break_next(event: iota.Event) -> None:
        story.touch()
        there = {frozenset(bond.ends) for bond in system.cosmetic_bonds}
        for p, q in BREAKS:
            if {made.points[p], made.points[q]} in there:
                return snap(p, q)
        event.notice("Both bonds are broken", "r puts the ring together again.")

    world.action("mend", key="r", button="a", help="puts the ring together again", on="world")(world.reset)
    return world


def hang(world: iota.World, kind: Literal["rigid", "soft"], nail: iota.Vec3 = NAIL) -> iota.builder.Realized:
    """A ring of atoms on a nail."""
    ring = shapelib.molecule(FILE, kind, scale=SCALE, damping=0.02)  # which a rigid one does not have
    made: iota.builder.Realized = (ring + (nail - ring.points.position[1])).realize(world.system, world)
    made.points[1].nail()
    return made


def present(world: iota.World) -> None:
    """The molecule's stand, and where one stands in front of it."""
    arm(world, NAIL)
    world.stage("studio")
    world.camera = iota.Camera(position=(0.8, 1.05, 2.1), target=tuple(NAIL - (0, 0.53, 0.1)))
