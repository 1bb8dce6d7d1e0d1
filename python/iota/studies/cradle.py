# SPDX-License-Identifier: Apache-2.0
"""Newton's cradle: as many balls leave as arrive. Drag any of them; l lifts one more on the left, k on the right."""

from __future__ import annotations

import math
from collections.abc import Sequence

import iota
from iota import looks
from iota.world.frames import turn_from_x

BALLS = 5
RADIUS, STRING, SPREAD = 0.06, 0.7, 0.22  # of a ball; height and half the width of its two strings, m
HEIGHT = 1.5  # of the bars, m
LIFT = 0.7  # rad
STEEL = 7800.0  # kg/m^3


def build(left: int = 1, right: int = 0) -> iota.World:
    """The world of the study. left, right: how many balls are lifted at first."""
    system = iota.System()
    world = iota.World(system, title="cradle")
    balls = [hang(system, place(number)) for number in range(BALLS)]
    present(world, balls)
    world.on_step(lambda: collide(balls, [ball == world.held() for ball in balls]))
    counts = [left, right]

    def lift() -> None:
        for number, ball in enumerate(balls):
            outer = number < counts[0], BALLS - 1 - number < counts[1]
            turn(ball, LIFT * (outer[1] - outer[0]), 0.0)

    def lift_more(side: int) -> None:
        counts[side] = (counts[side] + 1) % BALLS
        counts[1 - side] = min(counts[1 - side], BALLS - counts[side])
        lift()

    @world.action("lift left", key="l", button="a", help="lifts one more ball on the left", on="world")
    def lift_left() -> None:
        lift_more(0)

    @world.action("lift right", key="k", button="b", help="lifts one more ball on the right", on="world")
    def lift_right() -> None:
        lift_more(1)

    lift()
    return world


def place(number: int) -> float:
    """Where a ball hangs at rest, m along x: they touch."""
    return 2 * RADIUS * (number - (BALLS - 1) / 2)


def hang(system: iota.System, x: float) -> iota.Body:
    """A ball on two strings, nailed to both bars: it can only swing along x."""
    ball = system.body(shape=iota.Sphere(RADIUS), density=STEEL, position=(x, HEIGHT - STRING, 0))
    for side in (-1, 1):
        ball.attachment((x, HEIGHT, side * SPREAD)).nail()
    return ball


def angle(ball: iota.Body, x: float) -> float:
    """From the plumb line, towards +x, rad."""
    at = ball.center_of_mass
    return math.atan2(at.x - x, HEIGHT - at.y)


def turn(ball: iota.Body, to: float, speed: float) -> None:
    """Puts a ball at an angle (rad), with a speed (rad/s)."""
    x = ball.attachments[0].position.x
    at = (x + STRING * math.sin(to), HEIGHT - STRING * math.cos(to), 0)
    ball.set_pose(at, (0, 0, math.sin(to / 2), math.cos(to / 2)))
    ball.velocity = (STRING * speed * math.cos(to), STRING * speed * math.sin(to), 0)
    ball.angular_velocity = (0, 0, speed)


def collide(balls: Sequence[iota.Body], held: Sequence[bool]) -> None:
    """Thesis 5.1.4: groups that meet swap. Equal pendulums that collide elastically exchange their motion, so that it is as if
    they had passed through each other: what has come out of order is sorted, all cascades at once. A ball in a hand gives way to
    none; it takes along what it meets."""
    now = [(angle(ball, ball.attachments[0].position.x), ball.angular_velocity.z) for ball in balls]
    after = list(now)
    firm = [number for number, is_held in enumerate(held) if is_held]
    for first, last in zip([-1, *firm], [*firm, len(balls)], strict=True):
        after[first + 1 : last] = sorted(after[first + 1 : last])
    for hand in firm:
        for number in range(hand + 1, len(balls)):
            after[number] = max(after[number], after[hand])
        for number in range(hand):
            after[number] = min(after[number], after[hand])
    for ball, before, motion in zip(balls, now, after, strict=True):
        if motion != before:
            turn(ball, *motion)


def present(world: iota.World, balls: Sequence[iota.Body]) -> None:
    """Balls with their strings, two bars, four posts."""
    length = math.hypot(STRING, SPREAD)
    strings = [
        looks.cylinder(
            0.003, "rope", length, offset=(0, STRING / 2, side * SPREAD / 2),
            rotation=turn_from_x(iota.Vec3(0, STRING, side * SPREAD).unit()),
        )
        for side in (-1, 1)
    ]  # fmt: skip
    world.draw(list(balls), [looks.sphere(RADIUS, "steel"), *strings])
    reach = BALLS * RADIUS + 0.45
    for side in (-SPREAD, SPREAD):
        world.add_strut((-reach, HEIGHT, side), (reach, HEIGHT, side), looks.cylinder(0.016, "wood"))
        for x in (-reach, reach):
            world.add_strut((x, 0.05, side), (x, HEIGHT, side), looks.cylinder(0.016, "wood"))
    world.add_static(looks.box((2 * reach + 0.15, 0.05, 2 * SPREAD + 0.15), "wood"), (0, 0.025, 0))
    world.camera = iota.Camera(position=(0.7, 1.4, 2.3), target=(0, 0.85, 0))
