# SPDX-License-Identifier: Apache-2.0
"""How often one page may call functions of the script."""

from __future__ import annotations

import time
from collections.abc import Callable

from page_client import PageClient

import iota
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
        assert [card["title"] for card in page.notices] == ["Too fast"] and not other.notices
