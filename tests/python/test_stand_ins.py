# SPDX-License-Identifier: Apache-2.0
"""A structure that stands in for a thing at a level of one's own keeps its mass, momentum and angular momentum."""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise
from typing import Any

import numpy as np
import pytest

import iota
from iota.builder import Structure
from iota.frames import turned
from iota.levels.level import Level
from iota.levels.managed import Managed

PLENTY, LITTLE = 1e4, 1e-6  # ms


class Thing:
    """Five rods that fly and turn, far from the viewer, with a ball in their place at the level `far`."""

    def __init__(self, structure: Callable[[Managed], Any], nail: bool = False, gravity: float = 0.0) -> None:
        self.system = iota.System(gravity=(0, -gravity, 0))
        self.world = iota.World(self.system, ground=None)
        chain = iota.builder.chain(5, 2.0, top=(0, 0, 0), direction=(1, 0.3, 0), mass=5.0)
        if not nail:
            chain.nails.clear()
        self.bodies = chain.realize(self.system).bodies
        if not nail:
            with self.system.edit():
                for number, body in enumerate(self.bodies):
                    body.velocity = (1, 0.5 * number, 0.2 * number**2 - 1)
        self.world.levels.viewers = lambda: [(0, 0, 200.0)]
        self.thing = self.world.levels.manage(
            self.bodies[0].articulate, levels=["full", Level("far", share=0.1, quality=0.5, structure=structure)]
        )
        self.run(2)

    def run(self, steps: int) -> None:
        for _ in range(steps):
            self.world.step()

    def reach(self, level: str) -> None:
        """Until the thing is at a level."""
        self.world.levels.budget_ms = LITTLE if level == "far" else PLENTY
        for _ in range(150):
            if self.thing.level.name == level:
                return
            self.world.step()
        raise AssertionError(f"it is at {self.thing.level.name}")

    def sums(self) -> np.ndarray:
        """Mass, momentum and angular momentum of all."""
        system = self.system
        return np.array(
            [
                system.momentum.x,
                *list(system.momentum),
                *list(system.angular_momentum),
                sum(b.mass for b in system.bodies if b.active),
            ]
        )


def ball(thing: Managed, mass: float | None = None) -> Structure:
    made = Structure()
    made.body(shape=iota.Sphere(0.3), mass=mass or thing.mass, position=tuple(thing.position))
    return made


def dumbbell(thing: Managed) -> Structure:
    """Elsewhere; it is moved to the thing's place."""
    made = Structure()
    ends = [made.point((x, 9, 9), mass=thing.mass / 2) for x in (0.0, 1.0)]
    made.body(*ends)
    return made


def cross(thing: Managed) -> Structure:
    """As wide as the thing."""
    made = Structure()
    ways = [(x, y, z) for x, y, z in ((1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1))]
    made.body(*(made.point(way, mass=thing.mass / 6) for way in ways))
    return made


@pytest.mark.parametrize("structure", [ball, dumbbell, cross])
def test_a_swap_keeps_mass_momentum_and_angular_momentum_and_gains_no_energy(
    structure: Callable[[Managed], Structure],
) -> None:
    made = Thing(structure)
    system, before, energy, center = made.system, made.sums(), made.system.energy.kinetic, made.thing.position
    made.reach("far")
    assert len(made.thing.bodies) == 1 and not made.bodies[0].active
    assert made.sums()[[0, 1, 2, 3, 7]] == pytest.approx(before[[0, 1, 2, 3, 7]], abs=1e-9)
    if structure is cross:
        assert made.sums() == pytest.approx(before, abs=1e-9), "the others are more compact, and would have more energy"
    assert abs(made.thing.position - center) < 0.1 and system.energy.kinetic < energy * (1 + 1e-9)
    made.run(30)
    middle = made.thing.position
    made.reach("full")
    assert made.sums()[[0, 1, 2, 3, 7]] == pytest.approx(before[[0, 1, 2, 3, 7]], abs=1e-9)
    if structure is not dumbbell:  # which has no spin about its own line
        assert made.sums() == pytest.approx(before, abs=1e-9), "what a compact one could not take is back"
    assert abs(made.thing.position - middle) < 2.0
    assert all(body.active for body in made.bodies) and len(system.bodies) == 5
    assert system.energy.kinetic <= energy * (1 + 1e-9) and system.validate() == []
    ends = [abs(body.particles[0].position - body.particles[1].position) for body in made.bodies]
    assert ends == pytest.approx([0.4] * 5, abs=1e-9)


def test_the_bodies_come_back_turned_as_the_stand_in_has_turned() -> None:
    made = Thing(cross)
    made.reach("far")
    stand_in = made.thing.bodies[0]
    way = (made.bodies[4].particles[1].position - made.bodies[0].particles[0].position).unit()
    start = np.array([list(p.position - stand_in.center_of_mass) for p in stand_in.particles])
    made.run(60)
    now_at = np.array([list(p.position - stand_in.center_of_mass) for p in stand_in.particles])
    turned = iota.Vec3(*(np.linalg.lstsq(start, now_at, rcond=None)[0].T @ np.array(list(way))))
    made.reach("full")
    assert abs(turned.unit() - way) > 0.1, "it has turned"
    now = made.bodies[4].particles[1].position - made.bodies[0].particles[0].position
    assert now.unit().dot(turned.unit()) > 0.95


def test_what_is_nailed_comes_back_at_its_nails() -> None:
    def pendulum(thing: Managed) -> Structure:
        made = Structure()
        top, bob = made.point((0, 0, 0), mass=1.0), made.point((1, 0.3, 0), mass=4.0)
        made.body(top, bob)
        made.nail(top)
        return made

    made = Thing(pendulum, nail=True, gravity=9.81)
    start = [p.position for body in made.bodies for p in body.particles]
    made.reach("far")
    made.run(40)
    made.reach("full")
    top = made.bodies[0].particles[0]
    assert top.is_nailed and abs(top.position) < 1e-12
    assert len(start) == 10 and made.system.validate() == []


@pytest.mark.parametrize(
    ("structure", "told"),
    [
        (lambda thing: ball(thing, 7.0), "has 7 kg, but what it stands in for has 5 kg"),
        (lambda thing: None, "must make an iota.builder.Structure to stand in, not None"),
        (lambda thing: Structure(), "without bodies"),
        (lambda thing: 1 / 0, "division by zero"),
    ],
)
def test_a_wrong_structure_is_told_and_the_thing_stays_full(
    structure: Callable[[Managed], Any], told: str, capsys: pytest.CaptureFixture[str]
) -> None:
    made = Thing(structure)
    made.world.levels.budget_ms = LITTLE
    made.run(60)
    assert capsys.readouterr().err.count(told) in (1, 2)  # in the traceback, too
    assert made.thing.level.name == "full" and made.thing.is_pinned
    assert (
        made.thing.bodies == made.bodies and all(body.active for body in made.bodies) and len(made.system.bodies) == 5
    )
    assert made.system.validate() == []


def test_a_stand_in_that_is_destroyed_takes_its_thing_along() -> None:
    made = Thing(ball)
    made.reach("far")
    made.thing.bodies[0].destroy()
    made.run(40)
    assert made.world.levels.things == [] and made.system.bodies == []
    assert made.system.validate() == []


def test_a_stand_in_that_is_destroyed_in_the_frame_of_its_change_is_no_error(
    capsys: pytest.CaptureFixture[str],
) -> None:
    made = Thing(ball)
    made.reach("far")
    made.world.levels.budget_ms = PLENTY
    made.world.levels.manage(made.system.body(shape=iota.Sphere(0.1), mass=1, position=(0, 0, 190)))
    made.thing.bodies[0].destroy()
    made.world.levels._change(made.thing, 0, 0.0, 0.0, "in reach")
    made.run(3)
    assert capsys.readouterr().err == "" and len(made.system.bodies) == 1
    assert len(made.world.levels.things) == 1 and made.system.validate() == []


def test_a_stand_in_that_is_taken_apart_is_the_thing_from_then_on() -> None:
    def two(thing: Managed) -> Structure:
        made = Structure()
        a, b, c, d = (made.point((x, 0, 0), mass=1.25) for x in (0, 1, 1, 2))
        made.body(a, b)
        made.body(c, d)
        made.hinge(b, c)
        return made

    made = Thing(two)
    made.reach("far")
    left, right = made.thing.bodies
    left.particles[1].separate(right.particles[0])
    made.reach("full")
    made.run(10)
    assert left.alive and right.alive and len(made.system.bodies) == 2
    assert made.system.validate() == []


def test_an_undo_and_a_reset_find_what_stands_there() -> None:
    made = Thing(ball)
    full = made.system.snapshot()
    made.reach("far")
    far, stand_in = made.system.snapshot(), made.thing.bodies[0]
    made.system.restore(full)
    made.world.levels.budget_ms = PLENTY
    made.run(7)
    assert made.thing.level.name == "full" and made.thing.bodies == made.bodies
    made.system.restore(far)
    made.world.levels.budget_ms = LITTLE
    made.run(1)
    assert made.thing.bodies == [stand_in] and made.thing.level.name == "far"
    made.reach("full")
    assert made.thing.bodies == made.bodies and len(made.system.bodies) == 5
    assert made.system.validate() == []


def test_an_undo_takes_back_what_people_did_and_no_swap() -> None:
    made = Thing(ball)
    with made.system.edit():
        box = made.system.body(shape=iota.Box((1, 1, 1)), position=(0, 50, 0))
    count = made.system.undo_count
    made.reach("far")
    made.reach("full")
    assert made.system.undo_count == count and box.alive
    made.world.undo()
    assert not box.alive and made.system.redo_count == 1
    made.reach("far")
    assert made.system.redo_count == 1, "a swap is not what would be lost"
    made.world.redo()
    assert box.alive and made.system.validate() == []


def test_what_is_replayed_has_the_same_bits() -> None:
    made = Thing(dumbbell)
    made.system.start_recording()
    made.reach("far")
    made.run(5)
    made.reach("full")
    made.run(5)
    recording = made.system.stop_recording()
    assert iota.System().replay(recording) is None


def test_a_stand_in_in_reach_of_a_viewer_gives_way_at_once() -> None:
    made = Thing(ball)
    made.reach("far")
    place = made.thing.position
    made.world.levels.viewers = lambda: [tuple(place)]
    made.run(2)
    assert made.thing.level.name == "full" and all(body.active for body in made.bodies)


def test_solids_come_back_with_their_shapes_where_they_would_have_flown() -> None:
    system = iota.System(gravity=(0, 0, 0))
    world = iota.World(system, ground=None)
    left = system.body(shape=iota.Box((1, 0.2, 0.2)), mass=2, position=(0, 0, 0), attachments=[(0.5, 0, 0)])
    right = system.body(shape=iota.Box((1, 0.2, 0.2)), mass=2, position=(1, 0, 0), attachments=[(-0.5, 0, 0)])
    left.attachments[0].combine(right.attachments[0])
    left.velocity, left.angular_velocity = (0.5, 0, 0), (0, 0, 1)
    world.levels.viewers = lambda: [(0, 0, 200.0)]
    plank = Level("far", share=0.1, quality=0.5, structure=lambda thing: plank_of(thing.mass))
    thing = world.levels.manage(left.articulate, levels=["full", plank])
    world.levels.budget_ms = LITTLE
    for _ in range(60):
        world.step()
    assert thing.level.name == "far"
    now, momentum, spin = thing.position, system.momentum, system.angular_momentum
    velocity = momentum * 0.25
    world.levels.budget_ms = PLENTY
    steps = 0
    while thing.level.name == "far":
        world.step()
        steps += 1
    assert abs(thing.position - (now + velocity * (steps * world.dt))) < 1e-9
    assert abs(system.momentum - momentum) < 1e-9 and abs(system.angular_momentum - spin) < 1e-9
    assert len(left.solids) == len(right.solids) == 1 and left.articulate == right.articulate
    assert abs(left.attachments[0].position - right.attachments[0].position) < 1e-9
    assert system.validate() == []


def plank_of(mass: float) -> Structure:
    made = Structure()
    made.body(shape=iota.Box((2, 0.2, 0.2)), mass=mass, position=(0, 0, 0))
    return made


def lying(floor: bool) -> tuple[iota.World, list[iota.Body], Managed]:
    """Three boards in a row, for which a small ball stands in."""
    system = iota.System()
    system.usual_material = iota.Material()
    world = iota.World(system, ground=0.0 if floor else None)
    boards = [
        system.body(
            shape=iota.Box((0.6, 0.1, 0.2)),
            mass=2,
            position=(0.7 * k, 1, 0),
            attachments=[(x, 0, 0) for x in (-0.35, 0.35)],
        )
        for k in range(3)
    ]
    for one, other in pairwise(boards):
        one.attachments[1].combine(other.attachments[0])
    world.levels.viewers = lambda: [(0, 1.7, 20.0)]
    small = Level("far", share=0.1, quality=0.5, structure=lambda thing: ball_of(0.15, thing.mass))
    return world, boards, world.levels.manage(boards[0].articulate, levels=["full", small])


def ball_of(radius: float, mass: float) -> Structure:
    made = Structure()
    made.body(shape=iota.Sphere(radius), mass=mass)
    return made


def until(world: iota.World, thing: Managed, level: str) -> None:
    world.levels.budget_ms = LITTLE if level == "far" else PLENTY
    for _ in range(150):
        if thing.level.name == level:
            return
        world.step()
    raise AssertionError(f"it is at {thing.level.name}")


def lowest(bodies: list[iota.Body]) -> float:
    corners = [np.array([x, y, z]) for x in (-0.3, 0.3) for y in (-0.05, 0.05) for z in (-0.1, 0.1)]
    places = [body.position + turned(body.orientation, iota.Vec3(*corner)) for body in bodies for corner in corners]
    return min(place.y for place in places)


def test_bodies_come_back_out_of_the_ground_where_a_ball_has_stood_in() -> None:
    """They were 0.2 to 0.7 m inside of it, and stayed there."""
    for speed in (-2.0, 3.0):
        world, boards, thing = lying(floor=True)
        for board in boards:
            board.velocity = (speed, 0, 0.3 * speed)
        until(world, thing, "far")
        for _ in range(60):
            world.step()
        before, work = world.system.energy.total, 0.05 * thing.mass * 9.81
        until(world, thing, "full")
        assert lowest(boards) > -2e-3 and world.system.validate() == []
        assert world.system.energy.total < before + work, "they lie"
        for _ in range(30):
            world.step()
        assert lowest(boards) > -2e-3 and max(abs(board.velocity) for board in boards) < 4


def test_a_large_structure_begins_above_the_ground() -> None:
    world, boards, _ = lying(floor=True)
    big = Level("far", share=0.1, quality=0.5, structure=lambda thing: ball_of(0.8, thing.mass))
    for board in boards:
        board.position -= (0, 0.9 / 3, 0)
    world.levels._things.all.clear()
    thing = world.levels.manage(boards[0].articulate, levels=["full", big])
    for _ in range(90):
        world.step()
    until(world, thing, "far")
    assert thing.bodies[0].position.y > 0.79 and world.system.energy.kinetic < 1e-6


def test_what_a_joint_holds_at_the_world_comes_back_there() -> None:
    """It came back 5 m below, where the structure had fallen to, and its hinge was closed from there."""
    system = iota.System()
    world = iota.World(system, ground=None)
    door = system.body(shape=iota.Box((1, 1.5, 0.05)), mass=9, position=(0, 2, 0))
    system.revolute(door, at=(-0.5, 2, 0), axis=(0, 1, 0))
    door.angular_velocity = (0, 0.5, 0)
    world.levels.viewers = lambda: [(0, 0, 200.0)]
    small = Level("far", share=0.1, quality=0.5, structure=lambda thing: ball_of(0.15, thing.mass))
    thing = world.levels.manage(door, levels=["full", small])
    until(world, thing, "far")
    place, energy = door.position, system.energy.total
    for _ in range(60):
        world.step()
    until(world, thing, "full")
    assert abs(door.position - place) < 0.02 and system.worst_gap < 1e-9
    assert system.energy.total < energy + 1e-6 and system.validate() == []


@pytest.mark.parametrize("tie", ["rope", "spring"])
def test_no_structure_stands_in_for_what_is_tied_to_something_else_that_moves(
    tie: str, capsys: pytest.CaptureFixture[str]
) -> None:
    system = iota.System()
    world = iota.World(system, ground=None)
    crane, load = (
        system.body(shape=iota.Box((0.4, 0.4, 0.4)), mass=5, position=(0, y, 0), attachments=[(0, 0, 0)])
        for y in (3, 1)
    )
    ends = crane.attachments[0], load.attachments[0]
    system.rope(*ends) if tie == "rope" else system.bond(*ends, "spring", stiffness=90)
    world.levels.viewers = lambda: [(0, 0, 200.0)]
    small = Level("far", share=0.1, quality=0.5, structure=lambda thing: ball_of(0.15, thing.mass))
    thing = world.levels.manage(load, levels=["full", small])
    world.levels.budget_ms = LITTLE
    for _ in range(40):
        world.step()
    told = capsys.readouterr().err
    assert "ties it to something else that moves: manage both as one thing" in told and thing.level.name == "full"
    assert abs(load.position - crane.position) > 1.9 and load.active
