# SPDX-License-Identifier: Apache-2.0
"""Each script of the first hour shows what it says, by poses; web/e2e/first_hour.test.ts looks at its pictures."""

from __future__ import annotations

import math
import runpy
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from page_client import PageClient

import iota
from iota.world.options import RunOptions, use

SCRIPTS = Path(__file__).resolve().parents[2] / "examples" / "first_hour"


class Script:
    """A script that has run for some seconds, with the names in it."""

    def __init__(self, name: str, seconds: float = 0.02) -> None:
        with use(RunOptions(headless=True, seconds=seconds)):
            self.names = runpy.run_path(str(SCRIPTS / f"{name}.py"), run_name="__main__")
        self.world: iota.World = self.names["world"]

    def __getattr__(self, name: str) -> Any:
        return self.names[name]

    def go_on(self, seconds: float) -> None:
        self.world.advance(round(seconds / self.world.dt))


def test_six_boxes_slide_down_the_ramp_and_rest_on_the_ground() -> None:
    ramp = Script("ramp", 8)
    for box in ramp.boxes:
        assert box.position.x > 0.75 and box.position.y > 0.12, "at the foot of the ramp, on the ground or on others"
        assert abs(box.velocity) < 0.01
    assert sum(box.position.x > 0.9 for box in ramp.boxes) >= 5, "at most one ends on the pile"
    assert any(box.position.y == pytest.approx(0.125, abs=1e-3) for box in ramp.boxes)


def test_the_blow_goes_through_the_cradle_to_the_last_ball_and_back() -> None:
    cradle = Script("newtons_cradle", 0.3)
    speeds = np.zeros((2, 5))
    for half in range(2):
        for _ in range(100):
            cradle.go_on(0.01)
            speeds[half] = np.maximum(speeds[half], [abs(ball.velocity.x) for ball in cradle.balls])
    blow = math.sqrt(2 * 9.81 * (1 - math.cos(math.radians(35))))
    assert speeds[0][0] == pytest.approx(blow, rel=0.02) and speeds[0][4] == pytest.approx(blow, rel=0.04)
    cradle.world.reset()
    cradle.go_on(0.75)
    last, *others = reversed([ball.velocity.x for ball in cradle.balls])
    assert last > 0.5 and max(map(abs, others)) < 0.05, "those between stay where they are"


def test_the_double_pendulum_keeps_its_energy_and_follows_its_slider() -> None:
    pendulum = Script("double_pendulum")
    before, start = pendulum.system.energy.total, pendulum.weight.position
    pendulum.go_on(5)
    assert pendulum.system.energy.total == pytest.approx(before, rel=1e-6)
    assert abs(pendulum.weight.position - start) > 0.1
    pendulum.gravity.take(2.0, "", iota.Event(pendulum.system, "gravity"), pendulum.world._guard)
    assert pendulum.system.gravity == (0, -2, 0)


def test_the_catapult_waits_for_its_key_and_fells_the_tower() -> None:
    catapult = Script("catapult", 1)
    assert abs(catapult.ball.position - (1.35, 1.16, 0)) < 1e-3, "the latch holds"
    top = catapult.tower[-1].position
    assert top.y == pytest.approx(1.35, abs=1e-3), "the tower stands on the ground"
    catapult.fire()
    catapult.go_on(4)
    assert catapult.ball.position.x < -5, "it has flown"
    assert max(box.position.y for box in catapult.tower) < 1.3, "and felled the tower"


def test_the_ball_rolls_over_the_bridge_and_stays_on_the_other_side() -> None:
    bridge = Script("bridge")
    heights = []
    for _ in range(30):
        bridge.go_on(0.1)
        heights.append(bridge.ball.position.y)
    assert min(heights) > 0.9 and 1.6 < bridge.ball.position.x < 2.8
    assert abs(bridge.ball.angular_velocity.z) * 0.12 == pytest.approx(abs(bridge.ball.velocity), abs=0.02), "it rolls"


def test_the_robot_arm_goes_where_its_sliders_say() -> None:
    arm = Script("robot_arm", 2)
    angles = [arm.arm[name].angle for name in ("turn", "shoulder", "elbow")]
    assert [angle.value for angle in angles] == pytest.approx([0.5, 0.6, 0.8], abs=0.01)


def test_aspirin_hangs_from_its_atom_with_all_its_bonds() -> None:
    aspirin = Script("aspirin", 2)
    points = aspirin.aspirin.points
    assert points[0].is_nailed and min(point.position.y for point in points) < points[0].position.y - 0.3
    assert aspirin.system.worst_gap < 1e-8 and len([p for p in points if p.mass > 0]) >= 21


def test_the_planets_are_back_after_their_years() -> None:
    planets = Script("planets", 365.25)
    assert abs(planets.earth.position - (149.6, 0, 0)) < 3
    planets.go_on(687 - 365.25)
    assert abs(planets.mars.position - (227.9, 0, 0)) < 5


def test_the_gears_turn_with_their_ratio() -> None:
    gears = Script("gears", 1)
    small, large = (wheel.angle.value for wheel in gears.wheels)
    assert small == pytest.approx(3, rel=0.02) and large == pytest.approx(-small / 2, abs=1e-9)


def test_the_lorry_hangs_from_the_suspension_bridge() -> None:
    bridge = Script("suspension_bridge", 12)
    hung, ends = bridge.middle.position, [bridge.bridge.bodies[end].position.y for end in (0, -1)]
    assert hung.y - bridge.lorry.position.y - 1.5 == pytest.approx(bridge.rope.length, abs=0.1)
    assert 5 < bridge.lorry.position.y < hung.y < min(ends) and abs(bridge.lorry.velocity) < 1


def test_two_people_hold_one_chain(run_world: Any) -> None:
    chain = Script("two_people")
    with PageClient(run_world(chain.world), "Ada") as ada, PageClient(chain.world.pages.url, "Bob") as bob:
        for page, slot, x in ((ada, 5, -1.0), (bob, 15, 1.0)):
            page.send("grab_start", hold=1, body=page.body(slot), local_point=(0, 0, 0), target=(x, 1.5, 0.5))
        for page in (ada, bob):  # each is told in its own time
            page.wait_for(
                lambda page=page: {hold["client"] for hold in page.last["poses"]["holds"]} == {ada.id, bob.id}
            )
        ada.send("action", name="break", body=ada.body(10))
        bob.wait_for(lambda: bob.parts() == 2)


def test_the_quiz_answers_a_click_and_counts(run_world: Any) -> None:
    quiz = Script("quiz")
    with PageClient(run_world(quiz.world)) as page:
        for name, points, title in (("Mars", 0, "No"), ("Earth", 1, "Right!")):
            body = page.body(quiz.balls[name].slot)
            page.send(
                "pointer", kind=0, body=body, name="mouse", point=(0, 0, 0), origin=(0, 1, 3), direction=(0, 0, -1),
                rotation=(0, 0, 0, 1), buttons=(), axes=(), joints=(),
            )  # fmt: skip
            page.wait_for(lambda t=title: page.last.get("notice", {}).get("title") == t)
            assert quiz.score["points"] == points
        assert quiz.question.text == "Which one is red?"


def test_the_tower_of_ten_stands_until_the_ball_comes_and_falls_then() -> None:
    tower = Script("ball_and_tower", 0.2)
    assert tower.tower[-1].position.y == pytest.approx(1.9, abs=1e-3)
    tower.go_on(5)
    assert sum(box.position.y < 0.5 for box in tower.tower) >= 8
    assert max(abs(box.position - (0, box.position.y, 0)) for box in tower.tower) > 0.5
    assert abs(tower.ball.velocity) < 1.5


def test_a_box_that_is_pushed_by_hand_pushes_the_other_one(run_world: Any) -> None:
    push = Script("push", 0.3)
    left, right = push.boxes
    assert [box.position.y for box in push.boxes] == pytest.approx([0.9, 0.9], abs=1e-3), "they stand on the table"
    grip = push.system.grip(left, (0, 0, 0), left.position)
    for step in range(60):
        grip.move((-0.3 + 0.008 * step, 0.9, 0))
        push.go_on(1 / 30)
    assert right.position.x > 0.25 and right.position.x - left.position.x > 0.199, "none goes into the other"


def grab(world: iota.World, page: PageClient, body: iota.Body) -> None:
    slot, at = world.call(lambda: (body.slot, body.center_of_mass))
    page.send("grab_start", hold=1, body=page.body(slot), local_point=(0, 0, 0), target=tuple(at))


def test_the_door_opens_by_its_handle_only(run_world: Any) -> None:
    script = Script("door", 0.3)
    _, handle, _ = script.door.bodies
    assert script.sign.text == "shut" and script.door.is_latched
    at = handle.position
    with PageClient(run_world(script.world)) as page:
        grab(script.world, page, handle)
        page.wait_for(lambda: not script.world.call(lambda: script.door.is_latched))
        page.send("grab_move", hold=1, target=(at.x, at.y, at.z + 0.6))
        page.wait_for(lambda: script.world.call(lambda: script.door.angle) > 0.3)
        assert script.world.call(lambda: script.sign.text) == "open"


def test_the_button_switches_the_lamp_each_time_it_is_pressed(run_world: Any) -> None:
    script = Script("button", 0.3)
    dark = script.lamp.color
    with PageClient(run_world(script.world)) as page:
        for times in (1, 2):
            grab(script.world, page, script.button.bodies[0])
            page.wait_for(lambda n=times: script.world.call(lambda: script.presses.text) == f"{n} times")
            assert script.world.call(lambda: script.light.intensity) == times % 2
            assert (script.world.call(lambda: script.lamp.color) == dark) == (times == 2)
            page.send("grab_end", hold=1)
            page.wait_for(lambda: not script.world.call(lambda: script.button.pressed))


def test_the_plug_is_turned_and_drawn_into_its_socket(run_world: Any) -> None:
    script = Script("plug", 1.0)
    plug = script.lead.plug
    assert plug.position.y > 0.75 and abs(plug.velocity) < 0.05 and script.power.text == "off", "it lies on the table"
    with PageClient(run_world(script.world)) as page:
        grab(script.world, page, plug)
        page.send("grab_move", hold=1, target=(0.12, 1.0, -0.1))
        page.wait_for(lambda: script.world.call(lambda: script.lead.is_near or script.lead.is_plugged))
        page.send("grab_end", hold=1)
        page.wait_for(lambda: script.world.call(lambda: script.lead.is_plugged))
        page.wait_for(lambda: script.world.call(lambda: script.power.text) == "on")
        page.wait_for(lambda: script.world.call(lambda: script.lead.apart) < 1e-3)


@pytest.mark.parametrize("path", sorted(SCRIPTS.glob("*.py")), ids=lambda path: path.stem)
def test_a_script_of_the_first_hour_is_short_and_listed(path: Path) -> None:
    lines = [line for line in path.read_text().splitlines() if line.strip()]
    assert len(lines) <= 45 and f"({path.name})" in (SCRIPTS / "README.md").read_text()
