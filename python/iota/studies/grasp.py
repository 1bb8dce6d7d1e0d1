# SPDX-License-Identifier: Apache-2.0
"""Two grippers hold a bar by friction alone: one lifts it, turns it and hands it over; k hands it over, c begins anew."""

from __future__ import annotations

import math
from collections.abc import Callable

import iota
from iota import looks

from ._story import Story

BAR, DENSITY = (0.2, 0.05, 0.05), 700.0  # m, kg/m^3
TABLE, HEIGHT, APART = (0.16, 0.04, 0.3), 0.3, 0.4  # m; m, of its top; m, from the middle
PALM, FINGER = (0.05, 0.09, 0.14), (0.09, 0.022, 0.016)  # m
OPEN = 0.02  # m, from an open finger to the bar
FRICTION = iota.Material(friction=0.6)
ARM, SQUEEZE, WRIST = (80.0, 0.5), (25.0, 0.2), (10.0, 2.0)  # largest force and speed of servos: N, m/s; N m, rad/s
AWAY, UP = 0.16, 0.22  # m, from a bar on the table, and up
REACH, POST, BEHIND = 0.06, 0.55, 0.24  # m: of fingers over the bar; height of the middle of a post, and behind the bar
STEPS = (0.0, 0.8, 1.4, 2.4, 3.6, 5.4, 6.1, 6.8, 8.4, 9.6, 10.6, 11.2, 13.0)  # s, of the story


def build() -> iota.World:
    """The world of the study."""
    world = make_world()
    Grasp(world)
    return world


def make_world() -> iota.World:
    world = iota.World(iota.System(), title="grasp: two grippers hand over a bar of 20 cm", dt=1 / 240, ground=0.0)
    world.stage("room")
    world.camera = iota.Camera(position=(0.24, 0.84, 1.8), target=(0, 0.43, 0))
    return world


class Gripper:
    """A palm with two fingers on an arm that slides along x and up, and turns about x. side: -1: it reaches to the right."""

    def __init__(self, world: iota.World, side: int) -> None:
        system, self.side = world.system, side
        height = HEIGHT + BAR[1] / 2
        x = side * (APART + BAR[0] / 2 + AWAY)  # of the tips
        middle = x + side * (FINGER[0] + PALM[0] / 2)
        self.cart = self._box(world, (0.05, 0.5, 0.04), (middle + side * 0.05, POST, -BEHIND), 1.0, "steel")
        arm = (0.05, 0.04, BEHIND - 0.02)
        self.slider = self._box(world, arm, (middle + side * 0.05, height, (0.02 - BEHIND) / 2), 0.5, "brass")
        self.palm = self._box(world, PALM, (middle, height, 0), 0.6, "paint", "#3d5a80")
        self.along = system.prismatic(self.cart, at=self.cart.position, axis=(-side, 0, 0)).slide
        self.up = system.prismatic(self.slider, self.cart, at=self.slider.position, axis=(0, 1, 0)).slide
        self.wrist = system.revolute(self.palm, self.slider, at=self.palm.position, axis=(1, 0, 0)).angle
        self.pads: list[iota.Body] = []
        self.fingers = []
        for hand in (-1, 1):
            away = hand * (BAR[2] / 2 + OPEN + FINGER[2] / 2)
            place = (x + side * FINGER[0] / 2, height, away)
            finger = self._box(world, FINGER, place, 0.08, "rubber", "#2b2b2b")
            finger.material = FRICTION
            self.pads.append(finger)
            self.fingers.append(system.prismatic(finger, self.palm, at=place, axis=(0, 0, -hand)).slide)
        system.couple([(self.fingers[0], 1), (self.fingers[1], -1)])  # they close alike
        self.go(0, 0, 0)
        self.close(False)

    @staticmethod
    def _box(
        world: iota.World,
        sides: tuple[float, float, float],
        place: tuple[float, float, float],
        mass: float,
        look: str,
        color: str | None = None,
    ) -> iota.Body:
        body = world.system.body(shape=iota.Box(sides), mass=mass, position=place)
        body.name = "gripper"
        world.draw(body, looks.solid(look, color) if color else looks.solid(look))
        return body

    def go(self, along: float, up: float, turn: float) -> None:
        """From where it was made: towards the other one and up, m; rad."""
        self.along.servo = (along, *ARM)
        self.up.servo = (up, *ARM)
        self.wrist.servo = (turn, *WRIST)

    def close(self, closed: bool) -> None:
        """Closed fingers press as hard as their motors can."""
        for finger in self.fingers:
            finger.servo = (OPEN + BAR[2] / 2 if closed else 0.0, *SQUEEZE)


class Grasp:
    """Two tables, a bar on one of them, a gripper on each side."""

    def __init__(self, world: iota.World) -> None:
        self.world = world
        for side in (-1, 1):
            table = world.add_static(looks.box(TABLE, "wood"), (side * APART, HEIGHT - TABLE[1] / 2, 0))
            table.material = FRICTION
            world.add_static(
                looks.box((0.06, HEIGHT - TABLE[1], 0.06), "wood"), (side * APART, (HEIGHT - TABLE[1]) / 2, 0)
            )
        rail, back = POST + 0.2, -BEHIND - 0.045
        world.add_static(looks.box((2.3, 0.06, 0.04), "steel", color="#8a8f96"), (0, rail, back))
        for side in (-1, 1):
            world.add_static(looks.box((0.06, rail, 0.06), "wood"), (side * 1.12, rail / 2, back - 0.055))
        self.bar = world.system.body(
            shape=iota.Box(BAR), density=DENSITY, position=(-APART, HEIGHT + BAR[1] / 2, 0), material=FRICTION
        )
        self.bar.name = "bar"
        world.draw(self.bar, looks.solid("wood", "#c9803a"))
        self.left, self.right = Gripper(world, -1), Gripper(world, 1)
        self.at_left = True  # where the bar lies
        self.story = Story(world, wait=4.0, first=0.5, on_stop=self.rest)
        reach, meet = AWAY + REACH, AWAY + APART + REACH - 0.005

        def first() -> Gripper:
            return self.left if self.at_left else self.right

        def second() -> Gripper:
            return self.right if self.at_left else self.left

        moves: list[Callable[[], None]] = [
            self._reach,
            lambda: first().close(True),
            lambda: first().go(reach, UP, 0),
            lambda: first().go(meet, UP, math.pi / 2),
            lambda: second().go(meet, UP, 0),
            lambda: second().close(True),
            lambda: first().close(False),
            lambda: first().go(0, UP, math.pi / 2),
            lambda: second().go(reach, UP, 0),
            lambda: second().go(reach, 0.001, 0),
            lambda: second().close(False),
            self.rest,
            lambda: None,
        ]
        for time, move in zip(STEPS, moves, strict=True):
            self.story.at(time)(move)
        world.action("hand over", key="k", help="the grippers hand the bar over", on="world")(self.story.begin)
        world.action("begin anew", key="c", help="the bar lies as at the start", on="world")(world.reset)

    def _reach(self) -> None:
        """The gripper on whose side the bar lies begins."""
        self.at_left = self.bar.position.x < 0
        (self.left if self.at_left else self.right).go(AWAY + REACH, 0, 0)

    def rest(self) -> None:
        """Both let go, and draw back."""
        for gripper in (self.left, self.right):
            gripper.close(False)
            gripper.go(0, 0, 0)


if __name__ == "__main__":
    build().run()
