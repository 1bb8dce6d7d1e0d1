# SPDX-License-Identifier: Apache-2.0
"""What users do: events of the server, in the order in which they came, and calls from other threads."""

from __future__ import annotations

import queue
from collections.abc import Callable, Iterable
from typing import Any

from iota._core import InputEvent
from iota._protocol import ControlCommand
from iota.world.callbacks import Guard, one_line
from iota.world.clock import MAX_SPEED
from iota.world.event import Event
from iota.world.state import State


class Inputs:
    """Brings them to the world, between steps. step, reset: what users may ask the world for."""

    def __init__(self, state: State, guard: Guard, step: Callable[[], object], reset: Callable[[], None]) -> None:
        self._state, self._guard, self._step, self._reset = state, guard, step, reset
        self._calls: queue.SimpleQueue[Callable[[], None]] = queue.SimpleQueue()

    def call(self, function: Callable[[], None]) -> None:
        """Has it called with the next inputs. From any thread."""
        self._calls.put(function)

    def take_calls(self) -> None:
        while not self._calls.empty():
            self._calls.get()()

    def take(self, events: Iterable[tuple[InputEvent, Any]]) -> None:
        """Everything that users did, each with the body that it is on, if that is there."""
        for event, body in events:
            if event.names_body and body is None:
                text = "It was destroyed, or made one with another body."
                self._state.notices.send("That is gone", text, client=event.client)
                if event.kind != "select":
                    continue
            if event.kind == "action":
                self._act(event, body)
            elif event.kind == "control":
                self._control(event)
            else:
                self._take_hands(event, body)

    def _take_hands(self, event: InputEvent, body: Any) -> None:
        """What a page asks for that the system refuses is that page's error alone, and nothing of the script's."""
        try:
            self._state.hands.take(event, body)
        except (ValueError, RuntimeError, LookupError) as error:
            title = "That cannot be held" if event.kind.startswith("grab") else "That cannot be done"
            self._state.notices.send(title, one_line(error), level="warning", client=event.client)

    def _act(self, event: InputEvent, named: Any) -> None:
        state = self._state
        action = state.actions.get(event.name)
        if action is None:
            text = f"This world has no action {event.name!r}."
            state.notices.send("Unknown action", text, client=event.client)
            return
        body = named or state.hands.held(event.client) or state.hands.selected(event.client)
        if body is None and action.on == "body":
            hint = f"Hold or select something, then press {action.key}." if action.key else ""
            title = f"Nothing to {action.label}"
            state.notices.send(title, "Nothing is held or selected.", hint, client=event.client)
            return
        given = Event(state.system, action.name, event.client, body, state.notices)
        arguments = (given,) if action.hook.takes_event else ()
        self._guard.call(f"The action {action.name!r}", action.hook.function, *arguments)

    def _control(self, event: InputEvent) -> None:
        clock = self._state.clock
        if event.command == ControlCommand.PAUSE:
            clock.paused = True
        elif event.command == ControlCommand.PLAY:
            clock.paused = False
        elif event.command == ControlCommand.SINGLE_STEP:
            clock.paused = True
            self._step()
        elif event.command == ControlCommand.RESET:
            self._reset()
        elif event.command == ControlCommand.SPEED:
            clock.speed = min(max(event.value, 0.0), MAX_SPEED)
