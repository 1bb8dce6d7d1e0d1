# SPDX-License-Identifier: Apache-2.0
"""Users' input: events of the server, in order of arrival, and calls from other threads."""

from __future__ import annotations

import queue
from collections.abc import Callable, Iterable
from typing import Any

import numpy as np

from iota._core import InputEvent, System, Vec3
from iota._protocol import ControlCommand, PointerKind
from iota.world.actions import Action
from iota.world.callbacks import Guard, one_line
from iota.world.clients import alive
from iota.world.clock import MAX_SPEED
from iota.world.event import Event, Hand
from iota.world.listeners import Drag, Listener
from iota.world.pace import Pace
from iota.world.state import State
from iota.world.widgets import Widget


class Inputs:
    """Passes them to the world, between steps. step, reset: functions for users' requests."""

    def __init__(self, state: State, guard: Guard, step: Callable[[], object], reset: Callable[[], None]) -> None:
        self._state, self._guard, self._step, self._reset = state, guard, step, reset
        self._waiting: list[tuple[InputEvent, list[Any]]] = []
        self._pace = Pace()
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
            if event.kind == "leave":
                self._pace.forget(event.client)
            elif not self._pace.allows(event.client, event.kind):
                if self._pace.is_first_refusal(event.client):
                    text = "A page can run 30 actions a second. The others were left out."
                    self._state.notices.send("Too fast", text, client=event.client)
                continue
            if event.names_body and body is None and not self._is_on_world(event):
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
                    self._tell(listener, event.client, key=event.name)
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
        self._end_gone()
        for listener in state.listeners.of("frame"):
            arguments = (Event(state.system, "frame", notices=state.notices),) if listener.hook.takes_event else ()
            if not self._guard.call(f"on_frame ({listener.hook.name})", listener.hook.function, *arguments):
                state.listeners.remove(listener.hook.function)  # avoids an error in each frame

    def _tell(self, listener: Listener, client: int, body: Any = None, **more: Any) -> None:
        """Calls one of the script's functions."""
        state, hook = self._state, listener.hook
        given = Event(state.system, listener.kind, client, body, notices=state.notices, **more)
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
        if event.pointer == PointerKind.MOVE:
            return self._move(event)
        kind = "click" if event.pointer == PointerKind.CLICK else "hover"
        phase = {PointerKind.HOVER: "start", PointerKind.HOVER_END: "end"}.get(PointerKind(event.pointer), "")
        point = None if body is None else event.target
        ray = {"origin": event.origin, "direction": event.direction}
        for listener in self._state.listeners.of(kind, body):
            self._tell(listener, event.client, body, point=point, pointer=event.name, phase=phase, **ray)

    def _move(self, event: InputEvent) -> None:
        joints = np.array(event.joints).reshape(-1, 3)
        hand = Hand(event.rotation, tuple(event.buttons), tuple(event.axes), joints)
        ray = {"origin": event.origin, "direction": event.direction}
        for listener in self._state.listeners.of("pointer"):
            self._tell(listener, event.client, point=event.target, pointer=event.name, hand=hand, **ray)

    def _take_hands(self, event: InputEvent, body: Any) -> None:
        """Hands of users, joins and leaves. The script's listeners are called; they may replace the grip of a hand."""
        listeners, kind = self._state.listeners, event.kind
        self._follow_grips()
        if kind == "grab_start" and body is not None and body.kind != "inactive":
            drag = Drag(body, body, list(listeners.of("drag", body)))
            is_taken = any(listener.takes_over for listener in drag.listeners)
            listeners.drags[event.client, event.hold] = drag
            if not is_taken:
                self._move_hands(event, body)
            self._tell_of_hand("press", (event.client, event.hold), drag, event.target)
            self._tell_drag("start", (event.client, event.hold), drag, event.target)
        elif kind in ("grab_move", "grab_end"):
            self._move_hands(event, body)
            found = listeners.drags.get((event.client, event.hold))
            if found is not None and kind == "grab_move":
                self._tell_drag("update", (event.client, event.hold), found, event.target)
            elif found is not None:
                self._end((event.client, event.hold), listeners.drags.pop((event.client, event.hold)), "released")
        else:
            if kind == "leave":
                for hand in [hand for hand in listeners.drags if hand[0] == event.client]:
                    self._end(hand, listeners.drags.pop(hand), "left")
            self._move_hands(event, body)
            if kind in ("join", "leave"):
                for listener in listeners.of(kind):
                    self._tell(listener, event.client)

    def _end_gone(self) -> None:
        """Ends the drags whose body was destroyed, and tells of all that did not end by their user."""
        listeners = self._state.listeners
        self._follow_grips()
        listeners.take_away("destroyed", [hand for hand, drag in listeners.drags.items() if alive(drag.body) is None])
        taken, listeners.taken_away = listeners.taken_away, []
        for hand, drag, reason in taken:
            self._end(hand, drag, reason)

    def _follow_grips(self) -> None:
        """After an edit a grip may be on another body, which exists beside the one that was taken. Drags without a grip
        stay with theirs."""
        for hand, drag in self._state.listeners.drags.items():
            drag.body = self._state.clients.held_by(hand) or drag.body

    def _end(self, hand: tuple[int, int], drag: Drag, reason: str) -> None:
        self._tell_drag("end", hand, drag, None, reason)
        self._tell_of_hand("release", hand, drag, None, reason)

    def _tell_of_hand(self, kind: str, hand: tuple[int, int], drag: Drag, point: Vec3 | None, reason: str = "") -> None:
        client, hold = hand
        body = alive(drag.body)
        # A destroyed body is still that for which a function was registered, and so is the one that was pressed.
        for listener in self._state.listeners.of_any(kind, {drag.taken, drag.body if body is None else body}):
            self._tell(listener, client, body, point=point, hold=hold, reason=reason)

    def _tell_drag(self, phase: str, hand: tuple[int, int], drag: Drag, point: Vec3 | None, reason: str = "") -> None:
        client, hold = hand
        body = alive(drag.body)
        for listener in drag.listeners if body is not None or phase == "end" else ():
            self._tell(listener, client, body, point=point, phase=phase, hold=hold, reason=reason)

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

    def _is_on_world(self, event: InputEvent) -> bool:
        """Whether it is an action that needs no body: what was under the mouse may be gone, as in a world that locks bodies."""
        action = self._state.actions.get(event.name) if event.kind == "action" else None
        return action is not None and action.on == "world"

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
