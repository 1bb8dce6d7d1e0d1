# SPDX-License-Identifier: Apache-2.0
"""Draws bodies as lines of Braille dots."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from iota._core import Body, Box, Mesh, Shape, Solid, System
from iota.frames import axes_of

Points = NDArray[np.float64]

YAW, PITCH = 0.4, 0.24  # rad: the first view of the page
DOTS = ((0x01, 0x08), (0x02, 0x10), (0x04, 0x20), (0x40, 0x80))  # of a Braille cell, by row and column
PLAIN, MARKED = "\x1b[0m", "\x1b[38;5;209m"


class Picture:
    """Dots in cells of 2 x 4. middle: world, m. size: of the scene, m."""

    def __init__(self, columns: int, rows: int, middle: Points, size: float) -> None:
        self._cells = np.zeros((rows, columns), np.uint8)
        self._marks = np.zeros((rows, columns), bool)
        self._middle = middle
        self._scale = min(2 * columns, 4 * rows) / (1.1 * size) if size > 0 else 1.0

    def draw(self, line: Points, is_marked: bool) -> None:
        """Straight pieces through points, (n, 3), m."""
        across, above, _ = view_axes()
        rows, columns = self._cells.shape
        x = columns + (line - self._middle) @ across * self._scale
        y = 2 * rows - (line - self._middle) @ above * self._scale
        for begin in range(max(len(line) - 1, 1)):
            end = min(begin + 1, len(line) - 1)
            count = int(min(max(abs(x[end] - x[begin]), abs(y[end] - y[begin])), 4096)) + 1
            for dot_x, dot_y in zip(
                np.linspace(x[begin], x[end], count + 1).astype(int),
                np.linspace(y[begin], y[end], count + 1).astype(int),
                strict=True,
            ):
                if 0 <= dot_x < 2 * columns and 0 <= dot_y < 4 * rows:
                    self._cells[dot_y // 4, dot_x // 2] |= DOTS[dot_y % 4][dot_x % 2]
                    self._marks[dot_y // 4, dot_x // 2] |= is_marked

    def rows(self) -> Iterator[str]:
        """Lines of text; what is marked is colored."""
        for cells, marks in zip(self._cells, self._marks, strict=True):
            row = ""
            for number, (cell, mark) in enumerate(zip(cells, marks, strict=True)):
                if mark != (marks[number - 1] if number else False):
                    row += MARKED if mark else PLAIN
                row += chr(0x2800 + int(cell)) if cell else " "
            yield row + PLAIN


def view_axes() -> tuple[Points, Points, Points]:
    """To the right, up, and towards the viewer: unit vectors of the world."""
    across = np.array([np.cos(YAW), 0, -np.sin(YAW)])
    toward = np.array([np.sin(YAW) * np.cos(PITCH), np.sin(PITCH), np.cos(YAW) * np.cos(PITCH)])
    return across, np.cross(toward, across), toward


def drawing(system: System, columns: int, rows: int) -> list[str]:
    """A system as lines of text without colors, those at the top and bottom that are empty left out."""
    lines = [line for _, drawn in lines_of_all(system) for line in drawn]
    if not lines or columns < 1 or rows < 1:
        return []
    picture = Picture(columns, rows, *frame_of(lines))
    for line in lines:
        picture.draw(line, is_marked=False)
    drawn = [row.removesuffix(PLAIN).rstrip() for row in picture.rows()]
    filled = [number for number, row in enumerate(drawn) if row]
    return drawn[filled[0] : filled[-1] + 1] if filled else []


def lines_of_all(system: System) -> list[tuple[Body, list[Points]]]:
    return [(body, list(lines_of(body))) for body in system.bodies if body.kind != "inactive"]


def frame_of(lines: Sequence[Points]) -> tuple[Points, float]:
    """The middle of the box around lines and its diagonal, m."""
    points = np.concatenate(lines)
    low, high = points.min(axis=0), points.max(axis=0)
    return (low + high) / 2, max(float(np.linalg.norm(high - low)), 1e-9)


def lines_of(body: Body) -> Iterator[Points]:
    """The outline of a body: the outlines of its solids, or else a line through its particles. World, m."""
    if body.solids:
        for solid in body.solids:
            yield from outline(solid)
    elif body.particles:
        yield np.array([list(particle.position) for particle in body.particles])


def support_points(shape: Shape, directions: Points) -> Points:
    """The points of a bounded shape, or of its convex hull, that are farthest in some directions, in its frame: (n, 3), m."""
    # The point nearest to a far place is the farthest in its direction.
    far = 1e3 * max(abs(number) for number in shape.numbers)
    return np.array([tuple(shape.closest(tuple(far * direction))) for direction in directions])


@lru_cache(maxsize=256)
def silhouettes(shape: Shape) -> list[Points]:
    """The outlines of a shape, or of its convex hull, seen along each axis of its frame; none of an endless shape. m."""
    if not np.isfinite(shape.bounds).all():
        return []
    turn = np.linspace(0, 2 * np.pi, 25)
    circle = np.stack([0 * turn, np.cos(turn), np.sin(turn)], axis=1)
    return [support_points(shape, np.roll(circle, axis, axis=1)) for axis in range(3)]


def outline(solid: Solid) -> Iterator[Points]:
    shape = solid.shape
    if isinstance(shape, Box):
        corners = np.array([[x, y, z] for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)]) * list(
            shape.size
        )
        local = [corners[[a, b]] for a in range(8) for b in range(a + 1, 8) if (a ^ b).bit_count() == 1]
    elif isinstance(shape, Mesh):
        local = [np.asarray(shape.vertices)[[*corners, corners[0]]] for corners in np.asarray(shape.triangles)[:500]]
    else:
        local = silhouettes(shape)
    axes = axes_of(solid.orientation)
    for line in local:
        yield line @ axes.T + list(solid.position)
