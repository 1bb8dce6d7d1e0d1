# SPDX-License-Identifier: Apache-2.0
"""How deep things lie in each other is found. Studies are looked at while they go on, in test_studies.py."""

from __future__ import annotations

import numpy as np
import pytest
from penetration import Drawn

import iota
from iota import looks
from iota.studies import shoal

MOST = 0.03  # share of the smaller shape


def test_no_fish_starts_in_another_one_even_in_a_crowd() -> None:
    assert Drawn(shoal.build()).overlaps(MOST) == []
    crowd = shoal.apart(np.random.default_rng(0), 2000, 0.3)
    gaps = np.linalg.norm((crowd[:, None] - crowd) / shoal.ROOM, axis=2)
    assert (gaps[np.triu_indices(len(crowd), 1)] > 1).all()


def test_balls_that_overlap_are_found_and_those_that_touch_are_not() -> None:
    world = iota.World(iota.System(gravity=(0, 0, 0)))
    left, right = (world.system.body(shape=iota.Sphere(0.5), mass=1, position=(x, 2, 0)) for x in (0, 0.9))
    world.add_static(looks.box((1, 1, 1)), (0, 1.05, 0))
    drawn = Drawn(world)
    found = {(each.a, each.b): each for each in drawn.overlaps(0.01)}
    assert found[left, right].depth == pytest.approx(0.1, abs=0.01)
    assert sorted(each.depth for each in found.values())[0] == pytest.approx(0.05, abs=0.01)  # in the box
    left.set_pose((-0.2, 2.1, 0))
    assert [each for each in drawn.overlaps(0.01) if each.a == left] == []
