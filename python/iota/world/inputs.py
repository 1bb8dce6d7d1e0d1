# SPDX-License-Identifier: Apache-2.0
"""Handles users' input, a function for each type of message, and calls from other threads."""

from __future__ import annotations

import queue
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from functools import partial
from typing import Any

import numpy as np

from iota import _protocol as protocol
from iota._core import System, Vec3
from iota.world.actions import Action
from iota.world.callbacks import Guard, one_line
from iota.world.clients import Client, Hold, alive
from iota.world.clock import MAX_SPEED
from iota.world.event import Event, Hand
from iota.world.listeners import Listener
from iota.world.pace import ACTIONS, Pace
from iota.world.state import State
from iota.world.widgets import Widget

BodiesOf = Callable[[Sequence[protocol.Id]], list[Any]]
Handler = Callable[["Inputs", Client, Any], None]
HANDLERS: dict[type, Handler] = {}
SHARES: dict[type, float] = {}
ROLES = {protocol.Role.HOST: "host", protocol.Role.ACTOR: "guest", protocol.Role.VIEWER: "viewer"}
TOO_FAST = (
    "A page can run 30 actions a second, and all pages those that take half of the time. The others were left out."
)


def handles(message: type, share: float = 0.0) -> Callable[[Handler], Handler]:
    """Decorator: the function handles all messages of a type, for a client that is there. share: of an action that one
    counts as, see `Pace`."""

    def register(function: Handler) -> Handler:
        HANDLERS[message], SHARES[message] = function, share
        return function

    return register


def share_of(message: protocol.Input) -> float:
    """Returns the share of an action that a message counts as. Each further body counts as a tenth, up to all that a page can do at once."""
    others = len(message.others) if isinstance(message, protocol.Action) else 0
    return min(SHARES[type(message)] + 0.1 * others, ACTIONS)


class Inputs:
    """Passes them to the world, between steps. step, reset: functions for users' requests."""

    def __init__(self, state: State, guard: Guard, step: Callable[[], object], reset: Callable[[], None]) -> None:
        self._state, self._guard, self._step, self._reset = state, guard, step, reset
        self._bodies_of: BodiesOf = lambda ids: []
        self._pace = Pace()
        self._calls: queue.SimpleQueue[Callable[[], None]] = queue.SimpleQueue()
        self.wake: Callable[[], object] = lambda: None
        """Ends the wait of the world's loop for input."""

    def call(self, function: Callable[[], None]) -> None:
        """Calls a function with the next inputs. May be used on any thread."""
        self._calls.put(function)
        self.wake()

    def take_calls(self) -> bool:
        """Whether there were any."""
        if self._calls.empty():
            return False
        while not self._calls.empty():
            self._calls.get()()
        return True

    def take(self, inputs: Iterable[tuple[int, protocol.Input]], bodies_of: BodiesOf) -> None:
        """Handles all inputs, each with the number of its client. bodies_of: finds the bodies that still exist."""
        self._bodies_of = bodies_of
        for number, message in inputs:
            if isinstance(message, protocol.Join):
                self._state.clients.join(number, message.name, ROLES[message.role])
            client = self._state.clients.by_id.get(number)
            if client is None:
                continue
            if self._pace.allows(number, share_of(message)):
                began = time.monotonic()
                self._handle(client, message)
                self._pace.charge(number, time.monotonic() - began)
            elif self._pace.is_first_refusal(number):
                self._notice(client, "Too fast", TOO_FAST)

    def _handle(self, client: Client, message: protocol.Input) -> None:
        """An error here is one card for the sender."""

        def tell(title: str, text: str, hint: str) -> None:
            self._state.notices.send(title, text, hint, "error", client.id)

        self._guard.outlive("That", partial(HANDLERS[type(message)], self, client, message), tell)

    def frame(self) -> None:
        """Calls the functions for each frame."""
        state = self._state
        self._end_gone()
        for listener in state.listeners.of("frame"):
            arguments = (Event(state.system, "frame", notices=state.notices),) if listener.hook.takes_event else ()
            if not self._guard.call(f"on_frame ({listener.hook.name})", listener.hook.function, *arguments):
                state.listeners.remove(listener.hook.function)  # avoids an error in each frame

    def act(self, action: Action, client: int, bodies: list[Any]) -> None:
        """client: 0 for none."""
        state = self._state
        if not bodies and action.on == "body":
            hint = f"Hold or select something, then press {action.key}." if action.key else ""
            title = f"Nothing to {action.label}"
            state.notices.send(title, "Nothing is held or selected.", hint, client=client)
            return
        if action.on == "world":
            self._act_on_all(action, client, bodies[:1] or [None])
        elif len(bodies) > 1 and isinstance(state.system, System):
            with state.system.edit():
                self._act_on_all(action, client, bodies)
        else:
            self._act_on_all(action, client, bodies)

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

    # --- messages -------------------------------------------------------------------------------------------------

    @handles(protocol.Join)
    def _join(self, client: Client, message: protocol.Join) -> None:
        for listener in self._state.listeners.of("join"):
            self._tell(listener, client.id)

    @handles(protocol.Leave)
    def _leave(self, client: Client, message: protocol.Leave) -> None:
        clients = self._state.clients
        self._pace.forget(client.id)
        clients.follow_grips()
        for hold in list(client.holds.values()):
            self._end(hold, "left")
        with self._telling(client, "That cannot be done"):
            clients.leave(client)
        for listener in self._state.listeners.of("leave"):
            self._tell(listener, client.id)

    @handles(protocol.Select, share=0.1)
    def _select(self, client: Client, message: protocol.Select) -> None:
        client.selected = self._find(client, message.body)

    @handles(protocol.Profile, share=0.1)
    def _profile(self, client: Client, message: protocol.Profile) -> None:
        client.is_profiling = message.on

    @handles(protocol.Presence, share=0.02)
    def _presence(self, client: Client, message: protocol.Presence) -> None:
        client.eye = Vec3(*message.stance.head)

    @handles(protocol.Rename, share=0.2)
    def _rename(self, client: Client, message: protocol.Rename) -> None:
        client.name = message.name

    @handles(protocol.Picture)
    def _picture(self, client: Client, message: protocol.Picture) -> None:
        self._state.pictures.take(client.id, message)

    @handles(protocol.GrabStart, share=0.2)
    def _grab_start(self, client: Client, message: protocol.GrabStart) -> None:
        """The script's listeners are called; they may replace the grip of a hand."""
        body, clients = self._find(client, message.body), self._state.clients
        if body is None or body.kind == "inactive":
            return
        clients.follow_grips()
        listeners = list(self._state.listeners.of("drag", body))
        hold = Hold(client.id, message.hold, body, body, listeners, pointer=message.pointer)
        client.holds[hold.number] = hold
        if not any(listener.takes_over for listener in hold.listeners):
            with self._telling(client, "That cannot be held"):
                clients.grip(hold, body, message.local_point, message.target)
        self._tell_of_hand("press", hold, message.target)
        self._tell_drag("start", hold, message.target)

    @handles(protocol.GrabMove, share=0.02)
    def _grab_move(self, client: Client, message: protocol.GrabMove) -> None:
        self._state.clients.follow_grips()
        hold = client.holds.get(message.hold)
        if hold is not None:
            with self._telling(client, "That cannot be held"):
                hold.move(message.target)
            self._tell_drag("update", hold, message.target)

    @handles(protocol.GrabEnd)
    def _grab_end(self, client: Client, message: protocol.GrabEnd) -> None:
        self._state.clients.follow_grips()
        hold = client.holds.pop(message.hold, None)
        if hold is not None:
            with self._telling(client, "That cannot be held"):
                hold.let_go()
            self._end(hold, "released")

    @handles(protocol.Action, share=1.0)
    def _action(self, client: Client, message: protocol.Action) -> None:
        """Runs an action: on several bodies as one edit, which is undone at once."""
        clients, action = self._state.clients, self._state.actions.get(message.name)
        # An action on the world needs no body: the one under the mouse may be gone, as in a world that locks bodies.
        is_on_world = action is not None and action.on == "world"
        bodies = self._bodies_of([message.body, *message.others])
        if message.body and not bodies and not is_on_world:
            self._tell_of_gone(client)
        elif action is None:
            self._notice(client, "Unknown action", f"This world has no action {message.name!r}.")
        else:
            meant = clients.held(client.id) or clients.selected(client.id)
            self.act(action, client.id, bodies or ([] if meant is None else [meant]))

    @handles(protocol.Control, share=0.1)
    def _control(self, client: Client, message: protocol.Control) -> None:
        clock = self._state.clock
        if message.command == protocol.ControlCommand.PAUSE:
            clock.paused = True
        elif message.command == protocol.ControlCommand.PLAY:
            clock.paused = False
        elif message.command == protocol.ControlCommand.SINGLE_STEP:
            clock.paused = True
            self._step()
        elif message.command == protocol.ControlCommand.RESET:
            self._reset()
        elif message.command == protocol.ControlCommand.SPEED:
            clock.speed = min(max(message.value, 0.0), MAX_SPEED)

    @handles(protocol.Change, share=0.1)
    def _change(self, client: Client, message: protocol.Change) -> None:
        widget = self._state.things.find("widget", message.widget)
        if not isinstance(widget, Widget):
            self._notice(client, "It no longer exists", "The script has removed it from the page.")
            return
        given = Event(self._state.system, widget.label, client.id, notices=self._state.notices)
        widget.take(message.value, message.text, given, self._guard)

    @handles(protocol.Pointer, share=0.05)
    def _pointer(self, client: Client, message: protocol.Pointer) -> None:
        bodies = self._bodies_of([message.body])
        if message.body and not bodies:
            return
        body, point, hand, phase = next(iter(bodies), None), message.point, None, ""
        if message.kind == protocol.PointerKind.MOVE:
            kind, body = "pointer", None
            hand = Hand(message.rotation, message.buttons, message.axes, np.array(message.joints).reshape(-1, 3))
        elif message.kind == protocol.PointerKind.CLICK:
            kind = "click"
        else:
            kind, phase = "hover", "start" if message.kind == protocol.PointerKind.HOVER else "end"
        for listener in self._state.listeners.of(kind, body):
            self._tell(
                listener,
                client.id,
                body,
                point=point if kind == "pointer" or body is not None else None,
                origin=message.origin,
                direction=message.direction,
                pointer=message.name,
                phase=phase,
                hand=hand,
            )

    @handles(protocol.Key, share=0.1)
    def _key(self, client: Client, message: protocol.Key) -> None:
        for listener in self._state.listeners.of_key(message.key, released=not message.down):
            self._tell(listener, client.id, key=message.key)

    def _find(self, client: Client, id: protocol.Id) -> Any | None:
        """The body with an id; None if it names none, or one that is gone, which the client is told."""
        bodies = self._bodies_of([id]) if id else []
        if id and not bodies:
            self._tell_of_gone(client)
        return bodies[0] if bodies else None

    def _tell_of_gone(self, client: Client) -> None:
        self._notice(client, "It no longer exists", "It was destroyed, or combined with another body.")

    def _notice(self, client: Client, title: str, text: str) -> None:
        self._state.notices.send(title, text, client=client.id)

    @contextmanager
    def _telling(self, client: Client, title: str) -> Iterator[None]:
        """If the system refuses a request of a page, only that page gets an error, not the script."""
        try:
            yield
        except (ValueError, RuntimeError, LookupError) as error:
            self._state.notices.send(title, one_line(error), level="warning", client=client.id)

    # --- the script's functions -----------------------------------------------------------------------------------

    def _tell(self, listener: Listener, client: int, body: Any = None, **more: Any) -> None:
        """Calls one of the script's functions."""
        state, hook = self._state, listener.hook
        given = Event(state.system, listener.kind, client, body, notices=state.notices, **more)
        self._guard.call(f"on_{listener.kind} ({hook.name})", hook.function, *((given,) if hook.takes_event else ()))

    def _end_gone(self) -> None:
        """Ends the holds whose body was destroyed, and tells of all that did not end by their user."""
        clients = self._state.clients
        clients.follow_grips()
        clients.take_away("destroyed", [hold for hold in clients.holds() if alive(hold.last) is None])
        taken, clients.taken_away = clients.taken_away, []
        for hold, reason in taken:
            self._end(hold, reason)

    def _end(self, hold: Hold, reason: str) -> None:
        self._tell_drag("end", hold, None, reason)
        self._tell_of_hand("release", hold, None, reason)

    def _tell_of_hand(self, kind: str, hold: Hold, point: Vec3 | None, reason: str = "") -> None:
        body = alive(hold.last)
        # A destroyed body is still that for which a function was registered, and so is the one that was pressed.
        for listener in self._state.listeners.of_any(kind, {hold.taken, hold.last if body is None else body}):
            self._tell(listener, hold.client, body, point=point, pointer=hold.pointer, hold=hold.number, reason=reason)

    def _tell_drag(self, phase: str, hold: Hold, point: Vec3 | None, reason: str = "") -> None:
        body = alive(hold.last)
        for listener in hold.listeners if body is not None or phase == "end" else ():
            self._tell(
                listener,
                hold.client,
                body,
                point=point,
                pointer=hold.pointer,
                phase=phase,
                hold=hold.number,
                reason=reason,
            )
