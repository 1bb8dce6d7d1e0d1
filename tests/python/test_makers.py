# SPDX-License-Identifier: Apache-2.0
"""What the makers of iota.builder make, realized and left to itself."""

from __future__ import annotations

import json
import math

import numpy as np
import pytest

import iota
from iota import builder, looks
from iota.builder import Structure

MAKERS = ["rope", "ring", "snake", "net", "cloth", "leaf", "cuboid", "bridge", "ladder", "tower", "tree", "soft_block"]


@pytest.mark.parametrize("name", MAKERS)
def test_a_structure_can_be_realized_saved_and_left_to_itself(name: str) -> None:
    made: Structure = getattr(builder, name)()
    assert made.problems() == []
    again = Structure.from_json(json.loads(json.dumps(made.to_json())))
    assert len(again.points) == len(made.points) and len(again.bonds) == len(made.bonds)
    system = iota.System(mode="robust")
    realized = made.realize(system)
    for _ in range(30):
        report = system.step(1 / 120)
        assert report.unconverged == 0 and report.worst_gap < 1e-6
    assert not any(bond.broken for bond in realized.bonds)


def test_nothing_moves_at_once_where_it_hangs_in_its_own_shape() -> None:
    for name in ("tower", "ladder", "rope"):
        system = iota.System()
        getattr(builder, name)().realize(system)
        before = system.positions
        for _ in range(60):
            system.step(1 / 120)
        assert np.abs(system.positions - before).max() < 1e-3, name


def test_a_bridge_keeps_its_length_and_its_ends() -> None:
    for planks, sag in ((2, 0.3), (12, 0.15), (40, 0.02)):
        made = builder.bridge(planks=planks, length=3, sag=sag)
        places = made.points.position
        ends = places[-1] - places[0]
        assert abs(ends[0]) == pytest.approx(3 * (1 - sag), rel=1e-6)
        steps = np.linalg.norm(places[2::4] - places[0::4], axis=1)
        assert steps == pytest.approx(np.full(planks, 3 / planks), rel=1e-9)


def test_cloth_tears_and_a_tower_breaks_at_their_strengths() -> None:
    system = iota.System(mode="robust")
    cloth = builder.cloth(6, 6, tear=2.0).realize(system)
    grip = system.grip(cloth.points[-1].body, target=cloth.points[-1].position)
    grip.move(cloth.points[-1].position + (0.5, -1.5, 0))
    torn = 0
    for _ in range(120):
        system.step(1 / 120)
        torn += len(system.broken)
    assert torn > 0
    system = iota.System()
    tower = builder.tower(5, strength=20).realize(system)
    top = tower.bodies[-1]
    for _ in range(60):
        system.step(1 / 120)
    assert not any(joint.broken for joint in tower.joints)
    grip = system.grip(top, target=top.center_of_mass + (3, 0, 0))
    for _ in range(60):
        system.step(1 / 120)
    assert any(joint.broken for joint in tower.joints)


def test_a_soft_block_has_the_edges_of_its_tetrahedra() -> None:
    made = builder.soft_block(cells=(2, 1, 1))
    nx, ny, nz = 3, 2, 2
    edges = sum(
        math.prod(n - d for n, d in zip((nx, ny, nz), way, strict=True))
        for way in [(1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 1, 0), (1, 0, 1), (0, 1, 1), (1, 1, 1)]
    )
    assert len(made.bonds) == edges
    assert made.points.mass.sum() == pytest.approx(300 * 0.4 * 0.3 * 0.3)


@pytest.mark.parametrize("name", sorted({*MAKERS, "chain"} - {"net", "cloth", "leaf", "soft_block"}))  # of points alone
def test_a_look_is_asked_for_each_body(name: str) -> None:
    asked: list[tuple[str, int]] = []
    made: Structure = getattr(builder, name)(look=lambda *what: asked.append(what) or looks.solid("brass"))  # type: ignore[func-returns-value]
    assert len(asked) == len(set(asked)) == len(made.bodies) > 0
    assert {made.looks[body.look] for body in made.bodies if body.look} == {looks.solid("brass")}


def test_looks_are_overridden_one_by_one() -> None:
    asked = []

    def look(what: str, number: int) -> looks.Look | None:
        asked.append((what, number))
        return looks.solid("brass") if number == 1 else None

    made = builder.tower(3, look=look)
    assert asked == [("storey", 0), ("storey", 1), ("storey", 2)]
    assert [body.look for body in made.bodies] == ["storey", "storey 1", "storey"]
    assert made.looks["storey 1"] == looks.solid("brass") and made.looks["storey"] == looks.solid("wood")


def test_wrong_numbers_are_refused_with_their_name() -> None:
    for call, text in (
        (lambda: builder.rope(length=0), "length must be above 0"),
        (lambda: builder.ring(links=2), "links must be a whole number from 3 up, not 2"),
        (lambda: builder.cloth(columns=2000, rows=2000), "at most 1000000 parts"),
        (lambda: builder.cuboid(size=(1, math.nan, 1)), "size must be finite"),
        (lambda: builder.tree(levels=10, branches=9), "too many"),
        (lambda: builder.net(spacing=math.inf), "spacing must be above 0 m and finite"),
    ):
        with pytest.raises(ValueError, match=text):
            call()
