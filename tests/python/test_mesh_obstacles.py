# SPDX-License-Identifier: Apache-2.0
"""Bodies in rooms, valleys and hollows of triangles: as between planes, by places of their surfaces that nobody else computes."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

import iota

Array = NDArray[np.float64]
MATERIAL = iota.Material(friction=0.3)


def step_shape(size: float) -> iota.Mesh:
    """An L, which is not convex."""
    outline = [(0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2)]
    corners = [((x - 0.8) * size, (y - 0.8) * size, z * size) for z in (-0.5, 0.5) for x, y in outline]
    triangles = []
    for a, b, c in ((0, 1, 2), (0, 2, 3), (0, 3, 4), (0, 4, 5)):
        triangles += [(6 + a, 6 + b, 6 + c), (a, c, b)]
    for k in range(6):
        following = (k + 1) % 6
        triangles += [(k, following, 6 + following), (k, 6 + following, 6 + k)]
    return iota.Mesh(corners, triangles)


def shapes() -> dict[str, iota.Shape]:
    hull = np.random.default_rng(1).normal(size=(40, 3)) * 0.15
    return {
        "sphere": iota.Sphere(0.2),
        "capsule": iota.Capsule(0.1, 0.5),
        "box": iota.Box((0.3, 0.3, 0.3)),
        "cylinder": iota.Cylinder(0.2, 0.3),
        "cone": iota.Cone(0.2, 0.4),
        "ellipsoid": iota.Ellipsoid((0.4, 0.5, 0.6)),
        "torus": iota.Torus(0.2, 0.05),
        "hull": iota.Mesh.convex_hull(hull),
        "step": step_shape(0.15),
    }


class Thrown:
    """A body with points of its surface."""

    def __init__(self, system: iota.System, shape: iota.Shape, position: tuple[float, ...], turn: tuple[float, ...]):
        cloud = np.random.default_rng(0).normal(size=(500, 3))
        self.body = system.body(shape=shape, mass=1, position=position, orientation=turn)
        self.system = system
        center = np.array(self.body.center_of_mass) - position
        self.points = np.array([shape.closest(place) for place in cloud]) - Rotation.from_quat(turn).inv().apply(center)

    def surface(self) -> Array:
        return np.array(self.body.center_of_mass) + Rotation.from_quat(self.body.orientation).apply(self.points)


def two_planes(normals: list[tuple[int, int]], at: tuple[float, float], as_mesh: bool) -> iota.System:
    """Planes that meet in a line along z, with outward normals in x and y."""
    system = iota.System(threads=1)
    system.usual_material = MATERIAL
    if not as_mesh:
        for x, y in normals:
            system.obstacle(iota.HalfSpace((x, y, 0)), position=(*at, 0), material=MATERIAL)
        return system
    corners: list[tuple[float, ...]] = [(*at, -5), (*at, 5)]
    triangles = []
    for (x, y), (away_x, away_y) in zip(normals, reversed(normals), strict=True):
        # Each goes away from the line towards the outside of the other one.
        along = np.array((away_x, away_y)) - (x * away_x + y * away_y) * np.array((x, y)) / (x * x + y * y)
        first = len(corners)
        corners += [(at[0] + 5 * along[0], at[1] + 5 * along[1], z) for z in (-5, 5)]
        triangles += [(0, 1, first + 1), (0, first + 1, first)]
    system.obstacle(iota.Mesh(corners, triangles, closed=False), material=MATERIAL)
    return system


@pytest.mark.parametrize("scene", ["room", "groove"])
@pytest.mark.parametrize("kind", ["sphere", "capsule", "box", "cylinder", "ellipsoid", "torus"])
def test_a_corner_of_triangles_is_as_two_planes(kind: str, scene: str) -> None:
    """Each feature had only the nearest face: a cylinder sank 9 cm into the floor where it touched a wall, too."""
    is_room = scene == "room"
    places = []
    for as_mesh in (False, True):
        normals, at = ([(0, 1), (-1, 0)], (1.0, 0.0)) if is_room else ([(1, 1), (-1, 1)], (0.0, 0.0))
        system = two_planes(normals, at, as_mesh)
        thrown = Thrown(system, shapes()[kind], (0, 0.4, 0) if is_room else (0.1, 0.7, 0), (0.1, 0.2, 0.3, 0.9))
        thrown.body.velocity = (2, 0, 0.3) if is_room else (0, 0, 0.5)
        places.append([])
        for _ in range(180):
            system.step(1 / 120)
            places[-1].append(thrown.surface())
    deep = [max(float((np.array(at) - points[:, :2]).dot(n).max()) for points in places[1]) for n in normals]
    assert max(deep) < 2e-3 * np.sqrt(2)
    assert np.abs(np.array(places[0]) - places[1]).max() < 1e-4


def landscape(count: int, height: float) -> tuple[iota.Mesh, Array]:
    """Hills of 10 m, with steep valleys, and the heights at their corners."""
    x = np.linspace(-5, 5, count)
    along, across = np.meshgrid(x, x, indexing="ij")
    heights = height * np.sin(4 * along) * np.cos(4 * across)
    return iota.Mesh.height_field(heights, (10, 10)), heights


def height_at(heights: Array, x: Array, z: Array) -> Array:
    count = len(heights)
    u, v = ((p + 5) * (count - 1) / 10 for p in (x, z))
    i, k = (np.clip(np.floor(p).astype(int), 0, count - 2) for p in (u, v))
    u, v = u - i, v - k
    here, next_x, next_z, far = heights[i, k], heights[i + 1, k], heights[i, k + 1], heights[i + 1, k + 1]
    low = here + u * (next_x - here) + v * (next_z - here)
    high = far + (1 - u) * (next_z - far) + (1 - v) * (next_x - far)
    return np.where(u + v <= 1, low, high)


@pytest.mark.parametrize("kind", ["sphere", "capsule", "box", "cylinder", "cone", "ellipsoid", "torus", "hull"])
def test_bodies_stay_on_steep_hills(kind: str) -> None:
    """They were up to 14 cm in hills, also at rest, and rings fell through."""
    for count, seed in ((30, 6), (100, 11), (100, 2)):
        mesh, heights = landscape(count, 0.4)
        system = iota.System(threads=1)
        system.usual_material = MATERIAL
        system.obstacle(mesh, material=MATERIAL)
        random = np.random.default_rng(seed)
        start = (0.1 * random.normal(), 0.9, 0.1 * random.normal())
        thrown = Thrown(system, shapes()[kind], start, tuple(Rotation.random(random_state=seed).as_quat()))
        thrown.body.velocity = tuple(random.normal(size=3))
        deepest = 0.0
        for _ in range(60):
            system.step(1 / 120, 4)
            points = thrown.surface()
            deepest = max(deepest, float((height_at(heights, points[:, 0], points[:, 2]) - points[:, 1]).max()))
        assert deepest < 0.025, (count, seed)
        assert np.linalg.norm(np.array(thrown.body.position)) < 3


@pytest.mark.parametrize("mode", ["energy_keeping", "robust"])
@pytest.mark.parametrize("width", [0.02, 0.1, 0.2])
def test_a_ring_hangs_on_a_strip_of_triangles(width: float, mode: str) -> None:
    """An open mesh has no inside, and the middle of the ring is below."""
    corners = [(x, 0, z) for x in (-width / 2, width / 2) for z in (-1, 1)]
    heights = []
    for shape in (iota.Mesh(corners, [(0, 1, 3), (0, 3, 2)], closed=False), iota.Box((width, 0.002, 2))):
        system = iota.System(mode=mode, threads=1)
        system.usual_material = MATERIAL
        is_box = isinstance(shape, iota.Box)
        system.obstacle(shape, position=(0, -0.001 if is_box else 0, 0), material=MATERIAL)
        ring = system.body(shape=iota.Torus(0.2, 0.03), mass=1, position=(0, -0.165, 0), orientation=("y", 17))
        system.step(1 / 120, 240)
        heights.append(ring.position.y)
    assert heights[0] == pytest.approx(heights[1], abs=1e-4)
    assert -0.17 < heights[0] < -0.13


def crate() -> tuple[iota.Mesh, list[tuple[Array, Array]]]:
    """An open box with thick walls as one mesh, and its walls as boxes with their middles and halves."""
    inner, outer, low, high = 0.6, 0.7, -0.1, 0.5
    around = [(-1, -1), (1, -1), (1, 1), (-1, 1)]
    corners = [(x * outer, y, z * outer) for y in (low, high) for x, z in around]
    corners += [(x * inner, y, z * inner) for y in (0, high) for x, z in around]
    quads = [(0, 1, 2, 3), (8, 11, 10, 9)]
    for k in range(4):
        n = (k + 1) % 4
        quads += [(k, 4 + k, 4 + n, n), (8 + k, 8 + n, 12 + n, 12 + k), (4 + k, 12 + k, 12 + n, 4 + n)]
    triangles = [each for a, b, c, d in quads for each in ((a, b, c), (a, c, d))]
    walls = [(np.array((0, -0.05, 0)), np.array((outer, 0.05, outer)))]
    for side in (-0.65, 0.65):
        walls += [(np.array((side, 0.25, 0)), np.array((0.05, 0.25, outer)))]
        walls += [(np.array((0, 0.25, side)), np.array((outer, 0.25, 0.05)))]
    return iota.Mesh(corners, triangles), walls


@pytest.mark.parametrize("kind", ["cylinder", "ellipsoid", "torus", "step"])
def test_toys_stay_in_a_crate_that_is_one_mesh_and_turns(kind: str) -> None:
    """An L of triangles, whose edges crossed those of the crate, went 5 cm into its walls and stayed there."""
    mesh, walls = crate()
    for seed in (0, 5, 8):
        random = np.random.default_rng(seed)
        system = iota.System(threads=1)
        system.usual_material = MATERIAL
        system.obstacle(iota.HalfSpace((0, 1, 0)), material=MATERIAL)
        box = system.body(shape=mesh, mass=20, position=(0, 0.1, 0))
        center = np.array(box.center_of_mass) - (0, 0.1, 0)
        box.angular_velocity = (0, 1.5, 0)
        turn = tuple(Rotation.random(random_state=seed).as_quat())
        thrown = Thrown(system, shapes()[kind], (0, 0.55, 0), turn)
        thrown.body.velocity = tuple(random.normal(size=3) * (3, 0, 3))
        for _ in range(240):
            system.step(1 / 120)
        seen = Rotation.from_quat(box.orientation).inv().apply(thrown.surface() - np.array(box.center_of_mass)) + center
        deep = max(float((half - np.abs(seen - middle)).min(axis=1).max()) for middle, half in walls)
        assert deep < 5e-3, seed


def test_land_of_heights_refuses_what_is_no_grid() -> None:
    for heights, size, words in (
        ([1, 2, 3], (1, 1), "rows along x of columns along z"),
        ([[1, 2]], (1, 1), "not 1 rows of 2 columns"),
        ([[1, np.nan], [1, 2]], (1, 1), "row 0, column 1"),
        ([[1, 2], [1, 2]], (1, 0), "two positive lengths"),
    ):
        with pytest.raises(ValueError, match=words):
            iota.Mesh.height_field(heights, size)
    with pytest.raises(ValueError, match="heights must be an array of numbers, not 'hills'"):
        iota.Mesh.height_field("hills", (1, 1))  # type: ignore[arg-type]
    with pytest.raises(TypeError, match="size must be 2 numbers, not 5"):
        iota.Mesh.height_field([[1, 2], [1, 2]], 5)  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="closed mesh"):
        iota.System().body(shape=iota.Mesh.height_field([[0, 1], [1, 0]], (1, 1)))
