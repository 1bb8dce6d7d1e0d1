# SPDX-License-Identifier: Apache-2.0
"""Ropes over a beam: they hold what Euler's formula says, and no more."""

from __future__ import annotations

import math

import pytest
from solved_steps import run_solved

import iota
from iota.studies import capstan

ROD = 0.03  # of the hanging parts, m


def build(share: float) -> tuple[iota.World, capstan.Capstan]:
    """share: of the tension of a load, of exp(mu angle) times that on the other side; both with the rope that hangs there."""
    weight, slack, taut = capstan.COUNTERWEIGHT, *(capstan.ROPE_MASS * length / ROD for length in capstan.HANGING)
    ratios = [
        (share * math.exp(capstan.FRICTION * 2 * math.pi * turns) * (weight + slack) - taut) / weight
        for turns in (0.5, 1.5)
    ]
    world = capstan.make_world()
    return world, capstan.Capstan(world, (ratios[0], ratios[1]))


def rods_of(made: capstan.Capstan) -> list[float]:
    """Their lengths, m."""
    rods = [rod for rope in made.ropes for rod in rope.rods]
    return [abs(rod.particles[0].position - rod.particles[1].position) for rod in rods]


@pytest.mark.parametrize("share", [0.85, 1.15])
def test_a_rope_holds_its_load_up_to_the_formula_of_euler(share: float) -> None:
    world, made = build(share)
    before = [rope.load.position.y for rope in made.ropes]
    run_solved(world, 0.6, gap=1e-4)
    fallen = [height - rope.load.position.y for height, rope in zip(before, made.ropes, strict=True)]
    if share < 1:
        assert max(map(abs, fallen)) < 1e-4
    else:
        assert min(fallen) > 0.02


def test_a_load_runs_down_while_its_counterweight_is_lifted_and_is_held_then() -> None:
    world = capstan.make_world()
    made = capstan.Capstan(world)
    over, around = made.ropes
    lengths = rods_of(made)
    start = over.load.position.y, around.load.position.y
    run_solved(world, 2.8, gap=1e-4)
    lower = around.load.position.y
    assert lower < start[1] - 0.08 and abs(over.load.position.y - start[0]) < 1e-4
    run_solved(world, 0.4, gap=1e-4)
    assert abs(around.load.position.y - lower) < 1e-3
    assert max(abs(length - other) for length, other in zip(rods_of(made), lengths, strict=True)) < 1e-6
