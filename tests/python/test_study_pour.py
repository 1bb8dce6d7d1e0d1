# SPDX-License-Identifier: Apache-2.0
"""What is poured: all of it lies in the tray, beside each other and asleep, and the scales show its weight."""

from __future__ import annotations

import time

import numpy as np
import pytest
from penetration import Drawn

import iota
from iota.studies import pour

GRAINS = 48  # of a test


@pytest.fixture(scope="module")
def poured() -> tuple[iota.World, pour.Pour, np.ndarray]:
    """After the slide was pulled and all lies still; and the places of all grains in each step, m."""
    world = pour.make_world()
    made = pour.Pour(world, GRAINS)
    places, times = [], []
    while world.system.time < 5.0:
        began = time.perf_counter()
        report = world.step()
        times.append(time.perf_counter() - began)
        assert report is not None and report.unconverged == 0
        assert report.warnings == [], "what comes to rest has not gained energy"
        places.append([tuple(grain.center_of_mass) for grain in made.grains])
    p50, p99 = np.quantile(times, [0.5, 0.99]) * 1e3
    print(f"{GRAINS} grains: {p50:.1f} ms a step, {p99:.1f} ms in one of a hundred")
    return world, made, np.array(places)


def test_all_of_it_lands_in_the_tray_and_nothing_goes_through_a_wall(
    poured: tuple[iota.World, pour.Pour, np.ndarray],
) -> None:
    _, made, places = poured
    closed = round(1.2 / pour.STEP) - 1
    assert (places[:closed, :, 1] > pour.LIP - pour.SPOUT).all(), "the slide holds all"
    within, wide = np.abs(places[..., [0, 2]]).max(axis=2), np.where(places[..., 1] > pour.LIP, pour.MOUTH, pour.TRAY)
    assert (within < wide / 2 - 0.5 * pour.SIZE).all(), "in the hopper, the spout or the tray"
    assert places[..., 1].min() > pour.SCALES + pour.THICK + 0.5 * pour.SIZE
    assert (places[-1, :, 1] < pour.SCALES + pour.TALL).all()
    assert made.opened == pytest.approx(pour.TRAVEL, abs=0.01)


def test_at_rest_it_sleeps_and_the_scales_show_its_weight(poured: tuple[iota.World, pour.Pour, np.ndarray]) -> None:
    _, made, places = poured
    assert all(grain.kind == "resting" for grain in made.grains)
    assert np.abs(places[-1] - places[-60]).max() == 0
    mass = made.tray.mass + sum(grain.mass for grain in made.grains)
    assert made.weight() == pytest.approx(9.81 * mass, rel=0.01)


def test_at_rest_no_grain_is_in_another_one(poured: tuple[iota.World, pour.Pour, np.ndarray]) -> None:
    world, _, _ = poured
    assert Drawn(world).overlaps(0.01) == []


def test_the_slide_is_pushed_back_and_all_is_filled_in_again(
    poured: tuple[iota.World, pour.Pour, np.ndarray],
) -> None:
    world, made, _ = poured
    world._state.actions["slide"].hook.function()
    for _ in range(120):
        world.step()
    assert made.opened == pytest.approx(0, abs=0.01)
    world._state.actions["fill"].hook.function()
    for body, (place, _) in made.start.items():
        assert abs(body.position - place) < 1e-9
    assert made.opened == pytest.approx(0, abs=1e-9)
