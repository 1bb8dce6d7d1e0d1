# SPDX-License-Identifier: Apache-2.0
"""Whatever a script passes to the engine, a refusal is a sentence about what it wrote: no text of the binding's."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import pytest
import sweep

import iota
from iota import _core

# What nanobind, C++ and Python's object system say, and scripts do not.
RAW = re.compile(
    r"incompatible function|no constructor|nanobind|iota\._core|std::|bad_cast|Invoked with|has no setter|NoneType"
)
WRONG: list[Any] = [None, 5, -1, 2.5, 2**70, "word", b"bytes", (), (1,), (1, 2), {1, 2, 3}, {}, [[1, 2], [3]], object()]
# They take the process along, open files or ports, or give the system to another thread.
LEFT_OUT = {"Server", "Room", "load", "save", "adopt", "profile", "replay"}


def instances(scene: sweep.Scene) -> dict[str, Any]:
    """One of each type that a script meets."""
    s = scene.system
    emitted = iota.types.StepReport(step=1, time=0.0, dt=0.1)
    things = [
        s, scene.box, scene.point, scene.surfel, scene.spring, scene.line, scene.hinge, scene.hinge.angle, scene.crowd,
        scene.well, scene.pair_force, scene.law, scene.fountain, scene.grip, emitted, emitted.energy, iota.Vec3(1, 2, 3),
        iota.Box((1, 1, 1)), iota.Sphere(1), s.diagnose(scene.box), scene.rods[0].articulate, s.edit(),
    ]  # fmt: skip
    return {type(thing).__name__: thing for thing in things}


def members(kind: type) -> Iterator[tuple[str, Any]]:
    for name in dir(kind):
        if not name.startswith("_") and name not in LEFT_OUT:
            yield name, getattr(kind, name)


def refusal(call: Callable[[], Any]) -> str:
    """What a call is refused with, with the type of it; empty where it is taken."""
    try:
        call()
    except (TypeError, ValueError, AttributeError, RuntimeError, OverflowError) as error:
        return f"{type(error).__name__}: {error}"
    except Exception:  # of the script's own kind: a stop of an iteration, a missing key
        return ""
    return ""


TYPES = sorted(instances(sweep.Scene()))


@pytest.mark.parametrize("kind", TYPES)
@pytest.mark.filterwarnings(
    "ignore::pytest.PytestUnraisableExceptionWarning", "ignore::numpy.exceptions.VisibleDeprecationWarning"
)
def test_no_method_or_property_answers_wrong_arguments_with_a_raw_text(kind: str) -> None:
    raw = []
    for name, member in members(type(instances(sweep.Scene())[kind])):
        thing = instances(sweep.Scene())[kind]
        calls: list[Callable[[], Any]]
        if isinstance(member, property):
            calls = [lambda t=thing, n=name, v=value: setattr(t, n, v) for value in WRONG]
        else:
            method = getattr(thing, name)
            calls = [
                method,
                lambda m=method: m(no_such_argument=1),
                lambda m=method: m(*range(12)),
                *(lambda m=method, v=value: m(v) for value in WRONG),
                *(lambda m=method, v=value: m(v, v) for value in WRONG),
            ]
            words = re.findall(r"(\w+):", str(getattr(member, "__nb_signature__", ((("",),),))[0][0]))
            calls += [lambda m=method, w=word, v=value: m(**{w: v}) for word in words[1:] for value in WRONG]
        for call in calls:
            if RAW.search(text := refusal(call)):
                raw.append(f"{kind}.{name}: {text[:200]}")
    assert not raw, "\n".join(raw[:20])


@pytest.mark.parametrize("kind", sorted(n for n, t in vars(_core).items() if isinstance(t, type) and n not in LEFT_OUT))
def test_no_type_answers_wrong_arguments_with_a_raw_text(kind: str) -> None:
    make = getattr(_core, kind)
    calls: list[Callable[[], Any]] = [make, lambda: make(no_such_argument=1), lambda: make(*range(12))]
    calls += [lambda v=value: make(v) for value in WRONG] + [lambda v=value: make(v, v) for value in WRONG]
    raw = [text for call in calls if RAW.search(text := refusal(call))]
    assert not raw, "\n".join(raw)


def test_functions_of_the_module_answer_in_sentences() -> None:
    system = iota.System()
    text = refusal(lambda: _core.make_bodies(system, 3, 4, 5, 6))
    assert "make_bodies" in text and not RAW.search(text)


MISTAKES: dict[str, tuple[Callable[[sweep.Scene], Any], str]] = {
    "motor of one number": (
        lambda c: setattr(c.hinge.angle, "motor", 5),
        r"motor must be 2 numbers or None, not 5: \(speed, largest torque or force\)",
    ),
    "mass None": (lambda c: setattr(c.point, "mass", None), "mass must be a number, not None"),
    "a handle called": (lambda c: iota.Particle(c.system), "a Particle is made by Body.particle$"),
    "too many numbers": (lambda c: iota.Box(1, 1, 1), r"Box takes 2 arguments by place \(size, rounding\), not 3"),
    "a particle for a body": (lambda c: c.box.combine(c.point), "combine: other must be a Body, not <Particle"),
    "a body for a particle": (lambda c: c.system.bond(c.box, c.point, "spring"), "bond: p must be a Particle, not <Body"),
    "an attribute as an argument": (
        lambda c: c.box.particle(V, spin=(0, 0, 1)),
        "has no argument 'spin'; assign it to the result: particle.spin = ...",
    ),
    "a misspelled argument": (
        lambda c: c.system.revolute(c.box, c.ball, at=V, axis=V, limit=3),
        r"no argument 'limit'; did you mean 'limits'\? It takes a, b, at,",
    ),
    "a missing argument": (lambda c: c.system.revolute(c.box, c.ball), "revolute needs at: 2 or 3 numbers"),
    "an argument by place": (
        lambda c: c.system.revolute(c.box, c.ball, V, V),
        "by name also at, axis, limits",
    ),
    "a misspelled attribute": (lambda c: setattr(c.point, "postion", V), "no attribute 'postion'; did you mean 'position'"),
    "a read-only attribute": (
        lambda c: setattr(c.hinge, "angle", 0.5),
        r"Constraint.angle can be read but not assigned: it is a JointCoordinate; assign .*\.angle\.motor",
    ),
    "a method": (lambda c: setattr(c.point, "nail", V), "Particle.nail is a method and cannot be assigned"),
    "a set": (lambda c: setattr(c.point, "velocity", {1, 2, 3}), r"velocity must be 2 or 3 numbers, not \{1, 2, 3\}"),
    "density and mass": (
        lambda c: c.system.body(shape=iota.Sphere(1), density=3, mass=1),
        "density or mass",
    ),
    "density without a shape": (lambda c: c.system.body(density=3), "density, mass, position.* are of bodies with a shape"),
    "a spring": (lambda c: c.system.bond(c.p, c.point, "spring"), r"a spring needs stiffness=\.\.\., N/m"),
    "a tether": (lambda c: c.system.bond(c.p, c.point, "tether", length=1), r"a tether needs stiffness"),
}  # fmt: skip
V = (0.1, 0.2, 0.3)


@pytest.mark.parametrize("name", MISTAKES)
def test_a_mistake_is_named(name: str) -> None:
    scene = sweep.Scene()
    before = scene.system.state_hash()
    use, text = MISTAKES[name]
    with pytest.raises((TypeError, ValueError, AttributeError), match=text):
        use(scene)
    assert scene.system.state_hash() == before


def test_good_calls_cost_nothing_more() -> None:
    """Arguments are looked at only after a call was refused."""
    system = iota.System()
    particle = system.body().particle((0, 1, 0))
    particle.velocity = np.array([1.0, 2.0, 3.0])
    assert particle.velocity == (1, 2, 3)
