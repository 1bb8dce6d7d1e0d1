# SPDX-License-Identifier: Apache-2.0
"""A story of timed events that waits for its user: it is told while nobody touches anything, and stops when somebody does."""

from __future__ import annotations

from collections.abc import Callable

import iota

Callback = Callable[[], None]


class Story:
    """wait: s without a hand or action before it begins, and from its last event until it begins anew. first: the same at the start.
    on_stop: what the script does to put things right when somebody interrupts.

        story = Story(world, wait=6)

        @story.at(2)
        def leave(): ...
    """

    def __init__(
        self,
        world: iota.World,
        wait: float = 6.0,
        first: float | None = None,
        on_stop: Callable[[], None] = lambda: None,
    ) -> None:
        self._world, self._wait, self._on_stop = world, wait, on_stop
        self._begins = self._first = wait if first is None else first  # s, at the earliest
        self._events: list[tuple[float, Callable[[], None]]] = []
        self._next = 0  # event
        self._began: float | None = None
        world.on_step(self._tell)
        world.on_reset(self._forget)

    @property
    def is_told(self) -> bool:
        """It is under way."""
        return self._began is not None

    def at(self, time: float) -> Callable[[Callable[[], None]], Callable[[], None]]:
        """Decorator: an event `time` s after the beginning, later than those before it."""

        def register(event: Callable[[], None]) -> Callable[[], None]:
            self._events.append((time, event))
            return event

        return register

    def action(self, name: str, key: str, help: str, button: str | None = None) -> Callable[[Callback], Callback]:
        """Decorator: an action on the world, see `World.action`, that stops the story."""

        def register(function: Callback) -> Callback:
            @self._world.action(name, key, help, button, on="world")
            def act() -> None:
                self.touch()
                function()

            return function

        return register

    def begin(self) -> None:
        """Begins now, unless it is under way."""
        if self._began is None:
            self._begins = self._world.system.time

    def touch(self) -> None:
        """Somebody does something. Called by a study's own actions; hands are seen by the story itself."""
        self._begins = self._world.system.time + self._wait
        if self._began is not None:
            self._began = None
            self._world.users.notice("The story stops", "It is your turn.")
            self._on_stop()

    def _tell(self) -> None:
        now = self._world.system.time
        if self._world.users.held() is not None:
            self.touch()
        elif self._began is None and now >= self._begins:
            self._began, self._next = now, 0
            self._world.users.notice("The story begins", "Touch anything, and it stops.")
        while self._began is not None and now >= self._began + self._events[self._next][0]:
            self._next += 1
            if self._next == len(self._events):
                self._began, self._begins = None, now + self._wait
                self._events[-1][1]()
                return
            self._events[self._next - 1][1]()

    def _forget(self) -> None:
        self._began, self._begins = None, self._world.system.time + self._first
