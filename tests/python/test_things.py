# SPDX-License-Identifier: Apache-2.0
"""What a script adds to the page beside bodies, as a page is told of it."""

from __future__ import annotations

import threading
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from page_client import NOTHING, PageClient
from waiting import wait_until

import iota
from iota import looks
from iota._protocol import FIRST_FRAME, NO_BODY, NO_COLOR, PointerKind, WidgetKind

Runner = Callable[[iota.World], str]


@pytest.fixture
def rod(system: iota.System) -> iota.Body:
    """From (0, 1, 0) to (1, 1, 0), held still at both ends."""
    body = system.body()
    body.particle((0, 1, 0)).nail()
    body.particle((1, 1, 0)).nail()
    return body


def entity(page: PageClient, kind: str, slot: int = 0) -> dict[str, Any]:
    found: dict[str, Any] = page.wait_for(lambda: page.entities[kind].get(slot))
    return found


def test_assigning_updates_and_only_changes_are_sent(rod: iota.Body, run_world: Runner) -> None:
    world = iota.World(rod.system)
    label = world.label("one", at=rod.particles[1], offset=(0, 0.25, 0), color="#ff8000")
    others = [world.label(number) for number in range(50)]
    with PageClient(run_world(world)) as page:
        seen = entity(page, "label")
        assert seen["text"] == "one" and seen["color"] == 0xFF8000 and seen["offset"] == (0, 0.25, 0)
        assert seen["a"] == seen["b"] == {"body": rod.slot, "point": pytest.approx((0.5, 0, 0))}
        assert page.wait_for(lambda: len(page.entities["label"]) == 51)
        told = page.told
        world.call(lambda: setattr(label, "text", "two"))
        page.wait_for(lambda: page.entities["label"][0]["text"] == "two")
        assert page.told == told + 1, "one label of 51"
        world.call(lambda: setattr(label, "text", "two"))
        world.call(lambda: setattr(others[3], "visible", False))
        page.wait_for(lambda: 4 not in page.entities["label"])
        world.call(lambda: setattr(others[3], "visible", True))
        page.wait_for(lambda: 4 in page.entities["label"])
        world.call(label.destroy)
        page.wait_for(lambda: 0 not in page.entities["label"])
        assert page.told == told + 2 and not label.alive and len(world.drawings.things) == 50
        new = world.call(lambda: world.label("in the place of the first"))
        assert entity(page, "label")["id"][1] > seen["id"][1], "another one in that slot"
        assert new.text == "in the place of the first"


def test_drawings_on_a_particle_stay_on_it_when_bodies_are_cut(run_world: Runner) -> None:
    system = iota.System()
    body, other = system.body(), system.body()
    first = body.particle((0, 1, 0))
    body.particle((1, 1, 0))
    last = other.particle((2, 1, 0))
    world = iota.World(system)
    world.label("end", at=last)
    arrow = world.drawings.arrow(first, last)
    bond = system.bond(first, last, "spring", stiffness=1, length=2)
    world.label("middle", at=bond)
    world.clock.paused = True
    with PageClient(run_world(world)) as page:
        before = entity(page, "label")["a"]
        assert before["body"] == other.slot
        assert entity(page, "label", 1)["a"] != entity(page, "label", 1)["b"], "between the ends of the bond"
        world.call(lambda: body.combine(other))
        page.wait_for(lambda: len(page.bodies) == 1)
        page.wait_for(lambda: page.entities["label"][0]["a"]["body"] == body.slot)
        assert page.entities["label"][0]["a"]["point"] == pytest.approx((1, 0, 0), abs=0.6)
        world.call(body.destroy)
        page.wait_for(lambda: not page.entities["label"] and not page.entities["arrow"])
        assert arrow.alive, "the script may give it another place"
        world.call(lambda: (setattr(arrow, "at", (0, 0, 0)), setattr(arrow, "to", (0, 3, 0))))
        assert entity(page, "arrow")["b"] == {"body": NO_BODY, "point": (0, 3, 0)}


def test_thousands_are_set_by_one_array(rod: iota.Body, run_world: Runner) -> None:
    world = iota.World(rod.system)
    places = np.random.default_rng(1).uniform(-1, 1, (5000, 3))
    points = world.points(places, radius=0.01, color=np.linspace(0, 1, 15000).reshape(5000, 3))
    with PageClient(run_world(world)) as page:
        seen = entity(page, "point_cloud")
        np.testing.assert_allclose(np.reshape(seen["points"], (5000, 3)), places, atol=1e-6)
        assert len(seen["colors"]) == 5000 and seen["colors"][-1] == 0xFFFFFF and seen["radii"] == [pytest.approx(0.01)]
        world.call(lambda: setattr(points, "points", places + 1))
        page.wait_for(lambda: page.entities["point_cloud"][0]["points"][0] > seen["points"][0] + 0.5)


def test_thousands_of_arrows_and_lines_are_set_by_one_array(rod: iota.Body, run_world: Runner) -> None:
    random = np.random.default_rng(1)
    starts, ways = random.uniform(-1, 1, (2, 3000, 3))
    ways[:4] = [(0, 0, 0), (-2, 0, 0), (-1, 1e-8, 0), (0, 0, 3)]  # nowhere, backwards, nearly so, up to the user

    def ends(seen: dict[str, Any]) -> Any:
        """Where the page draws the end of each: of a shape from the origin to x = 1."""
        x, y, z, w = np.reshape(seen["rotations"], (-1, 4)).T
        to = np.column_stack([1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w)])
        return np.reshape(seen["places"], (-1, 3)) + to * np.reshape(seen["scales"], (-1, 3))[:, :1]

    world = iota.World(rod.system)
    arrows = world.drawings.arrows(starts, ways, color="#ff0000", at=rod)
    lines = world.drawings.segments(starts, starts + ways, radius=0.01, color=random.uniform(0, 1, (3000, 3)))
    with PageClient(run_world(world)) as page:
        seen = entity(page, "shape_set")
        np.testing.assert_allclose(ends(seen), starts + ways, atol=2e-6)
        scales = np.reshape(seen["scales"], (-1, 3))
        np.testing.assert_allclose(scales[:, 1], scales[:, 0], err_msg="as thick as it is long")
        assert seen["at"]["body"] == rod.slot and seen["part"]["color"] == 0xFF0000
        drawn = entity(page, "shape_set", 1)
        np.testing.assert_allclose(ends(drawn), starts + ways, atol=2e-6)
        scales = np.reshape(drawn["scales"], (-1, 3))
        assert scales[0].tolist() == [0, 0, 0] and scales[1:, 1:] == pytest.approx(0.01), (
            "what has no length is not drawn"
        )
        assert len(drawn["colors"]) == 3000
        world.call(lambda: (setattr(arrows, "radius", 0.036), setattr(arrows, "vectors", 2 * ways)))
        page.wait_for(lambda: page.entities["shape_set"][0]["scales"] != seen["scales"])
        now = page.entities["shape_set"][0]
        np.testing.assert_allclose(ends(now), starts + 2 * ways, atol=4e-6)
        assert np.reshape(now["scales"], (-1, 3))[1:, 1] == pytest.approx(2), "twice the shaft of the drawn shape"
        world.call(lambda: setattr(lines, "ends", starts[:5]))
        page.wait_for(lambda: any("ends must be 3000" in notice["text"] for notice in page.notices))
    with pytest.raises(ValueError, match="starts: may have 262144 rows at most, not 300000"):
        world.drawings.arrows(np.zeros((300_000, 3)), np.zeros((300_000, 3)))


def test_a_script_may_navigate_by_keys_and_a_camera_of_its_own(rod: iota.Body, run_world: Runner) -> None:
    world = iota.World(rod.system, camera=iota.Camera((0, 1, 4), (0, 1, 0)))

    @world.on_key("w")
    def nearer() -> None:
        assert world.camera is not None
        world.camera = iota.Camera((0, 1, world.camera.position[2] - 1), (0, 1, 0))

    with PageClient(run_world(world)) as page:
        page.wait_for(lambda: page.last["listens"]["keys"] == ["w"])
        for z in (3, 2):
            page.send("key", key="w", down=True)
            page.wait_for(lambda z=z: page.last["world_settings"]["camera_position"] == (0, 1, z))
        page.send("control", command=3, value=0)
        page.wait_for(lambda: page.last["world_settings"]["camera_position"] == (0, 1, 4))


def test_more_than_pages_take_is_refused_where_it_is_assigned(rod: iota.Body) -> None:
    world = iota.World(rod.system)
    many = np.zeros((1_100_000, 3), np.float32)
    with pytest.raises(ValueError, match="points: may have 1048576 rows at most, not 1100000; draw them in several"):
        world.points(many, radius=0.1)
    with pytest.raises(ValueError, match="positions: may have 349525 rows at most"):
        world.drawings.shapes(looks.sphere(0.1), many)
    with pytest.raises(ValueError, match="points: may have 349525 rows"):
        world.surface(many, [(0, 1, 2)])
    with pytest.raises(ValueError, match="triangles: may have 349525 rows"):
        world.surface(many[:3], np.zeros((400_000, 3), int))
    shapes = world.drawings.shapes(looks.sphere(0.1), many[:100])
    with pytest.raises(ValueError, match="positions: may have"):
        shapes.positions = many
    assert len(shapes.positions) == 100


def test_more_things_than_pages_draw_are_refused_and_the_others_stay(
    rod: iota.Body, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("iota.world.things.MOST_THINGS", 3)
    world = iota.World(rod.system)
    kept = [world.label("a", at=(x, 0, 0)) for x in range(3)]
    with pytest.raises(ValueError, match=r"at most 3 things .* by one array: world\.points"):
        world.label("b")
    assert world.drawings.things == kept
    kept[0].destroy()
    assert len(world.drawings.things) == 2 and world.label("c") in world.drawings.things


def test_pages_that_open_later_get_the_notice_of_a_thing_that_cannot_be_shown(
    rod: iota.Body, run_world: Runner
) -> None:
    world = iota.World(rod.system)
    world.points([(0, 0, 0)] * 3, radius=[0.1, 0.2])
    url = run_world(world)
    for _ in range(2):
        with PageClient(url) as page:
            notice = page.wait_for(lambda page=page: page.notices)[0]
            assert "Points: radius must be one, or one for each of the 3 points" in notice["text"]


def test_lines_axes_traces_and_shapes_have_the_records_of_the_protocol(rod: iota.Body, run_world: Runner) -> None:
    world = iota.World(rod.system)
    line = world.drawings.line(rod.particles[0], (0, 0, 0), radius=0.02, closed=True)
    world.drawings.line(np.zeros((4, 2)))
    world.drawings.axes(rod, length=0.3)
    world.drawings.trace(rod.particles[1], seconds=2, color=(1, 0, 0))
    world.drawings.shape(looks.sphere(0.1, "steel"), position=(0, 0.5, 0), on=rod, color=0x112233)
    with PageClient(run_world(world)) as page:
        seen = entity(page, "line")
        assert seen["bodies"] == [rod.slot, NO_BODY] and seen["points"] == pytest.approx([-0.5, 0, 0, 0, 0, 0])
        assert seen["closed"] and seen["radius"] == pytest.approx(0.02) and seen["color"] == NO_COLOR
        assert entity(page, "line", 1)["points"] == [0] * 12
        assert entity(page, "axes")["at"] == {"body": rod.slot, "point": (0, 0, 0)}
        assert entity(page, "trace")["seconds"] == 2 and page.entities["trace"][0]["color"] == 0xFF0000
        marker = entity(page, "marker")
        assert marker["body"] == rod.slot and marker["part"]["shape"]["kind"] == "sphere"
        assert marker["part"]["color"] == 0x112233 and marker["part"]["offset"] == (0, 0.5, 0)
        world.call(lambda: setattr(line, "points", [(0, 0, 0), rod.particles[1], (1, 2, 3)]))
        page.wait_for(lambda: len(page.entities["line"][0]["bodies"]) == 3)


@pytest.mark.parametrize(
    ("make", "said"),
    [
        (lambda w: w.label("x", at=(float("nan"), 0, 0)), "at: must be finite"),
        (lambda w: w.label("x", color="redd"), 'color: a color is "#rrggbb"'),
        (lambda w: w.label("x", height=-1), "height: must be a finite number from 0"),
        (lambda w: w.points(np.zeros((3, 4))), r"points: must have the shape \(n, 2\) or \(n, 3\)"),
        (lambda w: w.points([[0, 0, np.inf]]), "points: must be finite"),
        (lambda w: w.controls.slider("s", 3, 2), "a minimum below its maximum"),
        (lambda w: w.controls.choice("c", []), "at least one option"),
        (lambda w: w.controls.choice("c", ["a"], "b"), "value must be one of a"),
        (lambda w: w.controls.plot("p", ["a", "b"]).add(0, 1), "has 2 curves, not 1"),
        (lambda w: w.on_key(""), "a key is one character"),
    ],
)
def test_bad_values_are_refused_by_name(make: Callable[[iota.World], Any], said: str) -> None:
    with pytest.raises(ValueError, match=said):
        make(iota.World(iota.System()))


def test_a_bad_assignment_leaves_a_thing_as_it_was() -> None:
    label = iota.World(iota.System()).label("x", at=(1, 2, 3))
    with pytest.raises(ValueError, match="at"):
        label.at = (1, 2, float("inf"))
    assert label.at == iota.Vec3(1, 2, 3)


# --- controls -----------------------------------------------------------------------------------------------------------


def test_controls_reach_the_script_and_all_pages(system: iota.System, run_world: Runner) -> None:
    world = iota.World(system)
    heard: list[Any] = []
    slider = world.controls.slider("gravity", 0, 20, 9.5, step=0.5, unit="m/s²")
    check = world.controls.checkbox("wind")
    choice = world.controls.choice("law", ["spring", "rope"], "rope")
    text = world.controls.text("name", "Ada")
    slider.on_change(lambda: heard.append(slider.value))
    check.on_change(lambda event: heard.append((event.client, event.name, check.value)))

    @world.controls.button("go", help="starts")
    def go(event: iota.Event) -> None:
        heard.append("go")
        event.notice("gone")

    with PageClient(run_world(world)) as page, PageClient(world.pages.url or "") as other:
        seen = entity(page, "widget")
        assert seen["kind"] == WidgetKind.SLIDER and seen["value"] == 9.5 and seen["unit"] == "m/s²"
        assert entity(page, "widget", 2)["options"] == ["spring", "rope"] and page.entities["widget"][2]["value"] == 1

        def change(slot: int, value: float = 0.0, typed: str = "") -> None:
            page.send("change", widget=entity(page, "widget", slot)["id"], value=value, text=typed)

        change(0, 3.2)
        other.wait_for(lambda: other.entities["widget"][0]["value"] == 3.0)
        change(0, 1e9)
        other.wait_for(lambda: other.entities["widget"][0]["value"] == 20.0)
        change(2, 0)
        change(1, 1)
        change(2, 17)  # no such option
        change(3, typed="Grace")
        change(4)
        page.wait_for(lambda: page.notices)
        assert heard == [3.0, 20.0, (page.id, "wind", True), "go"]
        assert (choice.value, text.value) == ("spring", "Grace")
        world.call(lambda: setattr(slider, "value", 5))
        other.wait_for(lambda: other.entities["widget"][0]["value"] == 5.0)
        assert len(heard) == 4, "the script's own assignments call nothing"
        world.call(lambda: setattr(check, "enabled", False))
        other.wait_for(lambda: not other.entities["widget"][1]["enabled"])
        change(1, 0)
        page.send("change", widget=(999, 1), value=0, text="")
        page.wait_for(lambda: page.notices[-1]["title"] == "It no longer exists")
        assert check.value is True


def test_a_control_that_raises_is_reported_and_the_world_goes_on(run_world: Runner) -> None:
    world = iota.World(iota.System())
    slider = world.controls.slider("s", 0, 1)

    @slider.on_change
    def bad() -> None:
        raise RuntimeError("no such thing")

    with PageClient(run_world(world)) as page:
        page.send("change", widget=entity(page, "widget")["id"], value=1, text="")
        (notice,) = page.wait_for(lambda: page.notices)
        assert "'s'" in notice["title"] and "no such thing" in notice["text"] and slider.value == 1


def test_a_plot_samples_by_itself_and_begins_anew_after_reset(run_world: Runner) -> None:
    system = iota.System()
    ball = system.body().particle((0, 100, 0))
    world = iota.World(system, ground=None)
    world.controls.plot("height", lambda: ball.position.y, unit="m", seconds=1)
    own = world.controls.plot("mine", ["a", "b"])
    world.on_step(lambda: own.add(system.time, 1, 2))
    with PageClient(run_world(world)) as page:
        seen = page.wait_for(lambda: (p := page.entities["plot"].get(0)) and p["times"] and p["times"][-1] > 1.3 and p)
        assert seen["times"] == sorted(seen["times"]) and seen["times"][0] > seen["times"][-1] - 1.01
        at, height = seen["times"][-1], seen["values"][-1]
        assert height == pytest.approx(100 - 9.81 * at**2 / 2, abs=0.1)
        assert page.entities["plot"][1]["curves"] == ["a", "b"] and len(page.entities["plot"][1]["times"]) > 5
        world.call(world.reset)
        page.wait_for(lambda: page.entities["plot"][0]["times"][-1] < 1)


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("value", [1e39, -1e300, float("inf"), float("nan")])
def test_a_value_that_is_too_large_for_a_page_is_a_gap_in_its_plot(value: float) -> None:
    world = iota.World(iota.System(), ground=None)
    largest = 3.4028234e38
    plot = world.controls.plot("huge", ["a", "b"])
    plot.add(0.0, largest, 0.0)
    plot.add(1.0, 0.0, value)
    plot.add(2.0, 1.0, -largest)
    record = plot._record()
    assert record is not None and record["times"] == [0.0, 2.0]
    assert np.isfinite(np.asarray(record["values"], "f4")).all()


# --- what users do ------------------------------------------------------------------------------------------------------


def point(page: PageClient, kind: PointerKind, body: tuple[int, int] = NOTHING) -> None:
    places = {"point": (1, 2, 3), "origin": (0, 1, 5), "direction": (0, 0, -1), "rotation": (0, 0, 0, 1)}
    page.send("pointer", kind=kind, body=body, name="mouse", **places)


def test_clicks_and_hovers_reach_who_asked_for_that_body(rod: iota.Body, run_world: Runner) -> None:
    other = rod.system.body()
    other.particle((0, 3, 0)).nail()
    world = iota.World(rod.system)
    heard: list[Any] = []
    world.on_click(rod)(lambda e: heard.append(("rod", e.client, tuple(e.point), e.pointer)))
    world.on_click(lambda e: heard.append(("any", e.body.slot)))
    world.on_click("nothing")(lambda e: heard.append(("nothing", e.target, e.point, tuple(e.direction))))
    world.on_click([other])(lambda: heard.append("other"))
    world.on_hover(rod)(lambda e: heard.append(e.phase))
    with PageClient(run_world(world)) as page:
        assert page.wait_for(lambda: page.last.get("listens")) == {
            "clicks": True,
            "hovers": True,
            "moves": False,
            "keys": [],
        }
        point(page, PointerKind.CLICK, page.body(rod.slot))
        point(page, PointerKind.CLICK)
        point(page, PointerKind.HOVER, page.body(rod.slot))
        point(page, PointerKind.HOVER_END, page.body(rod.slot))
        point(page, PointerKind.CLICK, page.body(other.slot))
        point(page, PointerKind.CLICK, (4000, 1))  # gone: nobody is told
        page.wait_for(lambda: len(heard) == 7)
        assert heard[:2] == [("rod", page.id, (1, 2, 3), "mouse"), ("any", rod.slot)]
        assert heard[2] == ("nothing", None, None, (0, 0, -1))
        assert heard[3:5] == ["start", "end"] and set(map(str, heard[5:])) == {"other", str(("any", other.slot))}
        assert page.notices == []


def test_a_class_of_bodies_is_a_group_which_they_join_and_leave(rod: iota.Body, run_world: Runner) -> None:
    bricks = rod.system.group("bricks")
    other = rod.system.body()
    other.particle((0, 3, 0)).nail()
    world = iota.World(rod.system)
    heard: list[Any] = []
    world.on_click(bricks)(lambda e: heard.append(e.body.slot))
    world.on_drag(bricks, grab=False)(lambda e: heard.append(e.phase))
    world.on_click("nothing")(lambda: heard.append("nothing"))
    with pytest.raises(TypeError, match="a group"):
        world.on_click([rod, bricks])
    with PageClient(run_world(world)) as page:
        page.wait_for(lambda: page.last.get("listens"))

        def click(body: iota.Body, *expected: Any) -> None:
            heard.clear()
            point(page, PointerKind.CLICK, page.body(body.slot))
            point(page, PointerKind.CLICK)
            page.wait_for(lambda: "nothing" in heard)
            assert heard == [*expected, "nothing"]

        click(rod)
        world.call(lambda: bricks.add(rod.particles[0], other))
        click(rod, rod.slot)
        click(other, other.slot)
        heard.clear()
        page.send("grab_start", hold=1, body=page.body(rod.slot), local_point=(0, 0, 0), target=(1, 0, 0))
        page.send("grab_end", hold=1)
        page.wait_for(lambda: heard == ["start", "end"])
        world.call(lambda: bricks.remove(rod))
        click(rod)
        world.call(bricks.destroy)
        click(other)


def test_a_drag_may_be_the_scripts_own(rod: iota.Body, run_world: Runner) -> None:
    world = iota.World(rod.system)
    heard: list[Any] = []
    pointers: list[str] = []
    world.on_drag(rod, grab=False)(lambda e: heard.append((e.phase, e.point and tuple(e.point))))
    world.on_press(lambda e: heard.append("press") or pointers.append(e.pointer))  # type: ignore[func-returns-value]
    world.on_release(lambda: heard.append("release"))
    with PageClient(run_world(world)) as page:
        page.send("grab_start", hold=1, body=page.body(rod.slot), local_point=(0, 0, 0), target=(1, 0, 0))
        page.wait_for(lambda: len(heard) == 2)
        page.send("grab_move", hold=1, target=(2, 0, 0))
        page.wait_for(lambda: len(heard) == 3)
        assert not page.last["poses"]["holds"] and world.users.held() is None, "no spring pulls"
        page.send("grab_end", hold=1)
        page.wait_for(lambda: len(heard) == 5)
        assert heard == ["press", ("start", (1, 0, 0)), ("update", (2, 0, 0)), ("end", None), "release"]
        page.send(
            "grab_start", hold=2, body=page.body(rod.slot), local_point=(0, 0, 0), target=(1, 0, 0), pointer="left"
        )
        page.wait_for(lambda: len(heard) == 7)
        assert pointers == ["mouse", "left"]
    world.call(lambda: None)
    wait_until(lambda: len(heard) == 9)
    assert heard[7:] == [("end", None), "release"], "a page that leaves lets go"


def test_a_drag_ends_with_a_reason_when_the_body_is_taken_out_of_the_hand(
    system: iota.System, run_world: Runner
) -> None:
    system.gravity = (0, 0, 0)
    first, second, third = (system.body().particle((x, 0, 0)).body for x in range(3))
    world = iota.World(system, ground=None)
    heard: list[Any] = []
    world.on_drag(lambda e: heard.append((e.phase, e.target and e.target.slot, e.reason)))
    world.on_release(first)(lambda e: heard.append(("released", e.target, e.reason)))
    with PageClient(run_world(world)) as page:
        for hold, body in enumerate((first, second, third)):
            page.send("grab_start", hold=hold, body=page.body(body.slot), local_point=(0, 0, 0), target=(hold, 0, 0))
        page.wait_for(lambda: len(heard) == 3)
        del heard[:]
        world.call(first.destroy)
        page.wait_for(lambda: len(heard) == 2)
        assert heard == [("end", None, "destroyed"), ("released", None, "destroyed")]
        page.send("grab_end", hold=0)  # late
        page.send("grab_end", hold=1)
        page.wait_for(lambda: len(heard) == 3)
        assert heard[2] == ("end", second.slot, "released")
        world.call(world.reset)
        page.wait_for(lambda: len(heard) == 4)
        assert heard[3] == ("end", third.slot, "reset")
        page.send("grab_start", hold=7, body=page.body(third.slot), local_point=(0, 0, 0), target=(2, 0, 0))
        page.wait_for(lambda: len(heard) == 5)
    wait_until(lambda: len(heard) == 6)
    assert heard[5] == ("end", third.slot, "left")


def test_a_pointer_is_seen_by_the_script_and_a_particle_that_bonds_pull_at(run_world: Runner) -> None:
    system = iota.System(gravity=(0, 0, 0))
    finger = system.body().particle((0, 1, 0))
    finger.body.kind = "scripted"
    ball = system.body().particle((0.5, 1, 0), 0.1)
    system.bond(finger, ball, "spring", stiffness=20.0, length=0.0, damping=1.0)
    world = iota.World(system, ground=None)
    heard: list[iota.Event] = []

    @world.on_pointer
    def follow(event: iota.Event) -> None:
        heard.append(event)
        if event.pointer == "right hand":
            finger.position = event.point

    joints = [float(number) for number in range(75)]
    with PageClient(run_world(world)) as page:
        page.wait_for(lambda: page.last.get("listens", {}).get("moves"))
        common = {"kind": PointerKind.MOVE, "body": NOTHING, "origin": (0, 2, 1), "direction": (0, 0, -1)}
        page.send(
            "pointer",
            name="right hand",
            point=(3, 1, 0),
            rotation=(1, 0, 0, 0),
            buttons=[0.75],
            joints=joints,
            **common,
        )
        page.send(
            "pointer", name="left", point=(1, 1, 1), rotation=(0, 0, 0, 1), buttons=[0, 1], axes=[0.5, -0.25], **common
        )
        page.wait_for(lambda: len(heard) == 2)
        hand, controller = heard
        assert (hand.client, hand.pointer, hand.target, tuple(hand.point)) == (page.id, "right hand", None, (3, 1, 0))
        assert hand.hand is not None and controller.hand is not None
        assert (hand.hand.trigger, hand.hand.grip, hand.hand.stick, hand.hand.rotation) == (
            0.75,
            0,
            (0, 0),
            (1, 0, 0, 0),
        )
        assert hand.hand.joints.shape == (25, 3) and hand.hand.joints[8].tolist() == [24, 25, 26]
        assert (controller.hand.grip, controller.hand.stick, controller.hand.joints.shape) == (1, (0.5, 0.25), (0, 3))
        assert tuple(controller.origin) == (0, 2, 1)
        page.wait_for(lambda: world.call(lambda: abs(ball.position - iota.Vec3(3, 1, 0))) < 0.5)


def test_keys_joins_and_frames_are_called_until_forgotten(run_world: Runner) -> None:
    world = iota.World(iota.System())
    heard: list[Any] = []

    @world.on_key("k")
    def pressed(event: iota.Event) -> None:
        heard.append(event.key)

    world.on_key("k", release=True)(lambda: heard.append("up"))
    world.on_join(lambda e: heard.append(("join", e.client)))
    world.on_leave(lambda e: heard.append(("leave", e.client)))
    frames: list[float] = []
    world.on_frame(lambda: frames.append(world.system.time))
    with PageClient(run_world(world)) as page:
        page.wait_for(lambda: page.last.get("listens", {}).get("keys") == ["k"])
        page.send("key", key="k", down=True)
        page.send("key", key="k", down=False)
        page.send("key", key="j", down=True)
        page.wait_for(lambda: len(heard) == 3 and len(frames) > 5)
        assert heard == [("join", page.id), "k", "up"]
        assert world.call(lambda: world.events.forget(pressed)) and not world.call(lambda: world.events.forget(print))
        page.send("key", key="k", down=True)
        number = page.id
    wait_until(lambda: len(heard) == 4)
    assert heard[3] == ("leave", number)


def test_an_on_frame_that_raises_is_reported_once(run_world: Runner) -> None:
    world = iota.World(iota.System())

    @world.on_frame
    def bad() -> None:
        raise RuntimeError("each time")

    with PageClient(run_world(world)) as page:
        page.wait_for(lambda: page.pose_frames > 10)
        assert len(page.notices) == 1


def test_effects_of_the_script_reach_all_pages(run_world: Runner) -> None:
    world = iota.World(iota.System())
    world.drawings.effect("join", (0, 0, 0))  # nobody is there to see it
    url = run_world(world)
    with PageClient(url) as one, PageClient(url) as two:
        world.call(lambda: world.drawings.effect("break", (1, 2, 3)))
        for page in (one, two):
            (effect,) = page.wait_for(lambda page=page: page.effects)
            assert effect["kind"] == "break" and effect["position"] == pytest.approx((1, 2, 3))
    with pytest.raises(ValueError, match="kind must be one of 'break', 'join', 'grab', 'impact', not 'boom'"):
        world.drawings.effect("boom", (0, 0, 0))  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="finite"):
        world.drawings.effect("join", (0, float("nan"), 0))


def test_a_picture_comes_from_the_page(run_world: Runner, tmp_path: Path) -> None:
    world = iota.World(iota.System())
    with PageClient(run_world(world)) as page:
        (client,) = page.wait_for(lambda: world.users.clients)

        def answer() -> None:
            number = page.wait_for(lambda: page.last.get("ask_picture"))["request"]
            page.send("key", key="x", down=True)  # waits until the picture is there
            page.send("picture", request=number, is_last=False, data=b"PN")
            page.send("picture", request=number, is_last=True, data=b"G")

        thread = threading.Thread(target=answer)
        thread.start()
        assert client.screenshot(tmp_path / "shot.png") == b"PNG"
        thread.join()
        assert (tmp_path / "shot.png").read_bytes() == b"PNG"
        with pytest.raises(TimeoutError, match=r"0\.2 s"):
            client.screenshot(seconds=0.2)
        page.send("picture", request=77, is_last=True, data=b"spam")
        page.wait_for(lambda: any("none was asked for" in n["text"] for n in page.notices))


def test_surfaces_lose_the_triangles_whose_thread_is_gone(run_world: Runner) -> None:
    system = iota.System(gravity=(0, 0, 0))
    knots = [system.body().particle(place) for place in ((0, 0, 0), (1, 0, 0), (0, 1, 0), (1, 1, 0))]
    pairs = [(0, 1), (0, 2), (1, 3), (2, 3), (1, 2)]
    threads = [system.bond(knots[a], knots[b], "spring", stiffness=1) for a, b in pairs]
    slots = [knot.body.slot for knot in knots]
    world = iota.World(system)
    surface = world.surface(knots, [(0, 1, 2), (1, 3, 2)], threads=threads, color="#ff800080")
    with PageClient(run_world(world)) as page:
        seen = entity(page, "surface")
        assert seen["triangles"] == [0, 1, 2, 1, 3, 2] and seen["bodies"] == slots
        assert seen["color"] == 0x7FFF8000, "half is seen through it"
        world.call(lambda: setattr(threads[2], "active", False))
        page.wait_for(lambda: page.entities["surface"][0]["triangles"] == [0, 1, 2])
        world.call(lambda: setattr(threads[2], "active", True))
        page.wait_for(lambda: len(page.entities["surface"][0]["triangles"]) == 6)
        world.call(lambda: setattr(threads[2], "break_force", 0.1))
        world.call(lambda: setattr(knots[3], "velocity", (0, 1, 0)))
        page.wait_for(lambda: page.entities["surface"][0]["triangles"] == [0, 1, 2])
        world.call(threads[2].destroy)
        world.call(threads[4].destroy)
        page.wait_for(lambda: page.entities["surface"][0]["triangles"] == [])
        world.call(lambda: setattr(surface, "triangles", [(0, 1, 4)]))
        notice = page.wait_for(lambda: page.last.get("notice"))
        assert "Surface: triangles: name point 4, but there are 4" in notice["title"] + notice["text"]
        world.call(lambda: setattr(surface, "triangles", [(0, 2, 3)]))
        page.wait_for(lambda: page.entities["surface"][0]["triangles"] == [0, 2, 3])


def test_bodies_are_painted_by_one_array_and_the_survivor_keeps_its_own(run_world: Runner) -> None:
    system = iota.System(gravity=(0, 0, 0))
    bodies = [system.body(shape=iota.Sphere(0.1), mass=1, position=(i, 0, 0)) for i in range(300)]
    slots = [body.slot for body in bodies]
    world = iota.World(system)
    paint = world.drawings.paint(bodies, np.linspace(0, 1, 900).reshape(300, 3))
    with PageClient(run_world(world)) as page:
        seen = entity(page, "paint")
        assert seen["bodies"] == slots and seen["colors"][-1] == 0xFEFFFF
        world.call(bodies[5].destroy)
        page.wait_for(lambda: len(page.entities["paint"][0]["bodies"]) == 299)
        assert slots[5] not in page.entities["paint"][0]["bodies"], "what comes into its slot is not painted"
        world.call(lambda: setattr(paint, "color", "#102030"))
        page.wait_for(lambda: page.entities["paint"][0]["colors"] == [0x102030])
    with pytest.raises(TypeError, match="bodies: must be bodies"):
        world.drawings.paint("all", "#102030")


def test_frames_carry_hide_and_remove_their_drawings(rod: iota.Body, run_world: Runner) -> None:
    slot = rod.slot
    world = iota.World(rod.system)
    outer = world.drawings.frame(rod, rotation=(0, 0, 0, 2))
    inner = world.drawings.frame(outer.point((0, 1, 0)))
    world.drawings.shape(looks.sphere(0.1), on=inner, position=(0, 0, 0.5))
    world.drawings.line(inner.point((1, 0, 0)), rod)
    with PageClient(run_world(world)) as page:
        assert entity(page, "frame") | {"id": None} == {
            "id": None,
            "at": {"body": slot, "point": (0, 0, 0)},
            "rotation": (0, 0, 0, 1),
        }
        assert entity(page, "frame", 1)["at"] == {"body": FIRST_FRAME, "point": (0, 1, 0)}
        marker = entity(page, "marker")
        assert marker["body"] == FIRST_FRAME + 1 and marker["part"]["offset"] == (0, 0, 0.5)
        assert entity(page, "line")["bodies"] == [FIRST_FRAME + 1, slot]
        world.call(lambda: setattr(outer, "visible", False))
        page.wait_for(lambda: not page.entities["marker"] and not page.entities["line"])
        world.call(lambda: setattr(outer, "visible", True))
        page.wait_for(lambda: page.entities["marker"] and page.entities["line"])
        with pytest.raises(ValueError, match="a frame cannot be on itself"):
            world.call(lambda: setattr(outer, "at", inner))
        world.call(inner.destroy)
        page.wait_for(lambda: not page.entities["marker"] and not page.entities["line"])


def test_a_frame_that_moves_is_sent_alone(rod: iota.Body, run_world: Runner, monkeypatch: pytest.MonkeyPatch) -> None:
    """Pages move what is on it: a script may move frames in each step beside many things."""
    world = iota.World(rod.system)
    frame = world.drawings.frame((0, 0, 0))
    line = world.drawings.line(frame.point((1, 0, 0)), rod)
    sent: list[None] = []
    record = type(line)._record
    with PageClient(run_world(world)) as page:
        entity(page, "line")
        monkeypatch.setattr(type(line), "_record", lambda self: (sent.append(None), record(self))[1])
        for x in (1.0, 2.0, 3.0):
            world.call(lambda x=x: setattr(frame, "at", (x, 0, 0)))
            page.wait_for(lambda x=x: entity(page, "frame")["at"]["point"] == (x, 0, 0))
        assert sent == []


def test_what_is_on_a_frame_comes_back_with_its_next_place(rod: iota.Body, run_world: Runner) -> None:
    world = iota.World(rod.system)
    lost = world.system.body()
    lost.particle((0, 9, 0))
    frame = world.drawings.frame(lost)
    world.drawings.line(frame.point((1, 0, 0)), rod)
    with PageClient(run_world(world)) as page:
        entity(page, "line")
        world.call(lost.destroy)
        page.wait_for(lambda: not page.entities["line"])
        world.call(lambda: setattr(frame, "at", (0, 3, 0)))
        page.wait_for(lambda: page.entities["line"])


def test_struts_tubes_and_sets_have_the_records_of_the_protocol(rod: iota.Body, run_world: Runner) -> None:
    slot = rod.slot
    world = iota.World(rod.system)
    strut = world.drawings.strut(rod.particles[0], (0, 4, 0), looks.cylinder(0.02), color=(1, 0, 0))
    world.drawings.strut(rod, (0, 4, 0), looks.box((0.5, 0.1, 0.1)))
    world.drawings.tube(rod.particles[0], (0, 0, 0), radius=0.05)
    world.drawings.viewpoint("along", rod.particles[0], (0, 4, 0))
    world.drawings.stage(sky="#05070d", light=0.5)
    places = np.random.default_rng(1).uniform(-1, 1, (5000, 3))
    shapes = world.drawings.shapes(looks.cone(0.1, 0.2), places, sizes=np.linspace(1, 2, 5000), at=rod)
    with PageClient(run_world(world)) as page:
        seen = entity(page, "strut")
        assert seen["length"] == pytest.approx(3) and seen["part"]["shape"]["sizes"][1] == pytest.approx(3), (
            "it fits itself"
        )
        assert seen["part"]["color"] == 0xFF0000 and seen["a"]["body"] == slot
        assert entity(page, "strut", 1)["length"] == pytest.approx(0.5), "it is stretched"
        assert entity(page, "tube")["material"] == "rope"
        stage = entity(page, "stage")
        assert (stage["sky"], stage["ground"], stage["light"]) == (0x05070D, NO_COLOR, 0.5)
        view = entity(page, "viewpoint")
        assert view["name"] == "along" and view["eye"]["body"] == slot and view["target"]["body"] == NO_BODY
        seen = entity(page, "shape_set")
        np.testing.assert_allclose(np.reshape(seen["places"], (5000, 3)), places, atol=1e-6)
        assert seen["part"]["shape"]["kind"] == "cone" and len(seen["scales"]) == 5000 and seen["rotations"] == []
        world.call(lambda: setattr(shapes, "rotations", np.tile([0, 0, 0, 1.0], (5000, 1))))
        page.wait_for(lambda: len(page.entities["shape_set"][0]["rotations"]) == 20000)
        world.call(lambda: setattr(strut, "to", (0, 2, 0)))
        page.wait_for(lambda: page.entities["strut"][0]["length"] == pytest.approx(1))


@pytest.mark.parametrize(
    ("make", "says"),
    [
        (lambda w: w.surface([(0, 0, 0)], [(0, 1.5, 2)]), "triangles: must have the shape"),
        (lambda w: w.surface("no.stl"), "a surface needs triangles"),
        (
            lambda w: w.drawings.shapes(looks.sphere(0.1), [(0, 0, 0)], rotations=[(0, 0, 0, 0)]),
            "rotations: must have the shape",
        ),
        (
            lambda w: w.drawings.shape(looks.sphere(0.1), rotation=(0, 0, 0, 0)),
            "rotation: a rotation must be finite and not zero",
        ),
        (lambda w: w.drawings.tube((0, 0, 0), (1, 0, 0), radius=0), "radius: must be a finite number"),
        (lambda w: w.drawings.tube((0, 0, 0), (1, 0, 0), radius=1, material="silk"), "material must be one of"),
        (lambda w: looks.sphere(0.1, color="#12345"), "a color is"),
        (
            lambda w: looks.polygon([(0, 0), (1, 1), (1, 0), (0, 1)], 0.1),
            "it crosses or touches itself|encloses no volume",
        ),
    ],
)
def test_wrong_shapes_are_refused_with_the_reason(system: iota.System, make: Callable[..., Any], says: str) -> None:
    with pytest.raises((ValueError, TypeError), match=says):
        make(iota.World(system))


def test_a_thing_in_a_prompt_says_what_it_is(system: iota.System) -> None:
    world = iota.World(system, title="lab")
    slider = world.controls.slider("gravity", 0, 20, value=9.81)
    label = world.label("hello", at=(0, 1, 0), color="tomato")
    assert repr(slider).startswith("<Slider label='gravity'") and "value=9.81" in repr(slider)
    assert repr(label).startswith("<Label text='hello'") and "color=#ff6347" in repr(label)
    label.destroy()
    assert repr(label) == "<Label: destroyed>" and repr(world) == "<World 'lab'>"


def test_looks_of_all_shapes_enclose_their_volume() -> None:
    volume = {
        looks.pyramid((3, 2, 1)): 2.0,
        looks.half_sphere(1.0, segments=96): 2 / 3 * np.pi,
        looks.polygon([(0, 0), (0, 2), (1, 1), (2, 2), (2, 0)], 0.5): 1.5,
        looks.disc(1.0, 0.5): np.pi / 2,
        looks.cone(1.0, 3.0): np.pi,
        looks.ellipsoid((2, 4, 6)): 8 * np.pi,
        looks.arrow(1.0, 0.05): 8**0.5 * (0.05**2 * 0.65 + 0.13**2 * 0.35 / 3),  # of eight sides
    }
    for look, wanted in volume.items():
        body = iota.System().body(shape=look.shape, density=1.0)
        assert body.mass == pytest.approx(wanted, rel=0.01), look


ON = ("particle", "body", "bond", "frame", "place in a frame", "nothing")
DRAWINGS: dict[str, tuple[Callable[[iota.World, Any], Any], Callable[[dict[str, Any]], Any]]] = {
    "label": (lambda w, at: w.label("text", at=at), lambda e: e["a"]),
    "line": (
        lambda w, at: w.drawings.line(at, (9, 9, 9)),
        lambda e: {"body": e["bodies"][0] if e["bodies"] else NO_BODY},
    ),
    "tube": (
        lambda w, at: w.drawings.tube(at, (9, 9, 9), radius=0.1),
        lambda e: {"body": e["bodies"][0] if e["bodies"] else NO_BODY},
    ),
    "arrow": (lambda w, at: w.drawings.arrow(at, vector=(1, 0, 0)), lambda e: e["a"]),
    "axes": (lambda w, at: w.drawings.axes(at), lambda e: e["at"]),
    "trace": (lambda w, at: w.drawings.trace(at), lambda e: e["at"]),
    "point_cloud": (lambda w, at: w.points([(0, 0, 0)], at=at), lambda e: e["at"]),
    "marker": (lambda w, at: w.drawings.shape(looks.sphere(0.1), on=at), lambda e: e),
    "shape_set": (lambda w, at: w.drawings.shapes(looks.sphere(0.1), [(0, 0, 0)], at=at), lambda e: e["at"]),
    "strut": (lambda w, at: w.drawings.strut(at, (9, 9, 9), looks.cylinder(0.1)), lambda e: e["a"]),
    "surface": (lambda w, at: w.surface(np.eye(3), [(0, 1, 2)], at=at), lambda e: e["at"]),
    "light": (lambda w, at: w.drawings.light(at=at or (0, 0, 0)), lambda e: e["at"]),
    "frame": (lambda w, at: w.drawings.frame(at), lambda e: e["at"]),
    "custom": (lambda w, at: w.drawings.custom("own", at=at), lambda e: e["at"]),
    "viewpoint": (lambda w, at: w.drawings.viewpoint("here", at or (0, 0, 0), (9, 9, 9)), lambda e: e["eye"]),
}


@pytest.mark.parametrize("kind", DRAWINGS)
def test_every_drawing_is_on_a_particle_a_body_a_bond_a_frame_or_nothing(
    kind: str, rod: iota.Body, run_world: Runner
) -> None:
    system = rod.system
    other = system.body().particle((0, 3, 0))
    other.nail()
    bond = system.bond(rod.particles[1], other, "spring", stiffness=1.0, length=1.0)
    world = iota.World(system)
    frame = world.drawings.frame((5, 5, 5))
    places = {
        "particle": rod.particles[1], "body": rod, "bond": bond, "frame": frame, "place in a frame": frame.point((1, 0, 0)), "nothing": None,
    }  # fmt: skip
    make, anchor_of = DRAWINGS[kind]
    things = {
        on: make(world, (0, 0, 0) if at is None and kind in ("line", "tube", "strut", "arrow") else at)
        for on, at in places.items()
    }
    slots = {on: world._state.things.slot_of(thing) for on, thing in things.items()}
    with PageClient(run_world(world)) as page:
        page.wait_for(lambda: set(slots.values()) <= set(page.entities[kind]))
        bodies = {on: anchor_of(page.entities[kind][slot])["body"] for on, slot in slots.items()}
        expected = dict.fromkeys(ON[:3], rod.slot) | dict.fromkeys(ON[3:5], FIRST_FRAME) | {"nothing": NO_BODY}
        assert bodies == expected
        # What is on something ends with it.
        world.call(rod.destroy)
        page.wait_for(lambda: not {slots[on] for on in ON[:3]} & set(page.entities[kind]))
        assert {slots[on] for on in ON[3:]} <= set(page.entities[kind])


def drawn_on(world: iota.World, at: Any) -> dict[str, Any]:
    """One of each thing that has a place, on what is given."""
    corners = np.eye(3)
    ball = looks.sphere(0.1)
    return {
        "label": world.label("here", at=at),
        "line": world.drawings.line(at, (1, 1, 1)),
        "tube": world.drawings.tube(at, (1, 1, 1), radius=0.1),
        "arrow": world.drawings.arrow(at, vector=(0, 1, 0)),
        "axes": world.drawings.axes(at),
        "trace": world.drawings.trace(at),
        "points": world.points(corners, at=at),
        "shape": world.drawings.shape(ball, on=None if isinstance(at, tuple) else at),
        "shapes": world.drawings.shapes(ball, corners, at=at),
        "strut": world.drawings.strut(at, (1, 1, 1), looks.cylinder(0.1)),
        "surface": world.surface(corners, [(0, 1, 2)], at=at),
        "frame": world.drawings.frame(at),
        "viewpoint": world.drawings.viewpoint("there", at, (0, 0, 0)),
        "light": world.drawings.light("point", at=at),
        "custom": world.drawings.custom("flower", at=at),
    }


def bodies_in(record: Any) -> set[int]:
    """The numbers of the bodies that a record names."""
    if not isinstance(record, dict):
        return set()
    own = {int(record["body"])} if "body" in record else set()
    own |= {int(each) for each in record.get("bodies", ())}
    return own.union(*(bodies_in(each) for each in record.values()))


@pytest.mark.parametrize("on", ["particle", "body", "bond", "place"])
def test_each_thing_is_on_a_particle_a_body_a_bond_or_nothing_and_ends_with_it(rod: iota.Body, on: str) -> None:
    other = rod.system.body()
    spring = rod.system.bond(other.particle((0, 3, 0)), rod.particles[0], "energy = k*r^2", k=1.0)
    at = {"particle": other.particles[0], "body": other, "bond": spring, "place": (1.0, 2.0, 3.0)}[on]
    things = drawn_on(iota.World(rod.system), at)
    for name, thing in things.items():
        record = thing._record()
        assert record is not None, name
        named = bodies_in(record) - {NO_BODY}
        assert named == set() if on == "place" else other.slot in named, f"{name}: {record}"
    other.destroy()
    gone = {name for name, thing in things.items() if thing._record() is None}
    assert gone == (set() if on == "place" else set(things))
