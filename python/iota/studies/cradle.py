# SPDX-License-Identifier: Apache-2.0
"""Newton's cradle: as many balls leave as arrive. Drag a ball, turn the frame; l and k lift one more ball on the left, on the right."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise
from typing import Literal

import iota
from iota import looks
from iota.frames import turn_from_x

BALLS = 5
RADIUS, STRING, SPREAD = 0.012, 0.13, 0.045  # of a ball; height and half the width of its two strings, m
HEIGHT = 0.18  # of the bars above the table, m
LIFT = 0.7  # rad
STEEL = 7800.0  # kg/m^3
REACH = 0.002  # m: a hand that is nearer to its ball pushes to neither side
PLACE, UP = iota.Vec3(0, 0, 0), iota.Vec3(0, 1, 0)


def build(left: int = 1, right: int = 0, balls: int = BALLS) -> iota.World:
    """The world of the study. left, right: how many of the balls are lifted at first."""
    world = iota.World(iota.System(), title="cradle: of 24 mm balls as many leave as arrive", dt=1 / 240, ground=0.0)
    cradle = Cradle(world, balls=balls)
    add_actions(world, cradle, left, right)
    world.stage("room")
    world.camera = iota.Camera(position=(0.11, 0.2, 0.42), target=(0, 0.08, 0))
    return world


def add_actions(
    world: iota.World, cradle: Cradle, left: int = 1, right: int = 0, on_lift: Callable[[], None] = lambda: None
) -> None:
    """Lifts balls at first and at each reset, and by keys and buttons. on_lift: called before a user does."""
    counts = [left, right]

    def lift_more(side: int) -> None:
        on_lift()
        counts[side] = (counts[side] + 1) % len(cradle.balls)
        counts[1 - side] = min(counts[1 - side], len(cradle.balls) - counts[side])
        cradle.lift(*counts)

    @world.action("lift left", key="l", button="a", help="lifts one more ball on the left", on="world")
    def lift_left() -> None:
        lift_more(0)

    @world.action("lift right", key="k", button="b", help="lifts one more ball on the right", on="world")
    def lift_right() -> None:
        lift_more(1)

    @world.on_reset
    def begin_anew() -> None:
        counts[:] = left, right
        cradle.turn_to(0.0)
        cradle.lift(left, right)

    cradle.lift(left, right)


@dataclass
class Group:
    """Neighbors that swing as one pendulum. numbers: of its balls; leader: the one that is simulated, with the mass of all.
    angle: from the plumb line, rad; speed: rad/s."""

    numbers: range
    leader: int
    angle: float
    speed: float


class Cradle:
    """Thesis 5.1.4: the simulator swings one pendulum for each group; what happens between groups is known and done here."""

    def __init__(self, world: iota.World, at: iota.Vec3 = PLACE, balls: int = BALLS) -> None:
        self.at, self.turn, self.toward = at, 0.0, 0.0  # toward: where the hand on the frame is, rad
        self.hands: dict[int, tuple[int, iota.Vec3]] = {}  # what each holds, and where it is
        self.frame = world.system.body("static", shape=iota.Box((0.01, 0.01, 0.01)), position=at)
        self.frame.name = "frame"
        self.balls = [self._hang(world.system, number, balls) for number in range(balls)]
        self.mass = self.balls[0].mass
        self.groups = [Group(range(balls), 0, 0.0, 0.0)]
        present(world, self.balls, self.frame, looks.sphere(RADIUS, "steel"))
        self.put()
        world.on_step(self.step)
        world.on_frame(self.step)  # no picture shows balls that have met and not parted yet
        world.on_drag(self.balls)(self.drag)
        world.on_drag(self.frame, grab=False)(self.spin)

    # --- what users do --------------------------------------------------------------------------------------------

    def lift(self, left: int, right: int) -> None:
        """Balls on both sides are held up and let go."""
        bounds = [0, left, len(self.balls) - right, len(self.balls)]
        angles = (-LIFT, 0.0, LIFT)
        self.groups = [
            Group(range(p, q), p, angle, 0.0) for (p, q), angle in zip(pairwise(bounds), angles, strict=True) if q > p
        ]
        self.put()

    def turn_to(self, turn: float) -> None:
        """The whole cradle about the vertical, rad."""
        self.turn = turn
        self.frame.set_pose(self.at, (0, math.sin(turn / 2), 0, math.cos(turn / 2)))
        self.put(moved=True)

    def spin(self, event: iota.Event) -> None:
        """A hand on the frame turns it."""
        arm = event.point - self.at if event.point else iota.Vec3()
        toward = math.atan2(-arm.z, arm.x)
        if event.phase == "update":
            self.turn_to(self.turn + math.remainder(toward - self.toward, 2 * math.pi))
        self.toward = toward

    def drag(self, event: iota.Event) -> None:
        """A hand on a ball."""
        if event.phase == "end" or event.point is None:
            self.hands.pop(event.hold, None)
        else:
            self.hands[event.hold] = (self.balls.index(event.body), event.point)

    # --- a step ---------------------------------------------------------------------------------------------------

    def step(self) -> None:
        """Brings all balls up to where the simulated ones are."""
        for group in self.groups:
            group.angle, group.speed = self.motion(group.leader)
        for number, hand in self.hands.values():
            self.part(number, (hand - self.balls[number].center_of_mass).dot(self.along))
        held = {number for number, _ in self.hands.values()}
        while self.collide(held):
            pass  # a group may meet the next one at once
        self.put()

    def part(self, number: int, push: float) -> None:
        """Thesis 5.4.2: a ball that is pushed takes along what is before it, and leaves behind what is behind it. push: to which
        side, m."""
        index = next(i for i, group in enumerate(self.groups) if number in group.numbers)
        group = self.groups[index]
        cut = number + 1 if push < -REACH else number if push > REACH else group.numbers.start
        pieces = [range(group.numbers.start, cut), range(cut, group.numbers.stop)]
        self.groups[index : index + 1] = [
            Group(piece, number if number in piece else piece.start, group.angle, group.speed)
            for piece in pieces
            if piece
        ]
        for each in self.groups:
            if number in each.numbers:
                each.leader = number

    def collide(self, held: set[int]) -> bool:
        """The first two groups that have met swap (Eq. 5.1): what the left one did goes on as many balls farther right as the
        right one has, and the other way round. With a ball in a hand they become one group instead. False: none have met."""
        for index, (a, b) in enumerate(pairwise(self.groups)):
            if a.angle <= b.angle:
                continue
            p, q, middle = a.numbers.start, b.numbers.stop, a.numbers.start + len(b.numbers)
            firm = next((group for group in (a, b) if not held.isdisjoint(group.numbers)), None)
            if firm:
                speed = (len(a.numbers) * a.speed + len(b.numbers) * b.speed) / (q - p)
                self.groups[index : index + 2] = [Group(range(p, q), firm.leader, firm.angle, speed)]
            else:
                self.groups[index : index + 2] = [
                    Group(range(p, middle), p, b.angle, b.speed),
                    Group(range(middle, q), middle, a.angle, a.speed),
                ]
            return True
        return False

    def put(self, moved: bool = False) -> None:
        """Shows all balls where their groups are; what swings as it did is left alone unless the cradle was moved."""
        for group in self.groups:
            for number in group.numbers:
                ball, leads = self.balls[number], number == group.leader
                kind: Literal["dynamic", "static"] = "dynamic" if leads else "static"
                angle, speed = self.motion(number)
                is_there = abs(angle - group.angle) < 1e-12 and (not leads or speed == group.speed)
                if is_there and ball.kind == kind and not moved:
                    continue
                ball.kind = kind
                self._place(number, group.angle)
                if leads:
                    along = self.along * math.cos(group.angle) + UP * math.sin(group.angle)
                    ball.velocity, ball.angular_velocity = along * (STRING * group.speed), self.axis * group.speed
            self.balls[group.leader].mass = len(group.numbers) * self.mass

    # --- places ---------------------------------------------------------------------------------------------------

    @property
    def along(self) -> iota.Vec3:
        """From the left to the right ball."""
        return iota.Vec3(math.cos(self.turn), 0, -math.sin(self.turn))

    @property
    def axis(self) -> iota.Vec3:
        """The axis of a swing towards the right."""
        return self.along.cross(UP)

    def pivot(self, number: int) -> iota.Vec3:
        """Above a ball, between its strings' upper ends."""
        return self.at + UP * HEIGHT + self.along * (2 * RADIUS * (number - (len(self.balls) - 1) / 2))

    def motion(self, number: int) -> tuple[float, float]:
        """Angle and speed of a ball."""
        arm = self.balls[number].center_of_mass - self.pivot(number)
        return math.atan2(arm.dot(self.along), -arm.y), self.balls[number].angular_velocity.dot(self.axis)

    def _place(self, number: int, angle: float) -> None:
        arm = self.along * math.sin(angle) - UP * math.cos(angle)
        (sy, cy), (sz, cz) = ((math.sin(half), math.cos(half)) for half in (self.turn / 2, angle / 2))
        self.balls[number].set_pose(self.pivot(number) + arm * STRING, (sy * sz, sy * cz, cy * sz, cy * cz))

    def _hang(self, system: iota.System, number: int, balls: int) -> iota.Body:
        """A ball on two strings: it swings about the line between their upper ends."""
        top = self.at + UP * HEIGHT + (2 * RADIUS * (number - (balls - 1) / 2), 0, 0)
        ball = system.body(shape=iota.Sphere(RADIUS), density=STEEL, position=top - UP * STRING)
        ball.material = iota.Material(touches="nothing")  # they meet by `collide`
        system.revolute(ball, self.frame, at=top, axis=(0, 0, 1))
        return ball


def present(world: iota.World, balls: list[iota.Body], frame: iota.Body, look: looks.Look, size: float = 1.0) -> None:
    """Balls with their strings; two bars on posts on a plate. size: times the usual one."""
    world.draw(balls, strung(look, size))
    reach, bar, high, wide, low = (size * each for each in (len(balls) * RADIUS + 0.05, 0.003, HEIGHT, SPREAD, 0.008))
    upright = (0, 0, 0.5**0.5, 0.5**0.5)
    parts = [looks.box((2 * reach + 10 * bar, 2 * low, 2 * wide + 10 * bar), "wood", bar, offset=(0, low, 0))]
    for side in (-wide, wide):
        parts.append(looks.capsule(bar, "brass", 2 * reach, offset=(0, high, side)))
        for x in (-reach, reach):
            parts.append(looks.capsule(bar, "brass", high, offset=(x, high / 2, side), rotation=upright))
    world.draw(frame, parts)


def strung(look: looks.Look, size: float = 1.0) -> list[looks.Look]:
    """A ball with its two strings."""
    return [look, *(
        looks.cylinder(
            size * 0.0006, "rope", size * math.hypot(STRING, SPREAD), offset=(0, size * STRING / 2, size * side / 2),
            rotation=turn_from_x(iota.Vec3(0, STRING, side).unit()),
        )
        for side in (-SPREAD, SPREAD)
    )]  # fmt: skip
