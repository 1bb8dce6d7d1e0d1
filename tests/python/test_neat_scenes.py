# SPDX-License-Identifier: Apache-2.0
"""Scenes as people build them, by neat numbers: balanced on their axles, at rest, in the ground by half, held by a brake of any strength.

Random scenes move from the first step, and their energies are of some size: round-off that is compared with nothing does
not show in them.
"""

import math
import random

import numpy as np
import pytest
from amount import TRIES_ALL

import iota

MODES = ["energy_keeping", "robust", "accurate"]
HERTZ = 120


def put_on_axle(system: iota.System, dice: random.Random) -> None:
    """A solid of any size and density, at rest on a joint through its center, with or without what acts in the joint."""
    size = 10 ** dice.uniform(-2, 1.5)
    shapes = [
        iota.Cylinder(0.3 * size, 0.1 * size),
        iota.Box((0.6 * size, 0.5 * size, 0.1 * size)),
        iota.Sphere(size / 5),
    ]
    at = dice.choice([(0.0, 0.0, 0.0), tuple(dice.uniform(-5, 5) * size for _ in range(3))])
    body = system.body(shape=dice.choice(shapes), density=10 ** dice.uniform(2, 4), position=at)
    kind = dice.choice(["revolute", "prismatic", "ball"])
    if kind == "ball":
        system.ball(body, at=at)
        return
    joint = getattr(system, kind)(body, at=at, axis=dice.choice([(1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 2, 3)]))
    freedom = joint.slide if kind == "prismatic" else joint.angle
    strength = body.mass * (50 if kind == "prismatic" else size**2)  # holds it up
    what = dice.choice(["nothing", "friction", "motor", "spring", "servo"])
    if kind == "prismatic" or what == "friction":
        freedom.friction = strength
    elif what == "motor":
        freedom.motor = (dice.choice([0.0, 2.0]), strength)
    elif what == "spring":
        freedom.spring = (10 * strength, strength / 10, 0.0)
    elif what == "servo":
        freedom.servo = (dice.choice([0.0, 0.5]), strength)


@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("seed", range(20))
def test_round_off_of_what_is_balanced_on_its_axle_makes_no_energy(mode: str, seed: int) -> None:
    dice = random.Random(seed)
    system = iota.System(mode=mode, gravity=dice.choice([(0, -9.81, 0), (0, 0, 0), (3, -9.81, 2)]))
    put_on_axle(system, dice)
    for _ in range(120):
        report = system.step(1 / dice.choice([30, 60, 240, 1000]))
        assert (report.warnings, report.fallbacks, report.unconverged) == ([], 0, 0)


@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("size", [0.04, 0.4, 4.0])
@pytest.mark.parametrize("form", ["box", "sphere", "box in a box"])
def test_what_comes_out_of_the_ground_in_space_stays_where_it_came_out(mode: str, size: float, form: str) -> None:
    system = iota.System(mode=mode, gravity=(0, 0, 0))
    system.usual_material = iota.Material()
    system.obstacle(iota.HalfSpace((0, 1, 0)))
    shape = iota.Sphere(size / 2) if form == "sphere" else iota.Box((size, size, size))
    bodies = [system.body(shape=shape, position=(1, 0.3 * size, 0))]
    if form == "box in a box":
        bodies.append(system.body(shape=shape, position=(1 + 0.1 * size, 1.1 * size, 0)))
    for _ in range(3 * HERTZ):
        assert system.step(1 / HERTZ).warnings == []
    for k, body in enumerate(bodies):
        assert body.position.y == pytest.approx((0.5 + k) * size, abs=1e-5 * size)
        assert body.velocity.length < 1e-5 * size


@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("torque", [1e3, 1e9, 1e30, math.inf])
def test_a_brake_or_a_motor_of_any_strength_has_its_speed_at_once(mode: str, torque: float) -> None:
    for speed, before in ((0.0, 5.0), (3.0, 0.0), (-2.0, 5.0)):
        system = iota.System(mode=mode)
        wheel = system.body(shape=iota.Cylinder(0.1, 0.05), position=(0.5, 0, 0), spin=(0, before, 0))
        axle = system.revolute(wheel, at=(0.5, 0, 0), axis=(0, 1, 0))
        axle.angle.motor = (speed, torque)
        for _ in range(HERTZ):
            report = system.step(1 / HERTZ)
            assert (report.unconverged, report.fallbacks, report.warnings) == (0, 0, [])
        assert wheel.angular_velocity.y == pytest.approx(speed, abs=1e-3)
        assert axle.angle.value == pytest.approx(speed, abs=5.0 / HERTZ)


SOLIDS = {
    "ball": iota.Sphere(0.2),
    "capsule": iota.Capsule(0.2, 1.0),
    "box": iota.Box((0.6, 0.4, 0.5)),
    "cylinder": iota.Cylinder(0.25, 0.6),
    "cone": iota.Cone(0.3, 0.6),
    "ellipsoid": iota.Ellipsoid((0.3, 0.2, 0.25)),
}


@pytest.mark.parametrize("gravity", [0.0, 9.81])
@pytest.mark.parametrize("turn", [("y", 0), ("y", 90), ("z", 90)])
@pytest.mark.parametrize("other", SOLIDS)
@pytest.mark.parametrize("one", SOLIDS)
def test_what_is_put_into_the_middle_or_the_axis_of_another_comes_out(
    one: str, other: str, turn: tuple[str, float], gravity: float
) -> None:
    asides = ((0.0, 0.0, 0.0), (0.1, 0.0, 0.0), (0.0, 0.1, 0.0))
    number = [*SOLIDS].index(one) + [*SOLIDS].index(other) + "yz".index(turn[0]) + bool(turn[1])
    for aside in asides if TRIES_ALL else [asides[number % 3]]:
        system = iota.System(gravity=(0, -gravity, 0))
        system.usual_material = iota.Material()
        if gravity:
            system.obstacle(iota.HalfSpace((0, 1, 0)))
        place = iota.Vec3(0, 0.6, 0)
        system.body(shape=SOLIDS[one], position=place)
        system.body(shape=SOLIDS[other], position=place + iota.Vec3(*aside), orientation=turn)
        for _ in range(90):
            report = system.step(1 / 60)
            assert (report.unconverged, report.warnings) == (0, [])
        assert report.worst_gap < 1e-8


def test_what_sweeps_push_out_of_each_other_is_lifted_by_the_edit_and_not_by_made_energy() -> None:
    system = iota.System()
    system.budget_contacts = 1  # everything by sweeps
    system.usual_material = iota.Material()
    system.obstacle(iota.HalfSpace((0, 1, 0)))
    for k in range(3):
        system.body(shape=iota.Box((1, 1, 1)), position=(0, 0.4 + 0.8 * k, 0))
    for _ in range(120):
        assert system.step(1 / 60).warnings == []
    assert system.energy.made < 1e-9
    standing = 1000 * 9.81 * (0.5 + 1.5 + 2.5)  # three boxes of a tonne
    assert system.energy.edits == pytest.approx(standing, rel=1e-3), "with what their creation gave"


def test_a_hand_that_pulls_what_cannot_move_makes_no_energy() -> None:
    """A straight chain along its line; and a door along its axis."""
    for mode in MODES:
        for size in (0.1, 1.0, 10.0):
            system = iota.System(mode=mode, gravity=(0, 0, 0))
            before: iota.Body | None = None
            links = []
            for k in range(5):
                link = system.body(
                    shape=iota.Box((0.2 * size, 0.06 * size, 0.06 * size)), position=(0.2 * size * (k + 0.5), size, 0)
                )
                system.ball(link, before, at=(0.2 * size * k, size, 0))
                links.append(before := link)
            door = system.body(shape=iota.Box((0.8 * size, 1.2 * size, 0.04 * size)), position=(0, size, 3 * size))
            system.revolute(door, at=(-0.4 * size, size, 3 * size), axis=(0, 1, 0))
            hands = [
                (system.grip(links[1], hold=0), links[1].center_of_mass, iota.Vec3(2 * size, 0, 0)),
                (system.grip(door, hold=1, frequency=12), door.center_of_mass, iota.Vec3(0, -size, 0)),
            ]
            for step in range(2 * HERTZ):
                for hand, start, velocity in hands:
                    hand.move(start + velocity * (step / HERTZ))
                assert system.step(1 / HERTZ).warnings == [], (mode, size, step)
            assert system.energy.made < 1e-12 * size**3


def test_hands_that_press_a_body_while_it_turns_make_no_energy() -> None:
    """Their force along the chord of a step seems to take what the links between the hands seem to make."""

    def kinetic(kind: str, mode: str, hertz: int) -> float:
        system = iota.System(mode=mode, gravity=(0, 0, 0))
        if kind == "ball on a joint":
            body = system.body(shape=iota.Sphere(0.2), mass=8)
            system.ball(body, at=(0, 0, 0))
            pulls = [((0.2, 0.2, 0.2), (-3, 0, 0.5)), ((0, 0.2, 0), (2, 0, 0))]
        else:
            body = system.body(shape=iota.Box((0.8, 0.1, 0.1)), mass=8)
            pulls = [((0.4, 0, 0), (-3, 0, 0.5)), ((-0.4, 0, 0), (3, 0.3, 0))]
        hands = [
            (system.grip(body, local_point=at, hold=k, frequency=12, max_acceleration=2000), at, velocity)
            for k, (at, velocity) in enumerate(pulls)
        ]
        for step in range(hertz // 10):
            for hand, at, velocity in hands:
                hand.move(tuple(x + v * (step + 1) / hertz for x, v in zip(at, velocity, strict=True)))
            assert system.step(1 / hertz).warnings == [], (kind, mode, hertz, step)
        assert system.energy.made <= 1e-3 * system.energy.kinetic
        return system.energy.kinetic

    for kind in ("ball on a joint", "free bar"):
        truth = kinetic(kind, "energy_keeping", 3840)
        for mode in ("robust", "energy_keeping"):
            assert kinetic(kind, mode, 240) == pytest.approx(truth, rel=0.1)
            assert kinetic(kind, mode, 960) == pytest.approx(truth, rel=0.04)


@pytest.mark.parametrize("seed", range(6))
def test_hands_that_press_on_what_springs_hold_stop_nothing(seed: int) -> None:
    """A spring of a joint without a damper has no equation in a projection of velocities: a not-a-number stopped all bodies."""
    random = np.random.default_rng(seed)
    system = iota.System(mode="robust")
    first = system.body(shape=iota.Box((0.6, 0.1, 0.1)), position=(0.3, 1, 0))
    second = system.body(shape=iota.Box((0.6, 0.1, 0.1)), position=(0.9, 1, 0))
    system.revolute(first, at=(0, 1, 0), axis=(0, 0, 1))
    system.revolute(first, second, at=(0.6, 1, 0), axis=(0, 0, 1), spring=(random.choice((3.0, 30.0)), 0, 0))
    for hold, (body, at) in enumerate(((second, (0.2, 0, 0)), (first, (0.1, 0, 0)))):
        target = (*random.uniform((-1, 0), (1, 2)), 0)
        system.grip(body, at, target, hold=hold, frequency=5, max_acceleration=500)
    assert [step for step in range(120) if system.step(1 / 60).unconverged] == []
