# SPDX-License-Identifier: Apache-2.0
"""What the parts of a step cost, as scripts measure it and pages are told."""

from __future__ import annotations

import time
from collections.abc import Callable

import pytest
from page_client import PageClient

import iota
from iota.types import StepTimes
from iota.world.costs import Costs
from iota.world.step_costs import EVERY, PARTS, StepCosts

Runner = Callable[[iota.World], str]


def test_the_times_of_steps_add_up_to_the_passing_time(chain: list[iota.Body]) -> None:
    system = chain[0].system
    system.step()
    with StepTimes() as times:
        began = time.perf_counter()
        for _ in range(200):
            system.step(1 / 240)
        passed = time.perf_counter() - began
    assert 0 < times.total <= passed
    assert times.total == pytest.approx(times.forces + times.analyze + times.factor + times.solve + times.integrate)
    assert min(times.forces, times.factor, times.solve, times.integrate) > 0
    total = times.total
    system.step()
    assert times.total == total, "steps after the block are not timed"
    with times:
        system.step()
        with pytest.raises(RuntimeError, match="in use"), times:
            pass
    assert times.total > total


def test_costs_of_other_parts_are_means_of_a_step() -> None:
    costs = Costs()
    shown = StepCosts(costs)
    for done in (1.0, 3.0):
        costs.seconds = {"pages": 0.016 * done, "script: a": 0.016 * done, "script: b": 0.032 * done, "simulator": 9.0}
        shown.take(StepTimes())
    assert {part: round(ms, 6) for part, ms in shown.ms.items() if part not in PARTS} == {
        "pages": 1e3 * 0.032 / EVERY,
        "script": 1e3 * 0.096 / EVERY,
    }


def test_pages_get_the_parts_of_a_step_while_one_asks(chain: list[iota.Body], run_world: Runner) -> None:
    world = iota.World(chain[0].system)
    calls: list[float] = []

    @world.on_step
    def dawdle() -> None:
        calls.append(0)
        time.sleep(0.002)

    url = run_world(world)
    with PageClient(url) as page, PageClient(url) as other:
        page.wait_for(lambda: page.last["poses"]["step"] > 2 * EVERY)
        assert page.last["world_state"]["costs"] == []
        page.send("profile", on=True)

        def costs(client: PageClient = page) -> dict[str, float]:
            return {cost["part"]: cost["ms"] for cost in client.last["world_state"]["costs"]}

        found = page.wait_for(lambda: costs() if "script" in costs() else None)
        assert found.keys() >= {*PARTS, "pages", "script"} and "simulator" not in found
        assert found["script"] > 2 and 0 < found["factor"] < found["script"]
        other.send("profile", on=True)
        page.send("profile", on=False)
        other.wait_for(lambda: costs(other))
        other.close()
        page.wait_for(lambda: costs() == {})
