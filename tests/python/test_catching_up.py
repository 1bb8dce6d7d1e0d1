# SPDX-License-Identifier: Apache-2.0
"""What was frozen out of sight has happened when it comes into sight (completeness), and what was seen stays so (consistency)."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest

import iota
from iota import looks
from iota._core import Places
from iota.levels import catching_up
from iota.levels.catching_up import CatchUp, catch_up
from iota.levels.ties import Ties
from iota.studies import crowd

PLENTY, LITTLE = 1e4, 1e-6  # ms
DT = 1 / 120


class Place:
    """A ground, and something 200 m from its viewer, who may come."""

    def __init__(self, make: Callable[[iota.World], iota.Body], material: iota.Material | None = None) -> None:
        self.system = iota.System(damping=0.02)
        self.system.usual_material = material or iota.Material(touches="obstacles")
        self.world = iota.World(self.system, ground=0.0)
        self.root = make(self.world)
        self.eye = [0.0, 2.0, 200.0]
        self.world.levels.viewers = lambda: [self.eye]
        self.thing = self.world.levels.manage(self.root.articulate, levels=["full", "frozen"])
        for other in self.system.articulates:  # that joints tie to it
            if other != self.root.articulate and any(len(body.particles) > 1 for body in other.bodies):
                self.world.levels.manage(other, levels=["full", "frozen"])

    def freeze(self) -> None:
        self.world.levels.budget_ms = LITTLE
        for _ in range(100):
            self.world.step()
            if all(thing.level.name == "frozen" for thing in self.world.levels.things):
                return
        raise AssertionError("it is not frozen")

    def run(self, seconds: float) -> None:
        for _ in range(round(seconds / DT)):
            self.world.step()

    def places(self) -> np.ndarray:
        bodies = [body for thing in self.world.levels.things for body in thing.bodies]
        return np.array([list(p.position) for body in bodies for p in body.particles])


def box(world: iota.World) -> iota.Body:
    made = world.system.body(shape=iota.Box((0.3, 0.2, 0.4)), mass=2, position=(0, 9, 0))
    made.angular_velocity = (0, 2, 0)  # it lands flat: what tumbles slides on, for some meters
    return made


def hung(maker: Callable[..., iota.Body]) -> Callable[[iota.World], iota.Body]:
    return lambda world: maker(world, iota.Vec3(0, 3.4, 0), "#888888", 1)


def test_what_was_falling_lies_on_the_ground_when_somebody_comes() -> None:
    place = Place(box)
    place.freeze()
    assert place.root.position.y > 5
    place.run(3.0)
    assert place.root.position.y > 5, "nobody sees it"
    place.eye[2] = 20.0
    place.run(0.1)
    assert place.root.position.y == pytest.approx(0.1, abs=2e-3) and abs(place.root.velocity) < 1e-3
    assert place.system.validate() == [] and place.system.energy.made == 0
    assert len(place.root.solids) == 1


@pytest.mark.parametrize("maker", [crowd.chain, crowd.ladder, crowd.acrobat])
@pytest.mark.parametrize("seconds", [0.5, 1.5])
def test_what_swung_has_swung_on_with_its_energy(maker: Callable[..., iota.Body], seconds: float) -> None:
    place, twin = Place(hung(maker)), Place(hung(maker))
    for each in (place, twin):
        each.run(0.5)
    before = place.system.energy
    assert catch_up(place.system, place.thing.bodies, seconds)
    twin.run(seconds)
    energy, wanted = place.system.energy, twin.system.energy
    assert energy.total <= before.total + 1e-3 * before.kinetic
    assert energy.total == pytest.approx(wanted.total, abs=0.1 * before.kinetic)
    # Of 2 m, and of several rods that swing: its phase.
    assert np.abs(place.places() - twin.places()).max() < 0.15
    assert place.system.validate() == []


def test_what_is_seen_frozen_stays_where_it_is_seen() -> None:
    place = Place(box)
    place.eye[2] = 20.0
    place.freeze()
    start = place.places()
    for distance in (18.0, 12.0, 6.0):
        place.eye[2] = distance
        place.run(0.5)
        if place.thing.level.name == "frozen":
            assert np.array_equal(place.places(), start)
    place.eye[2] = 200.0
    place.run(0.2)
    place.eye[2] = 20.0
    place.run(0.1)
    assert np.abs(place.places() - start).max() < 0.9, "of the time out of sight alone"


def test_a_jump_beside_it_finds_what_has_happened() -> None:
    place = Place(box)
    place.freeze()
    place.run(3.0)
    place.eye[:] = [0.0, 1.0, 1.0]
    place.run(DT)
    assert place.thing.level.name == "full"
    assert place.root.position.y < 0.2


def test_what_lies_still_is_within_a_millimeter() -> None:
    place = Place(box, iota.Material(friction=0.5))
    place.root.set_pose((0, 0.1, 0))
    place.root.velocity = place.root.angular_velocity = (0, 0, 0)
    place.run(1.0)
    place.freeze()
    start = place.places()
    place.run(2.0)
    place.eye[2] = 20.0
    place.run(0.2)
    assert np.abs(place.places() - start).max() < 1e-3


def test_what_cannot_be_copied_goes_on_from_where_it_was() -> None:
    place = Place(box)
    lower = place.system.body(shape=iota.Box((1, 1, 1)), mass=5, position=(0, 30, 0))
    assert catch_up(place.system, [place.root], 0.1)
    both = place.system.group("both")
    both.add(place.root, lower)
    place.system.field(lambda batch: 0.1 * batch.velocity, group=both)  # it may want to know of the other one, too
    start = place.places()
    assert not catch_up(place.system, [place.root], 1.0)
    assert np.array_equal(place.places(), start) and lower.position.y == 30


def test_a_function_that_fails_for_a_copy_leaves_its_bodies_where_they_were() -> None:
    system = iota.System()
    leaf = system.body()
    leaf.particle((0, 5, 0))
    group = system.group("leaves")
    group.add(leaf)

    def fail(batch: iota.types.ParticleBatch) -> np.ndarray:
        raise KeyError("later")

    system.field(fail, group=group)
    assert not catch_up(system, [leaf], 1.0)
    assert leaf.center_of_mass.y == 5 and system.fields[0].active and system.validate() == []


def test_what_is_large_and_in_the_wind_flutters_on_from_where_it_was() -> None:
    system = iota.System()
    flag = system.body()
    for x in range(catching_up.MOST_POINTS + 1):
        flag.particle((0.1 * x, 5, 0.01 * x * x), mass=0.01)
    assert catch_up(system, [flag], 1.0)
    system.field("wind", velocity=(1, 0, 0), drag=0.1)
    assert not catch_up(system, [flag], 1.0)


def pendulum(world: iota.World) -> iota.Body:
    bob = world.system.body(shape=iota.Box((0.1, 1, 0.1)), mass=2, position=(0.4, 2.7, 0), orientation=("z", 53.13))
    world.system.revolute(bob, at=(0, 3, 0), axis=(0, 0, 1), limits=(-2, 1))
    return bob


def arm(world: iota.World) -> iota.Body:
    upper, lower = (
        world.system.body(shape=iota.Box((0.1, 1, 0.1)), mass=2, position=(x, 5, 0), orientation=("z", 90))
        for x in (0.5, 1.5)
    )
    world.system.revolute(upper, at=(0, 5, 0), axis=(0, 0, 1))
    world.system.revolute(upper, lower, at=(1, 5, 0), axis=(0, 0, 1), limits=(-2, 1), friction=0.05)
    return upper


def hung_on_a_spring(world: iota.World) -> iota.Body:
    nail = world.system.body().particle((0, 5, 0))
    nail.nail()
    bob = world.system.body(shape=iota.Sphere(0.2), mass=2, position=(0.3, 4, 0), attachments=[(0, 0.2, 0)])
    world.system.bond(nail, bob.attachments[0], "spring", stiffness=60, damping=0.3, length=0.8)
    return bob


def wheel(world: iota.World) -> iota.Body:
    made = world.system.body(shape=iota.Cylinder(0.5, 0.1), mass=2, position=(0, 3, 0))
    world.system.revolute(made, at=(0, 3, 0), axis=(0, 0, 1), motor=(2, 5))
    return made


def geared(world: iota.World) -> iota.Body:
    """A wheel with a weight on its rim drives another one; a third carries the difference of both."""
    wheels = [
        world.system.body(shape=iota.Cylinder(0.2, 0.1), mass=2, position=(0.6 * k, 3, 0), orientation=("x", 90))
        for k in range(3)
    ]
    joints = [
        world.system.revolute(body, at=(0.6 * k, 3, 0), axis=(0, 0, 1), limits=(-9, 9)) for k, body in enumerate(wheels)
    ]
    joints[0].angle.spring = (3.0, 0.0, 1.0)
    world.system.gear(joints[0].angle, joints[1].angle, -1.5)
    world.system.couple([(joints[0].angle, 1.0), (joints[1].angle, 1.0), (joints[2].angle, -2.0)])
    return wheels[0]


def nut(world: iota.World) -> iota.Body:
    """It turns down a screw by its weight."""
    made = world.system.body(shape=iota.Cylinder(0.2, 0.1), mass=2, position=(0, 4, 0))
    world.system.screw(made, at=(0, 4, 0), axis=(0, 1, 0), lead=-0.6)
    return made


def bent_rods(world: iota.World) -> iota.Body:
    points = [world.system.body() for _ in range(2)]
    first, middle = (points[0].particle((x, 4, 0), mass=1) for x in (0, 0.5))
    knee, end = (points[1].particle((x, 4, 0), mass=1) for x in (0.5, 1))
    middle.combine(knee)
    first.nail()
    world.system.angle_spring(first, knee, end, 20, 0.2)
    return points[0]


def weights_over_pulleys(world: iota.World) -> iota.Body:
    system = world.system
    heavy, light = (
        system.body(shape=iota.Box((0.2, 0.2, 0.2)), mass=mass, position=(x, 3, 0)) for x, mass in ((0, 1.1), (1, 1))
    )
    over = [system.body().particle((x, 6, 0)) for x in (0, 1)]
    for pulley in over:
        pulley.nail()
    system.rope([heavy.attachment((0, 3.1, 0)), *over, light.attachment((1, 3.1, 0))])
    return heavy


def bead(world: iota.World) -> iota.Body:
    made = world.system.body(shape=iota.Sphere(0.05), mass=0.5, position=(-1, 3, 0))
    wire = [(x, 2 + x * x, 0) for x in (-1.5, -1, -0.5, 0, 0.5, 1, 1.5)]
    world.system.on_path(made.attachment((-1, 3, 0)), wire)
    return made


def crossed(world: iota.World) -> iota.Body:
    made = world.system.body(shape=iota.Box((1, 0.1, 0.1)), mass=2, position=(0.5, 4, 0))
    made.angular_velocity = (0, 1, 0)
    world.system.universal(made, at=(0, 4, 0), axis=(0, 0, 1), second_axis=(0, 1, 0))
    return made


def hung_on_a_wall(world: iota.World) -> iota.Body:
    wall = world.system.body(kind="static", shape=iota.Box((0.1, 1, 1)), position=(0, 5, 0))
    made = world.system.body(shape=iota.Box((0.2, 0.2, 0.2)), mass=1, position=(0.6, 4.5, 0))
    world.system.rod(made.attachment((0.6, 4.5, 0)), wall.attachment((0, 5, 0)))
    return made


def in_the_wind(world: iota.World) -> iota.Body:
    """The wind takes hold of attachments, too."""
    made = pendulum(world)
    for x in (0.35, 0.45):
        made.attachment((x, 2.7, 0))
    blown = world.system.group("blown")
    blown.add(made)
    blown.remove(made.attachments[0])
    world.system.field("wind", velocity=(0.5, 0, 0), drag=0.1, group=blown)
    return made


def pushed_to_and_fro(world: iota.World) -> iota.Body:
    """By a field and a spring that depend on the time."""
    nail, bob = (world.system.body().particle((0, y, 0), mass=1) for y in (5, 4))
    nail.nail()
    bob.velocity = (2, 0, 0)
    world.system.field("fx = cos(2*t)")
    world.system.bond(nail, bob, "energy = 0.5*k*(r - 1 - 0.05*sin(3*t))^2", k=80.0)
    return bob.body


def without_gravity(world: iota.World) -> iota.Body:
    made = world.system.body(shape=iota.Box((0.2, 0.2, 0.2)), mass=1, position=(0, 5, 0))
    made.angular_velocity = (0, 1, 0)
    world.system.field("energy = 0.5*m*((x - 1)^2 + (y - 5)^2 + z^2)", replaces_gravity=True)
    return made


def steered(world: iota.World) -> iota.Body:
    """By a function of the script, which has a number for each of its particles."""
    made = world.system.body()
    points = [made.particle((k, 5, 0), mass=1 + k, velocity=(0, 0, 1)) for k in range(3)]
    strengths = np.array([[1.0], [2.0], [3.0]])

    def steer(batch: iota.types.ParticleBatch) -> np.ndarray:
        assert [p.mass for p in batch.particles] == list(batch.mass) == [1, 2, 3]
        return strengths * ([0, 9.81, 0] + np.cos(2 * batch.time) * np.array([0.5, 0, 0])) - [0, 0, 0.2]

    group = world.system.group("steered")
    group.add(*reversed(points))
    world.system.field(steer, group=group)
    return made


def kept_apart(world: iota.World) -> iota.Body:
    p, q = (world.system.body().particle((x, 5, 0), mass=1) for x in (0, 0.5))
    world.system.rope(p, q, 0.8)
    p.nail()
    world.system.pair_force("soft_repulsion", cutoff=1.5, stiffness=4, length=1.5)
    return q.body


def marble(world: iota.World) -> iota.Body:
    """In a bowl that is a function, whose rim is of a shape."""
    point = world.system.body().particle((0.6, 5, 0), mass=1)
    bowl = world.system.body(kind="static", shape=iota.Sphere(0.1), position=(0, 5, 0))
    world.system.inside(point, lambda x, y, z: math.sqrt(x * x + y * y + z * z) - 1, bowl, size=1.0)
    world.system.outside(point, iota.Sphere(0.1), bowl)
    return point.body


def rolling_off(world: iota.World) -> iota.Body:
    """A ball on an egg, both held together."""
    made = world.system.body(shape=iota.Sphere(0.3), mass=1, position=(0, 6.3, 0))
    world.system.surface_to_surface(
        made, iota.Sphere(0.3), None, iota.Ellipsoid((4, 2, 4)), one_sided=False, at_b=(0, 5, 0)
    )
    made.velocity = (0.3, 0, 0.1)
    return made


@pytest.mark.parametrize(
    ("make", "seconds", "off"),
    [
        (in_the_wind, 5, 0.06),
        (pushed_to_and_fro, 2, 0.1),
        (without_gravity, 4, 0.05),
        (steered, 2, 0.1),
        (kept_apart, 2, 0.1),
        (marble, 3, 0.1),
        (rolling_off, 1, 0.05),
        (pendulum, 8, 0.06),
        (arm, 1.5, 0.05),
        (hung_on_a_spring, 5, 0.1),
        (wheel, 9, 0.01),
        (bent_rods, 2, 0.15),
        (geared, 2, 0.03),
        (nut, 1.5, 0.02),
        (weights_over_pulleys, 2, 0.05),
        (bead, 3, 0.1),
        (crossed, 1, 0.1),
        (hung_on_a_wall, 3, 0.1),
    ],
)
def test_what_joints_and_springs_hold_has_gone_on_with_its_energy_and_phase(
    make: Callable[[iota.World], iota.Body], seconds: float, off: float
) -> None:
    place, twin = Place(make), Place(make)
    place.freeze()
    place.run(0.1)  # the last stride is over
    while twin.system.step_count < place.system.step_count:
        twin.world.step()
    start = place.places()
    place.run(seconds)
    assert np.array_equal(place.places(), start), "nobody sees it"
    kinetic = 0.0
    for _ in range(round((seconds - 0.1) / DT)):
        twin.world.step()
        kinetic = max(kinetic, twin.system.energy.kinetic)
    place.eye[2] = 20.0
    place.run(0.1)
    gaps = []  # from when its last stride ended to when a look noticed that are some steps
    for _ in range(30):
        twin.world.step()
        gaps.append((np.abs(place.places() - twin.places()).max(), twin.system.energy.total))
    gap, wanted = min(gaps)
    assert gap < off
    assert place.system.energy.total == pytest.approx(wanted, abs=0.05 * kinetic)
    assert place.system.validate() == [] and place.system.worst_gap < 1e-6


def test_what_swung_for_long_has_lost_its_energy() -> None:
    place = Place(pendulum)
    place.system.damping = 0.1
    place.freeze()
    top = place.system.energy.total
    place.run(100.0)
    place.eye[2] = 20.0
    place.run(0.1)
    lowest = -2 * 9.81 * 0.5 + 2 * 9.81 * 3
    assert place.system.energy.total - lowest < 0.02 * (top - lowest)
    assert place.root.position.y == pytest.approx(2.5, abs=0.01)


def test_what_is_tied_to_something_in_full_stays_where_it_was() -> None:
    place = Place(arm)
    lower = place.system.constraints[1].b
    assert lower is not None
    place.world.levels.pin(lower)
    place.run(0.2)
    bodies, ties = Ties(place.system).around([place.root])
    assert set(bodies) == {place.root, lower} and len(ties) == 2
    place.world.levels.budget_ms = LITTLE
    place.run(0.5)
    assert lower.stride == 1 and place.root.stride == 1, "the shortest stride of an island counts"
    before = place.places()
    place.eye[2] = 20.0
    place.run(DT)
    assert np.abs(place.places() - before).max() < 0.2


def test_its_work_is_bounded() -> None:
    place = Place(hung(crowd.ladder))
    place.run(0.2)
    found = CatchUp(place.system, place.thing.bodies, 1e6, (), Places(place.system))
    pieces = 1
    while not found.go_on(0.0):
        pieces += 1
    of_copying = len(place.thing.bodies) // catching_up.AT_ONCE + 9
    assert pieces <= catching_up.STEPS + of_copying
    assert catch_up(place.system, place.thing.bodies, 1e6), "as after a few seconds"
    assert math.isfinite(place.system.energy.total) and place.system.validate() == []


def test_what_comes_into_sight_step_by_step_is_found_in_pieces_before_it_is_there() -> None:
    place = Place(box)
    place.freeze()
    place.run(3.0)
    place.eye[2] = 35.0
    place.run(0.1)
    assert place.root.position.y > 5
    taken: list[int] = []
    for step in range(240):
        place.eye[2] -= 4 * DT
        place.world.step()
        if place.root.position.y < 0.2:
            taken.append(step)
    assert place.eye[2] < 30 and taken
    came = 35 - 4 * DT * (taken[0] + 1)
    assert 30 < came < 33, "it lies there before it is seen"
    assert taken[0] - (35 - 33) / (4 * DT) > 10, "in pieces"


def test_what_was_moved_meanwhile_stays_there() -> None:
    place = Place(box)
    place.freeze()
    found = CatchUp(place.system, place.thing.bodies, 2.0, (), Places(place.system))
    assert not found.go_on(0.0)
    place.root.set_pose((0, 20, 0))
    assert found.go_on()
    assert not found.finish()
    assert place.root.position.y == pytest.approx(20)


def test_what_ends_while_it_is_copied_is_left_alone() -> None:
    place = Place(hung(crowd.ladder))
    place.run(0.2)
    found = CatchUp(place.system, place.thing.bodies, 2.0, (), Places(place.system))
    assert not found.go_on(0.0)
    place.thing.bodies[-1].destroy()
    assert found.go_on(0.0) and not found.finish()
    assert place.system.validate() == []


def test_only_obstacles_near_it_are_copied_however_many_there_are() -> None:
    place = Place(box)
    for number in range(300):
        place.world.add_static(looks.box((0.1, 0.1, 0.1)), (50 + number, 0.05, 0))
    place.world.add_static(looks.box((2, 1, 2)), (0, 0.5, 0))
    assert catch_up(place.system, place.thing.bodies, 3.0)
    assert place.root.position.y == pytest.approx(1.1, abs=2e-3), "on the block, which was made last"


def test_what_is_replayed_has_the_same_bits() -> None:
    place = Place(box)
    place.system.start_recording()
    place.freeze()
    place.run(1.0)
    place.eye[2] = 20.0
    place.run(0.1)
    recording = place.system.stop_recording()
    assert iota.System().replay(recording) is None


@pytest.mark.parametrize("value", [-1, float("nan"), float("inf")])
def test_a_sight_is_a_length(value: float) -> None:
    with pytest.raises(ValueError, match="sight must be a length"):
        iota.World(iota.System()).levels.sight = value


# --- what a copy meets on its way, and what it leaves behind ---------------------------------------------------------------


def left_alone(system: iota.System, bodies: list[iota.Body], seconds: float) -> bool:
    """Frozen for a time, and then caught up."""
    for body in bodies:
        body.stride = 0
    for _ in range(round(seconds / DT)):
        system.step(DT)
    return catch_up(system, bodies, seconds)


@pytest.mark.parametrize("seconds", [2.0, 8.0])
def test_what_a_field_takes_far_stops_at_a_wall_there(seconds: float) -> None:
    system = iota.System(gravity=(0, 0, 0))
    system.usual_material = iota.Material(touches="obstacles")
    system.obstacle(iota.Box((1, 50, 50)), (15, 0, 0))
    cart = system.body(shape=iota.Box((0.2, 0.2, 0.2)), mass=0.1, position=(0, 5, 0))
    system.field("fx = m*10 - c*vx", c=0.01)
    assert left_alone(system, [cart], seconds)
    assert cart.position.x == pytest.approx(14.4, abs=1e-3) and system.validate() == []


def test_a_copy_passes_through_what_its_body_passes_through() -> None:
    system = iota.System()
    system.usual_material = iota.Material()
    floor = system.obstacle(iota.Box((10, 1, 10)), (0, 0, 0))
    ghost, solid = (system.body(shape=iota.Box((1, 1, 1)), mass=1, position=(x, 3, 0)) for x in (-2, 2))
    system.ignore_contacts(ghost, floor)
    assert left_alone(system, [ghost, solid], 1.0)
    assert ghost.position.y < -1.8 and solid.position.y == pytest.approx(1, abs=1e-3)


def test_bodies_that_pass_through_each_other_do_so_as_copies() -> None:
    system = iota.System(gravity=(0, 0, 0))
    system.usual_material = iota.Material()
    pair = [system.body(shape=iota.Box((1, 1, 1)), mass=1, position=(x, 3, 0)) for x in (0, 1.5)]
    group = system.group("both")
    group.add(*pair)
    system.ignore_contacts(group, group)
    pair[0].velocity = (2, 0, 0)
    assert left_alone(system, pair, 1.0)
    assert pair[0].position.x == pytest.approx(2) and pair[1].position.x == 1.5


@pytest.mark.parametrize("is_nailed", [False, True])
def test_what_others_attract_goes_on_from_where_it_was(is_nailed: bool) -> None:
    """A planet without its sun would fly off: its energy would come from nothing."""
    system = iota.System(gravity=(0, 0, 0))
    sun, planet = system.body().particle((0, 0, 0), mass=100), system.body().particle((1, 0, 0), mass=1)
    planet.velocity = (0, 10, 0)
    if is_nailed:
        sun.nail()
    system.pair_force("gravity", cutoff=5, strength=1)
    assert not left_alone(system, [planet.body], 1.0)
    assert planet.position.x == 1
    planet.position = (9, 0, 0)
    assert left_alone(system, [planet.body], 1.0), "nobody is near"


def test_a_shoal_swims_on_though_others_obey_the_same_laws() -> None:
    """Not so beside a fish of another shoal, which its own ones keep away from."""
    places = []
    for is_left in (True, False):
        system = iota.System(damping=0.02)
        world = iota.World(system, ground=0.0)
        shoals = [
            crowd.shoal(world, iota.Vec3(3 * crowd.APART * number, crowd.HEIGHT, 0), "#888888", 1)
            for number in range(3)
        ]
        for _ in range(60):
            system.step(DT)
        if is_left:
            assert left_alone(system, shoals[1], 1.5)
        else:
            for _ in range(180):
                system.step(DT)
        places.append(np.array([list(fish.position) for fish in shoals[1]]))
        if not is_left:
            shoals[0][0].position = shoals[1][0].position + (0.3, 0, 0)
            assert not left_alone(system, shoals[1], 1.5)
    assert np.abs(places[0] - places[1]).max() < 0.1


@pytest.mark.parametrize(
    "text",
    [
        "fx = " + " + ".join(["sin(t)"] * 60),  # 60 times the number of its time would make it too long
        "a = t; fx = exp(-a) + t0*t^2 - dt_*sin(t)^2",
        "fx = " + "(" * 49 + "t" + ")" * 49,
        "b = 1; c = 2; fx = -t^2 + a*b*c",
    ],
)
def test_expressions_of_the_time_are_those_of_the_world(text: str) -> None:
    places = []
    for is_left in (True, False):
        system = iota.System(gravity=(0, 0, 0))
        leaf = system.body().particle((0, 5, 0), mass=1)
        names = {name: 0.3 for name in ("t0", "dt_", "a") if name in text and f"{name} =" not in text}
        system.field(text, **names)
        for _ in range(60):
            system.step(DT)
        if is_left:
            assert left_alone(system, [leaf.body], 1.0)
        else:
            for _ in range(480):
                system.step(DT / 4)
        places.append(leaf.position.x)
    assert places[0] == pytest.approx(places[1], abs=2e-3)


def test_an_expression_that_is_nearly_too_long_is_not_copied() -> None:
    system = iota.System()
    leaf = system.body().particle((0, 5, 0), mass=1)
    system.field("fx = t" + " " * 990)
    assert not left_alone(system, [leaf.body], 0.5)
    assert leaf.position.y == 5


@pytest.mark.parametrize("end", ["destroy", "switch off"])
def test_a_field_that_ends_while_it_is_copied_leaves_its_bodies_where_they_were(end: str) -> None:
    system = iota.System(gravity=(0, 0, 0))
    leaf = system.body().particle((0, 5, 0), mass=1)
    field = system.field("fx = 10*m")
    found = CatchUp(system, [leaf.body], 2.0, (), Places(system))
    for _ in range(20):
        assert not found.go_on(0.0)
    if end == "destroy":
        field.destroy()
    else:
        field.active = False
    assert found.go_on() and not found.finish()
    assert leaf.position.x == 0 and system.energy.total == 0


def test_a_wall_that_is_destroyed_while_it_is_copied_is_no_longer_there() -> None:
    for pieces in range(30):
        system = iota.System()
        system.usual_material = iota.Material(touches="obstacles")
        walls = [system.obstacle(iota.Box((1, 1, 1)), (x, 0.5, 0)) for x in range(6)]
        cube = system.body(shape=iota.Box((0.2, 0.2, 0.2)), mass=1, position=(0, 3, 0))
        found = CatchUp(system, [cube], 2.0, (), Places(system))
        for _ in range(pieces):
            found.go_on(0.0)
        for wall in walls:
            wall.destroy()
        assert found.go_on() and found.finish()
        assert cube.position.y < 2.5 and system.validate() == []


def test_what_a_field_throws_out_of_the_world_is_left_alone() -> None:
    system = iota.System(gravity=(0, 0, 0))
    dart = system.body().particle((0, 5, 0), mass=1)
    dart.body.stride = 0
    system.field("fx = 1e12")
    assert not catch_up(system, [dart.body], 9.0)
    assert dart.position.x == 0
