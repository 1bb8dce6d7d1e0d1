# SPDX-License-Identifier: Apache-2.0
"""Forces that joints tell, and break by, where a motor or a servo changes its speed: judged from velocities."""

from __future__ import annotations

import math
from typing import Literal

import pytest

import iota

Mode = Literal["robust", "plausible", "energy_keeping", "accurate"]
Drive = Literal["motor", "servo", "brake"]
GRAVITY = 9.81
MODES: tuple[Mode, ...] = ("robust", "plausible", "energy_keeping", "accurate")


def drive_slide(system: iota.System, axis: tuple[float, float, float]) -> tuple[iota.Joint, iota.Body, iota.Joint]:
    """A block of 5 kg on a slide, and one of 1 kg that is welded to it."""
    carriage = system.body(shape=iota.Box((0.2, 0.2, 0.2)), mass=5, position=(0, 1, 0))
    load = system.body(shape=iota.Box((0.1, 0.1, 0.1)), mass=1, position=(0.15, 1, 0))
    return system.prismatic(carriage, at=(0, 1, 0), axis=axis), load, system.weld(load, carriage, at=(0.1, 1, 0))


@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("drive", ["motor", "servo", "brake"])
@pytest.mark.parametrize("rate", [60, 960])
def test_a_weld_and_a_drive_tell_what_the_acceleration_takes(mode: Mode, drive: Drive, rate: int) -> None:
    system = iota.System(mode=mode)
    joint, load, weld = drive_slide(system, (0, 1, 0))
    if drive == "servo":
        joint.slide.servo = (0.5, 1000, 1)
    for step in range(round(0.5 * rate)):
        if drive == "motor" or (drive == "brake" and step < 0.3 * rate):
            joint.slide.motor = (0.5 * math.sin(4 * (system.time + 1 / rate)), 1000)
        elif drive == "brake":
            joint.slide.motor = (0, 1000)
        before = load.velocity.y
        system.step(1 / rate)
        acceleration = (load.velocity.y - before) * rate
        if step * 10 < rate:  # a servo starts at once
            continue
        allowed = 2e-3 * (GRAVITY + abs(acceleration))  # a thousandth of the force of the drive stays out
        assert abs(weld.force.y - GRAVITY - acceleration) < allowed, step
        assert abs(load.net_force.y - acceleration) < allowed, step
        assert abs(joint.slide.effort - 6 * (acceleration + GRAVITY)) < 6 * allowed, step


@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("rate", [60, 960])
def test_a_weld_breaks_by_what_the_acceleration_of_a_motor_takes(mode: Mode, rate: int) -> None:
    """2 m/s^2 aside and the weight: 10.01 N."""
    for strength, holds in ((10.2, True), (9.9, False)):
        system = iota.System(mode=mode)
        joint, _, weld = drive_slide(system, (1, 0, 0))
        weld.break_force = strength
        for _ in range(rate // 2):
            joint.slide.motor = (2 * (system.time + 1 / rate), 1000)
            system.step(1 / rate)
        assert weld.broken != holds


@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("rate", [60, 240])
@pytest.mark.parametrize("stop", ["rope", "limit", "floor"])
def test_a_weld_and_a_rope_tell_what_a_blow_takes(mode: Mode, rate: int, stop: str) -> None:
    """Within the step that stops them. It was twice the mean in `energy_keeping`, and none of it in `accurate`."""
    system = iota.System(mode=mode)
    joint, load, weld = drive_slide(system, (0, 1, 0))
    rope = None
    if stop == "floor":
        system.usual_material = iota.Material(friction=0)
        system.obstacle(iota.HalfSpace((0, 1, 0)), position=(0, 0.717, 0))
    elif stop == "limit":
        joint.slide.limits = (-0.183, math.inf)
    else:
        top = system.body("static").particle((0, 2, 0))
        rope = system.rope(top, joint.a.attachment((0, 1.1, 0)))
        rope.length = 0.9 + 0.183
    hardest = 0.0
    for _ in range(rate):
        before = load.velocity.y
        system.step(1 / rate)
        needed = (load.velocity.y - before) * rate + GRAVITY
        hardest = max(hardest, needed)
        allowed = 1e-2 * abs(needed) + 0.02
        assert abs(weld.force.y - needed) < allowed
        assert abs(load.net_force.y + GRAVITY - needed) < allowed
        assert rope is None or abs(rope.force.length - 6 * needed) < 6 * allowed
    assert hardest > 5 * GRAVITY


@pytest.mark.parametrize("mode", ["robust", "energy_keeping", "accurate"])
@pytest.mark.parametrize("kind", ["ball", "revolute", "nail", "rod"])
def test_what_tips_over_is_held_by_the_force_of_its_motion_and_gains_no_energy(mode: Mode, kind: str) -> None:
    system, height, rate = iota.System(mode=mode), 1.2, 240
    if kind == "rod":
        body = system.body()
        top = body.particle((0, height, 0), mass=1, velocity=(-2 * height, 0, 0))
        rod = system.rod(top, system.body("static").particle((0, 0, 0)))
    else:
        body = system.body(
            shape=iota.Sphere(0.2), mass=1, position=(0, height, 0), velocity=(-2 * height, 0, 0), spin=(0, 0, 2)
        )
    if kind == "ball":
        rod = system.ball(body, at=(0, 0, 0))
    elif kind == "revolute":
        rod = system.revolute(body, at=(0, 0, 0), axis=(0, 0, 1))
    elif kind == "nail":
        foot = body.attachment((0, 0, 0))
        foot.nail()
    start = system.energy.kinetic + system.energy.potential
    places = [body.position]
    for step in range(rate // 6):
        system.step(1 / rate)
        places.append(body.position)
        if step == 0:
            continue
        along = places[-1] / abs(places[-1])
        acceleration = (places[-1] - 2 * places[-2] + places[-3]) * rate**2
        needed = acceleration.dot(along) + GRAVITY * along.y
        told = (foot.nail_force if kind == "nail" else rod.force).dot(along)
        assert told == pytest.approx(needed, abs=0.1), step
        assert system.energy.kinetic + system.energy.potential < start * (1 + 1e-12)
