# SPDX-License-Identifier: Apache-2.0
from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, Literal

import numpy as np
import pytest

import iota

Pair = tuple[iota.Particle, iota.Particle]


@pytest.fixture
def space() -> iota.System:
    """Without gravity."""
    return iota.System(gravity=(0, 0, 0))


@pytest.fixture
def pair(space: iota.System) -> Pair:
    """Two free particles, 1 m apart."""
    return space.body().particle(), space.body().particle((1, 0, 0))


def run(system: iota.System, seconds: float, dt: float = 1 / 240) -> None:
    for _ in range(round(seconds / dt)):
        system.step(dt)


def test_a_spring_swings_with_its_period(space: iota.System, pair: Pair) -> None:
    p, q = pair
    p.nail()
    space.bond(p, q, "spring", stiffness=(2 * math.pi) ** 2, length=0.8)
    run(space, 0.5)
    assert q.position.x == pytest.approx(0.6, abs=0.01), "half a period later it is at the other end"
    run(space, 0.5)
    assert q.position.x == pytest.approx(1.0, abs=0.01)


def test_a_spring_without_a_length_rests_where_it_was_made(space: iota.System, pair: Pair) -> None:
    space.bond(*pair, "spring", stiffness=1000)
    run(space, 0.1)
    assert pair[1].position == (1, 0, 0)


@pytest.mark.parametrize("mode", ["energy_keeping", "accurate"])
@pytest.mark.parametrize("law", ["spring", "energy = 0.5*stiffness*(r - length)^2; force = -damping*v"])
@pytest.mark.parametrize("size", [1e-6, 1, 1e3])
def test_a_damped_spring_takes_stretching_and_no_spin(
    mode: Literal["energy_keeping", "accurate"], law: str, size: float
) -> None:
    """A dumbbell at 5 rad/s, 0.1 rad in a step, ends as a rigid one whose spring balances the centrifugal force."""
    space = iota.System(gravity=(0, 0, 0), mode=mode)
    p, q = (space.body().particle((x * size, 0, 0), velocity=(0, 5 * x * size, 0)) for x in (-0.25, 0.25))
    space.bond(p, q, law, stiffness=100, damping=10, length=0.5 * size)
    spin = space.angular_momentum.z
    run(space, 4, 1 / 50)
    assert space.angular_momentum.z == pytest.approx(spin, rel=1e-12)
    distance = (q.position - p.position).length
    rate = (q.velocity - p.velocity).length / distance
    assert 0.5 * distance**2 * rate == pytest.approx(spin, rel=1e-7)  # it only turns
    assert 100 * (distance - 0.5 * size) == pytest.approx(0.5 * rate**2 * distance, rel=1e-5)


def test_a_drag_slows_exponentially(space: iota.System, pair: Pair) -> None:
    p, q = pair
    p.nail()
    q.velocity = (0, 1, 0)
    space.bond(p, q, "drag", damping=2.0)
    run(space, 0.5)
    assert q.velocity.y == pytest.approx(math.exp(-1), rel=0.01)


def test_a_function_gives_the_force_on_the_first_and_its_opposite_to_the_second(space: iota.System, pair: Pair) -> None:
    p, q = pair
    seen: list[Any] = []

    def force(bond: iota.types.BondState) -> tuple[float, float, float]:
        seen.append((bond.position_p, bond.position_q, bond.velocity_p, bond.velocity_q, bond.time))
        seen.append((bond.p, bond.q, bond.bond, bond.distance, bond.direction))
        return (0, 6, 0)

    bond = space.bond(p, q, force)
    space.step(0.5)
    assert seen[0] == ((0, 0, 0), (1, 0, 0), (0, 0, 0), (0, 0, 0), 0.25)
    assert seen[1] == (p, q, bond, 1.0, (1, 0, 0))
    assert p.velocity == pytest.approx((0, 3, 0)) and q.velocity == pytest.approx((0, -3, 0))
    assert abs(space.momentum) < 1e-12


def test_a_spring_in_python_moves_like_the_built_in_one(space: iota.System) -> None:
    ends = []
    for law in ("spring", lambda bond: 50 * (bond.distance - 0.8) * bond.direction):
        p = space.body().particle()
        q = space.body().particle((1, 0, 0))
        arguments = {"stiffness": 50, "length": 0.8} if law == "spring" else {}
        space.bond(p, q, law, **arguments)
        ends.append(q)
    run(space, 1.0, 1 / 2000)
    assert abs(ends[0].position - ends[1].position) < 0.01


@pytest.mark.parametrize(
    ("law", "cause", "text"),
    [
        (lambda bond: 1 / 0, ZeroDivisionError, "ZeroDivisionError: division by zero"),
        (lambda bond: (1, 2, 3, 4), TypeError, r"the force must be 2 or 3 numbers \(N\), not \(1, 2, 3, 4\)"),
        (lambda bond: None, TypeError, "not None"),
        (lambda bond: "up", TypeError, "not 'up'"),
        (lambda bond: (math.nan, 0, 0), ValueError, r"the force must be finite \(N\), not \(nan, 0, 0\)"),
        (lambda bond: (0, math.inf, 0), ValueError, "inf"),
        (lambda: (0, 0, 0), TypeError, "positional argument"),
        (lambda bond: bond.nothing, AttributeError, "nothing"),
    ],
)
def test_a_function_that_fails_is_switched_off_and_named_after_the_step(
    space: iota.System, pair: Pair, law: Callable[..., Any], cause: type[Exception], text: str
) -> None:
    pair[1].velocity = (1, 0, 0)
    good = space.bond(*pair, lambda bond: (0, 1, 0))
    bad = space.bond(*pair, law)
    with pytest.raises(iota.BondError, match=text) as caught:
        space.step(0.5)
    assert "bond 1 between particle 0 and particle 1 was switched off" in str(caught.value)
    assert caught.value.bond == bad and not bad.active and good.active
    assert type(caught.value.__cause__) is cause
    assert caught.value.report.step == space.step_count == 1, "the step was finished"
    assert pair[1].position.x > 1.4 and space.validate() == []
    space.step()


def test_the_traceback_of_a_failed_function_is_kept(space: iota.System, pair: Pair) -> None:
    def deep(bond: iota.types.BondState) -> Any:
        raise KeyError("inside")

    space.bond(*pair, deep)
    with pytest.raises(iota.BondError) as caught:
        space.step()
    cause = caught.value.__cause__
    assert cause is not None and cause.__traceback__ is not None
    assert cause.__traceback__.tb_frame.f_code.co_name == "deep"


def test_several_failures_in_one_step_are_counted(space: iota.System, pair: Pair) -> None:
    for _ in range(3):
        space.bond(*pair, lambda bond: 1 / 0)
    with pytest.raises(iota.BondError, match=r"\(and 2 more in this step\)"):
        space.step()
    space.step()


def test_ctrl_c_inside_a_function_is_no_fault_of_the_bond(space: iota.System, pair: Pair) -> None:
    def interrupted(bond: iota.types.BondState) -> Any:
        raise KeyboardInterrupt

    bond = space.bond(*pair, interrupted)
    with pytest.raises(KeyboardInterrupt):
        space.step()
    assert bond.active and space.step_count == 1


def test_a_bond_can_be_switched_off_on_and_removed(space: iota.System, pair: Pair) -> None:
    bond = space.bond(*pair, lambda bond: (1, 0, 0))
    assert bond.ends == pair and space.bonds == [bond]
    bond.active = False
    space.step()
    assert pair[0].velocity == (0, 0, 0)
    bond.active = True
    space.step()
    assert pair[0].velocity.x > 0
    bond.destroy()
    assert not bond.alive and space.bonds == []


def test_a_function_may_cut_and_join_and_this_is_done_after_the_step(
    system: iota.System, chain: list[iota.Body]
) -> None:
    upper, lower = chain[2].particles[1], chain[3].particles[0]
    reports: list[iota.types.RestructureReport] = []

    def cut(bond: iota.types.BondState) -> tuple[float, float, float]:
        if not reports:
            reports.append(upper.separate(lower))
            assert system.articulate_count == 1, "not yet"
        return (0, 0, 0)

    system.bond(chain[0].particles[0], chain[-1].particles[1], cut)
    report = system.step()
    assert reports[0].queued and "queued" in repr(reports[0])
    assert report.articulates == system.articulate_count == 2
    assert system.validate() == []


@pytest.mark.parametrize(
    "edit",
    [
        lambda s: s.step(),
        lambda s: s.body(),
        lambda s: s.bodies[0].particle(),
        lambda s: s.bond(*s.particles[:2], "drag"),
        lambda s: setattr(s.particles[0], "position", (0, 0, 0)),
        lambda s: setattr(s, "gravity", (0, 0, 0)),
        lambda s: s.snapshot(),
        lambda s: s.restore(b""),
        lambda s: s.grip(s.bodies[0]),
    ],
)
def test_a_function_may_not_make_calls_that_cannot_wait(
    space: iota.System, pair: Pair, edit: Callable[..., Any]
) -> None:
    def force(bond: iota.types.BondState) -> tuple[float, float, float]:
        edit(space)
        return (0, 0, 0)

    space.bond(*pair, force)
    with pytest.raises(iota.BondError, match="not possible in a function that is called during a step") as caught:
        space.step()
    assert isinstance(caught.value.__cause__, RuntimeError)
    assert space.validate() == [] and space.step_count == 1


def test_a_function_may_destroy_its_own_bond_and_body(space: iota.System, pair: Pair) -> None:
    def force(bond: iota.types.BondState) -> tuple[float, float, float]:
        bond.q.body.destroy()
        return (0, 0, 0)

    space.bond(*pair, force)
    space.step()
    space.step()
    assert not pair[1].alive and pair[0].alive and space.validate() == []


def test_methods_partials_and_objects_serve_as_functions(space: iota.System, pair: Pair) -> None:
    class Pull:
        def __call__(self, bond: iota.types.BondState) -> list[float]:
            return [1, 0]

    space.bond(*pair, Pull())
    space.bond(*pair, Pull().__call__)
    space.step(0.1)
    assert pair[0].velocity.x == pytest.approx(0.2)


def test_a_bond_reports_its_force_breaks_and_is_repaired() -> None:
    system = iota.System(mode="robust")
    hook = system.body().particle()
    weight = system.body().particle(position=(0, -1, 0), mass=2)
    hook.nail()
    thread = system.bond(hook, weight, "spring", stiffness=1000, damping=40, length=1, break_force=25)
    for _ in range(240):
        system.step(1 / 120)
    assert abs(thread.force.y + 2 * 9.81) < 1e-3 and not thread.broken
    weight.apply_force((0, -100, 0))
    system.step(1 / 120)
    (broken,) = system.broken
    assert broken.bond == thread and broken.constraint is None and broken.particle is None and broken.force > 25
    assert thread.broken and not thread.active and abs(thread.force) == 0
    assert "bond" in repr(broken)
    thread.break_force = math.inf
    thread.active = True
    assert thread.active and not thread.broken
    with pytest.raises(ValueError, match="break_force"):
        thread.break_force = -1


def test_a_parameter_whose_step_would_overflow_is_refused(system: iota.System) -> None:
    p, q = (system.body().particle((x, 0, 0)) for x in (0, 1))
    with pytest.raises(ValueError, match=r"stiffness must be at most 1e\+?30, got 1e\+?300"):
        system.bond(p, q, "spring", stiffness=1e300)
    bond = system.bond(p, q, "spring", stiffness=10)
    with pytest.raises(ValueError, match="at most"):
        bond.set(stiffness=1e31)
    assert bond.parameters["stiffness"] == 10


@pytest.mark.parametrize("mode", ["plausible", "robust", "energy_keeping", "accurate"])
@pytest.mark.parametrize("law", ["spring", "damped", "expression", "gravity"])
def test_bonds_between_turning_bodies_change_neither_momentum(mode: str, law: str) -> None:
    """At 20 rad/s; `robust` changed the angular momentum by a hundredth in 2 s."""
    system = iota.System(mode=mode, gravity=(0, 0, 0))
    a = system.body(shape=iota.Box((0.3, 0.2, 0.1)), mass=1, spin=(3, 20, 5), attachments=[(0.15, 0.1, 0.05)])
    b = system.body(
        shape=iota.Box((0.3, 0.2, 0.1)),
        mass=2,
        position=(0.8, 0.1, 0),
        spin=(20, -4, 2),
        attachments=[(-0.15, 0.1, 0.05)],
    )
    p, q = a.attachments[0], b.attachments[0]
    if law == "spring":
        system.bond(p, q, "spring", stiffness=100, length=0.4)
    elif law == "damped":
        system.bond(p, q, "spring", stiffness=100, length=0.4, damping=0.5)
    elif law == "expression":
        system.bond(p, q, "energy = 50*(r - 0.4)^2 + r^4")
    else:
        system.bond(p, q, "gravity", strength=5)

    def momenta() -> np.ndarray:
        parts = [(c.mass * np.array(c.velocity), np.array(c.position), np.array(c.angular_momentum)) for c in (a, b)]
        return np.concatenate([sum(p for p, _, _ in parts), sum(np.cross(x, p) + own for p, x, own in parts)])

    before = momenta()
    for _ in range(120):
        assert system.step(1 / 60).unconverged == 0
    assert np.abs(momenta() - before).max() < 1e-11


@pytest.mark.parametrize("law", ["function", "batch", "expression"])
def test_accurate_tells_the_error_of_held_dashpots_at_any_step(law: str) -> None:
    """These had the velocities at the start of a step: of first order, and 7 times the error that was told."""

    def dashpot(bond: iota.BondState) -> iota.Vec3:
        return 40 * (bond.distance - 0.4) * bond.direction + 0.8 * (bond.velocity_q - bond.velocity_p)

    def end(hz: int) -> tuple[np.ndarray, float]:
        system = iota.System(mode="accurate", gravity=(0, 0, 0))
        box = system.body(
            shape=iota.Box((0.6, 0.4, 0.2)), mass=20, spin=(1, 4, 2), attachments=[(0.3, 0.2, 0.1), (-0.3, 0.2, 0.1)]
        )
        balls = []
        for k in (0, 1):
            ball = system.body().particle((0.6 - 1.2 * k, 0.5, 0.2), mass=1, velocity=(0, 0.5, 0))
            place = box.attachments[k]
            if law == "function":
                system.bond(place, ball, dashpot)
            elif law == "expression":
                system.bond(place, ball, "energy = 20*(r - 0.4)^2; force = -0.8*v", implicit=False)
            else:
                system.bond(place, ball, system.law(all_at_once))
            balls.append(ball)
        told = sum(system.step(1 / hz).error for _ in range(hz)) / hz
        return np.array([ball.position for ball in balls]), told

    def all_at_once(batch: object) -> np.ndarray:
        way = np.asarray(batch.position_q) - np.asarray(batch.position_p)  # type: ignore[attr-defined]
        rate = np.asarray(batch.velocity_q) - np.asarray(batch.velocity_p)  # type: ignore[attr-defined]
        length = np.linalg.norm(way, axis=1, keepdims=True)
        return np.asarray(40 * (length - 0.4) * way / length + 0.8 * rate)

    truth = end(3840)[0]
    offs = []
    for hz in (60, 240):
        place, told = end(hz)
        offs.append(np.linalg.norm(place - truth, axis=1).max())
        assert offs[-1] < told < 100 * offs[-1], hz
    assert offs[0] > 12 * offs[1], "of second order"
