# SPDX-License-Identifier: Apache-2.0
"""Rockets climb, burst and rain down; b fires one, n all of them. One greets; the others fire by themselves while nobody does."""

from __future__ import annotations

import math
from functools import partial

import numpy as np

import iota
from iota import effects, looks
from iota.studies._story import Story

COLORS = ((1, 0.3, 0.15), (0.25, 0.55, 1), (1, 0.75, 0.2), (0.4, 0.85, 0.35), (0.85, 0.35, 0.9), (0.95, 0.9, 0.8))
CLIMB = 13.0  # m/s, of a rocket that leaves its tube
TUBE = 0.9  # m
STARS = 200  # of a burst
COMETS, TAILS = 24, 6  # stars with a trail of embers; emitters that go from one of them to the next
DRAG = 1.5  # 1/s, of a star: it is fast for half a second, and then sinks
BRIGHT, FADE = 2.0, 0.8  # of a burst's light; s
LAMPS = 3  # for bursts, beside those of the bowls
BOWL = 2.6  # m, of the two bowls from the middle


class Rocket:
    """A particle that waits in its tube, climbs with a tail of sparks, and bursts where it climbs no more: into stars, of which some
    leave trails."""

    def __init__(self, world: iota.World, sky: Sky, x: float, color: tuple[float, float, float], seed: int) -> None:
        self._world, self._sky, self._color, self._home = world, sky, color, iota.Vec3(x, TUBE, 0)
        system = world.system
        self._random = np.random.default_rng(seed)
        self.particle = system.body().particle(self._home, mass=0.3)
        self.particle.radius, self.particle.color = 0.05, color
        self.particle.body.kind = "scripted"  # it waits
        self._tail = system.emitter(
            rate=320, source=iota.Sphere(0.02), position=self._home, velocity=(0, -1.5, 0), velocity_spread=0.5, mass=0.0005,
            lifetime=0.6, lifetime_spread=0.2, curve=[(0, 0.035, (1, 0.9, 0.6)), (1, 0.008, (0.6, 0.2, 0.1))],
        )  # fmt: skip
        dim = tuple(0.35 * c for c in color)
        self._stars = [
            effects.burst(
                system, self._home, color, count=count, speed=speed, seed=seed, damping=DRAG, lifetime=life, lifetime_spread=0.5,
                curve=[(0, size, (1, 0.97, 0.9)), (0.25, size, color), (0.7, 0.7 * size, color), (1, 0.006, dim)],
            )
            for count, speed, life, size in ((STARS, 7.0, 1.5, 0.045), (COMETS, 9.0, 2.1, 0.06))
        ]  # fmt: skip
        self._embers = [
            system.emitter(
                rate=240, source=iota.Sphere(0.02), position=self._home, velocity=(0, 0, 0), velocity_spread=0.15, mass=0.0002,
                lifetime=0.6, lifetime_spread=0.25, damping=4.0, seed=seed + 10 * number, max_count=240,
                curve=[(0, 0.028, color), (0.5, 0.016, tuple(0.6 * c for c in color)), (1, 0.004, dim)],
            )
            for number in range(TAILS)
        ]  # fmt: skip
        for emitter in (self._tail, *self._stars, *self._embers):
            emitter.active = False

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
        self._trail()
        if self.is_ready:
            return
        self._tail.move(self.particle.position)
        if self.particle.velocity.y < 0.3 and self._world.users.held() != self.particle.body:  # not in a hand
            self._burst()
            self.particle.body.kind = "scripted"
            self.particle.position, self.particle.velocity = self._home, (0, 0, 0)

    def _burst(self) -> None:
        self._tail.active = False
        self._sky.flash(self.particle.position, self._color)
        for stars in self._stars:
            stars.move(self.particle.position)
            stars.active = True
        self._world.after(0.1)(self._end_burst)

    def _end_burst(self) -> None:
        for stars in self._stars:
            stars.active = False

    def _trail(self) -> None:
        """Each emitter of embers goes to the next of its comets."""
        comets = self._stars[1].particles
        turn = self._world.system.step_count * TAILS
        for number, embers in enumerate(self._embers):
            embers.active = len(comets) > 0
            if comets:
                embers.move(comets[(turn + number) % len(comets)].position)


class Sky:
    """Bursts act on what is around: they light the ground, and their sparks end there."""

    def __init__(self, world: iota.World) -> None:
        self._system = world.system
        self._lamps = [world.drawings.light("point", at=(0, 5, 0), intensity=0, reach=5) for _ in range(LAMPS)]
        self._flashed = [-math.inf] * LAMPS  # when, s
        world.on_step(self._fade)
        world.on_reset(self._darken)

    def flash(self, place: iota.Vec3, color: tuple[float, float, float]) -> None:
        """The lamp that has been dark for the longest time."""
        number = self._flashed.index(min(self._flashed))
        self._flashed[number] = self._system.time
        self._lamps[number].at, self._lamps[number].color = place, color

    def _fade(self) -> None:
        if self._system.step_count % 4 > 0:
            return
        for lamp, since in zip(self._lamps, self._flashed, strict=True):
            left = math.exp((since - self._system.time) / FADE)
            lamp.intensity = round(BRIGHT * left, 3) if left > 0.01 else 0
        low = self._system.positions[:, 1] < 0.03
        if low.any():
            particles = self._system.particles
            for number in np.flatnonzero(low):
                if (body := particles[number].body).is_spark:
                    body.destroy()

    def _darken(self) -> None:
        self._flashed = [-math.inf] * LAMPS


def build() -> iota.World:
    """The world of the study."""
    system = iota.System(mode="robust")
    world = iota.World(system, title="fireworks: rockets climb, burst and rain down; a tube is 0.9 m high")
    world.drawings.stage(sky="#04060c", horizon="#16203a", ground="#7c8270", light=0.2)  # a night
    places = np.linspace(-1.5, 1.5, len(COLORS))
    sky = Sky(world)
    rockets = [
        Rocket(world, sky, float(x), color, n) for n, (x, color) in enumerate(zip(places, COLORS, strict=True), 1)
    ]
    for x in (-BOWL, BOWL):
        effects.fire(system, at=(x, 0.62, 0), size=0.16)
        world.drawings.light("point", at=(x, 0.95, 0.1), color="#ff9a4a", intensity=0.7, reach=1.2)
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

    @story.action("fire", key="b", button="b", help="fires the next rocket")
    def fire_next() -> None:
        fire(system.step_count)

    @story.action("finale", key="n", button="a", help="fires all of them, one after the other")
    def finale() -> None:
        for number in range(len(rockets)):
            world.after(0.15 * number)(lambda: fire(0))

    world.at(0.3)(partial(fire, 0))
    for number, time in enumerate((0, 1.2, 1.5, 3.2, 4.0, 4.2, 4.4, 6.0)):
        story.at(time)(partial(fire, 2 * number + 1))
    return world


def present(world: iota.World, places: np.ndarray) -> None:
    """Tubes on a board, two bowls of fire beside it, a bench to sit on, and trees around the meadow."""
    world.add_static(looks.box((3.8, 0.12, 0.4), "wood", 0.02), (0, 0.06, 0))
    for x in places:
        world.add_strut((x, 0.1, 0), (x, TUBE - 0.05, 0), looks.cylinder(0.07, "brass"))
    for x in (-BOWL, BOWL):
        world.add_strut((x, 0, 0), (x, 0.5, 0), looks.cylinder(0.05, "steel"))
        world.add_static(looks.Look(iota.Ellipsoid((0.24, 0.1, 0.24)), "steel"), (x, 0.54, 0))
    for y, z, size in ((0.45, 2.6, (1.6, 0.05, 0.4)), (0.8, 2.85, (1.6, 0.3, 0.04))):
        world.add_static(looks.box(size, "wood", 0.01), (-3.2, y, z))
    for x in (-3.8, -2.6):
        world.add_static(looks.box((0.06, 0.45, 0.36), "wood"), (x, 0.22, 2.6))
    random = np.random.default_rng(3)
    for x in (-10.4, -8.9, -7.6, -6.3, 6.4, 7.8, 9.2, 10.6):
        height, z = random.uniform(3.0, 5.5), random.uniform(-8, -4)
        crown = looks.Look(iota.Cone(0.28 * height, height), "rubber", "#2c4a34", rotation=("z", 90))
        world.add_static(crown, (x, 0.4 + height / 4, z))
    world.camera = iota.Camera(position=(0, 1.8, 18.0), target=(0, 5.5, 0))
