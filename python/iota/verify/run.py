# SPDX-License-Identifier: Apache-2.0
"""Input and results of a verification case."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, Literal, TypeVar

T = TypeVar("T")
Draw = Callable[[Any], None]  # draws on a matplotlib Figure


@dataclass(frozen=True)
class Row:
    """One line of the table. expected and tolerance are texts; `passed` was decided from the numbers."""

    quantity: str
    expected: str
    measured: str
    tolerance: str
    passed: bool


@dataclass(frozen=True)
class Picture:
    """A figure that `draw` makes on a matplotlib Figure of `size` inches. raster: PNG instead of SVG."""

    name: str
    caption: str
    draw: Draw
    size: tuple[float, float] = (7.0, 3.6)
    raster: bool = False


@dataclass
class Run:
    """Collects the rows and pictures of one case.

    scale: 'quick' for tests, 'full' for the report, 'long' for a long run. progress: called with 0 ... 1.
    """

    scale: Literal["quick", "full", "long"] = "full"
    progress: Callable[[float], None] = lambda _: None
    rows: list[Row] = field(default_factory=list)
    pictures: list[Picture] = field(default_factory=list)

    def size(self, full: T, quick: T, long: T | None = None) -> T:
        return quick if self.scale == "quick" else long if self.scale == "long" and long is not None else full

    def near(self, quantity: str, measured: float, expected: float, tolerance: float) -> None:
        """Passes where measured is within an absolute tolerance of expected; never for NaN."""
        passed = abs(measured - expected) <= tolerance
        self.rows.append(Row(quantity, number(expected, 7), number(measured, 7), number(tolerance), passed))

    def at_most(self, quantity: str, measured: float, bound: float) -> None:
        """Passes where measured <= bound; never for NaN."""
        self.rows.append(Row(quantity, f"≤ {number(bound)}", number(measured), "", measured <= bound))

    def at_least(self, quantity: str, measured: float, bound: float) -> None:
        """Passes where measured >= bound; never for NaN."""
        self.rows.append(Row(quantity, f"≥ {number(bound)}", number(measured), "", measured >= bound))

    def note(self, quantity: str, value: float | str) -> None:
        """A value that is shown without a check."""
        self.rows.append(Row(quantity, "", value if isinstance(value, str) else number(value), "", True))

    def picture(self, name: str, caption: str, draw: Draw, **options: Any) -> None:
        self.pictures.append(Picture(name, caption, draw, **options))

    @property
    def passed(self) -> bool:
        return all(row.passed for row in self.rows)


@dataclass(frozen=True)
class Case:
    """A named verification; `check` fills a Run. Its docstring, first line a title, goes into the report."""

    name: str
    check: Callable[[Run], None]

    @property
    def title(self) -> str:
        return self.text[0].rstrip(".")

    @property
    def text(self) -> list[str]:
        return [line.strip() for line in (self.check.__doc__ or self.name).strip().splitlines()]


def number(value: float, digits: int = 3) -> str:
    """Short and unambiguous."""
    if isinstance(value, int) or (float(value).is_integer() and abs(value) < 1e6):
        return str(int(value))
    if not math.isfinite(value):
        return str(value)
    return f"{value:.{digits}g}"
