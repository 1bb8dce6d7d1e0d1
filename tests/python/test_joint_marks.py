# SPDX-License-Identifier: Apache-2.0
"""Joints as lines on the page."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from page_client import PageClient

import iota
from iota.frames import turned

Runner = Callable[[iota.World], str]


def lines_of(world: iota.World) -> dict[Any, list[tuple[Any, Any]]]:
    """The lines on the page by color, in the world."""
    found: dict[Any, list[tuple[Any, Any]]] = {}
    for thing in world.drawings.things:
        body = thing.at
        place, turn = (body.center_of_mass, body.orientation) if isinstance(body, iota.Body) else (body, (0, 0, 0, 1))
        for start, end in zip(thing.starts, thing.ends, strict=True):
            ends = tuple(np.array(list(place + turned(turn, iota.Vec3(*map(float, p))))) for p in (start, end))
            found.setdefault(color_of(thing), []).append(ends)
    return found


def door() -> tuple[iota.System, iota.Body, iota.Constraint]:
    system = iota.System(gravity=(0, 0, 0))
    body = system.body(shape=iota.Box((1, 2, 0.1)), position=(0.5, 1, 0))
    return system, body, system.revolute(body, at=(0, 1, 0), axis=(0, 1, 0), limits=(-0.25, 1.0))


def test_a_hinge_shows_its_axis_and_where_its_stops_are_wherever_it_stands(run_world: Runner) -> None:
    system, _, hinge = door()
    world = iota.World(system)
    marks = world.tools.show_joints(length=2.0)
    with PageClient(run_world(world)) as page:
        page.wait_for(lambda: world.call(lambda: len(marks._marks) == 3))
        for angle in (0.0, 0.7, -0.25):
            world.call(lambda angle=angle: setattr(hinge.angle, "value", angle))
            lines = world.call(lambda: lines_of(world))
            (axis,), (pointer,), sector = (lines[color] for color in colors_of(marks))
            assert np.allclose(axis, [(0, 0, 0), (0, 2, 0)], atol=1e-6)
            low, high = (end - start for start, end in sector[-2:])
            arm = pointer[1] - pointer[0]
            # By how much the door turns from here until it meets each stop.
            assert turn_about_y(arm, low) == pytest.approx(-0.25 - angle, abs=1e-5)
            assert turn_about_y(arm, high) == pytest.approx(1.0 - angle, abs=1e-5)
        world.call(marks.destroy)
        page.wait_for(lambda: world.call(lambda: not world.drawings.things))


def test_a_slide_shows_its_track_and_new_limits_are_drawn_at_once(run_world: Runner) -> None:
    system = iota.System(gravity=(0, 0, 0))
    body = system.body(shape=iota.Box((0.2, 0.2, 0.2)), position=(1, 0, 0))
    slide = system.prismatic(body, at=(1, 0, 0), axis=(1, 0, 0), limits=(-0.5, 2.0))
    world = iota.World(system)
    marks = world.tools.show_joints([slide], length=0.4)
    with PageClient(run_world(world)) as page:
        page.wait_for(lambda: world.call(lambda: len(marks._marks) == 3))
        track = world.call(lambda: lines_of(world))[colors_of(marks)[2]][0]
        assert np.allclose(track, [(0.5, 0, 0), (3, 0, 0)], atol=1e-6)
        world.call(lambda: setattr(slide.slide, "limits", (-0.1, 0.1)))
        page.wait_for(
            lambda: np.allclose(
                world.call(lambda: lines_of(world))[colors_of(marks)[2]][0], [(0.9, 0, 0), (1.1, 0, 0)], atol=1e-6
            )
        )
        world.call(slide.destroy)
        page.wait_for(lambda: world.call(lambda: not marks._marks))


def test_a_length_that_is_no_size_is_refused() -> None:
    system, *_ = door()
    for length in (0.0, -1.0, math.inf, math.nan):
        with pytest.raises(ValueError, match="length must be a finite number above 0 m"):
            iota.World(system).tools.show_joints(length=length)


def colors_of(marks: Any) -> list[Any]:
    """Of axes, pointers and stops, as the page has them."""
    return [color_of(mark) for mark in marks._marks]


def color_of(drawing: Any) -> tuple[float, ...]:
    return tuple(np.ravel(drawing.color))


def turn_about_y(start: Any, end: Any) -> float:
    return float(math.atan2(np.cross(start, end)[1], np.dot(start, end)))
