# SPDX-License-Identifier: Apache-2.0
"""Heaps are solved less exactly where steps take too long, and exactly again where there is room."""

from __future__ import annotations

import math
from unittest import mock

import pytest

import iota
from iota.levels import contact_share
from iota.levels.contact_share import LEAST, LONGEST_CALM, ContactShare
from iota.levels.level import Level
from iota.levels.managed import Managed
from iota.world.clients import Client

DT = 1 / 120


def wall(system: iota.System, rows: int = 4, columns: int = 4) -> list[iota.Body]:
    system.usual_material = iota.Material()
    return [
        system.body(
            shape=iota.Box((0.39, 0.2, 0.2)), mass=10, position=(0.4 * column + 0.2 * (row % 2), 0.1 + 0.2 * row, 0)
        )
        for row in range(rows)
        for column in range(columns)
    ]


def touching() -> iota.System:
    system = iota.System()
    wall(system)
    system.obstacle(iota.HalfSpace())
    system.step(DT)
    return system


def test_it_falls_by_halves_while_steps_take_too_long_and_rises_where_there_is_room() -> None:
    system = touching()
    share = ContactShare(system)
    found = []
    for _ in range(40):
        share.look(ms=9.0, limit=8.0)
        found.append(system.contacts_share)
    assert found[:5] == [1, 0.5, 0.5, 0.25, 0.25] and min(found) == found[-1] == LEAST
    for _ in range(5 * contact_share.CALM):
        share.look(ms=3.0, limit=8.0)
    assert system.contacts_share == 1


def test_it_falls_by_more_where_steps_take_many_times_too_long() -> None:
    system = touching()
    share = ContactShare(system)
    assert [share.look(ms=ms, limit=8.0) for ms in (70.0, 50.0)] == [None, (1, 0.25)], "by the shorter one of both"
    assert [share.look(ms=ms, limit=8.0) for ms in (999.0, 1e9)] == [None, (0.25, LEAST)]


@pytest.mark.parametrize("rare", [2, 5, 20])
def test_it_rises_where_most_steps_have_room(rare: int) -> None:
    """Levels fill a budget to the share that they have learnt. It never rose again there: half of the budget was never free."""
    system = touching()
    share = ContactShare(system)
    for _ in range(40):
        share.look(ms=9.0, limit=8.0, room=0.8)
    for step in range(8 * contact_share.CALM):
        share.look(ms=7.0 if step % rare == 0 else 6.0, limit=8.0, room=0.8)
    assert system.contacts_share == (LEAST if rare == 2 else 1)


def test_a_single_long_step_changes_nothing() -> None:
    system = touching()
    share = ContactShare(system)
    for step in range(200):
        assert share.look(ms=50.0 if step % 20 == 0 else 2.0, limit=8.0) is None
    assert system.contacts_share == 1


def test_it_waits_longer_each_time_that_it_rose_too_early() -> None:
    system = touching()
    share = ContactShare(system)
    waits = []
    for _ in range(8):
        while system.contacts_share == 1:
            share.look(ms=9.0, limit=8.0)
        count = 0
        while system.contacts_share < 1:
            share.look(ms=1.0, limit=8.0)
            count += 1
        waits.append(count)
    assert waits == sorted(waits) and waits[0] == contact_share.CALM and waits[-1] == LONGEST_CALM


def test_it_stays_where_other_things_than_contacts_take_the_time() -> None:
    system = touching()
    iota.builder.chain(links=400, length=40, top=(0, 50, 9), direction=(1, 0, 0)).realize(system)
    system.step(DT)
    share = ContactShare(system)
    for _ in range(40):
        assert share.look(ms=20.0, limit=8.0) is None
    assert system.contacts_share == 1


def test_a_wall_is_swept_only_as_long_as_its_share_is_too_small() -> None:
    system = touching()
    assert system.step(DT).approximate == 0
    system.budget_contacts, system.contacts_share = 2.5e7, LEAST
    assert system.step(DT).approximate == 1
    system.contacts_share = 1
    for _ in range(40):
        report = system.step(DT)
    assert report.approximate == 0 and system.budget_contacts == 2.5e7


def test_a_script_that_wants_all_contacts_exact_has_them() -> None:
    system = touching()
    system.budget_contacts, system.contacts_share = 0, LEAST
    assert system.step(DT).approximate == 0


def test_a_world_with_a_budget_lowers_it_tells_so_and_gives_it_back() -> None:
    system = iota.System()
    world = iota.World(system)
    wall(system)
    world.levels.viewers = lambda: [(0, 1, 2)]
    world.levels.budget_ms = 1e-6
    for _ in range(20):
        world.step()
    assert system.contacts_share < 1
    change = next(change for change in world.levels.changes if change.thing == "contacts")
    assert (change.before, change.after, change.reason) == (
        "1 of their budget",
        "0.0625 of their budget",
        "over budget",
    )
    assert f"contacts {system.contacts_share:g} of their budget" in str(world.levels)
    world.levels.off()
    assert system.contacts_share == 1 and system.budget_contacts == 3e7


def test_a_world_with_a_budget_that_its_steps_nearly_fill_raises_it_again() -> None:
    system = iota.System()
    world = iota.World(system)
    wall(system)
    world.levels.viewers = lambda: [(0, 1, 2)]  # all is within reach, and full
    world.levels.budget_ms = 1e-6
    for _ in range(20):
        world.step()
    assert system.contacts_share == LEAST
    with mock.patch.object(world.levels._contacts, "look", wraps=world.levels._contacts.look) as look:
        world.levels.budget_ms = 1e3
        world.step()
        ms, limit, room = look.call_args.args
    assert ms < limit == 1e3 and room == world.levels._time.full > contact_share.ROOM
    for _ in range(4 * contact_share.CALM + 20):
        world.levels._contacts.look(0.6 * limit, limit, room)
    assert system.contacts_share == 1


def test_a_world_that_somebody_sees_has_it_without_a_budget_too() -> None:
    system = iota.System()
    world = iota.World(system)
    wall(system)
    levels = world.levels
    world._state.clients.by_id[1] = Client(1)
    levels._keep_pace(1.0, 1e-6)
    for _ in range(20):
        world.step()
    assert system.contacts_share < 1 and levels.budget_ms is None
    assert levels._shown_ms is not None and "contacts" in levels._shown()[1][-1], "pages tell it"
    world._state.clients.by_id.clear()
    levels._keep_pace(1.0, 1e-6)
    assert system.contacts_share == 1, "nobody looks"
    world._state.clients.by_id[1] = Client(1)
    levels.off()
    levels._keep_pace(1.0, 1e-6)
    for _ in range(20):
        world.step()
    assert system.contacts_share == 1, "the script forbids it"


def test_a_level_of_the_script_may_end_the_budget() -> None:
    system = iota.System()
    world = iota.World(system)
    wall(system, 1, 6)

    def end(thing: Managed) -> None:
        world.levels.off()

    world.levels.viewers = lambda: [(0, 1, 50)]
    for body in system.bodies:
        if body.kind == "dynamic":
            world.levels.manage(body, levels=["full", Level("far", share=0.1, quality=0.5, enter=end)])
    world.levels.budget_ms = 1e-6
    for _ in range(60):
        world.step()
    assert world.levels.budget_ms is None and system.contacts_share == 1


def test_an_undo_to_a_time_with_a_small_share_does_not_bring_it_back() -> None:
    system = iota.System()
    world = iota.World(system)
    wall(system)
    world.step()
    system.contacts_share = 0.25
    then = system.snapshot()
    system.contacts_share = 1
    world.step()
    system.restore(then)
    assert system.contacts_share == 0.25
    world.step()
    assert system.contacts_share == 1
    system.restore(system.snapshot())
    system.contacts_share = 0.5
    world.step()
    assert system.contacts_share == 1, "also without a step between them"


def test_it_is_recorded_and_saved() -> None:
    system = touching()
    system.start_recording()
    system.budget_contacts = 3e6
    for share in (1, 0.25, 0.5):
        system.contacts_share = share
        for _ in range(5):
            system.step(DT)
    assert iota.System().replay(system.stop_recording()) is None
    other = iota.System()
    other.restore(system.snapshot())
    assert other.contacts_share == 0.5


@pytest.mark.parametrize("value", [0, -1, 1.01, math.nan, math.inf])
def test_a_share_is_above_0_to_1(value: float) -> None:
    system = touching()
    with pytest.raises(ValueError, match="contacts_share must be above 0 to 1"):
        system.contacts_share = value
    assert system.contacts_share == 1 and system.validate() == []


def test_a_hand_pulls_at_a_heap_with_springs_that_is_solved_by_sweeps() -> None:
    """The forces that sweeps knew by their places were others when a hand came, and the program crashed."""
    system = iota.System()
    boxes = wall(system, rows=4, columns=3)
    system.obstacle(iota.HalfSpace())
    system.budget_contacts = 1
    ends = [box.attachment(box.position) for box in boxes]
    for p, q in zip(ends[::3], ends[1::3], strict=True):
        system.bond(p, q, "energy = 0.5*k*(r - r0)^2", k=50, r0=0.1)
    assert system.step(DT, 30).approximate > 0
    place = boxes[4].position
    grip = system.grip(boxes[4], (0, 0, 0), place + (0, 0, 0.3))
    assert system.step(DT, 30).approximate > 0
    assert boxes[4].position.z > 0.1
    grip.destroy()
    system.step(DT, 30)
    assert abs(ends[0].position - ends[1].position) > 0.38 and system.validate() == []
