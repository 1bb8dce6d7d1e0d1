# SPDX-License-Identifier: Apache-2.0
"""A thousand fish keep together and apart, follow the golden one, or one in a hand, and flee a hunter; x scatters them."""

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
FLEE, FEAR = 3.0, 2.2  # N/m; m from the hunter, where they begin to flee
HUNT, PAUSE, FIRST = 7.0, 14.0, 4.0  # s: how long it hunts and rests, and when it comes for the first time
HOME = np.array([-3.0, 3.2, -15.0])  # where it rests, in the haze, m
ROOM = np.array([0.12, 0.14, 0.45])  # across, up and along: between two fish at the start, m
# The outline of a fish: places along it, half its height and half its width there, m.
BODY = ((0.09, 0.034, 0.017), (0.02, 0.05, 0.025), (-0.06, 0.03, 0.014))


def build(fish: int = FISH) -> iota.World:
    """The world of the study."""
    system = iota.System(mode="robust", gravity=(0, 0, 0))
    world = iota.World(system, title="shoal: fish of 0.3 m follow a leader and flee a hunter", dt=1 / 60)
    school = School(world, fish, leader_at)
    add_leader(world, school)
    add_hunter(world, school)
    present(world)

    @world.action("current", key="c", button="a", help="turns the current off and on", on="world")
    def turn() -> None:
        school.current.active = not school.current.active

    @world.action("scatter", key="x", button="b", help="scatters the shoal", on="world")
    def scatter() -> None:
        school.bodies.velocities += np.random.default_rng(0).normal(size=(fish, 3)) * 3

    return world


def leader_at(time: float) -> Any:
    """The place that the leader swims to, m: a loop, at first across the view."""
    turn = 2 * math.pi * time / 24
    return np.array([1.7 * math.sin(turn), 2.9 + 0.4 * math.sin(2 * turn), 1.6 * math.cos(turn)])


class School:
    """Fish about a leader: long-range attraction, short-range repulsion, neighbors swim alike, all drift with a turbulent
    current. A fish that is taken out of `group` no longer swims by itself."""

    def __init__(self, world: iota.World, fish: int, leader: Callable[[float], Any], spread: float = 1.5) -> None:
        self._system, self.leader = world.system, leader
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
        self.bodies = world.system.array([fish.body for fish in self.fish])
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
        self.bodies.orientations = self.headings()
        world.on_step(self._steer)
        world.on_reset(self._forget)

    def _swim(self, batch: iota.types.ParticleBatch) -> Any:
        """Each keeps its speed along its way and turns towards the leader, by its own strength, whatever it has to carry."""
        speed = np.linalg.norm(batch.velocity, axis=1, keepdims=True)
        to_leader = self.leader(batch.time) - batch.position
        distance = np.linalg.norm(to_leader, axis=1, keepdims=True)
        push = (KEEN * (CRUISE / np.maximum(speed, 0.05) - 1) - LEVEL) * batch.velocity
        push[:, 1] += 8 * np.maximum(BED - batch.position[:, 1], 0)
        return MASS * (push + FOLLOW * to_leader / np.maximum(distance, 0.5))

    def _forget(self) -> None:
        self._way, self._turn = self.bodies.velocities, np.zeros(len(self.bodies.velocities))

    def _steer(self) -> None:
        """Fish look along their way: every other step is enough."""
        if self._system.step_count % 2 == 0:
            before, self._way = self._way, self.bodies.velocities
            turn = np.cross(before, self._way)[:, 1] / np.maximum((self._way**2).sum(axis=1), 1e-6) / self._between
            self._turn += self._between / LEAN * (turn - self._turn)  # rad/s, to the left
            self.bodies.orientations = self.headings()

    def headings(self) -> Any:
        """Quaternions along each fish's way, level but for a bank into its turn, wagging from side to side: (n, 4)."""
        wag = 0.22 * np.sin(2 * math.pi * (1.2 + 0.3 * np.sin(self._phase)) * self._system.time + self._phase)
        return aim(self.bodies.velocities, wag, -0.6 * np.tanh(self._turn))


def aim(velocity: Any, wag: Any, roll: Any) -> Any:
    """Quaternions that point x along velocities (n, 3), with angles to the side and about the way, rad: (n, 4)."""
    speed = np.maximum(np.linalg.norm(velocity, axis=1), 1e-6)
    yaw = np.arctan2(-velocity[:, 2], velocity[:, 0]) + wag
    pitch = np.arcsin(np.clip(velocity[:, 1] / speed, -0.9, 0.9))
    (cy, cp, cr), (sy, sp, sr) = ([f(angle / 2) for angle in (yaw, pitch, roll)] for f in (np.cos, np.sin))
    # Roll about x, then pitch about z, then yaw about y.
    x, y = sr * cp * cy + cr * sp * sy, cr * cp * sy + sr * sp * cy
    z, w = cr * sp * cy - sr * cp * sy, cr * cp * cy - sr * sp * sy
    return np.stack([x, y, z, w], axis=1)


def drive(
    world: iota.World, fish: iota.Particle, goal: Callable[[float], Any], speed: float, keen: float
) -> iota.Group:
    """It swims by itself to where the function says. speed: m/s. keen: 1/s, how soon it has turned there."""
    alone = world.system.group(fish.body.name)
    alone.add(fish)

    def swim(batch: iota.types.ParticleBatch) -> Any:
        way = goal(batch.time) - batch.position
        pace = min(speed / max(float(np.linalg.norm(way)), 1e-6), 3.0)
        return keen * fish.mass * (pace * way - batch.velocity)

    world.system.field(swim, group=alone)
    return alone


def add_leader(world: iota.World, school: School) -> None:
    """The golden fish goes round its path; the others follow it, or the one that somebody holds."""
    golden = min(school.fish, key=lambda fish: abs(fish.position - iota.Vec3(*leader_at(0))))
    golden.body.name = "leader"
    world.draw(golden.body, fish_looks("#ffb01e", "#e0401a", 1.6))
    school.group.remove(golden)
    drive(world, golden, lambda time: leader_at(time + 0.3), 2 * CRUISE, 3.0)

    @world.on_step
    def follow() -> None:
        place = np.array(tuple((world.users.held() or golden.body).center_of_mass))
        school.leader = lambda _: place


def add_hunter(world: iota.World, school: School) -> None:
    """A large fish that comes out of the haze, goes for the middle of the shoal, and leaves again."""
    body = world.system.body(damping=3.0, material=iota.Material(touches="nothing"))
    tail, nose = (body.particle(tuple(HOME + (x, 0, 0)), mass=30) for x in (-1, 1))
    tail.body.name = "hunter"
    world.draw(tail.body, fish_looks("#3b4a52", "#2c3a40", 6.0))

    def goal(time: float) -> Any:
        hunts = time >= FIRST and (time - FIRST) % (HUNT + PAUSE) < HUNT
        return school.bodies.positions.mean(axis=0) if hunts else HOME

    group = drive(world, nose, goal, 6.0, 9.0)
    world.system.pair_force("soft_repulsion", cutoff=FEAR, group=school.group, other=group, stiffness=FLEE, length=FEAR)


def apart(random: np.random.Generator, fish: int, spread: float) -> Any:
    """Places of fish that swim along z, dense in the middle, none in another one: (fish, 3)."""
    places = np.empty((0, 3))
    while len(places) < fish:
        place = random.normal(size=3).clip(-1.8, 1.8) * [spread, 0.5 * spread, spread]
        if (np.linalg.norm((places - place) / ROOM, axis=1) > 1).all():
            places = np.vstack([places, place])
        else:
            spread *= 1.0005  # a crowd needs more room
    return places


def fish_looks(color: str = "#5b86a8", tail_color: str = "#e0a040", size: float = 1.0) -> list[looks.Look]:
    """A body and a tail, 54 triangles: a thousand fish are drawn at once. size: times the usual one."""
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
    parts = ((body, faces, color), (tail, fins, tail_color))
    return [looks.mesh(np.multiply(size, vertices), triangles, color=color) for vertices, triangles, color in parts]


def present(world: iota.World) -> None:
    """A bed of sand with stones, and the blue of the water around."""
    for x, z, size in ((-1.5, -2, 0.8), (1.3, 1.5, 0.6), (2.0, -3, 1.1), (-1.9, 1.2, 0.8), (0.1, -5, 1.3)):
        stone = looks.Look(iota.Ellipsoid((2 * size, size, 1.6 * size)), "rubber", "#5a6a5c")
        world.add_static(stone, (x, 0.25 * size, z))
    world.drawings.stage(sky="#7fc1cf", horizon="#2f6f88", ground="#a39a76", light=0.9)
    world.camera = iota.Camera(position=(0.6, 2.5, 10.3), target=(0.6, 3.0, 0))
