# SPDX-License-Identifier: Apache-2.0
"""What flies freely moves within itself as it does at rest (Galilei)."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

import iota

HERTZ = 60
MODES = ("robust", "energy_keeping", "accurate")
Pair = Callable[[iota.System, iota.Body, iota.Body], object]

JOINTS: dict[str, Pair] = {
    "ball": lambda system, a, b: system.ball(a, b, at=(0.6, 0, 0)),
    "revolute": lambda system, a, b: system.revolute(a, b, at=(0.6, 0, 0), axis=(0, 0, 1)),
    "prismatic": lambda system, a, b: system.prismatic(a, b, at=(0.6, 0, 0), axis=(1, 0, 0)),
    "universal": lambda system, a, b: system.universal(a, b, at=(0.6, 0, 0), axis=(0, 1, 0)),
    "cylindrical": lambda system, a, b: system.cylindrical(a, b, at=(0.6, 0, 0), axis=(1, 0, 0)),
    "weld": lambda system, a, b: system.weld(a, b, at=(0.6, 0, 0)),
    "screw": lambda system, a, b: system.screw(a, b, at=(0.6, 0, 0), axis=(1, 0, 0), lead=0.3),
    "spring": lambda system, a, b: system.bond(
        a.attachment((0.3, 0.1, 0)), b.attachment((0.9, 0.1, 0)), "spring", stiffness=100, length=0.5
    ),
    "drag": lambda system, a, b: system.bond(
        a.attachment((0.3, 0.1, 0)), b.attachment((0.9, 0.1, 0)), "drag", damping=5
    ),
}


def pair_in_flight(mode: str, joint: Pair, velocity: tuple[float, float, float]) -> iota.System:
    system = iota.System(mode=mode, gravity=(0, 0, 0))
    a = system.body(shape=iota.Box((0.5, 0.1, 0.1)), position=(0.3, 0, 0))
    b = system.body(shape=iota.Box((0.5, 0.1, 0.1)), position=(0.9, 0, 0))
    a.angular_velocity, b.angular_velocity = (1, 2, 4), (1, 2, -1.5)
    joint(system, a, b)
    for body in (a, b):
        body.velocity = body.velocity + velocity
    return system


def inner_motion(system: iota.System) -> np.ndarray:
    """The second body's place and velocity relative to the first, and both angular velocities."""
    a, b = system.bodies
    return np.concatenate([b.position - a.position, b.velocity - a.velocity, a.angular_velocity, b.angular_velocity])


@pytest.mark.parametrize("joint", JOINTS)
@pytest.mark.parametrize("mode", MODES)
def test_a_thrown_pair_turns_and_folds_as_one_at_rest(mode: str, joint: str) -> None:
    def fly(velocity: tuple[float, float, float]) -> iota.System:
        system = pair_in_flight(mode, JOINTS[joint], velocity)
        for _ in range(HERTZ // 2):
            assert system.step(1 / HERTZ).warnings == []
        return system

    at_rest = inner_motion(fly((0, 0, 0)))
    for velocity in ((30, 0, 0), (0, -100, 50)):
        np.testing.assert_allclose(inner_motion(fly(velocity)), at_rest, rtol=0, atol=3e-6)


@pytest.mark.parametrize("mode", MODES)
def test_drag_between_points_of_bodies_takes_just_what_they_lose(mode: str) -> None:
    """Drag acts across the line of its points, too, and so changes angular momentum."""
    system = pair_in_flight(mode, JOINTS["drag"], (0, 0, 0))
    fine = pair_in_flight("energy_keeping", JOINTS["drag"], (0, 0, 0))
    before = system.energy.kinetic
    for _ in range(HERTZ // 2):
        assert system.step(1 / HERTZ).warnings == []
        for _ in range(32):
            fine.step(1 / HERTZ / 32)
    assert system.energy.made == 0
    taken = system.energy.dissipated + system.energy.lost
    assert before - system.energy.kinetic == pytest.approx(taken, rel=1e-6)
    tolerance = 0.05 if mode == "robust" else 2e-3
    assert system.energy.kinetic == pytest.approx(fine.energy.kinetic, rel=tolerance)
    np.testing.assert_allclose(inner_motion(system), inner_motion(fine), rtol=0, atol=20 * tolerance)
