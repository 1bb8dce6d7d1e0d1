# SPDX-License-Identifier: Apache-2.0
"""What a page sends arrives as records, each at the function for its type."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from typing import Any, get_args

import pytest
from page_client import NOTHING, PageClient

import iota
from iota import _protocol as protocol
from iota.world.inputs import HANDLERS, SHARES, Inputs

Runner = Callable[[iota.World], str]

POINTER = {"name": "left", "point": (1, 2, 3), "origin": (4, 5, 6), "direction": (0, 0, -1), "rotation": (0, 0, 0, 1)}
SENT: list[tuple[str, dict[str, Any]]] = [
    ("select", {"body": (0, 1)}),
    ("grab_start", {"hold": 3, "body": (0, 1), "local_point": (0.5, 0, 0), "target": (1, 2, 3), "pointer": "left"}),
    ("grab_move", {"hold": 3, "target": (2, 2, 3)}),
    ("grab_end", {"hold": 3}),
    ("action", {"name": "break", "body": (0, 1), "others": ((1, 1), (2, 5))}),
    ("control", {"command": protocol.ControlCommand.SPEED, "value": 0.5}),
    ("change", {"widget": (7, 2), "value": 0.125, "text": "é"}),
    ("pointer", {"kind": 3, "body": NOTHING, "buttons": (0.5, 1), "axes": (-1,), "joints": (1, 2, 3), **POINTER}),
    ("key", {"key": "k", "down": True}),
    ("profile", {"on": True}),
]


def test_every_input_has_one_function() -> None:
    assert set(get_args(protocol.Input)) == HANDLERS.keys() == SHARES.keys()


def test_a_message_arrives_as_the_record_of_its_fields(run_world: Runner, monkeypatch: pytest.MonkeyPatch) -> None:
    seen: list[Any] = []

    def keep(inputs: Inputs, client: Any, message: Any) -> None:
        seen.append((client.id, message))

    for kind in HANDLERS:
        monkeypatch.setitem(HANDLERS, kind, keep)
    with PageClient(run_world(iota.World(iota.System())), name="Ada") as page:
        for name, values in SENT:
            page.send(name, **values)
        page.wait_for(lambda: len(seen) > len(SENT))
        assert seen[0] == (page.id, protocol.Join("Ada", protocol.Role.HOST))
        for (client, record), (name, values) in zip(seen[1:], SENT, strict=True):
            assert client == page.id
            assert type(record).__name__.lower() == name.replace("_", "")
            assert {field.name: getattr(record, field.name) for field in dataclasses.fields(record)} == values
    page.wait_for(lambda: seen[-1] == (page.id, protocol.Leave()))
    pointer, action = (next(r for _, r in seen if isinstance(r, kind)) for kind in (protocol.Pointer, protocol.Action))
    assert isinstance(pointer.point, iota.Vec3) and pointer.kind is protocol.PointerKind.MOVE
    assert not pointer.body and action.body and isinstance(action.others[1], protocol.Id)
    with pytest.raises(dataclasses.FrozenInstanceError):
        pointer.name = "right"


def cards(world: iota.World) -> list[tuple[int, str, str]]:
    """Client, title and text of cards, from now on."""
    shown: list[tuple[int, str, str]] = []
    world._state.notices.show = lambda client, level, title, text, *more, **rest: shown.append((client, title, text))
    return shown


def test_an_error_of_our_own_is_one_card_for_the_sender(monkeypatch: pytest.MonkeyPatch) -> None:
    world = iota.World(iota.System())
    inputs, shown = world._inputs, cards(world)

    def fail(*_: Any) -> None:
        raise OverflowError("too large")

    monkeypatch.setitem(HANDLERS, protocol.Key, fail)
    inputs.take(
        [(5, protocol.Join("", protocol.Role.ACTOR)), (6, protocol.Join("", protocol.Role.ACTOR))], lambda ids: []
    )
    inputs.take([(5, protocol.Key("k", True)), (6, protocol.Profile(True))], lambda ids: [])
    ((client, title, text),) = shown
    assert (client, title) == (5, "That failed") and text.startswith("OverflowError: too large")
    assert world._state.clients.is_profiled, "what came after it is handled"


def test_a_number_that_no_step_divides_goes_to_the_end_of_the_slider() -> None:
    world = iota.World(iota.System())
    for least, most, step in ((0.0, 10.0, 0.5), (-1e308, 1e308, 0.1), (0.0, 1.0, 5e-324)):
        slider = world.controls.slider("size", least, most, value=least, step=step)
        for value, end in ((1e308, most), (-1e308, least)):
            slider.take(value, "", iota.Event(world.system, "size"), world._guard)
            assert slider.value == end


def test_an_action_on_the_world_is_called_once_however_many_bodies_are_selected() -> None:
    world = iota.World(iota.System())
    world.offer("undo")
    bodies = [world.system.body() for _ in range(2)]
    with world.system.edit():
        for body in bodies:
            body.particle((0, 0, 0), mass=1)
    shown = cards(world)
    world._inputs.act(world._state.actions["undo"], 5, bodies)
    assert shown == [] and not bodies[0].particles


def test_an_action_on_several_bodies_is_undone_at_once() -> None:
    world = iota.World(iota.System())
    bodies = [world.system.body() for _ in range(3)]

    @world.controls.action("fill")
    def fill(event: iota.Event) -> None:
        event.target.particle((0, 0, 0), mass=1)

    world._inputs.act(world._state.actions["fill"], 5, bodies)
    assert [len(body.particles) for body in bodies] == [1, 1, 1]
    assert world.undo()
    assert [len(body.particles) for body in bodies] == [0, 0, 0]


@pytest.mark.parametrize(("asked", "given"), [(1e30, 10.0), (-1.0, 0.0), (0.25, 0.25)])
def test_a_page_sets_a_speed_within_limits_whatever_it_asks_for(asked: float, given: float) -> None:
    world = iota.World(iota.System())
    shown = cards(world)
    control = protocol.Control(protocol.ControlCommand.SPEED, asked)
    world._inputs.take([(5, protocol.Join("", protocol.Role.HOST)), (5, control)], lambda ids: [])
    assert (world._state.clock.speed, shown) == (given, [])


def test_an_error_of_our_own_that_is_for_all_pages_is_told_once_and_one_for_a_page_each_time(
    capsys: pytest.CaptureFixture[str],
) -> None:
    world = iota.World(iota.System())
    shown = cards(world)
    own: list[str] = []

    def fail() -> None:
        raise OverflowError("too large")

    for _ in range(3):
        assert not world._guard.outlive("A frame", fail)
    assert [title for _, title, _ in shown] == ["A frame failed"]
    for _ in range(3):
        world._guard.outlive("That", fail, lambda title, text, hint: own.append(title))
    assert own == ["That failed"] * 3 and len(shown) == 1
    assert capsys.readouterr().err.count("OverflowError: too large") == 1, "printed once"


def test_a_page_that_has_left_leaves_nothing_of_its_pace() -> None:
    world = iota.World(iota.System())
    for number in range(1, 50):
        inputs = [protocol.Join("", protocol.Role.ACTOR), protocol.Key("k", True), protocol.Leave()]
        world._inputs.take([(number, message) for message in inputs], lambda ids: [])
    assert not world._inputs._pace._of


def test_a_step_that_raises_pauses_the_world_and_pages_stay(run_world: Runner) -> None:
    world = iota.World(iota.System())
    is_broken = [False]

    def step() -> None:
        if is_broken[0]:
            raise ZeroDivisionError("a step")

    world._stepper.step = step  # type: ignore[method-assign,assignment]
    with PageClient(run_world(world)) as page:
        is_broken[0] = True
        page.wait_for(lambda: page.last["world_state"]["paused"])
        assert [card["title"] for card in page.notices] == ["The step failed"]
        is_broken[0] = False
        page.send("control", command=1, value=0.0)
        page.wait_for(lambda: not page.last["world_state"]["paused"])


def test_the_input_of_a_client_that_is_gone_is_left_out() -> None:
    world = iota.World(iota.System())
    inputs = world._inputs
    inputs.take([(5, protocol.Select(protocol.Id(0, 1)))], lambda ids: [])
    assert not world.users.clients
    inputs.take([(5, protocol.Join("", protocol.Role.ACTOR)), (5, protocol.Leave())], lambda ids: [])
    assert not world.users.clients


def test_keys_have_their_usual_names_and_those_of_browsers() -> None:
    world = iota.World(iota.System())
    for number, (given, name) in enumerate(
        (("space", " "), (" ", " "), ("up", "ArrowUp"), ("enter", "Enter"), ("k", "k"))
    ):
        if given != " ":
            world.action(f"action {number}", key=given)(lambda: None)
            assert world.controls.actions[-1].key == name
        world.on_key(given)(lambda: None)
    assert {" ", "ArrowUp", "Enter", "k"} == set(world._state.listeners.keys)
