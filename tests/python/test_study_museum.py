# SPDX-License-Identifier: Apache-2.0
"""The museum: fifty exhibits that work, in full where its visitors look, and less behind walls."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest

import iota
from iota.studies import museum


class Walked:
    """A museum in which only the script's visitor looks. eye: where; None: on the walk."""

    def __init__(self, budget_ms: float | None) -> None:
        self.world = museum.build(budget_ms)
        self.made: museum.Museum = self.world.levels.viewers.__self__  # type: ignore[union-attr]
        self.eye: iota.Vec3 | None = None
        self.world.levels.viewers = lambda: [self.eye or self.made.eye()]
        self.made.eyes = lambda: [self.eye or self.made.eye()]  # type: ignore[method-assign]

    def run(self, steps: int) -> None:
        for _ in range(steps):
            report = self.world.step()
            assert report is not None and report.worst_gap < 2e-3


@pytest.fixture(scope="module")
def full() -> Iterator[Walked]:
    """Half a second in full."""
    walked = Walked(None)
    walked.run(60)
    yield walked


def test_fifty_exhibits_work(full: Walked) -> None:
    exhibits = full.made.exhibits
    assert len(exhibits) == 50 == len(full.world.levels.things)
    assert len({each.name for each in exhibits}) == 50
    assert full.world.system.validate() == [] and full.world.system.energy.made == 0
    for each in exhibits:
        if each.name.startswith(("steam engine", "two crosses", "flag")):
            assert max(abs(body.velocity) + abs(body.angular_velocity) for body in each.bodies) > 0.2, each.name
        places = np.array([list(body.center_of_mass) for body in each.bodies if body.alive])
        left = museum.HALL * each.hall
        assert (places[:, 0] > left - 0.5).all() and (places[:, 0] < left + museum.HALL + 0.5).all(), each.name
        assert (places[:, 1] > -1e-9).all() and (places[:, 1] < museum.HEIGHT).all(), each.name


def test_a_wall_hides_what_is_behind_it_and_a_door_does_not(full: Walked) -> None:
    eye = iota.Vec3(2.0, 1.5, museum.AISLES[0])
    behind, through = iota.Vec3(10, 1.2, museum.BACK), iota.Vec3(10, 1.2, museum.DOOR[0])
    beside_door = iota.Vec3(2.0, 1.5, museum.DOOR[0])
    assert not museum.Museum.sees(eye, behind)
    assert museum.Museum.sees(beside_door, through)
    assert museum.Museum.sees(iota.Vec3(2, 1.5, 6.0), iota.Vec3(10, 1.2, 5.0)), "in front of the building"
    exhibit = next(each for each in full.made.exhibits if each.name == "steam engine 3")
    full.eye = exhibit.at + (0, 1.5, 1.5)
    near = full.made.significance(exhibit, exhibit.thing)
    full.eye = exhibit.at + (museum.HALL, 1.5, 0)
    hidden = full.made.significance(exhibit, exhibit.thing)
    full.eye = exhibit.at + (0, 1.5, museum.HALL)
    assert near > full.made.significance(exhibit, exhibit.thing) > 5 * hidden
    full.eye = None


def test_what_is_near_the_visitor_is_full_though_the_budget_is_far_too_small() -> None:
    walked = Walked(1e-3)
    levels = walked.world.levels
    for _ in range(12):  # on a busy machine a step changes fewer levels
        walked.run(30)
        if levels.counts().get("frozen", 0) > 30:
            break
    assert levels.counts().get("frozen", 0) > 30
    for hall in (2, 4):
        walked.eye = iota.Vec3(museum.HALL * (hall + 0.5), museum.EYE, museum.AISLES[0])
        walked.run(3)
        for each in walked.made.exhibits:
            middle = np.array(list(each.thing.middle.position))
            apart = float(np.linalg.norm(middle - np.array(list(walked.eye)))) - each.thing.extent
            if apart < levels.reach:
                assert each.thing.level.name == "full", each.name
    energy = walked.world.system.energy
    assert walked.world.system.validate() == [] and energy.made == 0


def test_a_visitor_sets_going_what_hangs_still_and_lamps_tell_levels() -> None:
    walked = Walked(1e-3)
    exhibit = next(each for each in walked.made.exhibits if each.name == "torsion pendulum 2")
    bar = exhibit.bodies[0]
    walked.eye = iota.Vec3(35, museum.EYE, 0)
    for _ in range(6):
        walked.run(20)
        if exhibit.thing.level.name == "frozen":
            break
    assert exhibit.thing.level.name == "frozen"
    number = walked.made.exhibits.index(exhibit)
    blue = walked.made.lamps.color[number]
    bar.velocity = bar.angular_velocity = (0, 0, 0)
    walked.eye = exhibit.at + (0, museum.EYE, 1.0)
    walked.made.eye = lambda: walked.eye  # type: ignore[method-assign, assignment, return-value]
    walked.run(75)
    assert exhibit.thing.level.name == "full" and abs(bar.angular_velocity) > 1
    assert walked.made.lamps.color[number] != blue


def test_ladders_are_not_stepped_in_strides_by_whose_forces_they_would_part_wrongly(full: Walked) -> None:
    ladders = [each for each in full.made.exhibits if each.name.startswith("Jacob's ladder")]
    assert ladders
    for each in ladders:
        assert [level.name for level in each.thing.levels] == ["full", "frozen"]


def test_t_tints_and_untints(full: Walked) -> None:
    world = full.world
    world.controls.act("tint")
    assert len(full.made.paints) == 50
    world.controls.act("tint")
    assert full.made.paints == {}


def test_the_wind_tears_no_flag() -> None:
    """Three winds, one made with each flag, blew on all of them: they were off their poles after a second."""
    walked = Walked(None)
    for body in walked.world.system.bodies:
        if body.kind == "dynamic" and not any(
            body in each.bodies for each in walked.made.exhibits if each.name.startswith("flag")
        ):
            body.stride = 0
    for _ in range(300):
        walked.world.step()
        assert walked.world.system.broken == []
