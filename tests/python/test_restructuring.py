# SPDX-License-Identifier: Apache-2.0
from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest

import iota


def names(bodies: list[list[iota.Body]]) -> list[list[int]]:
    return sorted(sorted(body.slot for body in part) for part in bodies)


@pytest.fixture
def space() -> iota.System:
    return iota.System(gravity=(0, 0, 0))


def rod(system: iota.System, x: float, y: float = 0.0) -> tuple[iota.Particle, iota.Particle]:
    body = system.body()
    return body.particle((x, y, 0)), body.particle((x + 1, y, 0))


def test_combine_makes_a_hinge_of_particles_of_unrelated_bodies(space: iota.System) -> None:
    (_, p), (q, _) = rod(space, 0), rod(space, 1)
    report = p.combine(q)
    assert report and report.changed and not report.queued
    assert set(p.ring) == {p, q} and p.body != q.body
    assert names(space.articulates) == [[0, 1]] and space.articulate_count == 1
    assert (report.articulates_before, report.articulates_after) == (2, 1)
    assert report.structure_version == space.structure_version


def test_combine_again_makes_the_hinge_rigid_and_absorbs_the_body(space: iota.System) -> None:
    (a, p), (q, b) = rod(space, 0), rod(space, 1)
    first, second = p.body, q.body
    p.combine(q)
    report = p.combine(q)
    assert report.absorbed_bodies == [(second, first)]
    assert not second.alive and second.survivor == first
    assert b.body == a.body == first
    assert space.validate() == []


def test_combine_of_one_particle_with_itself_does_nothing(space: iota.System) -> None:
    p, _ = rod(space, 0)
    version = space.structure_version
    assert not p.combine(p)
    assert space.structure_version == version


def test_combine_in_one_body_absorbs_the_second_particle(space: iota.System) -> None:
    p, q = rod(space, 0)
    report = p.combine(q)
    assert report.absorbed_particles == [(q, p)]
    assert q.survivor == p and p.body.particles == [p] and p.mass == 2


def test_combine_brings_particles_together_that_are_apart(space: iota.System) -> None:
    (_, p), (q, _) = rod(space, 0), rod(space, 1.5, 0.5)
    report = p.combine(q)
    assert report.closed_distance == pytest.approx(0.5**0.5 * 1.0, rel=1e-9)
    assert report.remaining_gap < 1e-9
    assert p.position == q.position
    assert abs(space.momentum) < 1e-12 and space.step().worst_gap < 1e-9


def test_combine_over_a_time_closes_smoothly(space: iota.System) -> None:
    (_, p), (q, _) = rod(space, 0), rod(space, 1.5, 0.5)
    p.combine(q, over=0.5)
    assert space.closing_count == 1
    gaps = []
    for _ in range(66):
        space.step()
        gaps.append(abs(p.position - q.position))
    assert space.closing_count == 0 and gaps[-1] == 0
    assert all(late <= early + 1e-12 for early, late in pairwise(gaps))
    assert 0.05 < gaps[len(gaps) // 2] < 0.65


@pytest.mark.parametrize("mode", ["energy_keeping", "robust"])
@pytest.mark.parametrize("last", [0.05, 0.2, 0.5, 1.0])  # of a step: the part of the last one that the closing takes
def test_the_end_of_a_slow_combine_makes_no_energy(mode: str, last: float) -> None:
    system = iota.System(mode=mode, damping=2)
    links = iota.builder.chain(24, 1.8, top=(0, 0, 0), direction=(0.01, -1, 0.007)).realize(system).bodies
    above, below = links[4].particles[-1], links[5].particles[0]
    above.separate(below)
    dt = 1 / 60
    system.step(dt, count=30)
    above.combine(below, over=(round(abs(above.position - below.position) / (1.5 * dt)) - 1 + last) * dt)
    while system.closing_count:
        assert system.step(dt).energy.made == 0


@pytest.mark.parametrize("mode", ["energy_keeping", "robust"])
def test_a_slow_combine_over_a_gap_of_any_size_leaves_the_motion_alone(mode: str) -> None:
    energies = []
    for gap in [0, *10.0 ** -np.arange(4, 13)]:
        system = iota.System(mode=mode)
        upper = iota.builder.chain(8, 0.8, top=(0, 0, 0), direction=(0.3, -0.9, 0.1)).realize(system).bodies
        end = upper[-1].particles[-1]
        top = np.array(tuple(end.position)) + gap * np.array((0.6, 0.8, 0))
        lower = iota.builder.chain(8, 0.8, top=tuple(top), direction=(-0.3, -0.9, 0.1)).realize(system).bodies
        lower[0].particles[0].release()
        end.combine(lower[0].particles[0], over=0.1)
        for _ in range(12):
            report = system.step(0.01)
            assert report.unconverged == 0, f"a gap of {gap:g} m"
        energies.append(report.energy.kinetic)
    assert energies == pytest.approx([energies[0]] * len(energies), rel=0.02)


@pytest.mark.parametrize("mode", ["energy_keeping", "robust"])
def test_a_hinge_breaks_at_the_force_that_it_reports_while_a_particle_of_it_closes(mode: str) -> None:
    def close(break_force: float, steps: int) -> tuple[float, list[float]]:
        system = iota.System(mode=mode)
        left = iota.builder.chain(3, 0.3, top=(0, 0, 0), direction=(0.3, -0.9, 0.1)).realize(system).bodies
        right = iota.builder.chain(3, 0.3, top=(0.5, 0, 0), direction=(-0.3, -0.9, 0.1)).realize(system).bodies
        hinge = left[1].particles[1]
        hinge.break_force = break_force
        left[2].particles[0].combine(right[2].particles[1], over=0.1)
        for _ in range(steps):
            system.step(0.01)
        return abs(hinge.hinge_force), [broken.force for broken in system.broken]

    for steps in (5, 8, 10):
        force, unbroken = close(math.inf, steps)
        _, broken = close(0.999 * force, steps)
        assert unbroken == [] and broken == pytest.approx([force], rel=1e-6)


def test_combine_of_bodies_makes_one_rigid_body_in_place(space: iota.System) -> None:
    (a, _), (c, d) = rod(space, 0), rod(space, 3, 1)
    report = a.body.combine(c.body)
    assert report.absorbed_bodies[0][1] == a.body == c.body == d.body
    assert c.position == pytest.approx((3, 1, 0))
    a.velocity = (0, 0, 1)
    for _ in range(60):
        space.step()
    assert abs(abs(a.position - d.position) - 17**0.5) < 1e-9, "distances stay"


def test_separate_undoes_a_hinge(space: iota.System) -> None:
    (_, p), (q, _) = rod(space, 0), rod(space, 1)
    p.combine(q)
    report = p.separate(q)
    assert report.changed and (report.articulates_before, report.articulates_after) == (1, 2)
    assert p.ring == [p] and q.ring == [q]


def test_separate_of_unrelated_particles_does_nothing(space: iota.System) -> None:
    (_, p), (q, _) = rod(space, 0), rod(space, 1)
    assert not p.separate(q)


def test_separate_of_one_particle_makes_a_second_one_of_half_the_mass(space: iota.System) -> None:
    p, _ = rod(space, 0)
    report = p.separate(p)
    (twin,) = report.created_particles
    assert twin.position == p.position and twin.mass == p.mass == 0.5


def test_separate_in_one_body_makes_the_second_a_body_hinged_to_the_first(space: iota.System) -> None:
    p, q = rod(space, 0)
    p.body.particle((0, 1, 0))
    report = p.separate(q)
    assert report.created_bodies == [q.body] and q.body != p.body
    assert q in p.ring


def test_a_cut_chain_falls_and_conserves_momentum(system: iota.System, chain: list[iota.Body]) -> None:
    for _ in range(30):
        system.step()
    before = system.momentum, system.energy.total
    chain[2].particles[1].separate(chain[3].particles[0])
    assert abs(system.momentum - before[0]) < 1e-12 and system.energy.total == pytest.approx(before[1])
    assert names(system.articulates) == [[0, 1, 2], [3, 4, 5]]
    height = chain[4].center_of_mass.y
    for _ in range(60):
        system.step()
    assert chain[4].center_of_mass.y < height - 1.0
    assert chain[0].particles[0].position == pytest.approx((0, 2, 0))


def test_a_nail_holds_moves_and_lets_go(system: iota.System) -> None:
    particle = system.body().particle((0, 1, 0), mass=2)
    particle.nail()
    system.step()
    assert particle.is_nailed and particle.position == pytest.approx((0, 1, 0))
    assert particle.nail_force == pytest.approx((0, 2 * 9.81, 0))
    particle.nail((1, 1, 0))
    system.step()
    assert particle.position == pytest.approx((1, 1, 0))
    particle.release()
    system.step()
    assert not particle.is_nailed


def test_two_grips_pull_with_the_sum_of_their_forces(space: iota.System) -> None:
    speeds = []
    for count in (1, 2):
        system = iota.System(gravity=(0, 0, 0))
        body = system.body()
        body.particle()
        grips = [system.grip(body, target=(0.05, 0, 0), hold=i) for i in range(count)]
        system.step()
        speeds.append(system.momentum.x)
        grips[0].destroy()
        assert not grips[0].alive
    assert speeds[1] == pytest.approx(2 * speeds[0], rel=0.2) and speeds[0] > 0


def test_static_bodies_stay_and_scripted_ones_go_where_they_are_put(system: iota.System) -> None:
    bodies = [system.body(kind=kind) for kind in ("static", "scripted", "inactive", "dynamic")]
    particles = [body.particle((0, 1, 0)) for body in bodies]
    for _ in range(10):
        particles[1].position += (0.01, 0, 0)
        system.step()
    static, scripted, inactive, dynamic = particles
    assert static.position == inactive.position == (0, 1, 0)
    assert scripted.position == pytest.approx((0.1, 1, 0))
    assert dynamic.position.y < 1


def test_a_chain_of_rods_keeps_its_inertia() -> None:
    """A rod that turns about its end swings slower than two point masses at its ends would."""
    lows = []
    for rods in (False, True):
        system = iota.System()
        (link,) = (
            iota.builder.chain(links=1, length=1.0, top=(0, 0, 0), direction=(1, 0, 0), rods=rods)
            .realize(system)
            .bodies
        )
        for _ in range(24):
            system.step()
        lows.append(link.particles[1].position.y)
    # 3/2 g against g for the angular acceleration at the start.
    assert lows[1] / lows[0] == pytest.approx(1.5, rel=0.03)


def test_an_articulate_is_the_presently_connected_bodies(system: iota.System, chain: list[iota.Body]) -> None:
    whole = chain[0].articulate
    assert list(whole) == chain and len(whole) == 6 and chain[5] in whole and whole == chain[3].articulate
    chain[2].particles[1].separate(chain[3].particles[0])
    assert whole.bodies == chain[:3] and chain[5] not in whole and whole != chain[3].articulate
    assert [len(part) for part in system.articulates] == [3, 3]
    whole.active = False
    assert [body.active for body in chain] == [False] * 3 + [True] * 3 and not whole.active
    with pytest.raises(TypeError):
        hash(whole)


def test_a_combine_may_keep_the_first_where_it_is(system: iota.System) -> None:
    (p, _), (q, end) = rod(system, 0, 0), rod(system, 0.3, 4)
    report = p.combine(q, keep="first")
    assert p.position == q.position == (0, 0, 0) and report.closed_distance == pytest.approx(math.hypot(0.3, 4))
    assert end.position == pytest.approx((1, 0, 0))
    (r, s) = rod(system, 5, 0)
    s.nail()
    with pytest.raises(ValueError, match="particle 4 cannot be brought to particle 0: particle 5 is nailed"):
        p.combine(r, keep="first")
    r.combine(p, keep="first")
    assert r.position == (5, 0, 0)
    (left, right) = rod(system, 9, 0)
    right.combine(left.body.system.bodies[-1].particles[0])
    for bad, text in (
        ({"keep": "last"}, "'both' or 'first', not 'last'"),
        ({"keep": "first", "over": 1}, "over must be 0"),
    ):
        with pytest.raises(ValueError, match=text):
            r.combine(left, **bad)


def test_an_obstacle_is_of_an_articulate_without_bodies_and_bodies_of_one_are_in_order() -> None:
    system = iota.System()
    rods = [system.body() for _ in range(5)]
    ends = [[rod.particle((k + side, 0, 0)) for side in (0, 1)] for k, rod in enumerate(rods)]
    for k in (3, 0, 2, 1):  # not in order
        ends[k][1].combine(ends[k + 1][0])
    assert rods[2].articulate.bodies == rods and len(rods[4].articulate) == 5
    assert system.obstacle(iota.Box((1, 1, 1)), (0, 9, 0)).articulate.bodies == []


def test_a_rod_beside_a_closing_that_cannot_be_met_is_a_conflict_and_no_error() -> None:
    """The rod's ends follow one point once the particle that was pulled off it goes back to its body."""
    system = iota.System()
    body = system.body()
    near, far = body.particle((0, 0, 0)), body.particle((1, 0, 0))
    hinged = system.body()
    other = hinged.particle((0, 0, 0))
    hinged.particle((-0.3, 1, 0))
    near.combine(other)
    point = system.body().particle((1, 0, 0))
    far.combine(point)
    twin = point.separate(point).created_particles[0]
    twin.combine(other, over=0.14)  # which are 1 m apart in one rigid body
    assert system.step(1 / 60).unconverged == 1
    system.rod(twin, far)
    for _ in range(40):
        system.step(1 / 240)
    assert np.isfinite(system.positions).all()
