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
    ("grab_start", {"hold": 3, "body": (0, 1), "local_point": (0.5, 0, 0), "target": (1, 2, 3)}),
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
        assert seen[0] == (page.id, protocol.Join("Ada", protocol.Role.ACTOR))
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


def test_the_input_of_a_client_that_is_gone_is_left_out() -> None:
    world = iota.World(iota.System())
    inputs = world._inputs
    inputs.take([(5, protocol.Select(protocol.Id(0, 1)))], lambda ids: [])
    assert not world.users.clients
    inputs.take([(5, protocol.Join("", protocol.Role.ACTOR)), (5, protocol.Leave())], lambda ids: [])
    assert not world.users.clients
