# SPDX-License-Identifier: Apache-2.0
"""Every argument of every call, one after the other, given what it should not be: refused in words, with the system as it
was, or accepted, with the system whole and finite afterwards."""

from __future__ import annotations

from typing import Any

import pytest
import sweep

import iota

NAMES = list(sweep.calls(sweep.Scene()))


@pytest.mark.parametrize("name", NAMES)
def test_good_arguments_are_taken(name: str) -> None:
    scene = sweep.Scene()
    function, arguments = sweep.calls(scene)[name]
    assert sweep.refused(function, arguments) is None
    sweep.check(scene)


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")
def test_bad_arguments_are_refused_or_harmless(name: str) -> None:
    _, arguments = sweep.calls(sweep.Scene())[name]
    for argument in arguments:
        if argument in sweep.HANDLES:
            continue
        number, count = 0, 1
        while number < count:
            number, count = give_until_accepted(name, argument, number)


def give_until_accepted(name: str, argument: str, number: int) -> tuple[int, int]:
    """Gives a fresh scene the bad values from a number on until one is accepted, as a refused one changes nothing. Returns the number of
    the next one, and how many there are."""
    scene, refusals, error = sweep.Scene(), [], None
    function, good = sweep.calls(scene)[name]
    values = sweep.bad_values(scene, good[argument])
    before, told = scene.system.state_hash(), f"{name}: {argument}"
    while number < len(values):
        told = f"{name}: {argument} = {values[number]!r:.80}"
        error = sweep.refused(function, {**good, argument: values[number]})
        number += 1
        if error is None:
            break
        assert len(str(error)) >= 10, f"{told}: {error!r}"
        assert scene.system.state_hash() == before, f"{told} was refused, but something changed: {error}"
        refusals.append(told)
    try:
        sweep.check(scene)
    except AssertionError as failed:
        how = "refused" if error else "accepted"
        raise AssertionError(f"{told}, {how}, after the refusals {refusals}: {failed}") from failed
    return number, len(values)


def ends(scene: sweep.Scene) -> dict[str, Any]:
    return {
        "body of a joint": scene.box,
        "body of a hand": scene.rods[3],
        "body of a closing": scene.ball,
        "body in the middle": scene.rods[1],
        "marker of a joint": next(p for p in scene.hinge.particles if p.mass == 0),
        "particle of a bond": scene.p,
        "particle of a rope": scene.point,
        "particle of a closing": scene.pole,
        "particle of a cosmetic bond": scene.plate.particles[0],
        "nailed particle": scene.rods[0].particles[0],
        "joint": scene.hinge,
        "rope": scene.rope,
        "bond": scene.script,
        "grip": scene.grip,
    }


@pytest.mark.parametrize("name", list(ends(sweep.Scene())))
def test_a_thing_that_others_refer_to_may_be_destroyed(name: str) -> None:
    scene = sweep.Scene()
    thing = ends(scene)[name]
    refused = sweep.refused(thing.destroy, {})
    if refused is None:
        for attribute in ("position", "kind", "ends", "gap"):
            if hasattr(type(thing), attribute):
                with pytest.raises(iota.StaleIdError, match=r"gone|destroyed|was let go"):
                    getattr(thing, attribute)
        with pytest.raises(iota.StaleIdError):
            thing.destroy()
    sweep.check(scene, steps=5)


def test_destroying_everything_in_any_order_leaves_an_empty_whole_system() -> None:
    for backwards in (False, True):
        scene = sweep.Scene()
        everything = [*scene.system.constraints, *scene.system.bonds, *scene.system.particles, *scene.system.bodies]
        for thing in reversed(everything) if backwards else everything:
            if thing.alive:
                assert sweep.refused(thing.destroy, {}) is None or thing.alive
                assert scene.system.validate() == []
        for body in scene.system.bodies:
            body.destroy()
        assert scene.system.particles == [] and scene.system.constraints == [] and scene.system.bonds == []
        sweep.check(scene)
