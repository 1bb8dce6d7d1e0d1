# SPDX-License-Identifier: Apache-2.0
"""Callbacks of a World for events of users and of the simulation."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

from iota._core import System
from iota.world.callbacks import Hook, add_once
from iota.world.keys import key_name
from iota.world.listeners import Listener, Listeners, bodies_of, parties_of, things_of
from iota.world.parts import Part

Callback = TypeVar("Callback", bound=Callable[..., Any])


class Events(Part):
    """Decorators for functions that are called on events of users or of the simulation. They take one `Event`, or
    nothing; the event has the client, the body and the place.

    on: a body, several, a class of bodies (a Group of the system: those with a particle in it when it happens),
    "anything" (any body) or "nothing" (no body was hit). `world.events.forget(function)` removes
    the function.
    """

    def __init__(self, listeners: Listeners, system: Any) -> None:
        self._listeners, self._system = listeners, system

    def on_step(self, function: Callback) -> Callback:
        """Decorator: calls a function before each step."""
        add_once(self._listeners.on_step, function, "on_step")
        return function

    def on_reset(self, function: Callback) -> Callback:
        """Decorator: calls a function after each reset, for the script's own state."""
        add_once(self._listeners.on_reset, function, "on_reset")
        return function

    def on_click(self, on: Any = "anything") -> Any:
        """Decorator: a short press, by mouse, finger, controller or hand.

        @world.on_click(ball)
        def hit(event): event.body.velocity += (0, 3, 0)

        @world.on_click("nothing")
        def drop(event): print(event.origin, event.direction)  # the ray that hit nothing
        """
        return self._listen("click", on)

    def on_press(self, on: Any = "anything") -> Any:
        """Decorator: a hand presses a body, at event.point."""
        return self._listen("press", on)

    def on_release(self, on: Any = "anything") -> Any:
        """Decorator: the hand releases it, or it is taken out of the hand: event.reason says why."""
        return self._listen("release", on)

    def on_drag(self, on: Any = "anything", grab: bool = True) -> Any:
        """Decorator: a hand grabs a body (event.phase "start"), moves ("update") and releases it ("end"), or it is
        taken out of the hand (see event.reason); event.point is the place of the hand, world, m; event.body is what the
        hand holds, which an edit may have made another body than at the start. grab: the hand also pulls with its spring;
        False: only the function acts."""
        return self._listen("drag", on, takes_over=not grab)

    def on_hover(self, on: Any = "anything") -> Any:
        """Decorator: a pointer enters a body (event.phase "start") or leaves it ("end")."""
        return self._listen("hover", on)

    def on_pointer(self, function: Callback) -> Callback:
        """Decorator: a pointer of a user moved, or its buttons: the mouse, a finger, a controller, a bare hand, a gamepad
        (event.pointer); at most once a frame for each. event.point is where it is, for a mouse on what it points at or beside the
        middle of the scene; event.origin and event.direction its ray; event.hand has buttons, sticks and joints.

        finger = system.body().particle((0, 1, 0))  # a pointer as a particle, which bonds can pull at
        finger.body.kind = "scripted"

        @world.on_pointer
        def follow(event):
            if event.pointer == "right": finger.position = event.point
        """
        return self._add("pointer")(function)

    def on_key(self, key: str, release: bool = False) -> Callable[[Callback], Callback]:
        """Decorator: a key is pressed, or released; the page then does not use this key. key: "k", "space",
        "ArrowUp" or "up", "Enter"; event.key has its name in browsers, as " ". Actions also have a button and a line in the help: see `Controls.action`."""
        return self._add("key", key=key_name(key), on_release=release)

    def on_join(self, function: Callback) -> Callback:
        """Decorator: a page was opened; event.client is its number."""
        return self._add("join")(function)

    def on_leave(self, function: Callback) -> Callback:
        """Decorator: a page was closed, or its connection lost."""
        return self._add("leave")(function)

    def on_frame(self, function: Callback) -> Callback:
        """Decorator: calls a function before each frame for pages, 60 times a second, also while paused."""
        return self._add("frame")(function)

    def on_stop(self, on: Any = "anything") -> Any:
        """Decorator: a one-sided constraint begins (event.phase "start") or ceases ("end") to carry a load: surfaces
        meet or part, a rope becomes taut or slack, a joint reaches or leaves a stop. Called between two steps;
        event.stop has the constraint and the coordinate, event.point the place. on: a body, a constraint, several, or
        "anything".

        @world.on_stop(door_hinge)
        def stopped(event):
            if event.phase == "start" and event.stop.coordinate == "angle": print("shut")
        """
        return self._hear("stop", on)

    def on_contact(
        self,
        a: Any = "anything",
        b: Any = "anything",
        *,
        min_impulse: float = 0.0,
        min_speed: float = 0.0,
        cooldown: float = 0.0,
    ) -> Any:
        """Decorator: two bodies begin (event.phase "start") or cease ("end") to touch. Called between two steps;
        event.target is of a and event.other of b, event.point the place; event.contact also has the normal, the impulse
        and the speed of the approach. a, b: a body, several, a Group, or "anything". The engine filters: see
        `System.watch_contacts`. A reset or an undo tells nothing: the touches of then have begun already.

        @world.on_contact(ball, min_speed=0.3, cooldown=0.1)
        def hit(event):
            if event.phase == "start": bell.play(event.point, volume=event.contact.speed)
        """
        if callable(a):  # without parentheses
            return self.on_contact()(a)
        if not isinstance(self._system, System):
            raise TypeError("on_contact needs a System; another Simulator has no contacts")
        sides = parties_of(a), parties_of(b)
        limits = {"min_impulse": min_impulse, "min_speed": min_speed, "cooldown": cooldown}

        def register(function: Callback) -> Callback:
            watch = self._system.watch_contacts(*sides, **limits)
            try:
                wanted = (*sides, *limits.values())
                self._listeners.add(Listener("contact", Hook.of(function), watch=watch, wanted=wanted))
            except BaseException:
                watch.end()
                raise
            return function

        return register

    def on_break(self, on: Any = "anything") -> Any:
        """Decorator: a constraint, bond, hinge or nail broke because of its load: event.broken has it and the load. on:
        a body, a constraint, several, or "anything"."""
        return self._hear("break", on)

    def forget(self, function: Callable[..., Any]) -> bool:
        """Removes a function registered by the decorators above; False for an unknown function."""
        return self._listeners.remove(function)

    def _listen(self, kind: str, on: Any, **more: Any) -> Any:
        if callable(on):  # without parentheses
            return self._add(kind, **more)(on)
        return self._add(kind, bodies=bodies_of(on), **more)

    def _hear(self, kind: str, on: Any) -> Any:
        if callable(on):  # without parentheses
            return self._add(kind)(on)
        return self._add(kind, bodies=things_of(on))

    def _add(self, kind: str, **more: Any) -> Callable[[Callback], Callback]:
        def register(function: Callback) -> Callback:
            self._listeners.add(Listener(kind, Hook.of(function), **more))
            return function

        return register
