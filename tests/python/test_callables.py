# SPDX-License-Identifier: Apache-2.0
"""Functions of the script that the engine calls: what they may do to the system that calls them, and what becomes of those
that fail. (Bonds: test_bonds.py, laws: test_laws.py, fields: test_fields.py.)"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import iota
from iota.world.options import RunOptions, use

Surface = Callable[[float, float, float], Any]


class Marble:
    """A point on a floor that is a function, and a second world's worth of things beside it."""

    def __init__(self) -> None:
        self.system = iota.System()
        self.point = self.system.body().particle((0, 0, 0))
        self.far = self.system.body(kind="static").particle((9, 0, 0))
        self.phi: Surface = lambda x, y, z: y
        self.floor = self.system.outside(self.point, lambda x, y, z: self.phi(x, y, z))
        self.spring = self.system.bond(self.point, self.far, "spring", stiffness=0.01, length=9)
        self.rope = self.system.rope(self.point, self.far, 20.0)
        block = self.system.body()
        self.corners = [block.particle(at) for at in ((9, 0, 1), (10, 0, 1), (9, 1, 1), (9, 0, 2))]
        self.hinge = self.system.revolute(block, at=(9, 0, 0), axis=(0, 0, 1))
        self.held = self.corners[0].nail()
        self.system.step(1 / 60)


FAILURES: dict[str, tuple[Surface, type[Exception], str]] = {
    "raises": (lambda x, y, z: 1 / 0, ZeroDivisionError, "ZeroDivisionError: division by zero"),
    "nan": (lambda x, y, z: math.nan, ValueError, "a surface must be a finite number .m., not nan"),
    "infinite": (lambda x, y, z: -math.inf, ValueError, "not -inf"),
    "shape": (lambda x, y, z: (1, 0), ValueError, r"not \(1, 0\)"),
    "none": (lambda x, y, z: None, ValueError, "not None"),
    "arguments": (lambda x, y: y, TypeError, "positional argument"),
    "huge": (lambda x, y, z: 1e307 * (1 + 1e4 * y), ValueError, "is not finite"),
}


@pytest.mark.parametrize("name", FAILURES)
def test_a_surface_whose_function_fails_in_a_step_is_switched_off_and_named(name: str) -> None:
    marble = Marble()
    marble.phi, cause, text = FAILURES[name]
    with pytest.raises(iota.ConstraintError, match=text) as caught:
        marble.system.step(1 / 60)
    assert str(caught.value).startswith(f"constraint {marble.floor.slot}")
    assert caught.value.constraint == marble.floor and caught.value.report.step == 2
    assert isinstance(caught.value.__cause__, cause) or name == "huge"
    assert not marble.floor.active and marble.system.validate() == []

    before = marble.point.position.y
    for _ in range(10):
        marble.system.step(1 / 60)
    assert marble.point.position.y < before - 0.1, "it falls"
    marble.floor.active = True
    with pytest.raises(iota.ConstraintError):
        marble.system.step(1 / 60)
    marble.phi = lambda x, y, z: y
    marble.floor.active = True
    for _ in range(10):
        marble.system.step(1 / 60)
    assert marble.floor.active and marble.point.position.y > -1e-6, "it holds again"


def test_a_surface_that_fails_can_be_a_warning() -> None:
    marble = Marble()
    marble.system.force_errors = "warn"
    marble.phi = lambda x, y, z: 1 / 0
    with pytest.warns(iota.ForceWarning, match="constraint 0 was switched off"):
        marble.system.step()
    marble.system.step()


def test_a_world_reports_a_failed_surface_and_goes_on(capsys: pytest.CaptureFixture[str]) -> None:
    marble = Marble()
    marble.phi = lambda x, y, z: 1 / 0
    with use(RunOptions(headless=True, seconds=0.1)):
        iota.World(marble.system).run()
    assert marble.system.step_count >= 5 and "constraint 0 was switched off" in capsys.readouterr().err


@pytest.mark.parametrize("wrong", [lambda *r: 1 / 0, lambda *r: math.nan, lambda *r: None])
def test_a_surface_that_fails_at_once_is_not_made(wrong: Surface) -> None:
    marble = Marble()
    ball = marble.system.body(shape=iota.Sphere(0.1), position=(3, 3, 3))
    before = marble.system.state_hash()
    with pytest.raises((ValueError, ZeroDivisionError)):
        marble.system.on_surface(marble.point, wrong)
    with pytest.raises((ValueError, ZeroDivisionError)):
        marble.system.surface_to_surface(ball, iota.Sphere(0.1), None, wrong)
    assert marble.system.state_hash() == before
    marble.system.step()


def test_curves_pass_errors_of_their_function_on_and_name_invalid_points() -> None:
    marble = Marble()
    before, constraints = marble.system.state_hash(), marble.system.constraints
    with pytest.raises(ZeroDivisionError):
        marble.system.on_path(marble.point, lambda t: (1 / (t - t), 0, 0))
    for wrong in (lambda t: (math.nan, 0, 0), lambda t: None, lambda t: (t, 0, 0, 0), lambda t: "up"):
        with pytest.raises((ValueError, TypeError), match="each point of the path"):
            marble.system.on_path(marble.point, wrong)
    assert marble.system.state_hash() == before and marble.system.constraints == constraints


# --- functions that touch the system that calls them ------------------------------------------------------------------

EDITS: dict[str, Callable[[Marble], Any]] = {
    "step": lambda m: m.system.step(),
    "create": lambda m: m.system.body(),
    "assign": lambda m: setattr(m.point, "position", (1, 1, 1)),
    "snapshot": lambda m: m.system.snapshot(),
    "restore": lambda m: m.system.restore(b""),
    "undo": lambda m: m.system.undo(),
    "law": lambda m: m.system.law("energy = r"),
    "field": lambda m: m.system.field("wind"),
    "joint": lambda m: m.system.rope(m.point, m.far),
    "recording": lambda m: m.system.start_recording(),
    "solver": lambda m: setattr(m.system, "solver", "newton"),
}
# All that may be asked for, by what shows that it was done.
QUEUED: dict[str, tuple[Callable[[Marble], Any], Callable[[Marble], bool]]] = {
    "nail": (lambda m: m.point.nail(), lambda m: m.point.is_nailed),
    "release": (lambda m: m.corners[0].release(), lambda m: not m.corners[0].is_nailed),
    "combine": (lambda m: m.point.combine(m.corners[3]), lambda m: m.point.position == m.corners[3].position),
    "combine bodies": (lambda m: m.point.body.combine(m.hinge.a), lambda m: m.point.body == m.corners[0].body),
    "separate": (lambda m: m.corners[1].separate(m.corners[2]), lambda m: m.corners[1].body != m.corners[2].body),
    "destroy": (lambda m: m.point.destroy(), lambda m: not m.point.alive),
    "destroy a body": (lambda m: m.hinge.a.destroy(), lambda m: not m.hinge.alive),
    "body.kind": (lambda m: setattr(m.hinge.a, "kind", "static"), lambda m: m.corners[0].body.kind == "static"),
    "body.active": (lambda m: setattr(m.hinge.a, "active", False), lambda m: not m.corners[0].body.active),
    "particle.active": (lambda m: setattr(m.corners[3], "active", False), lambda m: not m.corners[3].active),
    "bond.active": (lambda m: setattr(m.spring, "active", False), lambda m: not m.spring.active),
    "constraint.active": (lambda m: setattr(m.floor, "active", False), lambda m: not m.floor.active),
    "length": (lambda m: setattr(m.rope, "length", 30), lambda m: m.rope.length == 30),
    "limits": (lambda m: setattr(m.hinge.angle, "limits", (-1, 1)), lambda m: m.hinge.angle.limits == (-1, 1)),
    "motor": (lambda m: setattr(m.hinge.angle, "motor", (2, 5)), lambda m: m.hinge.angle.motor == (2, 5)),
    "friction": (lambda m: setattr(m.hinge.angle, "friction", 3), lambda m: m.hinge.angle.friction == 3),
    "spring": (lambda m: setattr(m.hinge.angle, "spring", (4, 5, 0)), lambda m: m.hinge.angle.spring is not None),
}  # fmt: skip


def zeros(batch: iota.types.BondBatch | iota.types.ParticleBatch) -> np.ndarray:
    return np.zeros((len(batch), 3))


CALLERS: dict[str, Callable[[Marble, Callable[[], Any]], Any]] = {
    "bond": lambda m, act: m.point.system.bond(m.point, m.far, lambda b: (act() and None) or (0, 0, 0)),
    "law": lambda m, act: m.point.system.bond(m.point, m.far, m.system.law(lambda b: (act() and None) or zeros(b))),
    "field": lambda m, act: m.system.field(lambda b: (act() and None) or zeros(b)),
}


@pytest.mark.parametrize("caller", CALLERS)
@pytest.mark.parametrize("edit", EDITS)
def test_an_impossible_call_during_a_step_is_a_clear_error(caller: str, edit: str) -> None:
    marble = Marble()
    CALLERS[caller](marble, lambda: EDITS[edit](marble))
    with pytest.raises(iota.ForceError) as caught:
        marble.system.step()
    assert isinstance(caught.value.__cause__, RuntimeError), caught.value.__cause__
    assert marble.system.validate() == []
    marble.system.step()


@pytest.mark.parametrize("caller", CALLERS)
@pytest.mark.parametrize("edit", QUEUED)
def test_calls_during_a_step_are_done_right_after_it(caller: str, edit: str) -> None:
    marble, done_within = Marble(), []
    request, is_done = QUEUED[edit]

    def ask() -> None:
        if not done_within:
            request(marble)
            done_within.append(is_done(marble))

    CALLERS[caller](marble, ask)
    assert not is_done(marble)
    marble.system.step()
    assert done_within == [False] and is_done(marble)
    assert marble.system.validate() == []


@pytest.mark.parametrize("caller", CALLERS)
def test_all_that_can_be_read_can_be_read_during_a_step(caller: str) -> None:
    marble = Marble()
    system, own = marble.system, marble.corners[0]
    pairs = system.pair_force("lennard_jones", cutoff=0.5, depth=1.0, size=0.1)
    things = [
        system, own.body, own, marble.hinge, marble.hinge.angle, marble.rope, marble.floor, marble.spring, pairs,
        system.grip(own.body), system.emitter(), system.group("all"),
        system.articulates[0], system.array(system.particles), system.array(system.bodies), system.array(system.bonds),
        system.cosmetic_bond(marble.corners[1], marble.corners[2]), system.field("uniform", acceleration=(0, 0.1, 0)), marble.spring.law,
    ]  # fmt: skip

    def readable() -> set[str]:
        found = set()
        for thing in things:
            for name, kind in vars(type(thing)).items():
                if isinstance(kind, property) and not name.startswith("_"):
                    try:
                        getattr(thing, name)
                    except (ValueError, AttributeError):
                        continue  # it has no such quantity: a rope no angle
                    except RuntimeError as error:
                        assert "during a step" not in str(error), f"{type(thing).__name__}.{name}"
                        continue
                    found.add(f"{type(thing).__name__}.{name}")
        return found

    within: list[set[str]] = []
    CALLERS[caller](marble, lambda: within.append(readable()))
    before = readable()
    system.step()
    assert len(before) > 100 and within[0] == before


@pytest.mark.parametrize("edit", [*EDITS, *QUEUED, "read"])
def test_the_function_of_a_surface_cannot_use_the_system(edit: str) -> None:
    """It may be called on any thread, while others step: what it saw or did would be chance."""
    marble = Marble()
    act = {**EDITS, **{name: ask for name, (ask, _) in QUEUED.items()}, "read": lambda m: m.point.position}[edit]

    def phi(x: float, y: float, z: float) -> float:
        act(marble)
        return y

    with pytest.raises(RuntimeError, match="cannot use the system"):
        marble.system.on_surface(marble.point, phi)
    marble.phi = phi
    with pytest.raises(iota.ConstraintError, match="cannot use the system"):
        marble.system.step()
    assert marble.system.validate() == [] and not marble.floor.active
    marble.system.step()


def test_a_solver_that_raises_is_named_and_the_built_in_one_takes_over() -> None:
    marble = Marble()
    rod = iota.builder.chain(links=2).realize(marble.system).bodies

    @iota.solver("stubborn")
    def stubborn(equations: Any, x: np.ndarray, tolerance: float, max_iterations: int) -> Any:
        return rod[0].mass + x[:0]

    marble.system.solver = "stubborn"
    report = marble.system.step()
    (warning,) = report.warnings
    assert "the built-in one took over; it raised RuntimeError" in warning and "cannot use the system" in warning

    @iota.solver("stubborn")
    def interrupted(*_: Any) -> Any:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        marble.system.step()
    assert marble.system.validate() == []

    @iota.solver("stubborn")
    def shooting(equations: Any, x: np.ndarray, tolerance: float, max_iterations: int) -> Any:
        return x - equations.evaluate(x)

    other = iota.System()
    solution = iota.solve(lambda x: [x[0] - other.body().slot * 0 - 3], [1.0], method="stubborn")
    assert solution.x[0] == 3, "equations of the script may use a system"
