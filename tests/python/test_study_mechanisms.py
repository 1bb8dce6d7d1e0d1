# SPDX-License-Identifier: Apache-2.0
from __future__ import annotations

import math

import pytest
from shown import show

import iota
from iota._protocol import TieKind
from iota.frames import turned
from iota.studies import mechanisms


def by_kind(system: iota.System) -> dict[str, list[iota.Constraint]]:
    constraints: dict[str, list[iota.Constraint]] = {}
    for constraint in system.constraints:
        constraints.setdefault(constraint.kind, []).append(constraint)
    return constraints


def build() -> tuple[iota.System, dict[str, list[iota.Constraint]]]:
    system = mechanisms.build().system
    return system, by_kind(system)


def test_the_piston_goes_as_crank_and_rod_say() -> None:
    system, constraints = build()
    motor, (guide,) = constraints["revolute"][0], constraints["prismatic"]
    start = guide.slide.value
    crank, rod = 0.09, 0.3
    for _ in range(480):
        report = system.step(1 / 120)
        assert report.unconverged == 0 and report.fallbacks == 0
        angle = motor.angle.value
        expected = crank * math.cos(angle) + math.sqrt(rod**2 - (crank * math.sin(angle)) ** 2) - (crank + rod)
        assert abs(guide.slide.value - start - expected) < 1e-9
    assert abs(motor.angle.speed - 4.0) < 1e-2  # points move along chords of their circles
    assert system.worst_gap < 1e-9


def test_the_motor_can_be_reversed() -> None:
    world = mechanisms.build()
    motor = next(c for c in world.system.constraints if c.kind == "revolute")
    world._state.actions["reverse"].hook.function()
    for _ in range(60):
        assert world.system.step(1 / 120).unconverged == 0
    assert motor.angle.value < -1.9


def test_two_crosses_turn_the_last_shaft_as_the_first() -> None:
    system, constraints = build()
    first = next(c for c in constraints["revolute"] if abs(c.axis.x) > 0.9)
    (last,) = constraints["cylindrical"]
    for _ in range(240):
        assert system.step(1 / 120).unconverged == 0
        assert abs(last.angle.value - first.angle.value) < 1e-6


def test_the_rope_breaks_when_it_is_pulled_and_can_be_mended() -> None:
    world = mechanisms.build()
    system = world.system
    constraints = by_kind(system)
    (rope,) = constraints["rope"]
    weight = rope.particles[1].body
    version = system.structure_version
    while not rope.broken:
        assert system.time < 1
        rope.particles[1].apply_force((0, -300, 0))
        assert system.step(1 / 120).unconverged == 0
    assert len(system.broken) == 1 and system.structure_version > version
    for _ in range(120):
        assert system.step(1 / 120).unconverged == 0
    assert weight.center_of_mass.y == pytest.approx(mechanisms.BENCH + 0.05, abs=1e-6)  # it lies on the bench
    world._state.actions["mend"].hook.function()
    for _ in range(240):
        assert system.step(1 / 120).unconverged == 0
    assert rope.gap < 1e-9


def test_ropes_and_springs_are_drawn_while_they_hold() -> None:
    system, constraints = build()
    (rope,) = constraints["rope"]
    with show(system) as shown:
        kinds = [tie["kind"] for tie in shown.page.entities["tie"].values()]
        assert kinds.count(TieKind.ROPE) == 1 and kinds.count(TieKind.SPRING) == 2
        rope.active = False
        shown.look()
        assert TieKind.ROPE not in [tie["kind"] for tie in shown.page.entities["tie"].values()]


def drawn_places(world: iota.World, body: iota.Body, shape: type) -> list[iota.Vec3]:
    """Where the parts of a body's look with a shape are, m."""
    look = world.scene.look_of(body)
    assert look is not None
    listed = look["*"] if isinstance(look["*"], list) else [look["*"]]
    return [
        body.center_of_mass + turned(body.orientation, iota.Vec3(*each.offset))
        for each in listed
        if isinstance(each.shape, shape)
    ]


def test_the_crosses_and_the_pin_of_the_crank_are_drawn_where_the_joints_are() -> None:
    world = mechanisms.build()
    constraints = by_kind(world.system)
    for _ in range(100):
        world.step()
    for joint in constraints["universal"]:
        assert joint.b is not None
        for body in (joint.a, joint.b):
            hubs = drawn_places(world, body, iota.Sphere)
            assert min(abs(hub - joint.position) for hub in hubs) < 1e-6
    wheel, pin = constraints["revolute"][0].a, constraints["revolute"][1].position
    assert min(abs(place - pin) for place in drawn_places(world, wheel, iota.Cylinder)) < 0.006
    rod_ends = drawn_places(world, constraints["revolute"][1].a, iota.Cylinder)
    assert min(abs(place - pin) for place in rod_ends) < 1e-6
