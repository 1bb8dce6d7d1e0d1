# SPDX-License-Identifier: Apache-2.0
"""Ropes of rods that lie over a post: friction holds loads up to the ratio of the capstan, judged from places."""

from __future__ import annotations

import math
from itertools import pairwise
from typing import Literal

import pytest

import iota

RADIUS, THICK, LINK, TAIL, FRICTION = 0.1, 0.008, 0.03, 6, 0.3
Kind = Literal["rods", "capsules"]


def over_a_post(
    mode: Literal["energy_keeping", "robust"],
    ratio: float,
    link_mass: float,
    kind: Kind,
    post: iota.Shape,
    moves: bool = False,
) -> tuple[iota.System, iota.Particle]:
    """Half a turn around a post along z, 1 kg at one end and `ratio` kg at the other one, which is returned."""
    system = iota.System(mode=mode)
    system.usual_material = iota.Material(friction=FRICTION)
    if moves:
        system.weld(system.body(shape=post, mass=10, orientation=("y", 90)), at=(0, 0, 0))
    else:
        system.obstacle(post, orientation=("y", 90))
    count = round(math.pi * (RADIUS + THICK) / LINK)
    turn = math.pi / count
    far = (RADIUS + THICK) / math.cos(turn / 2)
    knots = [(-far, -i * LINK, 0.0) for i in range(TAIL, 0, -1)]
    knots += [(-far * math.cos(i * turn), far * math.sin(i * turn), 0.0) for i in range(count + 1)]
    knots += [(far, -i * LINK, 0.0) for i in range(1, TAIL + 1)]
    ends: list[iota.Particle] = []
    for a, b in pairwise(knots):
        if kind == "rods":
            link = system.body()
            points = [link.particle(at, mass=link_mass / 2) for at in (a, b)]
            link.radius = THICK
        else:
            middle = tuple((x + y) / 2 for x, y in zip(a, b, strict=True))
            angle = math.degrees(math.atan2(b[1] - a[1], b[0] - a[0]))
            length = math.dist(a, b)
            link = system.body(
                shape=iota.Capsule(THICK, length), mass=link_mass, position=middle, orientation=("z", angle)
            )
            points = [link.attachment(a), link.attachment(b)]
        if ends:
            ends[-1].combine(points[0])
        ends += points
    ends[0].mass, ends[-1].mass = 1, ratio
    return system, ends[-1]


@pytest.mark.parametrize("mode", ["energy_keeping", "robust"])
@pytest.mark.parametrize("kind", ["rods", "capsules"])
@pytest.mark.parametrize(
    ("post", "moves"),
    [(iota.Cylinder(RADIUS, 2), False), (iota.Capsule(RADIUS, 2), False), (iota.Capsule(RADIUS, 2), True)],
)
@pytest.mark.parametrize(("ratio", "link_mass"), [(1.03, 0.02), (2, 0.02), (1.3, 0.002)])
def test_a_rope_of_rods_on_a_post_holds_what_its_friction_holds(
    mode: Literal["energy_keeping", "robust"], kind: Kind, post: iota.Shape, moves: bool, ratio: float, link_mass: float
) -> None:
    system, load = over_a_post(mode, ratio, link_mass, kind, post, moves)
    heights = [load.position.y]
    for _ in range(2):  # contacts of light links yield until they bear the load
        for _ in range(30):
            assert system.step(1 / 60).unconverged == 0
        heights.append(load.position.y)
    assert abs(heights[1] - heights[0]) < 4e-3
    assert abs(heights[2] - heights[1]) < 5e-4


@pytest.mark.parametrize("mode", ["energy_keeping", "robust"])
def test_a_rope_of_rods_on_a_post_slides_beyond_the_ratio_of_the_capstan(
    mode: Literal["energy_keeping", "robust"],
) -> None:
    system, load = over_a_post(mode, 3, 0.002, "rods", iota.Cylinder(RADIUS, 2))
    start = load.position.y
    for _ in range(30):
        system.step(1 / 60)
    assert load.position.y < start - 0.05
