# SPDX-License-Identifier: Apache-2.0
"""The run of marbles: all arrive in the box that the flap chooses, and none gains energy on the way."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import pytest
from solved_steps import run_solved

import iota
from iota.studies import marbles

SECONDS = 12.0  # until the last one has arrived


def build() -> tuple[iota.World, marbles.Run]:
    world = iota.World(iota.System())
    marbles.present(world)
    return world, marbles.Run(world)


def in_box(made: marbles.Run, number: int) -> int:
    """How many marbles lie in a box, on its floor."""
    wide, _, deep = marbles.BOX
    places = [marble.center_of_mass for marble in made.marbles]
    return sum(
        abs(place.x - marbles.BOXES[number]) < wide / 2
        and abs(place.z) < deep / 2
        and abs(place.y - marbles.WALL - marbles.RADIUS) < 1e-6
        for place in places
    )


@dataclass
class Rolled:
    """A run to its end: the energy after each step, and where the marbles were after each sixth one."""

    made: marbles.Run
    energies: list[float]
    places: list[list[iota.Vec3]]


@pytest.fixture(scope="module")
def rolled() -> Rolled:
    world, made = build()
    run = Rolled(made, [world.system.energy.total], [])
    for step in range(round(SECONDS / world.dt)):
        run_solved(world, world.dt)
        run.energies.append(world.system.energy.total)
        if step % 6 == 0:
            run.places.append([marble.center_of_mass for marble in made.marbles])
    return run


def test_all_marbles_arrive_in_the_box_that_the_flap_chooses(rolled: Rolled) -> None:
    assert rolled.made.flap.angle.value == pytest.approx(marbles.SIDE, abs=1e-6)
    assert [in_box(rolled.made, 0), in_box(rolled.made, 1)] == [0, marbles.MARBLES]


def test_all_marbles_arrive_in_the_other_box_when_the_flap_is_thrown() -> None:
    world, made = build()
    world._state.actions["switch"].hook.function()
    run_solved(world, SECONDS)
    assert made.flap.angle.value == pytest.approx(-marbles.SIDE, abs=1e-6)
    assert [in_box(made, 0), in_box(made, 1)] == [marbles.MARBLES, 0]


def test_energy_never_rises(rolled: Rolled) -> None:
    first = rolled.energies[0]
    assert all(now <= before + 1e-9 * first for before, now in pairwise(rolled.energies))
    assert rolled.energies[-1] < 0.2 * first


def test_no_marble_is_in_another_one_or_leaves_its_gutter(rolled: Rolled) -> None:
    for places in rolled.places:
        for place in places:
            assert place.y < marbles.BOX[1] + 0.3 or abs(place.z) < marbles.WIDTH / 2
        assert min(abs(p - q) for n, p in enumerate(places) for q in places[:n]) > 2 * marbles.RADIUS - 1e-6


def test_they_roll_once_more() -> None:
    world, made = build()
    run_solved(world, 1.5)
    world._state.actions["again"].hook.function()
    assert all(abs(marble.position - place) < 1e-12 for marble, place in made.start.items())
    run_solved(world, SECONDS)
    assert in_box(made, 1) == marbles.MARBLES
