# SPDX-License-Identifier: Apache-2.0
"""The keys, buttons, sliders and plots that a World gives its users."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from iota._core import Body
from iota.arguments import SHORT
from iota.world.actions import Action, Actions
from iota.world.callbacks import Hook, is_decorator
from iota.world.keys import key_name
from iota.world.parts import Part
from iota.world.things import Things
from iota.world.widgets import Button, Callback, Checkbox, Choice, Plot, Slider, TextField

Act = Callable[[Action, list[Body]], None]


class Controls(Part):
    """Actions, buttons, sliders, check boxes, choices, texts and plots. All but actions return a handle, as those of
    `Drawings`."""

    def __init__(self, things: Things, actions: Actions, act: Act) -> None:
        self._things, self._actions, self._act = things, actions, act

    def action(
        self,
        name: str,
        key: str | None = None,
        help: str = "",
        button: str | None = None,
        on: str = "body",
        label: str | None = None,
    ) -> Callable[[Callback], Callback]:
        """Decorator: lets users call a function by a key, a controller's face button ("a" or "b") or the page's panel.

        key: as of `Events.on_key`. on: "body" (the event has the held or selected body; without one the user is told so) or "world".
        """
        is_decorator(f"world.action({name!r})", key, help, button, label)
        key = None if key is None else key_name(key)
        self._actions.check(name, key, button, on)

        def register(function: Callback) -> Callback:
            self._actions.add(Action(name, Hook.of(function), key, button, help, label or name, on))
            return function

        return register

    @property
    def actions(self) -> list[Action]:
        """All actions, in the order of creation."""
        return list(self._actions)

    def act(self, name: str, body: Body | None = None) -> None:
        """Runs an action as a user does, on a body or without one. Raises LookupError for an unknown one. An action that
        raises is reported as one that a user runs."""
        self._act(self._actions[name], [] if body is None else [body])

    def button(self, label: str, help: str = "") -> Callable[[Callback], Button]:
        """Decorator: a button that calls a function. Returns its handle."""
        is_decorator(f"world.controls.button({label!r})", help)

        def register(function: Callback) -> Button:
            made = Button(self._things, label, help=help)
            made.on_change(function)
            return made

        return register

    def slider(
        self,
        label: str,
        minimum: float,
        maximum: float,
        value: float | None = None,
        step: float = 0.0,
        unit: str = "",
        help: str = "",
    ) -> Slider:
        """A number from `minimum` to `maximum` in whole `step`s, 0: any. value: initial, None: the minimum.

        gravity = world.controls.slider("gravity", 0, 20, 9.81, unit="m/s²")

        @gravity.on_change
        def changed(): system.gravity = (0, -gravity.value, 0)
        """
        first = minimum if value is None else value
        return Slider(self._things, label, minimum, maximum, first, step=step, unit=unit, help=help)

    def checkbox(self, label: str, value: bool = False, help: str = "") -> Checkbox:
        """On or off."""
        return Checkbox(self._things, label, value=value, help=help)

    def choice(self, label: str, options: Sequence[str], value: str | None = None, help: str = "") -> Choice:
        """One of several texts. value: initial, None: the first of them."""
        return Choice(self._things, label, options, value, help=help)

    def text(self, label: str, value: str = "", help: str = "") -> TextField:
        """A text field of one line."""
        return TextField(self._things, label, value=value, help=help)

    def plot(
        self,
        label: str,
        curves: Callable[[], float] | Mapping[str, Callable[[], float]] | Sequence[str] | None = None,
        unit: str = "",
        seconds: float = 10.0,
        color: Any = None,
    ) -> Plot:
        """Curves over the last `seconds` of simulated time. curves: a function, or several by name, called once a
        frame; or names of curves that the script feeds by `plot.add(time, value, ...)`. color: that of the first curve, or
        a list of colors, one for each; None: the page's.

        world.controls.plot("energy", {"kinetic": lambda: system.energy.kinetic, "total": lambda: system.energy.total}, unit="J")
        """
        if isinstance(curves, Mapping):
            named: dict[str, Callable[[], float] | None] = dict(curves)
        elif curves is None or callable(curves):
            named = {label: curves}
        else:
            if not all(isinstance(name, str) for name in curves):
                raise TypeError(f"curves must be a function, several by name, or names, not {SHORT.repr(curves)}")
            named = dict.fromkeys(curves)
        return Plot(self._things, label, named, unit, seconds, color)
