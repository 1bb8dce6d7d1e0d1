# SPDX-License-Identifier: Apache-2.0
"""What a World offers to draw beside its bodies, and controls for users. Each call gives a handle; assigning is updating."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from iota.looks import Look
from iota.simulator import SimulatedBody
from iota.world.shown import Arrow, Axes, Label, Line, Marker, Points, Trace
from iota.world.state import State
from iota.world.things import Attachable, Place, Thing
from iota.world.widgets import Button, Callback, Checkbox, Choice, Plot, Slider, TextField

Color = Any  # "#rrggbb", 0xRRGGBB, three numbers from 0 to 1, or None


class Drawing:
    """Labels, lines, arrows, axes, traces, points, shapes, buttons, sliders, check boxes, choices, texts and plots.

    A place is a particle, a body, a bond or a point of the world (m). What is on one of these moves with it, at no cost, stays
    on it when bodies are cut and joined, and goes when it goes. `handle.destroy()` takes a thing off the page, `handle.visible`
    hides it. Reset leaves all of them as they are.

        label = world.label("top", at=ball)
        label.text = "still the top"
    """

    _state: State

    @property
    def things(self) -> list[Thing]:
        """Everything that was made by the functions below, in that order."""
        return list(self._state.things)

    # --- to look at -----------------------------------------------------------------------------------------------

    def label(
        self,
        text: object,
        at: Place = None,
        offset: Sequence[float] = (0, 0, 0),
        height: float = 0.0,
        color: Color = None,
    ) -> Label:
        """Text at a place (of a bond its middle). offset: world, m. height: of a capital, m; 0: the same on the screen from
        wherever it is seen."""
        return Label(self._state.things, text=text, at=at, offset=offset, height=height, color=color)

    def line(self, *points: Any, radius: float = 0.0, color: Color = None, closed: bool = False) -> Line:
        """A line through particles, bodies and places, or through an array of shape (n, 3). radius: m; 0: a few pixels."""
        given = points[0] if len(points) == 1 and not isinstance(points[0], Attachable) else points
        return Line(self._state.things, points=given, radius=radius, color=color, closed=closed)

    def arrow(
        self,
        at: Place,
        to: Place = None,
        vector: Sequence[float] = (0, 0, 0),
        radius: float = 0.0,
        color: Color = None,
    ) -> Arrow:
        """An arrow from `at` to `to`, or along `vector` (world, m). radius: of its shaft, m; 0: by its length."""
        return Arrow(self._state.things, at=at, to=to, vector=vector, radius=radius, color=color)

    def axes(self, at: Place = None, length: float = 0.2, rotation: Sequence[float] = (0, 0, 0, 1)) -> Axes:
        """x, y and z of a body or of the world as red, green and blue arrows. length: m. rotation: quaternion x y z w."""
        return Axes(self._state.things, at=at, length=length, rotation=rotation)

    def trace(
        self, at: Place, seconds: float = 0.0, radius: float = 0.0, color: Color = None, capacity: int = 2000
    ) -> Trace:
        """The path that a particle or body has taken, as each page has seen it. seconds: of simulated time that it shows, 0: its
        newest `capacity` points."""
        return Trace(self._state.things, at=at, seconds=seconds, radius=radius, color=color, capacity=capacity)

    def points(self, points: Any, radius: Any = 0.02, color: Any = None, at: Place = None) -> Points:
        """Many balls. points: array of shape (n, 3), m, in the frame of `at`. radius: m, one or n. color: one, an array of shape
        (n, 3) from 0 to 1, or a list of n colors. An array assigned moves all of them."""
        return Points(self._state.things, points=points, radius=radius, color=color, at=at)

    def shape(
        self,
        look: Look,
        position: Sequence[float] = (0, 0, 0),
        rotation: Sequence[float] = (0, 0, 0, 1),
        on: Attachable | SimulatedBody | None = None,
        color: Color = None,
    ) -> Marker:
        """A look of `iota.looks` that is only drawn, on a body or in the world. position: m and rotation: quaternion x y z w, in
        the frame of what it is on."""
        return Marker(
            self._state.things,
            look=look,
            position=position,
            rotation=rotation,
            on=on,
            color=color,
        )

    # --- to be changed by users -----------------------------------------------------------------------------------

    def button(self, label: str, help: str = "") -> Callable[[Callback], Button]:
        """Decorator: a button that calls a function. What comes back is its handle."""

        def register(function: Callback) -> Button:
            made = Button(self._state.things, label, help=help)
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
        """A number from `minimum` to `maximum` in whole `step`s, 0: any. value: at first, None: the minimum.

        gravity = world.slider("gravity", 0, 20, 9.81, unit="m/s²")

        @gravity.on_change
        def changed(): system.gravity = (0, -gravity.value, 0)
        """
        first = minimum if value is None else value
        return Slider(self._state.things, label, minimum, maximum, first, step=step, unit=unit, help=help)

    def checkbox(self, label: str, value: bool = False, help: str = "") -> Checkbox:
        """On or off."""
        return Checkbox(self._state.things, label, value=value, help=help)

    def choice(self, label: str, options: Sequence[str], value: str | None = None, help: str = "") -> Choice:
        """One of several texts. value: at first, None: the first of them."""
        return Choice(self._state.things, label, options, value, help=help)

    def text(self, label: str, value: str = "", help: str = "") -> TextField:
        """A line that users can write."""
        return TextField(self._state.things, label, value=value, help=help)

    def plot(
        self,
        label: str,
        curves: Callable[[], float] | Mapping[str, Callable[[], float]] | Sequence[str] | None = None,
        unit: str = "",
        seconds: float = 10.0,
    ) -> Plot:
        """Curves over the last `seconds` of simulated time. curves: a function, or several by name, that are asked once a frame;
        or names of curves that the script feeds by `plot.add(time, value, ...)`.

        world.plot("energy", {"kinetic": lambda: system.energy.kinetic, "total": lambda: system.energy.total}, unit="J")
        """
        if isinstance(curves, Mapping):
            named: dict[str, Callable[[], float] | None] = dict(curves)
        elif curves is None or callable(curves):
            named = {label: curves}
        else:
            named = dict.fromkeys(curves)
        return Plot(self._state.things, label, named, unit, seconds)
