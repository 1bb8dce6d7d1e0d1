# SPDX-License-Identifier: Apache-2.0
"""A table of things that stand by contact alone: towers, a pyramid, an anvil on matchboxes; k pushes dominoes, c builds all anew."""

from __future__ import annotations

import math

import iota
from iota import looks

TABLE = 0.55  # height of its top, m
TOP = (2.3, 0.05, 0.84)  # m
WOOD = 600.0  # kg/m^3
CUBE, CUBES = 0.08, 10  # m; how many are on each other
BLOCK, ROWS = (0.12, 0.07, 0.08), 4  # of the pyramid
DOMINO, DOMINOES, SPACING = (0.014, 0.1, 0.05), 26, 0.052  # from middle to middle, m
MATCHBOX, MATCHBOXES, MATCHES = (0.11, 0.034, 0.07), 8, 0.03  # kg
ANVIL = 1000 * MATCHES  # kg
SMOOTH = iota.Material(friction=0.15)  # of dominoes: at 0.6 a row that turns jams, and the wave creeps
PUSH = 3.0  # rad/s, of the first domino about its edge
UPRIGHT, QUARTER = (0.0, 0.0, 0.0, 1.0), (0.0, 0.5**0.5, 0.0, 0.5**0.5)
COLORS = ("#b5462f", "#d9a441", "#5b7f4b", "#2f6c80")


def build() -> iota.World:
    """The world of the study: what stands falls asleep after half a second, and costs nothing until it is touched."""
    system = iota.System()
    system.rest_after = 0.5
    world = iota.World(system, title="stack: towers on a table of 2.3 m stand until they are pushed")
    present(world)
    Stacks(world)
    return world


def present(world: iota.World) -> None:
    """The table, and where one stands in front of it."""
    top = world.add_static(looks.box(TOP, "wood"), (0, TABLE - TOP[1] / 2, 0))
    top.material = iota.Material(friction=0.6)
    for x in (-1.05, 1.05):
        for z in (-0.34, 0.34):
            world.add_static(looks.box((0.06, TABLE - TOP[1], 0.06), "wood"), (x, (TABLE - TOP[1]) / 2, z))
    world.stage("studio")
    world.camera = iota.Camera(position=(0.5, 1.45, 2.25), target=(0.02, 0.78, 0))


class Stacks:
    """All that is on the table.

    Bodies touch by sharp boxes, and are drawn with edges that are rounded a little."""

    def __init__(self, world: iota.World) -> None:
        self.world, self.system = world, world.system
        self.tower = [
            self.box((CUBE, CUBE, CUBE), (-0.88, CUBE * (number + 0.5), -0.1), WOOD, COLORS[number % 4])
            for number in range(CUBES)
        ]
        self.pyramid = self._pile(iota.Vec3(-0.2, 0, -0.12))
        self.matchboxes, self.anvil = self._weighed(iota.Vec3(0.72, 0, -0.08))
        self.dominoes, self.way = self._row()
        self.start = {body: (body.position, body.orientation) for body in self.system.bodies}
        world.action("push", key="k", help="pushes the first domino", on="world")(self.push)
        world.action("build anew", key="c", help="everything stands again where it stood", on="world")(self.build_anew)
        world.tools.push(radius=0.02)
        world.at(1.0)(self.push)

    def box(
        self,
        size: tuple[float, float, float],
        at: tuple[float, float, float],
        density: float,
        color: str | tuple[float, float, float] | None = None,
        turn: tuple[float, float, float, float] = UPRIGHT,
    ) -> iota.Body:
        """A box on the table. at: of its middle, above the table's."""
        place = iota.Vec3(0, TABLE, 0) + at
        body = self.system.body(shape=iota.Box(size), density=density, position=place, orientation=turn)
        self.world.draw(body, looks.box(size, "paint" if color else "wood", 0.06 * min(size), color=color))
        return body

    def _pile(self, at: iota.Vec3) -> list[iota.Body]:
        """The pyramid; its blocks have gaps between them, so that each lies on two."""
        length, height, _ = BLOCK
        return [
            self.box(
                BLOCK, (at.x + (place - (count - 1) / 2) * 1.05 * length, height * (ROWS - count + 0.5), at.z), WOOD
            )
            for count in range(ROWS, 0, -1)
            for place in range(count)
        ]

    def _weighed(self, at: iota.Vec3) -> tuple[list[iota.Body], iota.Body]:
        """Matchboxes, each across the one below, and on them an anvil of a thousand times their mass."""
        length, height, width = MATCHBOX
        density = MATCHES / (length * height * width)
        boxes = [
            self.box(MATCHBOX, (at.x, height * (number + 0.5), at.z), density, COLORS[number % 2], turn)
            for number, turn in enumerate([QUARTER, UPRIGHT] * (MATCHBOXES // 2))
        ]
        foot = at + (0, TABLE + height * MATCHBOXES, 0)
        sizes = (((0.17, 0.045, 0.1), 0.0225), ((0.08, 0.06, 0.07), 0.075), ((0.24, 0.055, 0.09), 0.1325))
        volume = sum(math.prod(size) for size, _ in sizes) + math.pi * 0.026**2 * 0.12 / 3
        parts = [
            self.system.body(shape=iota.Box(size), density=ANVIL / volume, position=foot + (0, y, 0))
            for size, y in sizes
        ]
        horn = iota.Cone(0.026, 0.12)
        parts.append(self.system.body(shape=horn, density=ANVIL / volume, position=foot + (0.15, 0.1325, 0)))
        anvil = parts[0]
        for part in parts[1:]:
            anvil.combine(part)
        self.world.draw(anvil, looks.solid("steel", "#555b63"))
        anvil.name = "anvil"
        return boxes, anvil

    def _row(self) -> tuple[list[iota.Body], list[iota.Vec3]]:
        """Dominoes along a wave at the front of the table, and the direction in which each falls."""
        made, ways, x = [], [], -SPACING * (DOMINOES - 1) / 2 * 0.97
        for number in range(DOMINOES):
            slope = -0.32 * math.sin(2 * math.pi * x / 0.9)
            z, along = 0.25 + 0.32 * 0.9 / (2 * math.pi) * math.cos(2 * math.pi * x / 0.9), math.hypot(1, slope)
            half = -math.atan(slope) / 2
            turn = (0.0, math.sin(half), 0.0, math.cos(half))
            made.append(self.box(DOMINO, (x, DOMINO[1] / 2, z), 900, tint(number / (DOMINOES - 1)), turn))
            made[-1].material = SMOOTH
            ways.append(iota.Vec3(1 / along, 0, slope / along))
            x += SPACING / along
        return made, ways

    def push(self) -> None:
        """Turns the first domino about its front edge."""
        first, way = self.dominoes[0], self.way[0]
        spin = iota.Vec3(0, 1, 0).cross(way) * PUSH
        edge = way * (DOMINO[0] / 2) - (0, DOMINO[1] / 2, 0)
        with self.system.edit():
            first.velocity, first.angular_velocity = spin.cross(edge * -1), spin

    def build_anew(self) -> None:
        with self.system.edit():
            for body, (place, turn) in self.start.items():
                body.set_pose(place, turn)
                body.velocity = body.angular_velocity = (0, 0, 0)


def tint(share: float) -> tuple[float, float, float]:
    """A color from red over yellow to blue."""
    ends = ((0.75, 0.2, 0.16), (0.93, 0.72, 0.25), (0.16, 0.42, 0.6))
    low, high = ends[share > 0.5], ends[1 + (share > 0.5)]
    part = 2 * share - (share > 0.5)
    return tuple(a + (b - a) * part for a, b in zip(low, high, strict=True))  # type: ignore[return-value]


if __name__ == "__main__":
    build().run()
