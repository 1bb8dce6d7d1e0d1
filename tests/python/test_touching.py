# SPDX-License-Identifier: Apache-2.0
"""Where and in which direction all pairs of convex shapes meet, by an independent distance of their poses."""

from __future__ import annotations

import itertools
from typing import Any

import numpy as np
import pytest
from amount import TRIES_ALL
from convex_reference import distance
from scipy.spatial.transform import Rotation

import iota

NEAR = 0.02  # in sizes, the distance from which they are shot
KINDS = ("sphere", "box", "capsule", "cylinder", "cone", "ellipsoid", "hull")


def shape_of(kind: str, size: float, random: np.random.Generator) -> Any:
    a, b, c = size * random.uniform(0.3, 1, 3)
    if kind == "hull":
        return iota.Mesh.convex_hull(size / 2 * random.normal(size=(12, 3)))
    makers = {
        "sphere": lambda: iota.Sphere(a / 2),
        "box": lambda: iota.Box((a, b, c)),
        "capsule": lambda: iota.Capsule(a / 4, b),
        "cylinder": lambda: iota.Cylinder(a / 2, b),
        "cone": lambda: iota.Cone(a / 2, b),
        "ellipsoid": lambda: iota.Ellipsoid((a, b, c)),
    }
    return makers[kind]()


class Meeting:
    """A body is shot from nearby at another one that floats. Nothing else acts, without friction and rebound."""

    def __init__(self, kinds: tuple[str, str], seed: int) -> None:
        random = np.random.default_rng(seed)
        self.size = 10.0 ** random.uniform(-3, 1)  # m
        self.system = iota.System()
        self.system.gravity = (0, 0, 0)
        self.system.usual_material = iota.Material(friction=0)
        self.shapes = [shape_of(kind, self.size * random.uniform(0.3, 1), random) for kind in kinds]
        turns = [random.normal(size=4) for _ in kinds]
        self.turns = [Rotation.from_quat(turn).as_matrix() for turn in turns]
        way = random.normal(size=3)
        way /= np.linalg.norm(way)
        places = np.array([np.zeros(3), 2.5 * self.size * way])
        for _ in range(20):  # until it is near
            apart, normal = distance(self.shapes[0], places[0], self.turns[0], self.shapes[1], places[1], self.turns[1])
            if abs(apart - NEAR * self.size) < 1e-3 * NEAR * self.size:
                break
            places[1] -= (apart - NEAR * self.size) / max(-float(normal @ way), 0.2) * way
        self.bodies = [
            self.system.body(shape=shape, density=1000, position=place, orientation=turn)
            for shape, place, turn in zip(self.shapes, places, turns, strict=True)
        ]
        self.bodies[1].velocity = -self.size * way
        self.centers = [  # of mass, in the frames of the shapes
            turn.T @ (np.array(body.center_of_mass) - place)
            for turn, body, place in zip(self.turns, self.bodies, places, strict=True)
        ]

    def distance(self, shift: Any = 0.0) -> tuple[float, Any]:
        """Of the two, the second one moved by a shift."""
        poses = []
        for number, (shape, body, center) in enumerate(zip(self.shapes, self.bodies, self.centers, strict=True)):
            turn = Rotation.from_quat(body.orientation).as_matrix()
            poses += [shape, np.array(body.center_of_mass) - turn @ center + number * np.asarray(shift), turn]
        return distance(*poses)


@pytest.mark.parametrize("kinds", list(itertools.combinations_with_replacement(KINDS, 2)), ids="-".join)
def test_bodies_act_on_each_other_where_they_touch_and_along_their_normal(kinds: tuple[str, str]) -> None:
    for seed in range(3 if TRIES_ALL else 1):
        meeting = Meeting(kinds, seed)
        target, dt = meeting.bodies[0], 1 / 1000  # in which it moves by a thousandth of the size
        for _ in range(round(5 * NEAR / dt)):
            assert meeting.system.step(dt).unconverged == 0
            if np.linalg.norm(target.velocity) > 1e-6 * meeting.size:
                break
        impulse = np.array(target.velocity)
        assert impulse.any(), "they miss each other"
        gap, _ = meeting.distance()
        along = impulse / np.linalg.norm(impulse)
        _, normal = meeting.distance(-1e-3 * meeting.size * along)
        assert abs(gap) < 1e-5 * meeting.size
        assert (
            np.linalg.norm(along - normal) < 0.01
        )  # it has moved by a part of a thousandth since the contact was found


def bars() -> dict[str, iota.Shape]:
    """Bars along x of a radius of 5 cm, or about."""
    around = np.linspace(0, 2 * np.pi, 24, endpoint=False)
    corners = [(x, 0.05 * np.cos(a), 0.05 * np.sin(a)) for x in (-0.5, 0.5) for a in around]
    return {
        "capsule": iota.Capsule(0.05, 1),
        "cylinder": iota.Cylinder(0.05, 1),
        "rounded cylinder": iota.Cylinder(0.05, 1, 0.01),
        "box": iota.Box((1, 0.1, 0.1)),
        "rounded box": iota.Box((1, 0.1, 0.1), 0.02),
        "hull": iota.Mesh.convex_hull(corners),
        "ellipsoid": iota.Ellipsoid((1, 0.1, 0.1)),
        "cone": iota.Cone(0.06, 1),
    }


@pytest.mark.parametrize("mode", ["energy_keeping", "robust"])
@pytest.mark.parametrize("kind", list(bars()))
def test_a_ring_hangs_on_a_bar_of_any_shape_and_swings(kind: str, mode: str) -> None:
    system = iota.System(mode=mode, threads=1)
    bar = iota.Material(friction=0.3)
    quarter = np.sqrt(0.5)
    system.obstacle(bars()[kind], position=(0, 2, 0), orientation=(0, quarter, 0, quarter), material=bar)
    ring = system.body(
        shape=iota.Torus(0.3, 0.04), mass=1, material=bar, position=(0.03, 1.81, 0.05), orientation=(0.1, -0.2, 0.05, 1)
    )
    heights, energies = [], []
    for _ in range(240):
        system.step(1 / 120)
        heights.append(ring.position.y)
        energies.append(system.energy.total)
    assert min(heights) > 1.74 and max(heights) < 1.82  # its inner edge is 26 cm below the top of the bar
    assert np.diff(energies).max() < 1e-5  # of 18 J


@pytest.mark.parametrize("mode", ["energy_keeping", "robust", "plausible", "accurate"])
@pytest.mark.parametrize(("size", "pull"), [(0.1, 1), (0.15, 1), (1, 10), (1, 20)])
def test_a_thin_ring_stays_on_its_bar_though_it_could_fall_past_it_in_a_step(
    mode: Any, size: float, pull: float
) -> None:
    """`robust` put it against the other side of the bar, where its distance is the same, and told nothing."""
    system = iota.System(mode=mode)
    system.usual_material = iota.Material(friction=0.3)
    system.body("static", shape=iota.Capsule(0.008 * size, 0.3 * size), position=(0, 1, 0))
    height = 1 - 0.044 * size
    ring = system.body(
        shape=iota.Torus(0.06 * size, 0.008 * size), density=7800, position=(0, height, 0), orientation=("y", 90)
    )
    system.step(1 / 60)
    system.gravity = (0, -9.81 * pull, 0)
    for _ in range(30):
        assert system.step(1 / 60).unconverged == 0
    assert ring.position.y == pytest.approx(height, abs=1e-6)


@pytest.mark.parametrize("kind", ["cylinder", "box", "hull"])
def test_two_links_of_solids_hold_each_other_by_a_ring(kind: str) -> None:
    """A heavy bar hangs in a ring that hangs on a bar; all of it moves."""
    system = iota.System(threads=1)
    material = iota.Material(friction=0.3)
    quarter = np.sqrt(0.5)
    along_z = (0, quarter, 0, quarter)
    system.obstacle(bars()[kind], position=(0, 2, 0), orientation=along_z, material=material)
    system.body(shape=iota.Torus(0.3, 0.04), mass=0.5, material=material, position=(0, 1.795, 0))
    load = system.body(shape=bars()[kind], mass=20, material=material, position=(0, 1.58, 0), orientation=along_z)
    load.velocity = (0.5, 0, 0)
    for _ in range(360):
        system.step(1 / 120)
    assert load.position.y == pytest.approx(1.59, abs=0.12)


def rails_of_triangles() -> tuple[list[tuple[float, ...]], list[tuple[int, int, int]]]:
    """Two bars along z with a square section of 10 cm, 1 m apart, whose upper faces are at 0.55 m."""
    sides = [(0, 1, 3), (0, 3, 2), (4, 6, 7), (4, 7, 5), (0, 4, 5), (0, 5, 1)]
    sides += [(2, 3, 7), (2, 7, 6), (0, 2, 6), (0, 6, 4), (1, 5, 7), (1, 7, 3)]
    corners: list[tuple[float, ...]] = []
    triangles = []
    for middle in (-0.5, 0.5):
        triangles += [tuple(corner + len(corners) for corner in side) for side in sides]
        corners += itertools.product((middle - 0.05, middle + 0.05), (0.45, 0.55), (-1.5, 1.5))
    return corners, triangles


@pytest.mark.parametrize("is_closed", [True, False])
def test_beams_of_any_shape_lie_across_rails_of_triangles(is_closed: bool) -> None:
    beams = {
        "box": (iota.Box((2, 0.1, 0.1)), 0.05),
        "rounded box": (iota.Box((2, 0.1, 0.1), 0.02), 0.05),
        "plank": (iota.Box((2, 0.05, 0.6)), 0.025),
        "capsule": (iota.Capsule(0.05, 2), 0.05),
        "cylinder": (iota.Cylinder(0.05, 2), 0.05),
        "hull": (iota.Mesh.convex_hull(list(itertools.product((-1, 1), (-0.05, 0.05), (-0.05, 0.05)))), 0.05),
    }
    for kind, (shape, half) in beams.items():
        system = iota.System(threads=1)
        system.usual_material = iota.Material(friction=0.5)
        rails = iota.Mesh(*rails_of_triangles(), closed=is_closed)
        system.obstacle(rails, material=system.usual_material)
        beam = system.body(shape=shape, mass=1, position=(0.02, 0.7, 0.03))
        system.step(1 / 120, 240)
        assert beam.position.y == pytest.approx(0.55 + half, abs=1e-6), kind
        assert abs(beam.position.x - 0.02) < 1e-2, kind


@pytest.mark.parametrize("mode", [None, "robust", "accurate"])
@pytest.mark.parametrize("rate", [60, 480])
def test_a_spring_between_two_boxes_that_touch_draws_none_into_the_other(mode: Any, rate: int) -> None:
    """What it holds became unknowns of the boxes, so that they lost their contacts for a step: 30 mm of 100 stayed for ever."""
    system = iota.System() if mode is None else iota.System(mode=mode)
    system.usual_material = iota.Material(friction=0)
    system.obstacle(iota.HalfSpace((0, 1, 0)))
    boxes = [system.body(shape=iota.Box((0.1, 0.1, 0.1)), mass=0.3, position=(0.1 * k, 0.05, 0)) for k in range(2)]
    ends = boxes[0].attachment((-0.05, 0.05, 0)), boxes[1].attachment((0.15, 0.05, 0))
    system.bond(*ends, "spring", stiffness=400, length=0.1, damping=0.5)
    for _ in range(20):
        system.step(1 / rate)
        assert abs(boxes[1].position - boxes[0].position) > 0.1 - 1e-6
        assert min(box.position.y for box in boxes) > 0.05 - 1e-6
