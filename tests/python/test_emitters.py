# SPDX-License-Identifier: Apache-2.0
"""Particles that are born, age, turn and die."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from shown import show

import iota


def test_an_emitter_emits_particles_for_their_lifetime(system: iota.System) -> None:
    fire = system.emitter(
        rate=200, lifetime=0.3, velocity_spread=0.5, curve=[(0, 0.02, (1, 1, 0)), (1, 0.1, (1, 0, 0, 0))]
    )
    births = deaths = 0
    for _ in range(100):
        report = system.step(0.01)
        births += report.births
        deaths += report.deaths
    assert births == fire.born == 200 and fire.count == births - deaths == len(fire.particles) == 60
    assert system.ages.max() < 0.3 and system.colors.shape == (60, 4)
    np.testing.assert_allclose(system.radii, 0.02 + 0.08 * system.ages / 0.3, atol=1e-9)
    particle = fire.particles[0]
    assert particle.has_attributes and particle.lifetime == pytest.approx(0.3)
    assert particle.color[1] == pytest.approx(1 - particle.age / 0.3, abs=1e-6)
    fire.active = False
    fire.rate = 5
    fire.move((1, 0, 0))
    assert not fire.active and fire.rate == 5
    fire.destroy()
    assert not fire.alive and particle.alive and system.validate() == []
    with pytest.raises(iota.StaleIdError):
        _ = fire.rate


@pytest.mark.parametrize(("mode", "off"), [("energy_keeping", 6e-4), ("accurate", 2e-9)])
@pytest.mark.parametrize("own", [False, True])
def test_damping_acts_from_the_birth_within_a_step_on(mode: Any, off: float, own: bool) -> None:
    rate, speed, gravity = 2.0, 3.0, 9.81
    system = iota.System(mode=mode, damping=0.5 if own else rate)
    system.emitter(
        rate=170, source=iota.Sphere(1e-9), velocity=(0, speed, 0), lifetime=0.5, damping=1.5 if own else 0.0
    )
    for _ in range(30):
        system.step(1 / 60)
    heights = (speed + gravity / rate) / rate * -np.expm1(-rate * system.ages) - gravity / rate * system.ages
    assert len(heights) > 80
    np.testing.assert_allclose(system.positions[:, 1], heights, atol=off)


def test_sparks_are_dots_until_something_ties_them(system: iota.System) -> None:
    fire = system.emitter(rate=100, lifetime=10, velocity=(0, 1, 0))
    with show(system) as shown:
        for _ in range(20):
            system.step(0.01)
        assert fire.count == 20 and system.structure_version > 20
        assert shown.look() == 0 and len(system.poses()[0]) == 0, "nothing to tell a page but where they are"
        first, second = fire.particles[:2]
        assert first.body.is_spark
        bond = system.bond(first, second, "spring", stiffness=1)
        assert not first.body.is_spark
        shown.look()
        assert set(shown.bodies) == {first.body.slot, second.body.slot} == set(system.poses()[0])
        assert all(shown.parts(p.body)[0]["shape"]["kind"] == "sphere" for p in (first, second))
        first.destroy()  # takes the bond with it
        assert not bond.alive and second.body.is_spark
        shown.look()
        assert not shown.bodies
        fire.destroy()  # from now on they are particles like others
        assert not second.body.is_spark
        shown.look()
        assert len(shown.bodies) == 19


def test_thousands_of_particles_are_no_matter(system: iota.System) -> None:
    rain = system.emitter(rate=20_000, source=iota.Box((10, 0.1, 10)), lifetime=0.2, max_count=5000)
    for _ in range(30):
        system.step(0.01)
    assert rain.count == 4000 and system.validate() == []


def test_any_particle_may_have_a_lifetime_and_a_look(system: iota.System) -> None:
    spark = system.body().particle()
    assert not spark.has_attributes and spark.lifetime == math.inf
    spark.lifetime, spark.radius, spark.color = 0.025, 0.3, (1, 0, 0)
    assert spark.color == (1, 0, 0, 1) and spark.radius == 0.3
    assert [system.step(0.01).deaths for _ in range(3)] == [0, 0, 1] and not spark.alive


def test_oriented_particles_spin_and_are_drawn_to_a_direction(system: iota.System) -> None:
    surfel = system.body().particle()
    with pytest.raises(ValueError, match="no orientation of its own"):
        _ = surfel.spin
    surfel.orientation = (0, 0, 0, 2)
    assert surfel.is_oriented and surfel.normal == pytest.approx((0, 0, 1))
    surfel.moment, surfel.spin = 2, (0, 1, 0)
    surfel.apply_torque((0, 4, 0))
    system.step(0.5)
    assert surfel.spin == pytest.approx((0, 2, 0))
    assert surfel.normal == pytest.approx((math.sin(0.75), 0, math.cos(0.75)))
    surfel.align((1, 0, 0), stiffness=50, damping=30)
    for _ in range(500):
        system.step(0.02)
    assert surfel.normal == pytest.approx((1, 0, 0), abs=1e-4)


def test_bad_emitters_are_refused(system: iota.System) -> None:
    for bad in (
        {"rate": -1},
        {"lifetime": 0},
        {"lifetime": 1, "lifetime_spread": 2},
        {"mass": math.nan},
        {"source": iota.HalfSpace()},
        {"curve": [(0.5, 1, (1, 1, 1)), (0.2, 1, (1, 1, 1))]},
        {"curve": [(0, 1, (1, 1))]},
        {"curve": [(0, 1)]},
        {"curve": [(i / 10, 1, (1, 1, 1)) for i in range(9)]},
    ):
        with pytest.raises((ValueError, TypeError)):
            system.emitter(**bad)
    assert system.validate() == []


def test_a_particle_is_made_with_its_look_and_lifetime_or_not_at_all() -> None:
    system = iota.System(gravity=(0, 0, 0))
    body = system.body()
    p = body.particle((0, 1, 0), lifetime=0.5, radius=0.1, color=(1, 0, 0), nailed=True)
    assert (p.lifetime, p.radius, p.color, p.is_nailed) == (0.5, 0.1, (1, 0, 0, 1), True)
    forever = system.body().particle(lifetime=math.inf)
    plain = system.body().particle()
    assert not plain.has_attributes and not plain.is_nailed
    before = system.state_hash()
    for wrong, text in (
        ({"lifetime": -1}, "lifetime must be finite and above 0 s, not -1"),
        ({"lifetime": math.nan}, "lifetime must be"),
        ({"radius": -0.1}, "radius must be"),
        ({"color": (2, 0, 0)}, "numbers of a color are from 0 to 1"),
    ):
        with pytest.raises(ValueError, match=text):
            plain.body.particle((1, 0, 0), **wrong)
    assert system.state_hash() == before and system.validate() == []
    for _ in range(40):
        system.step(1 / 60)
    assert not p.alive and forever.alive and plain.alive
