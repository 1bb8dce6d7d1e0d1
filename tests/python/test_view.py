# SPDX-License-Identifier: Apache-2.0
"""Views that replace the page: one of a script, and the terminal."""

from __future__ import annotations

import io
import os
import pty
import re
import threading
import time
from collections.abc import Callable
from contextlib import suppress

import numpy as np
import pytest
from waiting import wait_until

import iota
from iota.terminal import TerminalView
from iota.world.braille import outline


class Probe(iota.View):
    """Keeps what it is told; `acts` are called with the world, one in each frame."""

    def __init__(self, *acts: Callable[[iota.World], object]) -> None:
        self.told: list[str] = []
        self.notices: list[tuple[str, str]] = []
        self._acts = list(acts)

    def open(self, world: iota.World) -> None:
        self.told.append("open")

    def frame(self, world: iota.World) -> None:
        self.told.append("frame")
        if not self._acts:
            world.stop()
        else:
            self._acts.pop(0)(world)

    def notice(self, title: str, text: str, hint: str) -> None:
        self.notices.append((title, text))

    def close(self) -> None:
        self.told.append("close")


def make_world() -> tuple[iota.World, iota.Particle]:
    system = iota.System(gravity=(0, 0, 0))
    ball = system.body().particle((0, 1, 0))
    world = iota.World(system, title="viewed", ground=None)

    @world.action("kick", key="k")
    def kick(event: iota.Event) -> None:
        event.body.velocity = (1, 0, 0)

    @world.action("fail", key="x", on="world")
    def fail() -> None:
        raise ValueError("no")

    return world, ball


def test_a_view_of_the_script_sees_the_world_and_acts_on_it() -> None:
    world, ball = make_world()
    view = Probe(
        lambda world: world.controls.act("kick", ball.body),
        lambda world: world.controls.act("fail"),
        lambda world: world.controls.act("kick"),
        *[lambda world: time.sleep(0.02)] * 20,
    )
    summary = world.run(view=view)
    assert view.told[0] == "open" and view.told[-1] == "close" and set(view.told[1:-1]) == {"frame"}
    assert summary.steps > 5 and ball.position.x > 0
    assert [title for title, _ in view.notices] == ["The action 'fail' failed", "Nothing to kick"]
    assert world.pages.url is None and [action.name for action in world.controls.actions] == ["kick", "fail"]
    with pytest.raises(LookupError, match="none"):
        world.controls.act("none")


def test_a_view_that_fails_is_closed() -> None:
    world, _ = make_world()

    def fail(world: iota.World) -> None:
        raise OSError("no screen")

    view = Probe(fail)
    with pytest.raises(OSError, match="no screen"):
        world.run(view=view)
    assert view.told == ["open", "frame", "close"]


def dots(picture: str) -> list[tuple[int, int]]:
    """Columns and rows of the cells with dots in a picture."""
    rows = [re.sub(r"\x1b\[[0-9;]*m", "", row) for row in picture.split("\r\n")]
    return [(x, y) for y, row in enumerate(rows) for x, cell in enumerate(row) if 0x2800 < ord(cell) < 0x2900]


def test_the_terminal_shows_bodies_where_they_are(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLUMNS", "80")
    monkeypatch.setenv("LINES", "43")
    world, ball = make_world()
    system = world.system
    for place in ((-1, 0, 0), (1, 0, 0), (1, 2, 0)):
        system.body().particle(place)
    out = io.StringIO()
    view = TerminalView(out=out, keys=io.StringIO())

    def picture() -> list[tuple[int, int]]:
        out.seek(0)
        out.truncate()
        view.frame(world)
        return dots(out.getvalue())

    before = picture()
    assert len(before) == 4
    ball.position = (0.5, 1, 0)
    after = picture()
    (moved,) = set(after) - set(before)
    (left,) = set(before) - set(after)
    corners = sorted(set(before) & set(after))
    wide = corners[-1][0] - corners[0][0]  # from x = -1 to 1
    assert moved[0] - left[0] == pytest.approx(wide / 4, abs=1.1) and abs(moved[1] - left[1]) <= 1
    assert min(y for _, y in corners) < left[1] < max(y for _, y in corners)
    assert "viewed" in out.getvalue() and "k: kick" in out.getvalue()


@pytest.mark.parametrize(
    "shape",
    [
        iota.Sphere(0.4), iota.Box((1, 2, 3)), iota.Cylinder(0.5, 2, 0.1), iota.Capsule(0.3, 1), iota.Cone(0.5, 2),
        iota.Torus(0.5, 0.1, 0.3), iota.Ellipsoid((1, 2, 3)),
    ],
    ids=lambda shape: shape.kind,
)  # fmt: skip
def test_the_terminal_draws_every_shape_along_its_surface(shape: iota.Shape) -> None:
    solid = iota.System().body(shape=shape, density=1000).solids[0]
    points = np.concatenate(list(outline(solid))) - list(solid.position)
    low, high = shape.bounds
    assert points.min(axis=0) == pytest.approx(list(low), abs=1e-3) and points.max(axis=0) == pytest.approx(
        list(high), abs=1e-3
    )
    assert max(abs(shape.distance(tuple(point))) for point in points) < 1e-6


def test_keys_in_the_terminal_act_on_the_selected_body() -> None:
    world, ball = make_world()
    world.system.body().particle((2, 1, 0))  # an arrow key pulls by a share of the size of the scene
    mine, theirs = pty.openpty()
    out = io.StringIO()
    with open(theirs, closefd=False) as keys:
        view = TerminalView(out=out, keys=keys)
        places: list[float] = []
        paused: list[bool] = []
        answered: list[bool] = []
        world.on_frame(lambda: (places.append(ball.position.x), paused.append(world.clock.paused)))

        def press() -> None:
            def until(condition: Callable[[], bool]) -> None:
                with suppress(AssertionError):
                    wait_until(condition)
                answered.append(condition())

            until(lambda: len(places) > 2)
            os.write(mine, b"\t\x1b[C")
            until(lambda: places[-1] > 0.02)
            os.write(mine, b"\x1bk")
            until(lambda: places[-1] > 0.5)
            os.write(mine, b" ")
            until(lambda: paused[-1])
            os.write(mine, b"r")
            until(lambda: places[-1] == 0)
            os.write(mine, b"q")

        presser = threading.Thread(target=press)
        presser.start()
        world.run(view=view, seconds=60)
        presser.join()
    os.close(mine)
    os.close(theirs)
    assert answered == [True] * 5
    assert max(places) > 0.5 and paused[-1] and places[-1] == 0
    assert "\x1b[38;5;209m" in out.getvalue(), "the selected body has another color"
