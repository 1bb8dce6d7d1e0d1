# SPDX-License-Identifier: Apache-2.0
"""Many things made, read and changed in one call are what they are one by one."""

from __future__ import annotations

import time
from collections.abc import Callable

import numpy as np
import pytest

import iota

RNG = np.random.default_rng(7)


def test_particles_of_an_array_are_those_of_a_loop() -> None:
    places, speeds, masses = RNG.normal(size=(20, 3)), RNG.normal(size=(20, 3)), RNG.uniform(1, 2, 20)
    many, one = iota.System(), iota.System()
    grains = many.particle_array(places, masses=masses, velocities=speeds)
    for place, speed, mass in zip(places, speeds, masses, strict=True):
        one.body().particle(place, mass=mass, velocity=speed)
    assert len(grains) == 20 and grains[3] == many.particles[3] and grains[-1] == many.particles[19]
    assert [p.slot for p in grains[4:10:2]] == [4, 6, 8]
    np.testing.assert_array_equal(grains.positions, places)
    np.testing.assert_array_equal(grains.masses, masses)
    many.step(0.01), one.step(0.01)
    np.testing.assert_array_equal(many.positions, one.positions)
    np.testing.assert_array_equal(many.velocities, one.velocities)
    grains.velocities = np.zeros((20, 3))
    grains.apply_forces(np.tile((1.0, 0, 0), (20, 1)))
    many.step(0.01)
    np.testing.assert_allclose(grains.velocities[:, 0], 0.01 / masses)
    np.testing.assert_allclose(grains.forces[:, 0], np.ones(20), rtol=1e-9)


def test_a_chain_of_rods_is_made_of_arrays() -> None:
    places = np.column_stack([np.linspace(0, 5, 51), np.zeros(51), np.zeros(51)])
    system = iota.System()
    links = system.rod_array(places[:-1], places[1:], masses=0.1, radii=0.01)
    ends = links.particles
    report = ends[1:-1:2].combine(ends[2::2])
    assert report.articulates_before == 50 and report.articulates_after == 1
    ends[0].nail()
    np.testing.assert_allclose(links.masses, np.full(50, 0.1))
    for _ in range(20):
        assert system.step(1 / 60).worst_gap < 1e-8
    np.testing.assert_allclose(links.positions, [b.position for b in system.bodies])
    np.testing.assert_allclose(links.angular_velocities, [b.angular_velocity for b in system.bodies])
    assert system.validate() == []


def test_bonds_of_an_array_have_parameters_of_their_own() -> None:
    system = iota.System(gravity=(0, 0, 0))
    knots = system.particle_array([(0, 0, 0), (1, 0, 0), (3, 0, 0), (6, 0, 0)])
    springs = system.bond_array(knots[:-1], knots[1:], "spring", stiffness=[10, 20, 30], length=0.5)
    np.testing.assert_array_equal(springs.distances, [1, 2, 3])
    np.testing.assert_allclose(np.abs(springs.forces[:, 0]), [10 * 0.5, 20 * 1.5, 30 * 2.5])
    springs.set(stiffness=1.0, length=[1, 1, 1])
    np.testing.assert_array_equal(springs.parameter("stiffness"), [1, 1, 1])
    np.testing.assert_allclose(np.abs(springs.forces[:, 0]), [0, 1, 2])
    assert system.bonds[2].parameters["length"] == 1
    with pytest.raises(ValueError, match="a spring needs stiffness"):
        system.bond_array(knots[:-1], knots[1:], "spring")
    before = system.state_hash()
    with pytest.raises(ValueError, match="row 1: stiffness"):
        system.bond_array(knots[:-1], knots[1:], "spring", stiffness=[1, -1, 1])
    with pytest.raises(ValueError, match="row 2: a bond needs two particles"):
        system.bond_array([knots[0], knots[1], knots[2]], [knots[1], knots[2], knots[2]], "spring", stiffness=1)
    assert system.state_hash() == before


def test_bodies_are_read_and_put_back_by_arrays() -> None:
    system = iota.System()
    for i in range(4):
        system.body(
            shape=iota.Box((1, 2, 3)), position=(5 * i, 0, 0), orientation=RNG.normal(size=4), spin=RNG.normal(size=3)
        )
    iota.builder.chain(links=3, top=(0, 9, 0), direction=(1, 0, 0)).realize(system)
    bodies = system.array(system.bodies)
    system.step(1 / 60, count=10)
    poses, motions = bodies.poses, bodies.motions
    for body, pose, motion in zip(system.bodies, poses, motions, strict=True):
        np.testing.assert_allclose(np.hstack([body.position, body.orientation]), pose)
        np.testing.assert_allclose(np.hstack([body.velocity, body.angular_velocity]), motion)
    system.step(1 / 60, count=30)
    assert not np.allclose(bodies.positions, poses[:, :3])
    bodies.poses, bodies.motions = poses, motions
    np.testing.assert_allclose(bodies.positions, poses[:, :3], atol=1e-9)
    np.testing.assert_allclose(bodies.motions[:4], motions[:4], atol=1e-9)
    # Of links, velocities after a step are those of rigid bodies on the average of two steps only.
    np.testing.assert_allclose(bodies.motions, motions, atol=1e-2)
    np.testing.assert_allclose(np.abs(np.sum(bodies.orientations * poses[:, 3:], axis=1)), 1, atol=1e-9)
    free = bodies[:4]
    free.positions, free.velocities = poses[:4, :3] + 1, np.zeros((4, 3))
    free.orientations, free.angular_velocities = np.tile((0, 0, 0, 2.0), (4, 1)), np.zeros((4, 3))
    np.testing.assert_allclose(free.poses[:, :3], poses[:4, :3] + 1, atol=1e-12)
    np.testing.assert_allclose(np.abs(free.orientations), np.tile((0, 0, 0, 1.0), (4, 1)), atol=1e-12)
    np.testing.assert_allclose(free.motions, np.zeros((4, 6)), atol=1e-12)
    assert system.step(1 / 60).worst_gap < 1e-8 and system.validate() == []


def test_torques_and_forces_of_an_array_are_those_of_each_body() -> None:
    def moved(use_array: bool) -> np.ndarray:
        system = iota.System(gravity=(0, 0, 0))
        for i in range(3):
            system.body(shape=iota.Box((1, 2, 3)), position=(5 * i, 0, 0), mass=1 + i)
        bodies = system.array(system.bodies)
        forces, torques = np.arange(9.0).reshape(3, 3), np.arange(9.0)[::-1].reshape(3, 3).copy()
        if use_array:
            bodies.apply_forces(forces), bodies.apply_torques(torques)
        else:
            for body, force, torque in zip(system.bodies, forces, torques, strict=True):
                body.apply_force(force), body.apply_torque(torque)
        system.step(0.01)
        return np.hstack([bodies.velocities, bodies.angular_velocities, bodies.forces])

    np.testing.assert_allclose(moved(True), moved(False), rtol=1e-12)
    np.testing.assert_allclose(moved(True)[:, 6:], np.arange(9.0).reshape(3, 3), rtol=1e-6, atol=1e-9)


def test_a_wrong_array_is_named_and_nothing_is_changed() -> None:
    system = iota.System()
    grains = system.particle_array(np.zeros((3, 3)))
    before = system.state_hash()
    for call, text in (
        (lambda: setattr(grains, "positions", np.zeros((2, 3))), r"positions must have the shape \(3, 3\), a row for each, not \(2, 3\)"),
        (lambda: setattr(grains, "masses", np.zeros((3, 3))), r"masses must have the shape \(3,\)"),
        (lambda: setattr(grains, "masses", [1, 2, -1]), "row 2: mass"),
        (lambda: setattr(grains, "velocities", [(0, 0, 0), (0, np.nan, 0), (0, 0, 0)]), "velocities must be finite; row 1 is not"),
        (lambda: setattr(grains, "positions", [(0, 0, 0), (0, 1e300, 0), (0, 0, 0)]), "row 1: position must have no component"),
        (lambda: system.particle_array([1, 2, 3]), r"positions must have the shape \(3, 3\)"),
        (lambda: system.particle_array(np.zeros((2, 3)), masses=[1, 2, 3]), r"masses must have the shape \(2,\)"),
        (lambda: system.rod_array(np.zeros((2, 3)), np.zeros((2, 3))), "row 0: the length of a rod"),
        (lambda: system.array([grains[0], grains[0].body]), "handles of one kind"),
        (lambda: system.array([]), "at least one"),
        (lambda: grains.combine(grains[:2]), "a row for each of 3, got 2"),
        (lambda: grains[7], "there are 3, and no number 7"),
    ):  # fmt: skip
        with pytest.raises((ValueError, TypeError, IndexError), match=text):
            call()
        assert system.state_hash() == before, text
    grains[1].destroy()
    with pytest.raises(iota.StaleIdError, match="particle 1 is gone"):
        _ = grains.positions


def test_arrays_are_recorded_as_they_are() -> None:
    system = iota.System()
    system.start_recording()
    grains = system.particle_array(RNG.normal(size=(50, 3)), masses=0.1)
    system.bond_array(grains[:-1], grains[1:], "spring", stiffness=RNG.uniform(1, 9, 49), length=None)
    links = system.rod_array([(0, 5, 0), (1, 5, 0)], [(1, 5, 0), (2, 5, 0)])
    links.particles[1:2].combine(links.particles[2:3])
    for _ in range(3):
        grains.apply_forces(RNG.normal(size=(50, 3)))
        links.apply_forces(RNG.normal(size=(2, 3)))
        system.step(1 / 60)
    links.masses, links.velocities = [2, 3], np.zeros((2, 3))
    system.step(1 / 60)
    assert system.replay(system.stop_recording()) is None


def test_a_hundred_thousand_take_a_moment() -> None:
    """A tenth of a second each on a free core; of the processor's time here, and twice that for slower ones."""

    def seconds(call: Callable[[], object]) -> float:
        best = np.inf
        for _ in range(3):
            start = time.process_time()
            call()
            best = min(best, time.process_time() - start)
        return best

    n = 100_000
    places = RNG.uniform(size=(n + 1, 3))
    assert seconds(lambda: iota.System().particle_array(places[:n], masses=1e-3)) < 0.2
    assert seconds(lambda: iota.System().rod_array(places[:-1], places[1:], masses=1e-3)) < 0.2
    system = iota.System()
    grains = system.particle_array(places)
    assert seconds(lambda: system.bond_array(grains[:-1], grains[1:], "spring", stiffness=1.0)) < 0.2
    assert seconds(lambda: setattr(grains, "positions", grains.positions)) < 0.2


def test_an_array_is_a_sequence_of_its_members() -> None:
    system = iota.System()
    rods = system.rod_array([(0, 0, 0), (1, 0, 0)], [(0, 1, 0), (1, 1, 0)])
    assert list(rods) == system.bodies and list(rods.particles) == system.particles
    world = iota.World(system)
    world.draw(rods, iota.looks.cylinder(0.02, "steel"))
    assert all(world.scene.look_of(rod) is not None for rod in system.bodies)
