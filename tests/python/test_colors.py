# SPDX-License-Identifier: Apache-2.0
"""One parser of colors and one converter of rotations, wherever they are taken."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from shown import show

import iota
from iota import looks
from iota._protocol import NO_COLOR
from iota.colors import NAMES, color_number, color_text, rgba

TOMATO = 0xFF6347
SAME = ("tomato", "Tomato", "#ff6347", "#FF6347ff", TOMATO, (1, 0x63 / 255, 0x47 / 255), np.array([255, 99, 71]) / 255)


@pytest.mark.parametrize("given", SAME, ids=repr)
def test_a_color_is_the_same_however_it_is_written(given: Any, system: iota.System) -> None:
    assert color_number(given) == TOMATO and color_text(given) == "#ff6347"
    body = system.body(shape=iota.Box((1, 1, 1)), color=given)
    assert body.color == "#ff6347"
    particle = system.body().particle((0, 0, 0), color=given)
    assert particle.color == pytest.approx((1, 99 / 255, 71 / 255, 1))
    assert looks.sphere(0.1, color=given).color == "#ff6347"
    world = iota.World(system)
    assert world.label("a", color=given).color == TOMATO
    assert world.drawings.paint(body, given).color.tolist() == [TOMATO]
    assert world.drawings.points([(0, 0, 0)], color=given).color.tolist() == [TOMATO]
    assert world.controls.plot("a", lambda: 0.0, color=given)._record()["colors"] == [TOMATO]  # type: ignore[index]
    points = iota.builder.Structure().points
    points.add((0, 0, 0), color=given)
    assert points.color[0] == pytest.approx((1, 99 / 255, 71 / 255))


def test_short_digits_opacity_and_lists_of_colors_are_taken(system: iota.System) -> None:
    assert rgba("#fc3") == pytest.approx((1, 0.8, 0.2, 1)) and rgba("#ff634780")[3] == pytest.approx(128 / 255)
    assert color_text("#ff634780") == "#ff634780" and color_number((1, 0, 0, 0)) == 0xFFFF0000
    bodies = [system.body(shape=iota.Sphere(0.1), position=(i, 0, 0)) for i in range(3)]
    world = iota.World(system)
    assert world.drawings.paint(bodies, ["red", "#00ff00", (0, 0, 1)]).color.tolist() == [0xFF0000, 0xFF00, 0xFF]
    assert world.drawings.paint(bodies, (1, 0, 0)).color.tolist() == [0xFF0000], "whole numbers are parts, too"
    assert len(NAMES) == 148


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ("tomatoe", "did you mean 'tomato'"),
        ("ff6347", '"#rrggbb"'),
        ("#ff634", 'is "#rrggbb" or "#rrggbbaa", not \'#ff634\''),
        ((255, 99, 71), 'from 0 to 1, not .255, 99, 71.; did you mean "#ff6347"'),
        ((0.5, math.nan, 0), "from 0 to 1"),
        ((1, 2), "a name such as"),
        (0x1000000, "0xFFFFFF"),
        (True, "a name such as"),
        (None, "a name such as"),
    ],
)
def test_what_is_no_color_is_refused_with_the_same_words_everywhere(given: Any, said: str, system: iota.System) -> None:
    world, body = iota.World(system), system.body(shape=iota.Sphere(1))
    takes: list[Callable[[], object]] = [
        lambda: rgba(given),
        lambda: setattr(body, "color", given),
        lambda: looks.sphere(0.1, color=given),
        lambda: world.label("a", color=given),
        lambda: system.body(color=given),
    ]
    for take in takes[:1] if given is None else takes:
        with pytest.raises((ValueError, TypeError), match=said):
            take()
    assert body.color is None and len(system.bodies) == 1


def test_a_body_is_drawn_in_its_color_and_pages_follow_it(system: iota.System) -> None:
    box = system.body(shape=iota.Box((1, 1, 1)), color="tomato")
    plain, wall = system.body(shape=iota.Sphere(0.5)), system.obstacle(iota.Box((1, 1, 1)), (3, 0, 0), color="gold")
    dot = system.body().particle((0, 3, 0), radius=0.1, color="tomato").body
    with show(system) as shown:
        assert [shown.bodies[body.slot]["color"] for body in (box, plain, wall, dot)] == [
            TOMATO,
            NO_COLOR,
            0xFFD700,
            TOMATO,
        ]
        plain.color = box.color
        box.color = None
        assert shown.look() == 2, "nothing else is told again"
        assert shown.bodies[plain.slot]["color"] == TOMATO and shown.bodies[box.slot]["color"] == NO_COLOR


def test_a_color_is_kept_in_snapshots_by_pieces_and_is_taken_back(system: iota.System) -> None:
    boxes = [system.body(shape=iota.Box((1, 1, 1)), position=(x, 0, 0)) for x in range(2)]
    boxes[0].color = "tomato"
    boxes[0].combine(boxes[1])
    boxes[0].parts[1].separate()
    assert [body.color for body in system.bodies] == ["#ff6347"] * 2
    before = system.snapshot()
    boxes[0].color = "navy"
    system.restore(before)
    assert boxes[0].color == "#ff6347"
    with system.edit():
        boxes[0].color = None
    system.undo()
    assert boxes[0].color == "#ff6347"


def test_a_color_that_is_seen_through_is_for_looks(system: iota.System) -> None:
    with pytest.raises(
        ValueError, match=r"no opacity: give it a look, as in looks.solid\('paint', color='#ff000080'\)"
    ):
        system.body(shape=iota.Sphere(1), color="#ff000080")


HALF = math.sqrt(0.5)
QUARTER_TURNS = (
    (("z", 90), (0, 0, HALF, HALF)),
    (("x", 90), (HALF, 0, 0, HALF)),
    (((0, 2, 0), 90), (0, HALF, 0, HALF)),
    ((iota.Vec3(0, 0, 1), -90), (0, 0, -HALF, HALF)),
    ((0, 0, 3, 3), (0, 0, HALF, HALF)),
    (np.array([0, 0, 0, 2.0]), (0, 0, 0, 1)),
)


@pytest.mark.parametrize(("given", "quaternion"), QUARTER_TURNS, ids=repr)
def test_a_rotation_is_the_same_however_it_is_written(given: Any, quaternion: Any, system: iota.System) -> None:
    body = system.body(shape=iota.Box((1, 2, 3)), orientation=given)
    assert body.orientation == pytest.approx(quaternion)
    body.orientation = (0, 0, 0, 1)
    body.orientation = given
    assert body.orientation == pytest.approx(quaternion)
    body.set_pose((0, 1, 0), given)
    assert body.orientation == pytest.approx(quaternion)
    assert system.obstacle(iota.Box((1, 1, 1)), (9, 0, 0), given).orientation == pytest.approx(quaternion)
    assert looks.box((1, 1, 1), rotation=given).rotation == pytest.approx(quaternion)
    world = iota.World(system)
    assert world.drawings.frame(rotation=given).rotation == pytest.approx(quaternion)
    assert world.drawings.axes(rotation=given).rotation == pytest.approx(quaternion)
    assert world.add_static(looks.sphere(1), (0, 0, 9), given).orientation == pytest.approx(quaternion)


@pytest.mark.parametrize(
    "given", [(1, 2, 3), ("q", 30), ("z", "a"), "z", 30, None, (0, 0, 0, 0), ((0, 0, 0), 30), ("z", math.inf)]
)
def test_what_is_no_rotation_is_refused_with_an_example(given: Any, system: iota.System) -> None:
    body = system.body(shape=iota.Box((1, 2, 3)))
    with pytest.raises((TypeError, ValueError), match=r"as in \('z', 30\)|finite and not zero|must be"):
        body.orientation = given
    assert body.orientation == (0, 0, 0, 1)


def test_a_static_body_has_the_place_and_rotation_that_its_look_has_in_its_frame(system: iota.System) -> None:
    world = iota.World(system)
    look = looks.box((2, 1, 1), offset=(1, 0, 0), rotation=("z", 30))
    wall = world.add_static(look, (0, 1, 0), ("z", 60))
    assert list(wall.position) == pytest.approx([0.5, 1 + math.sin(math.radians(60)), 0])
    assert wall.orientation == pytest.approx((0, 0, HALF, HALF))
