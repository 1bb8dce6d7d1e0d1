# SPDX-License-Identifier: Apache-2.0
"""The story of thesis 5.3.1, told by itself and by hand."""

from __future__ import annotations

import gc
from typing import Any

import numpy as np

import iota
from iota.studies import undersea

BEGIN, TEAR, LET_GO = 3.0, 10.0, 21.0  # s


def build() -> tuple[iota.World, undersea.Meal, Any]:
    world = undersea.build()
    (meal,) = (thing for thing in gc.get_objects() if type(thing) is undersea.Meal and thing._world is world)
    return world, meal, meal._school


def run(world: iota.World, until: float) -> None:
    while world.system.time < until - 1e-6:
        report = world.step()
        assert report is not None and report.unconverged == 0


def keeping_up(world: iota.World, school: Any, fish: iota.Particle, until: float) -> float:
    """Its speed beside the mean of all, over a time."""
    own, all = 0.0, 0.0
    while world.system.time < until:
        world.step()
        own += abs(fish.velocity)
        all += float(np.mean([abs(one.velocity) for one in school.fish]))
    return own / all


def test_there_are_three_kinds_of_seaweed_and_they_stand_by_buoyancy() -> None:
    world, meal, _ = build()
    system = world.system
    feet = [particle for particle in system.particles if particle.is_nailed]
    rings = sorted(len(foot.ring) for foot in feet)
    assert rings == [1] * 6 + [5] * 10, "kelps and ribbons by themselves; four stems in one hinge with the foot, twice"
    assert all(len(kelp) == undersea.NODES for kelp in meal._kelps)
    run(world, 2.9)
    tips = [kelp[-1].particles[-1].position.y for kelp in meal._kelps]
    assert min(tips) > 0.75 * undersea.LENGTH
    for field in system.fields:
        if field.name == "uniform":
            field.set(acceleration=(0, -undersea.BUOYANCY, 0))
    for _ in range(400):
        system.step(1 / 60)
    assert max(kelp[-1].particles[-1].position.y for kelp in meal._kelps) < 0.75 * undersea.LENGTH


def test_the_story_tells_itself_from_leaving_to_rejoining() -> None:
    world, meal, school = build()
    run(world, BEGIN - 0.1)
    assert meal.fish is None and len(school.group) == undersea.FISH
    run(world, BEGIN + 0.1)
    fish = meal.fish
    assert fish is not None and fish not in school.group and meal.lure is not None
    assert fish == meal.hero and meal._label.at == fish and meal._label.offset[1] > 0.4, "the label is above, not on it"
    run(world, TEAR - 1.5)
    near = []
    for _ in range(60):
        world.step()
        near.append(abs(fish.position - meal._tip().position))
    assert 0.05 < np.mean(near) < 0.5, "it lingers at its food"

    kelp, mass = meal._tip().body.articulate, fish.mass
    assert len(kelp) == undersea.NODES
    run(world, TEAR + 1.0)
    assert fish in school.group and meal.lure is None
    carried = {body for body in fish.body.articulate if body != fish.body}
    assert carried == set(meal.piece) and len(carried) == undersea.PIECE
    assert sum(body.mass for body in fish.body.articulate) > 1.3 * mass
    laden = keeping_up(world, school, fish, LET_GO - 0.1)
    piece = list(meal.piece)
    height = piece[0].position.y
    run(world, LET_GO + 1.5)
    assert meal.fish is None and list(fish.body.articulate) == [fish.body]
    assert piece[0].position.y > height + 0.5, "the piece drifts away"
    free = keeping_up(world, school, fish, LET_GO + 9)
    assert laden < 0.8 and free > 0.9, "heavier, it could not keep up; now it swims as the others do"
    middle = np.mean([tuple(one.position) for one in school.fish], axis=0)
    assert np.linalg.norm(np.array(fish.position) - middle) < 3


def test_the_fish_of_the_story_has_a_color_of_its_own_and_is_larger_than_the_others() -> None:
    world, meal, school = build()
    look, *others = (world.scene.look_of(fish.body)["*"] for fish in (meal.hero, *school.fish))
    other = next(each for each in others if each != look)
    assert look[0].color != other[0].color
    lengths = [
        max(x for x, _, _ in one[0].shape.vertices) - min(x for x, _, _ in one[0].shape.vertices)
        for one in (look, other)
    ]
    assert lengths[0] > 1.4 * lengths[1]
    assert sum(world.scene.look_of(fish.body)["*"] == look for fish in school.fish) == 1


def test_the_kelps_sway_by_more_than_a_hand_and_the_shoal_goes_by() -> None:
    world, meal, _ = build()
    tips = []
    for _ in range(8):
        run(world, world.system.time + 0.9)
        tips.append([tuple(kelp[-1].particles[-1].position) for kelp in meal._kelps])
    assert np.ptp(tips, axis=0)[:, 0].min() > 0.5


def test_a_touch_stops_the_story_and_each_event_can_be_done_by_hand() -> None:
    world, meal, school = build()
    run(world, BEGIN + 2)
    told = meal.fish
    go_on = world._state.actions["go on"].hook.function
    go_on()  # stops the story, and goes on by itself: the fish that was called off leaves again, or another one
    assert meal.fish is not None and meal.lure is not None and told is not None
    for expected in (3, 0):
        run(world, world.system.time + 1)
        go_on()
        assert len(meal.piece) == expected
    assert meal.fish is None and len(school.group) == undersea.FISH
    world.reset()
    assert meal.fish is None and [len(kelp) for kelp in meal._left] == [undersea.NODES] * 3


def test_the_weed_that_is_torn_off_by_and_by_makes_the_study_begin_anew() -> None:
    world, meal, _ = build()
    for _ in range(60):
        meal.go_on()
        world.step()
        assert world.system.validate() == []
    assert world.system.time < 1, "it was reset on the way"
