# SPDX-License-Identifier: Apache-2.0
"""Grippers hold a bar by friction alone, hand it over, and lose it where friction is too small."""

from __future__ import annotations

import numpy as np
import pytest

import iota
from iota.studies import grasp


def seen_from(palm: iota.Body, bar: iota.Body) -> np.ndarray:
    """The bar's middle in the palm's frame, m."""
    x, y, z, w = palm.orientation
    off, axis = np.array(tuple(bar.position - palm.position)), -np.array([x, y, z])
    turned: np.ndarray = off + 2 * np.cross(axis, np.cross(axis, off) + w * off)
    return turned


def held(friction: float, until: float) -> grasp.Grasp:
    """The study at a time of its story, s."""
    made = grasp.Grasp(grasp.make_world())
    made.bar.material = iota.Material(friction=friction)
    for gripper in (made.left, made.right):
        for pad in gripper.pads:
            pad.material = iota.Material(friction=friction)
    while made.world.system.time < 0.5 + until:
        made.world.step()
    return made


def test_a_bar_is_handed_over_and_back_and_nothing_slips() -> None:
    made = grasp.Grasp(grasp.make_world())
    world, table = made.world, grasp.HEIGHT + grasp.BAR[1] / 2
    for side in (1, -1):
        begun, slips, palms = world.system.time, [], (made.left.palm, made.right.palm)
        giver, taker = palms if side == 1 else palms[::-1]
        while world.system.time < begun + (0.5 if side == 1 else 4.0) + grasp.STEPS[-1] + 0.1:
            world.step()
            now = world.system.time - begun - (0.5 if side == 1 else 4.0)
            for palm, first, last in ((giver, 2.3, 5.3), (taker, 6.9, 9.5)):
                if first < now < last:
                    slips.append((palm, seen_from(palm, made.bar)))
        assert made.bar.position.x == pytest.approx(side * grasp.APART, abs=0.02)
        assert made.bar.position.y == pytest.approx(table, abs=1e-5)
        for palm in palms:
            places = [place for each, place in slips if each is palm]
            assert np.abs(np.array(places) - places[0]).max() < 1e-3


def test_a_bar_without_friction_stays_on_the_table() -> None:
    assert held(0.02, 2.6).bar.position.y < grasp.HEIGHT + grasp.BAR[1]
    assert held(0.6, 2.6).bar.position.y > grasp.HEIGHT + 0.15
