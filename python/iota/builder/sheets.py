# SPDX-License-Identifier: Apache-2.0
"""Makers of thin, wide structures: net, cloth, leaf. Their points are bodies of their own."""

from __future__ import annotations

import math
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from iota.builder.dressing import check, check_counts, place
from iota.builder.points import Vector
from iota.builder.structure import Structure
from iota.colors import ColorLike

if TYPE_CHECKING:
    from numpy.typing import NDArray


def _grid(
    made: Structure, corner: Vector, columns: int, rows: int, spacing: float, mass: float, color: ColorLike
) -> NDArray[np.int64]:
    """Adds points from a corner along x and down; returns their numbers, (rows, columns)."""
    row, column = np.indices((rows, columns))
    places = place("corner", corner) + spacing * np.stack([column, -row, 0 * row], axis=-1)
    numbers = made.points.add(places.reshape(-1, 3), mass / (rows * columns), radius=0.08 * spacing, color=color)
    return np.array(numbers).reshape(rows, columns)


def _pairs(p: NDArray[np.int64], q: NDArray[np.int64]) -> list[tuple[int, int]]:
    return list(zip(p.ravel().tolist(), q.ravel().tolist(), strict=True))


def net(
    columns: int = 9,
    rows: int = 7,
    spacing: float = 0.12,
    corner: Vector = (-0.5, 2.0, 0),
    mass: float = 0.5,
    break_force: float = math.inf,
    color: ColorLike = (0.75, 0.6, 0.35),
) -> Structure:
    """Knots with ropes between them, inextensible and without compression; the upper two corners are nailed. spacing:
    m. mass: of all, kg. break_force: of a rope, N."""
    check(spacing=spacing, mass=mass)
    check_counts(2, columns=columns, rows=rows)
    made = Structure()
    knots = _grid(made, corner, columns, rows, spacing, mass, color)
    for p, q in _pairs(knots[:, :-1], knots[:, 1:]) + _pairs(knots[:-1], knots[1:]):
        made.tie("rope", p, q, break_force=break_force)
    made.nail(int(knots[0, 0]), int(knots[0, -1]))
    made.group("net", knots.ravel().tolist())
    return made


def cloth(
    columns: int = 16,
    rows: int = 12,
    spacing: float = 0.08,
    corner: Vector = (-0.6, 2.0, 0),
    mass: float = 0.3,
    stiffness: float = 100.0,
    damping: float = 0.02,
    tear: float = math.inf,
    color: ColorLike = (0.75, 0.2, 0.2),
) -> Structure:
    """Knots with springs along threads, weaker ones across the cells against shear and over two cells against bending
    (Provot 1995). A spring breaks above `tear` N. spacing: m. mass: of all, kg. stiffness: of a
    thread, N/m; damping: N s/m. Its upper edge is nailed; its points are the group "cloth"."""
    check(spacing=spacing, mass=mass, stiffness=stiffness)
    check_counts(2, columns=columns, rows=rows)
    made = Structure()
    knots = _grid(made, corner, columns, rows, spacing, mass, color)
    threads = _pairs(knots[:, :-1], knots[:, 1:]) + _pairs(knots[:-1], knots[1:])
    shears = _pairs(knots[:-1, :-1], knots[1:, 1:]) + _pairs(knots[:-1, 1:], knots[1:, :-1])
    bends = _pairs(knots[:, :-2], knots[:, 2:]) + _pairs(knots[:-2], knots[2:])
    for pairs, share in ((threads, 1.0), (shears, 0.3), (bends, 0.1)):
        for p, q in pairs:
            made.bond(p, q, "spring", stiffness=share * stiffness, damping=share * damping, break_force=share * tear)
    made.nail(*knots[0].tolist())
    made.group("cloth", knots.ravel().tolist())
    return made


def leaf(
    length: float = 0.3,
    width: float = 0.12,
    ribs: int = 7,
    stem: Vector = (0, 1.5, 0),
    mass: float = 0.01,
    stiffness: float = 20.0,
    color: ColorLike = (0.35, 0.6, 0.2),
) -> Structure:
    """A midrib along x with ribs to both sides, in the outline of a leaf, held by springs; a wind may act on its group
    "leaf". length, width: m. mass: of all, kg. stiffness: N/m."""
    check(length=length, width=width, mass=mass, stiffness=stiffness)
    check_counts(2, ribs=ribs)
    made = Structure()
    along = np.linspace(0, 1, ribs + 2)
    half = width / 2 * np.sin(math.pi * along**0.8)
    zero = 0 * along
    rows = [np.stack([length * along, zero, side * half], axis=1) for side in (0, 1, -1)]
    rows = [rows[0], rows[1][1:-1], rows[2][1:-1]]
    count = sum(map(len, rows))
    numbers = [
        list(made.points.add(place("stem", stem) + row, mass / count, radius=0.012 * length, color=color))
        for row in rows
    ]
    mid, left, right = numbers
    pairs = [(p, q, 2.0) for line in numbers for p, q in pairwise(line)]
    pairs += [(p, q, 3.0) for p, q in zip(mid, mid[2:], strict=False)]  # against bending of the midrib
    for side in (left, right):
        pairs += [(mid[i + 1], q, 1.0) for i, q in enumerate(side)] + [(mid[i], q, 1.0) for i, q in enumerate(side)]
        pairs += [(mid[-1], side[-1], 1.0)]
    pairs += [(p, q, 0.5) for p, q in zip(left, right, strict=True)]  # against folding
    for p, q, share in pairs:
        made.bond(p, q, "spring", stiffness=share * stiffness, damping=0.002 * stiffness)
    made.group("leaf", range(count))
    return made
