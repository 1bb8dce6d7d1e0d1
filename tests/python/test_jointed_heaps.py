# SPDX-License-Identifier: Apache-2.0
"""Rooms full of things that people join while they fall: no step takes more than a blow may."""

from __future__ import annotations

import random
from typing import Literal

import pytest

import iota

DT = 1 / 60


def room(
    count: int, seed: int, mode: Literal["robust", "energy_keeping"]
) -> tuple[iota.System, list[iota.Body], random.Random]:
    """Things of different masses fall into a room."""
    at = random.Random(seed)
    system = iota.System(mode=mode, threads=1)
    system.usual_material = iota.Material(friction=0.5)
    system.obstacle(iota.HalfSpace((0, 1, 0)))
    for x, z in ((1, 0), (-1, 0), (0, 1), (0, -1)):
        system.obstacle(iota.HalfSpace((-x, 0, -z)), position=(x, 0, z))
    things = []
    for number in range(count):
        size = at.uniform(0.15, 0.4)
        shape = at.choice((iota.Box((size, size / 3, size / 2)), iota.Box((size,) * 3), iota.Capsule(size / 4, size)))
        place = (at.uniform(-0.8, 0.8), 0.3 + 0.12 * number, at.uniform(-0.8, 0.8))
        turn = ((at.gauss(0, 1), at.gauss(0, 1), at.gauss(0, 1)), at.uniform(0, 180))
        density = at.choice((200, 1000, 3000))
        things.append(system.body(shape=shape, density=density, position=place, orientation=turn))
    return system, things, at


def join_some(system: iota.System, things: list[iota.Body], at: random.Random) -> None:
    """One thing with the nearest other one, or with the world."""
    one = at.choice(things)
    other = min((each for each in things if each is not one), key=lambda each: abs(each.position - one.position))
    middle = (one.position + other.position) * 0.5
    at.choice(
        (
            lambda: system.revolute(one, other, at=middle, axis=(at.gauss(0, 1), at.gauss(0, 1), at.gauss(0, 1))),
            lambda: system.ball(one, other, at=middle),
            lambda: system.weld(one, other, at=middle),
            lambda: system.revolute(one, None, at=one.position, axis=(0, 0, 1)),
        )
    )()


def play(system: iota.System, things: list[iota.Body], at: random.Random, steps: int) -> list[int]:
    """Returns the iterations of each step, of all islands, of what was stored."""
    found = []
    for step in range(steps):
        if step >= 60 and step % 10 == 0:
            join_some(system, things, at)
        system.step(DT)
        found.append(sum(island.iterations for island in system.islands()))
    return found


@pytest.mark.parametrize(("mode", "seed"), [("energy_keeping", 3), ("energy_keeping", 6), ("robust", 2), ("robust", 3)])
def test_no_step_takes_thousands_of_iterations(mode: Literal["robust", "energy_keeping"], seed: int) -> None:
    """With forty things single steps took 700 to 6200 iterations, up to two seconds."""
    system, things, at = room(40, seed, mode)
    assert max(play(system, things, at, steps=130)) < 500
    assert system.validate() == []
