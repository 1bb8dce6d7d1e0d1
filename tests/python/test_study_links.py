# SPDX-License-Identifier: Apache-2.0
"""Chains of links that hold each other by contact: their length under load, shaken, and hung on another peg."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from solved_steps import solved_steps

import iota
from iota.studies import links

PLACES = 120  # of a link's middle line


def build(ratio: float = links.RATIO) -> tuple[iota.World, links.Links]:
    world = links.make_world()
    return world, links.Links(world, ratio)


def middle_line(link: iota.Body) -> np.ndarray:
    """Places on it, m."""
    angles = np.linspace(0, 2 * np.pi, PLACES, endpoint=False)
    x = links.BEND * np.cos(angles) + np.copysign(links.STRETCH / 2, np.cos(angles))
    local = np.stack([x, links.BEND * np.sin(angles), 0 * x], axis=1)
    axis, w = np.array(tuple(link.orientation)[:3]), link.orientation[3]
    turned = local + 2 * np.cross(axis, np.cross(axis, local) + w * local)
    return turned + np.array(tuple(link.position))


def gap(one: iota.Body, other: iota.Body) -> float:
    """Between the wires of two links, as sampled, m: never less than it is."""
    a, b = middle_line(one), middle_line(other)
    return float(np.linalg.norm(a[:, None] - b, axis=2).min()) - 2 * links.WIRE


@pytest.mark.parametrize("ratio", [1, 50, 1000])
def test_a_chain_is_as_long_as_its_links_under_any_weight(ratio: float) -> None:
    world, made = build(ratio)
    start = made.weight.position
    for _ in solved_steps(world, 0.4):
        pass
    lengths = [abs(one.position - other.position) for one, other in pairwise(made.chain)]
    assert max(abs(length - links.PITCH) for length in lengths) < 1e-7
    assert abs(made.weight.position - start) < 1e-3, "its first link comes to lie across the leaning peg"
    force = sum(contact.force.y for contact in made.chain[0].contacts if contact.other not in made.chain)
    assert force == pytest.approx(9.81 * sum(link.mass for link in [*made.chain, made.weight]), rel=5e-3)


def test_links_that_swing_and_twist_never_pass_through_each_other() -> None:
    world, made = build()
    for step, _ in enumerate(solved_steps(world, 4.0, gap=1e-3)):
        if step % 12:
            continue
        for upper, lower in pairwise(made.chain):
            assert gap(upper, lower) > -1e-4 and abs(upper.position - lower.position) < links.PITCH + 1e-4
    assert abs(made.weight.position.x - links.PEGS[0]) < 0.3


def test_a_link_is_taken_off_its_peg_and_hung_on_the_next_one() -> None:
    world, made = build()
    for _ in solved_steps(world, 6.8, gap=1e-3):
        pass
    top = made.short[0]
    assert abs(top.position.x - links.PEGS[2]) < 0.02 and abs(top.position.y - links.HEIGHT - links.DOWN) < 0.01
    assert not made._grips
    for upper, lower in pairwise(made.short):
        assert -1e-3 < gap(upper, lower) < 2e-3
    world._state.actions["begin anew"].hook.function()
    world.step()
    assert abs(made.short[0].position.x - links.PEGS[1]) < 1e-3 and world.system.time == pytest.approx(world.dt)


def test_links_in_space_keep_momentum_and_angular_momentum() -> None:
    system = iota.System(gravity=(0, 0, 0))
    system.usual_material = iota.Material(friction=0.3)
    random = np.random.default_rng(2)
    chain = [
        system.body(
            shape=iota.Torus(links.BEND, links.WIRE, links.STRETCH), density=links.STEEL, velocity=random.normal(size=3) / 5,
            position=(0, -links.PITCH * number, 0), orientation=links.ACROSS if number % 2 else links.ALONG,
        )
        for number in range(5)
    ]  # fmt: skip

    def momenta() -> np.ndarray:
        return np.concatenate([tuple(system.momentum), tuple(system.angular_momentum)])

    before = momenta()
    for _ in range(120):
        report = system.step(1 / 120)
        assert report.unconverged == 0
    assert np.abs(momenta() - before).max() < 1e-9
    for upper, lower in pairwise(chain):
        assert gap(upper, lower) > -1e-4
        assert abs(upper.position - lower.position) < links.PITCH + 1e-4
