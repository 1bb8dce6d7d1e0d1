# SPDX-License-Identifier: Apache-2.0
"""With shorter steps a motion tends to its limit, by the order of the mode, under damping, hands and laws of the time."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import iota

SECONDS = 0.5
FINE = 3840  # steps a second in `accurate`: the limit


def muscle(system: iota.System, p: iota.Particle, q: iota.Particle) -> Any:
    return system.bond(p, q, "energy = 0.5*k*(r - r0*(1 + 0.3*sin(9*t)))^2", k=30, r0=0.9)


def push(system: iota.System, p: iota.Particle, q: iota.Particle) -> Any:
    return system.bond(p, q, "force = k*sin(9*t)", k=3)


def damper(system: iota.System, p: iota.Particle, q: iota.Particle) -> Any:
    return system.bond(p, q, "energy = 0.5*k*(r - r0)^2; force = -c*(1.1 + sin(9*t))*v", k=30, r0=0.9, c=1)


def drag(system: iota.System, p: iota.Particle, q: iota.Particle) -> Any:
    return system.bond(p, q, "drag = c*(1.1 + sin(9*t))", c=1)


def damper_of_the_distance(system: iota.System, p: iota.Particle, q: iota.Particle) -> Any:
    return system.bond(p, q, "energy = 0.5*k*(r - r0)^2; force = -c*r^2*v", k=30, r0=0.9, c=2)


def drag_of_the_distance(system: iota.System, p: iota.Particle, q: iota.Particle) -> Any:
    return system.bond(p, q, "drag = c*r^2", c=2)


def damped(system: iota.System, p: iota.Particle, q: iota.Particle) -> Any:
    system.damping = 2


def one_damped(system: iota.System, p: iota.Particle, q: iota.Particle) -> Any:
    p.body.damping = 3


def hand(system: iota.System, p: iota.Particle, q: iota.Particle) -> Any:
    """It pulls with its largest force at first."""
    return system.grip(p.body, target=(0.2, 0.2, 0), frequency=2, max_acceleration=20)


def function(system: iota.System, p: iota.Particle, q: iota.Particle) -> Any:
    return system.bond(p, q, lambda bond: 3 * math.sin(9 * bond.time) * bond.direction)


def functions(system: iota.System, p: iota.Particle, q: iota.Particle) -> Any:
    law = system.law(lambda bonds: 3 * np.sin(9 * bonds.time) * bonds.direction)
    return system.bond(p, q, law)


def field(system: iota.System, p: iota.Particle, q: iota.Particle) -> Any:
    return system.field(lambda particles: np.tile([0, 0, 0.5 * math.sin(9 * particles.time)], (len(particles), 1)))


def pairs(system: iota.System, p: iota.Particle, q: iota.Particle) -> Any:
    return system.pair_force("force = k*sin(9*t)", k=0.2, cutoff=5)


Act = Callable[[iota.System, iota.Particle, iota.Particle], Any]


def scene(mode: Any, act: Act, jointed: bool) -> iota.System:
    system = iota.System(mode=mode, gravity=(0, 0, 0), threads=1)
    first = system.body(shape=iota.Box((0.5, 0.2, 0.1)), mass=1)
    first.velocity, first.angular_velocity = (0.5, 0.3, -0.2), (1, 2, 3)
    second = system.body(shape=iota.Box((0.5, 0.2, 0.3)), mass=2, position=(1, 0, 0))
    second.angular_velocity = (1, -2, 1)
    if jointed:
        system.ball(first, second, at=(0.5, 0, 0))
    act(system, first.attachment((0.1, 0.05, 0)), second.attachment((1.1, 0, 0.05)))
    return system


def end(mode: Any, act: Act, jointed: bool, per_second: int) -> np.ndarray[Any, np.dtype[np.float64]]:
    """Places of points of both bodies, m; the book of energy is closed all the time."""
    system = scene(mode, act, jointed)
    system.step(1 / per_second)
    energy = system.energy
    balance = energy.balance
    for _ in range(round(SECONDS * per_second) - 1):
        assert system.step(1 / per_second).energy.balance == pytest.approx(balance, abs=1e-10)
    return np.array([tuple(particle.position) for body in system.bodies for particle in body.particles])


@pytest.mark.parametrize("jointed", [False, True])
@pytest.mark.parametrize(
    "act", [muscle, push, damper, drag, damper_of_the_distance, drag_of_the_distance, damped, one_damped, hand]
)
def test_motions_tend_to_one_limit_by_the_order_of_the_mode(act: Act, jointed: bool) -> None:
    limit = end("accurate", act, jointed, FINE)

    def error(mode: str, per_second: int) -> float:
        return float(np.abs(end(mode, act, jointed, per_second) - limit).max())

    assert error("accurate", 60) < (1e-4 if act is hand else 1e-6)  # steps with a hand are implicit
    # Bodies of different damping on a joint are of first order: damping and reaction take turns in a step.
    order = 1 if act is one_damped and jointed else 2
    coarse, fine = error("energy_keeping", 120), error("energy_keeping", 480)
    assert fine < coarse / 4**order * 1.2
    assert fine < (5e-4 if order == 1 else 2e-4)
    coarse, fine = error("robust", 480), error("robust", 1920)
    assert fine < coarse / 4 * 1.2


@pytest.mark.parametrize("act", [function, functions, field, pairs])
def test_held_forces_of_the_time_are_of_second_order(act: Act) -> None:
    """They are given the time of the positions that they are given. `accurate` holds them, too, and tells the error of that."""
    limit = end("accurate", act, False, FINE)
    for mode in ("energy_keeping", "accurate"):
        errors = [float(np.abs(end(mode, act, False, per_second) - limit).max()) for per_second in (60, 240)]
        assert errors[1] < 5e-5
        assert errors[1] < errors[0] / 16 * 1.2


@pytest.mark.parametrize("mode", ["robust", "energy_keeping", "accurate"])
@pytest.mark.parametrize("own", [False, True])
def test_damping_slows_a_flight_by_its_exponential(mode: Any, own: bool) -> None:
    rate, speed = 3.0, 2.0
    system = iota.System(mode=mode, gravity=(0, 0, 0), damping=0 if own else rate)
    ball = system.body(shape=iota.Sphere(0.1), mass=2, damping=rate if own else 0)
    point = system.body(damping=rate if own else 0)
    point.particle((5, 0, 0))
    ball.velocity = point.velocity = (0, speed, 0)
    ball.angular_velocity = (0, 0, 4)
    for _ in range(30):
        system.step(1 / 60)
    left = math.exp(-rate * 0.5)
    for body in (ball, point):
        assert body.velocity.y == pytest.approx(speed * left, rel=1e-9)
        assert body.position.y == pytest.approx(speed * (1 - left) / rate, rel=1e-9 if mode == "accurate" else 2e-4)
    assert ball.angular_velocity.z == pytest.approx(4 * left, rel=1e-3)
    turned = 2 * math.atan2(ball.orientation[2], ball.orientation[3])
    assert turned == pytest.approx(4 * (1 - left) / rate, rel=1e-3)


def test_a_body_that_a_script_moves_is_not_slowed_by_damping() -> None:
    system = iota.System(gravity=(0, 0, 0), damping=5)
    cart = system.body(shape=iota.Box((0.2, 0.2, 0.2)), kind="scripted")
    load = system.body(shape=iota.Sphere(0.1), position=(0.5, 0, 0))
    system.ball(load, cart, at=(0.3, 0, 0))
    for step in range(60):
        cart.set_pose((0.01 * (step + 1), 0, 0), (0, 0, 0, 1))
        system.step(1 / 60)
        assert step < 2 or cart.velocity.x == pytest.approx(0.6, abs=1e-9)


@pytest.mark.parametrize("held", [False, True])
def test_a_field_that_turns_makes_no_energy_of_one_body_in_robust(held: bool) -> None:
    """The links of a body resist what turns its points; the made energy was taken from what moves within a body, so that it stayed."""
    energies = []
    for per_second in (60, 960):
        system = iota.System(mode="robust", gravity=(0, 0, 0))
        body = system.body(shape=iota.Box((0.6, 0.3, 0.2)), mass=3, position=(0, 0.5, 0))
        body.angular_velocity = (3, 2, -4)
        if held:
            system.ball(body, at=(0, 0.6, 0))
        system.field("fx = 6*m*vy; fy = -6*m*vx; fz = 0")
        for _ in range(per_second):
            assert system.step(1 / per_second).warnings == []
        assert system.energy.made < 1e-5
        energies.append(system.energy.kinetic)
    assert energies[0] == pytest.approx(energies[1], rel=0.06)


@pytest.mark.parametrize("mode", ["robust", "energy_keeping", "accurate"])
def test_the_way_of_a_servo_does_not_depend_on_the_step(mode: Any) -> None:
    """The remaining distance falls by exp(-t / 0.05 s)."""
    for per_second in (30, 60, 240):
        system = iota.System(mode=mode, gravity=(0, 0, 0))
        arm = system.body(shape=iota.Box((0.6, 0.1, 0.1)), mass=1, position=(0.3, 0, 0))
        joint = system.revolute(arm, at=(0, 0, 0), axis=(0, 0, 1))
        joint.angle.servo = (0.5, 1e4)
        for _ in range(per_second // 10):
            system.step(1 / per_second)
        # By a torque of 1e4 N m it reaches its first speed in 1e-4 s, which only `accurate` shows.
        far = 1e-4 if mode == "accurate" else 1e-9
        assert joint.angle.value == pytest.approx(0.5 * (1 - math.exp(-0.1 / 0.05)), abs=far)


@pytest.mark.parametrize("mode", ["robust", "energy_keeping", "accurate"])
@pytest.mark.parametrize("rate", [1e3, 1e6, 1e12])
def test_damping_of_any_size_lets_things_stand_still(mode: Any, rate: float) -> None:
    system = iota.System(mode=mode, damping=rate)
    arm = system.body(shape=iota.Box((0.6, 0.1, 0.1)), position=(0.3, 0, 0))
    system.revolute(arm, at=(0, 0, 0), axis=(0, 0, 1))
    rod = system.body(shape=iota.Cylinder(0.02, 1), position=(2, 0, 0))
    rod.attachment((2, 0, 0.5)).nail()
    rod.angular_velocity = (0, 0, 9)
    loose = system.body(shape=iota.Box((0.1, 0.2, 0.3)), position=(4, 0, 0))
    point = system.body().particle((5, 0, 0))
    loose.velocity = point.velocity = (3, 0, 0)
    starts = [body.position for body in system.bodies]
    for _ in range(30):
        report = system.step(1 / 60)
        assert report.unconverged == 0 and report.warnings == []
    for body, start in zip(system.bodies, starts, strict=True):
        assert abs(body.velocity) < 9.81 / min(rate, 60)
        assert np.isfinite([*body.velocity, *body.net_force]).all()
        assert abs(body.position - start) < 1.01 * 30 * 9.81 / 60**2  # in each step gravity still moves it
