# SPDX-License-Identifier: Apache-2.0
"""Surroundings by name."""

from __future__ import annotations

import numpy as np
import pytest

import iota


@pytest.mark.parametrize("place", ["room", "studio", "space"])
def test_a_stage_ends_with_all_that_was_made_for_it(place: str) -> None:
    system = iota.System()
    world = iota.World(system, ground=0)
    label = world.label("mine")
    stage = world.stage(place)
    assert len(world.drawings.things) > 2
    stage.destroy()
    stage.destroy()
    world.step()
    assert world.drawings.things == [label]
    assert [body.name for body in system.obstacles] == ["ground"]


def test_the_walls_of_a_room_hold_what_is_thrown_at_them() -> None:
    system = iota.System()
    world = iota.World(system, ground=0)
    world.stage("room")
    for way in ((1, 0, 0), (-1, 0, 0), (0, 0, -1)):
        ball = system.body(shape=iota.Sphere(0.1), mass=1, position=(0, 0.5, 1.2))
        ball.velocity = iota.Vec3(*way) * 12
    for _ in range(180):
        world.step()
    places = np.array([body.position for body in system.bodies])
    assert (abs(places[:, 0]) < 4.5).all() and (places[:, 2] > -3.5).all()
    assert (abs(places[:, 0]) > 3).sum() == 2


def test_a_color_that_is_given_counts_instead_of_that_of_the_place() -> None:
    world = iota.World(iota.System(), ground=0)
    stage = world.stage("space", sky="#102030")
    assert stage.sky != world.stage("space").sky
    assert stage.light == pytest.approx(0.8)


def test_stars_are_around_what_is_there_already() -> None:
    system = iota.System(gravity=(0, 0, 0))
    for x in (0.0, 2e7):
        system.body().particle((x, 0, 0), mass=1e10)
    world = iota.World(system, ground=None)
    world.stage("space")
    (stars,) = [thing for thing in world.drawings.things if type(thing).__name__ == "Points"]
    assert np.linalg.norm(np.asarray(stars.points) - (1e7, 0, 0), axis=1).min() > 5e7


def test_an_unknown_place_is_refused_and_nothing_is_made() -> None:
    world = iota.World(iota.System(), ground=0)
    with pytest.raises(ValueError, match="place must be one of 'room', 'studio', 'space', not 'kitchen'"):
        world.stage("kitchen")  # type: ignore[arg-type]
    with pytest.raises(ValueError):
        world.stage("room", light=-1)
    assert world.drawings.things == []
    assert [body.name for body in world.system.obstacles] == ["ground"]
