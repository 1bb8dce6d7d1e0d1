# SPDX-License-Identifier: Apache-2.0
"""How often one page may call functions of the script."""

from __future__ import annotations

import time
from collections.abc import Callable

import pytest
from page_client import PageClient

import iota
from iota import _protocol as protocol
from iota.world import tools
from iota.world.inputs import share_of
from iota.world.pace import Pace

Runner = Callable[[iota.World], str]


def test_a_page_has_thirty_actions_at_once_and_a_second_and_others_have_their_own() -> None:
    now = 0.0
    pace = Pace(lambda: now)
    assert sum(pace.allows(1, 1.0) for _ in range(100)) == 30
    assert pace.is_first_refusal(1) and not pace.is_first_refusal(1)
    assert sum(pace.allows(2, 1.0) for _ in range(100)) == 30
    now = 0.5
    assert sum(pace.allows(1, 1.0) for _ in range(100)) == 15
    assert not pace.is_first_refusal(1), "it never stopped"
    now = 10.0
    assert sum(pace.allows(1, 0.1) for _ in range(1000)) in range(299, 302)
    assert all(pace.allows(1, 0.0) for _ in range(1000))
    assert pace.is_first_refusal(1)
    pace.forget(1)
    assert sum(pace.allows(1, 1.0) for _ in range(100)) == 30


def work_of(pages: int, seconds: float, reconnecting: bool = False) -> tuple[float, dict[int, int]]:
    """Pages that want an action at any time, each taking 0.25 s, for 60 s: how long they took, how many of each."""
    now, took, calls, last = 0.0, 0.0, dict.fromkeys(range(1, pages + 1), 0), pages
    pace = Pace(lambda: now)
    ids = {page: page for page in calls}
    while now < 60:
        for page in calls:
            if pace.allows(ids[page], 1.0):
                now, took = now + seconds, took + seconds
                pace.charge(ids[page], seconds)
                calls[page] += 1
                if reconnecting:
                    last += 1
                    pace.forget(ids[page])
                    ids[page] = last
        now += 0.01
    return took, calls


def test_what_pages_let_the_script_do_takes_at_most_half_of_the_time_however_many_they_are() -> None:
    for pages in (1, 2, 40):
        took, calls = work_of(pages, 0.25)
        assert 20 < took < 33
        assert max(calls.values()) <= min(calls.values()) + 3, "each has its part"
    assert 20 < work_of(40, 0.25, reconnecting=True)[0] < 33, "a new connection begins with no more work than all have"


def test_bodies_count_as_tenths_of_an_action() -> None:
    ids = tuple(protocol.Id(slot, 1) for slot in range(4096))
    assert share_of(protocol.Action("copy", ids[0], ())) == 1
    assert share_of(protocol.Action("copy", ids[0], ids[:50])) == pytest.approx(6)
    assert share_of(protocol.Action("copy", ids[0], ids)) == 30


def test_users_copy_until_that_is_enough(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(tools, "MOST_COPIES", 10)
    system = iota.System()
    bodies = [system.body() for _ in range(4)]
    for number, body in enumerate(bodies):
        body.particle((number, 0, 0), mass=1)
    world = iota.World(system)
    world.offer("copy")
    titles: list[str] = []
    world._state.notices.show = lambda client, level, title, *more, **rest: titles.append(title)
    for _ in range(5):
        world._inputs.act(world._state.actions["copy"], 1, list(system.bodies))
    assert len(system.bodies) == 14 and set(titles) == {"That is enough"}
    for body in list(system.bodies)[4:]:
        body.destroy()
    world._inputs.act(world._state.actions["copy"], 1, bodies)
    assert len(system.bodies) == 8


def test_a_world_for_users_gives_up_a_step_after_a_time_unless_its_script_says_otherwise(run_world: Runner) -> None:
    own = iota.System()
    own.budget_iterations = 40
    for system, seconds in ((iota.System(), 2.0), (own, 0.0)):
        world = iota.World(system)
        assert system.budget_seconds == 0
        run_world(world)
        assert world.call(lambda system=system: system.budget_seconds) == seconds


def test_what_an_action_takes_counts_as_more_actions() -> None:
    world, calls = iota.World(iota.System()), []

    @world.action("slow", key="s", on="world")
    def slow() -> None:
        calls.append(0)
        time.sleep(0.1)

    joins = protocol.Join("one", protocol.Role.ACTOR)
    acts = [protocol.Action("slow", protocol.Id(0, 0), ())] * 30
    world._inputs.take([(1, joins), *((1, act) for act in acts)], lambda ids: [])
    assert 1 < len(calls) < 15, "each is as three that take no time, less what has come back meanwhile"


def test_a_page_that_floods_the_world_with_actions_holds_up_nobody(run_world: Runner) -> None:
    system = iota.System()
    chain = iota.builder.chain(links=24, length=1.2, top=(0, 2, 0)).realize(system)
    world = iota.World(system)
    world.offer("break", "join")
    calls = []

    @world.action("count", key="n", on="world")
    def count(event: iota.Event) -> None:
        calls.append(event.client)
        time.sleep(0.002)

    assert chain
    url = run_world(world)
    with PageClient(url) as other, PageClient(url) as page:
        began, step = time.monotonic(), other.last["poses"]["step"]
        while time.monotonic() < began + 2:
            for _ in range(20):
                page.send("action", name="count", body=(0, 0))
            time.sleep(0.005)
        other.send("action", name="count", body=(0, 0))
        other.wait_for(lambda: other.id in calls)
        assert calls.count(page.id) <= 30 * (1 + time.monotonic() - began)
        assert other.last["poses"]["step"] > step + 30, "the world goes on"
        page.wait_for(lambda: page.notices)
        assert {card["title"] for card in page.notices} == {"Too fast"} and not other.notices
        # One more card for each half second that this process or the server is held up: the page has stopped meanwhile.
        assert len(page.notices) <= 1 + 2 * (time.monotonic() - began)
