# SPDX-License-Identifier: Apache-2.0
"""Surfaces that move against their bodies: belts."""

from __future__ import annotations

import math
import pickle
from typing import Literal

import pytest

import iota

Mode = Literal["robust", "energy_keeping", "accurate"]
G, FRICTION, SPEED = 9.81, 0.5, 1.0
BELT = iota.Material(friction=FRICTION, surface_velocity=(SPEED, 0, 0))


def hall(mode: Mode = "energy_keeping", material: iota.Material = BELT, lean: float = 0.0) -> iota.System:
    """A belt along x; by gravity that leans it goes up."""
    system = iota.System(mode=mode, gravity=(-G * math.sin(lean), -G * math.cos(lean), 0))
    system.usual_material = iota.Material(friction=FRICTION)
    system.obstacle(iota.Box((40, 0.2, 2)), position=(0, -0.1, 0), material=material)
    return system


def run(system: iota.System, seconds: float, dt: float = 1 / 120) -> None:
    for _ in range(round(seconds / dt)):
        assert system.step(dt).unconverged == 0


@pytest.mark.parametrize("mode", ["robust", "energy_keeping", "accurate"])
def test_a_box_on_a_belt_gets_its_speed_by_friction_and_keeps_it(mode: Mode) -> None:
    system = hall(mode)
    box = system.body(shape=iota.Box((0.2, 0.2, 0.2)), mass=2, position=(0, 0.1, 0))
    run(system, 1.0)
    assert box.velocity.x == pytest.approx(SPEED, abs=1e-6)
    assert box.position.x == pytest.approx(SPEED * (1 - SPEED / (2 * FRICTION * G)), abs=5e-3)
    energy = system.energy
    assert energy.external_work == pytest.approx(2 * SPEED**2, rel=0.03)
    assert energy.dissipated == pytest.approx(0.5 * 2 * SPEED**2, rel=0.06)
    before = box.position.x
    run(system, 1.0)
    assert box.position.x - before == pytest.approx(SPEED, abs=1e-6)


def test_a_ball_on_a_belt_ends_with_two_sevenths_of_its_speed() -> None:
    system = hall()
    ball = system.body(shape=iota.Sphere(0.1), mass=1, position=(0, 0.1, 0))
    run(system, 1.5)
    assert ball.velocity.x == pytest.approx(SPEED * 2 / 7, rel=1e-3)
    contact = ball.contacts[0]
    assert contact.slip < 1e-3


def test_a_belt_carries_a_box_up_a_slope_without_creep() -> None:
    system = hall(lean=math.radians(20))
    box = system.body(shape=iota.Box((0.2, 0.2, 0.2)), mass=2, position=(0, 0.1, 0))
    run(system, 3.0)
    before = box.position.x
    run(system, 2.0)
    assert box.position.x - before == pytest.approx(2 * SPEED, abs=1e-5)


def test_a_heap_that_is_swept_is_carried_too() -> None:
    system = hall()
    system.budget_contacts = 1
    boxes = [system.body(shape=iota.Box((0.2, 0.2, 0.2)), mass=2, position=(x, 0.1, 0)) for x in (0, 0.5, 1.0)]
    for _ in range(180):
        assert system.step(1 / 120).approximate > 0
    assert [box.velocity.x for box in boxes] == pytest.approx([SPEED] * 3, abs=0.01)


def test_a_belt_on_a_free_cart_keeps_momentum() -> None:
    system = iota.System()
    system.usual_material = iota.Material(friction=0.0)
    system.obstacle(iota.HalfSpace((0, 1, 0)), material=iota.Material(friction=0.0))
    cart = system.body(shape=iota.Box((3, 0.2, 1)), mass=10, position=(0, 0.1, 0))
    cart.material = BELT
    box = system.body(shape=iota.Box((0.2, 0.2, 0.2)), mass=2, position=(0, 0.3, 0))
    box.material = iota.Material(friction=FRICTION)
    # The floor has no friction, and the geometric mean with it has none.
    run(system, 0.8)
    assert box.velocity.x - cart.velocity.x == pytest.approx(SPEED, abs=1e-4)
    assert 2 * box.velocity.x + 10 * cart.velocity.x == pytest.approx(0, abs=1e-7)


def test_a_belt_that_starts_wakes_what_sleeps_on_it() -> None:
    system = hall(material=iota.Material(friction=FRICTION))
    system.rest_after = 0.2
    box = system.body(shape=iota.Box((0.2, 0.2, 0.2)), mass=2, position=(0, 0.1, 0))
    run(system, 1.0)
    assert box.kind == "resting"
    system.obstacles[0].material = BELT
    run(system, 1.0)
    assert box.velocity.x == pytest.approx(SPEED, abs=1e-6)


def test_belts_are_saved_and_compared() -> None:
    assert pickle.loads(pickle.dumps(BELT)) == BELT != iota.Material(friction=FRICTION)
    assert "surface_velocity=(1, 0, 0)" in repr(BELT)
    system, other = hall(), iota.System()
    other.restore(system.snapshot())
    assert other.obstacles[0].material == BELT
    with pytest.raises(ValueError, match="surface_velocity"):
        iota.Material(surface_velocity=(math.nan, 0, 0))
