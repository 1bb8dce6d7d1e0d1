# SPDX-License-Identifier: Apache-2.0
"""Rockets climb, burst and rain down; b fires one, n all of them. One greets; the others fire by themselves while nobody does."""

from __future__ import annotations

from functools import partial

import numpy as np

import iota
from iota import effects, looks
from iota.studies._story import Story

COLORS = ((1, 0.3, 0.15), (0.25, 0.55, 1), (1, 0.75, 0.2), (0.4, 0.85, 0.35), (0.85, 0.35, 0.9), (0.95, 0.9, 0.8))
CLIMB = 9.0  # m/s, of a rocket that leaves its tube
TUBE = 0.9  # m


class Rocket:
    """A particle that waits in its tube, climbs with a tail of sparks, and bursts where it climbs no more."""

    def __init__(self, world: iota.World, x: float, color: tuple[float, float, float], seed: int) -> None:
        self._world, self._home = world, iota.Vec3(x, TUBE, 0)
        system = world.system
        self._random = np.random.default_rng(seed)
        self.particle = system.body().particle(self._home, mass=0.3)
        self.particle.radius, self.particle.color = 0.05, color
        self.particle.body.kind = "scripted"  # it waits
        self._tail = system.emitter(
            rate=260, source=iota.Sphere(0.02), position=self._home, velocity=(0, -1.5, 0), velocity_spread=0.5, mass=0.0005,
            lifetime=0.5, lifetime_spread=0.2, curve=[(0, 0.03, (1, 0.9, 0.6)), (1, 0.008, (0.6, 0.2, 0.1))],
        )  # fmt: skip
        self._star = effects.burst(system, self._home, color, count=400, speed=2.2, seed=seed)
        self._tail.active = self._star.active = False

    @property
    def is_ready(self) -> bool:
        return self.particle.body.kind == "scripted"

    def fire(self) -> None:
        """Off it goes, a little aslant."""
        aslant = self._random.uniform(-1, 1, 2)
        self.particle.body.kind = "dynamic"
        self.particle.velocity = (aslant[0], CLIMB + self._random.uniform(-1, 1), 0.7 * aslant[1])
        self._tail.active = True

    def follow(self) -> None:
        """The tail goes along; at the top it bursts, and a new rocket stands in the tube."""
        if self.is_ready:
            return
        self._tail.move(self.particle.position)
        if self.particle.velocity.y < 0.3 and self._world.users.held() != self.particle.body:  # not in a hand
            self._star.move(self.particle.position)
            self._tail.active, self._star.active = False, True
            self._world.after(0.1)(lambda: setattr(self._star, "active", False))
            self.particle.body.kind = "scripted"
            self.particle.position, self.particle.velocity = self._home, (0, 0, 0)


def build() -> iota.World:
    """The world of the study."""
    system = iota.System(mode="robust")
    world = iota.World(system, title="fireworks: a tube is 0.9 m high")
    world.drawings.stage(sky="#03050a", horizon="#141c2c", ground="#34363a", light=0.45)  # a night
    places = np.linspace(-1.5, 1.5, len(COLORS))
    rockets = [Rocket(world, float(x), color, n) for n, (x, color) in enumerate(zip(places, COLORS, strict=True), 1)]
    for x in (-2.6, 2.6):
        effects.fire(system, at=(x, 0.62, 0), size=0.16)
    present(world, places)
    story = Story(world, wait=4.0, first=2.5)

    @world.on_step
    def follow() -> None:
        for rocket in rockets:
            rocket.follow()

    def fire(number: int) -> None:
        ready = [rocket for rocket in rockets if rocket.is_ready]
        if ready:
            ready[number % len(ready)].fire()

    @world.action("fire", key="b", button="b", help="fires the next rocket", on="world")
    def fire_next() -> None:
        story.touch()
        fire(system.step_count)

    @world.action("finale", key="n", button="a", help="fires all of them, one after the other", on="world")
    def finale() -> None:
        story.touch()
        for number in range(len(rockets)):
            world.after(0.15 * number)(lambda: fire(0))

    world.at(0.5)(partial(fire, 0))
    for number, time in enumerate((0, 1.2, 1.5, 3.2, 4.0, 4.2, 4.4, 6.0)):
        story.at(time)(partial(fire, 2 * number + 1))
    return world


def present(world: iota.World, places: np.ndarray) -> None:
    """Tubes on a board, and two bowls of fire beside it."""
    world.add_static(looks.box((3.8, 0.12, 0.4), "wood", 0.02), (0, 0.06, 0))
    for x in places:
        world.add_strut((x, 0.1, 0), (x, TUBE - 0.05, 0), looks.cylinder(0.07, "brass"))
    for x in (-2.6, 2.6):
        world.add_strut((x, 0, 0), (x, 0.5, 0), looks.cylinder(0.05, "steel"))
        world.add_static(looks.Look(iota.Ellipsoid((0.24, 0.1, 0.24)), "steel"), (x, 0.54, 0))
    world.camera = iota.Camera(position=(0, 1.9, 9.5), target=(0, 2.75, 0))
