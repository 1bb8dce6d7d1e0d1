# SPDX-License-Identifier: Apache-2.0
"""Users' input: events of the server, in order of arrival, and calls from other threads."""

from __future__ import annotations

import queue
from collections.abc import Callable, Iterable
from typing import Any

from iota._core import InputEvent, System
from iota._protocol import ControlCommand, PointerKind
from iota.world.actions import Action
from iota.world.callbacks import Guard, one_line
from iota.world.clients import alive
from iota.world.clock import MAX_SPEED
from iota.world.event import Event
from iota.world.listeners import Drag, Listener
from iota.world.state import State
from iota.world.widgets import Widget


class Inputs:
    """Passes them to the world, between steps. step, reset: functions for users' requests."""

    def __init__(self, state: State, guard: Guard, step: Callable[[], object], reset: Callable[[], None]) -> None:
        self._state, self._guard, self._step, self._reset = state, guard, step, reset
        self._waiting: list[tuple[InputEvent, list[Any]]] = []
        self._calls: queue.SimpleQueue[Callable[[], None]] = queue.SimpleQueue()

    def call(self, function: Callable[[], None]) -> None:
        """Calls a function with the next inputs. May be used on any thread."""
        self._calls.put(function)

    def take_calls(self) -> None:
        while not self._calls.empty():
            self._calls.get()()

    def take(self, events: Iterable[tuple[InputEvent, list[Any]]]) -> None:
        """Handles all events of users, each with its bodies that still exist."""
        waited, self._waiting = self._waiting, []
        for event, bodies in (*waited, *events):
            body = bodies[0] if bodies else None
            if event.kind == "picture":
                self._state.pictures.take(event)
                continue
            if event.names_body and body is None:
                if event.kind == "pointer":
                    continue
                text = "It was destroyed, or combined with another body."
                self._state.notices.send("It no longer exists", text, client=event.client)
                if event.kind != "select":
                    continue
            if event.kind == "action":
                self._act(event, bodies)
            elif event.kind == "control":
                self._control(event)
            elif event.kind == "change":
                self._change(event)
            elif event.kind == "pointer":
                self._point(event, body)
            elif event.kind == "key":
                for listener in self._state.listeners.of_key(event.name, event.is_final):
                    self._tell(listener, event, key=event.name)
            else:
                self._take_hands(event, body)

    def take_pictures(self, events: Iterable[tuple[InputEvent, list[Any]]]) -> None:
        """Handles only parts of pictures; all other events wait for `take`."""
        for event, bodies in events:
            if event.kind == "picture":
                self._state.pictures.take(event)
            else:
                self._waiting.append((event, bodies))

    def frame(self) -> None:
        """Calls the functions for each frame."""
        state = self._state
        for listener in state.listeners.of("frame"):
            arguments = (Event(state.system, "frame", notices=state.notices),) if listener.hook.takes_event else ()
            if not self._guard.call(f"on_frame ({listener.hook.name})", listener.hook.function, *arguments):
                state.listeners.remove(listener.hook.function)  # avoids an error in each frame

    def _tell(self, listener: Listener, event: InputEvent, body: Any = None, **more: Any) -> None:
        """Calls one of the script's functions."""
        state, hook = self._state, listener.hook
        given = Event(state.system, listener.kind, event.client, body, notices=state.notices, **more)
        self._guard.call(f"on_{listener.kind} ({hook.name})", hook.function, *((given,) if hook.takes_event else ()))

    def _change(self, event: InputEvent) -> None:
        widget = self._state.things.find("widget", event.widget)
        if not isinstance(widget, Widget):
            self._state.notices.send(
                "It no longer exists", "The script has removed it from the page.", client=event.client
            )
            return
        given = Event(self._state.system, widget.label, event.client, notices=self._state.notices)
        widget.take(event.value, event.name, given, self._guard)

    def _point(self, event: InputEvent, body: Any) -> None:
        kind = "click" if event.pointer == PointerKind.CLICK else "hover"
        phase = {PointerKind.HOVER: "start", PointerKind.HOVER_END: "end"}.get(PointerKind(event.pointer), "")
        point = None if body is None else event.target
        ray = {"origin": event.origin, "direction": event.direction}
        for listener in self._state.listeners.of(kind, body):
            self._tell(listener, event, body, point=point, pointer=event.name, phase=phase, **ray)

    def _take_hands(self, event: InputEvent, body: Any) -> None:
        """Hands of users, joins and leaves. The script's listeners are called; they may replace the grip of a hand."""
        listeners, kind = self._state.listeners, event.kind
        if kind == "grab_start" and body is not None and body.kind != "inactive":
            drag = Drag(body, list(listeners.of("drag", body)))
            is_taken = any(listener.takes_over for listener in drag.listeners)
            listeners.drags[event.client, event.hold] = drag
            if not is_taken:
                self._move_hands(event, body)
            self._tell_of_hand("press", event, drag)
            self._tell_drag("start", event, drag)
        elif kind in ("grab_move", "grab_end"):
            self._move_hands(event, body)
            found = listeners.drags.get((event.client, event.hold))
            if found is not None and kind == "grab_move":
                self._tell_drag("update", event, found)
            elif found is not None:
                self._end(event, (event.client, event.hold))
        else:
            if kind == "leave":
                for hand in [hand for hand in listeners.drags if hand[0] == event.client]:
                    self._end(event, hand)
            self._move_hands(event, body)
            if kind in ("join", "leave"):
                for listener in listeners.of(kind):
                    self._tell(listener, event)

    def _end(self, event: InputEvent, hand: tuple[int, int]) -> None:
        drag = self._state.listeners.drags.pop(hand)
        self._tell_drag("end", event, drag)
        self._tell_of_hand("release", event, drag)

    def _tell_of_hand(self, kind: str, event: InputEvent, drag: Drag) -> None:
        body = alive(drag.body)
        for listener in self._state.listeners.of(kind, body) if body is not None else ():
            self._tell(listener, event, body, point=event.target if kind == "press" else None, hold=event.hold)

    def _tell_drag(self, phase: str, event: InputEvent, drag: Drag) -> None:
        body = alive(drag.body)
        point = None if phase == "end" else event.target
        for listener in drag.listeners if body is not None else ():
            self._tell(listener, event, body, point=point, phase=phase, hold=event.hold)

    def _move_hands(self, event: InputEvent, body: Any) -> None:
        """If the system refuses a request of a page, only that page gets an error, not the script."""
        try:
            self._state.clients.take(event, body)
        except (ValueError, RuntimeError, LookupError) as error:
            title = "That cannot be held" if event.kind.startswith("grab") else "That cannot be done"
            self._state.notices.send(title, one_line(error), level="warning", client=event.client)

    def _act(self, event: InputEvent, named: list[Any]) -> None:
        """Runs an action: on several bodies as one edit, which is undone at once."""
        state = self._state
        action = state.actions.get(event.name)
        if action is None:
            text = f"This world has no action {event.name!r}."
            state.notices.send("Unknown action", text, client=event.client)
            return
        meant = state.clients.held(event.client) or state.clients.selected(event.client)
        self.act(action, event.client, named or ([] if meant is None else [meant]))

    def act(self, action: Action, client: int, bodies: list[Any]) -> None:
        """client: 0 for none."""
        state = self._state
        if not bodies and action.on == "body":
            hint = f"Hold or select something, then press {action.key}." if action.key else ""
            title = f"Nothing to {action.label}"
            state.notices.send(title, "Nothing is held or selected.", hint, client=client)
            return
        if len(bodies) > 1 and isinstance(state.system, System):
            with state.system.edit():
                self._act_on_all(action, client, bodies)
        else:
            self._act_on_all(action, client, bodies or [None])

    def _act_on_all(self, action: Action, client: int, bodies: Iterable[Any]) -> None:
        """On one after the other, until the script's function raises."""
        state = self._state
        for body in bodies:
            if body is not None and alive(body) is None:  # destroyed with an earlier one
                continue
            given = Event(state.system, action.name, client, body, notices=state.notices)
            arguments = (given,) if action.hook.takes_event else ()
            if not self._guard.call(f"The action {action.name!r}", action.hook.function, *arguments):
                return

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
