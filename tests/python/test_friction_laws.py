# SPDX-License-Identifier: Apache-2.0
"""Static friction apart from kinetic, friction against spinning on the spot, and what pivots while it rolls."""

from __future__ import annotations

import math
import pickle
from typing import Literal

import numpy as np
import pytest

import iota

G = 9.81


def ground(material: iota.Material, lean: float = 0.0) -> iota.System:
    system = iota.System(gravity=(G * math.sin(lean), -G * math.cos(lean), 0))
    system.obstacle(iota.HalfSpace((0, 1, 0)), material=material)
    system.usual_material = material
    return system


def run(system: iota.System, body: iota.Body, seconds: float, dt: float = 1 / 240) -> np.ndarray:
    places = []
    for _ in range(round(seconds / dt)):
        assert system.step(dt).unconverged == 0
        places.append(body.center_of_mass)
    return np.array(places)


def test_a_material_has_a_static_friction_of_at_least_the_kinetic_one() -> None:
    material = iota.Material(friction=0.3, static_friction=0.5, spinning=0.01)
    assert (material.static_friction, material.spinning) == (0.5, 0.01)
    assert pickle.loads(pickle.dumps(material)) == material
    assert repr(material) == "Material(friction=0.3, static_friction=0.5, spinning=0.01)"
    with pytest.raises(
        ValueError, match=r"static_friction must be at least the friction 0\.5, or 0 for the same, not 0.3"
    ):
        iota.Material(friction=0.5, static_friction=0.3)
    for name in ("static_friction", "spinning"):
        with pytest.raises(ValueError, match=name):
            iota.Material(**{name: -1.0})


@pytest.mark.parametrize("dt", [1 / 60, 1 / 120, 1 / 240])
@pytest.mark.parametrize("share", [0.7, 0.999, 1.001])
def test_what_is_drawn_sticks_up_to_its_static_friction_and_slides_with_the_kinetic_one(
    share: float, dt: float
) -> None:
    system = ground(iota.Material(friction=0.3, static_friction=0.5))
    box = system.body(shape=iota.Box((0.4, 0.1, 0.4)), position=(0, 0.05, 0), mass=2)
    way = []
    for _ in range(round(1.5 / dt)):
        box.apply_force((share * 0.5 * 2 * G, 0, 0), box.center_of_mass - (0, 0.05, 0))
        assert system.step(dt).unconverged == 0
        way.append(box.center_of_mass.x)
    n = len(way) // 3
    slides = (way[3 * n - 1] - 2 * way[2 * n - 1] + way[n - 1]) / (n * dt) ** 2
    assert slides == pytest.approx((0.5 * share - 0.3) * G if share > 1 else 0, abs=1e-6)
    assert all(point.sliding == (share > 1) for point in box.contacts)


@pytest.mark.parametrize("dt", [1 / 60, 1 / 120, 1 / 240, 1 / 500])
def test_between_both_frictions_what_slides_goes_on_and_what_comes_to_rest_stays(dt: float) -> None:
    lean = math.atan(0.4)
    material = iota.Material(friction=0.3, static_friction=0.5)
    for speed, way in (
        (0.0, 0.0),
        (0.5, 1 + 2 * G * (math.sin(lean) - 0.3 * math.cos(lean))),
        (-2.0, -4 / (2 * G * (math.sin(lean) + 0.3 * math.cos(lean)))),
    ):
        system = ground(material, lean)
        box = system.body(shape=iota.Box((0.4, 0.1, 0.4)), position=(0, 0.05, 0), velocity=(speed, 0, 0))
        places = run(system, box, 2, dt)
        assert places[-1, 0] == pytest.approx(way, abs=3e-4)
        if speed <= 0:
            assert np.ptp(places[-round(1 / dt) :, 0]) < 1e-6, "it rests"


@pytest.mark.parametrize("mode", ["energy_keeping", "accurate"])
def test_a_ball_that_spins_on_the_spot_is_slowed_by_the_torque_of_its_patch(
    mode: Literal["energy_keeping", "accurate"],
) -> None:
    coefficient = 0.05
    system = ground(iota.Material(friction=0.6, spinning=coefficient))
    system.mode = mode
    ball = system.body(shape=iota.Sphere(0.1), position=(0, 0.1, 0), spin=(0, 20, 0))
    slowing = 2.5 * coefficient * G / 0.1
    run(system, ball, 1)
    assert ball.angular_velocity.y == pytest.approx(20 - slowing, rel=1e-3)
    run(system, ball, 1)
    assert abs(ball.angular_velocity) < 1e-9
    assert abs(ball.center_of_mass - (0, 0.1, 0)) < 1e-9
    assert system.energy.dissipated == pytest.approx(0.5 * 0.4 * ball.mass * 0.01 * 400, rel=1e-4)


def test_friction_against_spinning_keeps_the_angular_momentum_of_two_balls_that_move() -> None:
    system = iota.System(gravity=(0, 0, 0))
    system.usual_material = iota.Material(friction=0.6, spinning=0.2)
    balls = [system.body(shape=iota.Sphere(0.1), position=(0, 0, side * 0.1)) for side in (-1, 1)]
    balls[0].angular_velocity = (0, 0, 10)
    momentum = system.angular_momentum
    for _ in range(240):
        for side, ball in zip((1, -1), balls, strict=True):
            ball.apply_force((0, 0, side * 20), ball.center_of_mass)
        assert system.step(1 / 240).unconverged == 0
    assert abs(system.angular_momentum - momentum) < 1e-9 * abs(momentum)
    assert balls[0].angular_velocity.z == pytest.approx(balls[1].angular_velocity.z, abs=1e-6)


def test_both_are_kept_by_a_snapshot() -> None:
    def build() -> tuple[iota.System, iota.Body]:
        system = ground(iota.Material(friction=0.3, static_friction=0.5, spinning=0.02))
        ball = system.body(shape=iota.Sphere(0.1), position=(0, 0.1, 0), spin=(0, 20, 0), velocity=(0.2, 0, 0))
        return system, ball

    system, ball = build()
    run(system, ball, 0.3)
    kept = system.snapshot()
    after = run(system, ball, 0.3)
    system.restore(kept)
    assert np.array_equal(run(system, ball, 0.3), after)


@pytest.mark.parametrize("degrees", [60, 40])
def test_a_disk_that_leans_rolls_in_place_and_keeps_its_energy(degrees: float) -> None:
    """It turns about the vertical, so that the point that touches in the middle of a step moves before and after it."""
    radius, half, lean = 0.1, 0.002, math.radians(degrees)
    s, c = math.sin(lean), math.cos(lean)
    across, along = radius**2 / 4 + half**2 / 3, radius**2 / 2
    rate = math.sqrt(G * (radius * c - half * s) / (s * (across * c - along * half / radius * s)))
    arm = radius * np.array([c, -s, 0]) - half * np.array([s, c, 0])
    system = ground(iota.Material(friction=0.5))
    disk = system.body(
        shape=iota.Cylinder(radius, 2 * half), mass=1, position=(0, -arm[1], 0),
        orientation=("z", 90 - degrees), spin=tuple(-rate * s / radius * arm),
    )  # fmt: skip
    energy = system.energy.kinetic + system.energy.potential
    places = run(system, disk, 0.3, 1 / 1000)
    assert np.abs(places - (0, -arm[1], 0)).max() < 5e-6
    assert system.energy.kinetic + system.energy.potential == pytest.approx(energy, rel=1e-7)
