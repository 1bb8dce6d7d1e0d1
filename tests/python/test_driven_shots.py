# SPDX-License-Identifier: Apache-2.0
"""What springs and motors move further in a step than its velocity tells stops at a wall."""

from __future__ import annotations

import math

import numpy as np
import pytest
from amount import TRIES_ALL

import iota

MODES = ("energy_keeping", "robust", "accurate")
GAP = 0.3  # m, from the shot to the wall


def made(mode: str, wall: float) -> tuple[iota.System, iota.Body]:
    """A ball of 0.1 m and 1 kg at rest before a wall of this thickness, m."""
    system = iota.System(mode=mode, gravity=(0, 0, 0))
    system.usual_material = iota.Material(friction=0.3, restitution=0.0)
    system.obstacle(iota.Box((wall, 4, 4)), position=(0.05 + GAP + wall / 2, 0, 0))
    return system, system.body(shape=iota.Sphere(0.05), mass=1, position=(0, 0, 0))


def spring(system: iota.System, ball: iota.Body, stiffness: float) -> None:
    anchor = system.body().particle((2, 0, 0), mass=1)
    anchor.nail()
    system.bond(ball.attachment((0, 0, 0)), anchor, "spring", stiffness=stiffness, length=0.1)


def motor(system: iota.System, ball: iota.Body, force: float) -> None:
    system.prismatic(ball, None, at=(0, 0, 0), axis=(1, 0, 0), motor=(force, force))


def servo(system: iota.System, ball: iota.Body, stiffness: float) -> None:
    system.prismatic(ball, None, at=(0, 0, 0), axis=(1, 0, 0), spring=(stiffness, 2.0))


def arm(system: iota.System, ball: iota.Body, stiffness: float) -> None:
    """The spring pulls a body that the ball is welded to."""
    other = system.body(shape=iota.Sphere(0.02), mass=1, position=(0, 0.5, 0))
    system.weld(other, ball, at=(0, 0.25, 0))
    spring(system, other, stiffness)


@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("drive", [spring, motor, servo, arm])
def test_it_stops_at_a_wall_whatever_its_force_and_the_length_of_the_step(mode: str, drive: object) -> None:
    for strength in (1e2, 1e3, 1e4, 1e5) if TRIES_ALL else (1e3, 1e5):
        for wall in (0.01, 0.2):
            for rate in (60, 240):
                system, ball = made(mode, wall)
                drive(system, ball, strength)  # type: ignore[operator]
                far = 0.0
                for _ in range(rate // 5):
                    system.step(1 / rate)
                    far = max(far, ball.position.x)
                assert far < GAP + 0.02, (strength, wall, rate)


@pytest.mark.parametrize("mode", MODES)
def test_a_flipper_that_starts_near_a_ball_hits_it(mode: str) -> None:
    system = iota.System(mode=mode, gravity=(0, 0, 0))
    system.usual_material = iota.Material(friction=0.3, restitution=0.0)
    flipper = system.body(shape=iota.Box((1.0, 0.05, 0.1)), mass=1, position=(0.5, 0, 0))
    system.revolute(flipper, None, at=(0, 0, 0), axis=(0, 0, 1), motor=(20.0, 1e5))
    ball = system.body(shape=iota.Sphere(0.05), mass=0.1, position=(0.7, 0.2, 0))
    for _ in range(3):
        system.step(1 / 60)
        x, y, z, w = flipper.orientation
        normal = np.array([2 * (x * y - z * w), 1 - 2 * (x * x + z * z), 2 * (y * z + x * w)])
        assert np.dot(np.array(ball.position) - np.array(flipper.position), normal) > 0.05, "it is still on its side"
    assert abs(ball.velocity) > 5


@pytest.mark.parametrize("mode", MODES)
def test_what_passes_beside_a_post_goes_on_as_without_it(mode: str) -> None:
    ways = []
    for has_post in (False, True):
        system, ball = iota.System(mode=mode, gravity=(0, 0, 0)), None
        system.usual_material = iota.Material(friction=0.3)
        ball = system.body(shape=iota.Sphere(0.05), mass=1, position=(0, 0, 0))
        if has_post:
            system.obstacle(iota.Box((0.1, 0.4, 4)), position=(0.8, 0.4, 0))
        spring(system, ball, 3000)
        for _ in range(10):
            system.step(1 / 120)
        ways.append(tuple(ball.position))
    assert math.dist(*ways) < 1e-9


def test_what_a_spring_throws_at_another_body_pushes_it() -> None:
    system = iota.System(gravity=(0, 0, 0))
    system.usual_material = iota.Material(friction=0.0, restitution=0.0)
    ball = system.body(shape=iota.Sphere(0.05), mass=1, position=(0, 0, 0))
    plate = system.body(shape=iota.Box((0.01, 1, 1)), mass=3, position=(0.4, 0, 0))
    spring(system, ball, 1e4)
    for _ in range(3):
        system.step(1 / 120)
        assert ball.position.x < plate.position.x
    assert plate.velocity.x == pytest.approx(ball.velocity.x) and plate.velocity.x > 50
