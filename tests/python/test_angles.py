# SPDX-License-Identifier: Apache-2.0
"""Turns are those of the bodies, and rows at their bounds do the work that they should: judged from places and velocities."""

from __future__ import annotations

import math
import random
from typing import Any

import numpy as np
import pytest
from amount import sampled

import iota

ACROSS = (0, math.sqrt(0.5), 0, math.sqrt(0.5))  # a cylinder's axis is x
every_mode = pytest.mark.parametrize("mode", ["plausible", "robust", "energy_keeping", "accurate"])
exact_modes = pytest.mark.parametrize("mode", ["energy_keeping", "accurate"])


def wheel(system: iota.System, x: float, speed: float, **motion: object) -> iota.Constraint:
    """The joint of a wheel about z, or of a screw."""
    lead = motion.pop("lead", 0.0)
    disc = system.body(shape=iota.Cylinder(0.2, 0.1), mass=1, position=(x, 0, 0), orientation=ACROSS)
    joint = (
        system.screw(disc, at=(x, 0, 0), axis=(0, 0, 1), lead=lead)
        if lead
        else system.revolute(disc, at=(x, 0, 0), axis=(0, 0, 1))
    )
    disc.angular_velocity = (0, 0, speed)
    disc.velocity = (0, 0, lead * speed / (2 * math.pi))
    return joint


@exact_modes
@pytest.mark.parametrize("speed", [150.0, 300.0, -1000.0])
def test_gears_and_screws_count_more_than_half_a_turn_in_a_step(mode: str, speed: float) -> None:
    system = iota.System(mode=mode, gravity=(0, 0, 0))
    a, b, screw = wheel(system, 0, speed), wheel(system, 1, -0.5 * speed), wheel(system, 2, speed, lead=0.01)
    system.gear(a, b, -0.5)
    system.step(1 / 60)
    edits, kinetic = system.energy.edits, system.energy.kinetic
    for _ in range(59):
        system.step(1 / 60)
    close = 1e-4 if mode == "accurate" else 0.1  # the mid-point rule turns by 2 atan(w h / 2)
    assert a.angle.value == pytest.approx(speed, rel=close) and b.angle.value == pytest.approx(-0.5 * speed, rel=close)
    assert a.a.angular_velocity.z == pytest.approx(speed, rel=close)
    assert screw.a.position.z == pytest.approx(0.01 * speed / (2 * math.pi), rel=close)
    assert system.energy.edits == pytest.approx(edits, abs=1e-6 * kinetic)
    assert system.energy.kinetic == pytest.approx(kinetic, rel=1e-6)


@pytest.mark.parametrize("mode", ["plausible", "robust"])
@pytest.mark.parametrize("speed", [10.0, 100.0, 300.0])
def test_a_wheel_and_a_free_disk_turn_as_they_say(mode: str, speed: float) -> None:
    system = iota.System(mode=mode, gravity=(0, 0, 0))
    axle = wheel(system, 0, speed)
    free = system.body(shape=iota.Cylinder(0.2, 0.1), mass=1, position=(2, 0, 0), orientation=ACROSS)
    mark = free.particle((2.2, 0, 0), mass=0)
    free.angular_velocity = (0, 0, speed)
    says_axle = says_free = missing = 0.0
    before = math.atan2(mark.position.y, mark.position.x - 2)
    for _ in range(60):
        system.step(1 / 60)
        says_axle += axle.a.angular_velocity.z / 60
        now = math.atan2(mark.position.y, mark.position.x - 2)
        missing = max(missing, abs(math.remainder(now - before - free.angular_velocity.z / 60, 2 * math.pi)))
        says_free += free.angular_velocity.z / 60
        before = now
    assert axle.angle.value == pytest.approx(says_axle, rel=5e-3)
    assert missing < 0.02 * abs(says_free) / 60 + 1e-3


def crank(system: iota.System) -> iota.Constraint:
    """The motor of a slider-crank, 2 N m at any speed."""
    shaft = system.body(shape=iota.Box((0.2, 0.05, 0.05)), mass=1, position=(0.1, 0, 0))
    rod = system.body(shape=iota.Box((0.6, 0.05, 0.05)), mass=1, position=(0.5, 0, 0))
    slider = system.body(shape=iota.Box((0.1, 0.1, 0.1)), mass=1, position=(0.8, 0, 0))
    motor = system.revolute(shaft, at=(0, 0, 0), axis=(0, 0, 1))
    system.revolute(rod, shaft, at=(0.2, 0, 0), axis=(0, 0, 1))
    system.revolute(slider, rod, at=(0.8, 0, 0), axis=(0, 0, 1))
    system.prismatic(slider, at=(0.8, 0, 0), axis=(1, 0, 0))
    motor.angle.value = 0.5
    motor.angle.motor = (1e6, 2)
    return motor


@exact_modes
@pytest.mark.parametrize("rate", [60, 240])
def test_a_motor_at_its_largest_torque_does_the_work_torque_times_angle(mode: str, rate: int) -> None:
    system = iota.System(mode=mode, gravity=(0, 0, 0))
    motor = crank(system)
    for _ in range(3 * rate):
        system.step(1 / rate)
    assert motor.angle.value > 100
    assert system.energy.kinetic == pytest.approx(2 * (motor.angle.value - 0.5), rel=1e-6)


def hinged(system: iota.System, count: int, length: float, **options: object) -> list[iota.Constraint]:
    joints, before = [], None
    for i in range(count):
        box = system.body(
            shape=iota.Box((length, length / 5, length / 5)), mass=length, position=((i + 0.5) * length, 0, 0)
        )
        joints.append(system.revolute(box, before, at=(i * length, 0, 0), axis=(0, 0, 1), **options))
        before = box
    return joints


@every_mode
@pytest.mark.parametrize("links", [40, 60])
def test_a_chain_whose_hinges_rub_starts_to_fall_in_few_iterations(mode: str, links: int) -> None:
    system = iota.System(mode=mode)
    hinged(system, links, 0.1, friction=0.02)
    for _ in range(3 if mode == "accurate" else 10):
        report = system.step(1 / 60)
        assert report.unconverged == 0 and report.iterations_max < 100


@pytest.mark.parametrize(
    "options",
    [
        {"spring": (5, 0.1, 0)},
        {"friction": 0.2},
        {"motor": (1, 100)},
        {"motor": (1000, 1)},
        {"servo": (0.5, 2, 3)},
        {"limits": (-1, 1)},
    ],
)
def test_the_accurate_mode_follows_rows_with_bounds_by_few_iterations(options: dict[str, object]) -> None:
    def steps(**options: object) -> int:
        system = iota.System(mode="accurate")
        joint = hinged(system, 4, 0.5)[1]
        for name, value in options.items():
            setattr(joint.angle, name, value)
        iterations = []
        for _ in range(60):
            system.step(1 / 60)
            iterations.append(sum(island.iterations for island in system.islands()))
        return sorted(iterations)[30]

    assert steps(**options) <= 4 * steps()


def test_friction_stops_a_wheel_where_it_must_in_the_accurate_mode() -> None:
    system = iota.System(mode="accurate", gravity=(0, 0, 0))
    joint = wheel(system, 0, 3)
    joint.angle.friction = 0.05
    for _ in range(120):
        system.step(1 / 60)
    inertia = 0.5 * 0.2**2
    assert joint.angle.value == pytest.approx(0.5 * inertia * 9 / 0.05, rel=1e-8)
    assert abs(joint.angle.speed) < 1e-9
    assert system.energy.dissipated == pytest.approx(0.5 * inertia * 9, rel=1e-8)


def joined(system: iota.System, kind: str, dice: random.Random) -> list[iota.Body]:
    """Two boxes that a joint or a coupling joins, one of them turned at random."""
    a, b = (system.body(shape=iota.Box((0.3, 0.2, 0.1)), mass=1, position=(x, 0, 0)) for x in (0, 0.5))
    speed = dice.uniform(-60, 60)
    if kind in ("gear", "rack"):
        wheel = system.revolute(a, at=(0, 0, 0), axis=(0, 0, 1))
        if kind == "gear":
            other = system.revolute(b, at=(0.5, 0, 0), axis=(0, 0, 1)).angle
            system.couple([(wheel.angle, dice.choice((0.5, -2, 1.3))), (other, -1)])
        else:
            other = system.prismatic(b, at=(0.5, 0, 0), axis=(1, 0, 0)).slide
            system.couple([(wheel.angle, 0.05), (other, -1)])
        a.angular_velocity = (0, 0, speed)
        return [a, b]
    at: dict[str, Any] = {"at": (0.25, 0, 0), "axis": (0, 1, 0)}
    a.angular_velocity = (0, speed, 0)
    if kind == "prismatic":
        a.velocity = (0, speed / 30, 0)
        system.prismatic(a, b, **at)
    if kind == "screw":
        system.screw(a, b, lead=0.1, **at)
    if kind == "cylindrical":
        a.velocity = (0, speed / 30, 0)
        system.cylindrical(a, b, **at)
    if kind == "path":
        ring = [(0.2 * math.cos(k), 0, 0.2 * math.sin(k)) for k in np.linspace(0, 2 * math.pi, 17)]
        system.on_path(a.attachment((0.15, 0, 0)), ring, b)
    if kind == "hinge":
        system.revolute(a, b, **at)
    return [a, b]


@pytest.mark.parametrize("kind", ["hinge", "prismatic", "cylindrical", "screw", "path", "gear", "rack"])
def test_what_is_set_back_in_one_edit_stays_where_it_was_put(kind: str) -> None:
    for seed in range(sampled(200)):
        dice = random.Random(seed)
        system = iota.System(gravity=(0, 0, 0))
        bodies = joined(system, kind, dice)
        system.step(1 / 60, dice.randint(1, 30))
        poses = [(body.position, body.orientation) for body in bodies]
        system.step(1 / 60, dice.randint(1, 60))
        with system.edit():
            for k in dice.sample(range(2), 2):
                bodies[k].set_pose(*poses[k])
        for body in bodies:
            body.velocity = body.angular_velocity = (0, 0, 0)
        system.step(1 / 60)
        for body, (position, orientation) in zip(bodies, poses, strict=True):
            assert body.position == pytest.approx(position, abs=1e-6), f"seed {seed}"
            turned = abs(np.dot(body.orientation, orientation))
            assert turned == pytest.approx(1, abs=1e-9), f"seed {seed}: a coupling turned it"
