# SPDX-License-Identifier: Apache-2.0
"""Graphs of points and bonds: connected pieces, and bonds outside of rings."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Numbers = NDArray[np.int64]


def pieces(count: int, edges: Numbers) -> Numbers:
    """The connected piece of each of `count` points, numbered in the order of their first points: (count,)."""
    part = np.arange(count)
    while len(edges):  # the lowest number spreads along the edges
        lowest = part.copy()
        np.minimum.at(lowest, edges[:, 0], part[edges[:, 1]])
        np.minimum.at(lowest, edges[:, 1], part[edges[:, 0]])
        lowest = lowest[lowest]
        if (lowest == part).all():
            break
        part = lowest
    return np.unique(part, return_inverse=True)[1]


def bridges(count: int, edges: Numbers) -> NDArray[np.bool_]:
    """The bridges: edges without which their two ends are not connected (Tarjan 1974). (k,)"""
    neighbors: list[list[tuple[int, int]]] = [[] for _ in range(count)]
    for number, (p, q) in enumerate(edges.tolist()):
        neighbors[p].append((q, number))
        neighbors[q].append((p, number))
    found = np.zeros(len(edges), bool)
    entered, lowest = [-1] * count, [0] * count
    clock = 0
    for root in range(count):
        if entered[root] >= 0:
            continue
        entered[root] = lowest[root] = clock
        clock += 1
        stack = [(root, -1, iter(neighbors[root]))]
        while stack:
            point, came, ahead = stack[-1]
            for other, edge in ahead:
                if edge == came:
                    continue
                if entered[other] >= 0:
                    lowest[point] = min(lowest[point], entered[other])
                    continue
                entered[other] = lowest[other] = clock
                clock += 1
                stack.append((other, edge, iter(neighbors[other])))
                break
            else:
                stack.pop()
                if stack:
                    above = stack[-1][0]
                    lowest[above] = min(lowest[above], lowest[point])
                    found[came] = lowest[point] > entered[above]
    return found
