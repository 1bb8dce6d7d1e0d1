# SPDX-License-Identifier: Apache-2.0
"""Nothing that is drawn passes through anything else in a study, for its first seconds or its story."""

from __future__ import annotations

import numpy as np
import pytest
from penetration import Drawn

import iota
from iota import looks, studies
from iota.studies import shoal

USUAL = 0.25  # s, between two looks
EACH = {"lab": 1.0, "museum": 1.0}  # a room of 65 000 triangles; 900 bodies
MOST = 0.03  # share of the smaller shape
# A fish that feeds is between leaves, and fish do not know of weed. Blocks that are hit and turn fast may get into each
# other, and are eased out within 0.1 s: docs/contact.md, Not here yet. So may what falls on a heap. An acrobat's own limbs do not touch,
# nor do the threads of a flag.
KNOWN = {"museum": 0.2, "crowd": 0.4, "undersea": 0.2, "wrecking-ball": 0.15, "pour": 0.35}
SECONDS = {"museum": 3.0, "undersea": 16.0, "molecule": 13.0, "lab": 5.0, "pour": 4.0, "capstan": 3.0, "knot": 2.0}
STYLES = {"chain": ("rope", "chain")}
OTHERS = {"shoal"}  # a thousand fish: at their start below, later in test_study_cloth


@pytest.mark.parametrize("name", sorted(set(studies.names()) - OTHERS))
def test_nothing_passes_through_anything(name: str) -> None:
    world = studies.module(name).build()
    styles = [Drawn(world, style) for style in STYLES.get(name, ("",))]
    for step in range(round(SECONDS.get(name, 8.0) / world.dt)):
        if step % round(EACH.get(name, USUAL) / world.dt) == 0:
            for drawn in styles:
                assert drawn.overlaps(KNOWN.get(name, MOST)) == []
        world.step()


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
