# SPDX-License-Identifier: Apache-2.0
"""Ready parts of rigs: what hands, fingertips and thrown things do to them, judged from places and values."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial
from itertools import count
from pathlib import Path
from typing import Any

import pytest

import iota
from iota import _protocol as protocol
from iota.fixtures import Fixture
from iota.world import fingers
from iota.world.pace import Pace

MAKERS: dict[str, Callable[..., Any]] = {
    "push_button": lambda world, at, **more: world.push_button(at, **more),
    "switch": lambda world, at, **more: world.switch(at, **more),
    "lever": lambda world, at, **more: world.lever(at, **more),
    "notched lever": lambda world, at, **more: world.lever(at, notches=3, **more),
    "knob": lambda world, at, **more: world.knob(at, **more),
    "dial": lambda world, at, **more: world.dial(at, ["off", "low", "high"], **more),
    "door": lambda world, at, **more: world.door(at, **more),
    "drawer": lambda world, at, **more: world.drawer(at, **more),
    "plug_and_socket": lambda world, at, **more: world.plug_and_socket(at, iota.Vec3(*at) + (0.3, -0.3, 0.4), **more),
}


class Rig:
    """A world and one user of it, without a page."""

    def __init__(self, ground: float | None = 0.0, dt: float = 1 / 120) -> None:
        self.system = iota.System()
        self.world = iota.World(self.system, ground=ground, dt=dt)
        # A test sends messages as fast as it can, and a busy machine takes longer for each: by its clock they were too many.
        self.world._inputs._pace = Pace(partial(next, count(0.0, 1.0)))
        self.told: list[iota.Event] = []

    def hear(self, event: iota.Event) -> None:
        self.told.append(event)

    def run(self, seconds: float) -> None:
        for _ in range(round(seconds / self.world.dt)):
            self.world.step()

    def send(self, *messages: Any, body: iota.Body | None = None, client: int = 5) -> None:
        if client not in self.world._state.clients.by_id:
            messages = (protocol.Join("Ada", protocol.Role.HOST), *messages)
        inputs = [(client, message) for message in messages]
        self.world._inputs.take(inputs, lambda ids: [] if body is None else [body])

    def grab(self, body: iota.Body, point: Any = None) -> iota.Vec3:
        """A hand takes a body at a place of the world, by default its center."""
        at = body.center_of_mass if point is None else iota.Vec3(*point)
        turn = body.orientation
        x, y, z, w = turn
        axis, arm = iota.Vec3(-x, -y, -z), at - body.center_of_mass
        twice = axis.cross(arm) * 2.0
        local = arm + twice * w + axis.cross(twice)
        self.send(protocol.GrabStart(1, protocol.Id(1, 1), local, at, "mouse"), body=body)
        return at

    def move(self, to: Any) -> None:
        self.send(protocol.GrabMove(1, iota.Vec3(*to)))

    def let_go(self) -> None:
        self.send(protocol.GrabEnd(1))

    def point(
        self, name: str, at: Any, origin: Any = (0, 0, 0), direction: Any = (0, 0, -1), button: float = 0.0,
        joints: tuple[float, ...] = (),
    ) -> None:  # fmt: skip
        way = iota.Vec3(*direction).unit()
        self.send(
            protocol.Pointer(
                protocol.PointerKind.MOVE, protocol.Id(0, 0), name, iota.Vec3(*at), iota.Vec3(*origin), way,
                (0.0, 0.0, 0.0, 1.0), (button,), (), joints,
            )
        )  # fmt: skip


@pytest.fixture
def rig() -> Rig:
    return Rig()


def test_a_ball_that_is_thrown_at_a_button_presses_it_once_and_the_spring_pushes_it_back(rig: Rig) -> None:
    button = rig.world.push_button((0, 1, 0), rig.hear)
    ball = rig.system.body(shape=iota.Sphere(0.03), mass=0.3, position=(0, 1.02, 0.6), velocity=(0, 0.5, 4))
    ball.velocity = (0, 0.5, -4)
    rig.run(1.5)
    assert [event.client for event in rig.told] == [0]
    assert rig.told[0].target == button.bodies[0]
    assert not button.pressed and abs(button.depth) < 1e-6


def test_a_ball_that_is_too_light_and_slow_does_not_press_a_button(rig: Rig) -> None:
    rig.world.push_button((0, 1, 0), rig.hear)
    rig.system.body(shape=iota.Sphere(0.02), mass=0.002, position=(0, 1.0, 0.2), velocity=(0, 0.2, -1))
    rig.run(0.5)
    assert rig.told == []


def test_a_hand_that_holds_a_button_presses_it_as_long_as_it_holds(rig: Rig) -> None:
    button = rig.world.push_button((0, 1, 0), rig.hear)
    rig.run(0.1)
    rig.grab(button.bodies[0])
    rig.run(0.3)
    assert button.pressed and button.depth == pytest.approx(button.travel, abs=1e-4)
    rig.run(0.5)
    rig.let_go()
    rig.run(0.3)
    assert not button.pressed
    assert [event.client for event in rig.told] == [5]


def test_a_button_is_no_longer_pressed_after_a_reset_or_an_undo_in_a_hand(rig: Rig) -> None:
    button = rig.world.push_button((0, 1, 0))
    rig.run(0.1)
    rig.grab(button.bodies[0])
    rig.run(0.3)
    with rig.system.edit():
        rig.system.body().particle((3, 1, 0))
    assert button.pressed
    rig.run(0.2)
    rig.world.undo()
    rig.run(0.3)
    assert not button.pressed
    rig.grab(button.bodies[0])
    rig.run(0.3)
    assert button.pressed
    rig.world.reset()
    rig.run(0.3)
    assert not button.pressed


def test_an_open_hand_presses_what_its_fingertip_touches_and_a_closed_one_does_not(rig: Rig) -> None:
    button = rig.world.push_button((0, 1, 0), rig.hear)
    pulses: list[tuple[str, float, float]] = []
    rig.world._state.clients.send_pulse = lambda client, *pulse: pulses.append(pulse)
    for closed, presses in ((0.0, 1), (1.0, 1)):
        for step in range(90):
            depth = 0.12 - 0.002 * min(step, 60)  # ends within the cap
            rig.point("right", (0, 1, depth), button=closed)
            rig.world.step()
        assert len(rig.told) == presses
        assert rig.told[0].client == 5 and pulses == [("right", 0.5, 0.03)]
        for step in range(60):
            rig.point("right", (0, 1, 0.01 * step), button=closed)
            rig.world.step()
        assert not button.pressed
    rig.send(protocol.Leave())
    assert all(body.name != "fingertip" for body in rig.system.bodies)


def test_a_bare_hand_presses_with_the_tip_of_its_index_finger(rig: Rig) -> None:
    button = rig.world.push_button((0, 1, 0), rig.hear)
    for step in range(90):
        tip = (0.0, 1.0, 0.12 - 0.002 * min(step, 60))
        joints = [(9.0, 9.0, 9.0)] * 9 + [tip] + [(9.0, 9.0, 9.0)] * 15
        rig.point("right hand", (0, 1.05, tip[2] + 0.03), joints=tuple(number for joint in joints for number in joint))
        rig.world.step()
    assert button.pressed and len(rig.told) == 1


def test_a_paddle_at_the_mouse_pushes_what_it_touches_and_nothing_while_the_mouse_holds(rig: Rig) -> None:
    rig.world.tools.push(radius=0.05)
    ball = rig.system.body(shape=iota.Sphere(0.1), mass=1, position=(0.4, 0.1, 0))
    eye = (0.0, 0.1, 3.0)

    def sweep(button: float) -> float:
        """The mouse goes by from left to right, at the depth of the ball. Returns how far the ball went, m."""
        before = ball.position.x
        for step in range(-60, 120):  # it comes to the left of the ball as one that passes through things
            x = before - 0.6 + 0.006 * max(step, 0)
            rig.point("mouse", (x, 0.1, 0.05), eye, (x, 0.0, -2.95), button if step >= 0 else 1.0)
            rig.world.step()
        return float(ball.position.x - before)

    assert sweep(0.0) == pytest.approx(0, abs=1e-9), "nobody has taken it"
    rig.send(protocol.Action("paddle", protocol.Id(0, 0), ()))
    assert sweep(1.0) == pytest.approx(0, abs=1e-6), "the button is down"
    assert sweep(0.0) > 0.08
    (paddle,) = [body for body in rig.system.bodies if body.name == "paddle"]
    assert abs(paddle.position.z) < 0.06, "at the depth at which it began"
    rig.send(protocol.Action("paddle", protocol.Id(0, 0), ()))
    assert [body.name for body in rig.system.bodies if body.name == "paddle"] == []
    assert len(rig.system.bodies) == 1 and rig.system.validate() == []


def test_a_paddle_stays_while_the_mouse_rests_and_goes_with_its_user(rig: Rig, monkeypatch: pytest.MonkeyPatch) -> None:
    rig.world.tools.push(key="k")
    rig.point("mouse", (0, 1, 0), (0, 1, 3))
    rig.send(protocol.Action("paddle", protocol.Id(0, 0), ()))
    rig.point("mouse", (0.1, 1, 0), (0, 1, 3), (0.1, 0, -3))
    later = fingers.time.monotonic() + 60
    monkeypatch.setattr(fingers.time, "monotonic", lambda: later)
    rig.run(0.1)
    rig.world._inputs.frame()
    assert [body.name for body in rig.system.bodies] == ["paddle"]
    rig.send(protocol.Leave())
    assert rig.system.bodies == []
    with pytest.raises(ValueError, match="radius must be a finite number above 0 m, not -1"):
        rig.world.tools.push(radius=-1)


def test_fingertips_are_neither_drawn_nor_left_over_by_an_undo(rig: Rig) -> None:
    rig.world.push_button((0, 1, 0))
    before = len(rig.system.bodies)
    rig.point("left", (1, 1, 1))
    rig.world.step()
    (tip,) = [body for body in rig.system.bodies if body.name == "fingertip"]
    assert rig.world.scene.look_of(tip) == {"*": []}
    with rig.system.edit():
        rig.system.body().particle((3, 1, 0))
    rig.send(protocol.Leave())
    assert len(rig.system.bodies) == before + 1
    rig.world.undo()
    rig.world._inputs.frame()
    assert len(rig.system.bodies) == before


def test_a_switch_snaps_back_if_it_is_pushed_less_than_half_way_and_over_beyond_it(rig: Rig) -> None:
    switch = rig.world.switch((0, 1, 0), rig.hear)
    low = switch.joint.angle.value
    for value, is_on in ((low + 0.3, False), (0.05, True), (-0.05, False)):
        switch.joint.angle.value = value
        rig.run(1.0)
        assert switch.is_on == is_on
        assert abs(switch.joint.angle.value - (-low if is_on else low)) < 1e-3
    assert len(rig.told) == 2


def test_a_lever_stays_where_a_hand_leaves_it(rig: Rig) -> None:
    lever = rig.world.lever((0, 1, 0), rig.hear)
    ball = iota.Vec3(0, 1 - 0.22 * math.sin(0.75), 0.014 + 0.22 * math.cos(0.75))
    rig.run(1.0)
    assert lever.value == pytest.approx(0, abs=1e-3)  # its weight does not move it
    rig.grab(lever.bodies[0], ball)
    rig.move((0, 1, 0.24))
    rig.run(1.5)
    rig.let_go()
    rig.run(0.3)
    there = lever.value
    assert 0.2 < there < 0.7
    rig.run(2.0)
    assert lever.value == pytest.approx(there, abs=1e-3)
    assert rig.told and rig.told[-1].client == 5


def test_a_dial_comes_to_rest_in_its_notches_only_and_the_notches_make_no_energy(rig: Rig) -> None:
    dial = rig.world.dial((0, 1, 0), ["a", "b", "c", "d", "e"])
    places = dial.notches.places
    for value in (-1.1, -0.3, 0.2, 0.7, 1.3):
        dial.joint.angle.value = value
        dial.bodies[0].angular_velocity = (0, 0, -3)
        rig.run(1.0)
        assert min(abs(dial.angle - place) for place in places) < 1e-3
        assert dial.value == dial.options[dial.notches.index]
    energy = rig.system.energy
    balance = energy.kinetic + energy.potential + energy.dissipated + energy.lost - energy.made
    assert balance - energy.external_work - energy.edits == pytest.approx(0, abs=1e-6)
    assert abs(energy.made) < 1e-9


def test_a_knob_reads_its_value_in_its_own_range(rig: Rig) -> None:
    knob = rig.world.knob((0, 1, 0), minimum=10, maximum=30, value=15)
    assert knob.value == pytest.approx(15)
    knob.joint.angle.value = 0
    assert knob.value == pytest.approx(20)


def test_a_door_is_held_by_its_latch_until_a_hand_takes_the_handle(rig: Rig) -> None:
    door = rig.world.door((0, 0, 0), rig.hear)
    leaf, handle, _ = door.bodies
    for _ in range(120):
        leaf.apply_force((0, 0, 300), leaf.center_of_mass)
        rig.world.step()
    assert door.is_latched and abs(door.angle) < 0.005 and not door.is_open
    at = rig.grab(handle)
    rig.run(0.5)
    assert door.handle > 0.6 and not door.is_latched
    rig.move(at + (0, 0, 0.5))
    rig.run(2.0)
    assert door.is_open and door.angle > 0.3
    rig.let_go()
    for _ in range(120):
        leaf.apply_force((0, 0, -40), leaf.center_of_mass)  # it slams
        rig.world.step()
    assert door.is_latched and not door.is_open
    assert len(rig.told) == 2


def test_the_bolt_of_a_door_follows_its_handle(rig: Rig) -> None:
    door = rig.world.door((0, 0, 0))
    out = door.bodies[2].position.x
    rig.grab(door.bodies[1])
    rig.run(0.5)
    assert out - door.bodies[2].position.x == pytest.approx(0.018, abs=1e-3)


def test_a_mouse_pulls_a_drawer_towards_the_viewer_by_its_ray(rig: Rig) -> None:
    drawer = rig.world.drawer((0, 1, 0), rig.hear)
    eye = iota.Vec3(0.1, 1.5, 2.0)
    front = rig.grab(drawer.bodies[0], (0, 1, 0.03))
    wanted = front + (0, 0, 0.2)
    for _ in range(240):
        ray = (wanted - eye).unit()
        # A page moves the hand in the plane that faces the viewer.
        facing = (front - eye).unit()
        hand = eye + ray * ((front - eye).dot(facing) / ray.dot(facing))
        rig.point("mouse", hand, eye, ray, button=1.0)
        rig.move(hand)
        rig.world.step()
    assert drawer.slide == pytest.approx(0.2, abs=0.02)
    assert drawer.is_open and len(rig.told) == 1


def test_a_drawer_goes_to_the_last_ray_of_a_mouse_also_if_that_arrives_after_the_hand_has_moved(rig: Rig) -> None:
    drawer = rig.world.drawer((0, 1, 0))
    eye = iota.Vec3(0.1, 1.5, 2.0)
    front = rig.grab(drawer.bodies[0], (0, 1, 0.03))
    facing = (front - eye).unit()
    for out in (0.0, 0.1, 0.2):
        ray = (front + (0, 0, out) - eye).unit()
        hand = eye + ray * ((front - eye).dot(facing) / ray.dot(facing))
        rig.move(hand)
        rig.world.step()
        rig.point("mouse", hand, eye, ray, button=1.0)
        rig.world.step()
    rig.run(2.0)
    assert drawer.slide == pytest.approx(0.2, abs=0.02)


def test_a_hand_in_space_pulls_a_drawer_by_its_own_place(rig: Rig) -> None:
    drawer = rig.world.drawer((0, 1, 0))
    front = rig.grab(drawer.bodies[0], (0, 1, 0.03))
    rig.move(front + (0.1, 0.1, 0.15))
    rig.run(2.0)
    assert drawer.slide == pytest.approx(0.15, abs=0.02)


def test_what_lies_in_a_drawer_comes_out_with_it(rig: Rig) -> None:
    drawer = rig.world.drawer((0, 1, 0))
    box = rig.system.body(shape=iota.Box((0.06, 0.04, 0.06)), mass=0.1, position=(0.05, 0.96, -0.2))
    rig.run(0.5)
    before = box.position
    drawer.use()
    rig.run(2.0)
    assert drawer.slide > 0.25
    assert box.position.z - before.z == pytest.approx(drawer.slide, abs=0.03)
    assert box.position.y == pytest.approx(before.y, abs=2e-3)


def test_a_plug_is_turned_drawn_in_and_held_until_it_is_pulled_hard(rig: Rig) -> None:
    made = rig.world.plug_and_socket((0, 1, 0), (0.04, 0.95, 0.2), rig.hear, plug_facing=(0.5, 0.3, 1))
    rig.system.gravity = (0, 0, 0)
    start = made.plug.orientation
    texts = list(rig.world.drawings.things)
    rig.grab(made.plug)
    rig.run(0.05)
    assert len(rig.world.drawings.things) == len(texts) + 4  # its three shapes at its place, on a frame
    rig.move((0, 1, 0.1))
    rig.run(2.0)
    rig.let_go()
    assert made.is_plugged and list(rig.world.drawings.things) == texts
    rig.run(2.0)
    assert made.is_plugged and made.apart < 1e-6
    assert abs(sum(a * b for a, b in zip(start, made.plug.orientation, strict=True))) < 0.99
    # Its own frame is that of the socket again: the key is above.
    key = made.plug.solids[2].position
    assert key.y > 1.02 and abs(key.x) < 1e-6
    for force, stays in ((50, True), (80, False)):
        for _ in range(12):
            made.plug.apply_force((0, 0, force), made.plug.center_of_mass)
            rig.world.step()
        assert made.is_plugged == stays
    assert len(rig.told) == 2


def test_a_cable_lies_on_the_table_where_it_begins(rig: Rig) -> None:
    rig.world.table((0, 0, 0.4))
    made = rig.world.plug_and_socket(
        (0, 1.05, 0), (-0.2, 0.8, 0.4), plug_facing=(-1, 0.3, 0.2), cable_from=(-0.5, 0.77, 0.2)
    )
    rig.run(2.0)
    lowest = min(particle.position.y for link in made.cable for particle in link.particles)
    assert lowest > 0.75 and made.plug.center_of_mass.y > 0.75
    assert 0.9 < sum(abs(link.particles[1].position - link.particles[0].position) for link in made.cable) / 0.72 < 1.4


def test_a_plug_that_was_pulled_out_may_hang_near_its_socket(rig: Rig) -> None:
    made = rig.world.plug_and_socket((0, 1, 0), (0, 1, 0.1), rig.hear)
    rig.system.gravity = (0, 0, 0)
    rig.run(2.0)
    assert made.is_plugged
    made.use()
    rig.run(0.05)
    made.plug.velocity = (0, 0, 0)
    rig.run(1.0)
    assert not made.is_plugged and made.apart < 0.1


@pytest.mark.parametrize("facing", [(0, 0, 1), (1, 0, 0), (0, 1, 0), (-0.5, 0.4, -0.7)])
@pytest.mark.parametrize("name", MAKERS)
def test_each_part_works_in_any_direction_by_the_key_or_a_click(name: str, facing: tuple[float, float, float]) -> None:
    rig = Rig(ground=None)
    if name == "door":
        facing = (facing[0] or 1.0, 0, facing[2])  # nobody lifts one by its handle
    fixture: Fixture = MAKERS[name](rig.world, (0.3, 1, -0.2), facing=facing)
    before = fixture.state
    rig.run(0.25)
    assert fixture.state == before
    changed = False
    rig.world.controls.act("use", fixture.bodies[0])
    for _ in range(500):
        rig.world.step()
        changed = changed or fixture.state != before
    assert changed
    assert all(body.center_of_mass - (0.3, 1, -0.2) for body in fixture.bodies)


@pytest.mark.parametrize("mode", ["robust", "plausible"])
@pytest.mark.parametrize("name", ["plug_and_socket", "door", "dial", "push_button"])
def test_parts_work_in_other_modes_with_long_steps_and_asleep(name: str, mode: Any) -> None:
    rig = Rig(dt=1 / 60)
    rig.system.mode, rig.system.rest_after = mode, 0.3
    fixture: Fixture = MAKERS[name](rig.world, (0.3, 1, -0.2))
    rig.run(1.5)
    before, changed = fixture.state, False
    fixture.use()
    for _ in range(192):
        report = rig.world.step()
        changed = changed or fixture.state != before
        assert report is not None and not report.warnings
    assert changed


def test_a_journal_brings_back_what_was_switched_and_plugged(tmp_path: Path) -> None:
    for run in range(2):
        system = iota.System()
        world = iota.World(system, ground=0)
        switch, dial = world.switch((0, 1, 0)), world.dial((0.3, 1, 0), ["a", "b"])
        plug = world.plug_and_socket((0.6, 1, 0), (0.6, 1, 0.05))
        world.keep(tmp_path / "kept")
        world.step()
        if run == 0:
            assert (switch.is_on, dial.value) == (False, "a")
            switch.use()
            dial.use()
            for _ in range(240):
                world.step()
        assert (switch.is_on, dial.value, plug.is_plugged) == (True, "b", True)
        world.close()


@pytest.mark.parametrize("name", ["switch", "lever", "knob", "dial", "door", "drawer"])
def test_a_reset_and_a_rewind_bring_values_back_and_tell_of_the_change(rig: Rig, name: str) -> None:
    fixture: Fixture = MAKERS[name](rig.world, (0, 1, 0), on_change=rig.hear)
    before = fixture.state
    rig.run(0.1)
    fixture.use()
    rig.run(3.2)
    assert fixture.state != before
    rig.told.clear()
    rig.world.reset()
    rig.run(0.1)
    assert fixture.state == before and rig.told
    rig.run(3.0)
    assert fixture.state == before  # the use has ended with the reset


def test_the_key_uses_the_held_or_selected_part_and_says_so_if_there_is_none(rig: Rig) -> None:
    rig.world.push_button((0, 1, 0), rig.hear)
    (use,) = [action for action in rig.world.controls.actions if action.name == "use"]
    assert use.key == "Enter"
    ball = rig.system.body(shape=iota.Sphere(0.1), position=(2, 1, 0))
    rig.world.controls.act("use", ball)
    rig.run(0.5)
    assert rig.told == []


def test_a_function_that_raises_is_reported_and_called_again(rig: Rig, capsys: pytest.CaptureFixture[str]) -> None:
    calls: list[int] = []

    def broken() -> None:
        calls.append(1)
        raise KeyError("lamp")

    switch = rig.world.switch((0, 1, 0), broken, label="power")
    for _ in range(2):
        switch.use()
        rig.run(1.0)
    assert len(calls) == 2
    assert "KeyError" in capsys.readouterr().err


def test_a_part_that_is_destroyed_leaves_nothing_behind(rig: Rig) -> None:
    rig.world.drawings.label("mine")
    made = [make(rig.world, (0, 1, 0), label="x") for make in MAKERS.values()]
    assert len(list(rig.world.fixtures)) == len(MAKERS)
    for fixture in made:
        fixture.destroy()
    rig.run(0.1)
    assert len(rig.system.bodies) == 0 and len(rig.system.obstacles) == 1  # the ground
    assert len(rig.world.drawings.things) == 1 and not list(rig.world.fixtures)


def test_a_part_whose_body_the_script_destroys_stops_acting(rig: Rig) -> None:
    button = rig.world.push_button((0, 1, 0), rig.hear)
    button.bodies[0].destroy()
    rig.run(0.1)
    assert not button.is_alive and rig.told == []


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda world: world.push_button((0, 1)[:1]), "at must be 2 or 3 finite numbers"),
        (lambda world: world.push_button((0, 1, 0), facing=(0, 0, 0)), "faces a direction"),
        (lambda world: world.push_button((0, 1, 0), radius=0), "radius must be a finite number above 0 m"),
        (lambda world: world.push_button((0, 1, 0), force=math.nan), "force must be a finite number above 0 N"),
        (lambda world: world.lever((0, 1, 0), notches=1), "notches must be 0 or from 2 to 20"),
        (lambda world: world.lever((0, 1, 0), value=2), "value must be from 0 to 1"),
        (lambda world: world.dial((0, 1, 0), ["a"]), "2 to 12 different positions"),
        (lambda world: world.dial((0, 1, 0), ["a", "b"], value="c"), "value must be one of a, b"),
        (lambda world: world.knob((0, 1, 0), minimum=1, maximum=1), "minimum below its maximum"),
        (lambda world: world.door((0, 0, 0), hinge="top"), 'hinge must be "left" or "right"'),
        (lambda world: world.drawer((0, 1, 0), width=0.01), "at least 0.08 m"),
        (lambda world: world.table(size=(1, 1, 1)), "size must be 2 finite numbers"),
        (lambda world: world.stairs((0, 0, 0), steps=0), "steps must be a whole number"),
        (lambda world: world.shelf((0, 0, 0), boards=1), "boards must be a whole number"),
    ],
)
def test_bad_arguments_are_refused_in_words_and_nothing_is_made(
    rig: Rig, make: Callable[[iota.World], object], words: str
) -> None:
    with pytest.raises(ValueError, match=words):
        make(rig.world)
    assert len(rig.system.bodies) == 0 and len(rig.system.obstacles) == 0


def test_a_function_that_takes_two_arguments_is_refused_before_anything_is_made(rig: Rig) -> None:
    with pytest.raises(TypeError, match="a callback gets one event"):
        rig.world.push_button((0, 1, 0), lambda a, b: None)
    assert len(rig.system.bodies) == 0


def test_furniture_holds_what_lies_on_it(rig: Rig) -> None:
    world, system = rig.world, rig.system
    tops = [
        world.table((-3, 0, 0)).top,
        *world.shelf((0, 0, -2)).tops[:-1],
        *world.stairs((3, 0, 0), steps=3).tops,
        world.wall((6, 0, 0), size=(1, 1)).top,
    ]
    boxes = [system.body(shape=iota.Box((0.08, 0.08, 0.08)), mass=0.2, position=top + (0, 0.05, 0)) for top in tops]
    rig.run(1.5)
    for box, top in zip(boxes, tops, strict=True):
        assert abs(box.center_of_mass - (top + (0, 0.04, 0))) < 2e-3


def test_a_ball_rolls_down_a_ramp_between_its_rails(rig: Rig) -> None:
    top = rig.world.ramp((0, 0, 0), facing=(0, 0, 1)).top
    ball = rig.system.body(shape=iota.Sphere(0.06), mass=0.5, position=top + (0.2, 0.08, 0.15), velocity=(0.3, 0, 0))
    rig.run(2.5)
    assert ball.position.z > 0.3 and abs(ball.position.x) < 0.6


def test_another_simulator_has_no_fixtures() -> None:
    from test_simulator import Minimal

    world = iota.World(Minimal(), ground=None)  # type: ignore[arg-type]
    with pytest.raises(TypeError, match="fixtures need a System"):
        world.table()
