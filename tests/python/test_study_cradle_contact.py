# SPDX-License-Identifier: Apache-2.0
"""Two cradles by contact: as many balls leave as arrive, and lead moves as one."""

from __future__ import annotations

import math

import pytest
from solved_steps import run_solved

from iota.studies import cradle_contact
from iota.studies.cradle import LIFT, RADIUS, STRING

SWING = 2 * math.pi * math.sqrt(STRING / 9.81) * (1 + LIFT**2 / 16)  # s, there and back


def swung(metal: str, left: int, right: int, balls: int, seconds: float) -> list[float]:
    """Angles after a time, as parts of that to which the balls were lifted."""
    world = cradle_contact.make_world()
    row = cradle_contact.Row(world, metal, balls)
    row.lift(left, right)
    run_solved(world, seconds, gap=1e-5)
    nearest = min(abs(a.center_of_mass - b.center_of_mass) for a, b in zip(row.balls, row.balls[1:], strict=False))
    assert nearest > 2 * RADIUS - 1e-5
    return [angle / LIFT for angle in row.angles()]


@pytest.mark.parametrize(
    ("left", "right", "balls"), [(1, 0, 5), (2, 0, 5), (3, 0, 5), (4, 0, 5), (1, 1, 5), (2, 1, 5), (3, 1, 7)]
)
def test_as_many_balls_of_steel_leave_as_arrive(left: int, right: int, balls: int) -> None:
    angles = swung("steel", left, right, balls, SWING / 2)
    wanted = [-1.0] * right + [0.0] * (balls - left - right) + [1.0] * left
    assert angles == pytest.approx(wanted, abs=0.09)


def test_balls_of_lead_swing_as_one_with_the_momentum_of_those_that_arrive() -> None:
    angles = swung("lead", 2, 0, 5, SWING / 2)
    share = math.asin(2 / 5 * math.sin(LIFT / 2)) / (LIFT / 2)
    assert angles == pytest.approx([share] * 5, abs=0.06)


def test_the_cradle_of_steel_goes_on_for_a_while_and_loses_what_its_restitution_takes() -> None:
    world = cradle_contact.make_world()
    row = cradle_contact.Row(world, "steel")
    row.lift(1, 0)
    energy = world.system.energy.total
    highest = -1.0
    for _ in range(round(4.2 * SWING / world.dt)):
        world.step()
        assert world.system.energy.total <= energy + 1e-9
        energy = world.system.energy.total
        if world.system.time > 3.3 * SWING:
            highest = max(highest, row.angles()[-1])
    assert highest > 0.7 * LIFT
