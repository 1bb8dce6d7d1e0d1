# SPDX-License-Identifier: Apache-2.0
"""The study of what stands by contact: how still it stands, how dominoes fall, what a missing block brings down."""

from __future__ import annotations

import math

import numpy as np
import pytest
from solved_steps import run_solved

import iota
from iota.studies import stack


def build(rest_after: float = 0.0) -> tuple[iota.World, stack.Stacks]:
    """Without sleep, unless it is asked for: what stands has to be held in every step."""
    system = iota.System()
    system.rest_after = rest_after
    world = iota.World(system)
    stack.present(world)
    return world, stack.Stacks(world)


def tilt(body: iota.Body) -> float:
    """Of its upright axis, rad."""
    x, _, z, _ = body.orientation
    return math.acos(1 - 2 * (x * x + z * z))


def test_towers_stand_still_for_ten_seconds_under_a_thousand_times_their_mass() -> None:
    world, made = build()
    assert made.anvil.mass == pytest.approx(1000 * made.matchboxes[0].mass)
    standing = [*made.tower, *made.matchboxes, made.anvil, *made.pyramid]
    begin = [body.center_of_mass for body in standing]
    run_solved(world, 10.0)
    assert all(body.kind == "dynamic" for body in standing), "none is asleep"
    assert max(abs(body.center_of_mass - place) for body, place in zip(standing, begin, strict=True)) < 1e-6


def test_a_push_runs_through_all_dominoes_as_a_wave_of_constant_speed() -> None:
    world, made = build(0.5)
    times: list[float | None] = [None] * len(made.dominoes)
    while world.system.time < 4:
        run_solved(world, world.dt)
        for number, domino in enumerate(made.dominoes):
            if times[number] is None and tilt(domino) > math.radians(10):
                times[number] = world.system.time
    assert None not in times
    assert min(tilt(domino) for domino in made.dominoes) > math.radians(60), "all have fallen"
    delays = np.diff(np.array(times, float))[5:]  # past its beginning
    assert (delays > 0).all()
    speeds = stack.SPACING / delays.reshape(4, -1).mean(axis=1)
    assert speeds.min() > 0.79 * speeds.max(), speeds
    assert 1 < speeds.mean() < 2, "about 1.5 sqrt(g h)"


def test_what_stands_sleeps_until_it_is_touched() -> None:
    world, made = build(0.5)
    run_solved(world, 0.9)
    assert all(body.kind == "resting" for body in world.system.bodies)
    run_solved(world, 0.5)
    assert made.dominoes[2].kind == "dynamic" and made.tower[0].kind == "resting"


def test_a_block_that_is_pulled_out_brings_those_above_it_down() -> None:
    world, made = build(0.5)
    run_solved(world, 0.6)
    block, above = made.pyramid[5], made.pyramid[7:]  # its pyramid has rows of 4, 3, 2 and 1
    begin = {body: body.center_of_mass for body in above}
    start = block.center_of_mass
    grip = world.system.grip(block)
    for step in range(120):
        grip.move(start + iota.Vec3(0, 0.1, 0.3) * min(1, step / 60))
        run_solved(world, world.dt)
    grip.destroy()
    run_solved(world, 2.0)
    assert block.center_of_mass.z > start.z + 0.2
    fallen = [body for body, place in begin.items() if body.center_of_mass.y < place.y - 0.5 * stack.BLOCK[1]]
    assert len(fallen) == len(above)
    assert max(abs(body.center_of_mass.y - stack.TABLE - 0.5 * stack.BLOCK[1]) for body in made.pyramid[:4]) < 1e-6


def test_everything_is_built_anew() -> None:
    world, made = build(0.5)
    run_solved(world, 3.0)
    made.tower[5].velocity = (0, 0, 2)
    for _ in range(120):
        world.step()
    assert made.tower[9].center_of_mass.y < made.start[made.tower[9]][0].y - 0.01
    world._state.actions["build anew"].hook.function()
    for body, (place, turn) in made.start.items():
        assert abs(body.position - place) < 1e-12
        assert tuple(body.orientation) == pytest.approx(tuple(turn), abs=1e-9)
    run_solved(world, 1.0)
    assert all(body.kind == "resting" for body in world.system.bodies)
    world._state.actions["push"].hook.function()
    run_solved(world, 3.0, gap=1e-3)  # a step may be taken by sweeps
    assert min(tilt(domino) for domino in made.dominoes) > math.radians(60)
