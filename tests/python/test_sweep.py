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
        scene = sweep.Scene()
        count = len(sweep.bad_values(scene, arguments[argument]))
        for number in range(count):
            scene = sweep.Scene()
            function, given = sweep.calls(scene)[name]
            given[argument] = sweep.bad_values(scene, given[argument])[number]
            told = f"{name}: {argument} = {given[argument]!r:.80}"
            before = scene.system.state_hash()
            error = sweep.refused(function, given)
            if error is not None:
                assert len(str(error)) >= 10, f"{told}: {error!r}"
                assert scene.system.state_hash() == before, f"{told} was refused, but something changed: {error}"
            try:
                sweep.check(scene)
            except AssertionError as failed:
                raise AssertionError(f"{told}, {'refused' if error else 'accepted'}: {failed}") from failed


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
