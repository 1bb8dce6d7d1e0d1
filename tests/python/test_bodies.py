# SPDX-License-Identifier: Apache-2.0
"""What is done to a body as a whole: its mass, forces and torques on it, its energy. Measured by where it goes."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest

import iota
from iota.frames import turned

SCALES = (1e-3, 1.0, 1e3)  # m


def box(system: iota.System, size: float = 1.0) -> iota.Body:
    return system.body(shape=iota.Box((size, 2 * size, 3 * size)), mass=6.0, position=(size, 2 * size, -size))


def lattice(system: iota.System, size: float = 1.0) -> iota.Body:
    body = system.body()
    for x, y, z, mass in ((0, 0, 0, 1.0), (1, 0, 0, 2.0), (0, 1, 0, 3.0), (0, 0, 1, 4.0), (1, 1, 1, 0.5)):
        body.particle((size * x, size * y, size * z), mass=mass)
    return body


MAKERS: dict[str, Callable[..., iota.Body]] = {"box": box, "lattice": lattice}


@pytest.mark.parametrize("size", SCALES)
@pytest.mark.parametrize("kind", MAKERS)
def test_a_force_at_the_center_moves_and_does_not_turn(kind: str, size: float) -> None:
    system = iota.System(gravity=(0, 0, 0))
    body = MAKERS[kind](system, size)
    start = np.array(body.position)
    wanted = np.array((1.0, -2.0, 0.5)) * size  # m/s^2
    for _ in range(10):
        body.apply_force(wanted * body.mass)
        system.step(0.01)
    np.testing.assert_allclose(body.velocity, wanted * 0.1, rtol=1e-9, atol=1e-12 * size)
    np.testing.assert_allclose(np.array(body.position) - start, 0.5 * wanted * 0.1**2, rtol=1e-6)
    assert abs(body.angular_velocity) < 1e-9
    system.step(0.01)
    np.testing.assert_allclose(body.velocity, wanted * 0.1, rtol=1e-9, atol=1e-12 * size)  # only while it was applied


@pytest.mark.parametrize("size", SCALES)
@pytest.mark.parametrize("kind", MAKERS)
def test_a_torque_turns_and_does_not_move(kind: str, size: float) -> None:
    system = iota.System(gravity=(0, 0, 0))
    body = MAKERS[kind](system, size)
    wanted = np.array((1e-3, 2e-3, -1e-3))  # rad/s^2: so slow that inertia stays what it is
    torque = body.inertia @ wanted
    start = body.position
    for _ in range(10):
        body.apply_torque(torque)
        system.step(0.01)
    np.testing.assert_allclose(body.angular_velocity, wanted * 0.1, rtol=1e-4)
    np.testing.assert_allclose(body.angular_momentum, torque * 0.1, rtol=1e-6)
    assert abs(body.position - start) < 1e-9 * size and abs(body.velocity) < 1e-9 * size


@pytest.mark.parametrize("kind", MAKERS)
def test_a_force_at_a_place_is_a_force_and_its_moment(kind: str) -> None:
    def after(push: Callable[[iota.Body], None]) -> tuple[np.ndarray, np.ndarray]:
        system = iota.System(gravity=(0, 0, 0))
        body = MAKERS[kind](system)
        push(body)
        system.step(1e-3)
        return np.array(body.velocity), np.array(body.angular_momentum)

    force, lever = iota.Vec3(3, -1, 2), iota.Vec3(0.2, 5.0, -0.7)
    at = after(lambda body: body.apply_force(force, at=body.position + lever))

    def apart(body: iota.Body) -> None:
        body.apply_force(force)
        body.apply_torque(lever.cross(force))

    for one, other in zip(at, after(apart), strict=True):
        np.testing.assert_allclose(one, other, rtol=1e-9)
    np.testing.assert_allclose(at[1], 1e-3 * np.cross(lever, force), rtol=1e-5)


def test_a_rod_is_turned_about_axes_with_inertia() -> None:
    system = iota.System(gravity=(0, 0, 0))
    rod = system.body()
    rod.particle((0, 0, 0))
    rod.particle((2, 0, 0))
    with pytest.raises(
        ValueError, match=r"a torque of \(1, 0, 0\) N m cannot act on body 0: its particles are at one place or"
    ):
        rod.apply_torque((1, 0, 0))
    rod.apply_torque((0, 1, 0))
    system.step(0.01)
    np.testing.assert_allclose(rod.angular_velocity, (0, 0.005, 0), rtol=1e-4, atol=1e-12)
    point = system.body().particle((9, 9, 9)).body
    point.apply_force((1, 0, 0))
    with pytest.raises(ValueError, match="at one place"):
        point.apply_torque((0, 0, 1))


def test_a_mass_is_assigned_with_the_inertia() -> None:
    system = iota.System(gravity=(0, 0, 0))
    rod = system.body()
    rod.particle((3, 0, 0))
    rod.particle((3, 1, 0))
    rod.set_rod(2.0, 0.1)
    for body in (box(system), lattice(system), rod):
        body.angular_velocity = (0, 3, 0) if body == rod else (1, 2, 3)
        inertia, spin, mass, place = body.inertia, body.angular_velocity, body.mass, body.position
        body.mass = 7 * mass
        assert body.mass == pytest.approx(7 * mass) and body.position == pytest.approx(place)
        np.testing.assert_allclose(body.inertia, 7 * inertia, rtol=1e-12, atol=1e-12)
        np.testing.assert_allclose(body.angular_velocity, spin, rtol=1e-12)
    with pytest.raises(ValueError, match="mass must be finite and above 0 kg, not 0"):
        rod.mass = 0
    assert system.validate() == []


def test_the_energy_of_a_body_is_that_of_its_motion_and_height() -> None:
    system = iota.System()
    ball = system.body(shape=iota.Sphere(0.1), mass=2, position=(0, 3, 0), velocity=(1, 0, 0), spin=(0, 10, 0))
    box(system)
    assert ball.energy.kinetic == pytest.approx(0.5 * 2 * 1 + 0.5 * 0.4 * 2 * 0.01 * 100)
    assert ball.energy.potential == pytest.approx(2 * 9.81 * 3)
    total = sum(body.energy.total for body in system.bodies)
    assert total == pytest.approx(system.energy.total)


def test_a_name_is_kept_with_the_body() -> None:
    system = iota.System()
    one, other = box(system), lattice(system)
    assert one.name == ""
    one.name, other.name = "Tür", "other"
    snapshot = system.snapshot()
    one.name = ""
    system.restore(snapshot)
    assert one.name == "Tür"
    one.combine(other)
    assert one.name == "Tür" and system.validate() == []
    with pytest.raises(ValueError, match="the name of a body must be shorter than 64 bytes, got 99"):
        one.name = "x" * 99
    one.destroy()
    assert system.validate() == [] and box(system).name == ""


def test_edits_of_bodies_are_recorded_and_undone() -> None:
    system = iota.System()
    body = box(system)
    before = system.state_hash()
    with system.edit():
        body.mass, body.position, body.orientation = 5.0, (1, 1, 1), (0, 0, 1, 1)
    system.undo()
    assert system.state_hash() == before
    system.start_recording()
    for _ in range(3):
        body.apply_force((1, 2, 3), at=(5, 5, 5))
        body.apply_torque((3, 2, 1))
        body.mass = 1.1 * body.mass
        system.step(1 / 60)
    assert system.replay(system.stop_recording()) is None


def test_several_steps_are_one_call_with_one_report() -> None:
    def pendulum() -> iota.System:
        system = iota.System()
        iota.builder.chain(links=5, top=(0, 2, 0), direction=(1, 0, 0)).realize(system)
        return system

    one, many = pendulum(), pendulum()
    report = many.step(1 / 60, count=30)
    singles = [one.step(1 / 60) for _ in range(30)]
    assert one.state_hash() == many.state_hash()
    assert report.step == 30 and report.time == pytest.approx(0.5) and report.dt == pytest.approx(0.5)
    assert report.fallbacks == sum(r.fallbacks for r in singles)
    assert report.worst_gap == max(r.worst_gap for r in singles)
    assert report.iterations_mean == pytest.approx(math.fsum(r.iterations_mean for r in singles) / 30)
    with pytest.raises(ValueError, match="count must be at least 1, not 0"):
        one.step(count=0)


def test_steps_in_a_row_end_with_the_one_whose_force_fails() -> None:
    system = iota.System()
    p, q = (system.body().particle((x, 0, 0)) for x in (0, 1))

    def fails(bond: iota.types.BondState) -> tuple[float, float, float]:
        if bond.time > 0.045:
            raise RuntimeError("enough")
        return (0, 0, 0)

    system.bond(p, q, fails)
    with pytest.raises(iota.BondError, match="enough") as raised:
        system.step(0.01, count=100)
    assert system.step_count == raised.value.report.step == 6


def test_a_large_body_that_grows_point_by_point_has_the_inertia_and_motion_of_all_its_points() -> None:
    """From 64 points on a new one is tied to the body's basis, which is chosen anew only where it spans too little."""
    random = np.random.default_rng(1)
    places = random.normal(size=(300, 3))
    places[:70] *= 0.01  # at first the basis spans little
    masses = random.uniform(0.5, 1.5, 300)
    system = iota.System(gravity=(0, 0, 0))
    body = system.body()
    middle = masses @ places / masses.sum()
    for place, mass in zip(places, masses, strict=True):
        body.particle(place, mass, np.cross((0.3, -1.0, 0.5), place - middle))
    assert system.validate() == []
    arms = places - middle
    inertia = np.einsum("i,ij,ij->", masses, arms, arms) * np.eye(3) - np.einsum("i,ij,ik->jk", masses, arms, arms)
    assert body.inertia == pytest.approx(inertia, rel=1e-12)
    momentum = inertia @ (0.3, -1.0, 0.5)
    for _ in range(60):
        system.step(1 / 120)
    assert tuple(body.angular_momentum) == pytest.approx(tuple(momentum), rel=1e-9)
    now = np.array([tuple(particle.position) for particle in body.particles])
    for other in (1, 100, 299):
        apart = np.linalg.norm(now - now[other], axis=1)
        assert apart == pytest.approx(np.linalg.norm(places - places[other], axis=1), abs=1e-9)


def test_a_body_of_one_particle_or_of_points_in_one_place_has_no_angular_velocity() -> None:
    system = iota.System(gravity=(0, 0, 0))
    for count in (1, 3):
        body = system.body()
        for _ in range(count):
            body.particle((0.1, 0.7, -3.3), mass=0.37, velocity=(1, 2, 3))
        for _ in range(20):
            system.step()
            assert body.angular_velocity == (0, 0, 0)


@pytest.mark.parametrize("place", [(0.0, 0.0, 0.0), (0.3, -0.1, 0.2)])
def test_an_attachment_of_a_scripted_body_goes_as_far_as_the_body(place: tuple[float, float, float]) -> None:
    """In the first move it went twice as far, and stayed so far away."""
    system = iota.System()
    lift = system.body("scripted", shape=iota.Box((2, 0.2, 2)), mass=9, attachments=[place])
    mark = lift.attachments[0]
    for step in range(4):
        lift.set_pose((0.1 * step, 0, 0), ("y", 10 * step))
        system.step()
        wanted = lift.position + turned(lift.orientation, iota.Vec3(*place))
        assert abs(mark.position - wanted) < 1e-9 and abs(lift.position.x - 0.1 * step) < 1e-9


def test_scripted_and_static_bodies_take_no_velocity_as_their_places_are_set() -> None:
    system = iota.System()
    table = system.body("scripted", shape=iota.Box((1, 1, 1)))
    with pytest.raises(ValueError, match="a scripted body goes where its places are set"):
        table.velocity = (1, 0, 0)
    with pytest.raises(ValueError, match="angular velocity: a scripted body"):
        table.angular_velocity = (1, 0, 0)
    with pytest.raises(ValueError, match="a static body does not move"):
        system.body("static", shape=iota.Box((1, 1, 1))).velocity = (1, 0, 0)
    table.velocity = (0, 0, 0)
    system.velocities = system.velocities
