# SPDX-License-Identifier: Apache-2.0
"""Rays, nearest bodies and overlaps, against geometry by hand."""

from __future__ import annotations

import itertools
import math
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh
from amount import TRIES_ALL
from convex_reference import distance as distance_of
from scipy.spatial.transform import Rotation
from slow_queries import SlowQueries
from test_touching import KINDS, shape_of

import iota
from iota._core import Places
from iota.shapelib import read_model


def make_world() -> tuple[iota.World, iota.Body, iota.Body, iota.Body]:
    """A ball, a box turned by 45 degrees about y, and a rod drawn 2 cm thick."""
    system = iota.System(gravity=(0, 0, 0))
    ball = system.body(shape=iota.Sphere(0.5), position=(0, 0, 0))
    turn = (0, math.sin(math.pi / 8), 0, math.cos(math.pi / 8))
    box = system.body(shape=iota.Box((1, 1, 1)), position=(3, 0, 0), orientation=turn, kind="static")
    rod = system.body()
    rod.particle((0, 2, -1))
    rod.particle((0, 2, 1))
    world = iota.World(system, ground=None)
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
        hit = world.queries.ray(origin, direction)
        assert hit is not None and hit.body == body
        assert hit.point == pytest.approx(point, abs=1e-5)
        assert hit.distance == pytest.approx(math.dist(origin, point), abs=1e-5)
    assert world.queries.ray((-5, 0, 0), (1, 0, 0), bodies=[box]).body == box
    assert world.queries.ray((-5, 0, 0), (1, 0, 0), farthest=4.4) is None
    assert world.queries.ray((-5, 0.51, 0), (1, 0, 0)) is None
    assert world.queries.ray((0, 9, 1.03), (0, -1, 0), bodies=[rod]) is None
    with pytest.raises(ValueError, match="direction"):
        world.queries.ray((0, 0, 0), (0, 0, 0))


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
        hit = world.queries.ray(origin, along, bodies=[ball])
        assert (hit is not None) == (under > 0 and middle > 0)
        if hit is not None:
            met += 1
            assert hit.distance == pytest.approx(middle - math.sqrt(under), abs=1e-4)
    assert 50 < met < 300


def test_the_nearest_body_and_those_within_a_distance_are_by_their_surfaces() -> None:
    world, ball, box, rod = make_world()
    hit = world.queries.nearest((0, 1.4, 0.2))
    assert hit.body == rod and hit.distance == pytest.approx(0.58)
    assert hit.point == pytest.approx((0, 1.98, 0.2), abs=1e-5)
    inside = world.queries.nearest((0.1, 0, 0))
    assert inside.body == ball and inside.distance == pytest.approx(-0.4)
    assert inside.point == pytest.approx((0.5, 0, 0), abs=1e-5)
    assert world.queries.within((1.4, 0, 0), 0.88) == []
    assert world.queries.within((1.4, 0, 0), 0.905) == [ball, box]
    assert world.queries.within((0, 1, 0), 0.5001) == [ball]
    assert world.queries.within((0, 1, 0), 0.99) == [ball, rod]
    assert iota.World(iota.System(), ground=None).queries.nearest((0, 0, 0)) is None


def make_crowd(count: int) -> iota.World:
    """Balls, boxes, meshes, rods and points in motion, some with looks."""
    random = np.random.default_rng(4)
    system = iota.System(gravity=(0, 0, 0))
    corners = [(-0.2, -0.2, -0.2), (0.3, 0, 0), (0, 0.3, 0), (0, 0, 0.3)]
    mesh = iota.Mesh(corners, [(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)])
    for number in range(count):
        place = random.uniform(-3, 3, 3)
        if number % 5 < 3:
            shape = (iota.Sphere(0.2), iota.Box((0.4, 0.2, 0.3), rounding=0.02), mesh)[number % 5]
            body = system.body(shape=shape, position=place)
            body.angular_velocity = random.normal(size=3)
        else:
            body = system.body()
            for _ in range(1 + number % 3):
                body.particle(place + random.uniform(-0.3, 0.3, 3))
        body.velocity = random.normal(size=3)
    world = iota.World(system, ground=None)
    world.draw(system.bodies[3::5], iota.looks.capsule(0.03, "steel"))
    return world


def test_a_crowd_in_motion_is_answered_as_one_body_after_the_other() -> None:
    world, random = make_crowd(80), np.random.default_rng(5)
    slow = SlowQueries(world)
    met = 0
    for round in range(6):
        for _ in range(15):
            place, aim = random.uniform(-4, 4, 3), world.system.bodies[random.integers(70)].position
            along = np.array(list(aim)) - place + 0.1 * random.normal(size=3)
            hit, expected = world.queries.ray(place, along), slow.ray(place, along)
            assert (hit is None) == (expected is None)
            if hit is not None and expected is not None:
                met += 1
                assert hit.body == expected.body and hit.distance == pytest.approx(expected.distance, abs=1e-4)
            near, expected = world.queries.nearest(place), slow.nearest(place)
            assert near is not None and expected is not None
            assert near.body == expected.body and near.distance == pytest.approx(expected.distance, abs=1e-9)
            assert near.point == pytest.approx(expected.point, abs=1e-9)
            assert world.queries.within(place, 0.8) == slow.within(place, 0.8)
        for _ in range(20):
            world.system.step(1 / 60)
        if round == 1:
            world.system.bodies[7].destroy()
        if round == 2:
            world.draw(world.system.bodies[::4], iota.looks.capsule(0.1, "steel"))
        if round == 3:
            world.system.bodies[0].position = (0, 0, 0)
        if round == 4:
            world.system.bodies[1].kind = "inactive"
    assert met > 20


def test_ten_thousand_bodies_take_less_than_a_tenth_of_asking_a_thousand_one_by_one() -> None:
    def least(ask: Callable[[], object], count: int) -> float:
        times = []
        for _ in range(count):
            began = time.perf_counter()
            ask()
            times.append(time.perf_counter() - began)
        return min(times)

    system = iota.System(gravity=(0, 0, 0))
    system.particle_array(np.random.default_rng(1).uniform(-5, 5, (10_000, 3)))
    world = iota.World(system, ground=None)
    few = iota.System(gravity=(0, 0, 0))
    few.particle_array(np.random.default_rng(1).uniform(-5, 5, (1000, 3)))
    slow = SlowQueries(iota.World(few, ground=None))
    for name, arguments in (
        ("ray", ((-9, 0, 0), (1, 0.1, 0.1))),
        ("nearest", ((1, 2, 3),)),
        ("within", ((1, 2, 3), 0.5)),
    ):
        quick = least(partial(getattr(world.queries, name), *arguments), 30)
        assert quick < 0.1 * least(partial(getattr(slow, name), *arguments), 3), name


def test_the_ground_a_wall_and_a_room_from_a_file_are_static_bodies(tmp_path: Path) -> None:
    world = iota.World(iota.System(gravity=(0, 0, 0)), ground=-1)
    wall = world.add_static(iota.looks.box((0.2, 4, 4)), (2, 0, 0))
    beam = world.add_strut((0, 3, -2), (0, 3, 2), iota.looks.cylinder(0.1))
    corners, faces = [(-3, 0, -3), (-3, 0, 3), (-3, 4, 3), (-3, 4, -3)], [(0, 1, 2), (0, 2, 3)]
    trimesh.Scene(trimesh.Trimesh(corners, faces)).export(tmp_path / "side.glb")
    (surface,) = world.drawings.model(read_model(tmp_path / "side.glb"), at=(0, 0, 0), solid=True)
    side = surface.at
    ball = world.system.body(shape=iota.Sphere(0.2), position=(0, 1, 0))
    ground = world.scene.ground_body
    assert world.system.obstacles == [wall, beam, side, ground] and world.system.bodies == [ball]
    assert {body.kind for body in world.system.obstacles} == {"static"}
    for along, body, distance in (((1, 0, 0), wall, 1.9), ((0, 0, 1), None, None), ((-1, 0, 0), side, 3)):
        hit = world.queries.ray((0, 0.5, 0), along)
        assert hit is None if body is None else hit.body == body
        assert hit is None or hit.distance == pytest.approx(distance, abs=1e-6)
    down = world.queries.ray((0.5, 0, 0), (0, -1, 0))
    assert down.distance == pytest.approx(1) and down.body == ground and ground.name == "ground"
    assert world.queries.nearest((0, 2.8, 1)).body == beam
    assert world.queries.nearest((0, 2.8, 1), bodies=[ball]).body == ball
    assert world.queries.overlap(iota.Box((8, 0.1, 0.1)), (0, 1, 0)) == [wall, side, ball]
    assert world.queries.overlap(iota.Box((8, 0.1, 0.1)), (0, 1, 0), bodies=[ball]) == [ball]
    half = math.sqrt(0.5)
    assert world.queries.overlap(iota.Box((8, 0.1, 0.1)), (0, 1.3, 0), (0, half, 0, half)) == []

    other = iota.System()
    other.restore(world.system.snapshot())
    met = iota.World(other).queries.ray((0, 0.5, 0), (-1, 0, 0))
    assert met.distance == pytest.approx(3), "a saved room is a room elsewhere"
    side.position = (-1, 0, 0)
    assert world.queries.ray((0, 0.5, 0), (-1, 0, 0)).distance == pytest.approx(4)
    side.destroy()
    assert world.queries.ray((0, 0.5, 0), (-1, 0, 0)) is None
    with pytest.raises(ValueError, match="convex"):
        world.queries.overlap(iota.Torus(1, 0.1), (0, 0, 0))
    with pytest.raises(ValueError, match="without surfaces"):
        world.drawings.model([], solid=True)
    with pytest.raises(ValueError, match="place of the world"):
        world.drawings.model(read_model(tmp_path / "side.glb"), at=ball, solid=True)


def test_a_closed_model_is_drawn_where_it_acts(tmp_path: Path) -> None:
    """Its body's frame has its origin at the center of mass, the file another one."""
    box = trimesh.creation.box((1, 1, 1))
    box.apply_translation((5, 0.5, 0))
    trimesh.Scene(box).export(tmp_path / "box.glb")
    world = iota.World(iota.System(), ground=None)
    (surface,) = world.drawings.model(read_model(tmp_path / "box.glb"), at=(0, 2, 0), solid=True)
    drawn = surface.points + list(surface.at.position)
    assert drawn.min(axis=0) == pytest.approx((4.5, 2, -0.5)) and drawn.max(axis=0) == pytest.approx((5.5, 3, 0.5))
    assert world.queries.ray((5, 9, 0), (0, -1, 0)).distance == pytest.approx(6, abs=1e-6)


def test_only_a_body_that_cannot_move_has_a_mesh_with_holes() -> None:
    corners, faces = [(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2)]
    with pytest.raises(ValueError, match="closed"):
        iota.Mesh(corners, faces)
    with pytest.raises(ValueError, match="names vertex 3"):
        iota.Mesh(corners, [(0, 1, 3)], closed=False)
    system, flat = iota.System(), iota.Mesh(corners, faces, closed=False)
    assert not flat.closed and iota.Mesh.convex_hull([*corners, (0, 0, 1)]).closed
    assert iota.shapes.from_json(iota.shapes.to_json(flat)) == flat
    with pytest.raises(ValueError, match="closed"):
        system.body(shape=flat)
    wall = system.body("static", shape=flat)
    with pytest.raises(ValueError, match="no mass"):
        wall.kind = "dynamic"
    assert system.obstacle(flat).solids[0].shape == flat


def test_an_obstacle_is_a_static_body_that_nothing_is_tied_to_and_that_no_sum_counts() -> None:
    system = iota.System()
    ball = system.body(shape=iota.Sphere(0.1), position=(0, 1, 0), mass=2)
    energy, rows = system.energy.total, len(system.positions)
    wall = system.obstacle(iota.Box((1, 2, 0.2)), position=(0, 1, -1), orientation=(0, 0.6, 0, 0.8))
    wall.name = "wall"
    assert (wall.kind, wall.particles, wall.mass, wall.position) == ("static", [], 0, iota.Vec3(0, 1, -1))
    assert wall.orientation == pytest.approx((0, 0.6, 0, 0.8)) and "obstacle" in repr(wall)
    assert system.energy.total == energy and len(system.positions) == rows and system.articulate_count == 1
    refused: list[Callable[[], object]] = [
        lambda: setattr(wall, "kind", "dynamic"),
        lambda: setattr(wall, "kind", "scripted"),
        lambda: wall.particle((0, 1, -1)),
        lambda: wall.particle((0, 1, -1), mass=0),
        lambda: wall.attachment((0, 1, -1)),
        lambda: wall.combine(ball),
        lambda: ball.combine(wall),
        lambda: setattr(wall, "velocity", (1, 0, 0)),
        lambda: setattr(wall, "mass", 2),
        lambda: setattr(wall, "radius", 0.1),
        lambda: wall.apply_force((0, 1, 0)),
        lambda: system.weld(ball, wall, at=(0, 1, 0)),
        lambda: system.grip(wall, (0, 0, 0), (0, 1, 0)),
    ]
    state = system.snapshot()
    for edit in refused:
        with pytest.raises(ValueError, match=r"obstacle|no particles|shape|static"):
            edit()
    assert system.snapshot() == state, "what is refused changes nothing"
    with system.edit():
        wall.position = (0, 3, 0)
    assert Places(system).ray((0, 9, 0), (0, -1, 0), 99, None)[1].y == pytest.approx(4)
    system.undo()
    assert wall.position == iota.Vec3(0, 1, -1)
    wall.active = False
    assert Places(system).ray((0, 1, -9), (0, 0, 1), 8.5, None) is None
    wall.active = True
    for _ in range(10):
        system.step(0.01)
    assert wall.position == iota.Vec3(0, 1, -1)
    wall.destroy()
    assert system.obstacles == [] and not wall.alive


def test_the_ground_comes_back_when_a_script_restores_a_state_of_before_it() -> None:
    system = iota.System()
    ball = system.body(shape=iota.Sphere(0.1), position=(0, 0.5, 0), mass=1)
    start = system.snapshot()
    world = iota.World(system, ground=0)
    for _ in range(2):
        system.restore(start)
        world.draw(system.bodies, iota.looks.sphere(0.1))
        for _ in range(200):
            world.step()
        assert ball.position.y == pytest.approx(0.1, abs=1e-3)
        assert [body.name for body in system.obstacles].count("ground") == 1
    again = iota.World(system, ground=3)
    assert again.scene.ground == 0, "a system has one ground"


def test_a_world_of_another_simulator_says_that_it_cannot_be_asked() -> None:
    class Nothing(iota.Simulator):
        bodies = ()

        def step(self, dt: float) -> None: ...
        def poses(self): ...
        def snapshot(self) -> bytes: ...
        def restore(self, snapshot: bytes) -> None: ...

    with pytest.raises(TypeError, match="simulator of its own"):
        iota.World(Nothing(), ground=None).queries.nearest((0, 0, 0))


def test_what_is_frozen_or_fixed_is_met_where_an_edit_has_put_it_whatever_happened_in_between() -> None:
    system = iota.System(gravity=(0, 0, 0))
    system.usual_material = iota.Material()
    frozen = [system.body(shape=iota.Sphere(0.5), position=(3 * k, 0, 0)) for k in range(3)]
    fixed = system.obstacle(iota.Sphere(0.5), position=(9, 0, 0))
    for body in frozen:
        body.stride = 0
    places = Places(system)

    def found_at(x: float) -> iota.Body | None:
        met = places.ray(iota.Vec3(x, 9, 0), iota.Vec3(0, -1, 0), 100.0, None)
        return None if met is None else met[0]

    for steps in (0, 1, 3):
        for body, x in zip([*frozen, fixed], (0, 3, 6, 9), strict=True):
            for to in (x + 100, x):
                body.set_pose((to, 0, 0))
                for _ in range(steps):
                    system.step(1 / 120)
                assert found_at(to) == body, (steps, x)
                assert found_at(2 * x + 100 - to) is None, (steps, x)
                if body in frozen:
                    body.stride = 0


def random_pair(kinds: tuple[str, str], seed: int) -> tuple[iota.World, list[Any], list[iota.Body], float]:
    random = np.random.default_rng(seed)
    size = 10.0 ** random.uniform(-3, 2)
    world = iota.World(iota.System(gravity=(0, 0, 0)), ground=None)
    poses = []
    for k, kind in enumerate(kinds):
        turn = random.normal(size=4)
        shape = shape_of(kind, size * random.uniform(0.3, 1), random)
        poses.append((shape, 1.5 * k * size * random.normal(size=3), Rotation.from_quat(turn).as_matrix(), turn))
    bodies = [
        world.system.body(shape=shape, density=1000, position=place, orientation=turn)
        for shape, place, _, turn in poses
    ]
    return world, poses, bodies, size


@pytest.mark.parametrize("kinds", list(itertools.combinations_with_replacement(KINDS, 2)), ids="-".join)
def test_the_gap_of_two_bodies_is_that_of_their_support_functions(kinds: tuple[str, str]) -> None:
    for seed in range(4 if TRIES_ALL else 2):
        world, poses, bodies, size = random_pair(kinds, seed)
        expected, _ = distance_of(*poses[0][:3], *poses[1][:3])
        gap, other = world.queries.gap(*bodies), world.queries.gap(*reversed(bodies))
        assert gap.distance == pytest.approx(max(0, expected), abs=1e-8 * size)
        assert other.distance == pytest.approx(gap.distance, abs=1e-8 * size)
        if gap.distance > 0:
            apart = np.array(gap.point) - gap.other_point
            assert np.linalg.norm(apart) == pytest.approx(gap.distance, abs=1e-9 * size)
            for body, point in zip(bodies, (gap.point, gap.other_point), strict=True):
                assert world.queries.nearest(point, [body]).distance == pytest.approx(0, abs=1e-6 * size)


@pytest.mark.parametrize("kinds", list(itertools.product(KINDS, KINDS)), ids="-".join)
def test_a_shape_that_goes_straight_stops_where_it_touches(kinds: tuple[str, str]) -> None:
    for seed in range(3 if TRIES_ALL else 1):
        world, ((shape, place, turn, rotation), other), bodies, size = random_pair(kinds, seed)
        way = other[1] - place + 0.2 * size * np.random.default_rng(seed).normal(size=3)
        start, unit = place - 3 * way, way / np.linalg.norm(way)

        def apart(gone: float) -> float:
            return distance_of(shape, start + gone * unit, turn, *other[:3])[0]  # noqa: B023

        hit = world.queries.cast(shape, start, way, rotation=tuple(rotation), bodies=[bodies[1]])
        if hit is None:
            assert min(apart(gone) for gone in np.linspace(0, 30 * size, 60)) > -1e-3 * size
            continue
        assert apart(hit.distance) == pytest.approx(0, abs=1e-5 * size)
        assert min(apart(share * hit.distance) for share in (0.9, 0.99, 0.9999)) > 0
        assert world.queries.nearest(hit.point, [bodies[1]]).distance == pytest.approx(0, abs=1e-5 * size)
        short = world.queries.cast(shape, start, way, 0.999 * hit.distance, tuple(rotation), [bodies[1]])
        assert short is None


def test_gaps_and_casts_know_rooms_of_triangles_rings_ropes_and_planes() -> None:
    system = iota.System(gravity=(0, 0, 0))
    world = iota.World(system, ground=None)
    floor = system.obstacle(iota.HalfSpace((0, 1, 0)))
    corners = list(itertools.product((1, 2), (0, 3), (-2, 2)))
    sides = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    triangles = [each for a, b, c, d in sides for each in ((a, b, c), (a, c, d))]
    wall = system.obstacle(iota.Mesh(corners, triangles, closed=False))
    ring = system.body(shape=iota.Torus(0.5, 0.1), mass=1, position=(-3, 2, 0))
    rope = system.body()
    rope.particle((-1, 4, -1))
    rope.particle((-1, 4, 1))
    rope.radius = 0.05
    ball = system.body(shape=iota.Sphere(0.25), mass=1, position=(0, 1, 0.3))
    assert world.queries.gap(ball, floor).distance == pytest.approx(0.75)
    assert world.queries.gap(ball, wall) == iota.world.queries.Gap(
        pytest.approx(0.75), pytest.approx((0.25, 1, 0.3)), pytest.approx((1, 1, 0.3))
    )
    assert world.queries.gap(ball, rope).distance == pytest.approx(math.hypot(1, 3) - 0.3)
    assert world.queries.gap(ring, floor).distance == pytest.approx(1.4, abs=1e-3)
    assert world.queries.gap(rope, wall).distance == pytest.approx(math.hypot(2, 1) - 0.05)
    assert world.queries.gap(wall, floor).distance == 0
    assert world.queries.gap(ring, wall).distance == pytest.approx(3.4, abs=1e-3)
    hit = world.queries.cast(iota.Sphere(0.2), (0, 1, 0.3), (1, 0, 0), bodies=[wall])
    assert hit.distance == pytest.approx(0.8) and hit.point == pytest.approx((1, 1, 0.3))
    assert world.queries.cast(iota.Box((0.4, 1, 0.4)), (-5, 2.5, 0), (0, -1, 0)).distance == pytest.approx(2)
    assert world.queries.cast(iota.Sphere(0.2), (-5, 4, 0), (1, 0, 0)).body == rope
    through = world.queries.cast(iota.Sphere(0.2), (-3, 2, -4), (0, 0, 1), bodies=[ring])
    assert through is None  # the hole has a radius of 0.4
    assert world.queries.cast(iota.Sphere(0.5), (-3, 2, -4), (0, 0, 1), bodies=[ring]).distance < 4
    assert world.queries.cast(iota.Sphere(2), (1, 2, 0), (0, 0, 1)).distance == 0
    with pytest.raises(ValueError, match="of one with itself"):
        world.queries.gap(ball, ball)
    for farthest in (math.nan, -1.0):
        for ask in (world.queries.ray, partial(world.queries.cast, iota.Sphere(0.1)), world.queries.rays):
            with pytest.raises(ValueError, match="farthest must be 0 m or more"):
                ask((0, 1, 0), (0, -1, 0), farthest=farthest)
    with pytest.raises(ValueError, match="only a convex shape"):
        world.queries.cast(iota.Torus(1, 0.1), (0, 0, 0), (1, 0, 0))


def test_many_questions_have_the_answers_of_each() -> None:
    world, *_ = make_world()
    random = np.random.default_rng(3)
    origins, directions = 4 * random.normal(size=(200, 3)), random.normal(size=(200, 3))
    rays, nearest = world.queries.rays(origins, directions), world.queries.nearest_each(origins)
    for k, (origin, direction) in enumerate(zip(origins, directions, strict=True)):
        for hits, hit in (
            (rays, world.queries.ray(origin, direction)),
            (nearest, world.queries.nearest(origin)),
        ):
            assert hits.slots[k] == (-1 if hit is None else hit.body.slot)
            assert hits.distances[k] == (math.inf if hit is None else hit.distance)
            assert hit is None or tuple(hits.points[k]) == tuple(hit.point)
    assert world.queries.rays((0, 5, 0), directions).distances.shape == (200,)
    with pytest.raises(ValueError, match="three numbers"):
        world.queries.rays(origins[:, :2], directions)
    with pytest.raises(ValueError, match="zero"):
        world.queries.rays(origins, 0 * directions)
    with pytest.raises(ValueError, match="a direction for each origin, or one for all: 200 and 3"):
        world.queries.rays(origins, directions[:3])
    with pytest.raises(ValueError, match="finite"):
        world.queries.rays((0, 0, math.nan), (1, 0, 0))


@pytest.mark.parametrize("ground", [0, None])
def test_a_question_before_the_world_begins_does_not_let_its_bodies_touch_each_other(ground: float | None) -> None:
    system = iota.System(gravity=(0, 0, 0))
    left = system.body(shape=iota.Sphere(0.1), position=(-1, 1, 0), velocity=(4, 0, 0))
    system.body(shape=iota.Sphere(0.1), position=(0, 1, 0))
    world = iota.World(system, ground=ground)
    assert world.queries.nearest((-1, 1, 0)).body == left and (world.scene.ground == 0) == (ground == 0)
    assert system.usual_material is None
    system.step(1 / 120, count=60)
    assert left.velocity.x == pytest.approx(4, rel=1e-12)
    world.advance(1)  # it begins
    assert system.usual_material == iota.Material(friction=0.6)
    world.reset()
    assert system.usual_material == iota.Material(friction=0.6)
    world.close()
