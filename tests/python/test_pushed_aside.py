# SPDX-License-Identifier: Apache-2.0
"""Bodies that begin within each other are pushed apart: they are moved, not turned, and nothing is told."""

import numpy as np
import pytest

import iota

H = 1 / 120


@pytest.mark.parametrize("mode", ["energy_keeping", "robust"])
@pytest.mark.parametrize("velocity", [(0, -5, 0), (0, 0, 40)])
def test_a_box_that_is_pushed_aside_while_both_fly_does_not_begin_to_spin(
    mode: str, velocity: tuple[float, float, float]
) -> None:
    system = iota.System(mode=mode, gravity=(0, 0, 0))
    system.usual_material = iota.Material(friction=0.5)
    boxes = [system.body(shape=iota.Box((0.2, 0.2, 0.2)), mass=1 + i, position=(0.19 * i, 0, 0)) for i in range(2)]
    for box in boxes:
        box.velocity = velocity
    for _ in range(20):
        assert not system.step(H).warnings
    assert boxes[1].position.x - boxes[0].position.x > 0.195
    for box in boxes:
        assert box.angular_velocity.length < 1e-9
        assert np.linalg.norm(np.array(box.velocity) - velocity) < 1e-6


def a_row(seed: int) -> iota.System:
    """Two to five bodies that nearly touch, or overlap a little; some of them move."""
    random = np.random.default_rng(seed)
    system = iota.System(mode=("energy_keeping", "robust")[random.integers(2)])
    system.usual_material = iota.Material(friction=random.uniform(0, 1), restitution=random.choice([0, 0.5]))
    if random.random() < 0.5:
        floor = system.obstacle(iota.HalfSpace((0, 1, 0)))
        floor.material = iota.Material(friction=0.5)
    if random.random() < 0.5:
        system.gravity = (0, 0, 0)
    count, size, x = random.integers(2, 6), 10 ** random.uniform(-2, 0.5), 0.0
    shapes = [
        (iota.Box((size, size, size)), size / 2),
        (iota.Sphere(size / 2), size / 2),
        (iota.Box((size, 0.2 * size, 0.5 * size)), 0.1 * size),
        (iota.Capsule(size / 4, size / 2), size / 4),
    ]
    bodies = []
    for _ in range(count):
        shape, half = shapes[random.integers(4)]
        gap = random.choice([0, 1e-6, -1e-6, -1e-4, 1e-3, -0.01, -0.1]) * size
        mass, above = 10 ** random.uniform(-1, 1), random.choice([0, 0, 1e-9, -1e-4]) * size
        body = system.body(shape=shape, mass=mass, position=(x, half + above, 0))
        x += size + gap
        if random.random() < 0.5:
            body.velocity = tuple(random.normal(size=3) * random.choice([0, 1e-3, 1]))
        if random.random() < 0.3:
            body.angular_velocity = tuple(random.normal(size=3) * random.choice([1e-3, 1]))
        bodies.append(body)
    if random.random() < 0.3 and count > 2:
        system.ball(bodies[0], bodies[1], at=(size / 2, size / 2, 0))
    return system


@pytest.mark.parametrize("seed", [*range(60), 264, 410, 593])
def test_bodies_that_are_made_close_to_each_other_give_no_warning(seed: int) -> None:
    system = a_row(seed)
    for _ in range(8):
        assert not system.step(H).warnings
