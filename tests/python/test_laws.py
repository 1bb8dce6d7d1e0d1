# SPDX-License-Identifier: Apache-2.0
"""Bonds by law: every way of writing one, and what happens when it goes wrong."""

from __future__ import annotations

import ctypes
import functools
import gc
import math
import warnings
import weakref
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import iota
from iota.world.options import RunOptions, use

Pair = tuple[iota.Particle, iota.Particle]
Radial = ctypes.CFUNCTYPE(
    ctypes.c_double, ctypes.c_double, ctypes.c_double, ctypes.c_double, ctypes.POINTER(ctypes.c_double)
)
Doubles = ctypes.POINTER(ctypes.c_double)
Batch = ctypes.CFUNCTYPE(None, ctypes.c_int64, ctypes.c_double, Doubles, Doubles, Doubles, Doubles, Doubles, Doubles)


@pytest.fixture
def space() -> iota.System:
    return iota.System(gravity=(0, 0, 0))


@pytest.fixture
def pair(space: iota.System) -> Pair:
    return space.body().particle(), space.body().particle((1, 0, 0))


def radial_spring(r: float, v: float, t: float, p: Any) -> float:
    return -p[0] * (r - p[1])


def batch_spring(count, t, xp, xq, vp, vq, parameters, force):
    p, q = (np.ctypeslib.as_array(a, (count, 3)) for a in (xp, xq))
    k, length = np.ctypeslib.as_array(parameters, (count, 2)).T
    np.ctypeslib.as_array(force, (count, 3))[:] = pull(p, q, k, length)


def pull(p: np.ndarray, q: np.ndarray, k: np.ndarray, length: np.ndarray) -> np.ndarray:
    d = q - p
    r = np.sqrt((d * d).sum(axis=1))
    return (k * (r - length) / r)[:, None] * d


@functools.cache
def of_numba(signature: str) -> Any:
    """The two springs compiled by Numba. To load it and to compile takes seconds, in each process that collects tests."""
    import numba

    def batch(count, t, xp, xq, vp, vq, parameters, force):
        p, q, f = (numba.carray(xp, (count, 3)), numba.carray(xq, (count, 3)), numba.carray(force, (count, 3)))
        k = numba.carray(parameters, (count, 2))
        for i in range(count):
            d = q[i] - p[i]
            r = math.sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2])
            f[i] = (k[i, 0] * (r - k[i, 1]) / r) * d

    if signature == "batch":
        return numba.cfunc("void(int64, float64" + ", CPointer(float64)" * 6 + ")")(batch)
    return numba.cfunc("float64(float64, float64, float64, CPointer(float64))")(radial_spring)


def numpy_spring(bonds: iota.types.BondBatch) -> np.ndarray:
    return pull(bonds.position_p, bonds.position_q, bonds.parameters["k"], bonds.parameters["r0"])


def python_spring(bond: iota.types.BondState) -> iota.Vec3:
    return 20 * (bond.distance - 0.1) * bond.direction


def mesh(law: Callable[[iota.System], Any], mode: Any, **arguments: Any) -> iota.System:
    """A stretched 4 x 4 net of particles that hangs from its upper row."""
    system = iota.System(gravity=(0, -1, 0), mode=mode)
    points = [
        [system.body().particle((0.11 * x, -0.11 * y, 0.01 * ((x + y) % 2)), 0.1 + 0.01 * x) for x in range(4)]
        for y in range(4)
    ]
    for point in points[0]:
        point.nail()
    ready = law(system)
    for y in range(4):
        for x in range(4):
            if x < 3:
                system.bond(points[y][x], points[y][x + 1], ready, **arguments)
            if y < 3:
                system.bond(points[y][x], points[y + 1][x], ready, **arguments)
    return system


RUNGS: dict[str, tuple[Callable[[iota.System], Any], dict[str, Any]]] = {
    "predefined": (lambda s: "spring", {"stiffness": 20, "length": 0.1, "implicit": False}),
    "expression": (lambda s: "energy = 0.5*k*(r - r0)^2", {"k": 20, "r0": 0.1, "implicit": False}),
    "force expression": (lambda s: "force = -k*(r - r0)", {"k": 20, "r0": 0.1, "implicit": False}),
    "compiled": (lambda s: s.law(Radial(radial_spring), k=20, r0=0.1), {}),
    "compiled batch": (lambda s: s.law(Batch(batch_spring), signature="batch", k=20, r0=0.1), {}),
    "numba": (lambda s: s.law(of_numba("radial"), k=20, r0=0.1), {}),
    "numba batch": (lambda s: s.law(of_numba("batch"), signature="batch", k=20, r0=0.1), {}),
    "numpy": (lambda s: s.law(numpy_spring, k=20, r0=0.1), {}),
    "python": (lambda s: python_spring, {}),
}


def test_all_rungs_of_the_ladder_give_the_same_numbers() -> None:
    """In both modes in one process: to load Numba takes longer than all else here."""
    for mode in ("energy_keeping", "robust"):
        ends = {}
        for name, (law, arguments) in RUNGS.items():
            system = mesh(law, mode, **arguments)
            start = system.positions
            for _ in range(100):
                system.step(1 / 240)
            ends[name] = system.positions
            assert np.abs(ends[name] - start).max() > 0.02, "it moves"
            np.testing.assert_allclose(ends[name], ends["predefined"], rtol=0, atol=1e-12, err_msg=f"{name}, {mode}")


def test_the_first_two_rungs_are_implicit_alike(space: iota.System) -> None:
    ends = []
    for law, arguments in (
        ("spring", {"stiffness": 500, "length": 0.1, "damping": 0.2}),
        ("energy = 0.5*k*(r - r0)^2; force = -c*v", {"k": 500, "r0": 0.1, "c": 0.2}),
    ):
        system = mesh(lambda s, law=law: law, "energy_keeping", **arguments)
        assert all(bond.implicit for bond in system.bonds)
        for _ in range(100):
            system.step(1 / 120)
        ends.append(system.positions)
    np.testing.assert_allclose(ends[0], ends[1], rtol=0, atol=1e-8)


def test_an_expression_is_made_once_for_all_its_bonds(space: iota.System, pair: Pair) -> None:
    first = space.bond(*pair, "energy = k*r^4", k=1)
    second = space.bond(*pair, "energy = k*r^4", k=2)
    assert first.law == second.law and first.parameters == {"k": 1} and second.parameters == {"k": 2}
    assert "energy = k*r^4" in repr(first.law) and first.law.text == "energy = k*r^4"
    with pytest.raises(ValueError, match="2 bonds or pairwise forces have it"):
        first.law.destroy()


def test_an_expression_survives_a_restore_that_took_it_away(space: iota.System, pair: Pair) -> None:
    before = space.snapshot()
    space.bond(*pair, "energy = k*r^4", k=1)
    space.restore(before)
    space.bond(*pair, "energy = k*r^2", k=1)
    bond = space.bond(*pair, "energy = k*r^4", k=1)
    assert bond.law.text == "energy = k*r^4"


def test_errors_in_an_expression_show_the_place(pair: Pair) -> None:
    with pytest.raises(ValueError, match="did you mean 'length'") as caught:
        pair[0].system.bond(*pair, "energy = 0.5*k*(r - lenght)^2", k=1, length=1)
    line, caret = str(caught.value).splitlines()[-2:]
    assert line[caret.index("^") :].startswith("lenght")
    with pytest.raises(ValueError, match="cannot depend on v"):
        pair[0].system.bond(*pair, "energy = k*v", k=1)
    with pytest.raises(ValueError, match="has no parameter 'depth'; it has stiffness, damping, length"):
        pair[0].system.bond(*pair, "spring", depth=1)


def test_parameters_can_be_changed_while_it_runs(space: iota.System, pair: Pair) -> None:
    pair[0].nail()
    bond = space.bond(*pair, "energy = 0.5*k*(r - r0)^2; force = -c*v", k=100, r0=None, c=5)
    assert bond.parameters == {"k": 100, "r0": 1, "c": 5}
    bond.set(r0=0.5)
    for _ in range(2000):
        space.step(0.01)
    assert pair[1].position.x == pytest.approx(0.5)
    bond.set(r0=None)
    assert bond.parameters["r0"] == pytest.approx(0.5)
    with pytest.raises(ValueError, match="no parameter 'q'"):
        bond.set(k=3, q=1)
    assert bond.parameters["k"] == 100, "all or none"
    with pytest.raises(TypeError, match="k must be a number, not 'stiff'"):
        bond.set(k="stiff")  # type: ignore[arg-type]


def test_a_bond_acts_within_a_body_and_between_articulates(space: iota.System) -> None:
    body = space.body()
    p, q = body.particle(), body.particle((1, 0, 0))
    far = space.body().particle((3, 0, 0))
    space.bond(p, q, "energy = 1000*r^2")
    space.bond(q, far, "morse", depth=3, length=1)
    for _ in range(50):
        space.step(0.01)
    assert abs(q.position - p.position) == pytest.approx(1, abs=1e-9)
    assert far.velocity.x < 0 and abs(space.momentum) < 1e-9
    assert space.articulate_count == 2 and space.validate() == []


@pytest.mark.parametrize(
    ("function", "cause", "text"),
    [
        (lambda b: 1 / 0, ZeroDivisionError, "division by zero"),
        (lambda b: np.zeros(3), ValueError, r"must have the shape \(2, 3\), one row a bond, not \(3,\)"),
        (lambda b: np.zeros((3, 3)), ValueError, r"not \(3, 3\)"),
        (lambda b: None, (TypeError, ValueError), "law wind"),
        (lambda b: "up", ValueError, "law wind"),
    ],
)
def test_a_batch_function_that_fails_is_named_and_switched_off(
    space: iota.System, pair: Pair, function: Any, cause: Any, text: str
) -> None:
    law = space.law(function, name="wind")
    bonds = [space.bond(*pair, law) for _ in range(2)]
    with pytest.raises(iota.ForceError, match=text) as caught:
        space.step()
    assert isinstance(caught.value.__cause__, cause)
    assert str(caught.value).startswith("law wind was switched off: its function raised")
    assert not bonds[0].active and not bonds[1].active
    assert caught.value.report.step == space.step_count == 1 and space.validate() == []
    space.step()


def test_a_row_that_is_not_finite_switches_off_that_bond_only(space: iota.System, pair: Pair) -> None:
    law = space.law(lambda b: [[0, 1, 0], [math.nan, 0, 0]], name="half")
    good, bad = space.bond(*pair, law), space.bond(*pair, law)
    with pytest.raises(iota.BondError, match=r"bond 1 \(half\): its function gave the force \(nan, 0, 0\)") as caught:
        space.step(0.5)
    assert caught.value.bond == bad and good.active and not bad.active
    assert pair[0].velocity.y == pytest.approx(0.5)


@pytest.mark.parametrize("implicit", [True, False])
def test_dividing_by_zero_switches_the_bond_off(space: iota.System, implicit: bool) -> None:
    p, q = (space.body().particle() for _ in range(2))
    bond = space.bond(p, q, "force = 1/r", implicit=implicit)
    with pytest.raises(iota.BondError, match="bond 0: the force is not finite at r = 0 m"):
        space.step()
    assert not bond.active and space.validate() == []
    bond.active = True
    space.force_errors = "warn"
    with pytest.warns(iota.ForceWarning, match="bond 0"):
        space.step()
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        space.step()


def test_a_batch_function_may_cut_but_not_create(space: iota.System, pair: Pair) -> None:
    def cut(bonds: iota.types.BondBatch) -> np.ndarray:
        bonds.bonds[0].destroy()
        return np.zeros((len(bonds), 3))

    space.bond(*pair, space.law(cut))
    space.step()
    assert space.bonds == []

    def create(bonds: iota.types.BondBatch) -> np.ndarray:
        space.body()
        return np.zeros((len(bonds), 3))

    space.bond(*pair, space.law(create))
    with pytest.raises(iota.ForceError, match="not possible in a function that is called during a step"):
        space.step()


def test_a_batch_is_good_only_during_its_call_but_its_arrays_may_be_kept(space: iota.System, pair: Pair) -> None:
    kept: list[Any] = []

    def keep(bonds: iota.types.BondBatch) -> np.ndarray:
        kept.extend([bonds, bonds.distance, bonds.direction, bonds.velocity_q, bonds.time])
        return np.zeros((len(bonds), 3))

    space.bond(*pair, space.law(keep))
    space.step(0.1)
    space.step(0.1)
    assert kept[1].tolist() == [1] and kept[2].tolist() == [[1, 0, 0]] and kept[9] == pytest.approx(0.15)
    with pytest.raises(RuntimeError, match="valid only until"):
        len(kept[0])


def test_code_that_is_no_law_is_refused(space: iota.System, pair: Pair) -> None:
    with pytest.raises(TypeError, match="law must be an expression, compiled code or a function"):
        space.law(3.5)
    with pytest.raises(ValueError, match="'radial' or 'batch', not 'fast'"):
        space.law(Radial(radial_spring), signature="fast", k=1, r0=1)
    with pytest.raises(ValueError, match="cannot be implicit"):
        space.bond(*pair, python_spring, implicit=True)
    with pytest.raises(ValueError, match="cannot be implicit"):
        space.bond(*pair, space.law(numpy_spring, k=1, r0=1), implicit=True)
    with pytest.raises(ValueError, match="a law of its own system"):
        space.bond(*pair, iota.System().law("energy = r"))
    with pytest.raises(ValueError, match="at most 8 parameters"):
        space.law("energy = r", **{f"a{i}": 1 for i in range(9)})


def test_a_system_with_functions_of_its_own_is_freed() -> None:
    class Flag:
        pass

    flag = Flag()
    gone = weakref.ref(flag)
    system = iota.System()
    p, q = (system.body().particle((x, 0, 0)) for x in range(2))
    system.bond(p, q, system.law(lambda b, flag=flag, system=system: np.zeros((len(b), 3))))
    del flag, p, q, system
    gc.collect()
    assert gone() is None


def test_a_world_reports_a_failed_law_and_goes_on(space: iota.System, pair: Pair) -> None:
    space.bond(*pair, space.law(lambda b: 1 / 0, name="broken"))
    with use(RunOptions(headless=True, seconds=0.1)):
        iota.World(space, title="test").run()
    assert space.step_count >= 5


def test_a_profile_names_every_force_and_changes_nothing(space: iota.System, pair: Pair) -> None:
    space.bond(*pair, "morse", length=1)
    space.bond(*pair, "energy = k*r^2", k=1, implicit=False)
    space.bond(*pair, python_spring)
    space.bond(*pair, space.law(numpy_spring, k=1, r0=1))
    space.field("wind")
    space.pair_force("coulomb", cutoff=2)
    before = space.state_hash()
    profile = space.profile()
    assert space.state_hash() == before
    assert [(row.force, row.kind, row.count) for row in profile] == [
        ("morse", "predefined, implicit", 1),
        ("energy = k*r^2", "expression, held", 1),
        ("function", "function, held", 1),
        ("numpy_spring", "arrays, held", 1),
        ("field wind", "particles", 2),
        ("pair force coulomb", "particles", 2),
    ]
    assert all(0 < row.ns < 1e7 for row in profile) and len(str(profile).splitlines()) == 7


def test_a_name_is_that_of_a_law_or_of_a_function_of_the_script(space: iota.System, pair: Pair) -> None:
    space.law("energy = k*r^2", name="stiff", k=3)
    assert space.bond(*pair, "stiff").parameters == {"k": 3}

    def local_pull(bond: iota.types.BondState) -> iota.Vec3:
        return 2 * bond.direction

    assert space.bond(*pair, "local_pull").law.kind == "function"
    bond = space.bond(*pair, "python_spring")
    space.step(0.01)
    assert bond.active and abs(bond.force) > 0
    with pytest.raises(ValueError, match=r"no law is called 'fred'\. Predefined are"):
        space.bond(*pair, "fred")
    with pytest.raises(ValueError, match="did you mean 'stiff'"):
        space.bond(*pair, "stif")


@pytest.mark.parametrize("mode", ["plausible", "robust", "energy_keeping", "accurate"])
def test_a_held_law_between_points_of_one_rigid_body_does_not_move_it(mode: Any) -> None:
    """It had a torque about the place where the body turned to in the step: the body spun up."""
    places = []
    for strength in (0, 50):
        system = iota.System(gravity=(0, 0, 0), mode=mode)
        body = system.body()
        p, q = body.particle((0, 0, 0), 1, (0, 1, 0)), body.particle((1, 0, 0), 2, (0, -2, 0.5))
        r = body.particle((0, 1, 0.3), 1, (0.3, 0, 0))
        bonds = [
            system.bond(p, q, "gravity", strength=strength, softening=0.01, implicit=False),
            system.bond(q, r, "spring", stiffness=10 * strength, length=0.5, implicit=False),
        ]
        for _ in range(240):
            system.step(1 / 60)
        places.append([tuple(point.position) for point in (p, q, r)])
        assert abs(system.energy.external_work) < 1e-6
        assert strength == 0 or min(abs(bond.force) for bond in bonds) > 50  # it is there
    np.testing.assert_allclose(places[1], places[0], atol=1e-9)
