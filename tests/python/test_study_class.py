# SPDX-License-Identifier: Apache-2.0
"""The studies physics-class, fireworks and the scripts of Appendix E, and the story that waits for its user."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from conftest import Runner
from page_client import PageClient

import iota
from iota import studies
from iota.studies import appendix_e1, appendix_e2, appendix_e3, fireworks, physics_class
from iota.studies._story import Story
from iota.world.widgets import Plot


def run(world: iota.World, seconds: float) -> None:
    """Without a page, as fast as it goes."""
    for _ in range(round(seconds / world.dt)):
        world.step()


def widget(world: iota.World, label: str):  # type: ignore[no-untyped-def]
    return next(
        thing for thing in world.drawings.things if getattr(thing, "label", None) == label and hasattr(thing, "value")
    )


def change(world: iota.World, label: str, value: float) -> None:
    """As a user does."""
    thing = widget(world, label)
    thing.take(value, "", iota.Event(world.system, label), world._guard)


def labels(world: iota.World) -> list[str]:
    return [thing.text for thing in world.drawings.things if hasattr(thing, "text")]


def test_the_appendix_scripts_fall_swing_and_fold_and_land_on_the_ground() -> None:
    first, second, third = (study.build() for study in (appendix_e1, appendix_e2, appendix_e3))
    for world in (first, second, third):
        run(world, 2.0)
    assert [p.position.y for p in first.system.particles] == pytest.approx([-2, -2], abs=0.02)
    p, q = (particle.position for particle in second.system.particles)
    assert p.y == q.y == pytest.approx(-2, abs=0.02) and p.x + q.x == pytest.approx(30)
    assert third.system.articulate_count == 1 and third.system.worst_gap < 1e-7
    for number, length in enumerate([math.hypot(30, 35), math.hypot(35, 35)]):
        ends = third.system.bodies[number].particles
        assert abs(ends[0].position - ends[1].position) == pytest.approx(length, rel=1e-9)
    distances = []
    for _ in range(400):
        second.step()
        distances.append(abs(second.system.particles[0].position - second.system.particles[1].position))
    assert min(distances) < 11 and max(distances) > 29, "about 20 m, without loss"
    for world in (first, second, third):
        run(world, 6.0)
        lowest = min(particle.position.y for particle in world.system.particles)
        assert lowest > appendix_e1.GROUND - 0.1


@pytest.mark.parametrize("study", [appendix_e1, appendix_e2, appendix_e3])
def test_the_appendix_scripts_land_and_begin_anew_unless_somebody_holds_them(
    study: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    world = study.build()
    start = world.system.positions
    run(world, 11.9)
    assert world.system.positions[:, 1].min() < appendix_e1.GROUND + 3
    # The force of the second one swings its particles along the ground, against friction.
    assert world.system.energy.kinetic < (15 if study is appendix_e2 else 0.5)
    run(world, 0.2)
    assert world.system.time < 0.2 and np.abs(world.system.positions - start).max() < 0.1
    monkeypatch.setattr(type(world.users), "held", lambda *_: world.system.bodies[0])
    run(world, 13.0)
    assert world.system.time > 13.0


def test_the_class_measures_the_values_of_the_formulas() -> None:
    world = physics_class.build()
    system = world.system
    run(world, 9.0)
    pendulum, orbit, spring = labels(world)
    swing = float(pendulum.split()[1])
    amplitude = 1 + physics_class.START**2 / 16 + 11 * physics_class.START**4 / 3072  # of the series for large swings
    assert swing == pytest.approx(2 * math.pi * math.sqrt(1 / 9.81) * amplitude, abs=0.015)
    half = physics_class.ORBIT / (
        2 - physics_class.LAUNCH**2
    )  # vis-viva, launched across at a circle's speed times LAUNCH
    year = 2 * math.pi * math.sqrt(half**3 / physics_class.PULL)
    assert float(orbit.split()[1]) == pytest.approx(year, abs=0.01)
    places = []
    for _ in range(round(year / world.dt)):
        places.append(tuple(system.particles[3].position))
        world.step()
    gone = np.linalg.norm(np.array(places) - np.array(system.particles[3].position), axis=1)
    assert gone[0] < 0.02 and gone.max() == pytest.approx(2 * half, rel=0.1), "it closes after the year that is told"
    assert float(spring.split()[1]) == pytest.approx(2 * math.pi / math.sqrt(40), abs=0.01)
    before = system.energy.total
    run(world, 5.0)
    assert system.energy.total == pytest.approx(before, abs=1e-6)


def test_the_plots_of_the_class_show_its_motions() -> None:
    world = physics_class.build()
    run(world, 2.0)
    system = world.system
    newest = {}
    for plot in world.drawings.things:
        if isinstance(plot, Plot):
            plot.sample(system.time, world._guard)  # as before each picture
            newest[plot.label] = plot._record()["values"][-1]  # type: ignore[index]
    bob, planet, weight = (p.position for p in system.particles if not p.is_nailed)
    arm = bob - physics_class.PIVOT
    for label, value in {
        "energy": system.energy.total,
        "pendulum": math.degrees(math.atan2(arm.x, -arm.y)),
        "orbit": abs(planet - physics_class.SUN),
        "spring": physics_class.BEAM.y - weight.y,
    }.items():
        assert newest[label] == pytest.approx(value, rel=1e-9), label


def test_the_sliders_of_the_class_set_their_values() -> None:
    world = physics_class.build()
    change(world, "length", 0.5)
    change(world, "gravity", 4.0)
    change(world, "stiffness", 100.0)
    change(world, "launch", 1.2)
    far = 0.0
    planet = world.system.particles[3]
    for _ in range(round(10 / world.dt)):
        world.step()
        far = max(far, abs(planet.position - physics_class.SUN))
    pendulum, orbit, spring = labels(world)
    assert float(pendulum.split()[1]) == pytest.approx(2 * math.pi * math.sqrt(0.5 / 4) * 1.0158, abs=0.02)
    assert float(spring.split()[1]) == pytest.approx(2 * math.pi / 10, abs=0.01)
    # Kepler: launched across at 1.2 times the circle's speed, e = 0.44.
    assert far == pytest.approx(physics_class.ORBIT * 1.44 / 0.56, rel=0.01)
    assert float(orbit.split()[1]) == pytest.approx(2 * math.pi * math.sqrt((0.4 / 0.56) ** 3 / 0.4), abs=0.02)
    world.reset()
    assert widget(world, "stiffness").value == 40


def test_rockets_climb_burst_at_their_top_and_stand_in_their_tubes_again() -> None:
    world = fireworks.build()
    system = world.system
    rockets = system.particles[: len(fireworks.COLORS)]
    for _ in range(2):  # what has been carried back to its tube climbs again
        world._state.actions["finale"].hook.function()
        tops, sparks = np.zeros(len(rockets)), 0
        for step in range(round(2.9 / world.dt)):
            world.step()
            tops = np.maximum(tops, [rocket.position.y for rocket in rockets])
            if step % round(0.1 / world.dt) == 0:  # to count thousands of bodies takes longer than a step
                sparks = max(sparks, sum(body.is_spark for body in system.bodies))
        climb = fireworks.CLIMB
        assert ((climb - 1.1) ** 2 / 19.62 < tops - fireworks.TUBE).all()
        assert (tops - fireworks.TUBE < (climb + 1.1) ** 2 / 19.62).all()
        assert sparks > 1000
        assert all(rocket.body.kind == "scripted" for rocket in rockets)
        assert all(abs(rocket.position.y - fireworks.TUBE) < 1e-9 for rocket in rockets)


def test_stars_are_braked_leave_trails_light_the_ground_and_end_there() -> None:
    world = fireworks.build()
    system = world.system
    lamps = [thing for thing in world.drawings.things if type(thing).__name__ == "Light"][: fireworks.LAMPS]
    lowest, most, bright, speeds, embers = 0.0, 0, [], [], 0
    world._state.actions["fire"].hook.function()  # the story waits
    for _ in range(round(5.0 / world.dt)):
        world.step()
        places = system.positions
        lowest, most = min(lowest, places[:, 1].min()), max(most, len(places))
        bright.append(max(lamp.intensity for lamp in lamps))
        stars = np.array([abs(p.velocity) for p in system.particles if p.body.is_spark and p.position.y > 6])
        if len(stars) > 50:
            speeds.append(np.quantile(stars, 0.9))
            embers = max(embers, int((stars < 0.4).sum()))
    assert lowest > -0.5, "none falls through the ground for longer than four steps"
    assert 300 < most < 6000 and len(system.positions) < 0.4 * most, "they die; the fires go on"
    assert max(speeds) > 5 and min(speeds) < 3, "fast at first, and soon slow"
    assert embers > 100, "they hang where the comets were"
    assert max(bright) == pytest.approx(fireworks.BRIGHT, rel=0.1) and bright[0] == 0
    assert bright[-1] < 0.05 * max(bright), "it is night again"


def test_a_story_waits_tells_itself_and_stops_when_it_is_touched() -> None:
    system = iota.System()
    ball = system.body().particle((0, 1, 0))
    world = iota.World(system)
    told: list[str] = []
    cards: list[str] = []
    world._state.notices.show = lambda client, level, title, text, *more, **rest: cards.append(title)
    story = Story(world, wait=1.0, on_stop=lambda: told.append("stopped"))
    story.at(0.5)(lambda: told.append("one"))
    story.at(1.0)(lambda: told.append("two"))
    story.action("three", key="t", help="tells three")(lambda: told.append("three"))
    run(world, 1.2)
    assert told == [] and story.is_told
    run(world, 1.0)
    assert told == ["one", "two"] and not story.is_told
    run(world, 1.2)
    assert told == ["one", "two"] and story.is_told
    run(world, 0.6)
    world.controls.act("three")
    run(world, 0.02)
    assert told == ["one", "two", "one", "stopped", "three"] and not story.is_told
    assert cards == ["The story begins", "The story begins", "The story stops"]
    run(world, 0.5)
    world.reset()
    run(world, 0.9)
    assert not story.is_told
    run(world, 0.7)
    assert told[-1] == "one"
    assert ball.alive


@pytest.mark.parametrize(
    ("name", "begins"),
    [("chain", 4.0), ("fireworks", 2.5), ("lab", 8.0), ("ladder", 8.0), ("molecule", 6.0), ("undersea", 3.0)],
)
def test_a_story_says_that_it_begins_and_a_hand_on_a_page_stops_it(name: str, begins: float, run_world: Runner) -> None:
    world = studies.module(name).build()
    run(world, begins - 0.5)
    with PageClient(run_world(world)) as page:

        def has_said(title: str) -> bool:
            return any(notice["title"] == title for notice in page.notices)

        page.wait_for(lambda: has_said("The story begins"))

        def free() -> tuple[int, iota.Vec3]:
            body = next(body for body in world.system.bodies if body.kind == "dynamic" and not body.is_spark)
            return body.slot, body.center_of_mass

        slot, place = world.call(free)
        assert not has_said("The story stops")
        page.send("grab_start", hold=1, body=page.body(slot), local_point=(0, 0, 0), target=tuple(place))
        page.wait_for(lambda: has_said("The story stops"))


def test_stories_and_helpers_are_no_studies() -> None:
    assert {"appendix-e1", "appendix-e2", "appendix-e3", "physics-class", "fireworks"} <= set(studies.names())
    assert not any("story" in name for name in studies.names())
