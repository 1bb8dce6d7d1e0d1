# SPDX-License-Identifier: Apache-2.0
"""Shapes as Python sees them: sizes, plain data, distances; the samples that the page is checked against."""

from __future__ import annotations

import json
import math
import runpy
from pathlib import Path
from typing import get_args

import pytest

import iota
from iota import looks, shapes

ROOT = Path(__file__).resolve().parents[2]
SAMPLES = json.loads((ROOT / "tests" / "shapes" / "samples.json").read_text())
KINDS = get_args(iota.Shape)


def test_the_samples_are_the_distances_of_the_engine() -> None:
    made = runpy.run_path(str(ROOT / "tests" / "shapes" / "make_samples.py"))["samples"]()
    assert {sample["kind"] for sample in made} == {kind.kind for kind in KINDS}, "each shape has a sample"
    assert len(made) == len(SAMPLES)
    for sample, stored in zip(made, SAMPLES, strict=True):
        assert {**sample, "distances": None} == {**stored, "distances": None}
        assert sample["distances"] == pytest.approx(stored["distances"], rel=1e-9, abs=1e-12 * stored["scale"])


@pytest.mark.parametrize(
    "shape",
    [
        iota.Sphere(0.5),
        iota.Box((1, 2, 3), rounding=0.1),
        iota.Torus(1, 0.1, stretch=0.4),
        iota.HalfSpace(),
        iota.Mesh.convex_hull([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]),
    ],
    ids=lambda shape: shape.kind,
)
def test_a_shape_comes_back_from_json(shape: iota.Shape) -> None:
    text = json.dumps(shapes.to_json(shape))
    assert shapes.from_json(json.loads(text)) == shape


def test_a_description_that_is_no_shape_is_refused() -> None:
    with pytest.raises(ValueError, match=r"must be one of sphere, box, .* not 'blob'"):
        shapes.from_json({"kind": "blob"})
    with pytest.raises(ValueError, match="a box is described wrongly by width"):
        shapes.from_json({"kind": "box", "width": 3})
    with pytest.raises(ValueError, match="the radius of a sphere must be between"):
        shapes.from_json({"kind": "sphere", "radius": -1})


def test_shapes_are_values() -> None:
    box = iota.Box((1, 2, 3))
    assert box == iota.Box((1, 2, 3), rounding=0) != iota.Box((1, 2, 3), 0.1)
    assert box != iota.Ellipsoid((1, 2, 3))
    assert len({box, iota.Box((1, 2, 3)), iota.Sphere(1)}) == 2
    assert repr(box) == "Box(size=(1.0, 2.0, 3.0), rounding=0.0)"
    assert eval(repr(box), {"Box": iota.Box}) == box
    assert box.size == (1, 2, 3) and box.numbers == (1, 2, 3, 0) and box.sizes == ("size", "rounding")
    with pytest.raises(AttributeError):
        box.size = (3, 2, 1)
    with pytest.raises(ValueError, match=r"rounding of a box .* must not be above half its least edge"):
        iota.Box((1, 2, 3), 0.6)


def test_distances_and_nearest_points_are_in_the_frame_of_the_shape() -> None:
    cone = iota.Cone(1, 2)
    assert cone.distance((1.5, 0, 0)) == pytest.approx(0.5)
    assert cone.closest((-2, 0.5, 0)) == pytest.approx((-1, 0.5, 0))
    assert iota.HalfSpace((0, 1, 0)).distance((7, -0.25, 3)) == pytest.approx(-0.25)


def test_a_half_space_has_no_mass() -> None:
    with pytest.raises(ValueError, match="a half-space has no volume, so no mass"):
        iota.HalfSpace().mass_properties  # noqa: B018
    system = iota.System()
    ground = system.body("static", shape=iota.HalfSpace(), position=(0, 1, 0))
    assert ground.solids[0].shape == iota.HalfSpace()
    with pytest.raises(ValueError, match="static or scripted"):
        system.body(shape=iota.HalfSpace())
    with pytest.raises(ValueError, match="can only be static or scripted"):
        ground.kind = "dynamic"


def test_bounds_are_the_least_box_and_a_look_is_as_long_as_its_shape() -> None:
    corners = [(0, 0, 0), (0.7, 0, 0), (0, 1, 0), (0, 0, 1)]
    for shape, low, high, length in [
        (iota.Sphere(0.5), (-0.5, -0.5, -0.5), (0.5, 0.5, 0.5), 1.0),
        (iota.Box((1, 2, 3), rounding=0.1), (-0.5, -1, -1.5), (0.5, 1, 1.5), 1.0),
        (iota.Cylinder(0.1, 2), (-1, -0.1, -0.1), (1, 0.1, 0.1), 2.0),
        (iota.Capsule(0.1, 2), (-1.1, -0.1, -0.1), (1.1, 0.1, 0.1), 2.0),  # of its cylinder
        (iota.Torus(1, 0.1, stretch=0.4), (-1.3, -1.1, -0.1), (1.3, 1.1, 0.1), 2.6),
        (iota.Ellipsoid((1, 2, 3)), (-0.5, -1, -1.5), (0.5, 1, 1.5), 1.0),
        (iota.Mesh.convex_hull(corners), (0, 0, 0), (0.7, 1, 1), 0.7),
    ]:
        assert tuple(shape.bounds[0]) == pytest.approx(low) and tuple(shape.bounds[1]) == pytest.approx(high), shape
        assert looks.Look(shape).length == pytest.approx(length), shape
    assert iota.HalfSpace().bounds[0].y == -math.inf and looks.Look(iota.HalfSpace()).length == 1


def test_any_shape_is_a_look() -> None:
    look = looks.Look(iota.Cone(0.1, 0.3), "wood", color="#aa3311")
    assert look.describe() | {"kind": "cone", "sizes": [0.1, 0.3], "material": "wood"} == look.describe()
    assert looks.cylinder(0.1).of_length(3).shape == iota.Cylinder(0.1, 3)
    assert looks.cylinder(0.1, length=2).of_length(3).shape == iota.Cylinder(0.1, 2)
    assert looks.sphere(0.1).of_length(3).shape == iota.Sphere(0.1)


def test_a_point_stays_on_the_cylinder_that_is_drawn() -> None:
    system = iota.System(gravity=(0, 0, 0))
    bead = system.body().particle((0.2, 0.5, 0), mass=1, velocity=(0, 0, 2))
    system.on_surface(bead, iota.Cylinder(0.5, 1, rounding=0.1))
    for _ in range(400):
        system.step(0.01)
    assert math.hypot(bead.position.y, bead.position.z) == pytest.approx(0.5, abs=1e-6)
    assert abs(bead.velocity) == pytest.approx(2, rel=1e-9)
    with pytest.raises(ValueError, match="has sharp edges"):
        system.on_surface(bead, iota.Cylinder(0.5, 1))
