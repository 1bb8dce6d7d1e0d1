# SPDX-License-Identifier: Apache-2.0
from __future__ import annotations

import pytest

import iota
from iota.studies import chain as study
from iota.world.options import RunOptions, use


def run(world: iota.World, seconds: float) -> iota.types.RunSummary:
    with use(RunOptions(headless=True)):
        return world.run(seconds)


def test_it_breaks_and_mends_itself_by_forces() -> None:
    world = study.build()
    system = world.system
    parts: dict[float, int] = {}
    bonds: dict[float, int] = {}

    @world.on_step
    def watch() -> None:
        parts[round(system.time, 2)] = system.articulate_count
        bonds[round(system.time, 2)] = len(system.bonds)

    summary = run(world, 10)
    assert (parts[3.9], parts[4.1], parts[7.9], parts[8.1], parts[9.9]) == (1, 2, 2, 1, 1)
    assert bonds[3.9] == 0 and bonds[5.0] == 1 and bonds[7.0] > 1 and bonds[8.1] == 0
    assert summary.steps == 1200 and summary.articulates == 1
    assert summary.worst_gap_m < 1e-8
    assert summary.energy_max_j <= summary.energy_start_j * (1 + 1e-12)


def test_it_is_alive_at_once_and_the_same_each_time() -> None:
    ends = []
    for _ in range(2):
        world = study.build()
        run(world, 9)
        ends.append(world.system.state_hash())
    assert ends[0] == ends[1]
    world = study.build()
    run(world, 0.5)
    assert world.system.energy.kinetic > 0.5


def test_it_tells_its_story_again_and_waits_for_those_who_touch_it(monkeypatch: pytest.MonkeyPatch) -> None:
    world = study.build()
    falls = []
    world.on_step(lambda: falls.append(world.system.articulate_count == 2))
    run(world, 30)
    begins = [step / 120 for step in range(1, len(falls)) if falls[step] and not falls[step - 1]]
    assert begins == pytest.approx([4, 17], abs=0.3), "5 s of story, 8 s of rest"
    world = study.build()
    monkeypatch.setattr(type(world.users), "held", lambda *_: world.system.bodies[3] if world.system.time < 9 else None)
    run(world, 16)
    assert world.system.articulate_count == 1 and not world.system.bonds, "8 s after the hand"
    run(world, 2)
    assert world.system.articulate_count == 2


def test_the_user_can_ask_for_it() -> None:
    for seconds, parts in ((2, 2), (8, 1)):
        world = study.build()
        world.at(1.0)(world._state.actions["fall apart"].hook.function)
        run(world, seconds)
        assert world.system.articulate_count == parts


@pytest.mark.parametrize("links", [1, 2, 3, 60])
def test_it_runs_with_any_number_of_links(links: int) -> None:
    world = study.build(links=links)
    summary = run(world, 9)
    assert summary.steps == 1080 and summary.articulates == 1  # broken at 4 s, whole again at 8 s
    assert summary.worst_gap_m < 1e-9 and world.system.validate() == []
    assert summary.energy_max_j <= summary.energy_start_j + 1e-12 * abs(summary.energy_start_j)


def test_a_cut_off_part_lies_on_the_floor() -> None:
    world = study.build()
    links = world.system.bodies
    world.at(0.1)(lambda: links[11].particles[1].separate(links[12].particles[0]))
    run(world, 3.5)
    lowest = world.system.positions[:, 1].min()
    assert -0.05 < lowest < 0.1
