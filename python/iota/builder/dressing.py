# SPDX-License-Identifier: Apache-2.0
"""Common functions of makers: checks of numbers, and looks that a callback may replace."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, TypeAlias

import numpy as np

from iota.arguments import is_number
from iota.builder.points import Vector
from iota.builder.structure import Structure
from iota.looks import Drawn

if TYPE_CHECKING:
    from numpy.typing import NDArray

Dress: TypeAlias = Callable[[str, int], Drawn | None]
"""Takes the kind of a body ("plank") and its index from 0; returns its look, None for the default one."""

MOST_PARTS = 1_000_000
UNITS = dict.fromkeys(("length", "width", "thickness", "radius", "tube", "spacing", "height", "x", "y", "z"), "m")
UNITS |= {"density": "kg/m^3", "mass": "kg", "stiffness": "N/m"}


def check(**numbers: float) -> None:
    """Raises ValueError for values that are not finite and above 0."""
    for name, value in numbers.items():
        if not (is_number(value) and 0 < value < math.inf):
            unit = UNITS.get(name, "")
            raise ValueError(f"{name} must be above 0{unit and ' ' + unit} and finite, not {value!r}")


def check_counts(least: int = 1, **counts: int) -> None:
    """Raises ValueError for counts that are not whole numbers from `least` up, and for too many parts in total."""
    for name, count in counts.items():
        if not (isinstance(count, int | np.integer) and count >= least):
            raise ValueError(f"{name} must be a whole number from {least} up, not {count!r}")
    if math.prod(counts.values()) > MOST_PARTS:
        raise ValueError(f"{' x '.join(counts)} must be at most {MOST_PARTS} parts")


def place(name: str, vector: Vector) -> NDArray[np.float64]:
    """A finite vector. Raises TypeError and ValueError."""
    parts = tuple(vector)
    if len(parts) not in (2, 3) or not all(map(is_number, parts)):
        raise TypeError(f"{name} must be 2 or 3 numbers, not {vector!r}")
    found = np.array([*parts, 0.0][:3], float)
    if not np.isfinite(found).all():
        raise ValueError(f"{name} must be finite, not {tuple(vector)}")
    return found


def dress(structure: Structure, usual: Mapping[str, Drawn | None], look: Dress | None) -> Structure:
    """Gives each body whose `look` is a name in `usual` that look, or the one of the callback; None: that of
    the page. Returns the structure."""
    count = dict.fromkeys(usual, 0)
    structure.looks |= {what: drawn for what, drawn in usual.items() if drawn is not None}
    for body in structure.bodies:
        what = body.look
        if what not in usual:
            continue
        number = count[what]
        count[what] += 1
        own = look(what, number) if look is not None else None
        if own is not None:
            body.look = f"{what} {number}"
            structure.looks[body.look] = own
        elif usual[what] is None:
            body.look = ""
    return structure
