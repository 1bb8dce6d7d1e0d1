# SPDX-License-Identifier: Apache-2.0
from __future__ import annotations

import json
import math
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

import iota


@pytest.mark.parametrize("links", [1, 2, 24])
def test_a_chain_has_its_length_mass_and_place(system: iota.System, links: int) -> None:
    chain = iota.builder.chain(links, length=2.4, top=(0, 3, 0), direction=(0, -2, 0), mass=1.2).realize(system).bodies
    assert len(chain) == links and system.articulate_count == 1
    assert sum(link.mass for link in chain) == pytest.approx(1.2)
    assert chain[0].particles[0].position == (0, 3, 0)
    assert chain[-1].particles[1].position == pytest.approx((0, 0.6, 0))
    assert chain[0].particles[0].is_nailed
    for upper, lower in pairwise(chain):
        assert lower.particles[0] in upper.particles[1].ring
    assert system.validate() == [] and system.energy.kinetic == 0


def test_a_chain_need_not_be_nailed(system: iota.System) -> None:
    chain = iota.builder.chain(links=3, nailed=False).realize(system).bodies
    assert not any(p.is_nailed for link in chain for p in link.particles)


def test_a_long_chain_is_quick_to_build(system: iota.System) -> None:
    chain = iota.builder.chain(links=2000).realize(system).bodies
    report = system.step()
    assert len(chain) == 2000 and report.articulates == 1 and report.worst_gap < 1e-9


# --- the common data structure ------------------------------------------------------------------------------------------


def swing() -> iota.builder.Structure:
    """A board on two rods, a spring below it, a free point and a lamp that turns."""
    s = iota.builder.Structure()
    for x, side in ((-0.3, "left"), (0.3, "right")):
        top, end = s.point((x, 2, 0), name=f"{side} nail"), s.point((x, 1, 0))
        s.body(top, end, name=side, rod=(0.4, 0.01), look="steel")
        s.nail(top)
    ends = [s.point((x, 1, 0), mass=0) for x in (-0.3, 0.3)]
    board = s.body(*ends, shape=iota.Box((0.7, 0.04, 0.3)), density=700, position=(0, 1, 0), name="board", look="wood")
    for p, q in zip((1, 3), ends, strict=True):
        s.hinge(p, q)
    ground = s.point((0, 0.2, 0), mass=3)
    s.bond(ends[0], ground, "spring", stiffness=40, length=None, name="spring")
    lamp = s.body(shape=iota.Sphere(0.1), mass=1, position=np.array([0, 3, 0]), name="lamp")
    s.joint("revolute", lamp, at=(0, 3, 0), axis=(0, 1, 0), motor=(2, 5), name="axle")
    s.tie("rope", ends[1], ground, break_force=100, name="rope")
    s.group("feelers", [0, ground])
    s.looks = {"steel": {"*": iota.looks.cylinder(0.01)}, "wood": {"*": iota.looks.solid("wood")}}
    assert board == 2 and s.problems() == []
    return s


def test_a_structure_becomes_bodies_hinges_bonds_and_joints(system: iota.System) -> None:
    made = swing().realize(system)
    assert system.validate() == [] and len(made.bodies) == 4 and len(made.points) == 7
    assert made["board"].mass == pytest.approx(700 * 0.7 * 0.04 * 0.3) and made["left"].mass == pytest.approx(0.4)
    assert made["left nail"].is_nailed and made["axle"].angle.motor == (2, 5)
    assert made.points[4] in made.points[1].ring and made["rope"].kind == "rope" and made["rope"].break_force == 100
    assert made["spring"].parameters["length"] == pytest.approx(abs(made.points[4].position - made.points[6].position))
    assert made.groups["feelers"].particles == [made.points[0], made.points[6]]
    assert made.points[6].body.particles == [made.points[6]] and made.points[6].mass == 3
    for _ in range(30):
        report = system.step()
    assert report.worst_gap < 1e-9 and made["axle"].angle.speed == pytest.approx(2, rel=0.01)
    with pytest.raises(KeyError):
        made["door"]
    again = (swing() + (5, 0, 0)).realize(system)
    assert len(again.groups["feelers"]) == 4 and again["lamp"] != made["lamp"] and system.validate() == []


def test_a_structure_fills_a_group_that_is_there_and_empty(system: iota.System) -> None:
    feelers = system.group("feelers")
    assert swing().realize(system).groups["feelers"] == feelers and len(feelers) == 2


def test_a_structure_is_drawn_in_its_looks(system: iota.System) -> None:
    world = iota.World(system)
    made = swing().realize(system, world)
    drawn = world._state.visuals.looks
    assert list(drawn.values()) == [{"*": iota.looks.cylinder(0.01)}, {"*": iota.looks.solid("wood")}]
    assert made["board"].solids


def test_a_moved_copy_leaves_the_original(system: iota.System) -> None:
    one = swing()
    other = one + (1, 0, -2)
    made, moved = one.realize(system), other.realize(iota.System())
    for here, there in zip(made.points, moved.points, strict=True):
        assert there.position - here.position == pytest.approx((1, 0, -2))
    assert moved["lamp"].center_of_mass == pytest.approx((1, 3, -2)) and moved["axle"].position == pytest.approx(
        (1, 3, -2)
    )


def test_merging_renumbers_and_renames(system: iota.System) -> None:
    row = iota.builder.Structure()
    for number in range(3):
        shift = row.merge(swing() + (2 * number, 0, 0), prefix=f"{number} ")
        assert shift == (7 * number, 4 * number)
    assert row.problems() == []
    made = row.realize(system)
    assert system.articulate_count == 3 * 3  # swing, free point, lamp
    assert made["2 board"].center_of_mass == pytest.approx((4, 1, 0)) and len(made.groups["feelers"]) == 6
    assert made["1 axle"].a == made["1 lamp"] and system.validate() == []
    twice = swing()
    twice.looks["wood"] = {"*": iota.looks.solid("brass")}
    with pytest.raises(ValueError, match="different looks 'wood'"):
        row.merge(twice)


def belt() -> iota.builder.Structure:
    """Two wheels on axles; the small one turns three times as fast."""
    s = iota.builder.Structure()
    axles = []
    for name, x in (("large", 0.0), ("small", 1.0)):
        wheel = s.body(shape=iota.Sphere(0.1), mass=1, position=(x, 0, 0), name=name)
        axles.append(s.joint("revolute", wheel, at=(x, 0, 0), axis=(0, 0, 1)))
    s.couple((axles[0], "angle", 3), (axles[1], "angle", -1), name="belt")
    return s


def test_couplings_of_joints_are_merged_saved_and_kept(system: iota.System) -> None:
    row = iota.builder.Structure()
    for number in range(2):
        row.merge(belt() + (0, number, 0), prefix=f"{number} ")
    made = iota.builder.Structure.from_json(json.loads(json.dumps(row.to_json()))).realize(system)
    assert made["1 belt"] == made.couplings[1] and made["1 belt"].kind == "coupling"
    made["0 large"].angular_velocity = (0, 0, 1)
    made["1 large"].angular_velocity = (0, 0, -2)
    system.step(1 / 120)
    for number in range(2):
        speeds = [made[f"{number} {wheel}"].angular_velocity.z for wheel in ("large", "small")]
        assert speeds[1] == pytest.approx(3 * speeds[0], rel=1e-5) and abs(speeds[0]) > 0.05


def test_couplings_of_missing_joints_are_named() -> None:
    s = belt()
    s.couple((5, "angle", 1))
    s.couple((0, "length", 1), name="odd")  # type: ignore[arg-type]
    assert s.problems() == [
        "coupling 1: there is no joint 5, only 2 joints",
        "coupling 2 \"odd\": a coordinate must be one of angle, slide, second_angle, not 'length'",
    ]
    s = belt()
    s.couple((0, "slide", 1), name="none")
    with pytest.raises(ValueError, match=r'coupling 1 "none": .*slide'):
        s.realize(iota.System())


def test_a_structure_comes_back_from_json(system: iota.System) -> None:
    text = json.dumps(swing().to_json(), allow_nan=False)
    back = iota.builder.Structure.from_json(json.loads(text))
    assert back.problems() == [] and json.dumps(back.to_json()) == text
    other = iota.System()
    swing().realize(system), back.realize(other)
    for _ in range(5):
        assert system.step().energy.total == other.step().energy.total
    assert system.state_hash() == other.state_hash()


def test_a_structure_of_another_version_is_refused_and_one_of_before_versions_is_read() -> None:
    """Each version has a file that it made."""
    file = Path(__file__).parent / "golden" / "structure_1.json"
    saved = json.loads(file.read_text())
    assert swing().to_json() == saved
    assert iota.builder.Structure.from_json(saved).problems() == []
    del saved["version"]
    assert iota.builder.Structure.from_json(saved).to_json() == swing().to_json()
    for version in (2, 0, "1", None, [1]):
        with pytest.raises(ValueError, match=r"the structure has version .* reads version 1"):
            iota.builder.Structure.from_json({"version": version, "wheels": []})


def test_values_that_json_cannot_hold_are_named() -> None:
    s = swing()
    s.bond(0, 1, lambda bond: (0, 0, 0), name="pull")
    with pytest.raises(ValueError, match='SoftBond 1 "pull": law cannot be saved'):
        s.to_json()
    data = swing().to_json()
    for change, text in (
        ({"wheels": []}, "has no wheels"),
        ({"bodies": [{"points": [0], "weight": 3}]}, "RigidBody 0: .*weight"),
        (
            {"bodies": [{"points": [], "shape": {"kind": "egg"}, "name": "e"}]},
            'RigidBody 0 "e": the kind of a shape must be',
        ),
    ):
        with pytest.raises(ValueError, match=text):
            iota.builder.Structure.from_json(data | change)


PROBLEMS: dict[str, tuple[Callable[[iota.builder.Structure], object], str]] = {
    "point": (lambda s: s.bond(0, 99, "drag"), "bond 1: there is no point 99, only 7 points"),
    "point of a body": (lambda s: s.body(0.5, name="door"), 'body 4 "door": there is no point 0.5'),  # type: ignore[arg-type]
    "body": (lambda s: s.joint("weld", 7, at=(0, 0, 0)), "weld 1: there is no body 7, only 4 bodies"),
    "shared point": (lambda s: s.body(0, 6), "point 0 is in 2 bodies"),
    "far hinge": (lambda s: s.hinge(1, 6), r"hinge 2: points 1 and 6 are 0\.854\d* m apart"),
    "hinge in one body": (lambda s: s.hinge(0, 0), "hinge 2: points 0 and 0 are of one body"),
    "mass": (lambda s: s.points.mass.__setitem__(1, -1), "point 1: its mass must be finite and at least 0 kg, not -1"),
    "marker alone": (lambda s: s.point((9, 9, 9), mass=0), "point 7: it is a body of its own"),
    "mass of an attachment": (lambda s: s.points.mass.__setitem__(4, 1), 'body 2 "board" has its mass from its shape'),
    "position": (
        lambda s: s.points.position.__setitem__(2, math.nan),
        r"point 2: its position must be finite, not \(nan",
    ),
    "empty body": (lambda s: s.body(), "body 4 has neither points nor a shape"),
    "look": (lambda s: s.body(6, look="glass"), "body 4: there is no look 'glass'"),
    "kind": (lambda s: s.joint("screw", 0), "joint 1: kind must be one of ball"),  # type: ignore[arg-type]
    "name": (lambda s: s.point((0, 0, 0), name="board"), 'the name "board" is given 2 times'),
}


@pytest.mark.parametrize("name", PROBLEMS)
def test_errors_are_named_and_nothing_is_made(system: iota.System, name: str) -> None:
    change, text = PROBLEMS[name]
    structure = swing()
    change(structure)
    with pytest.raises(ValueError, match=text):
        structure.realize(system)
    assert system.bodies == []


def test_refusals_of_the_system_are_named_and_undone(system: iota.System) -> None:
    for change, text in (
        (lambda s: s.bond(0, 6, "spring", stifness=3, name="b"), 'bond 1 "b": .*stifness'),
        (lambda s: s.joint("revolute", 3, at=(0, 3, 0), name="j"), 'revolute 1 "j": '),
        (lambda s: s.body(6, kind="frozen"), "body 4: kind must be"),
    ):
        structure = swing()
        change(structure)
        with pytest.raises((ValueError, TypeError), match=text):
            structure.realize(system)
        assert system.bodies == [] and system.validate() == []


def test_a_body_of_several_shapes_has_them_and_the_given_inertia() -> None:
    one = iota.builder.Structure()
    shape, ball = iota.Box((0.2, 0.2, 0.2)), iota.Sphere(0.1)
    others = [(ball, (0.3, 0, 0), (0, 0, 0, 1))]
    inertia = ((0.02, 0, 0), (0, 0.03, 0), (0, 0, 0.04))
    one.body(shape=shape, mass=2, others=others, center=(0.1, 0.02, 0), inertia=inertia, spin=(0, 1, 0), name="a")
    one.body(shape=shape, mass=2, position=(2, 0, 0), others=[(ball, (2.3, 0, 0), (0, 0, 0, 1))], name="b")
    one.passing.append((0, 1))
    again = iota.builder.Structure.from_json(json.loads(json.dumps(one.to_json())))
    both = iota.builder.Structure()
    both.body(shape=ball, name="before")
    both.merge(again + (0, 5, 0))
    system = iota.System()
    made = both.realize(system)
    a, b = made["a"], made["b"]
    assert (a.mass, len(a.solids)) == (pytest.approx(2), 2)
    assert tuple(a.center_of_mass) == pytest.approx((0.1, 5.02, 0), abs=1e-12)
    assert np.array(a.inertia) == pytest.approx(np.array(inertia), abs=1e-12)
    assert tuple(a.solids[1].position) == pytest.approx((0.3, 5, 0), abs=1e-12)
    assert tuple(a.angular_velocity) == pytest.approx((0, 1, 0), abs=1e-12)
    volumes = [s.mass_properties.volume for s in (shape, ball)]
    assert b.mass == pytest.approx(2)
    assert b.center_of_mass.x == pytest.approx(2 + 0.3 * volumes[1] / sum(volumes)), "of one density"
    assert system.ignored_contacts == [(a, b)]
    assert "passing" not in both.to_json() or both.passing == [(1, 2)]


def test_what_only_is_seen_is_saved_and_bad_shapes_and_pairs_are_told_in_words() -> None:
    seen = iota.builder.Structure()
    seen.body(shape=iota.Sphere(0.1), touches=False)
    data = json.loads(json.dumps(seen.to_json()))
    system = iota.System()
    iota.builder.Structure.from_json(data).realize(system)
    assert system.bodies[0].material == iota.Material(touches="nothing")

    def told(part: dict[str, object], **more: object) -> str:
        system = iota.System()
        with pytest.raises(ValueError) as error:
            iota.builder.Structure.from_json(data | {"bodies": [data["bodies"][0] | part], **more}).realize(system)
        assert not system.bodies
        return str(error.value)

    assert "touches must be true or false, not 3" in told({"touches": 3})
    assert "each of others must be a list, not 1" in told({"others": [1]})
    assert "a shape, its place and its orientation, not [1]" in told({"others": [[1]]})
    assert "passing 0 must be two bodies, not 1" in told({}, passing=[[0]])
    assert "there is no body 'a'" in told({}, passing=[[0, "a"]])


def test_a_body_without_a_shape_has_no_inertia_of_its_own() -> None:
    wrong = iota.builder.Structure()
    wrong.body(wrong.point((0, 0, 0)), inertia=((1, 0, 0), (0, 1, 0), (0, 0, 1)))
    wrong.body(shape=iota.Sphere(0.1), inertia=((1, 0, 0), (0, 1, 0), (0, 0, 1)))
    told = "\n".join(wrong.problems())
    assert "no shape" in told and "needs a mass and a center" in told
    wrong.passing.append((0, 7))
    assert "passing 0: there is no body 7, only 2 bodies" in "\n".join(wrong.problems())
