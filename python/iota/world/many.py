# SPDX-License-Identifier: Apache-2.0
"""Thousands of arrows and straight lines, each set of them by arrays. Pages draw them as copies of one shape."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from iota._protocol import ENTITIES, NO_COLOR
from iota.looks import Look, arrow, cylinder
from iota.world.shown import colors, part_of_look
from iota.world.things import FARTHEST, Field, Thing, anchor, length, number, place, points

Rows = NDArray[np.float64]
MOST = next(most for name, _, most, _ in ENTITIES["shape_set"] if name == "rotations") // 4


def _starts(value: Any) -> Rows:
    rows = points(value)
    if len(rows) > MOST:
        raise ValueError(f"may have {MOST} rows at most, not {len(rows)}; draw them in several parts")
    return rows


class _Along(Thing):
    """A look of length 1 along x, from each of `starts` as far as `_ways` says."""

    kind = "shape_set"
    look: Look
    at, starts, color = Field(place), Field(_starts), Field(colors)

    def _ways(self) -> Rows:
        raise NotImplementedError

    def _thickness(self, lengths: Rows) -> Rows:
        """The thickness of each, relative to that of the look."""
        raise NotImplementedError

    def _record(self) -> dict[str, Any] | None:
        at, count, ways = anchor(self.at), len(self.starts), self._ways()
        if at is None:
            return None
        if len(self.color) not in (1, count):
            raise ValueError(f"color must be one, or one for each of the {count}, not {len(self.color)}")
        lengths = np.linalg.norm(ways, axis=1)
        thickness = np.where(lengths > 0, self._thickness(lengths), 0)  # without a direction it is not drawn
        one = self.color[0] if len(self.color) == 1 else NO_COLOR
        return {
            "at": at,
            "part": part_of_look(self.look, int(one)),
            "places": self.starts,
            "rotations": turns_from_x(ways, lengths),
            "scales": np.column_stack([lengths, thickness, thickness]),
            "colors": self.color if len(self.color) > 1 else (),
        }

    def _as_many(self, name: str, rows: Rows) -> Rows:
        if len(rows) != len(self.starts):
            raise ValueError(f"{name} must be {len(self.starts)}, one for each of the starts, not {len(rows)}")
        return rows


class Arrows(_Along):
    """Many arrows. starts, vectors: (n, 3), m, in the frame of `at`. radius: of their shafts, m; 0: each by its length.
    color: one, n, or an array (n, 3) from 0 to 1."""

    look = arrow(1.0)
    vectors, radius = Field(points), Field(length)

    def _ways(self) -> Rows:
        return self._as_many("vectors", self.vectors)

    def _thickness(self, lengths: Rows) -> Rows:
        return lengths if self.radius == 0 else np.full(len(lengths), self.radius / 0.018)


class Segments(_Along):
    """Many straight lines. starts, ends: (n, 3), m, in the frame of `at`. radius: m. color: one, n, or an array (n, 3)
    from 0 to 1."""

    look = cylinder(1.0, "paint", length=1.0, offset=(0.5, 0, 0))
    ends, radius = Field(points), Field(number(1e-15, FARTHEST))

    def _ways(self) -> Rows:
        return self._as_many("ends", self.ends) - self.starts

    def _thickness(self, lengths: Rows) -> Rows:
        return np.full(len(lengths), self.radius)


def turns_from_x(ways: Rows, lengths: Rows) -> Rows:
    """Quaternions x y z w of the smallest rotations from x to directions (n, 3); none for a length of 0."""
    x, y, z = (ways / np.where(lengths > 0, lengths, 1)[:, None]).T
    turns = np.column_stack([0 * x, -z, y, 1 + x])
    turns[(x < -1 + 1e-9) | (lengths == 0)] = (0, 0, 1, 0)  # half a turn, as any
    return np.asarray(turns / np.linalg.norm(turns, axis=1)[:, None])
