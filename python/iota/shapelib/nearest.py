# SPDX-License-Identifier: Apache-2.0
"""Pairs of near points."""

from __future__ import annotations

from itertools import product
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray


MOST_PAIRS = 10_000_000  # candidates of one direction to a neighboring cell


class TooManyPairsError(ValueError):
    """The points are much denser than `reach`."""


def near_pairs(places: NDArray[np.float64], reach: float) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """All pairs i < j of points nearer than `reach`: (k, 2), sorted, and their distances, (k,). places: (n, 3). Points are
    sorted into cells of that size; each cell is compared with its 13 neighbors ahead and with itself. Raises ValueError for
    points too far apart, TooManyPairsError."""
    if len(places) < 2:
        return np.empty((0, 2), int), np.empty(0)
    cells = np.floor((places - places.min(axis=0)) / reach).astype(np.int64) + 1
    size = cells.max(axis=0) + 2
    if float(size[0]) * float(size[1]) * float(size[2]) > 2**62:
        raise ValueError("the points are too far apart")
    strides = np.array([size[1] * size[2], size[2], 1])
    keys = cells @ strides
    order = np.argsort(keys, kind="stable")
    keys = keys[order]
    pairs = []
    for step in product((-1, 0, 1), repeat=3):
        offset = int(np.dot(step, strides))
        if offset < 0:
            continue
        first = np.searchsorted(keys, keys + offset)
        last = np.searchsorted(keys, keys + offset, side="right")
        if offset == 0:
            first = np.arange(len(keys)) + 1
        counts = np.maximum(last - first, 0)
        if counts.sum() > MOST_PAIRS:
            raise TooManyPairsError(f"more than {MOST_PAIRS} pairs of points are near each other")
        i = np.repeat(np.arange(len(keys)), counts)
        j = np.arange(len(i)) - np.repeat(np.cumsum(counts) - counts, counts) + np.repeat(first, counts)
        p, q = order[i], order[j]
        distance = np.linalg.norm(places[p] - places[q], axis=1)
        is_near = distance < reach
        pairs.append((np.sort(np.stack([p, q], axis=1)[is_near], axis=1), distance[is_near]))
    found = np.concatenate([rows for rows, _ in pairs])
    distances = np.concatenate([values for _, values in pairs])
    order = np.lexsort((found[:, 1], found[:, 0]))
    return found[order], distances[order]
