# SPDX-License-Identifier: Apache-2.0
"""With shorter steps what slides and rolls tends to one limit, by the order of the mode, on a box and on a mesh."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import iota

SECONDS = 0.4
FINE = 1920  # steps a second in `energy_keeping`: the limit
EVENTS = 1e-5  # of places and turns, where what slides begins to stick within a step

Make = Callable[[iota.System], iota.Body]


def turn(axis: tuple[float, float, float], angle: float) -> tuple[float, float, float, float]:
    x, y, z = (math.sin(angle / 2) * a for a in axis)
    return x, y, z, math.cos(angle / 2)


def sliding_box(system: iota.System) -> iota.Body:
    body = system.body(
        shape=iota.Box((0.3, 0.2, 0.2)), density=500, position=(0, 0.1, 0), orientation=turn((0, 1, 0), 0.4)
    )
    body.velocity, body.angular_velocity = (1.5, 0, 0.4), (0, 2, 0)
    return body


def ball(system: iota.System) -> iota.Body:
    body = system.body(shape=iota.Sphere(0.1), density=500, position=(0, 0.1, 0))
    body.velocity = (2, 0, 0)
    return body


def cylinder(system: iota.System) -> iota.Body:
    askew = turn((0, 1, 0), math.pi / 2 + 0.3)
    return system.body(shape=iota.Cylinder(0.1, 0.3), density=500, position=(0, 0.1, 0), orientation=askew)


def capsule(system: iota.System) -> iota.Body:
    askew = turn((0, 1, 0), math.pi / 2 + 0.3)
    return system.body(shape=iota.Capsule(0.1, 0.3), density=500, position=(0, 0.1, 0), orientation=askew)


def ellipsoid(system: iota.System) -> iota.Body:
    body = system.body(
        shape=iota.Ellipsoid((0.4, 0.2, 0.2)), density=500, position=(0, 0.1, 0), orientation=turn((0, 1, 0), 0.5)
    )
    body.angular_velocity = (2, 0, -1)
    return body


def cone(system: iota.System) -> iota.Body:
    tilt = math.atan(0.25)
    place = (0, 0.2 * math.sin(tilt) + 1e-9, 0)
    return system.body(shape=iota.Cone(0.1, 0.4), density=500, position=place, orientation=turn((0, 0, 1), -tilt))


def leaning_capsule(system: iota.System) -> iota.Body:
    place = (0, 0.5 * math.sin(1.2) + 0.03, 0)
    return system.body(shape=iota.Capsule(0.03, 1), density=500, position=place, orientation=turn((0, 0, 1), 1.2))


def after(make: Make, on_mesh: bool, mode: Any, rate: int) -> NDArray[np.float64]:
    """Its position and orientation."""
    slope = 0.1
    system = iota.System(gravity=(9.81 * math.sin(slope), -9.81 * math.cos(slope), 0), mode=mode)
    system.usual_material = iota.Material(friction=0.5)
    if on_mesh:
        places = [(x, 0.0, z) for x in (-4.0, -1.3, 1.1, 4.0) for z in (-4.0, -1.3, 1.1, 4.0)]
        corners = [(4 * i + k, 4 * i + k + 1, 4 * i + k + 4, 4 * i + k + 5) for i in range(3) for k in range(3)]
        triangles = [t for a, b, c, d in corners for t in ((a, b, c), (b, d, c))]
        system.obstacle(iota.Mesh(np.array(places), np.array(triangles), closed=False))
    else:
        system.obstacle(iota.Box((8, 1, 8)), (0, -0.5, 0))
    body = make(system)
    dissipated = 0.0
    for _ in range(round(SECONDS * rate)):
        report = system.step(1 / rate)
        assert not report.warnings
        now = report.energy
        assert now.dissipated > dissipated - (1e-3 * now.kinetic + 1e-6), "contacts give no energy"
        dissipated = now.dissipated
    return np.array([*body.position, *body.orientation])


@pytest.mark.parametrize("on_mesh", [False, True])
@pytest.mark.parametrize("make", [sliding_box, ball, cylinder, capsule, ellipsoid, cone, leaning_capsule])
def test_what_slides_and_rolls_tends_to_one_limit_by_the_order_of_the_mode(make: Make, on_mesh: bool) -> None:
    limit = after(make, on_mesh, "energy_keeping", FINE)

    def error(mode: Any, rate: int) -> float:
        return float(np.abs(after(make, on_mesh, mode, rate) - limit).max())

    robust, keeping = error("robust", 60), error("energy_keeping", 60)
    assert error("robust", 240) < 0.45 * robust + EVENTS
    assert error("energy_keeping", 240) < 0.12 * keeping + EVENTS
    assert error("accurate", 60) < keeping + EVENTS


@pytest.mark.parametrize("mode", [None, "robust"])
def test_dominoes_fall_one_after_the_other_at_the_times_of_shorter_steps(mode: Any) -> None:
    """The wave stood still at the tenth: what stuck in the mean of a step was held at its end by more than its friction."""

    def times(rate: int, mode: Any = None) -> dict[int, float]:
        system = iota.System() if mode is None else iota.System(mode=mode)
        system.usual_material = iota.Material(friction=0.6)
        system.obstacle(iota.HalfSpace((0, 1, 0)))
        size = iota.Box((0.04, 0.2, 0.1))
        dominoes = [system.body(shape=size, density=600, position=(0.12 * k, 0.1, 0)) for k in range(12)]
        dominoes[0].angular_velocity, dominoes[0].velocity = (0, 0, -4), (0.5, 0, 0)
        fallen: dict[int, float] = {}
        while system.time < 1.4 and len(fallen) < len(dominoes):
            system.step(1 / rate)
            for k, domino in enumerate(dominoes):
                if abs(domino.angular_velocity.z) > 0.5:
                    fallen.setdefault(k, system.time)
        return fallen

    fine, coarse = times(480), times(120, mode)
    assert fine.keys() == coarse.keys() == set(range(12))
    assert all(abs(coarse[k] - fine[k]) < 0.02 for k in fine)


@pytest.mark.parametrize(("mode", "turn"), [(None, 0.9), (None, 1.5), (None, 3.0), ("accurate", 0.9)])
def test_a_ball_rolls_on_for_any_turn_in_a_step(mode: Any, turn: float) -> None:
    """A marble at 1.5 m/s lost a third of its speed in 2 s: the point that touched in the middle of the step had the friction of
    each of its sub-steps."""
    system = iota.System() if mode is None else iota.System(mode=mode)
    system.usual_material = iota.Material(friction=0.6)
    system.obstacle(iota.HalfSpace((0, 1, 0)))
    rate, radius = 60, 0.1
    speed = turn * radius * rate
    ball = system.body(shape=iota.Sphere(radius), mass=1, position=(0, radius, 0))
    ball.velocity, ball.angular_velocity = (speed, 0, 0), (0, 0, -speed / radius)
    for _ in range(rate):
        system.step(1 / rate)
    assert ball.velocity.x == pytest.approx(speed, rel=1e-6)
    assert -ball.angular_velocity.z * radius == pytest.approx(speed, rel=1e-6)


@pytest.mark.parametrize("held_by", ["slope", "jaws"])
def test_what_rests_takes_few_parts_of_a_step_in_mode_accurate(held_by: str) -> None:
    """Contacts sagged anew in each step, by a part of g h^2: 64 parts on a slope, 288 between jaws."""
    on_slope = held_by == "slope"
    system = iota.System(mode="accurate", gravity=(3, -9.3, 0) if on_slope else (0, -9.81, 0))
    system.usual_material = iota.Material(friction=0.6)
    if on_slope:
        system.obstacle(iota.HalfSpace((0, 1, 0)))
        body = system.body(shape=iota.Box((0.2, 0.1, 0.2)), density=500, position=(0, 0.05, 0))
    else:
        body = system.body(shape=iota.Box((0.1, 0.1, 0.1)), mass=1, position=(0, 1, 0))
        for side in (-1, 1):
            place = (0.06 * side, 1, 0)
            jaw = system.body(shape=iota.Box((0.02, 0.3, 0.08)), mass=0.3, position=place)
            system.prismatic(jaw, at=place, axis=(1, 0, 0), motor=(-0.2 * side, 40))
    start = np.array(body.position)
    parts = [system.step(1 / 60).substeps_max for _ in range(60)]
    assert sum(parts[2:]) < 120
    assert np.abs(np.array(body.position) - start).max() < 1e-7
