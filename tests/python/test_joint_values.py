# SPDX-License-Identifier: Apache-2.0
"""Joints are set, aimed and read in parts; what meets and parts is told."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest

import iota


def arm(system: iota.System, links: int = 3, held: bool = True) -> list[iota.Constraint]:
    """Boxes of 1 m along x, the first on an axis of the world."""
    boxes = [system.body(shape=iota.Box((1, 0.1, 0.2)), mass=1, position=(i + 0.5, 0, 0)) for i in range(links)]
    joints = [system.revolute(boxes[0], None, at=(0, 0, 0), axis=(0, 0, 1))] if held else []
    return joints + [
        system.revolute(b, a, at=(i + 1, 0, 0), axis=(0, 0, 1)) for i, (a, b) in enumerate(pairwise(boxes))
    ]


def test_a_joint_that_is_set_turns_the_bodies_behind_it() -> None:
    system = iota.System(gravity=(0, 0, 0))
    shoulder, elbow, wrist = arm(system)
    elbow.angle.value = math.pi / 2
    assert elbow.angle.value == pytest.approx(math.pi / 2) and shoulder.angle.value == pytest.approx(0, abs=1e-12)
    assert wrist.angle.value == pytest.approx(0, abs=1e-12)
    np.testing.assert_allclose([b.position for b in system.bodies], [(0.5, 0, 0), (1, 0.5, 0), (1, 1.5, 0)], atol=1e-12)
    shoulder.angle.value = -math.pi / 2
    np.testing.assert_allclose(
        [b.position for b in system.bodies], [(0, -0.5, 0), (0.5, -1, 0), (1.5, -1, 0)], atol=1e-12
    )
    assert system.step(1 / 60).worst_gap < 1e-9 and system.validate() == []


@pytest.mark.parametrize("aim", [7.0, -11.0, 1e-6])
def test_an_angle_is_counted_on_through_full_turns(aim: float) -> None:
    system = iota.System(gravity=(0, 0, 0))
    shoulder, *_ = arm(system)
    shoulder.angle.value = aim
    assert shoulder.angle.value == pytest.approx(aim)
    np.testing.assert_allclose(system.bodies[0].position, (0.5 * math.cos(aim), 0.5 * math.sin(aim), 0), atol=1e-12)
    system.step(1 / 60)
    assert shoulder.angle.value == pytest.approx(aim)


def test_the_held_side_stays_and_the_other_side_moves() -> None:
    system = iota.System(gravity=(0, 0, 0))
    wall = system.body("static", shape=iota.Box((1, 1, 1)))
    door = system.body(shape=iota.Box((1, 1, 0.1)), mass=1, position=(1.5, 0, 0))
    hinge = system.revolute(wall, door, at=(1, 0, 0), axis=(0, 1, 0))
    hinge.angle.value = 0.5
    assert hinge.angle.value == pytest.approx(0.5) and wall.position == (0, 0, 0)
    np.testing.assert_allclose(door.position, (1 + 0.5 * math.cos(-0.5), 0, -0.5 * math.sin(-0.5)), atol=1e-12)
    slider = system.prismatic(
        system.body(shape=iota.Sphere(0.1), position=(0, 3, 0)), wall, at=(0, 3, 0), axis=(0, 1, 0)
    )
    slider.slide.value = -1.5
    np.testing.assert_allclose(slider.a.position, (0, 1.5, 0), atol=1e-12)


def four_bar(system: iota.System) -> list[iota.Constraint]:
    """A crank of 1 m, a coupler and a rocker of 2 m, 2.5 m apart."""

    def bar(p: np.ndarray, q: np.ndarray) -> iota.Body:
        turn = math.atan2(q[1] - p[1], q[0] - p[0])
        shape = iota.Box((float(np.hypot(*(q - p))), 0.05, 0.05))
        return system.body(
            shape=shape, position=(p + q) / 2, orientation=(0, 0, math.sin(turn / 2), math.cos(turn / 2))
        )

    ground, far, pin = np.array((0.0, 0.0)), np.array((2.5, 0.0)), np.array((0.0, 1.0))
    # The rocker's end: 2 m from both the pin and the far pivot.
    middle, apart = (pin + far) / 2, far - pin
    top = middle + np.array((-apart[1], apart[0])) / np.hypot(*apart) * math.sqrt(4 - apart @ apart / 4)
    crank, coupler, rocker = bar(ground, pin), bar(pin, top), bar(top, far)
    return [
        system.revolute(a, b, at=at, axis=(0, 0, 1))
        for a, b, at in ((crank, None, ground), (coupler, crank, pin), (rocker, coupler, top), (rocker, None, far))
    ]


def test_in_a_loop_the_rest_of_the_mechanism_follows() -> None:
    system = iota.System(gravity=(0, 0, 0))
    crank, _, _, rocker = four_bar(system)
    for aim in (0.3, -0.9, 1.4, 0.0):
        crank.angle.value = aim
        assert crank.angle.value == pytest.approx(aim, abs=1e-9)
        assert system.worst_gap < 1e-9
        # Against the geometry: the rocker's end is 2 m from the crank's pin.
        pin = np.array((math.cos(math.pi / 2 + aim), math.sin(math.pi / 2 + aim)))
        bar = rocker.a
        end = np.array(bar.position)[:2] * 2 - np.array((2.5, 0))
        assert np.hypot(*(end - pin)) == pytest.approx(2, abs=1e-8)
    assert rocker.angle.value == pytest.approx(0, abs=1e-6)
    assert system.step(1 / 60).worst_gap < 1e-8


def test_a_value_that_cannot_be_is_refused_and_nothing_moves() -> None:
    system = iota.System(gravity=(0, 0, 0))
    crank, _, _, rocker = four_bar(system)
    crank.angle.limits = (-1, 1)
    before = system.positions
    with pytest.raises(ValueError, match=r"angle must be within its limits, -1 and 1, got 2"):
        crank.angle.value = 2
    with pytest.raises(ValueError, match=r"angle cannot be 3: what hangs on joint \d+ follows no further than about"):
        rocker.angle.value = 3
    np.testing.assert_allclose(system.positions, before, atol=1e-12)
    with pytest.raises(ValueError, match="value must be finite"):
        crank.angle.value = math.nan
    assert crank.angle.limits == (-1, 1) and system.validate() == []
    crank.active = False
    with pytest.raises(ValueError, match="is switched off"):
        crank.angle.value = 0.5


@pytest.mark.parametrize("mode", ["robust", "energy_keeping"])
def test_a_servo_goes_to_its_aim_and_holds_against_weight(mode: str) -> None:
    system = iota.System(mode=mode)
    (shoulder,) = arm(system, links=1)
    shoulder.angle.servo = (0.8, 100.0)
    assert shoulder.angle.servo == (0.8, 100.0, math.inf) and shoulder.angle.motor is None
    system.step(1 / 120, count=120)
    assert shoulder.angle.value == pytest.approx(0.8, abs=1e-6)
    weight = 9.81 * 0.5 * math.cos(0.8)  # N m about the axis
    assert shoulder.angle.efforts["motor"] == pytest.approx(weight, rel=1e-4)
    shoulder.angle.servo = None
    assert shoulder.angle.servo is None and shoulder.angle.motor is None


def test_a_servo_keeps_to_its_speed_and_torque() -> None:
    system = iota.System(gravity=(0, 0, 0))
    (shoulder,) = arm(system, links=1)
    shoulder.angle.servo = (3.0, 100.0, 0.5)
    system.step(1 / 120, count=60)
    assert shoulder.angle.speed == pytest.approx(0.5, rel=1e-4) and shoulder.angle.value == pytest.approx(
        0.25, rel=0.02
    )
    weak = iota.System()
    (joint,) = arm(weak, links=1)
    joint.angle.servo = (0.0, 1.0)  # the weight is 4.9 N m
    weak.step(1 / 120, count=30)
    assert joint.angle.value < -0.1 and joint.angle.efforts["motor"] == pytest.approx(1.0, rel=1e-6)


def test_efforts_of_motor_stop_friction_and_spring_are_told_apart() -> None:
    system = iota.System(gravity=(0, 0, 0))
    (shoulder,) = arm(system, links=1)
    shoulder.angle.limits, shoulder.angle.motor = (-1, 0.1), (1.0, 10.0)
    shoulder.angle.friction, shoulder.angle.spring = 2.0, (3.0, 0.0, 0.0)
    system.step(1 / 120, count=120)
    efforts = shoulder.angle.efforts
    assert shoulder.angle.value == pytest.approx(0.1, abs=1e-6)
    assert efforts["motor"] == pytest.approx(10, rel=1e-3) and efforts["spring"] == pytest.approx(-0.3, rel=1e-3)
    assert sum(efforts.values()) == pytest.approx(shoulder.angle.effort, abs=1e-12) == pytest.approx(0, abs=1e-3)
    assert efforts["stop"] < -7


def test_reaching_and_leaving_a_stop_is_reported_once() -> None:
    system = iota.System(gravity=(0, 0, 0))
    (shoulder,) = arm(system, links=1)
    shoulder.angle.limits, shoulder.angle.motor = (-0.5, 0.2), (1.0, 10.0)
    told = []
    for i in range(240):
        if i == 120:
            shoulder.angle.motor = (-1.0, 10.0)
        system.step(1 / 120)
        told += [(i, event) for event in system.stops]
    assert [(event.met, event.coordinate) for _, event in told] == [(True, "angle"), (False, "angle"), (True, "angle")]
    assert told[0][1].constraint == shoulder and 20 <= told[0][0] <= 30
    assert 120 <= told[1][0] <= 122 and 200 <= told[2][0] <= 210


def test_meeting_and_parting_of_a_rope_is_reported() -> None:
    system = iota.System()
    anchor, weight = system.body().particle((0, 2, 0)), system.body().particle((0, 1.5, 0))
    anchor.nail()
    rope = system.rope(anchor, weight, 1.0)
    events = []
    for _ in range(120):
        system.step(1 / 120)
        events += system.stops
    assert events and events[0].met and events[0].coordinate is None and events[0].constraint == rope
    assert "met" in repr(events[0])
    weight.velocity = (0, 3, 0)
    events = []
    for _ in range(10):
        system.step(1 / 120)
        events += system.stops
    assert [event.met for event in events] == [False]
