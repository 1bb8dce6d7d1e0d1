# SPDX-License-Identifier: Apache-2.0
"""The points of a structure: a table that grows."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from iota._core import Vec3
from iota.arguments import is_number
from iota.colors import ColorLike, rgba

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    Array = NDArray[np.float64]

Vector = Sequence[float] | Vec3


class Points:
    """Places (m), velocities (m/s), masses (kg), drawn radii (m) and colors of n points, one row each.

    `position`, `velocity` and `color` (n, 3), `mass` and `radius` (n,) are views, float64: write into them, but read
    them again after `add`. With a radius of 0 the page chooses the look; colors, 0 to 1, are for points with a radius.
    """

    def __init__(self) -> None:
        self._rows = np.empty((0, 11))
        self._count = 0

    def __len__(self) -> int:
        return self._count

    @property
    def position(self) -> Array:
        return self._rows[: self._count, 0:3]

    @property
    def velocity(self) -> Array:
        return self._rows[: self._count, 3:6]

    @property
    def mass(self) -> Array:
        return self._rows[: self._count, 6]

    @property
    def radius(self) -> Array:
        return self._rows[: self._count, 7]

    @property
    def color(self) -> Array:
        return self._rows[: self._count, 8:11]

    def add(
        self,
        position: ArrayLike,
        mass: ArrayLike = 1.0,
        velocity: ArrayLike = (0.0, 0.0, 0.0),
        radius: ArrayLike = 0.0,
        color: ColorLike | ArrayLike = (1.0, 1.0, 1.0),
    ) -> range:
        """Adds points; returns their numbers. position: (k, 3) or (3,). The others: one for all, or one each; color by name, as
        "#rrggbb", or rows of red, green and blue."""
        places = np.atleast_2d(np.asarray(position, float))
        if places.ndim != 2 or places.shape[1] != 3:
            raise ValueError(f"position must be of shape (k, 3), not {np.shape(position)}")
        first, self._count = self._count, self._count + len(places)
        if self._count > len(self._rows):
            grown = np.empty((max(2 * len(self._rows), self._count), 11))
            grown[:first] = self._rows[:first]
            self._rows = grown
        new = self._rows[first : self._count]
        new[:, 0:3], new[:, 3:6], new[:, 6], new[:, 7], new[:, 8:11] = places, velocity, mass, radius, rows_of(color)
        return range(first, self._count)

    def add_all(self, other: Points) -> range:
        """Adds all points of another table; returns their numbers."""
        return self.add(other.position, other.mass, other.velocity, other.radius, other.color)

    def to_json(self) -> dict[str, Any]:
        names = ("position", "velocity", "mass", *(("radius", "color") if self.radius.any() else ()))
        return {name: getattr(self, name).tolist() for name in names}


def rows_of(color: ColorLike | ArrayLike) -> ArrayLike:
    """Red, green and blue of one color, or of one in each row. Raises ValueError, TypeError."""
    if isinstance(color, np.ndarray):
        return color
    is_listed = isinstance(color, Sequence) and not isinstance(color, str) and not all(map(is_number, color))
    return [rgba(each)[:3] for each in color] if is_listed else rgba(color)[:3]  # type: ignore[union-attr]
