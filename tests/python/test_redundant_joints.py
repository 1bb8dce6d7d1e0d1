# SPDX-License-Identifier: Apache-2.0
"""Joints that hold the same share it as statics does, at any rate, size and place."""

from __future__ import annotations

from math import cos, inf, pi, sin
from typing import Literal

import numpy as np
import pytest

import iota

Mode = Literal["robust", "energy_keeping", "accurate"]
MODES: tuple[Mode, ...] = ("robust", "energy_keeping", "accurate")
WEIGHT = 20 * 9.81
# Steps a second, size in m, place in m.
SCALES = [(60, 1, 0), (120, 1, 0), (1000, 1, 0), (120, 30, 0), (120, 0.1, 0), (120, 1, 100), (120, 1, 9000)]


def force_on_hinges(mode: Mode, rate: int, size: float, place: float, break_force: float = inf) -> float:
    """The largest in 30 steps of a door of 20 kg that hangs at rest on two hinges, N."""
    system = iota.System(mode=mode)
    door = system.body(
        shape=iota.Box((0.9 * size, 2 * size, 0.04 * size)),
        mass=20,
        position=(place + 0.45 * size, size, place / 3),
    )
    hinges = [
        system.revolute(door, at=(place, height * size, place / 3), axis=(0, 1, 0), break_force=break_force)
        for height in (0.2, 1.8)
    ]
    largest = 0.0
    for _ in range(30):
        system.step(1 / rate)
        assert not system.broken
        largest = max(largest, *(abs(hinge.force) for hinge in hinges))
    return largest


@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize(("rate", "size", "place"), SCALES)
def test_two_hinges_of_a_door_carry_half_its_weight_each(mode: Mode, rate: int, size: float, place: float) -> None:
    """And 0.07 of it across. They told up to 659 weights, as round-off pressed them against each other."""
    assert force_on_hinges(mode, rate, size, place) / WEIGHT == pytest.approx(0.505, abs=0.015)


@pytest.mark.parametrize("mode", MODES)
def test_hinges_that_hold_twice_their_share_do_not_break_far_away(mode: Mode) -> None:
    force_on_hinges(mode, 240, 1, 100, break_force=WEIGHT)


@pytest.mark.parametrize("kind", ["weld", "ball"])
@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize(("rate", "size"), [(120, 1), (1000, 1), (120, 100)])
def test_four_joints_at_the_corners_of_a_plate_carry_a_quarter_each(
    kind: str, mode: Mode, rate: int, size: float
) -> None:
    system = iota.System(mode=mode)
    plate = system.body(shape=iota.Box((size, 0.1 * size, size)), mass=10)
    corners = [(-0.5, -0.5), (-0.5, 0.5), (0.5, -0.5), (0.5, 0.5)]
    joints = [getattr(system, kind)(plate, at=(x * size, 0.05 * size, z * size)) for x, z in corners]
    for _ in range(30):
        system.step(1 / rate)
    for joint in joints:
        assert joint.force[1] / (10 * 9.81) == pytest.approx(0.25, abs=2e-3)


@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize(("rate", "place"), [(60, 0), (120, 0), (1000, 0), (120, 10)])
def test_a_lift_between_two_guides_with_friction_falls_freely(mode: Mode, rate: int, place: float) -> None:
    """Nothing presses on the guides. Down a slope both carry it, with friction by that load."""
    for slope in (pi / 2, pi / 4):
        system = iota.System(mode=mode)
        along = (cos(slope), -sin(slope), 0)
        lift = system.body(shape=iota.Box((1, 0.5, 1)), mass=100, position=(place, 0, place / 3))
        for z in (-0.5, 0.5):
            system.prismatic(lift, at=(place, 0, place / 3 + z), axis=along, friction_coefficient=0.2)
        for _ in range(rate // 2):
            system.step(1 / rate)
        way = (np.array(lift.position) - (place, 0, place / 3)) @ along
        ahead = 2 / rate if mode == "robust" else 0  # of backward Euler, as a part
        wanted = 0.125 * 9.81 * (sin(slope) - 0.2 * cos(slope))
        assert way == pytest.approx((1 + ahead) * wanted, rel=2e-3)
