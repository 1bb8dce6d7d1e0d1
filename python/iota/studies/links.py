# SPDX-License-Identifier: Apache-2.0
"""Chains of steel links that hold each other by contact alone hang from pegs; k hangs the short one on the next peg, c begins anew."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise

import iota
from iota import looks

from ._story import Story

BEND, WIRE, STRETCH, STEEL = (
    0.04,
    0.005,
    0.03,
    7800.0,
)  # radius of a link's ends and of its wire, its straight length, m; kg/m^3
PITCH = 2 * BEND + STRETCH - 2 * WIRE  # from link to link, m
LINKS, SHORT, RATIO = 8, 4, 50  # of the long chain and the short one; mass of the weight, of that of a link
PEGS, HEIGHT, LENGTH, LEAN = (-0.3, 0.1, 0.4), 1.35, 0.15, 0.05  # x, m; m; m; rad, by which they point up
DOWN = 2 * WIRE - BEND - STRETCH / 2  # from a peg to the middle of the link on it, m
AT, TIP = 0.1, 0.02  # from the board to the link; height of a peg's end, m
FRICTION = iota.Material(friction=0.3)
Turn = tuple[float, float, float, float]
ALONG: Turn = (0.0, 0.0, 0.5**0.5, 0.5**0.5)  # upright, along the board
ACROSS: Turn = (0.5, 0.5, 0.5, 0.5)  # upright, at right angles to it


def build() -> iota.World:
    """The world of the study."""
    world = make_world()
    Links(world)
    return world


def make_world() -> iota.World:
    """Board and pegs. A chain that hangs still for half a second sleeps."""
    system = iota.System()
    system.rest_after = 0.5
    world = iota.World(system, title="links: steel rings hold each other by contact alone; each is 12 cm long")
    present(world)
    return world


def present(world: iota.World) -> None:
    world.add_static(looks.box((1.14, 0.24, 0.04), "wood"), (0.02, HEIGHT + 0.03, -0.02))
    for x in (-0.58, 0.62):
        world.add_static(looks.box((0.06, HEIGHT + 0.15, 0.06), "wood"), (x, (HEIGHT + 0.15) / 2, -0.02))
        world.add_static(looks.box((0.08, 0.04, 0.5), "wood"), (x, 0.02, -0.02))
    for x in PEGS:
        end, brass = on_peg(x, LENGTH), looks.capsule(WIRE, "brass")
        world.add_strut(tuple(on_peg(x, 0)), tuple(end), brass).material = FRICTION
        for place in (end, on_peg(x, AT - 0.025)):  # a chain that swings would walk off
            world.add_strut(tuple(place), tuple(place + (0, TIP, 0)), brass).material = FRICTION
    world.stage("room")
    world.camera = iota.Camera(position=(0.74, 1.24, 1.9), target=(0.02, 0.8, 0))


class Links:
    """A long chain with a weight, and a short one."""

    def __init__(self, world: iota.World, ratio: float = RATIO) -> None:
        self.world, self.system = world, world.system
        self.chain, self.short = self._chain(PEGS[0], LINKS), self._chain(PEGS[1], SHORT)
        self.weight = self._weight(self.chain[-1], ratio)
        self.peg = 1  # on which the short one hangs
        self._grips: list[iota.Grip] = []
        self._way: list[tuple[float, iota.Vec3]] = []  # s, of the middle of the link
        self.story = Story(world, wait=6.0, first=0.5, on_stop=self.release)
        self.story.at(0.0)(self.push)
        self.story.at(2.0)(self.rehang)
        self.story.at(8.0)(lambda: None)
        self.story.action("rehang", key="k", help="hangs the short chain on the next peg")(self.rehang)
        world.action("begin anew", key="c", help="all hangs as at the start", on="world")(self.begin_anew)
        world.on_step(self._follow)
        world.on_reset(self._forget)

    def _chain(self, x: float, count: int) -> list[iota.Body]:
        place, made = on_peg(x, AT) + (0, DOWN, 0), []
        for number in range(count):
            link = self.system.body(
                shape=iota.Torus(BEND, WIRE, STRETCH), density=STEEL, material=FRICTION, damping=0.2,
                position=place - (0, PITCH * number, 0), orientation=ACROSS if number % 2 else ALONG,
            )  # fmt: skip
            self.world.draw(link, looks.solid("steel", "#b9bec4" if x < 0 else "#c9a24a"))
            made.append(link)
        return made

    def _weight(self, last: iota.Body, ratio: float) -> iota.Body:
        """A ball at a ring of its own."""
        link = self.system.body(
            shape=iota.Torus(BEND, WIRE, STRETCH), density=STEEL, material=FRICTION, damping=0.2,
            position=last.position - (0, PITCH, 0), orientation=ACROSS if LINKS % 2 else ALONG,
        )  # fmt: skip
        mass = ratio * link.mass
        radius = (3 * mass / (4 * math.pi * STEEL)) ** (1 / 3)
        low = link.position - (0, BEND + STRETCH / 2 + radius, 0)
        link.combine(self.system.body(shape=iota.Sphere(radius), mass=mass, position=low))
        self.world.draw(link, looks.solid("paint", "#b5352b"))
        return link

    def push(self) -> None:
        """Lets the weight swing along the board."""
        with self.system.edit():
            for body, share in zip([*self.chain, self.weight], range(1, LINKS + 2), strict=True):
                body.velocity += (0.4 * share / (LINKS + 1), 0, 0)

    def rehang(self) -> None:
        """Two fingers take the uppermost link of the short chain, lift it off its peg, and put it on the other one."""
        if self._grips:
            return
        link, self.peg = self.short[0], 3 - self.peg
        up, out = iota.Vec3(0, 0.045, 0), iota.Vec3(0, 0.02, LENGTH - AT + 0.06)
        start, end = link.position, on_peg(PEGS[self.peg], AT) + (0, DOWN, 0)
        now = self.system.time
        self._way = [
            (now + time, place)
            for time, place in (
                (0.0, start), (0.6, start + up), (1.4, start + up + out), (2.4, end + up + out), (3.2, end + up),
                (3.8, end - (0, 0.005, 0)),
            )
        ]  # fmt: skip
        for side in (-1, 1):
            self._grips.append(self.system.grip(link, (STRETCH / 2, side * BEND, 0), frequency=6, max_acceleration=400))

    def _follow(self) -> None:
        now = self.system.time
        if not self._grips:
            return
        if now >= self._way[-1][0] or not all(grip.alive for grip in self._grips):
            return self.release()
        place = between(self._way, now)
        for side, grip in zip((-1, 1), self._grips, strict=True):
            grip.move(place + (-side * BEND, STRETCH / 2, 0))

    def release(self) -> None:
        for grip in self._grips:
            if grip.alive:
                grip.destroy()
        self._grips = []

    def begin_anew(self) -> None:
        self.story.touch()
        self.world.reset()

    def _forget(self) -> None:
        self._grips, self.peg = [], 1


def on_peg(x: float, out: float) -> iota.Vec3:
    """A place on the middle line of a peg, `out` m along it from the board."""
    return iota.Vec3(x, HEIGHT + out * math.sin(LEAN), out * math.cos(LEAN))


def between(way: Sequence[tuple[float, iota.Vec3]], time: float) -> iota.Vec3:
    """On a way of times and places, with rests at its corners."""
    for (begin, start), (end, place) in pairwise(way):
        if time < end:
            share = max(0.0, (time - begin) / (end - begin))
            return start + (place - start) * (share * share * (3 - 2 * share))
    return way[-1][1]


if __name__ == "__main__":
    build().run()
