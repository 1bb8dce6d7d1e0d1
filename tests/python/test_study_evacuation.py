# SPDX-License-Identifier: Apache-2.0
"""The evacuation: flows through doors against published ones, doors that are shut, and who comes back."""

from __future__ import annotations

import numpy as np
import pytest

import iota
from iota.studies import evacuation


def leave(width: float, people: int, wanted: float = evacuation.SPEED) -> tuple[float, evacuation.Evacuation]:
    """The flow through a door, people a second, between a sixth and two thirds of them."""
    world = iota.World(iota.System(gravity=(0, 0, 0)), ground=0.0, dt=1 / 60)
    made = evacuation.Evacuation(world, evacuation.hall(width, people))
    made.wanted = wanted
    (gate,) = made.plan.gates
    begin, end = people // 6, 2 * people // 3
    while len(gate.passed) <= end and world.system.time < 120:
        world.step()
    return (end - begin) / (gate.passed[end] - gate.passed[begin]), made


@pytest.mark.parametrize("width", [1.0, 1.6])
def test_the_flow_through_a_door_is_between_the_published_ones(width: float) -> None:
    flow, _ = leave(width, 60)
    assert (
        1.0 < flow / width < 2.2
    )  # persons per meter and second: 1.3 (Weidmann) for planning, 1.9 (Seyfried) measured


def test_a_wider_door_lets_more_people_out_and_those_who_stroll_fewer() -> None:
    narrow, wide, slow = leave(1.0, 50)[0], leave(2.0, 50)[0], leave(2.0, 50, 0.6)[0]
    assert wide > 1.7 * narrow
    assert slow < 0.7 * wide


def test_nobody_goes_through_a_wall_or_another_one() -> None:
    _, made = leave(1.2, 60)
    for _ in range(60):
        made.world.step()
        places = made.where()
        inside = places[:, 0] < 0
        assert (np.abs(places[inside, 1]) < 5).all() and (places[inside, 0] > -10).all()
    there = places[[body.kind == "dynamic" for body in made.people]]
    apart = np.linalg.norm(there[:, None] - there, axis=2) + 9 * np.eye(len(there))
    assert apart.min() > 0.5 * 2 * evacuation.RADIUS


def study(people: int) -> tuple[iota.World, evacuation.Evacuation]:
    world = evacuation.build(people)
    made = next(hook.function.__self__ for hook in world._state.listeners.on_step)
    return world, made


def test_all_leave_the_building_and_come_back() -> None:
    world, made = study(8)
    while made.gone < 32:
        world.step()
        assert world.system.time < 60
    assert [len(gate.passed) for gate in made.plan.gates[:4]] == [8, 8, 8, 8]
    assert sum(len(gate.passed) for gate in made.plan.gates[4:]) == 32
    since = world.system.time
    while made.gone:
        world.step()
        assert world.system.time < since + evacuation.END + 0.1
    assert np.abs(made.points.positions - made.start).max() < 0.01


def test_who_finds_an_exit_shut_takes_the_other_one_and_waits_if_there_is_none() -> None:
    world, made = study(5)
    west, east = made.plan.gates[4:]
    assert west.hinge is not None and east.hinge is not None
    world.controls.act("shut", east.hinge.a)
    while made.gone < 20:
        world.step()
        assert world.system.time < 90
    assert not east.is_open and len(east.passed) == 0 and len(west.passed) == 20
    assert 0 < west.passed[0] < 10, "sooner than the time in which nobody leaves below"
    world.controls.act("shut", west.hinge.a)
    world.controls.act("anew")
    for _ in range(60 * 12):
        world.step()
    assert made.gone == 0 and len(west.passed) == 0
    world.controls.act("shut", east.hinge.a)
    while made.gone < 20:
        world.step()
        assert world.system.time < 240
    assert len(east.passed) == 20


def test_a_door_is_shut_by_hand_too() -> None:
    world, made = study(1)
    gate = made.plan.gates[5]
    assert gate.hinge is not None and gate.is_open
    leaf = gate.hinge.a
    for _ in range(120):
        torque = -200.0 if gate.hinge.angle.value > 0.1 else 0.0
        leaf.apply_torque(gate.hinge.axis * torque)
        world.step()
    assert not gate.is_open


def test_a_reset_brings_everybody_and_all_doors_back() -> None:
    world, made = study(3)
    assert made.plan.gates[5].hinge is not None
    world.step()
    world.controls.act("shut", made.plan.gates[5].hinge.a)
    for _ in range(600):
        world.step()
    world.reset()
    world.step()
    assert made.gone == 0 and all(gate.is_open and not gate.passed for gate in made.plan.gates)
    world.controls.act("shut", made.plan.gates[5].hinge.a)
    for _ in range(180):
        world.step()
    assert not made.plan.gates[5].is_open
