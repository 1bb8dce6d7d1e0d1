# SPDX-License-Identifier: Apache-2.0
"""Joints, rods and ropes as a script makes, reads, changes and ends them."""

import math
import re
from pathlib import Path
from typing import Literal

import numpy as np
import pytest

import iota


def hanging_box() -> tuple[iota.System, iota.Body]:
    system = iota.System()
    return system, system.body(shape=iota.Box((0.2, 0.4, 0.3)), mass=2, position=(0, -0.5, 0))


def run(system: iota.System, seconds: float, dt: float = 1 / 120) -> iota.types.StepReport:
    for _ in range(round(seconds / dt)):
        report = system.step(dt)
    assert system.validate() == []
    return report


def test_a_joint_has_its_bodies_place_axis_and_reaction() -> None:
    system, box = hanging_box()
    joint = system.revolute(box, at=(0, 0, 0), axis=(0, 0, 2))
    run(system, 0.2)
    assert (joint.kind, joint.a, joint.b, joint.active, joint.broken) == ("revolute", box, None, True, False)
    assert joint.axis == pytest.approx((0, 0, 1))
    assert joint.position == pytest.approx((0, 0, 0), abs=1e-9)
    assert joint.force == pytest.approx((0, 2 * 9.81, 0), abs=1e-6)
    assert joint.torque == pytest.approx((0, 0, 0), abs=1e-6)
    assert joint.gap < 1e-9
    assert joint in system.constraints
    assert repr(joint) == "<Constraint 0: revolute of body 0 and the world>"


def test_limits_motor_friction_and_spring_can_change_while_it_runs() -> None:
    system, box = hanging_box()
    joint = system.revolute(box, at=(0, 0, 0), axis=(0, 0, 1), motor=(3, 100), limits=(-1, 1))
    assert joint.angle.limits == (-1, 1)
    assert joint.angle.motor == (3, 100)
    run(system, 0.5)
    assert joint.angle.value == pytest.approx(1, abs=1e-6)
    joint.angle.limits = None
    run(system, 0.5)
    assert joint.angle.speed == pytest.approx(3, rel=1e-3)
    joint.angle.motor = None
    joint.angle.friction = 50
    run(system, 1)
    assert joint.angle.speed == pytest.approx(0, abs=1e-4)
    joint.angle.friction = 0
    joint.angle.spring = (40, 10, 0.5)
    assert joint.angle.spring == (40, 10, 0.5)
    run(system, 10)
    angle = float(joint.angle)
    assert 40 * (0.5 - angle) == pytest.approx(2 * 9.81 * 0.5 * math.sin(angle), abs=1e-3)
    assert joint.angle.effort == pytest.approx(40 * (0.5 - angle), abs=1e-3)


@pytest.mark.parametrize("coefficient", [0.3, 0.9])
def test_a_slider_on_a_slope_sticks_or_slides_by_its_friction_coefficient(coefficient: float) -> None:
    slope, mass = 0.5, 2
    system = iota.System()
    box = system.body(shape=iota.Box((0.2, 0.2, 0.2)), mass=mass)
    down = (math.cos(slope), -math.sin(slope), 0)
    joint = system.prismatic(box, at=(0, 0, 0), axis=down, friction_coefficient=coefficient)
    assert joint.slide.friction_coefficient == coefficient
    run(system, 1)
    pull, most = mass * 9.81 * math.sin(slope), coefficient * mass * 9.81 * math.cos(slope)
    assert joint.slide.efforts["friction"] == pytest.approx(-min(pull, most), abs=1e-3)
    assert joint.slide.speed == pytest.approx(max(0, pull - most) / mass, abs=1e-4)
    joint.slide.friction_coefficient = 0
    before = joint.slide.speed
    run(system, 0.5)
    assert joint.slide.speed - before == pytest.approx(9.81 * math.sin(slope) * 0.5, abs=1e-3)


def test_two_coordinates_of_a_cylindrical_joint() -> None:
    system, box = hanging_box()
    joint = system.cylindrical(
        box, at=(0, -0.5, 0), axis=(0, 1, 0), angle={"motor": (2, 10)}, slide={"limits": (-1, 0.5), "friction": 1}
    )
    assert joint.slide.friction == 1
    run(system, 2)
    assert joint.slide.value == pytest.approx(-1, abs=1e-6)
    assert joint.angle.value == pytest.approx(4, rel=1e-2)
    with pytest.raises(AttributeError, match="a weld has no angle"):
        _ = system.weld(system.body(shape=iota.Sphere(0.1), position=(0, -0.5, 3)), box, at=(0, -0.5, 1)).angle


def test_switched_off_a_joint_lets_go_and_switched_on_it_brings_back() -> None:
    system, box = hanging_box()
    joint = system.ball(box, at=(0, -0.3, 0))
    joint.active = False
    run(system, 0.2)
    assert box.center_of_mass.y < -0.6
    joint.active = True
    run(system, 0.1)
    assert joint.gap < 1e-9
    assert joint.position == pytest.approx((0, -0.3, 0), abs=1e-9)
    joint.destroy()
    assert not joint.alive
    assert len(box.particles) == 4, "its markers are gone with it"
    with pytest.raises(iota.StaleIdError, match="constraint 0 is gone"):
        _ = joint.force


def test_a_joint_ends_with_its_body_and_when_its_bodies_become_one() -> None:
    system, box = hanging_box()
    other = system.body(shape=iota.Sphere(0.1), position=(0, -1, 0))
    joint = system.weld(other, box, at=(0, -0.8, 0))
    report = box.combine(other)
    assert not joint.alive
    assert any("weld 0 ended" in note for note in report.notes)
    hinge = system.revolute(box, at=(0, 0, 0), axis=(1, 0, 0))
    box.destroy()
    assert not hinge.alive
    assert system.validate() == []


def test_rod_and_rope_join_particles() -> None:
    system = iota.System()
    hook = system.body(kind="static").particle((0, 0, 0))
    ball = system.body().particle((0, -1, 0), mass=3)
    rope = system.rope(hook, ball, 1.5)
    run(system, 2)
    assert rope.length == 1.5
    assert ball.position.y == pytest.approx(-1.5, abs=1e-6)
    assert rope.force.y == pytest.approx(-3 * 9.81, abs=1e-3), "it pulls the hook down"
    rope.length = 1
    run(system, 0.1)
    assert ball.position.y >= -1.0 - 1e-6
    rod = system.rod(hook, ball)
    assert rod.length == pytest.approx(-ball.position.y)


@pytest.mark.parametrize("kind", ["rod", "rope"])
@pytest.mark.parametrize("made_from", ["particles", "attachments"])
def test_a_hauled_rope_tells_the_weight_that_hangs_on_it(kind: str, made_from: str) -> None:
    """It told it in the ratio of the length with which it was made and that of now, and broke by that."""
    system = iota.System()
    if made_from == "particles":
        hook, load = system.body().particle((0, 5, 0)), system.body().particle((0, 3, 0), mass=10)
        hook.nail()
    else:
        box = iota.Box((0.2, 0.2, 0.2))
        beam, crate = system.body(shape=box, position=(0, 5, 0)), system.body(shape=box, position=(0, 3, 0), mass=10)
        beam.kind = "static"
        hook, load = beam.attachment((0, 5, 0)), crate.attachment((0, 3, 0))
    line = getattr(system, kind)(hook, load)
    line.break_force = 150
    for length in (2, 1, 0.5):
        before = line.force.length
        line.length = length
        assert line.force.length == pytest.approx(before)  # of the last step
        system.step(1 / 120)
        load.body.velocity = (0, 0, 0)
        system.step(1 / 120, 2)
        assert line.force.length == pytest.approx(98.1, rel=1e-6)
    assert not line.broken


def test_joints_are_saved_and_replayed() -> None:
    system, box = hanging_box()
    joint = system.revolute(box, at=(0.1, 0, 0), axis=(0, 0, 1), friction=0.2, limits=(-0.5, 0.5))
    snapshot = system.snapshot()
    run(system, 0.5)
    there = system.state_hash()
    system.restore(snapshot)
    run(system, 0.5)
    assert system.state_hash() == there
    system.start_recording()
    joint.angle.limits = None
    system.ball(system.body(shape=iota.Sphere(0.1), position=(0.3, -0.5, 0)), box, at=(0.2, -0.5, 0))
    run(system, 0.5)
    joint.destroy()
    run(system, 0.2)
    recording = system.stop_recording()
    assert system.replay(recording) is None


def test_markers_are_carried_and_can_be_hinged_nailed_and_bonded() -> None:
    system, box = hanging_box()
    corner = box.particle((0.1, -0.3, 0.15), mass=0)
    below = box.particle((0, -0.9, 0), mass=0)
    assert box.mass == pytest.approx(2)
    corner.nail()
    bob = system.body().particle((0, -0.9, 0), mass=0.5)
    below.combine(bob)
    spring = system.bond(box.particle((0, -0.5, 0), mass=0), bob, "spring", stiffness=10)
    report = run(system, 2)
    assert report.worst_gap < 1e-8
    assert spring.alive
    report = run(system, 20)
    with pytest.raises(ValueError, match="massless and cannot leave"):
        box.particles[0].separate(corner)
    with pytest.raises(ValueError, match=r"massless.*do not reach"):
        bob.body.particle((1, 1, 1), mass=0)


def test_beads_run_on_points_and_on_functions() -> None:
    system = iota.System()
    bead = system.body().particle((-1, 1, 0))
    path = system.on_path(bead, lambda u: (u, u * u, 0), interval=(-1, 1))
    assert path.kind == "path"
    assert path.slide.limits == (0, pytest.approx(path.length))
    run(system, 0.5)
    assert bead.position.y == pytest.approx(bead.position.x**2, abs=1e-6)
    driven = system.body().particle((1, 0, 0))
    ring = [(math.cos(a), 0, math.sin(a)) for a in (math.tau * i / 40 for i in range(40))]
    loop = system.on_path(driven, ring, closed=True, motor=(1, 1e4))
    run(system, 2)
    assert loop.slide.value == pytest.approx(2, abs=0.02)
    assert driven.position == pytest.approx((math.cos(2), 0, math.sin(2)), abs=0.02)
    square = system.body().particle((0.5, 3, 0))
    system.on_path(square, [(0, 3, 0), (1, 3, 0), (1, 4, 0)], smooth=False, rounding=0.1)
    run(system, 0.1)


@pytest.mark.parametrize("budget", [0, 40])
def test_a_box_laid_on_a_plane_rests_and_each_step_without_a_solution_says_so(budget: int) -> None:
    """A face touches a plane in many points, and one row knows one of them: no step has a solution (see docs/why.md)."""
    system = iota.System()
    system.budget_iterations = budget
    box = system.body(shape=iota.Box((0.2, 0.2, 0.2)), mass=1, position=(0, 0.1 + 1e-3, 0))
    touch = system.surface_to_surface(box, iota.Box((0.2, 0.2, 0.2)), None, iota.HalfSpace((0, 1, 0)))
    reports = [system.step(1 / 60) for _ in range(4)]
    assert [report.unconverged for report in reports[1:]] == [1, 1, 1]
    assert [report.cut_short for report in reports[1:]] == [1 if budget else 0] * 3
    assert box.position == pytest.approx((0, 0.1, 0), abs=1e-6)
    assert system.energy.made < 1e-9
    assert system.validate() == []
    touch.destroy()
    assert run(system, 0.1).unconverged == 0
    assert box.position.y == pytest.approx(0.1 - 9.81 * 0.1**2 / 2, abs=1e-4)


def test_an_island_without_a_solution_costs_little_until_it_is_touched() -> None:
    """The box of the test above. It is tried in full for some steps, then after 8, 16, 32 ... steps."""
    system = iota.System()
    box = system.body(shape=iota.Box((0.2, 0.2, 0.2)), mass=1, position=(0, 0.1 + 1e-3, 0))
    system.surface_to_surface(box, iota.Box((0.2, 0.2, 0.2)), None, iota.HalfSpace((0, 1, 0)))
    iterations = []
    for _ in range(60):
        system.step(1 / 60)
        iterations.append(system.islands()[0].iterations)
    assert max(iterations) > 400
    assert sum(n > 24 for n in iterations[30:]) <= 2, iterations
    assert box.position == pytest.approx((0, 0.1, 0), abs=1e-6)
    box.velocity = (0, 1, 0)
    assert system.step(1 / 60).unconverged == 0, "a box that leaves is free at once"
    assert box.position.y == pytest.approx(0.1 + 1 / 60, abs=0.01)


def test_points_stay_on_and_within_surfaces_and_surfaces_apart() -> None:
    system = iota.System(damping=0.5)
    ball = system.body(shape=iota.Sphere(0.2), mass=1, position=(0.3, 1, 0))
    inner = system.body().particle((0.5, 0.3, 5), mass=1)
    bowl = system.inside(inner, iota.Sphere(1), at=(0, 0, 5))
    floor = system.surface_to_surface(ball, iota.Sphere(0.2), None, iota.HalfSpace())
    egg = system.body().particle((0, 2, 9))
    on_egg = system.on_surface(egg, iota.Ellipsoid((2, 4, 2)), at=(0, 0, 9))
    saddle = system.body().particle((0.1, 0.01, 20))
    valley = system.on_surface(saddle, lambda x, y, z: y - x * x, at=(0, 0, 20))
    run(system, 8)
    assert ball.center_of_mass.y == pytest.approx(0.2, abs=1e-6)
    assert floor.kind == "apart"
    assert floor.force.y == pytest.approx(9.81, abs=1e-2)
    assert inner.position.y == pytest.approx(-1, abs=1e-2)
    assert on_egg.gap < 1e-8
    assert valley.gap < 1e-8
    assert saddle.position.y == pytest.approx(saddle.position.x**2, abs=1e-8)
    assert bowl.kind == "inside"


def test_a_broken_joint_is_named_and_can_be_repaired() -> None:
    system, box = hanging_box()
    joint = system.ball(box, at=(0, -0.3, 0), break_force=30)
    run(system, 0.2)
    assert system.broken == []
    box.particles[0].apply_force((0, -200, 0))
    system.step(1 / 120)
    (broken,) = system.broken
    assert broken.constraint == joint
    assert broken.particle is None
    assert broken.force > 30
    assert joint.broken
    assert not joint.active
    assert "broken" in repr(joint)
    joint.break_force = math.inf
    joint.active = True
    run(system, 0.1)
    assert joint.gap < 1e-8


def test_a_hinge_reports_its_load_and_breaks_under_too_much() -> None:
    system = iota.System(damping=5)
    links = iota.builder.chain(links=3, length=0.3).realize(system).bodies
    run(system, 3)
    upper = links[1].particles[0]
    weight = sum(link.mass for link in links[1:]) * 9.81
    assert upper.hinge_force == pytest.approx((0, weight, 0), abs=1e-3 * weight)
    assert math.isinf(upper.break_force)
    upper.break_force = 2 * weight
    run(system, 0.1)
    assert upper in links[1].particles
    assert len(upper.ring) == 2
    links[2].particles[1].apply_force((0, -5 * weight, 0))
    system.step(1 / 120)
    (broken,) = system.broken
    assert broken.particle == upper
    assert broken.constraint is None
    assert len(upper.ring) == 1


def test_the_function_of_a_bond_may_change_joints_for_after_the_step() -> None:
    system, box = hanging_box()
    joint = system.revolute(box, at=(0, 0, 0), axis=(0, 0, 1), motor=(1, 100))
    weld = system.weld(system.body(shape=iota.Sphere(0.1), position=(0, -0.8, 0)), box, at=(0, -0.7, 0))

    def pull(_bond: iota.types.BondState) -> tuple[float, float, float]:
        joint.angle.motor = (-1, 100)
        weld.active = False
        return 0, 0, 0

    system.bond(box.particles[0], system.body(kind="static").particle((0, 5, 0)), pull)
    system.step(1 / 120)
    assert joint.angle.motor == (-1, 100)
    assert not weld.active
    run(system, 0.5)
    assert joint.angle.speed == pytest.approx(-1, rel=1e-2)


def test_a_joint_that_moves_wakes_resting_bodies() -> None:
    system, box = hanging_box()
    joint = system.revolute(box, at=(0, 0, 0), axis=(0, 0, 1), motor=(0, 100))
    box.kind = "resting"
    run(system, 0.1)
    assert box.kind == "resting"
    joint.angle.motor = (1, 100)
    run(system, 1)
    assert joint.angle.value == pytest.approx(1, abs=0.05)


def test_the_page_of_constraints_runs_and_shows_every_picture() -> None:
    docs = Path(__file__).parents[2] / "docs"
    page = (docs / "constraints.md").read_text(encoding="utf-8")
    blocks = re.findall(r"^```python\n(.*?)^```", page, re.M | re.S)
    assert blocks
    for block in blocks:
        exec(compile(block, "docs/constraints.md", "exec"), {})
    shown = re.findall(r"\]\((pictures/constraints/\w+\.svg)\)", page)
    assert sorted(shown) == sorted(str(p.relative_to(docs)) for p in (docs / "pictures" / "constraints").glob("*.svg"))


REFUSED = {
    "path of one point": (lambda s, a, b: s.on_path(b.particles[0], [(0, 0, 0)]), "2 distinct points or more, got 1"),
    "path of one place": (
        lambda s, a, b: s.on_path(b.particles[0], [(1, 1, 1)] * 5),
        "2 distinct points or more, got 1",
    ),
    "path of nan": (lambda s, a, b: s.on_path(b.particles[0], [(0, 0, 0), (math.nan, 0, 0)]), "must be finite"),
    "own path": (lambda s, a, b: s.on_path(a.particles[0], [(0, 0, 0), (1, 0, 0)], a), "is of the body that holds"),
    "flat holder": (
        lambda s, a, b: s.on_path(a.particles[0], [(0, 0, 0), (1, 0, 0)], b),
        "is a point and holds no frame",
    ),
    "flat surface": (
        lambda s, a, b: s.on_surface(a.particles[0], iota.HalfSpace((0, 0, 0))),
        "normal of a half-space must be finite and not of zero length",
    ),
    "skew frame": (
        lambda s, a, b: s.on_surface(a.particles[0], iota.HalfSpace(), orientation=(0, 0, 0, 0)),
        "orientation must be finite and not zero",
    ),
    "zero axis": (lambda s, a, b: s.revolute(a, b, at=(0, 0, 0), axis=(0, 0, 0)), "axis must have a direction"),
    "nan place": (lambda s, a, b: s.ball(a, b, at=(math.nan, 0, 0)), "at must be finite"),
    "one body twice": (lambda s, a, b: s.weld(a, a, at=(0, 0, 0)), "body 0 twice"),
    "limits the wrong way": (
        lambda s, a, b: s.revolute(a, at=(0, 0, 0), axis=(1, 0, 0), limits=(1, -1)),
        "lower must not be above upper, got 1 and -1",
    ),
    "weak motor": (lambda s, a, b: s.revolute(a, at=(0, 0, 0), axis=(1, 0, 0), motor=(1, -1)), "motor_max.*got -1"),
    "friction": (lambda s, a, b: s.prismatic(a, at=(0, 0, 0), axis=(1, 0, 0), friction=-1), "friction.*not -1"),
    "friction_coefficient": (
        lambda s, a, b: s.prismatic(a, at=(0, 0, 0), axis=(1, 0, 0), friction_coefficient=-1),
        "friction_coefficient.*not -1",
    ),
    "coefficient of an angle": (
        lambda s, a, b: s.cylindrical(a, at=(0, 0, 0), axis=(1, 0, 0), angle={"friction_coefficient": 0.1}),
        "angle of a cylindrical constraint cannot have a friction coefficient",
    ),
    "spring": (lambda s, a, b: s.prismatic(a, at=(0, 0, 0), axis=(1, 0, 0), spring=(-5,)), "stiffness.*not -5"),
    "skew universal": (
        lambda s, a, b: s.universal(a, b, at=(0, 0, 0), axis=(1, 0, 0), second_axis=(1, 1, 0)),
        "right angles",
    ),
    "a point has no axis": (
        lambda s, a, b: s.revolute(b, at=(0, 2, 0), axis=(1, 0, 0)),
        "body 1 is a point, which has no directions; use a ball joint",
    ),
    "a point reaches nothing": (lambda s, a, b: s.ball(b, at=(0, 0, 0)), r"does not reach \(0.*0.*0.*\)"),
    "rod within a body": (lambda s, a, b: s.rod(*a.particles[:2]), "one rigid body"),
    "rod of no length": (
        lambda s, a, b: s.rod(a.particles[0], b.particles[0], 0),
        "length must be between 1e-9 and 1e9 m",
    ),
    "rope without a number": (
        lambda s, a, b: s.rope(a.particles[0], b.particles[0], math.nan),
        "length must be finite",
    ),
    "rest of no spring": (
        lambda s, a, b: s.revolute(a, at=(0, 0, 0), axis=(1, 0, 0), spring=(0, 1, 0.5)),
        "a spring with a rest needs a stiffness",
    ),
    "interval of points": (
        lambda s, a, b: s.on_path(b.particles[0], [(0, 2, 0), (1, 2, 0)], interval=(0, 2)),
        "interval and samples are of a path that is a function",
    ),
    "rounding of a spline": (
        lambda s, a, b: s.on_path(b.particles[0], [(0, 2, 0), (1, 2, 0)], smooth=True, rounding=0.1),
        "a smooth path has none",
    ),
    "size of a shape": (
        lambda s, a, b: s.on_surface(b.particles[0], iota.Sphere(1), at=(0, 1, 0), size=3),
        "a shape has its own",
    ),
    "screw without a lead": (
        lambda s, a, b: s.screw(a, at=(0, 0, 0), axis=(1, 0, 0), lead=0),
        "needs a lead that is not zero",
    ),
    "break force": (lambda s, a, b: s.ball(a, at=(0, 0, 0), break_force=0), "break_force must be above zero, got 0"),
    "another system": (lambda s, a, b: s.ball(iota.System().body(), at=(0, 0, 0)), "another system"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_bad_input_is_refused_in_a_sentence_and_changes_nothing(name: str) -> None:
    system, box = hanging_box()
    point = system.body()
    point.particle((0, 2, 0))
    before = system.state_hash(), len(system.particles), len(system.constraints)
    make, text = REFUSED[name]
    with pytest.raises(ValueError, match=text):
        make(system, box, point)
    assert before == (system.state_hash(), len(system.particles), len(system.constraints))
    assert system.validate() == []


def test_each_coordinate_says_its_name_and_unit() -> None:
    system, box = hanging_box()
    cross = system.universal(box, at=(0, 0, 0), axis=(1, 0, 0), second_axis=(0, 0, 1))
    assert repr(cross.angle).startswith("<angle ") and repr(cross.angle).endswith(" rad>")
    assert repr(cross.second_angle).startswith("<second_angle ") and repr(cross.second_angle).endswith(" rad>")
    assert repr(system.prismatic(box, at=(0, 0, 0), axis=(0, 1, 0)).slide).endswith(" m>")


def test_limits_and_ropes_that_move_bodies_at_once_are_noted() -> None:
    system = iota.System(gravity=(0, 0, 0))
    system.revolute(system.body(shape=iota.Sphere(0.1)), at=(0, 0, 0), axis=(0, 0, 1), limits=(0.5, 1))
    p, q = system.body().particle((3, 0, 0)), system.body().particle((6, 0, 0))
    system.rope(p, q, 0.5)
    system.rope(p, q, 3)
    notes = system.step().warnings
    assert [note for note in notes if "outside of its limits 0.5 to 1" in note]
    assert [note for note in notes if "its ends are 3 m apart" in note]
    assert len(notes) == 2
    assert system.step().warnings == []


def test_a_universal_joint_tells_both_axes_and_a_path_where_it_is_now() -> None:
    system = iota.System(gravity=(0, 0, 0))
    shaft = system.body(shape=iota.Box((1, 0.1, 0.1)), position=(0.5, 0, 0))
    cross = system.universal(shaft, at=(0, 0, 0), axis=(0, 0, 3), second_axis=(0, 2, 0))
    assert np.allclose(cross.axis, (0, 0, 1)) and np.allclose(cross.second_axis, (0, 1, 0))
    carrier = system.body(shape=iota.Box((1, 1, 1)), position=(5, 0, 0))
    bead = system.body().particle((5, 2, 0))
    points = [(4, 2, 0), (5, 2, 0), (6, 3, 0)]
    wire = system.on_path(bead, points, carrier, rounding=0.1)
    given = wire.path
    assert np.allclose(given.pop("path"), points)
    assert given == {"closed": False, "smooth": False, "rounding": 0.1}
    carrier.set_pose((5, 4, 0), ("z", 90))
    moved = [(5 - y, 4 + x - 5, z) for x, y, z in points]
    assert np.allclose(wire.path["path"], moved)
    other = iota.System()
    again = other.on_path(other.body().particle(moved[0]), **wire.path)
    assert again.slide.limits == pytest.approx(wire.slide.limits) and np.allclose(again.second_axis, 0)
    with pytest.raises(ValueError, match="only a particle on a path has one"):
        _ = cross.path


def test_surfaces_tell_where_they_are_now_and_make_the_same_ones() -> None:
    def bowl(x: float, y: float, z: float) -> float:
        return math.sqrt(x * x + y * y + z * z) - 2

    system = iota.System(gravity=(0, 0, 0))
    carrier = system.body(shape=iota.Box((1, 1, 1)), position=(5, 0, 0))
    ball = iota.Sphere(1.5)
    point = system.body().particle((5, 1.5, 0))
    held = system.on_surface(point, ball, carrier, orientation=("z", 30))
    within = system.inside(point, bowl, carrier, at=(5, 0, 1), size=2.0)
    turn = math.radians(15)
    (given,) = held.surfaces
    assert given["surface"].radius == 1.5 and np.allclose(given["at"], (5, 0, 0))
    assert np.allclose(given["orientation"], (0, 0, math.sin(turn), math.cos(turn)))
    assert within.surfaces[0]["surface"] is bowl and within.surfaces[0]["size"] == 2.0
    carrier.set_pose((5, 4, 0), ("z", 90))
    (moved,) = held.surfaces
    assert np.allclose(moved["at"], (5, 4, 0))
    assert np.allclose(moved["orientation"], (0, 0, math.sin(4 * turn), math.cos(4 * turn)))
    other = iota.System()
    again = other.on_surface(other.body().particle((5, 5.5, 0)), **moved)
    assert np.allclose(again.surfaces[0]["at"], (5, 4, 0)) and "size" not in again.surfaces[0]
    wheel = system.body(shape=iota.Sphere(0.5), position=(0, 3, 0))
    rolls = system.surface_to_surface(wheel, iota.Sphere(0.5), None, iota.Ellipsoid((4, 5, 4)), at_b=(0, 0, 0))
    of_a, of_b = rolls.surfaces
    assert of_a["surface"].radius == 0.5 and np.allclose(of_a["at"], (0, 3, 0)) and np.allclose(of_b["at"], 0)
    assert system.ball(wheel, at=(0, 3, 0)).surfaces == []


@pytest.mark.parametrize("rate", [60, 240])
def test_accurate_surfaces_have_the_forces_and_the_motion_of_a_curve(rate: int) -> None:
    """A ball slides down a larger one without leaving it: as a point on a sphere around the center."""
    distance = 0.6
    start = (distance * math.sin(2.0), distance * math.cos(2.0), 0)
    pair = iota.System(mode="accurate")
    ball = pair.body(shape=iota.Sphere(0.1), mass=1, position=start)
    joint = pair.surface_to_surface(ball, iota.Sphere(0.1), None, iota.Sphere(0.5), one_sided=False, at_b=(0, 0, 0))
    single = iota.System(mode="accurate")
    point = single.body().particle(start, mass=1)
    single.on_surface(point, iota.Sphere(distance), at=(0, 0, 0))
    for _ in range(rate):
        pair.step(1 / rate)
        single.step(1 / rate)
        along = ball.position / abs(ball.position)
        needed = 9.81 * along.y - ball.velocity.dot(ball.velocity) / distance
        assert joint.force.dot(along) == pytest.approx(needed, abs=0.02 * 60 / rate * (1 + abs(needed)))
    assert math.dist(tuple(ball.position), tuple(point.position)) < 1e-7


@pytest.mark.parametrize("mode", ["energy_keeping", "robust", "accurate"])
@pytest.mark.parametrize("shape", [iota.Box((0.3, 1e-4, 0.4)), iota.Cylinder(1e-5, 0.4)])
def test_a_thin_body_swings_about_a_hinge_far_outside_of_it_and_makes_no_energy(
    mode: Literal["energy_keeping", "robust", "accurate"], shape: iota.Shape
) -> None:
    system = iota.System(mode=mode)
    body = system.body(shape=shape, mass=1, position=(0.3, -0.3, 0), orientation=("z", 20))
    system.revolute(body, at=(0, 0, 0), axis=(0, 0, 1))

    def energy() -> float:
        spin = np.array(body.angular_velocity)
        kinetic = math.hypot(*body.velocity) ** 2 / 2 + spin @ np.array(body.inertia) @ spin / 2
        return float(kinetic + 9.81 * body.position.y)

    before = energy()
    most = 0.0
    for _ in range(60):
        assert not system.step(1 / 60).warnings
        most = max(most, energy() - before)
        assert math.hypot(body.position.x, body.position.y) == pytest.approx(math.hypot(0.3, 0.3), abs=1e-6)
        assert abs(body.position.z) < 1e-6
    assert most < 1e-5


def test_a_joint_far_outside_of_a_thin_body_that_can_give_no_attachment_is_told() -> None:
    system = iota.System()
    sheet = system.body(shape=iota.Box((0.3, 1e-4, 0.4)), mass=1, position=(0, -0.3, 0))
    system.bond(sheet.particles[0], system.body().particle((0, -2, 0)), "spring", stiffness=1, length=1)
    system.revolute(sheet, at=(0, 0, 0), axis=(0, 0, 1))
    told = system.step(1 / 60).warnings
    assert any("times its thickness outside of it" in warning for warning in told)
