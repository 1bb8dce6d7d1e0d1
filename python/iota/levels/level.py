# SPDX-License-Identifier: Apache-2.0
"""How a thing may be simulated: in full, or less."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from iota.arguments import SHORT, is_number

if TYPE_CHECKING:
    from iota.levels.managed import Managed
    from iota.levels.stand_ins import Structure

LONGEST_STRIDE = 16  # steps, as in the engine


@dataclass(frozen=True)
class Level:
    """A level of a thing. name: for reports. stride: see `Body.stride`. is_stiff: its bodies are one. quality: from 1, as good as
    full, to 0. share: of the full cost, as far as is known before it is tried. enter, leave: functions of the script for a
    level of its own, called with the thing. structure: a function that makes an `iota.builder.Structure` of the same mass, which stands
    in for the thing at this level:

        far = Level("far", share=0.1, quality=0.5, structure=lambda thing: ball_of(thing.mass, thing.position))

    It begins with the thing's center of mass, momentum and angular momentum, and gives its own back. See docs/complexity.md.
    """

    name: str
    stride: int = 1
    is_stiff: bool = False
    quality: float = 1.0
    share: float = 1.0
    enter: Callable[[Managed], None] | None = None
    leave: Callable[[Managed], None] | None = None
    structure: Callable[[Managed], Structure] | None = None

    def is_like(self, other: Level) -> bool:
        """Whether both do no more than take strides, of the same length."""
        functions = (self.enter, self.structure, other.enter, other.structure)
        is_plain = not (self.is_stiff or other.is_stiff) and all(function is None for function in functions)
        return is_plain and self.stride == other.stride

    def __post_init__(self) -> None:
        """Raises TypeError and ValueError for what is not a level."""
        if not isinstance(self.name, str) or not self.name:
            raise TypeError(f"the name of a level must be a text, not {SHORT.repr(self.name)}")
        what = f"level {self.name!r}"
        if not isinstance(self.stride, int) or not 0 <= self.stride <= LONGEST_STRIDE:
            raise ValueError(
                f"{what}: stride must be a number of steps, 1 to {LONGEST_STRIDE}, or 0 for frozen, not {SHORT.repr(self.stride)}"
            )
        for key, value in (("quality", self.quality), ("share", self.share)):
            if not (is_number(value) and 0 <= value <= 1):
                raise ValueError(f"{what}: {key} must be a number from 0 to 1, not {SHORT.repr(value)}")
        for key in ("enter", "leave", "structure"):
            refuse_no_function(f"{what}: {key}", getattr(self, key))


def refuse_no_function(what: str, value: object) -> None:
    if not (value is None or callable(value)):
        raise TypeError(f"{what} must be a function that takes the thing, not {SHORT.repr(value)}")


FULL_LEVEL = Level("full")
HALF, QUARTER, EIGHTH = (Level(f"1/{n}", n, quality=q, share=1 / n) for n, q in ((2, 0.97), (4, 0.92), (8, 0.85)))
STIFF = Level("stiff", is_stiff=True, quality=0.4, share=0.15)
FROZEN = Level("frozen", 0, quality=0.05, share=0.0)
STANDARD = (FULL_LEVEL, HALF, QUARTER, EIGHTH, STIFF, FROZEN)
BY_NAME = {level.name: level for level in STANDARD}


@dataclass(frozen=True)
class LevelChange:
    """A change of the level of a thing. ms: what it was expected to save a step; negative: to cost. reason: why."""

    time: float
    thing: str
    before: str
    after: str
    significance: float
    ms: float
    reason: str


def levels_of(given: Sequence[str | Level]) -> tuple[Level, ...]:
    """Raises ValueError and TypeError for what a thing cannot have."""
    levels: list[Level] = []
    for level in [given] if isinstance(given, str) else given:
        if isinstance(level, str) and level not in BY_NAME:
            raise ValueError(
                f"no level is called {level!r}; there are {', '.join(map(repr, BY_NAME))}, or a Level of one's own"
            )
        if not isinstance(level, str | Level):
            raise TypeError(f"levels are names or of the type Level, not {SHORT.repr(level)}")
        levels.append(BY_NAME[level] if isinstance(level, str) else level)
    if not levels or levels[0] != FULL_LEVEL:
        raise ValueError("levels begin with 'full', at which a thing is as without management")
    names = [level.name for level in levels]
    if twice := next((each for each in names if names.count(each) > 1), None):
        raise ValueError(f"there are two levels {twice!r}: reports tell them by their names")
    return tuple(levels)


def frozen_level(levels: Sequence[Level]) -> int | None:
    """Index of the level at which a thing is frozen, and no more than that; None if there is none."""
    return next((i for i, level in enumerate(levels) if level.is_like(FROZEN)), None)


def last_that_moves(levels: Sequence[Level]) -> int:
    """Index of the last one at which all of a thing moves, as far as those before it do."""
    stopped = (i for i, level in enumerate(levels) if level.is_stiff or level.stride == 0)
    return next(stopped, len(levels)) - 1
