# SPDX-License-Identifier: Apache-2.0
"""A thousand fish keep together and apart, follow a leader, and drift with a current; c turns the current off, x scatters them."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np

import iota
from iota import looks

FISH = 1000
MASS = 0.3  # kg, of a fish
CRUISE = 1.2  # m/s
KEEN = 2.0  # 1/s, how soon a fish has its speed again
FOLLOW = 0.9  # m/s^2, towards the leader
LEVEL = np.array([0.0, 1.0, 0.0])  # 1/s, how soon a fish swims level again
BED = 0.7  # m: below, a fish rises
LEAN = 0.3  # s, how soon a fish leans into a turn
MIDDLE = np.array([0.0, 3.1, 0.0])  # of the leader's path, m
WAY = np.array([2.2, 0.5, 1.8])  # how far it goes from there, m
ROOM = np.array([0.12, 0.14, 0.45])  # across, up and along: between two fish at the start, m
# The outline of a fish: places along it, half its height and half its width there, m.
BODY = ((0.09, 0.034, 0.017), (0.02, 0.05, 0.025), (-0.06, 0.03, 0.014))


def build(fish: int = FISH) -> iota.World:
    """The world of the study."""
    system = iota.System(mode="robust", gravity=(0, 0, 0))
    world = iota.World(
        system, title="shoal: a thousand fish follow their leader and flee a hunter; a fish is 0.3 m long", dt=1 / 60
    )
    school = School(world, fish, leader_at)
    present(world)

    @world.action("current", key="c", button="a", help="turns the current off and on", on="world")
    def turn() -> None:
        school.current.active = not school.current.active

    @world.action("scatter", key="x", button="b", help="scatters the shoal", on="world")
    def scatter() -> None:
        system.velocities = system.velocities + np.random.default_rng(0).normal(size=(fish, 3)) * 3

    return world


def leader_at(time: float) -> Any:
    """The place that the fish swim to, m: a loop in half a minute, at first across the view."""
    turn = 2 * math.pi * time / 30
    return MIDDLE + WAY * np.array([math.sin(turn), math.sin(2 * turn), math.cos(turn)])


class School:
    """Fish about a leader: long-range attraction, short-range repulsion, neighbors swim alike, all drift with a turbulent
    current. A fish that is taken out of `group` no longer swims by itself."""

    def __init__(self, world: iota.World, fish: int, leader: Callable[[float], Any], spread: float = 1.5) -> None:
        self._system, self._leader = world.system, leader
        random = np.random.default_rng(5)
        self._phase = random.uniform(0, 2 * math.pi, fish)
        shoal = iota.builder.Structure()
        ahead = (leader(0.1) - leader(0)) * (1, 0, 1)
        along = ahead / np.linalg.norm(ahead)
        frame = np.stack([np.cross([0, 1, 0], along), [0, 1, 0], along])
        shoal.points.add(leader(0) + apart(random, fish, spread) @ frame, MASS, CRUISE * along)
        shoal.group("shoal", range(fish))
        made = shoal.realize(world.system)
        self.fish, self.group = made.points, made.groups["shoal"]
        self._bodies = world.system.array([fish.body for fish in self.fish])
        world.system.pair_force(
            "attract_repel", cutoff=0.9, group=self.group, attraction=0.03, attraction_range=0.8, repulsion=0.4,
            repulsion_range=0.15, alignment=0.02,
        )  # fmt: skip
        world.system.field(self._swim, group=self.group)
        self.current = world.system.field(
            "current", group=self.group, drag=0.15, speed=0.6, size=2.5, octaves=3, evolution=0.2
        )
        world.draw([fish.body for fish in self.fish], fish_looks())
        self._between = 2 * world.dt  # s, between two looks at the way
        self._forget()
        self._bodies.orientations = self.headings()
        world.on_step(self._steer)
        world.on_reset(self._forget)

    def _swim(self, batch: iota.types.ParticleBatch) -> Any:
        """Each keeps its speed along its way and turns towards the leader, by its own strength, whatever it has to carry."""
        speed = np.linalg.norm(batch.velocity, axis=1, keepdims=True)
        to_leader = self._leader(batch.time) - batch.position
        distance = np.linalg.norm(to_leader, axis=1, keepdims=True)
        push = (KEEN * (CRUISE / np.maximum(speed, 0.05) - 1) - LEVEL) * batch.velocity
        push[:, 1] += 8 * np.maximum(BED - batch.position[:, 1], 0)
        return MASS * (push + FOLLOW * to_leader / np.maximum(distance, 0.5))

    def _forget(self) -> None:
        self._way, self._turn = self._bodies.velocities, np.zeros(len(self._bodies.velocities))

    def _steer(self) -> None:
        """Fish look along their way: every other step is enough."""
        if self._system.step_count % 2 == 0:
            before, self._way = self._way, self._bodies.velocities
            turn = np.cross(before, self._way)[:, 1] / np.maximum((self._way**2).sum(axis=1), 1e-6) / self._between
            self._turn += self._between / LEAN * (turn - self._turn)  # rad/s, to the left
            self._bodies.orientations = self.headings()

    def headings(self) -> Any:
        """Quaternions along each fish's way, level but for a bank into its turn, wagging from side to side: (n, 4)."""
        time, velocity = self._system.time, self._bodies.velocities
        speed = np.maximum(np.linalg.norm(velocity, axis=1), 1e-6)
        wag = 0.22 * np.sin(2 * math.pi * (1.2 + 0.3 * np.sin(self._phase)) * time + self._phase)
        yaw = np.arctan2(-velocity[:, 2], velocity[:, 0]) + wag
        pitch = np.arcsin(np.clip(velocity[:, 1] / speed, -0.9, 0.9))
        roll = -0.6 * np.tanh(self._turn)
        (cy, cp, cr), (sy, sp, sr) = ([f(angle / 2) for angle in (yaw, pitch, roll)] for f in (np.cos, np.sin))
        # Roll about x, then pitch about z, then yaw about y.
        x, y = sr * cp * cy + cr * sp * sy, cr * cp * sy + sr * sp * cy
        z, w = cr * sp * cy - sr * cp * sy, cr * cp * cy - sr * sp * sy
        return np.stack([x, y, z, w], axis=1)


def apart(random: np.random.Generator, fish: int, spread: float) -> Any:
    """Places of fish that swim along z, dense in the middle, none in another one: (fish, 3)."""
    places = np.empty((0, 3))
    while len(places) < fish:
        place = random.normal(size=3) * [spread, 0.5 * spread, spread]
        if (np.linalg.norm((places - place) / ROOM, axis=1) > 1).all():
            places = np.vstack([places, place])
        else:
            spread *= 1.0005  # a crowd needs more room
    return places


def fish_looks() -> list[looks.Look]:
    """A body and a tail, 54 triangles: a thousand fish are drawn at once."""
    around = np.pi / 4 * np.arange(8)
    rings = [[(x, h * np.cos(a), w * np.sin(a)) for a in around] for x, h, w in BODY]
    body = [(0.14, 0.0, 0.0), *(place for ring in rings for place in ring), (-0.12, 0.0, 0.0)]
    sides = [(1 + a, 1 + (a + 1) % 8) for a in range(8)]
    faces = [(0, a, b) for a, b in sides]
    for k in range(0, 8 * len(BODY) - 8, 8):
        faces += [t for a, b in sides for t in ((k + a, k + 8 + a, k + 8 + b), (k + a, k + 8 + b, k + b))]
    faces += [(len(body) - 1, k + 8 + b, k + 8 + a) for a, b in sides]
    tail = [(-0.1, 0, 0.006), (-0.1, 0, -0.006), (-0.19, 0.06, 0), (-0.16, 0, 0), (-0.19, -0.06, 0)]
    fins = [(0, 2, 3), (0, 3, 4), (1, 3, 2), (1, 4, 3), (0, 1, 2), (0, 4, 1)]
    return [looks.mesh(body, faces, color="#5b86a8"), looks.mesh(tail, fins, color="#e0a040")]


def present(world: iota.World) -> None:
    """A bed of sand with stones, and the blue of the water around."""
    for x, z, size in ((-1.5, -2, 0.8), (1.3, 1.5, 0.6), (2.0, -3, 1.1), (-1.9, 1.2, 0.8), (0.1, -5, 1.3)):
        stone = looks.Look(iota.Ellipsoid((2 * size, size, 1.6 * size)), "rubber", "#5a6a5c")
        world.add_static(stone, (x, 0.25 * size, z))
    world.drawings.stage(sky="#7fc1cf", horizon="#2f6f88", ground="#a39a76", light=0.9)
    world.camera = iota.Camera(position=(0, 2.0, 15.0), target=(0, 3.4, 0))
