# SPDX-License-Identifier: Apache-2.0
"""Places for the atoms of a molecule from its bonds alone, for cages and others for which distance geometry finds none."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Array = NDArray[np.float64]
    Numbers = NDArray[np.int64]

ROUNDS = 400  # of relaxation
CLOSEST = 3.0  # angstrom, between atoms with at least three bonds between them
WEAKER = 0.1  # stiffness of that distance, as a share of a bond's


def lay_out(count: int, bonds: Numbers, lengths: Array, angles: Array) -> Array:
    """Places, (n, 3), angstrom. bonds: (k, 2), lengths: (k,), angstrom. angles: between the bonds of each atom, (n,), rad.

    Multidimensional scaling of the numbers of bonds between atoms (Torgerson 1952) puts a cage on a ball; then the lengths and
    angles of bonds, and the distance of all others, are improved by stress majorization (Gansner, Koren and North 2004).
    """
    steps = _steps(count, bonds)
    wanted, weight = (
        np.maximum(CLOSEST, steps.astype(float)),
        np.where(steps > 2, WEAKER / np.maximum(steps, 1) ** 2, 0.0),
    )
    for p, q, length, angle in _ends_of_angles(count, bonds, lengths, angles):
        wanted[p, q] = wanted[q, p] = length
        weight[p, q] = weight[q, p] = angle
    np.fill_diagonal(weight, 0)
    place = _scaled(steps.astype(np.float64) * (float(lengths.mean()) if len(lengths) else 1.0))
    for _ in range(ROUNDS):
        place = _improved(place, wanted, weight)
    return place


def _steps(count: int, bonds: Numbers) -> Numbers:
    """The number of bonds between any two atoms, (n, n); pieces count as near each other."""
    steps = np.full((count, count), -1)
    reached = np.eye(count, dtype=bool)
    near = np.zeros((count, count), bool)
    near[bonds[:, 0], bonds[:, 1]] = near[bonds[:, 1], bonds[:, 0]] = True
    front, number = reached.copy(), 0
    while front.any():
        steps[front] = number
        number += 1
        front = (front.astype(np.float32) @ near.astype(np.float32) > 0) & ~reached
        reached |= front
    steps[steps < 0] = number
    return steps


def _ends_of_angles(count: int, bonds: Numbers, lengths: Array, angles: Array) -> list[tuple[int, int, float, float]]:
    """Two atoms, their distance and its weight: of each bond, and of the ends of each angle, which is weaker."""
    around: list[list[tuple[int, float]]] = [[] for _ in range(count)]
    found = []
    for (p, q), length in zip(bonds.tolist(), lengths.tolist(), strict=True):
        around[p].append((q, length))
        around[q].append((p, length))
    for atom, near in enumerate(around):
        for number, (p, a) in enumerate(near):
            for q, b in near[number + 1 :]:
                found.append((p, q, float(np.sqrt(a * a + b * b - 2 * a * b * np.cos(angles[atom]))), 0.2))
    return found + [(p, q, length, 1.0) for (p, q), length in zip(bonds.tolist(), lengths.tolist(), strict=True)]


def _scaled(distance: Array) -> Array:
    """Places in space whose distances are near these."""
    count = len(distance)
    center = np.eye(count) - 1 / count
    values, vectors = np.linalg.eigh(-center @ distance**2 @ center / 2)
    place = vectors[:, -3:] * np.sqrt(np.maximum(values[-3:], 0))
    if place.shape[1] < 3:
        place = np.column_stack([place, np.zeros((count, 3 - place.shape[1]))])
    # Atoms that only differ in how they are numbered are at one place, and a plane stays a plane.
    return np.asarray(place + 0.05 * np.random.default_rng(1).standard_normal(place.shape))


def _improved(place: Array, wanted: Array, weight: Array) -> Array:
    """One step towards the wanted distances. Other atoms only push, where they are nearer."""
    difference = place[:, None] - place[None]
    distance = np.sqrt((difference**2).sum(axis=2)) + 1e-9
    is_bound = weight >= 0.2
    active = np.where(is_bound | (distance < wanted), weight, 0.0)
    move = (active * (wanted / distance - 1))[:, :, None] * difference
    return np.asarray(place + move.sum(axis=1) / np.maximum(active.sum(axis=1), 1e-9)[:, None] * 0.5)
