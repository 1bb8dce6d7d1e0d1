# SPDX-License-Identifier: Apache-2.0
"""Balls, blocks, pills and rollers pour out of a hopper into a tray on scales; pull the red slide, k does it too, c fills anew."""

from __future__ import annotations

import math

import numpy as np

import iota
from iota import looks
from iota.frames import Quaternion, one_after_another

from ._story import Story

GRAINS, SIZE, DENSITY = 120, 0.019, 900.0  # m, kg/m^3
THROAT, MOUTH, LIP, RIM = 0.2, 0.42, 0.5, 0.72  # widths, m; heights of the throat and of the upper end of the slope
WALL, HIGH = 0.016, 0.2  # of the hopper: thickness, height above the slope, m
SPOUT = 0.04  # height below the lip, m
SLIDE, TRAVEL = (THROAT + 0.12, 0.016, THROAT + 0.05), THROAT + 0.05  # m
TRAY, TALL, THICK = 0.5, 0.18, 0.02  # width, height of its walls, thickness, m
SCALES = 0.1  # height, m
STEP = 1 / 120  # s: what falls is faster than its own length in 1/60 s
GLASSY, SLICK = iota.Material(friction=0.2), iota.Material(friction=0.08)
GRAIN = iota.Material(friction=0.3, rolling=0.02)
COLORS = ("#c8343c", "#e0a63a", "#3f7f5f", "#2f6c90")


def build() -> iota.World:
    """The world of the study."""
    world = make_world()
    Pour(world)
    return world


def make_world() -> iota.World:
    """Grains that lie still for half a second sleep."""
    system = iota.System()
    system.rest_after, system.rest_speed = 0.5, 0.04
    system.budget_contacts = 1e6  # sweeps: equations of so many places of contact take up to 0.1 s in a blow
    world = iota.World(system, title="pour: grains run out of a hopper into a heap; the tray is 0.5 m wide")
    world.dt = STEP
    present(world)
    return world


def present(world: iota.World) -> None:
    world.stage("room")
    world.camera = iota.Camera(position=(0.62, 0.95, 1.5), target=(0.04, 0.43, 0))


class Pour:
    """Hopper, slide, scales, tray and grains."""

    def __init__(self, world: iota.World, grains: int = GRAINS) -> None:
        self.world, self.system = world, world.system
        self._hopper()
        self._stand()
        self.scales = self._scales()
        self.slide, self.tray = self._slide(), self._tray()
        self.grains = self._grains(grains)
        self.start = {body: (body.position, body.orientation) for body in self.system.bodies}
        self._grip: iota.Grip | None = None
        self._goal = 0.0
        self.dial = world.drawings.label("", at=(0, SCALES / 2, TRAY / 2 + 0.075), height=0.035)
        self.story = Story(world, wait=4.0, first=1.2)
        self.story.at(0.0)(lambda: self.pull(True))
        self.story.at(5.5)(self.fill)
        world.action("slide", key="k", help="pulls the slide, or pushes it back", on="world")(self.toggle)
        self.story.action("fill", key="c", help="all goes back into the hopper")(self.fill)
        world.on_step(self._follow)
        world.every(0.2)(self._read)

    # --- what does not move -------------------------------------------------------------------------------------------

    def wall(
        self,
        size: tuple[float, float, float],
        at: tuple[float, float, float],
        turn: Quaternion = (0, 0, 0, 1),
        look: str = "glass",
        material: iota.Material = GLASSY,
    ) -> iota.Body:
        color = "#e9f3f6" if look == "glass" else None
        made = self.world.add_static(looks.box(size, look, color=color), at, turn)
        made.material = material
        return made

    def _hopper(self) -> None:
        """Upright walls, a slope, a spout; of each four. Glass faces the viewer."""
        rise, run = RIM - LIP, (MOUTH - THROAT) / 2
        lean, length = math.atan2(run, rise), math.hypot(run, rise)
        for side in range(4):
            yaw = side * math.pi / 2
            c, s = math.cos(yaw), math.sin(yaw)

            def place(out: float, height: float, c: float = c, s: float = s) -> tuple[float, float, float]:
                return (out * c, height, -out * s)

            upright = (0.0, math.sin(yaw / 2), 0.0, math.cos(yaw / 2))
            wide = MOUTH + (2 * WALL if side % 2 else 0)
            look = "glass" if side in (0, 3) else "wood"
            self.wall((WALL, HIGH, wide), place((MOUTH + WALL) / 2, RIM + HIGH / 2), upright, look)
            # Its inner face runs from the lip to the rim.
            middle = (THROAT + MOUTH) / 4 + WALL / 2 * math.cos(lean), (LIP + RIM) / 2 - WALL / 2 * math.sin(lean)
            self.wall((WALL, length, MOUTH), place(*middle), one_after_another(upright, about_z(-lean)), look)
            wide = THROAT + (2 * WALL if side % 2 else 0)
            self.wall((WALL, SPOUT, wide), place((THROAT + WALL) / 2, LIP - SPOUT / 2), upright, look)

    def _stand(self) -> None:
        """Four posts around the tray, and what the slide runs in: rails below, strips beside it, and two stops."""
        post, brass = looks.cylinder(0.014, "steel"), looks.cylinder(0.008, "brass")
        far, near = TRAY / 2 + 0.06, MOUTH / 2 + WALL
        for x in (-1.0, 1.0):
            for z in (-1.0, 1.0):
                self.world.add_strut((x * far, 0, z * far), (x * far, RIM + 0.06, z * far), post)
                self.world.add_strut((x * far, RIM + 0.04, z * far), (x * near, RIM + 0.04, z * near), brass)
        low = LIP - SPOUT - 0.002 - SLIDE[1] / 2
        length, middle = SLIDE[0] + TRAVEL + 0.02, TRAVEL / 2 + 0.03
        for z in (-1, 1):
            rail, strip = z * (SLIDE[2] / 2 - 0.008), z * (SLIDE[2] / 2 + 0.0075)
            self.wall((length, 0.012, 0.03), (middle, low - SLIDE[1] / 2 - 0.006, rail), look="steel", material=SLICK)
            self.wall((length, 0.012, 0.012), (middle, low, strip), look="steel", material=SLICK)
            for end in (-far, far):
                self.world.add_strut((end, low - 0.028, z * far), (end, low - 0.028, rail), brass)
            self.world.add_strut((-far, low - 0.028, rail), (far, low - 0.028, rail), brass)
        for stop in (-THROAT / 2 - 0.037, SLIDE[0] + TRAVEL - THROAT / 2 - 0.023):
            self.wall((0.012, 0.03, SLIDE[2] + 0.03), (stop, low, 0), look="steel", material=SLICK)

    def _scales(self) -> iota.Body:
        """A plate that weighs what stands on it, on a board."""
        self.wall((1.3, 0.02, 0.95), (0.1, 0.01, 0), look="wood", material=GRAIN)
        self.wall((0.44, SCALES - 0.04, 0.44), (0, SCALES / 2, 0), look="paint")
        return self.wall((TRAY + 0.06, 0.02, TRAY + 0.06), (0, SCALES - 0.01, 0), look="steel", material=GRAIN)

    # --- what moves ---------------------------------------------------------------------------------------------------

    def _slide(self) -> iota.Body:
        low = LIP - SPOUT - 0.002 - SLIDE[1] / 2
        slide = self.system.body(
            shape=iota.Box(SLIDE), mass=1.0, position=(SLIDE[0] / 2 - THROAT / 2 - 0.03, low, 0), material=SLICK
        )
        self.world.draw(slide, looks.box(SLIDE, "paint", 0.003, color="#d0432f"))
        return slide

    def _tray(self) -> iota.Body:
        foot = iota.Vec3(0, SCALES, 0)
        inner = TRAY - THICK
        parts = [self.system.body(shape=iota.Box((TRAY, THICK, TRAY)), density=500, position=foot + (0, THICK / 2, 0))]
        for side in range(4):
            size = (THICK, TALL, TRAY) if side % 2 else (TRAY - 2 * THICK, TALL, THICK)
            out = inner / 2 if side > 1 else -inner / 2
            at = foot + ((out, THICK + TALL / 2, 0) if side % 2 else (0, THICK + TALL / 2, out))
            parts.append(self.system.body(shape=iota.Box(size), density=500, position=at))
        for part in parts[1:]:
            parts[0].combine(part)
        self.world.draw(parts[0], looks.solid("glass", "#e9f3f6"))
        parts[0].material = GRAIN
        return parts[0]

    def _grains(self, count: int) -> list[iota.Body]:
        """Four kinds, in layers within the hopper, turned at random."""
        random, pitch = np.random.default_rng(2), 3.0 * SIZE
        row = int((MOUTH - 0.01) / pitch)
        kinds = (
            (iota.Sphere(SIZE), "glass"),
            (iota.Box((1.7 * SIZE,) * 3), "wood"),
            (iota.Capsule(0.65 * SIZE, 1.5 * SIZE), "paint"),
            (iota.Cylinder(0.95 * SIZE, 1.8 * SIZE), "paint"),
        )
        made = []
        for number in range(count):
            layer, rest = divmod(number, row * row)
            across, deep = (pitch * (place - (row - 1) / 2) for place in divmod(rest, row))
            turn = random.normal(size=4)
            shape, material = kinds[number % 4]
            grain = self.system.body(
                shape=shape, density=DENSITY, damping=1.0, material=GRAIN, orientation=turn / np.linalg.norm(turn),
                position=(across, RIM - 0.02 + pitch * (layer + 0.5), deep),
            )  # fmt: skip
            color = None if material == "wood" else COLORS[(number // 4 + number) % 4]
            self.world.draw(grain, looks.solid(material, color))
            made.append(grain)
        return made

    # --- what is done -------------------------------------------------------------------------------------------------

    @property
    def opened(self) -> float:
        """How far the slide is pulled out, m."""
        return float(self.slide.position.x - self.start[self.slide][0].x)

    def toggle(self) -> None:
        self.story.touch()
        self.pull(self._goal < TRAVEL / 2)

    def pull(self, out: bool) -> None:
        """By a grip, as a hand would: it does not crush what is in its way."""
        self._goal = TRAVEL if out else 0.0
        if self._grip is None or not self._grip.alive:
            self._grip = self.system.grip(self.slide)

    def _follow(self) -> None:
        """Moves the grip, and ends it where the slide is to be."""
        if self.world.users.held() == self.slide:
            self._goal = TRAVEL if self.opened > TRAVEL / 2 else 0.0
            self._release()
        elif self._grip is not None and self._grip.alive:
            way = self._goal - self.opened
            if abs(way) < 0.004:
                self._release()
            else:
                self._grip.move(self.slide.center_of_mass + (math.copysign(min(abs(way) + 0.02, 0.06), way), 0, 0))

    def _release(self) -> None:
        if self._grip is not None and self._grip.alive:  # an undo may have ended it
            self._grip.destroy()
        self._grip = None

    def weight(self) -> float:
        """On the scales, N."""
        return -sum(contact.force.y for contact in self.scales.contacts)

    def _read(self) -> None:
        self.dial.text = f"{max(0.0, self.weight() / 9.81 - self.tray.mass):.2f} kg"

    def fill(self) -> None:
        """Shuts the slide and puts all back, as at the start."""
        self._release()
        self._goal = 0.0
        with self.system.edit():
            for body, (place, turn) in self.start.items():
                body.set_pose(place, turn)
                body.velocity = body.angular_velocity = (0, 0, 0)


def about_z(angle: float) -> Quaternion:
    return (0.0, 0.0, math.sin(angle / 2), math.cos(angle / 2))


if __name__ == "__main__":
    build().run()
