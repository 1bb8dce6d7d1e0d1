# SPDX-License-Identifier: Apache-2.0
"""The judge of bench/contact_bench.py, and those of its scenes that take no time."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest

sys.path[:0] = [
    str(Path(__file__).resolve().parents[2] / "bench"),
    str(Path(__file__).resolve().parents[2] / "bench" / "peers"),
]

import contact_bench  # noqa: E402
from contact_engines import Iota  # noqa: E402
from contact_scene import SCENES, Thing, overlap  # noqa: E402

STRAIGHT = np.eye(3)
DIAGONAL = np.array([[1, -1, 0], [1, 1, 0], [0, 0, 2**0.5]]) / 2**0.5


@pytest.mark.parametrize(
    ("a", "b", "way", "turn", "depth"),
    [
        ((1.0,), (1.0,), (1.5, 0, 0), STRAIGHT, 0.5),
        ((1, 1, 1), (0.5,), (0.9, 0, 0), STRAIGHT, 0.1),
        ((1, 1, 1), (0.5,), (1, 1, 0), STRAIGHT, 0.5 - 0.5**0.5),
        ((1, 1, 1), (0.5,), (0.3, 0, 0), STRAIGHT, 0.7),
        ((1, 1, 1), (1, 1, 1), (0.9, 0.2, 0), STRAIGHT, 0.1),
        ((1, 1, 1), (1, 1, 1), (1.1, 0, 0), DIAGONAL, 0.5 + 0.5**0.5 - 1.1),
    ],
)
def test_the_judge_measures_overlaps(a, b, way, turn, depth) -> None:  # type: ignore[no-untyped-def]
    one, other = Thing(a, (0, 0, 0)), Thing(b, way)
    for first, second, to in ((one, other, np.array(way)), (other, one, -np.array(way))):
        turns = (STRAIGHT, turn) if first is one else (turn, STRAIGHT)
        assert overlap(first, second, np.zeros(3), turns[0], to, turns[1]) == pytest.approx(depth, abs=1e-12)


@pytest.mark.parametrize(
    "scene", ["cradle", "bounce, e = 1", "bounce, e = 0.5", "slope 0.99", "slope 1.2", "grip 20", "rope 2.3"]
)
def test_iota_passes_where_the_judge_reads_poses_alone(scene: str) -> None:
    row = contact_bench.run(scene, "iota", 60, 20.0)
    assert row["passes"], row["figure"]
    assert float(str(row["overlap_mm"])) < 1e-4


def test_a_rope_of_light_beads_is_not_lost() -> None:
    """Sweeps let a load of 4000 times the mass of a bead pull the beads through the cylinder."""
    scene = SCENES["rope 2.3"]()
    for bead in scene.things[2:-1]:
        bead.mass = 0.0006
    engine = Iota(scene, 60, "energy_keeping")
    for _ in range(45):  # by sweeps it was lost from the 38th
        assert engine.system.step(1 / 60).approximate == 0
    places, _ = engine.poses()
    links = np.linalg.norm(np.diff(places, axis=0), axis=1)
    assert links.max() < 1.001 * np.median(links)
    assert places[:, 1].max() > 1.9  # over the cylinder
