# SPDX-License-Identifier: Apache-2.0
"""The angular momentum about an axle of the world, of what is joined to it, by places and velocities."""

import random

import numpy as np
import pytest

import iota

Array = np.ndarray


def unit(rng: random.Random) -> Array:
    v = np.array([rng.gauss(0, 1) for _ in range(3)])
    return v / np.linalg.norm(v)


def carousel(
    seed: int, mode: str, upright: bool, links: tuple[str, ...]
) -> tuple[iota.System, list[iota.Body], Array, Array]:
    """Boxes joined at random, the first on an axle of the world or on two ball joints, that turn about it; the last one also on its own."""
    rng = random.Random(seed)
    axis = np.array((0.0, 1.0, 0.0)) if upright else unit(rng)
    at = np.array([rng.uniform(-3, 3) for _ in range(3)])
    size = 10 ** rng.uniform(-2, 1)
    system = iota.System(mode=mode, gravity=(0, -9.81 * size if upright else 0, 0), threads=1)  # type: ignore[arg-type]
    bodies: list[iota.Body] = []
    turn = rng.choice((-1, 1)) * rng.uniform(2, 8) * axis
    for _ in range(rng.randint(2, 5)):
        before = rng.choice(bodies) if bodies else None
        place = at + size * unit(rng) if before is None else np.array(before.position) + 0.8 * size * unit(rng)
        box = iota.Box(tuple(size * rng.uniform(0.1, 0.5) for _ in range(3)))
        body = system.body(shape=box, mass=10 ** rng.uniform(-1, 1), position=tuple(place))
        body.angular_velocity, body.velocity = tuple(turn), tuple(np.cross(turn, place - at))
        bodies.append(body)
        if before is None and rng.random() < 0.5:
            system.revolute(body, at=tuple(at), axis=tuple(axis))
        elif before is None:
            system.ball(body, at=tuple(at))
            system.ball(body, at=tuple(at + size * axis))
        else:
            link, middle = rng.choice(links), tuple((np.array(before.position) + place) / 2)
            along = {"axis": tuple(unit(rng))} if link in ("revolute", "prismatic") else {}
            getattr(system, link)(body, before, at=middle, **along)
    bodies[-1].angular_velocity = tuple(turn + rng.uniform(-3, 3) * unit(rng))
    return system, bodies, at, axis


def angular_momentum(bodies: list[iota.Body], at: Array, axis: Array) -> float:
    return sum(
        float(
            axis @ (b.mass * np.cross(np.array(b.position) - at, np.array(b.velocity)) + np.array(b.angular_momentum))
        )
        for b in bodies
    )


@pytest.mark.parametrize("upright", [False, True])
@pytest.mark.parametrize("mode", ["robust", "energy_keeping"])
def test_what_hangs_on_an_axle_of_the_world_keeps_its_angular_momentum(mode: str, upright: bool) -> None:
    changes = []
    for seed in range(24):
        links = ("ball", "revolute", "prismatic", "weld")
        system, bodies, at, axis = carousel(seed, mode, upright, links)
        hz = (30, 60, 120)[seed % 3]
        system.step(1 / hz)  # joints take what does not fit them
        start, energy = angular_momentum(bodies, at, axis), system.energy.total
        for _ in range(hz):
            system.step(1 / hz)
        changes.append(abs(angular_momentum(bodies, at, axis) / start - 1))
        assert system.energy.total <= energy + 1e-6 * abs(energy)
    assert np.median(changes) < 1e-9
    # Swinging needs energy that `robust` has lost.
    assert max(changes) < (0.01 if upright and mode == "robust" else 1e-4)


def test_a_carousel_in_gravity_turns_on_in_robust() -> None:
    """It lost a quarter of its speed in a second."""
    system = iota.System(mode="robust", gravity=(0, -9.81, 0), threads=1)
    arm = system.body(shape=iota.Box((1, 0.1, 1)), mass=1, position=(0.3, 0, 0))
    seat = system.body(shape=iota.Box((0.5, 0.1, 0.2)), mass=0.7, position=(1.1, 0.2, 0))
    system.revolute(arm, at=(0, 0, 0), axis=(0, 1, 0))
    system.revolute(seat, arm, at=(0.8, 0.2, 0), axis=(0, 1, 0))
    for body in (arm, seat):
        body.angular_velocity = (0, 5, 0)
        body.velocity = tuple(np.cross((0, 5, 0), np.array(body.position)))
    at, axis = np.zeros(3), np.array((0.0, 1.0, 0.0))
    start = angular_momentum([arm, seat], at, axis)
    for _ in range(120):
        system.step(1 / 60)
    assert angular_momentum([arm, seat], at, axis) == pytest.approx(start, rel=2e-3)
