# SPDX-License-Identifier: Apache-2.0
"""Rays, nearest bodies and overlaps, against geometry by hand."""

from __future__ import annotations

import math

import numpy as np
import pytest

import iota


def make_world() -> tuple[iota.World, iota.Body, iota.Body, iota.Body]:
    """A ball, a box turned by 45 degrees about y, and a rod drawn 2 cm thick."""
    system = iota.System(gravity=(0, 0, 0))
    ball = system.body(shape=iota.Sphere(0.5), position=(0, 0, 0))
    turn = (0, math.sin(math.pi / 8), 0, math.cos(math.pi / 8))
    box = system.body(shape=iota.Box((1, 1, 1)), position=(3, 0, 0), orientation=turn, kind="static")
    rod = system.body()
    rod.particle((0, 2, -1))
    rod.particle((0, 2, 1))
    world = iota.World(system)
    world.draw(rod, iota.looks.capsule(0.02, "steel"))
    return world, ball, box, rod


def test_a_ray_meets_the_first_body_at_its_surface() -> None:
    world, ball, box, rod = make_world()
    for origin, direction, body, point in (
        ((-5, 0, 0), (1, 0, 0), ball, (-0.5, 0, 0)),
        ((-5, 0.3, 0), (2, 0, 0), ball, (-0.4, 0.3, 0)),
        ((9, 0, 0), (-1, 0, 0), box, (3 + math.sqrt(0.5), 0, 0)),
        ((3, 5, 0.1), (0, -3, 0), box, (3, 0.5, 0.1)),
        ((0, 9, 0.5), (0, -1, 0), rod, (0, 2.02, 0.5)),
        ((0, 0.1, 0), (1, 0, 0), ball, (0, 0.1, 0)),
    ):
        hit = world.ray(origin, direction)
        assert hit is not None and hit.body == body
        assert hit.point == pytest.approx(point, abs=1e-5)
        assert hit.distance == pytest.approx(math.dist(origin, point), abs=1e-5)
    assert world.ray((-5, 0, 0), (1, 0, 0), bodies=[box]).body == box
    assert world.ray((-5, 0, 0), (1, 0, 0), farthest=4.4) is None
    assert world.ray((-5, 0.51, 0), (1, 0, 0)) is None
    assert world.ray((0, 9, 1.03), (0, -1, 0), bodies=[rod]) is None
    with pytest.raises(ValueError, match="direction"):
        world.ray((0, 0, 0), (0, 0, 0))


def test_random_rays_at_a_ball_meet_it_where_the_quadratic_equation_says() -> None:
    world, ball, *_ = make_world()
    random = np.random.default_rng(1)
    met = 0
    for _ in range(300):
        origin = random.normal(size=3)
        origin *= random.uniform(0.6, 5) / np.linalg.norm(origin)
        along = random.normal(size=3) * 0.2 - origin / np.linalg.norm(origin)
        along /= np.linalg.norm(along)
        middle = -origin @ along
        under = 0.25 - origin @ origin + middle * middle
        if abs(under) < 1e-4:
            continue
        hit = world.ray(origin, along, bodies=[ball])
        assert (hit is not None) == (under > 0 and middle > 0)
        if hit is not None:
            met += 1
            assert hit.distance == pytest.approx(middle - math.sqrt(under), abs=1e-4)
    assert 50 < met < 300


def test_the_nearest_body_and_those_within_a_distance_are_by_their_surfaces() -> None:
    world, ball, box, rod = make_world()
    hit = world.nearest((0, 1.4, 0.2))
    assert hit.body == rod and hit.distance == pytest.approx(0.58)
    assert hit.point == pytest.approx((0, 1.98, 0.2), abs=1e-5)
    inside = world.nearest((0.1, 0, 0))
    assert inside.body == ball and inside.distance == pytest.approx(-0.4)
    assert inside.point == pytest.approx((0.5, 0, 0), abs=1e-5)
    assert world.within((1.4, 0, 0), 0.88) == []
    assert world.within((1.4, 0, 0), 0.905) == [ball, box]
    assert world.within((0, 1, 0), 0.5001) == [ball]
    assert world.within((0, 1, 0), 0.99) == [ball, rod]
    assert iota.World(iota.System()).nearest((0, 0, 0)) is None
