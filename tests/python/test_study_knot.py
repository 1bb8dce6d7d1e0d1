# SPDX-License-Identifier: Apache-2.0
"""A rope is tied by two hands, by contact alone; the knot holds a ring by friction, and slips off without it."""

from __future__ import annotations

import numpy as np
import pytest

import iota
from iota.studies import knot


def run(made: knot.Knot, until: float) -> None:
    """To a time since the tying began, s."""
    while made.system.time < made.begun + until:
        made.world.step()


def apart(made: knot.Knot, skip: int = 2) -> float:
    """The least distance of the middle lines of rods that are not neighbors, in diameters: from both sides' nearest points, by
    alternating projections."""
    ends = np.array([[tuple(p.position) for p in rod.particles] for rod in made.rods])
    i, j = np.triu_indices(len(ends), skip + 1)
    start, along = ends[:, 0], ends[:, 1] - ends[:, 0]
    s = np.full(len(i), 0.5)

    def share(point: np.ndarray, of: np.ndarray) -> np.ndarray:
        off = ((point - start[of]) * along[of]).sum(1) / (along[of] ** 2).sum(1)
        return np.asarray(np.clip(off, 0, 1))

    for _ in range(200):
        t = share(start[i] + s[:, None] * along[i], j)
        s = share(start[j] + t[:, None] * along[j], i)
    gaps = np.linalg.norm(start[i] + s[:, None] * along[i] - start[j] - t[:, None] * along[j], axis=1)
    return float(gaps.min()) / (2 * knot.ROPE)


def lengths_of(made: knot.Knot) -> np.ndarray:
    """Of the rods, m."""
    return np.array([abs(rod.particles[0].position - rod.particles[1].position) for rod in made.rods])


@pytest.fixture(scope="module")
def tied() -> knot.Knot:
    """After both hands have pulled."""
    made = knot.Knot(knot.make_world())
    made.tie()
    nearest = []
    for time in (5.5, 8.0, 9.5, knot.HANG[0]):
        run(made, time)
        nearest.append(apart(made))
    assert min(nearest) > 0.98
    return made


def test_two_hands_tie_a_knot_that_holds_a_ring_by_friction_alone(tied: knot.Knot) -> None:
    lengths = lengths_of(tied)
    span = abs(tied.rods[0].particles[0].position - tied.rods[-1].particles[1].position)
    assert span < lengths.sum() - 0.08  # it is a knot: taut, and shorter than the rope
    saved = tied.system.snapshot()
    run(tied, knot.TIED + 2)
    assert tied.ring.position.y > 0.12 and apart(tied) > 0.98
    assert np.abs(lengths_of(tied) - lengths).max() < 1e-7

    # The same knot of a rope without friction.
    tied.system.restore(saved)
    tied.hands.clear()
    for rod in tied.rods:
        rod.material = iota.Material(friction=0.0)
    tied._take("other", tied.rods[0], -1, [(knot.HANG[1], (-0.2, knot.TOP, 0.0))])
    run(tied, knot.HANG[1])
    while tied.ring.position.y >= 0.06 and tied.system.time < tied.begun + knot.TIED + 2:
        tied.world.step()
    assert tied.ring.position.y < 0.06
