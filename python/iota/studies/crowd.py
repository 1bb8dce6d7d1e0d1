# SPDX-License-Identifier: Apache-2.0
"""Acrobats, ladders, chains, cradles and shoals: only what is near a walking lamp is simulated in full; t tints the levels."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache

import iota
from iota import looks
from iota.levels.level import Level
from iota.levels.managed import Managed

from . import cradle_contact
from ._figure import ALONG, UPRIGHT, Figure, Part
from .cradle import RADIUS, strung

COUNT = 24
BUDGET = 0.8  # ms of processor time a step
ROWS, APART, HEIGHT = 3, 2.6, 3.4  # of gallows; m
PACE = 2.0  # of the lamp, m/s
LINK, LINKS = 0.24, 8  # of a chain; m
RUNGS, STEP, WIDTH = 6, 0.3, 0.36  # of a rope ladder; m
ARM, LEG, THICK = 0.5, 0.7, 0.045  # of an acrobat; m
BALL = 0.1  # radius, in a cradle; m
FISH, LONG = 8, 0.26  # of paper, at least so many in a shoal; m
HOME = 2.3  # where they swim, m
# A fish swims around the middle of its cell of p m, at a distance of o m and at u m/s, up and down by b m about the height h, and floats.
SWIM = """dx = x - p*floor(x/p + 0.5); dz = z - p*floor(z/p + 0.5); r = sqrt(dx^2 + dz^2 + 0.01)
fx = m*(k*(-u*dz/r - vx) - s*(1 - o/r)*dx)
fz = m*(k*(u*dx/r - vz) - s*(1 - o/r)*dz)
fy = m*(g + e*(h + b*sin(w*t + x - dx + z - dz) - y) - k*vy)"""
TRAIL = "fx = -k*m*vx; fy = m*(g - k*vy); fz = -k*m*vz"  # of tails in still air
ACROBAT = [
    Part("torso", iota.Box((0.36, 0.5, 0.18)), 30, (0, 0, 0), ALONG),
    *(
        Part(f"{name} arm", iota.Capsule(THICK, ARM - 2 * THICK), 4, (x, 0.25 + ARM / 2, 0), UPRIGHT, "torso", (x, 0.25, 0),
             hangs=((x, 0.25 + ARM, 0),))
        for name, x in (("right", -0.2), ("left", 0.2))
    ),
    *(
        Part(f"{name} leg", iota.Capsule(THICK, LEG - 2 * THICK), 9, (x, -0.25 - LEG / 2, 0), UPRIGHT, "torso", (x, -0.25, 0))
        for name, x in (("right", -0.12), ("left", 0.12))
    ),
    Part("head", iota.Sphere(0.09), 5, (0, 0.37, 0), ALONG, "torso", (0, 0.25, 0)),
]  # fmt: skip
PAINTS = ("#b5462f", "#d9a441", "#5b7f4b", "#2f6c80")
TINTS = {
    "full": "#ece6d6",
    "1/2": "#9aa64a",
    "1/4": "#d9a441",
    "1/8": "#cf7a3a",
    "stiff": "#b5462f",
    "frozen": "#5a6f8c",
}


def build(count: int = COUNT, budget_ms: float | None = BUDGET) -> iota.World:
    """The world of the study. count: how many things hang there. budget_ms: None simulates all in full."""
    system = iota.System(damping=0.02)
    system.usual_material = iota.Material(touches="obstacles")  # their own legs do not matter from afar
    length = APART * math.ceil(count / ROWS)
    world = iota.World(system, title=f"crowd: a lamp walks through a valley of {length:.0f} m", ground=0.0)
    world.stage(ground="#93a06f")
    world.camera = iota.Camera(position=(-4.2, 2.3, 4.9), target=(4, 1.9, -0.5))
    crowd = Crowd(world, count)
    world.levels.viewers = lambda: [crowd.eye()]
    world.levels.budget_ms = budget_ms
    return world


class Crowd:
    """All that hangs, stands and flies in the valley, and the lamp that walks through it."""

    def __init__(self, world: iota.World, count: int) -> None:
        self.world, self.system = world, world.system
        self.length = APART * max(1, math.ceil(count / ROWS))
        self.is_tinted = True
        self.things: list[Managed] = []
        self.coats: dict[Managed, tuple[Coat, str]] = {}
        for number in range(count):
            column, row = divmod(number, ROWS)
            at = iota.Vec3(APART * column, HEIGHT, APART * (row - (ROWS - 1) / 2))
            kind, paint = KINDS[(column + row) % len(KINDS)], PAINTS[number % 4]
            if kind.frame is not None:
                kind.frame(world, at)
            made = kind.make(world, at, paint, number)
            self.things.append(thing := world.levels.manage(made, levels=kind.levels, on_level=self.tint))
            self.coats[thing] = kind.coat, paint
            self.tint(thing, thing.level)
        self.lamp = world.drawings.shape(looks.sphere(0.12, "brass", color="#ffd27a"), position=tuple(self.eye()))
        world.every(1 / 30)(self.walk)
        world.action("tint", key="t", help="colors things by their levels", on="world")(self.toggle)

    def eye(self) -> iota.Vec3:
        """The place of the lamp: it goes through the valley and back."""
        way = (PACE * self.system.time) % (2 * self.length)
        return iota.Vec3(min(way, 2 * self.length - way), 1.6, 0.5 * APART)

    def walk(self) -> None:
        self.lamp.position = tuple(self.eye())

    def toggle(self) -> None:
        self.is_tinted = not self.is_tinted
        for thing in self.things:
            self.tint(thing, thing.level)

    def tint(self, thing: Managed, level: Level) -> None:
        """Draws a thing in the color of its level."""
        coat, paint = self.coats[thing]
        self.world.draw(thing.bodies, coat(TINTS[level.name] if self.is_tinted else paint))


def gallows(world: iota.World, at: iota.Vec3) -> None:
    world.add_static(looks.box((0.67, 0.08, 0.08), "wood"), (at.x - 0.085, at.y, at.z))
    world.add_static(looks.box((0.07, at.y, 0.07), "wood"), (at.x - 0.42, at.y / 2, at.z))


def chain(world: iota.World, at: iota.Vec3, color: str, number: int) -> iota.Body:
    """Links that were pulled to the side."""
    links: list[iota.Body] = []
    way = iota.Vec3(0.05 * math.sin(number), -1.5, math.copysign(1.0, math.cos(3 * number)))
    way = way / abs(way) * LINK
    for k in range(LINKS):
        link = world.system.body()
        upper = link.particle(at + way * k, mass=0.2)
        link.particle(at + way * (k + 1), mass=0.2 if k + 1 < LINKS else 2.0)
        if links:
            links[-1].particles[1].combine(upper)
        else:
            upper.nail()
        links.append(link)
        world.draw(link, looks.capsule(0.02, "paint", color=color))
    return links[0]


def ladder(world: iota.World, at: iota.Vec3, color: str, number: int) -> iota.Body:
    """Rungs between two ropes of rods, pushed."""
    made: list[iota.Body] = []
    above: list[iota.Particle] = []
    for k in range(RUNGS + 1):
        ends = [at + (side * WIDTH / 2, -STEP * k, 0) for side in (-1, 1)]
        if k == 0:
            places = []
            for end in ends:
                rod = world.system.body()
                top = rod.particle(end, mass=0.1)
                top.nail()
                rod.particle(end - (0, STEP, 0), mass=0.1)
                made.append(rod)
                places.append(rod.particles[1])
            above = places
            continue
        rung = world.system.body()
        here = [rung.particle(end, mass=0.3) for end in ends]
        made.append(rung)
        for mine, other in zip(here, above, strict=True):
            other.combine(mine)
        above = []
        if k < RUNGS:
            for mine, end in zip(here, ends, strict=True):
                rod = world.system.body()
                mine.combine(rod.particle(end, mass=0.1))
                above.append(rod.particle(end - (0, STEP, 0), mass=0.1))
                made.append(rod)
    for body in made:
        world.draw(body, looks.capsule(0.02, "paint", color=color))
    made[-1].velocity = (0, 0, 1.5 + 0.5 * math.sin(number))
    return made[0]


def acrobat(world: iota.World, at: iota.Vec3, color: str, number: int) -> iota.Body:
    """Hangs by both hands and swings."""
    made = Figure(
        world.system, ACROBAT, at - (0, ARM + 0.25, 0), lambda _, body: world.draw(body, looks.solid("paint", color))
    )
    for hand in made.hangs:
        hand.nail()
    torso = made.bodies["torso"]
    torso.velocity = (0, 0, 1.2 + 0.4 * math.cos(number))
    return torso


def cradle(world: iota.World, at: iota.Vec3, color: str, number: int) -> list[iota.Body]:
    """Stands on the ground, with one or two balls lifted."""
    row = cradle_contact.Row(world, "steel", at=at - (0, HEIGHT, 0), label=False, size=BALL / RADIUS)
    row.lift(lifted := 1 + number % 2, 0)
    swing = iota.Vec3(0, 0, -0.9 * abs(math.sin(number)))  # rad/s, so that not all of them hit in the same step
    for ball, top in zip(row.balls[:lifted], row.tops, strict=False):
        ball.angular_velocity, ball.velocity = swing, swing.cross(ball.position - top)
    world.draw(row.balls, steel(color))
    return row.balls


def shoal(world: iota.World, at: iota.Vec3, color: str, number: int) -> list[iota.Body]:
    """Fish of paper around the pole of their cell. All shoals obey the same laws, so fish that are put elsewhere join another one."""
    heads, tails = water(world.system)
    made: list[iota.Body] = []
    for k in range(FISH + number % 5):
        angle = number + 0.3 * k
        out = iota.Vec3(math.cos(angle), 0, math.sin(angle))
        along = iota.Vec3(-out.z, 0, out.x)
        head = iota.Vec3(at.x, HOME + 0.25 * (k % 3 - 1), at.z) + out * (0.75 + 0.15 * (k % 2))
        fish = world.system.body()
        tails.add(fish.particle(head - along * LONG, mass=0.1))
        heads.add(fish.particle(head, mass=0.2))
        fish.velocity = along * 1.2
        made.append(fish)
    world.draw(made, paper(color))
    return made


def water(system: iota.System) -> tuple[iota.Group, iota.Group]:
    """The groups of heads and tails of all fish, with the forces that make them swim: expressions, so that strides and copies of frozen
    shoals have them."""
    known = {group.name: group for group in system.groups}
    if "heads" in known:
        return known["heads"], known["tails"]
    heads, tails = system.group("heads"), system.group("tails")
    up = abs(system.gravity)
    system.field(SWIM, group=heads, p=APART, k=3.0, u=2.1, s=12.0, o=0.72, g=up, e=0.7, h=HOME, b=0.3, w=0.9)
    system.field(TRAIL, group=tails, k=4.0, g=up)
    system.pair_force(
        "attract_repel", cutoff=0.8, group=heads, attraction=0.1, attraction_range=0.8, repulsion=0.18, repulsion_range=0.2,
        alignment=0.02,
    )  # fmt: skip
    return heads, tails


def pole(world: iota.World, at: iota.Vec3) -> None:
    world.add_static(looks.box((0.07, at.y, 0.07), "wood"), (at.x, at.y / 2, at.z))
    world.add_static(looks.sphere(0.1, "brass"), (at.x, at.y + 0.08, at.z))


@cache
def solid(color: str) -> looks.Look:
    return looks.solid("paint", color)


@cache
def rod(color: str) -> looks.Look:
    return looks.capsule(0.02, "paint", color=color)


@cache
def steel(color: str) -> list[looks.Look]:
    return strung(looks.sphere(BALL, "steel", color=color), BALL / RADIUS)


@cache
def paper(color: str) -> list[looks.Look]:
    """A fish that is round, as a rod may turn about itself."""
    return [
        looks.ellipsoid((0.3, 0.13, 0.13), "paint", color=color, offset=(0.03, 0, 0)),
        looks.cone(0.08, 0.17, "paint", color=color, offset=(-0.145, 0, 0)),
    ]


Coat = Callable[[str], looks.Look | list[looks.Look]]


@dataclass(frozen=True)
class Kind:
    """A kind of thing. frame: makes what holds it. make: the thing, of a color. coat: its look. levels: see `Levels.manage`."""

    frame: Callable[[iota.World, iota.Vec3], None] | None
    make: Callable[[iota.World, iota.Vec3, str, int], iota.Body | list[iota.Body]]
    coat: Coat
    levels: tuple[str, ...] | None = None


KINDS = (
    Kind(gallows, acrobat, solid),
    Kind(gallows, ladder, rod),
    Kind(gallows, chain, rod),
    Kind(None, cradle, steel, ("full", "frozen")),  # balls touch, and what touches takes every step
    Kind(pole, shoal, paper),
)


if __name__ == "__main__":
    build().run()
