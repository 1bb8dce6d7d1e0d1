# SPDX-License-Identifier: Apache-2.0
from __future__ import annotations

from itertools import pairwise

import pytest

from iota.studies import cradle

N = cradle.BALLS


@pytest.mark.parametrize(("left", "right"), [(1, 0), (0, 1), (2, 0), (3, 0), (4, 0), (1, 1), (1, 2), (2, 2), (0, 3)])
def test_as_many_balls_leave_as_arrive(left: int, right: int) -> None:
    world = cradle.build(left, right)
    system = world.system
    balls = system.bodies
    out_left = out_right = 0
    start = system.energy.kinetic + system.energy.potential
    swing = 0.3 * cradle.LIFT
    for _ in range(500):
        report = world.step()
        assert report is not None and report.unconverged == 0
        angles = [cradle.angle(ball, cradle.place(number)) for number, ball in enumerate(balls)]
        places = [ball.center_of_mass.x for ball in balls]
        assert all(q - p > 2 * cradle.RADIUS - 0.02 for p, q in pairwise(places))
        if system.time > 0.5:  # after the first collision
            out_left = max(out_left, sum(angle < -swing for angle in angles))
            out_right = max(out_right, sum(angle > swing for angle in angles))
    assert out_left == out_right == max(left, right)
    assert system.energy.kinetic + system.energy.potential == pytest.approx(start, rel=1e-3)


def test_groups_that_meet_swap() -> None:
    """One ball from the left and two from the right: two swing out on the left and one on the right, and so on."""
    world = cradle.build(1, 2)
    balls = world.system.bodies
    swing = 0.8 * cradle.LIFT
    seen = []
    for _ in range(480):
        world.step()
        angles = [cradle.angle(ball, cradle.place(number)) for number, ball in enumerate(balls)]
        out = (sum(angle < -swing for angle in angles), sum(angle > swing for angle in angles))
        if 0 not in out and (not seen or seen[-1] != out):
            seen.append(out)
    assert seen[:4] == [(1, 2), (2, 1), (1, 2), (2, 1)]


def test_momentum_and_energy_at_a_swap_are_kept_to_the_bit() -> None:
    world = cradle.build(2, 1)
    balls = world.system.bodies
    for _ in range(40):
        world.system.step(1 / 120)
    cradle.turn(balls[1], 0.02, 1.0)
    cradle.turn(balls[2], 0.0, -0.5)
    before = sorted(ball.angular_velocity.z for ball in balls)
    cradle.collide(balls, [False] * N)
    assert sorted(ball.angular_velocity.z for ball in balls) == pytest.approx(before, abs=1e-9)
    angles = [cradle.angle(ball, cradle.place(number)) for number, ball in enumerate(balls)]
    assert angles == sorted(angles)


def test_a_held_ball_takes_along_what_it_meets() -> None:
    world = cradle.build(0, 0)
    balls = world.system.bodies
    grip = world.system.grip(balls[0], target=balls[0].center_of_mass)
    for _ in range(120):
        grip.move(balls[0].center_of_mass + (0.02, 0.004, 0))
        world.system.step(1 / 120)
        cradle.collide(balls, [True, False, False, False, False])
    angles = [cradle.angle(ball, cradle.place(number)) for number, ball in enumerate(balls)]
    assert min(angles) > 0.05 and max(angles) - min(angles) < 0.3
