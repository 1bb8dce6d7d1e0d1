# SPDX-License-Identifier: Apache-2.0
from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest

import iota
from iota import effects


def test_winds_add_up() -> None:
    system = iota.System(gravity=(0, 0, 0))
    places = [(1.0, 1.0, 0.5), (-0.4, 2.0, 0.7)]
    dust = [system.body().particle(place, mass=1e-3) for place in places]
    wind = effects.uniform((2, 0, -1)) + effects.vortex((0, 0, 0), circulation=3, core=0.1) * 2
    wind = wind + effects.source((0, 1, 0), strength=5, core=0.1)
    wind.blow(system, drag=1e-6)
    dt = 1e-3
    system.step(dt)
    for particle, (x, y, z) in zip(dust, places, strict=True):
        turn = 2 * 3 / (2 * math.pi) / (x * x + z * z + 0.01)
        out = 5 / (4 * math.pi) / (x * x + (y - 1) ** 2 + z * z + 0.01) ** 1.5
        expected = np.array([2 + z * turn + x * out, (y - 1) * out, -1 - x * turn + z * out])
        assert tuple(particle.velocity) == pytest.approx(expected * 1e-3 * dt, rel=2e-3, abs=1e-12)


def test_a_gust_comes_and_goes_and_too_many_flows_are_refused() -> None:
    system = iota.System(gravity=(0, 0, 0))
    leaf = system.body().particle((0, 0, 0), mass=1.0)
    effects.gust((3, 0, 0), period=1.0).blow(system, drag=1e-6)
    for _ in range(100):
        system.step(0.01)
    assert leaf.velocity.x == pytest.approx(1.5e-6, rel=1e-2)  # the mean of sin^2 is a half
    many = effects.uniform((0, 0, 0))
    for x in range(20):
        many = many + effects.vortex((x, 0, 0), 1)
    with pytest.raises(ValueError, match="999"):
        many.blow(system)


def test_sparks_are_born_and_die() -> None:
    system = iota.System()
    fire = effects.fire(system, at=(0, 0.1, 0))
    effects.waterfall(system, at=(3, 3, 0))
    for _ in range(180):
        system.step(1 / 60)
    count = len(system.bodies)
    assert 500 < count < 1500
    flames = np.array([tuple(p.position) for p in system.particles if abs(p.position.x) < 1])
    assert flames[:, 1].max() > 0.6 and flames[:, 1].min() > -0.3
    water = np.array([tuple(p.position) for p in system.particles if p.position.x > 2])
    assert water[:, 1].min() < 0.6 and water[:, 1].min() > -0.6
    fire.active = False
    star = effects.burst(system, (0, 5, 0), count=100)
    for _ in range(6):
        system.step(1 / 60)
    star.active = False
    near = [p for p in system.particles if abs(p.position - (0, 5, 0)) < 1.5 and p.position.y > 3.4]
    assert 80 <= len(near) <= 100


def test_the_unit_is_stiff_when_pulled_fast_and_soft_when_held() -> None:
    """It creeps to the load over the first spring alone, with the time constant of a standard linear solid."""
    k, creep, viscosity, load = 50.0, 150.0, 60.0, 5.0
    system = iota.System(gravity=(0, -load, 0), mode="robust")  # 1 kg
    top, weight = system.body().particle((0, 1, 0)), system.body(damping=20.0).particle((0, 0, 0), mass=1.0)
    top.nail()
    effects.viscoelastic(system, top, weight, k, creep, viscosity)
    sag = []
    for _ in range(1200):
        assert system.step(1 / 100).unconverged == 0
        sag.append(-weight.position.y)
    fast, slow = load / (k + creep), load / k
    assert sag[-1] == pytest.approx(slow, rel=1e-2)
    constant = viscosity * (k + creep) / (k * creep)
    early, late = sag[100], sag[100 + round(100 * constant)]
    assert fast < early < 0.75 * slow
    assert (slow - late) / (slow - early) == pytest.approx(math.exp(-1), abs=0.06)


def test_heat_flows_softens_and_melts() -> None:
    system = iota.System()
    bar = iota.builder.Structure()
    points = bar.points.add([(0.1 * x, 2, 0) for x in range(6)], 0.1)
    for p, q in pairwise(points):
        bar.bond(p, q, "spring", stiffness=1000, damping=1)
    bar.nail(0)
    made = bar.realize(system)
    melting = effects.Melting(made.bonds, melts_at=50, conduction=0.5, capacity=10)
    melting.heat((0.5, 2, 0), radius=0.01, energy=90)
    before = melting.temperature.sum()
    assert before == pytest.approx(90)
    stiff = made.bonds[4].parameters["stiffness"]
    assert melting.step(1e-3) == 0
    assert made.bonds[4].parameters["stiffness"] < 0.2 * stiff and made.bonds[0].parameters["stiffness"] == stiff
    for _ in range(300):
        melting.step(0.1)
    assert melting.temperature.sum() == pytest.approx(before)  # all particles have one capacity
    assert np.ptp(melting.temperature) < 1
    assert all(bond.alive for bond in made.bonds)
    melting.heat((0.3, 2, 0), radius=0.01, energy=200)
    assert melting.step(1e-3) == 2
    assert [bond.alive for bond in made.bonds] == [True, True, False, False, True]


def test_the_skin_of_one_particle_is_a_ball_and_near_ones_melt_into_one() -> None:
    points, triangles = effects.skin([(1, 2, 3)], radius=0.3, cell=0.05)
    ball = iota.Mesh(points, triangles).mass_properties  # refuses what is open or inside out
    assert ball.volume == pytest.approx(4 / 3 * np.pi * 0.3**3, rel=0.05)
    assert ball.center == pytest.approx((1, 2, 3), abs=1e-3)
    assert np.linalg.norm(points - (1, 2, 3), axis=1) == pytest.approx(np.full(len(points), 0.3), rel=0.05)
    volumes = [
        iota.Mesh(*effects.skin([(0, 0, 0), (apart, 0, 0)], radius=0.3, cell=0.05)).mass_properties.volume
        for apart in (0.0, 0.5, 1.3)
    ]
    assert volumes[1] > 2.05 * ball.volume, "a neck between them"
    assert volumes[2] == pytest.approx(2 * ball.volume, rel=0.01)


def test_a_skin_follows_its_particles_and_refuses_impossible_sizes() -> None:
    system = iota.System()
    jelly = iota.builder.soft_block(cells=(3, 2, 2)).realize(system)
    before, triangles = effects.skin(system.positions, radius=0.1)
    for _ in range(30):
        system.step(1 / 60)
    after, _ = effects.skin(system.positions, radius=0.1)
    assert len(jelly.points) < len(before) and triangles.max() < len(before)
    fallen = before[:, 1].mean() - after[:, 1].mean()
    assert fallen == pytest.approx(9.81 * 0.5**2 / 2, rel=0.05)
    nothing, none = effects.skin(np.empty((0, 3)), radius=0.1)
    assert len(nothing) == len(none) == 0
    with pytest.raises(ValueError, match="make cell larger"):
        effects.skin([(0, 0, 0), (100, 100, 100)], radius=0.1)
    with pytest.raises(ValueError, match="finite"):
        effects.skin([(np.nan, 0, 0)], radius=0.1)
