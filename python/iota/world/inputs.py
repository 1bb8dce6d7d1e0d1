# SPDX-License-Identifier: Apache-2.0
"""What users do: events of the server, in the order in which they came, and calls from other threads."""

from __future__ import annotations

from typing import TYPE_CHECKING

from iota._core import InputEvent
from iota.world.event import Event

if TYPE_CHECKING:
    from iota.world.world import World

PAUSE, PLAY, SINGLE_STEP, RESET, SPEED = range(5)  # commands of a control event
MAX_SPEED = 10.0


class Inputs:
    """Brings them to the world, between steps."""

    def __init__(self, world: World) -> None:
        self._world = world

    def take(self) -> None:
        """Everything that has arrived."""
        world = self._world
        while not world._calls.empty():
            world._calls.get()()
        if world._publisher is None:
            return
        for event in world._publisher.server.take_input():
            if event.kind == "action":
                self._act(event)
            elif event.kind == "control":
                self._control(event)
            else:
                world._guard.call(f"{event.kind} by client {event.client}", world._hands.take, event)

    def _act(self, event: InputEvent) -> None:
        world = self._world
        action = world._actions.get(event.name)
        if action is None:
            world.notice("Unknown action", f"This world has no action {event.name!r}.", client=event.client)
            return
        named = None if event.body is None else world.system.body_at(event.body)
        body = named or world.held(event.client) or world.selected(event.client)
        if body is None and action.on == "body":
            hint = f"Hold or select something, then press {action.key}." if action.key else ""
            world.notice(f"Nothing to {action.label}", "Nothing is held or selected.", hint, client=event.client)
            return
        arguments = (Event(world, action.name, event.client, body),) if action.hook.takes_event else ()
        world._guard.call(f"The action {action.name!r}", action.hook.function, *arguments)

    def _control(self, event: InputEvent) -> None:
        world = self._world
        if event.command == PAUSE:
            world.paused = True
        elif event.command == PLAY:
            world.paused = False
        elif event.command == SINGLE_STEP:
            world.paused = True
            world._advance()
        elif event.command == RESET:
            world.reset()
        elif event.command == SPEED:
            world.speed = min(max(event.value, 0.0), MAX_SPEED)
