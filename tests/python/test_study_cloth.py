# SPDX-License-Identifier: Apache-2.0
from __future__ import annotations

import numpy as np

import iota
from iota.studies import cloth, shoal


def test_the_cloth_hangs_in_the_wind_without_tearing_and_tears_where_it_is_pulled() -> None:
    system = cloth.build().system
    for _ in range(360):
        assert system.step(1 / 120).unconverged == 0
    assert not any(bond.broken for bond in system.bonds)
    corner = system.particles[-1]
    grip = system.grip(corner.body, target=corner.position)
    start, torn = corner.position, 0
    for step in range(150):
        grip.move(start + (0.0, -0.02 * step, 0.01 * step))
        system.step(1 / 120)
        torn += len(system.broken)
    assert 0 < torn < 0.5 * len(system.bonds)


def test_the_shoal_stays_together_apart_and_behind_its_leader() -> None:
    world = shoal.build(300)
    system = world.system
    for _ in range(600):
        world.step()
    places = system.positions
    apart = np.linalg.norm(places[:, None] - places[None], axis=2) + 10 * np.eye(len(places))
    nearest = apart.min(axis=1)
    assert np.median(nearest) > 0.12 and np.quantile(nearest, 0.95) < 1.5
    middle = places.mean(axis=0)
    assert np.quantile(np.linalg.norm(places - middle, axis=1), 0.9) < 4
    assert np.linalg.norm(middle - shoal.leader_at(system.time)) < 6
    speeds = np.linalg.norm(system.velocities, axis=1)
    assert 0.6 * shoal.CRUISE < speeds.mean() < 1.8 * shoal.CRUISE
    # Fish look where they swim, within their wag and bank.
    q = np.array([body.orientation for body in system.bodies])
    x = np.stack([1 - 2 * (q[:, 1] ** 2 + q[:, 2] ** 2), 2 * (q[:, 0] * q[:, 1] + q[:, 2] * q[:, 3])], axis=1)
    ahead = system.velocities[:, :2] / speeds[:, None]
    assert np.median(np.abs(x - ahead)) < 0.25


def test_a_thousand_fish_are_drawn_of_few_triangles() -> None:
    looks = shoal.fish_looks()
    assert all(look.shape.mass_properties.volume > 0 for look in looks if isinstance(look.shape, iota.Mesh))
    of_one = sum(len(look.shape.triangles) for look in looks if isinstance(look.shape, iota.Mesh))
    assert 2 * shoal.FISH * of_one < 120_000  # and as many for their shadows
