# SPDX-License-Identifier: Apache-2.0
"""The base of the parts of a `World`, and how a world forwards calls to them."""

from __future__ import annotations

import functools
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, Concatenate, NoReturn, ParamSpec, TypeVar

from iota.arguments import refuse_reading, refuse_unknown

Given = ParamSpec("Given")
Result = TypeVar("Result")


class Part:
    """A part of a world, with a small state of its own."""

    def __setattr__(self, name: str, value: Any) -> None:
        """A misspelled attribute would change nothing."""
        if name[0] != "_":
            refuse_unknown(self, name)
        super().__setattr__(name, value)

    if not TYPE_CHECKING:  # checkers would take any name

        def __getattr__(self, name: str) -> NoReturn:
            refuse_reading(self, name)


def forward(function: Callable[Concatenate[Any, Given], Result]) -> Callable[Concatenate[Any, Given], Result]:
    """A method of a world that calls a method of its part, with the same signature and documentation: `Scene.draw` is that of
    `world.scene`."""
    kind, name = function.__qualname__.split(".")
    part = kind.lower()

    @functools.wraps(function)
    def call(world: Any, /, *given: Given.args, **named: Given.kwargs) -> Result:
        result: Result = getattr(getattr(world, part), name)(*given, **named)
        return result

    return call
