# SPDX-License-Identifier: Apache-2.0
"""A visitor in an emulated headset, driven from Python."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest
from pages import LEAVE_OUT_DRAWING

import iota
from iota.film import browser
from iota.film.files import Failed

pytest.importorskip("playwright")
testing = pytest.importorskip("iota.testing")
needs_browser = pytest.mark.skipif(browser.find_browser() is None, reason="there is no Chromium")
Runner = Callable[[iota.World], str]


@pytest.fixture(autouse=True)
def browsers_without_drawing(monkeypatch: pytest.MonkeyPatch) -> None:
    """What a visitor does needs no filled pixels, which take software most of two cores; e2e/xr.test.ts looks at them."""
    open_browser = testing.open_browser

    @contextmanager
    def open_without_drawing(purpose: str) -> Iterator[Any]:
        with open_browser(purpose) as browser:
            new_page = browser.new_page

            def page_without_drawing(**options: Any) -> Any:
                page = new_page(**options)
                page.add_init_script(LEAVE_OUT_DRAWING)
                return page

            browser.new_page = page_without_drawing
            yield browser

    monkeypatch.setattr(testing, "open_browser", open_without_drawing)


@needs_browser
def test_a_visitor_takes_a_body_by_ray_and_by_pinch_and_moves_it(run_world: Runner, tmp_path: Path) -> None:
    system = iota.System(gravity=(0, 0, 0), damping=4.0)
    ball = system.body(shape=iota.Sphere(0.05), mass=0.2, position=(0, 1.2, 0))
    world = iota.World(system, camera=iota.Camera(position=(0, 1.6, 1.2), target=(0, 1.2, 0)))
    pressed: list[iota.Body] = []

    @world.action("poke", button="a")
    def poke(event: iota.Event) -> None:
        pressed.append(event.body)

    run_world(world)
    with testing.Headset(world) as visitor:
        assert 0 < visitor.head.y - 1.2 < 0.3, "the ball is a little below the eyes"
        visitor.look(ball)
        visitor.point("right", ball)
        visitor.press("right")
        assert visitor.wait_for(lambda: world.users.held() == ball)
        before = world.call(lambda: ball.center_of_mass)
        visitor.move("right", visitor.head + iota.Vec3(0.05, 0.05, -0.1))
        visitor.wait_for(lambda: abs(ball.center_of_mass - before) > 0.02)
        visitor.press("right", "a")
        visitor.wait_for(lambda: pressed == [ball])
        visitor.release("right", "a")
        visitor.release("right")
        visitor.wait_for(lambda: world.users.held() is None and abs(ball.velocity) < 1e-3)  # it goes on for a while
        visitor.use_hands()
        visitor.move("left", ball)
        visitor.pinch("left")
        assert visitor.wait_for(lambda: world.users.held() == ball)
        visitor.pinch("left", closed=False)
        visitor.wait_for(lambda: world.users.held() is None)
        visitor.picture(tmp_path / "eyes.png")
        with pytest.raises(TimeoutError, match=r"did not become true within 0\.1 s"):
            visitor.wait_for(lambda: False, 0.1)
    assert (tmp_path / "eyes.png").read_bytes().startswith(b"\x89PNG")


@needs_browser
def test_a_visitor_teleports_onto_a_platform_and_not_through_a_wall(run_world: Runner) -> None:
    system = iota.System()
    world = iota.World(system, ground=0.0, camera=iota.Camera(position=(0, 1.6, 0), target=(0, 1.2, -3)))
    system.body(shape=iota.Box((4, 0.5, 4)), mass=1.0, position=(0, 0.25, -4)).kind = "static"
    system.body(shape=iota.Box((0.2, 6, 20)), mass=1.0, position=(2, 3, 0)).kind = "static"
    run_world(world)

    def teleport(towards: tuple[float, float, float]) -> tuple[iota.Vec3, iota.Vec3]:
        before = visitor.head
        visitor.point("left", towards)
        visitor.stick("left", 0, -1)
        visitor.stick("left", 0, 0)
        return before, visitor.head

    with testing.Headset(world) as visitor:
        start = visitor.head
        before, after = teleport((start.x, start.y - 0.3, start.z - 3))
        assert after.y - before.y == pytest.approx(0.5, abs=0.01) and before.z - after.z > 1.5
        before, after = teleport((after.x + 3, after.y, after.z))
        assert abs(after - before) < 0.01, "the arc ends at the wall"


def test_a_world_without_a_page_has_no_visitors() -> None:
    with pytest.raises(Failed, match=r"on no page. Try: world.start"), testing.Headset(iota.World(iota.System())):
        pass
