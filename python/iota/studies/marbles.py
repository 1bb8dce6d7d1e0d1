# SPDX-License-Identifier: Apache-2.0
"""Marbles roll down a zigzag of gutters into one of two boxes; a flap sorts them: turn it by hand, or with n."""

from __future__ import annotations

import math

import iota
from iota import looks

RADIUS, GLASS = 0.03, 2500.0  # m, kg/m^3
# With 0.1 a row of marbles that pushes can hold its first one in the air, at the end of a gutter.
SMOOTH = iota.Material(friction=0.03)
MARBLES, ROW = 20, 0.09  # how many; from one to the next on the uppermost gutter, m
LEAN = 0.11  # rad, of the gutters
WIDTH, WALL, HIGH = 0.07, 0.012, 0.035  # of a gutter within, of its walls, of its sides, m
BAY = 0.5  # length of the higher sides where marbles turn back, m
GUTTERS = (  # from x to x, height of the middle, m; way down; height of the end that turns marbles back
    (-1.2, 0.72, 1.42, 1, 0.035),
    (-0.62, 0.86, 1.08, -1, 0.3),
    (-0.76, 0.46, 0.77, 1, 0.3),
)
FLAP, PLATE, SIDE = iota.Vec3(0.66, 0.27, 0), (0.016, 0.34, 0.12), 0.5  # axle; m; rad to either side
BOX, BOXES = (0.52, 0.16, 0.3), (0.38, 0.94)  # m; x of their middles
COLORS = ("#cc4033", "#3373b3", "#e6b333", "#4d9959")


def build() -> iota.World:
    """The world of the study."""
    world = iota.World(iota.System(), title="marbles: balls of 6 cm roll down gutters, and a flap sorts them")
    present(world)
    Run(world)
    return world


def present(world: iota.World) -> None:
    world.stage("room")
    world.camera = iota.Camera(position=(0.5, 1.35, 2.35), target=(0.02, 0.74, 0))


class Run:
    """Gutters, flap, boxes and marbles."""

    def __init__(self, world: iota.World) -> None:
        self.world, self.system = world, world.system
        for left, right, height, way, end in GUTTERS:
            self._gutter(iota.Vec3((left + right) / 2, height, 0), right - left, way, end)
        for x in BOXES:
            self._box(x)
        self.flap = self._flap()
        self.marbles = self._marbles()
        world.action("switch", key="n", help="turns the flap to the other side", on="world")(self.switch)
        world.action("again", key="c", help="all marbles roll once more", on="world")(self.again)
        world.every(20.0)(self.again)

    def wall(self, size: tuple[float, float, float], at: iota.Vec3, lean: float = 0.0, look: str = "wood") -> iota.Body:
        made = self.world.add_static(looks.box(size, look), tuple(at), turned(lean))
        made.material = iota.Material(friction=0.3)
        return made

    def _gutter(self, at: iota.Vec3, length: float, way: int, end: float) -> None:
        """A floor between two sides, posts behind it. way: 1 if it goes down to +x. end: height of its upper end."""
        lean = -way * LEAN
        along, up = iota.Vec3(math.cos(lean), math.sin(lean), 0), iota.Vec3(-math.sin(lean), math.cos(lean), 0)
        self.wall((length, WALL, WIDTH + 2 * WALL), at, lean)
        for side in (-1, 1):
            middle = at + up * ((HIGH + WALL) / 2) + (0, 0, side * (WIDTH + WALL) / 2)
            look = "glass" if side > 0 else "wood"
            self.wall((length, HIGH, WALL), middle, lean, look)
            if end > HIGH:  # marbles that push from behind would go over the sides
                corner = at - along * (way * (length - BAY) / 2) + up * ((end + HIGH + WALL) / 2)
                self.wall((BAY, end - HIGH, WALL), corner + (0, 0, side * (WIDTH + WALL) / 2), lean, look)
        self.wall((WALL, end, WIDTH), at - along * (way * (length - WALL) / 2) + up * ((end + WALL) / 2), lean)
        for share in (-0.4, 0.4):
            place = at + along * (share * length)
            self.world.add_strut((place.x, 0, -0.2), tuple(place + (0, 0.02, -0.2)), looks.cylinder(0.012, "steel"))
            self.world.add_strut(
                tuple(place + (0, 0, -0.2)), tuple(place + (0, 0, -WIDTH / 2)), looks.cylinder(0.012, "steel")
            )

    def _box(self, x: float) -> None:
        """Open above."""
        wide, high, deep = BOX
        self.wall((wide, WALL, deep), iota.Vec3(x, WALL / 2, 0))
        for side in (-1, 1):
            self.wall((WALL, high, deep), iota.Vec3(x + side * (wide - WALL) / 2, high / 2 + WALL, 0))
            self.wall((wide - 2 * WALL, high, WALL), iota.Vec3(x, high / 2 + WALL, side * (deep - WALL) / 2))

    def _flap(self) -> iota.Constraint:
        """A plate on an axle below it: its weight keeps it on either side."""
        plate = self.system.body(shape=iota.Box(PLATE), density=900, position=FLAP + (0, PLATE[1] / 2, 0))
        self.world.draw(plate, looks.solid("paint", "#c8343c"))
        axle = self.system.revolute(plate, at=FLAP, axis=(0, 0, 1), limits=(-SIDE, SIDE), friction=0.02)
        plate.set_pose(FLAP + iota.Vec3(-math.sin(SIDE), math.cos(SIDE), 0) * (PLATE[1] / 2), turned(SIDE))
        for z in (-0.08, 0.08):
            self.world.add_strut((FLAP.x, 0, z), (FLAP.x, FLAP.y, z), looks.cylinder(0.012, "steel"))
        self.world.add_strut(tuple(FLAP - (0, 0, 0.08)), tuple(FLAP + (0, 0, 0.08)), looks.cylinder(0.012, "brass"))
        return axle

    def _marbles(self) -> list[iota.Body]:
        left, right, height, *_ = GUTTERS[0]
        middle, made = iota.Vec3((left + right) / 2, height, 0), []
        for number in range(MARBLES):
            x = left + WALL + RADIUS + ROW * (number + 0.2) - middle.x
            place = middle + (x * math.cos(LEAN), -x * math.sin(LEAN), 0)
            place += iota.Vec3(math.sin(LEAN), math.cos(LEAN), 0) * (RADIUS + WALL / 2)
            marble = self.system.body(
                shape=iota.Sphere(RADIUS), density=GLASS, position=place, damping=0.25, material=SMOOTH
            )
            self.world.draw(marble, looks.solid("glass" if number % 2 else "paint", color=COLORS[number % 4]))
            made.append(marble)
        self.start = {marble: marble.position for marble in made}
        return made

    def switch(self) -> None:
        """Throws the flap over."""
        plate = self.flap.a
        spin = iota.Vec3(0, 0, -4.0 if self.flap.angle.value > 0 else 4.0)
        with self.system.edit():
            plate.velocity, plate.angular_velocity = spin.cross(plate.center_of_mass - FLAP), spin

    def again(self) -> None:
        with self.system.edit():
            for marble, place in self.start.items():
                marble.set_pose(place, (0, 0, 0, 1))
                marble.velocity = marble.angular_velocity = (0, 0, 0)


def turned(angle: float) -> tuple[float, float, float, float]:
    return (0.0, 0.0, math.sin(angle / 2), math.cos(angle / 2))


if __name__ == "__main__":
    build().run()
