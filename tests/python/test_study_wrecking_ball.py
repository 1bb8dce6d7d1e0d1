# SPDX-License-Identifier: Apache-2.0
"""The wrecking ball: it goes through the pillars on exact links, and what it has not met stands."""

from __future__ import annotations

import numpy as np
import pytest
from solved_steps import solved_steps

import iota
from iota.studies import wrecking_ball


def build() -> tuple[iota.World, wrecking_ball.Wrecker]:
    world = wrecking_ball.make_world()
    return world, wrecking_ball.Wrecker(world)


def run(world: iota.World, made: wrecking_ball.Wrecker, seconds: float) -> float:
    """Returns the widest gap between links, and between the last one and the ball, m, from their places."""
    widest = 0.0
    for _ in solved_steps(world, seconds, gap=1e-4):  # where bricks jam, sweeps may leave 4e-5 m
        ends = [[particle.position for particle in link.particles[:2]] for link in made.chain]
        lengths = [abs(lower - upper) for upper, lower in ends]
        widest = max(widest, *(abs(length - wrecking_ball.LENGTH / wrecking_ball.LINKS) for length in lengths))
        widest = max(widest, abs(abs(ends[-1][1] - made.ball.center_of_mass) - wrecking_ball.RADIUS))
        widest = max(widest, abs(ends[0][0] - wrecking_ball.HOOK))
    return widest


def fallen(made: wrecking_ball.Wrecker) -> list[bool]:
    """Of each brick, whether it lies lower than it stood."""
    rows = np.arange(len(made.bricks)) % wrecking_ball.ROWS
    heights = np.array([brick.center_of_mass.y for brick in made.bricks])
    return list(heights < wrecking_ball.BRICK * (rows + 0.5) - 0.5 * wrecking_ball.BRICK)


def test_the_ball_goes_through_the_pillars_and_its_chain_stays_together() -> None:
    world, made = build()
    farthest = widest = 0.0
    while world.system.time < 4:
        widest = max(widest, run(world, made, world.dt))
        farthest = max(farthest, made.ball.center_of_mass.x)
    assert farthest > wrecking_ball.RADIUS + wrecking_ball.BRICK, "it has passed where they stood"
    assert widest < 1e-6
    down = fallen(made)
    assert sum(down) >= len(down) / 3
    ways = [abs(brick.center_of_mass.x) for brick in made.bricks]
    assert max(ways) > 4 * wrecking_ball.BRICK
    places = [brick.center_of_mass for brick in made.bricks]
    assert min(place.y for place in places) > 0.5 * wrecking_ball.BRICK - 1e-6, "none is in the ground"
    # A step by sweeps may leave 4e-5 m, with which bricks fall asleep.
    assert min(abs(p - q) for n, p in enumerate(places) for q in places[:n]) > wrecking_ball.BRICK - 4e-5
    outer = [*range(wrecking_ball.ROWS), *range(len(places) - wrecking_ball.ROWS, len(places))]
    assert any(abs(places[n].x) < 1e-3 for n in outer), "the ball is not as wide as the row"


def test_energy_never_rises_after_the_ball_is_let_go() -> None:
    world, made = build()
    run(world, made, 1.3)
    before = world.system.energy.total
    for _ in range(240):
        run(world, made, world.dt)
        assert world.system.energy.total < before + 1e-6 * abs(before)
        before = world.system.energy.total


def test_it_is_held_back_until_it_is_let_go_and_is_drawn_back_again() -> None:
    world, made = build()
    start = made.ball.center_of_mass
    run(world, made, 1.0)
    assert abs(made.ball.center_of_mass - start) < 0.05
    world._state.actions["let go"].hook.function()
    for _ in solved_steps(world, 2.0, gap=1e-3):  # a blow may be taken contact by contact
        pass
    assert made.ball.center_of_mass.x > start.x + 1
    world._state.actions["build anew"].hook.function()
    world.step()
    assert made.rope.active and abs(made.ball.center_of_mass - start) < 0.01
    assert not any(fallen(made))
    assert world.system.time == pytest.approx(world.dt)
