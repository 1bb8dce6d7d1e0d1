# SPDX-License-Identifier: Apache-2.0
"""Controls and plots of the script on the page."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Callable, Mapping, Sequence
from typing import Any, TypeVar

import numpy as np

from iota._protocol import NO_COLOR, WidgetKind
from iota.arguments import is_number
from iota.world.callbacks import Guard, Hook
from iota.world.event import Event
from iota.world.shown import colors
from iota.world.things import Field, Thing, Things, color, flag, number, text

Callback = TypeVar("Callback", bound=Callable[..., Any])
CURVES = ("#2f9d92", "#e8452c", "#3f7fd0", "#f2a324", "#8d6fd1", "#4c9a52")
MOST_SAMPLES = 400  # of a plot
LARGEST = float(np.finfo(np.float32).max)  # of the numbers of a page, where a larger one is not finite


class Widget(Thing):
    """A control. value: assigning it updates all pages and calls no function. enabled: users may change it. client: the number
    of the only client that has it, as in `Event.client`; 0: all have."""

    kind = "widget"
    form: WidgetKind
    label, help, enabled = Field(text), Field(text), Field(flag)
    client = Field(lambda value: int(number(0, 2**32 - 1)(value)))

    def __init__(self, things: Things, label: str, **values: Any) -> None:
        self._hooks: list[Hook] = []
        super().__init__(things, label=label, **{"help": "", "enabled": True, "client": 0} | values)

    def on_change(self, function: Callback) -> Callback:
        """Decorator: calls a function after a user has changed it (pressed it, for a button); it gets one Event, or nothing."""
        self._hooks.append(Hook.of(function))
        return function

    def take(self, value: float, typed: str, event: Event, guard: Guard) -> None:
        """Applies a user's change. Values out of range are corrected."""
        if not self.enabled or self.client not in (0, event.client):
            return
        self._set(value, typed)
        for hook in list(self._hooks):
            arguments = (event,) if hook.takes_event else ()
            guard.call(f"{self.label!r} ({hook.name})", hook.function, *arguments)

    def _set(self, value: float, typed: str) -> None:
        raise NotImplementedError

    def _record(self) -> dict[str, Any] | None:
        usual = {"unit": "", "value": 0.0, "minimum": 0.0, "maximum": 0.0, "step": 0.0, "text": "", "options": ()}
        return usual | self._values | {"kind": self.form}


class Button(Widget):
    """A button."""

    form = WidgetKind.BUTTON

    def _set(self, value: float, typed: str) -> None:
        pass


class Slider(Widget):
    """A number from `minimum` to `maximum`, any or a multiple of `step` above the minimum."""

    form = WidgetKind.SLIDER
    minimum, maximum, step, unit = Field(number()), Field(number()), Field(number(0)), Field(text)
    value = Field(number())

    def __init__(self, things: Things, label: str, minimum: float, maximum: float, value: float, **values: Any) -> None:
        if not minimum < maximum:
            raise ValueError(f"a slider needs a minimum below its maximum, not {minimum} and {maximum}")
        if is_number(value) and not minimum <= float(value) <= maximum:
            raise ValueError(f"value: must be from {minimum:g} to {maximum:g}, not {value}")
        super().__init__(things, label, minimum=minimum, maximum=maximum, value=value, **values)

    def _set(self, value: float, typed: str) -> None:
        value = min(max(value, self.minimum), self.maximum)  # first: a client may send 1e308, which no step divides
        steps = (value - self.minimum) / self.step if self.step > 0 else math.inf
        if math.isfinite(steps):
            value = self.minimum + self.step * round(steps)
        self.value = min(max(value, self.minimum), self.maximum)


class Checkbox(Widget):
    """A check box."""

    form = WidgetKind.CHECKBOX
    value = Field(flag)

    def _set(self, value: float, typed: str) -> None:
        self.value = value != 0


class Choice(Widget):
    """A choice of one of several texts."""

    form = WidgetKind.CHOICE

    def __init__(self, things: Things, label: str, options: Sequence[str], value: str | None, **values: Any) -> None:
        self._options = [str(option) for option in options]
        if not self._options:
            raise ValueError("a choice needs at least one option")
        super().__init__(things, label, value=self._options[0] if value is None else value, **values)

    @property
    def options(self) -> list[str]:
        return list(self._options)

    @property
    def value(self) -> str:
        return self._options[int(self._values["value"])]

    @value.setter
    def value(self, value: str) -> None:
        if value not in self._options:
            raise ValueError(f"value must be one of {', '.join(self._options)}, not {value!r}")
        self._values["value"] = self._options.index(value)
        self._changed()

    def _set(self, value: float, typed: str) -> None:
        if 0 <= value < len(self._options):
            self._values["value"] = int(value)
            self._changed()

    def _record(self) -> dict[str, Any] | None:
        record = super()._record()
        return None if record is None else record | {"options": self._options}


class TextField(Widget):
    """A text field of one line."""

    form = WidgetKind.TEXT
    value = Field(text)

    def _set(self, value: float, typed: str) -> None:
        self.value = typed

    def _record(self) -> dict[str, Any] | None:
        record = super()._record()
        return None if record is None else record | {"value": 0.0, "text": self.value}


class Plot(Thing):
    """Curves over the last `seconds` of simulated time. With functions it samples automatically, otherwise by `add`."""

    kind = "plot"
    label, unit, seconds, color = Field(text), Field(text), Field(number(1e-6, 1e6)), Field(colors)

    def __init__(
        self,
        things: Things,
        label: str,
        curves: Mapping[str, Callable[[], float] | None],
        unit: str,
        seconds: float,
        color: Any = None,
    ) -> None:
        if not curves or len(curves) > len(CURVES):
            raise ValueError(f"a plot has 1 to {len(CURVES)} curves, not {len(curves)}")
        self._functions = dict(curves)
        self._samples: deque[tuple[float, tuple[float, ...]]] = deque(maxlen=MOST_SAMPLES)
        self._off = False
        super().__init__(things, label=label, unit=unit, seconds=seconds, color=color)

    @property
    def curves(self) -> list[str]:
        """Names of the curves."""
        return list(self._functions)

    def add(self, time: float, *values: float) -> None:
        """Adds a sample of each curve at a simulated time, s. Samples that are not finite, or too close to the previous
        one to be visible, are skipped. Going back in time clears the curves."""
        if len(values) != len(self._functions):
            raise ValueError(f"this plot has {len(self._functions)} curves, not {len(values)}")
        if self._samples and time < self._samples[-1][0]:
            self._samples.clear()
        if not self.is_due(time) or not all(abs(value) <= LARGEST for value in values):
            return
        self._samples.append((float(time), tuple(map(float, values))))
        while self._samples[0][0] < time - self.seconds:
            self._samples.popleft()
        self._changed()

    def clear(self) -> None:
        self._samples.clear()
        self._changed()

    def is_due(self, time: float) -> bool:
        """Whether a sample at that time would be visible."""
        return not self._samples or not 0 <= time - self._samples[-1][0] < 0.99 * self.seconds / MOST_SAMPLES

    def sample(self, time: float, guard: Guard) -> None:
        """Takes a sample by its functions, if one is due."""
        functions = [function for function in self._functions.values() if function is not None]
        if self._off or len(functions) < len(self._functions) or not self.is_due(time):
            return

        def take() -> None:
            self.add(time, *(function() for function in functions))

        self._off = not guard.call(f"The plot {self.label!r}", take, hint="It is switched off. Correct the script.")

    def _record(self) -> dict[str, Any] | None:
        times = [time for time, _ in self._samples]
        values = [values[curve] for curve in range(len(self._functions)) for _, values in self._samples]
        given = list(self.color)
        if len(given) not in (1, len(self._functions)):
            raise ValueError(
                f"color must be one, or one for each of the {len(self._functions)} curves, not {len(given)}"
            )
        hues = [*given, *map(color, CURVES[len(given) :])][: len(self._functions)]
        shown = [color(usual) if hue == NO_COLOR else hue & 0xFFFFFF for hue, usual in zip(hues, CURVES, strict=False)]
        own = {"curves": self.curves, "colors": shown}
        return self._values | own | {"times": times, "values": values}
