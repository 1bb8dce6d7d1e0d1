# SPDX-License-Identifier: Apache-2.0
"""What decides about levels: the price of work, the speed that counts, and exchanges between things."""

from __future__ import annotations

import random

import pytest

import iota
from iota.levels.connections import MOST_TOGETHER, Connections, Together
from iota.levels.contact_share import CALM, ContactShare
from iota.levels.managed import Managed
from iota.levels.step_time import StepTime

DT = 1 / 120


def test_the_price_of_work_leaves_out_what_each_step_takes() -> None:
    """3 ms for all that stands still and for management, whatever moves."""
    time, price, fixed = StepTime(), 2e-3, 3.0
    for step in range(400):
        work = max(20_000 * 0.9**step, 1000.0)
        time.take(fixed + price * work, fixed + price * work, work, step)
    assert time.ms_of_work == pytest.approx(price, rel=0.15), "a step divided by its work: 5e-3"
    for step in range(400):  # another program makes all slower, while the work is the same
        time.take(2 * (fixed + price * 1000), 2 * (fixed + price * 1000), 1000.0, step)
    assert price <= time.ms_of_work <= 2 * price + fixed / 1000


def test_contacts_become_exact_again_where_levels_fill_the_budget() -> None:
    share = ContactShare(iota.System())
    share._system.contacts_share = 0.5
    found = [share.look(ms=9.0 if step % 10 == 0 else 6.0, limit=10.0, room=0.75) for step in range(2 * CALM)]
    assert found.count((0.5, 1.0)) == 1


def pendulums(count: int) -> tuple[iota.World, list[Managed]]:
    """Far from the viewer, and from each other."""
    world = iota.World(iota.System(), ground=None)
    world.levels.viewers = lambda: [(0.0, 0.0, 20.0)]
    things = []
    for number in range(count):
        top = iota.Vec3(10.0 * number, 0, 0)
        body = world.system.body()
        nail, bob = body.particle(top), body.particle(top + (0.6, -0.8, 0))
        nail.nail()
        bob.mass = 1
        things.append(world.levels.manage(body, levels=["full", "frozen"]))
    return world, things


def test_what_swings_matters_at_its_ends_too() -> None:
    world, _ = pendulums(1)
    world.levels.budget_ms = 1e4
    for _ in range(120):
        world.step()
    found = []
    for _ in range(240):
        world.step()
        found.append(float(world.levels._arrays.significance[0]))
    assert min(found) > 0.4 * max(found), "its speed falls to 0 at each end"


@pytest.mark.parametrize(("other", "changes"), [(100.0, True), (1.5, False)])
def test_what_matters_much_more_takes_the_place_of_another_thing(
    monkeypatch: pytest.MonkeyPatch, other: float, changes: bool
) -> None:
    """Steps take as long as they may, so that nobody is over budget and nothing has room."""
    world, (first, second) = pendulums(2)
    first.significance, second.significance = lambda thing: 1.0, lambda thing: other
    levels = world.levels
    levels.budget_ms = 10.0
    for _ in range(60):
        world.step()
    monkeypatch.setattr(levels._time, "take", lambda *given: None)
    levels._time.ms, levels._time.full, levels._time.ms_of_work = 6.9, 0.75, 1e-3
    levels._change(second, 1, 0.0, 0.0, "test")
    for _ in range(120):
        world.step()
    assert [first.level.name, second.level.name] == (["frozen", "full"] if changes else ["full", "frozen"])
    assert len(levels.changes) == (3 if changes else 1), "no more than that"
    if changes:
        assert levels.changes[1].reason == "others matter more"


def test_what_cannot_be_frozen_is_not_tried_in_each_step(monkeypatch: pytest.MonkeyPatch) -> None:
    """A heap of 400 boxes took 72 ms a step instead of 34: 38 ms to find again and again that it stays full."""
    system = iota.System()
    system.rest_after = 1e9
    world = iota.World(system, ground=0.0)
    dice = random.Random(0)
    for number in range(MOST_TOGETHER + 72):
        x, y, z = number % 6, number // 36, number // 6 % 6
        at = (100 + 0.31 * x + 0.02 * dice.random(), 0.15 + 0.31 * y, 0.31 * z + 0.02 * dice.random())
        system.body(shape=iota.Box((0.3, 0.3, 0.3)), mass=3, position=at)
    world.levels.viewers = lambda: [(0, 1.7, 0)]
    tries = 0
    solved_with = Connections.solved_with

    def counted(self: Connections, thing: Managed) -> Together:
        nonlocal tries
        tries += 1
        return solved_with(self, thing)

    monkeypatch.setattr(Connections, "solved_with", counted)
    world.levels.budget_ms = 1e-6
    for _ in range(120):
        world.step()
    assert 0 < tries < 40, "once for each part of it, and again after 60 steps"
