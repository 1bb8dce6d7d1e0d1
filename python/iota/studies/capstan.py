# SPDX-License-Identifier: Apache-2.0
"""Ropes of rods over a beam: friction holds five times the counterweight after one turn and a half; k lifts that, c begins anew."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

import iota
from iota import looks

from ._story import Story

BEAM, HEIGHT, LENGTH = 0.1, 1.15, 0.7  # radius, height and length of the beam, m
ROPE, ROD, PITCH = 0.008, 0.03, 0.024  # radius of a rope, its rods, from turn to turn, m
ROPE_MASS = 0.003  # of a rod, kg
FRICTION = 0.2
COUNTERWEIGHT = 0.2  # kg
HANGING = (0.45, 0.3)  # m, of the side with the counterweight, and of the other one
DENSITY = 1500.0  # of the weights, kg/m^3
STEP = 1 / 360  # s: rods that are this light under tension turn fast


def build() -> iota.World:
    """The world of the study."""
    world = make_world()
    Capstan(world)
    return world


def make_world() -> iota.World:
    """Weights that hang still for half a second sleep."""
    system = iota.System()
    system.rest_after = 0.5
    world = iota.World(system, title="capstan: turns of rope about a beam of 20 cm hold a weight")
    world.dt = STEP
    present(world)
    return world


def present(world: iota.World) -> None:
    for z in (-1, 1):
        end = z * (LENGTH / 2 + 0.04)
        world.add_static(looks.box((0.12, HEIGHT, 0.06), "wood"), (0, HEIGHT / 2, end))
        world.add_static(looks.box((0.5, 0.04, 0.08), "wood"), (0, 0.02, end))
    world.draw_ties("rope", looks.cylinder(ROPE, "rope"))
    world.stage("room")
    world.camera = iota.Camera(position=(1.5, 1.25, 1.0), target=(0, 0.78, 0))


@dataclass
class Rope:
    """turns: about the beam. rods: from the counterweight to the load."""

    turns: float
    rods: list[iota.Body]
    counterweight: iota.Body
    load: iota.Body


class Capstan:
    """Two ropes: one over the beam, one with a turn more. ratios: of their loads to the counterweights."""

    def __init__(self, world: iota.World, ratios: tuple[float, float] = (1.6, 5.0)) -> None:
        self.world, self.system = world, world.system
        beam = world.add_static(looks.cylinder(BEAM, "brass", LENGTH), (0, HEIGHT, 0), (0, -(0.5**0.5), 0, 0.5**0.5))
        beam.material = iota.Material(friction=FRICTION)
        self.ropes = [self._rope(0.5, ratios[0], 0.16), self._rope(1.5, ratios[1], -0.16)]
        self._grip: iota.Grip | None = None
        self.story = Story(world, wait=5.0, first=1.0, on_stop=self.release)
        self.story.at(0.0)(self.lift)
        self.story.at(1.2)(self.release)
        self.story.at(5.0)(world.reset)
        self.story.action("lift", key="k", help="lifts the counterweight of the rope with a turn more")(self.lift)
        world.action("begin anew", key="c", help="all hangs as at the start", on="world")(world.reset)
        world.on_step(self._follow)
        world.on_reset(self._forget)

    def _rope(self, turns: float, ratio: float, z: float) -> Rope:
        places = course(turns) + (0, HEIGHT, z)
        made = self.system.rod_array(places[:-1], places[1:], masses=ROPE_MASS)
        made.particles[1:-1:2].combine(made.particles[2::2])
        rods = list(made)
        for rod in rods:
            rod.material = iota.Material(friction=FRICTION)
        self.world.draw(rods, looks.capsule(ROPE, "rope"))
        ends = []
        for particle, mass, color in (
            (rods[0].particles[0], COUNTERWEIGHT, "#2f6c90"), (rods[-1].particles[1], ratio * COUNTERWEIGHT, "#b5352b")
        ):  # fmt: skip
            radius = (3 * mass / (4 * math.pi * DENSITY)) ** (1 / 3)
            ball = self.system.body(
                shape=iota.Sphere(radius), mass=mass, position=particle.position - (0, radius, 0), damping=0.5
            )
            particle.combine(ball.attachment(particle.position))
            self.world.draw(ball, looks.solid("paint", color))
            ends.append(ball)
        return Rope(turns, rods, *ends)

    def lift(self) -> None:
        """Takes the weight off the rope's slack end: what is left there, times exp(mu angle), is less than the load."""
        if self._grip is None:
            ball = self.ropes[1].counterweight
            self._start, self._begun = ball.position, self.system.time
            self._grip = self.system.grip(ball)

    def _follow(self) -> None:
        if self._grip is not None and self._grip.alive:
            way = min(0.12, 0.2 * (self.system.time - self._begun))
            self._grip.move(self._start + (0, way, 0))

    def release(self) -> None:
        if self._grip is not None and self._grip.alive:
            self._grip.destroy()
        self._grip = None

    def _forget(self) -> None:
        self._grip = None


def course(turns: float) -> np.ndarray:
    """Ends of rods (n, 3), m, about a beam at the origin: up on the left, around, and down on the other side."""
    reach, angle = BEAM + ROPE, 2 * math.pi * turns
    count = round(angle * reach / ROD)
    corner, step = reach / math.cos(angle / count / 2), angle / count
    rod = 2 * corner * math.sin(step / 2)
    wound = [
        (-corner * math.cos(step * i), corner * math.sin(step * i), PITCH * turns * (i / count - 0.5))
        for i in range(count + 1)
    ]
    up = [(wound[0][0], -rod * i, wound[0][2]) for i in range(round(HANGING[0] / rod), 0, -1)]
    down = [(wound[-1][0], -rod * i, wound[-1][2]) for i in range(1, round(HANGING[1] / rod) + 1)]
    return np.array([*up, *wound, *down])


if __name__ == "__main__":
    build().run()
