# SPDX-License-Identifier: Apache-2.0
"""Groups, fields and pairwise forces from a script."""

from __future__ import annotations

import ctypes
import gc
import math
import weakref
from typing import Any

import numpy as np
import pytest

import iota


@pytest.fixture
def space() -> iota.System:
    return iota.System(gravity=(0, 0, 0))


def scatter(system: iota.System, count: int, speed: float = 0.0) -> list[iota.Particle]:
    random = np.random.default_rng(1)
    return [
        system.body().particle(place, velocity=tuple(velocity))
        for place, velocity in zip(
            random.uniform(-1, 1, (count, 3)), speed * random.normal(size=(count, 3)), strict=True
        )
    ]


def test_wind_carries_the_particles_of_its_group_only(space: iota.System) -> None:
    still, *leaves = scatter(space, 3)
    group = space.group("leaves")
    group.add(*leaves)
    wind = space.field("wind", velocity=(3, 0, 0), drag=1000, group=group)
    space.step(0.1)
    assert still.velocity == (0, 0, 0) and leaves[0].velocity == pytest.approx((3, 0, 0))
    wind.set(velocity=(0, 2, 0))
    space.step(0.1)
    assert leaves[0].velocity == pytest.approx((0, 2, 0))
    assert wind.parameters == {"velocity_x": 0, "velocity_y": 2, "velocity_z": 0, "drag": 1000}
    group.remove(leaves[0])
    assert leaves[0] not in group and leaves[1] in group and len(group) == 1 and group.particles == [leaves[1]]
    assert "leaves" in repr(group)


def test_a_current_is_turbulent_and_repeats(space: iota.System) -> None:
    ends = []
    for _ in range(2):
        system = iota.System(gravity=(0, 0, 0))
        scatter(system, 50)
        system.field("current", velocity=(0.2, 0, 0), speed=1, size=0.5, drag=5, seed=4)
        for _ in range(50):
            system.step(0.02)
        ends.append(system.positions)
    np.testing.assert_array_equal(ends[0], ends[1])
    assert np.std(system.velocities) > 0.2


@pytest.mark.parametrize(
    ("field", "arguments"),
    [
        ("well", {"strength": 1.0, "softening": 0.0}),
        ("r = sqrt(x^2 + y^2 + z^2); fx = -m*k*x/r^3; fy = -m*k*y/r^3; fz = -m*k*z/r^3", {"k": 1.0}),
        (lambda b: -b.mass[:, None] * b.position / np.linalg.norm(b.position, axis=1)[:, None] ** 3, {}),
    ],
)
def test_a_well_holds_an_orbit_however_it_is_written(space: iota.System, field: Any, arguments: Any) -> None:
    planet = space.body().particle((1, 0, 0), mass=2, velocity=(0, 1, 0))
    space.field(field, **arguments)
    for _ in range(1000):
        space.step(2 * math.pi / 1000)
    assert planet.position == pytest.approx((1, 0, 0), abs=1e-3)


def test_a_field_can_replace_gravity() -> None:
    system = iota.System()
    ball = system.body().particle()
    link = iota.builder.chain(links=3).realize(system).bodies[0]
    start = abs(system.momentum)
    field = system.field("fy = 0", replaces_gravity=True)
    system.step(0.1)
    assert ball.velocity == (0, 0, 0) and abs(system.momentum) == pytest.approx(start) and link.alive
    field.active = False
    system.step(0.1)
    assert ball.velocity.y == pytest.approx(-0.981)


def test_a_function_sees_arrays_in_the_order_of_its_particles(space: iota.System) -> None:
    particles = scatter(space, 5)
    group = space.group("some")
    group.add(*particles[1:4])
    seen: list[Any] = []

    def push(batch: iota.types.ParticleBatch) -> np.ndarray:
        seen.extend([len(batch), batch.particles, batch.mass, batch.time, batch.dt, batch])
        return np.outer(np.arange(len(batch)), [1, 0, 0])

    space.field(push, group=group)
    space.step(0.5)
    assert seen[0] == 3 and seen[1] == particles[1:4] and seen[2].tolist() == [1, 1, 1] and seen[3:5] == [0.25, 0.5]
    assert [p.velocity.x for p in particles] == pytest.approx([0, 0, 0.5, 1, 0])
    with pytest.raises(RuntimeError, match="valid only until"):
        len(seen[5])


def test_a_field_may_be_the_gradient_of_an_energy_which_is_then_kept(space: iota.System) -> None:
    particle = space.body().particle((1, 0.5, -0.3), mass=2, velocity=(0, 1, 0))
    spring = space.field("energy = 0.5*k*(x^2 + y^2) + m*g*z; fz = -c*vz", k=8, g=3, c=0)
    assert space.energy.potential == pytest.approx(4 * (1 + 0.25) - 2 * 3 * 0.3)
    start = space.energy
    for _ in range(round(2 * math.pi / 2 / 0.005)):  # omega = 2: one turn
        report = space.step(0.005)
        assert report.energy.total == pytest.approx(start.total, rel=1e-4)
        assert report.energy.total - report.energy.external_work == pytest.approx(start.total, abs=1e-10)
    assert particle.position.x == pytest.approx(1, abs=1e-3)
    assert particle.position.z == pytest.approx(-0.3 - 3 * space.time**2 / 2, abs=1e-9)
    spring.set(c=1)
    space.step(0.005)
    assert space.energy.external_work < -0.01, "what the rest of the field takes"
    with pytest.raises(ValueError, match="an energy cannot depend on a velocity"):
        space.field("energy = x*vy")
    with pytest.raises(ValueError, match="a field defines 'energy'"):
        space.field("force = x")


def test_a_field_can_be_compiled_code(space: iota.System) -> None:
    scatter(space, 3)
    doubles = ctypes.POINTER(ctypes.c_double)

    @ctypes.CFUNCTYPE(None, ctypes.c_int64, ctypes.c_double, doubles, doubles, doubles, doubles)
    def push(count: int, time: float, position: Any, velocity: Any, mass: Any, force: Any) -> None:
        np.ctypeslib.as_array(force, (count, 3))[:] = [1, 2, 3]

    space.field(push)
    space.step(0.5)
    np.testing.assert_allclose(space.velocities, [[0.5, 1, 1.5]] * 3)


def test_hinged_particles_are_one_row_with_all_their_mass(space: iota.System) -> None:
    bodies = iota.builder.chain(links=4).realize(space).bodies
    rows: list[int] = []
    masses: list[float] = []

    def look(batch: iota.types.ParticleBatch) -> np.ndarray:
        rows.append(len(batch))
        masses.append(batch.mass.sum())
        return np.zeros((len(batch), 3))

    space.field(look)
    space.step()
    assert rows == [5] and masses[0] == pytest.approx(sum(p.mass for body in bodies for p in body.particles))


@pytest.mark.parametrize(
    ("function", "cause", "text"),
    [
        (lambda b: 1 / 0, ZeroDivisionError, "division by zero"),
        (lambda b: np.zeros(3), ValueError, r"must have the shape \(2, 3\), one row a particle, not \(3,\)"),
        (lambda b: b.particles[0].system.body(), RuntimeError, "not possible"),
    ],
)
def test_a_field_that_fails_is_named_and_switched_off(space: iota.System, function: Any, cause: Any, text: str) -> None:
    scatter(space, 2)
    field = space.field(function, name="gusts")
    with pytest.raises(iota.ForceError, match=text) as caught:
        space.step()
    assert str(caught.value).startswith("field gusts was switched off") and isinstance(caught.value.__cause__, cause)
    assert not field.active and caught.value.report.step == 1
    space.step()


def test_a_field_without_a_finite_force_warns_in_the_report(space: iota.System) -> None:
    space.body().particle()
    space.field("fx = 1/x", name="pole")
    assert space.step().warnings == ["field 0 (pole) gives no finite force on particle 0; there it gives none"]


def test_pairwise_forces_by_name_and_by_expression_are_the_same() -> None:
    ends = []
    for law, arguments in (
        ("lennard_jones", {"depth": 1, "size": 0.2}),
        ("energy = 4*e*((s/r)^12 - (s/r)^6)", {"e": 1, "s": 0.2}),
    ):
        system = iota.System(gravity=(0, 0, 0))
        for i in range(64):
            system.body().particle((0.24 * (i % 4), 0.24 * (i // 4 % 4), 0.24 * (i // 16)))
        pairs = system.pair_force(law, cutoff=2, **arguments)
        start = pairs.energy
        for _ in range(100):
            system.step(0.001)
        ends.append(system.positions)
        assert system.energy.kinetic + pairs.energy == pytest.approx(start, rel=1e-2)
        assert abs(system.momentum) < 1e-12
    np.testing.assert_allclose(ends[0], ends[1], rtol=0, atol=1e-10)


def test_a_flock_aligns(space: iota.System) -> None:
    scatter(space, 60, speed=1.0)
    before = space.momentum
    space.pair_force("attract_repel", cutoff=1.5, alignment=0.5, repulsion_range=0.2)
    spread = np.std(space.velocities, axis=0).sum()
    for _ in range(150):
        space.step(0.02)
    assert np.std(space.velocities, axis=0).sum() < 0.5 * spread
    assert abs(space.momentum - before) < 1e-11


def bent_sheet(space: iota.System) -> tuple[list[iota.Particle], iota.PairForce]:
    """7 x 7 surfels on a wavy sheet of springs 0.1 m long; their normals are off by up to half a radian."""
    random = np.random.default_rng(3)
    surfels = {}
    for i in range(7):
        for j in range(7):
            surfels[i, j] = surfel = space.body().particle((0.1 * i, 0.03 * math.sin(2 * i + j), 0.1 * j), mass=0.01)
            tilt = 0.2 * random.normal(size=3)
            surfel.orientation = (tilt[0] - 0.7071, tilt[1], tilt[2], 0.7071)  # its normal is near +y
            surfel.moment = 1e-5
            for other in (surfels.get((i - 1, j)), surfels.get((i, j - 1))):
                if other is not None:
                    space.bond(surfel, other, "spring", stiffness=50, length=0.1)
    law = "energy = k*exp(-(r/w)^2)*(cos_p^2 + cos_q^2 + 1 - cos_pq)"
    return list(surfels.values()), space.pair_force(law, cutoff=0.5, k=0.01, w=0.15)


@pytest.mark.parametrize("mode", ["robust", "energy_keeping"])
def test_surfels_keep_momentum_and_angular_momentum_and_exchange_energy(mode: str) -> None:
    space = iota.System(gravity=(0, 0, 0), mode=mode)
    _, pairs = bent_sheet(space)
    start, momentum, turning = space.energy, space.momentum, space.angular_momentum
    lowest = potential = pairs.energy
    for _ in range(400):
        space.step(0.0005)
        lowest = min(lowest, pairs.energy)
        assert abs(space.momentum - momentum) < 1e-14
        assert abs(space.energy.balance - start.balance) < 1e-12
    assert lowest < 0.5 * potential, "they have moved"
    if mode == "energy_keeping":
        assert abs(space.angular_momentum - turning) < 1e-7
        assert space.energy.total == pytest.approx(start.total, abs=1e-3 * (potential - lowest))


def test_a_bent_sheet_of_surfels_flattens(space: iota.System) -> None:
    surfels, _ = bent_sheet(space)
    space.damping = 3

    def bend() -> float:
        places = space.positions - space.positions.mean(axis=0)
        return float(np.linalg.svd(places, compute_uv=False)[2] / math.sqrt(len(places)))

    def spread() -> float:
        normals = np.array([surfel.normal for surfel in surfels])
        return float(1 - np.linalg.norm(normals.mean(axis=0)))

    before = bend(), spread()
    for _ in range(2000):
        space.step(0.002)
    assert bend() < 0.01 * before[0] and spread() < 1e-4 * before[1]


def test_laws_of_normals_are_for_pairs_of_oriented_particles(space: iota.System) -> None:
    p, q = scatter(space, 2)
    with pytest.raises(ValueError, match=r"depends on normals .* only pairwise forces know them"):
        space.bond(p, q, "energy = cos_p^2")
    with pytest.raises(ValueError, match="only an energy may depend on cos_p"):
        space.pair_force("force = cos_p", cutoff=1)
    with pytest.raises(ValueError, match="depends on the distance alone"):
        space.pair_force("energy = cos_p^2", cutoff=1, shifted=True)
    pairs = space.pair_force("energy = 1 + cos_p", cutoff=10)
    assert pairs.energy == 0, "neither is oriented"
    p.orientation = q.orientation = (0, 0, 0, 1)
    assert pairs.energy == pytest.approx(1 + abs(q.position - p.position) ** -1 * (q.position - p.position).z)


def test_two_particles_at_one_place_are_reported(space: iota.System) -> None:
    for _ in range(2):
        space.body().particle()
    pairs = space.pair_force("coulomb", cutoff=1)
    assert space.step().warnings == [
        "pairwise force 0 gives no finite force between particles 0 and 1; there it gives none"
    ]
    pairs.active = False
    assert space.step().warnings == []
    pairs.destroy()
    assert not pairs.alive


def test_bad_groups_fields_and_pairs_are_refused(space: iota.System) -> None:
    (ball,) = scatter(space, 1)
    group = space.group("a")
    before = space.state_hash()
    for call, error, text in (
        (lambda: space.group("a"), ValueError, "already"),
        (lambda: group.add(3), TypeError, "takes particles and bodies, not 3"),
        (lambda: space.field("wimd"), ValueError, "no field is called 'wimd'"),
        (lambda: space.field("fx = qq"), ValueError, "unknown name 'qq'"),
        (lambda: space.field("wind", velocity=(math.nan, 0, 0)), ValueError, "velocity must be finite"),
        (lambda: space.field("wind", drag="much"), TypeError, "drag must be a number or a vector"),
        (lambda: space.field(3), TypeError, "field must be"),
        (lambda: space.field("wind", group=ball), TypeError, "group must be a Group or None"),
        (lambda: space.field("wind", group=iota.System().group("b")), ValueError, "same system"),
        (lambda: space.pair_force("morse", cutoff=1), ValueError, "need a value for length"),
        (lambda: space.pair_force("coulomb", cutoff=-1), ValueError, "cutoff"),
        (lambda: space.pair_force(lambda b: 0, cutoff=1), TypeError, "law must be"),
    ):
        with pytest.raises(error, match=text):
            call()
    assert space.state_hash() == before and space.validate() == []


def test_a_field_whose_function_knows_the_system_is_freed() -> None:
    class Flag:
        pass

    flag = Flag()
    gone = weakref.ref(flag)
    system = iota.System()
    system.body().particle()
    system.field(lambda b, flag=flag, system=system: np.zeros((len(b), 3)))
    system.step()
    del flag, system
    gc.collect()
    assert gone() is None


def test_forces_on_many_are_saved_and_restored(space: iota.System) -> None:
    scatter(space, 30, speed=1.0)
    space.field("current", drag=1)
    space.pair_force("soft_repulsion", cutoff=0.5, length=0.5)
    saved = space.snapshot()
    hashes = []
    for _ in range(2):
        for _ in range(20):
            space.step(0.01)
        hashes.append(space.state_hash())
        space.restore(saved)
    assert hashes[0] == hashes[1]


def test_forces_on_many_tell_what_makes_the_same_ones_of_another_system(space: iota.System) -> None:
    def push(batch: iota.types.ParticleBatch) -> np.ndarray:
        return np.zeros((len(batch), 3))

    left, right = space.group("left"), space.group("right")
    wind = space.field("wind", velocity=(3, 0, 1), drag=0.2, group=left, name="breeze")
    swing = space.field("energy = k*x*t", k=2.0, replaces_gravity=True)
    pushed = space.field(push, group=right)
    assert [f.kind for f in space.fields] == ["predefined", "expression", "function"]
    assert [f.text for f in space.fields] == ["wind", "energy = k*x*t", ""]
    assert [f.group for f in space.fields] == [left, None, right]
    assert [f.replaces_gravity for f in space.fields] == [False, True, False]
    assert pushed.function is push and wind.function is None and swing.function is None
    other = iota.System(gravity=(0, 0, 0))
    again = other.field(wind.text, name=wind.name, **wind.parameters)
    assert again.parameters == wind.parameters and again.name == "breeze"
    assert other.field(swing.text, **swing.parameters).parameters == {"k": 2.0}
    between = space.pair_force("lennard_jones", cutoff=2.5, shifted=True, group=left, other=right)
    within = space.pair_force("soft_repulsion", cutoff=0.5)
    assert (between.group, between.other, between.shifted) == (left, right, True)
    assert (within.group, within.other, within.shifted) == (None, None, False)


def test_pairs_between_two_groups_are_those_of_one_and_the_other() -> None:
    system = iota.System(gravity=(0, 0, 0))
    a, b, both, none = (system.body().particle(place) for place in ((0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)))
    left, right = system.group("left"), system.group("right")
    left.add(a, both), right.add(b, both)
    system.pair_force("coulomb", cutoff=3.0, group=left, other=right, strength=2.0)
    system.step(1e-6)

    def push(p: iota.Particle, q: iota.Particle) -> np.ndarray:
        line = np.array(p.position - q.position)
        return 2 * line / np.linalg.norm(line) ** 3

    # a-b, a-both and both-b; but never twice, and nothing on what is in neither.
    wanted = [push(a, b) + push(a, both), push(b, a) + push(b, both), push(both, a) + push(both, b), np.zeros(3)]
    np.testing.assert_allclose(system.array([a, b, both, none]).forces, wanted, rtol=1e-6, atol=1e-9)
    c = system.body().particle((0, 3.5, 0))
    left.add(c)
    assert system.pair_forces[0].energy == pytest.approx(2 * (1 + 1 + 1 / np.sqrt(2) + 1 / 2.5))
    with pytest.raises(ValueError, match="acts on"):
        right.destroy()
    with pytest.raises(ValueError, match="give group and other"):
        system.pair_force("coulomb", cutoff=3.0, other=right, strength=2.0)


def test_a_shifted_cut_off_has_no_jump() -> None:
    def pair(distance: float, shifted: bool) -> tuple[float, float]:
        system = iota.System(gravity=(0, 0, 0))
        _, q = (system.body().particle((x, 0, 0)) for x in (0, distance))
        force = system.pair_force("lennard_jones", cutoff=2.0, shifted=shifted, depth=1.0, size=1.0)
        energy = force.energy
        system.step(1e-9)
        return energy, system.array([q]).forces[0, 0]

    for distance in (1.0, 1.3, 1.9):
        low, high = (pair(distance + step, True)[0] for step in (-1e-5, 1e-5))
        assert pair(distance, True)[1] == pytest.approx(-(high - low) / 2e-5, rel=1e-6)
    energy, force = pair(2 - 1e-6, True)
    assert abs(energy) < 1e-11 and abs(force) < 1e-5
    assert abs(pair(2 - 1e-6, False)[1]) > 0.1
    system = iota.System()
    with pytest.raises(ValueError, match="gravity cannot be shifted"):
        system.pair_force("gravity", cutoff=2.0, shifted=True, strength=1.0)


def kinetic_energy(bodies: list[iota.Body]) -> float:
    energy = 0.0
    for body in bodies:
        velocity, spin = np.array(list(body.velocity)), np.array(list(body.angular_velocity))
        energy += 0.5 * body.mass * velocity @ velocity + 0.5 * spin @ np.array(body.inertia) @ spin
    return energy


def turning_box(system: iota.System, x: float, spin: tuple[float, float, float]) -> iota.Body:
    """A box that turns about the origin."""
    velocity = tuple(np.cross(spin, (x, 0, 0)))
    return system.body(shape=iota.Box((0.6, 0.4, 0.2)), mass=2, position=(x, 0, 0), velocity=velocity, spin=spin)


def free_box(system: iota.System) -> list[iota.Body]:
    return [turning_box(system, 0, (1, 2, 3))]


def nailed_box(system: iota.System) -> list[iota.Body]:
    box = turning_box(system, 0.1, (1, 2, 3))
    box.attachment((0, 0, 0)).nail()
    return [box]


def door(system: iota.System) -> list[iota.Body]:
    box = turning_box(system, 0.4, (0, 0, 3))
    system.revolute(box, at=(0, 0, 0), axis=(0, 0, 1))
    return [box]


def jointed_pair(system: iota.System) -> list[iota.Body]:
    boxes = [turning_box(system, x, (1, 2, 3)) for x in (-0.4, 0.4)]
    system.ball(*boxes, at=(0, 0, 0))
    return boxes


@pytest.mark.parametrize("mode", ["robust", "plausible", "energy_keeping"])
@pytest.mark.parametrize("make", [free_box, nailed_box, door, jointed_pair])
def test_a_field_that_turns_velocities_takes_no_energy_from_what_spins(mode: str, make: Any) -> None:
    for turn, most in ((0.1, 2e-3), (3, 4e-3), (30, 4e-2)):
        system = iota.System(mode=mode, gravity=(0, 0, 0))
        bodies = make(system)
        system.field("fx = B*m*vy; fy = -B*m*vx; fz = 0", B=turn)
        before = kinetic_energy(bodies)
        for _ in range(60):
            system.step(1 / 60)
            assert kinetic_energy(bodies) <= before * (1 + 1e-9)
        assert kinetic_energy(bodies) >= before * (1 - most)


@pytest.mark.parametrize("make", [free_box, nailed_box])
def test_a_spin_in_a_field_that_turns_velocities_is_that_of_short_steps(make: Any) -> None:
    def spin_after(mode: str, rate: int) -> Any:
        system = iota.System(mode=mode, gravity=(0, 0, 0))
        (body,) = make(system)
        system.field("fx = B*m*vy - c*m*vx; fy = -B*m*vx - c*m*vy; fz = -c*m*vz", B=3, c=0.5)
        for _ in range(rate // 2):
            system.step(1 / rate)
        return np.array(list(body.angular_velocity))

    right = spin_after("energy_keeping", 1000)
    errors = [np.linalg.norm(spin_after("robust", rate) - right) for rate in (60, 240)]
    assert errors[0] < 0.1
    assert errors[1] < 0.3 * errors[0]


def test_a_field_that_turns_velocities_leaves_a_wheel_on_two_shared_points_its_spin(space: iota.System) -> None:
    space.mode = "robust"
    wheel, frame = space.body(), space.body()
    axle = [wheel.particle((0, 0, z), mass=0.1) for z in (-0.1, 0.1)]
    angles = 2 * math.pi / 3 * np.arange(3)
    rim = [
        wheel.particle((math.cos(a), math.sin(a), 0), velocity=(-5 * math.sin(a), 5 * math.cos(a), 0)) for a in angles
    ]
    for point in axle:
        frame.particle(point.position).combine(point)
    frame.particle((3, 0, 0))
    space.field("fx = B*m*vy; fy = -B*m*vx; fz = 0", B=10)
    before = sum(p.mass * norm_squared(p.velocity) for p in rim)
    for _ in range(120):
        space.step(1 / 60)
    assert sum(p.mass * norm_squared(p.velocity) for p in rim) == pytest.approx(before, rel=2e-3)


def norm_squared(vector: iota.Vec3) -> float:
    return float(np.sum(np.square(list(vector))))
