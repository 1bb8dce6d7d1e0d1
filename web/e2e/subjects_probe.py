# SPDX-License-Identifier: Apache-2.0
"""Scenes whose subject the camera keeps, for browser tests: IOTA_SCENE names one of them, IOTA_SPEED its speed."""

from __future__ import annotations

import math
import os
from collections.abc import Callable

import iota
from iota import looks


def pier(system: iota.System, world: iota.World, size: float = 1.0) -> None:
    """Four posts under a plank, on which things stand."""
    for x in (-1.0, 1.0):
        for z in (-0.3, 0.3):
            world.add_static(looks.box((0.1 * size, size, 0.1 * size), "wood"), (x * size, size / 2, z * size))
    plank = iota.Box((2.4 * size, 0.08 * size, 0.9 * size))
    system.obstacle(plank, position=(0, 1.04 * size, 0), material=iota.Material())
    for k in range(3):
        system.body(
            shape=iota.Box((0.3 * size,) * 3),
            density=500.0,
            position=((-0.7 + 0.5 * k) * size, 1.23 * size, 0),
        )


def rolling() -> iota.World:
    """A ball rolls away from what stands and goes on without end."""
    system = iota.System()
    world = iota.World(system, title="rolling", ground=0.0)
    pier(system, world)
    system.body(shape=iota.Sphere(0.15), density=500.0, position=(1.6, 0.15, 0)).velocity = (1.5, 0, 0)
    return world


def thrown() -> iota.World:
    """A ball is thrown far away."""
    system = iota.System()
    world = iota.World(system, title="thrown", ground=0.0)
    pier(system, world)
    system.body(shape=iota.Sphere(0.12), density=500.0, position=(1.6, 1.5, 0)).velocity = (9, 6, -2)
    return world


def lone() -> iota.World:
    """The only thing falls and rolls away."""
    system = iota.System()
    world = iota.World(system, title="lone", ground=0.0)
    system.body(shape=iota.Sphere(0.2), density=500.0, position=(0, 2, 0)).velocity = (1, 0, 0)
    return world


def button() -> iota.World:
    """A small knob that moves, on a pedestal, beside a lamp, below a label."""
    system = iota.System(gravity=(0, 0, 0))
    world = iota.World(system, title="button", ground=0.0)
    world.add_static(looks.box((0.3, 1.0, 0.3), "wood"), (0, 0.5, 0))
    knob = system.body(shape=iota.Cylinder(0.03, 0.03), density=500.0, position=(0, 1.02, 0))
    system.prismatic(knob, at=(0, 1, 0), axis=(0, 1, 0))
    world.add_static(looks.sphere(0.06, "glass", color="#ffd27a"), (0.5, 1.1, 0))
    world.drawings.label("Press the button", offset=(0, 1.45, 0))
    return world


def planets() -> iota.World:
    """Planets in a line, which circle a sun once in 6 s and more."""
    system = iota.System(gravity=(0, 0, 0))
    world = iota.World(system, title="planets", ground=None)
    sun = system.body().particle((0, 0, 0), mass=1.0)
    sun.radius, sun.color = 0.3, (1.0, 0.8, 0.2)
    sun.nail()
    for far in (1.0, 1.6, 2.4):
        planet = system.body().particle((far, 0, 0), mass=1.0)
        planet.radius, planet.color = 0.1, (0.25, 0.5, 0.8)
        planet.velocity = (0, 0, -1.05 / math.sqrt(far))
        system.bond(planet, sun, "gravity", strength=1.1, softening=0)
    return world


def tower() -> iota.World:
    """Boxes on each other, much taller than wide."""
    system = iota.System()
    world = iota.World(system, title="tower", ground=0.0)
    for k in range(14):
        system.body(shape=iota.Box((0.5, 0.4, 0.5)), density=300.0, position=(0, 0.2 + 0.401 * k, 0))
    return world


def sized(size: float) -> Callable[[], iota.World]:
    def make() -> iota.World:
        system = iota.System(gravity=(0, -9.81 * size, 0))
        world = iota.World(system, title=f"{size:g} m", ground=0.0)
        pier(system, world, size)
        return world

    return make


def label() -> iota.World:
    """A ball below a long label."""
    system = iota.System(gravity=(0, 0, 0))
    world = iota.World(system, title="label", ground=0.0)
    system.body(shape=iota.Sphere(0.1), density=500.0, position=(0, 0.5, 0))
    world.drawings.label("Which of these three balls falls first, and why?", offset=(0, 0.8, 0))
    return world


SCENES = {
    make.__name__: make for make in (rolling, thrown, lone, button, planets, tower, label)
} | {"30": sized(30.0), "0.001": sized(0.001)}


def build() -> iota.World:
    world = SCENES[os.environ["IOTA_SCENE"]]()
    world.clock.speed = float(os.environ.get("IOTA_SPEED", "1"))
    return world
