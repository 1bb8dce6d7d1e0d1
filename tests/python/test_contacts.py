# SPDX-License-Identifier: Apache-2.0
"""Contacts as arrays, functions that are called when bodies touch, and bodies that pass through each other."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import iota

G = 9.81


def make_system(friction: float = 0.5) -> tuple[iota.System, iota.Body]:
    """With a ground at height 0."""
    system = iota.System()
    system.usual_material = iota.Material(friction=friction)
    return system, system.obstacle(iota.HalfSpace((0, 1, 0)), material=iota.Material(friction=friction))


def make_box(system: iota.System, x: float, y: float, size: float = 0.2) -> iota.Body:
    return system.body(shape=iota.Box((size, size, size)), position=(x, y, 0))


def make_ball(system: iota.System, x: float, y: float) -> iota.Body:
    return system.body(shape=iota.Sphere(0.1), position=(x, y, 0))


def run(world: iota.World, seconds: float) -> None:
    for _ in range(round(seconds * 120)):
        world.step()


@pytest.mark.parametrize("size", [0.02, 2.0])
def test_arrays_of_contacts_carry_the_weight_and_show_the_friction(size: float) -> None:
    system, ground = make_system(0.4)
    box, other = make_box(system, 0, size / 2, size), make_box(system, 3 * size, size / 2, size)
    box.velocity = (4 * size**0.5, 0, 0)
    assert len(system.contacts) == 0
    assert system.contacts.positions.shape == (0, 3)
    system.step(1 / 120, count=5)
    contacts = system.contacts
    assert [(each.body, each.other) for each in contacts] == [(box, ground)] * 4 + [(other, ground)] * 4
    assert contacts.slots.tolist() == [[box.slot, ground.slot]] * 4 + [[other.slot, ground.slot]] * 4
    weight = box.mass * G
    loads = np.bincount(contacts.slots[:, 0], contacts.normal_forces)
    assert loads[box.slot] == pytest.approx(weight, rel=1e-3) and loads[other.slot] == pytest.approx(weight, rel=1e-3)
    assert contacts.sliding.tolist() == [True] * 4 + [False] * 4
    assert contacts.friction[contacts.sliding].sum(axis=0) == pytest.approx([-0.4 * weight, 0, 0], rel=1e-3, abs=1e-6)
    assert contacts.forces == pytest.approx(contacts.normal_forces[:, None] * contacts.normals + contacts.friction)
    assert contacts.slips[:4] == pytest.approx(box.velocity.x, rel=1e-6)
    assert contacts.slips[4:] == pytest.approx(0, abs=1e-9)
    assert np.abs(contacts.gaps).max() < 1e-6 * size and contacts.positions[:, 1] == pytest.approx(0, abs=1e-6 * size)
    assert box.force_from(ground).y == pytest.approx(weight, rel=1e-3)
    assert ground.force_from(box).y == pytest.approx(-weight, rel=1e-3)
    assert box.force_from(other) == (0, 0, 0)
    last = contacts[-1]
    assert last.body == other and last.friction == last.force - last.force.y * last.normal and not last.sliding
    assert len(box.contacts) == 4 and box.contacts[0].slip == contacts[0].slip
    contacts.forces[:] = 0  # a copy
    assert contacts.forces[0, 1] > 0
    with pytest.raises(IndexError, match="there are 8 contacts, and no number 8"):
        contacts[8]


def test_a_function_is_called_when_a_touch_begins_and_ends() -> None:
    system, _ = make_system()
    world = iota.World(system, dt=1 / 120, ground=None)
    ball, other = make_ball(system, 0, 0.5), make_ball(system, 1, 0.1)
    told: list[tuple[str, float]] = []

    @world.on_contact(ball)
    def hit(event: iota.Event) -> None:
        assert event.name == "contact" and event.contact is not None and event.point is not None
        assert event.body == ball and event.contact.body == ball and event.other == event.contact.other
        assert event.contact.began == (event.phase == "start")
        if event.phase == "start":
            assert event.contact.normal == pytest.approx((0, 1, 0)) and event.point.x == pytest.approx(0, abs=1e-6)
            fall = (2 * G * 0.4) ** 0.5
            assert event.contact.speed == pytest.approx(fall, rel=0.05)
            assert event.contact.impulse == pytest.approx(ball.mass * fall, rel=0.05)
        told.append((event.phase, system.time))

    run(world, 1)
    assert told == [("start", pytest.approx((2 * 0.4 / G) ** 0.5, abs=1 / 60))]
    ball.velocity = (0, 2, 0)
    world.step()
    assert [phase for phase, _ in told] == ["start", "end"]
    assert world.events.forget(hit) and not world.events.forget(hit)
    run(world, 1)
    assert len(told) == 2 and other.alive


def test_filters_choose_among_pairs_groups_and_strengths() -> None:
    system, ground = make_system()
    world = iota.World(system, dt=1 / 120, ground=None)
    slow, fast = make_ball(system, 0, 0.1), make_ball(system, 1, 1.0)
    heavy = system.group("heavy")
    heavy.add(fast.particles[0])
    told: dict[str, list[iota.Body | None]] = {}

    def note(name: str) -> object:
        return lambda event: told.setdefault(name, []).append(event.target)

    world.on_contact(note("all"))
    world.on_contact(ground, slow)(note("ground"))
    world.on_contact(b=heavy)(note("heavy"))
    world.on_contact([slow, heavy], min_speed=1)(note("speed"))
    world.on_contact(min_impulse=1e6)(note("never"))
    world.on_contact(slow, fast)(note("never"))
    run(world, 0.6)
    assert told == {"all": [slow, fast], "ground": [ground], "heavy": [ground], "speed": [fast]}


def test_a_body_may_be_destroyed_by_its_touch_and_the_end_is_told() -> None:
    system, ground = make_system()
    world = iota.World(system, dt=1 / 120, ground=None)
    ball = make_ball(system, 0, 0.3)
    told: list[tuple[str, iota.Body | None, iota.Body | None]] = []

    @world.on_contact(ball)
    def hit(event: iota.Event) -> None:
        told.append((event.phase, event.target, event.other))
        if event.phase == "start":
            event.body.destroy()

    world.on_contact(lambda event: told.append((event.phase, event.target, event.other)))
    run(world, 0.5)
    assert told == [("start", ball, ground), ("end", None, ground)]


def test_a_reset_tells_nothing_and_the_run_tells_the_same_again() -> None:
    system, _ = make_system()
    world = iota.World(system, dt=1 / 120, ground=None)
    make_ball(system, 0, 0.5)
    told: list[tuple[str, float]] = []
    world.on_contact(cooldown=10)(lambda event: told.append((event.phase, system.time)))
    run(world, 0.5)
    world.reset()
    assert len(told) == 1
    run(world, 0.5)
    assert told == [told[0], told[0]]


def test_a_watch_has_the_events_of_all_steps_of_a_call() -> None:
    system, ground = make_system()
    balls = [make_ball(system, x, 0.2 + 0.1 * x) for x in range(3)]
    watch = system.watch_contacts(b=ground, min_speed=0.5)
    system.step(1 / 120, count=60)
    assert [event.body for event in watch.events] == balls and all(event.began for event in watch.events)
    assert watch.events[2].speed > watch.events[0].speed > 0.5
    system.step(1 / 120)
    assert watch.events == []
    watch.end()
    balls[0].velocity = (0, 1, 0)
    system.step(1 / 120, count=10)
    assert watch.events == []


def test_bodies_and_groups_pass_through_each_other_on_request() -> None:
    system, ground = make_system()
    below, above, third = (make_box(system, 0, 0.1 + 0.2 * i) for i in range(3))
    system.ignore_contacts(below, above)
    fish = system.group("fish")
    fish.add(third.particles[0])
    system.ignore_contacts(fish, ground)
    system.ignore_contacts(fish, below)
    assert (below, above) in system.ignored_contacts and len(system.ignored_contacts) == 3
    system.step(1 / 120, count=60)
    assert above.position.y == pytest.approx(0.1, abs=1e-6)
    system.allow_contacts(above, below)
    assert len(system.ignored_contacts) == 2
    system.ignore_contacts(fish, above)
    system.step(1 / 120, count=60)
    assert third.position.y < -0.3


def test_a_sensor_counts_what_falls_through_it() -> None:
    system, ground = make_system()
    world = iota.World(system, dt=1 / 120, ground=None)
    hoop = system.obstacle(iota.Box((1, 0.1, 1)), position=(0, 1, 0), material=iota.Material(touches="sensor"))
    balls = [make_ball(system, 0, 1.5), make_ball(system, 5, 1.5), make_ball(system, 0.2, 2)]
    inside: list[iota.Body] = []
    most = 0

    @world.on_contact(b=hoop)
    def through(event: iota.Event) -> None:
        nonlocal most
        (inside.append if event.phase == "start" else inside.remove)(event.body)
        most = max(most, len(inside))

    run(world, 0.3)
    assert inside == [balls[0]]
    run(world, 1)
    assert inside == [] and most == 1 and balls[0].position.y == pytest.approx(0.1, abs=1e-5)
    assert repr(hoop.material) == "Material(friction=0.5, touches='sensor')" and ground.alive


MISTAKES = {
    "a number": (lambda s, b: s.watch_contacts(3), TypeError, "a must be a body, a group, several of them, or None"),
    "nothing": (lambda s, b: s.watch_contacts(b=[]), TypeError, "b must be a body, a group"),
    "a text": (lambda s, b: s.watch_contacts("all"), TypeError, "or None for any, not 'all'"),
    "less than nothing": (lambda s, b: s.watch_contacts(min_speed=-1), ValueError, "min_speed"),
    "no number": (lambda s, b: s.watch_contacts(cooldown=float("nan")), ValueError, "cooldown"),
    "itself": (lambda s, b: s.ignore_contacts(b, b), ValueError, "a body does not touch itself"),
    "a word": (lambda s, b: s.ignore_contacts(b, "ground"), TypeError, "b must be a body or a group, not 'ground'"),
    "another system's": (
        lambda s, b: s.ignore_contacts(b, iota.System().body(shape=iota.Sphere(1))),
        ValueError,
        "of one system",
    ),
    "a group of pages": (
        lambda s, b: iota.World(s).on_contact("nothing"),
        TypeError,
        "must be a body, a group, several",
    ),
}


@pytest.mark.parametrize("name", MISTAKES)
def test_what_makes_no_sense_is_refused(name: str) -> None:
    system, _ = make_system()
    use, error, text = MISTAKES[name]
    with pytest.raises(error, match=text):
        use(system, make_box(system, 0, 1))  # type: ignore[no-untyped-call]
    assert system.ignored_contacts == []


def test_a_function_is_not_registered_twice_for_the_same_touches() -> None:
    system, _ = make_system()
    world = iota.World(system, dt=1 / 120, ground=None)
    ball = make_ball(system, 0, 0.2)
    told: list[str] = []

    def hit(event: iota.Event) -> None:
        told.append(event.phase)

    world.on_contact(ball)(hit)
    with pytest.raises(ValueError, match="is registered by on_contact already"):
        world.on_contact(ball)(hit)
    world.on_contact(ball, min_speed=100)(hit)
    run(world, 0.3)
    assert told == ["start"]


@pytest.mark.parametrize("mode", ["energy_keeping", "robust", "accurate"])
@pytest.mark.parametrize("acceleration", [3.0, -3.0])
def test_a_box_weighs_more_on_a_lift_that_starts_and_less_on_one_that_stops(mode: Any, acceleration: float) -> None:
    """A jump of what moves as prescribed was in no force, and the mid-point rule told twice that of what begins to move."""
    system = iota.System(mode=mode)
    system.usual_material = iota.Material(friction=0.6)
    cabin = system.body("scripted", shape=iota.Box((1.6, 0.1, 1.6)), position=(0, 10, 0))
    box = system.body(shape=iota.Box((0.4, 0.4, 0.4)), mass=20, position=(0, 10.25, 0))
    system.step(1 / 120, 20)
    start, forces = system.time, []
    for _ in range(60):
        time = system.time - start + 1 / 120
        cabin.position = (0, 10 + 0.5 * acceleration * time * time, 0)
        system.step(1 / 120)
        forces.append(box.force_from(cabin).y)
    weight = 20 * (9.81 + acceleration)
    assert forces[2:] == pytest.approx([weight] * 58, rel=1e-6)
    assert sum(contact.force.y for contact in box.contacts) == pytest.approx(weight, rel=1e-6)


def test_what_absorbs_something_that_touches_nothing_still_touches() -> None:
    system = iota.System()
    system.usual_material = iota.Material(friction=0.5)
    system.obstacle(iota.HalfSpace((0, 1, 0)))
    box = system.body(shape=iota.Box((0.1, 0.1, 0.1)), mass=0.3, position=(0, 0.05, 0))
    nothing = iota.Material(touches="nothing")
    box.combine(system.body(shape=iota.Sphere(0.02), mass=0.01, position=(0, 0.11, 0), material=nothing))
    for _ in range(30):
        system.step(1 / 60)
    lowest = 0.05 - 0.01 / 0.31 * 0.06  # by the center of both, which is a little higher
    assert box.position.y > lowest


@pytest.mark.parametrize("lift", [0.0, 0.3])
@pytest.mark.parametrize("ground", ["box", "half-space"])
@pytest.mark.parametrize(
    "kind", ["planar", "deep planar", "prismatic", "deep prismatic", "cylindrical", "path", "surface", "inside"]
)
def test_what_a_joint_of_the_world_lets_fall_lands_on_the_obstacle_at_its_place(
    kind: str, ground: str, lift: float
) -> None:
    system = iota.System()
    system.usual_material = iota.Material(friction=0.3)
    if ground == "box":
        system.obstacle(iota.Box((20, 1, 20)), position=(0, -0.5, 0))
    else:
        system.obstacle(iota.HalfSpace())
    box = system.body(shape=iota.Box((0.4, 0.4, 0.4)), mass=1, position=(0, 0.2 + lift, 0))
    at = (0, -0.3 if "deep" in kind else 0, 0)
    if "planar" in kind:
        system.planar(box, at=at, axis=(0, 0, 1))
    elif "prismatic" in kind:
        system.prismatic(box, at=at, axis=(0, 1, 0))
    elif kind == "cylindrical":
        system.cylindrical(box, at=at, axis=(0, 1, 0))
    elif kind == "path":
        system.on_path(box.attachment((0, 0, 0)), [(0, -3, 0), (0, 0, 0), (0, 3, 0)])
    elif kind == "surface":
        system.on_surface(box.attachment((0, 0, 0)), iota.HalfSpace(), at=(0, 0, 0), orientation=("x", 90))
    else:
        system.inside(box.attachment((0, 0, 0)), iota.Sphere(5), at=(0, 0, 0))
    for _ in range(180):
        assert system.step(1 / 60).unconverged == 0
    assert box.position.y == pytest.approx(0.2, abs=1e-4)


def test_a_bead_on_a_bar_a_piston_in_a_block_and_a_wheel_on_its_axle_overlap_what_guides_them() -> None:
    """By the motion that they would have alone."""
    for kind in ("bead", "piston", "wheel", "drawer"):
        ways = []
        for has_obstacle in (False, True):
            system = iota.System()
            system.usual_material = iota.Material(friction=0.5)
            body = system.body(shape=iota.Box((0.2, 0.2, 0.2)), mass=1)
            if kind == "wheel":
                system.revolute(body, at=(0, 0, 0), axis=(0, 0, 1))
                body.angular_velocity = (0, 0, 3)
            else:
                system.prismatic(body, at=(0, 0, 0), axis=(1, 0, 0))
                body.velocity = (0.5, 0, 0)
            size = {"bead": (4, 0.05, 0.05), "piston": (2, 0.6, 0.6), "wheel": (0.05, 0.05, 1), "drawer": (3, 0.1, 3)}[
                kind
            ]
            if has_obstacle:
                system.obstacle(iota.Box(size), position=(0, -0.05 if kind == "drawer" else 0, 0))
            system.step(1 / 60, 60)
            ways.append((*body.position, *body.angular_velocity))
        assert ways[1] == pytest.approx(ways[0], abs=1e-12), kind
