# SPDX-License-Identifier: Apache-2.0
"""An orange fish leaves its shoal, feeds on seaweed, tears a piece off, lags behind with it, lets go and rejoins; n goes on by hand."""

from __future__ import annotations

import math
from itertools import combinations, pairwise
from typing import Any

import numpy as np

import iota
from iota import looks
from iota.studies._story import Story
from iota.studies.shoal import School, fish_looks, present

FISH = 120
KELPS = ((-1.5, -0.8), (1.7, -1.5), (0.5, 0.9))  # where they grow, m
NODES, LENGTH = 16, 3.6  # of a kelp; m
PIECE = 3  # links that a fish tears off
BUOYANCY = 1.6  # m/s^2, upwards
FIRST = iota.Vec3(1.5, 3.0, 1.5)  # m: the fish that is nearest to it at the start has the story
HIGHEST = 9.0  # m: what drifts away is gone there
LURE = "force = -3*(r - r0 - 0.05*sin(7*t))/(r + 0.3) - 0.5*v; drag = 0.25"  # towards the food, and nibbling there


def build(fish: int = FISH) -> iota.World:
    """The world of the study."""
    system = iota.System(mode="robust", gravity=(0, 0, 0))
    system.usual_material = iota.Material(friction=0.6, touches="obstacles")
    world = iota.World(system, title="undersea: one of many fish of 0.3 m goes to feed", dt=1 / 60, ground=0.0)
    school = School(world, fish, leader_at, spread=0.8)
    weed = system.group("weed")
    system.field("uniform", group=weed, acceleration=(0, BUOYANCY, 0))
    system.field("current", group=weed, velocity=(0.1, 0, 0), drag=0.02, speed=0.5, size=1.5, octaves=2, evolution=0.4)
    # A swell: waves far above push to and fro what grows high.
    system.field("fx = a*m*y*sin(1.3*t + 0.5*x); fz = 0.5*a*m*y*sin(0.9*t + 0.7*z)", group=weed, a=0.22)
    school.current.set(speed=0.3)
    soft = system.group("soft")
    system.pair_force("soft_repulsion", cutoff=0.09, group=soft, stiffness=6, length=0.09)
    kelps = [kelp(world, weed, x, z) for x, z in KELPS]
    bush(world, weed, (-0.1, 0, -1.8))
    bush(world, weed, (1.9, 0, 0.5))
    for x, z in ((-0.2, 0.0), (0.6, -0.9), (-2.6, -0.5)):
        ribbon(world, weed, (x, 0, z))
    present(world)
    world.camera = iota.Camera(position=(0.4, 1.9, 7.4), target=(0.1, 2.4, 0))
    bubbles(world)
    world.draw_ties("spring", looks.capsule(0.018, "rubber", color="#5c8a4a"))
    meal = Meal(world, school, kelps)
    story = Story(world, wait=8.0, first=3.0, on_stop=meal.call_off)
    for time in (0.0, 7.0, 18.0):
        story.at(time)(meal.go_on)
    story.at(26.0)(lambda: None)

    story.action("go on", key="n", button="a", help="the next event of the story, by hand")(meal.go_on)
    return world


def leader_at(time: float) -> Any:
    """The place that the shoal swims to, m: round the seaweed, nearly as fast as a fish can swim."""
    turn = 2 * math.pi * (time + 1.0) / 16
    return np.array([1.9 * math.cos(turn), 2.7 + 0.5 * math.sin(3 * turn), 2.2 * math.sin(turn) - 0.4])


class Meal:
    """The story of one fish, an event at a time: it leaves and feeds; tears a piece off and takes it along; lets go. It has a color of
    its own, so that one sees where it is among the others."""

    def __init__(self, world: iota.World, school: School, kelps: list[list[iota.Body]]) -> None:
        self._world, self._school, self._kelps = world, school, kelps
        self._weed = next(group for group in world.system.groups if group.name == "weed")
        # The load is as heavy as water, and drags.
        self._load = world.system.group("load")
        world.system.field("wind", group=self._load, drag=0.16)
        self.hero = min(school.fish, key=lambda fish: abs(fish.position - FIRST))
        world.draw(self.hero.body, fish_looks("#ff6a1a", "#ffd23c", 1.6))
        self.hero.body.name = "orange fish"
        self._label = world.label("", self.hero, offset=(0, 0.5, 0))
        self._start()
        world.on_reset(self._start)
        world.every(1.0)(self._clear)

    def _start(self) -> None:
        self.fish: iota.Particle | None = None  # that is away from the shoal, or carries
        self.lure: iota.Bond | None = None
        self.piece: list[iota.Body] = []
        self.pieces: list[list[iota.Body]] = []  # that drift away
        self._say("")
        self._left = [list(kelp) for kelp in self._kelps]

    def go_on(self) -> None:
        """The next event."""
        if self.fish is None:
            self.leave()
        elif self.lure is not None:
            self.tear()
        else:
            self.let_go()

    def leave(self) -> None:
        """The fish forgets the shoal; a force draws it to the food instead."""
        if all(len(kelp) <= 2 * PIECE for kelp in self._left):
            self._world.reset()
            return
        self.fish = self.hero
        tip = max(self._left, key=len)[-1].particles[-1]
        self._school.group.remove(self.fish)
        self._say("feeds on the kelp")
        self.lure = self._world.system.bond(self.fish, tip, LURE, r0=0.18)

    def tear(self) -> None:
        """The last links come off, and hang from the fish's mouth; it follows the shoal again."""
        assert self.fish is not None
        kelp = next(kelp for kelp in self._left if kelp[-1] == self._tip().body)
        self.piece = [kelp.pop() for _ in range(PIECE)][::-1]
        kelp[-1].particles[-1].separate(self.piece[0].particles[0])
        self.fish.combine(self.piece[-1].particles[-1], over=0.5)
        self._say("carries its meal, and lags behind")
        self._weed.remove(*self.piece)
        self._load.add(*self.piece)
        self._end_lure()

    def let_go(self) -> None:
        """The piece drifts away."""
        assert self.fish is not None
        self._load.remove(*self.piece)
        self._weed.add(*self.piece)
        if self.fish.ring and len(self.fish.ring) > 1:
            self.fish.separate(self.piece[-1].particles[-1])
        self.pieces.append(self.piece)
        self.fish, self.piece = None, []
        self._say("")

    def call_off(self) -> None:
        """A fish that only feeds goes home; one that carries waits for the next event."""
        if self.lure is not None:
            self._end_lure()
            self.fish = None
            self._say("")

    def _say(self, text: str) -> None:
        """Labels the fish with what it does; an empty text removes the label."""
        self._label.text, self._label.visible = text, text != ""

    def _tip(self) -> iota.Particle:
        assert self.lure is not None
        return self.lure.ends[1]

    def _end_lure(self) -> None:
        assert self.lure is not None and self.fish is not None
        self.lure.destroy()
        self.lure = None
        self._school.group.add(self.fish)

    def _clear(self) -> None:
        """Pieces that have drifted out of sight are gone."""
        for piece in [piece for piece in self.pieces if piece[0].position.y > HIGHEST]:
            self.pieces.remove(piece)
            for link in piece:
                link.destroy()


# --- three kinds of seaweed -------------------------------------------------------------------------------------------


def kelp(world: iota.World, weed: iota.Group, x: float, z: float, length: float = LENGTH) -> list[iota.Body]:
    """An articulated chain of rigid links, each with a leaf, on the bed."""
    stem = iota.builder.chain(NODES, length, top=(x, 0.02, z), direction=(0.1, 1, 0), mass=2.0)
    links = stem.realize(world.system).bodies
    link = length / NODES
    leaf = looks.Look(iota.Ellipsoid((0.16, 0.34, 0.02)), "rubber", "#7d8f2e", offset=(0.04, 0.15, 0), turn=math.pi)
    world.draw(links, [looks.capsule(0.02, "rubber", link, color="#5d7024"), leaf])
    weed.add(*links)
    return links


def bush(world: iota.World, weed: iota.Group, foot: tuple[float, float, float]) -> None:
    """Four rigid stems in one hinge at the bed, held apart by springs, with a soft strand on each (Faure 1999)."""
    system, tops = world.system, []
    base = system.body().particle(foot, mass=0.1)
    base.radius = 0.05
    base.nail()
    for number in range(4):
        angle = math.pi / 4 + number * math.pi / 2
        stem = system.body()
        low = stem.particle(foot, mass=0.05)
        top = stem.particle(iota.Vec3(*foot) + (0.22 * math.cos(angle), 0.55, 0.22 * math.sin(angle)), mass=0.05)
        base.combine(low)
        world.draw(stem, looks.capsule(0.03, "rubber", color="#8a4a3a"))
        weed.add(stem)
        strand(world, weed, top, iota.Vec3(0.05 * math.cos(angle), 0.13, 0.05 * math.sin(angle)), 6, (0.75, 0.35, 0.3))
        tops.append(top)
    for p, q in combinations(tops, 2):
        system.bond(p, q, "spring", stiffness=4, damping=0.05)


def ribbon(world: iota.World, weed: iota.Group, foot: tuple[float, float, float]) -> None:
    """A soft chain from the bed."""
    base = world.system.body().particle(foot, mass=0.05)
    base.radius = 0.03
    base.nail()
    strand(world, weed, base, iota.Vec3(0.01, 0.15, 0), 9, (0.35, 0.6, 0.3))


def strand(
    world: iota.World, weed: iota.Group, start: iota.Particle, way: iota.Vec3, nodes: int, color: tuple[float, ...]
) -> None:
    """Particles on springs, from a particle on; springs over two resist bending."""
    points, soft = [start], next(group for group in world.system.groups if group.name == "soft")
    for number in range(1, nodes + 1):
        node = world.system.body().particle(start.position + way * number, mass=0.02)
        node.radius, node.color = 0.034 - 0.002 * number, color
        for group in (weed, soft):
            group.add(node)
        points.append(node)
    for p, q in pairwise(points):
        world.system.bond(p, q, "spring", stiffness=40, damping=0.1)
    for p, q in zip(points, points[2:], strict=False):
        world.system.bond(p, q, "spring", stiffness=2, damping=0.02)


def bubbles(world: iota.World) -> None:
    """They rise from between the stones."""
    for x, z, rate in ((-2.2, 0.2, 6), (1.3, 1.6, 4)):
        world.system.emitter(
            rate=rate, source=iota.Sphere(0.08), position=(x, 0.4, z), velocity=(0, 0.7, 0), velocity_spread=0.12, mass=0.001,
            lifetime=11, lifetime_spread=1, curve=[(0, 0.005, (0.45, 0.68, 0.76)), (1, 0.016, (0.55, 0.76, 0.82))],
        )  # fmt: skip
