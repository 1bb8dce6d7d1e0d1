# SPDX-License-Identifier: Apache-2.0
"""What hands do to bodies, seen from the page: throws, and pulls that are far too far."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from typing import Any

import pytest
from page_client import PageClient

import iota
from iota import _protocol as protocol
from iota.world.clients import hand_frequency

Runner = Callable[[iota.World], str]


def test_a_thrown_body_keeps_the_velocity_of_the_hand(run_world: Runner) -> None:
    system = iota.System(gravity=(0, 0, 0))
    ball = system.body(shape=iota.Sphere(0.05), mass=0.2, position=(0, 1, 0))
    world = iota.World(system, ground=None)
    with PageClient(run_world(world)) as page:
        page.send("control", command=0, value=0)
        page.wait_for(lambda: page.last["world_state"]["paused"])
        page.send("grab_start", hold=1, body=page.body(0), local_point=(0, 0, 0), target=(0, 1, 0))
        hand = 1.5  # m/s
        for step in range(1, 100):
            page.send("grab_move", hold=1, target=(hand * world.dt * step, 1, 0))
            page.single_step()
        page.send("grab_end", hold=1)
        page.wait_for(lambda: world.call(lambda: world.users.held() is None))
        velocity = world.call(lambda: ball.velocity)
        assert velocity.x == pytest.approx(hand, rel=0.2)
        assert abs(velocity.y) + abs(velocity.z) < 0.05
        page.single_step()
        assert world.call(lambda: ball.velocity.x) == pytest.approx(velocity.x, rel=0.01)


@pytest.mark.parametrize("mass", [1e-3, 0.1, 100.0])
@pytest.mark.parametrize("size", [1e-3, 1.0, 1e3])
def test_a_pull_that_is_far_too_far_explodes_nothing(run_world: Runner, mass: float, size: float) -> None:
    system = iota.System(gravity=(0, -9.81 * size, 0), damping=0.5)
    links = iota.builder.chain(12, size, top=(0, 2 * size, 0), mass=mass).realize(system).bodies
    world = iota.World(system, ground=None)
    url = run_world(world)

    def figures() -> tuple[float, float]:
        reach = max(abs(p.position - iota.Vec3(0, 2 * size, 0)) for link in links for p in link.particles)
        return reach, system.energy.kinetic

    with PageClient(url) as page:
        page.send("grab_start", hold=1, body=page.body(6), local_point=(0, 0, 0), target=(0, size, 0))
        for target in ((3 * size, 3 * size, 0), (-1e3 * size, 0, 0), (0, 1e5 * size, 0), (1e5 * size, 0, 1e5 * size)):
            page.send("grab_move", hold=1, target=target)
            time.sleep(0.15)
            reach, kinetic = world.call(figures)
            assert math.isfinite(kinetic) and reach <= size * 1.001
        page.send("grab_end", hold=1)
        page.wait_for(lambda: world.call(lambda: world.users.held() is None))
        reach, kinetic = world.call(figures)
        # At most a hundred lengths of the chain or so in a second; targets were 100 000 of them away.
        assert kinetic < 0.5 * mass * (200 * size) ** 2 and reach <= size * 1.001


def test_a_body_that_is_destroyed_in_two_users_hands_ends_their_holds_and_nothing_else(run_world: Runner) -> None:
    system = iota.System(gravity=(0, 0, 0))
    ball = system.body(shape=iota.Sphere(0.05), mass=0.2, position=(0, 1, 0))
    system.body(shape=iota.Sphere(0.05), mass=0.2, position=(1, 1, 0))
    world = iota.World(system, ground=None)

    def holds() -> int:
        return world.call(
            lambda: sum(hold.grip.alive for client in world.users.clients for hold in client.holds.values())
        )

    url = run_world(world)
    with PageClient(url, "Ada") as ada, PageClient(url, "Bob") as bob:
        for page, x in ((ada, 0.2), (bob, -0.1)):
            page.send("grab_start", hold=1, body=page.body(0), local_point=(0, 0, 0), target=(x, 1, 0))
        ada.wait_for(lambda: holds() == 2)
        gone = ada.body(0)
        world.call(ball.destroy)
        for page in (ada, bob):
            page.wait_for(lambda page=page: 0 not in page.entities["body"] and page.last["poses"]["holds"] == [])
        for page in (ada, bob):  # both hands are still closed, and do not know yet
            page.send("grab_move", hold=1, target=(0.5, 1, 0))
        ada.send("grab_start", hold=2, body=gone, local_point=(0, 0, 0), target=(0, 1, 0))
        ada.wait_for(lambda: any(notice["title"] == "It no longer exists" for notice in ada.notices))
        ada.send("grab_end", hold=1)
        assert holds() == 0 and bob.notices == []
        bob.send("grab_end", hold=1)
        bob.send("grab_start", hold=1, body=bob.body(1), local_point=(0, 0, 0), target=(1.2, 1, 0))
        bob.wait_for(lambda: bob.places[1][0] > 1.05)
        assert world.call(lambda: world.users.held() == system.bodies[0]) and not ada.closed.is_set()


def test_two_users_hold_one_body_and_one_who_leaves_takes_only_his_own_hand(run_world: Runner) -> None:
    system = iota.System(gravity=(0, 0, 0), damping=2)
    system.body(shape=iota.Sphere(0.05), mass=0.2, position=(0, 1, 0))
    world = iota.World(system, ground=None)
    url = run_world(world)
    with PageClient(url, "Ada") as ada:
        with PageClient(url, "Bob") as bob:
            for page, x in ((ada, 1.0), (bob, -1.0)):
                page.send("grab_start", hold=1, body=page.body(0), local_point=(0, 0, 0), target=(x, 1, 0))
            ada.wait_for(lambda: len(ada.last["poses"]["holds"]) == 2)
            time.sleep(0.3)
            assert abs(ada.places[0][0]) < 0.2, "in balance between both"
        ada.wait_for(lambda: len(ada.last["poses"]["holds"]) == 1 and ada.places[0][0] > 0.9)


@pytest.mark.parametrize("target", [(math.nan, 0, 0), (0, math.inf, 0), (3e38, 0, 0), (0, -1e12, 0)])
def test_a_hand_that_is_nowhere_is_its_own_users_error_alone(run_world: Runner, target: tuple[float, ...]) -> None:
    system = iota.System(gravity=(0, 0, 0))
    system.body(shape=iota.Sphere(0.05), mass=0.2, position=(0, 1, 0))
    world = iota.World(system, ground=None)
    url = run_world(world)
    with PageClient(url, "Ada") as ada, PageClient(url, "Bob") as bob:
        bob.send("grab_start", hold=1, body=bob.body(0), local_point=(0, 0, 0), target=target)
        bob.wait_for(lambda: len(bob.notices) == 1)
        bob.send("grab_start", hold=2, body=bob.body(0), local_point=(0, 0, 0), target=(0.2, 1, 0))
        bob.wait_for(lambda: len(bob.last["poses"]["holds"]) == 1)
        bob.send("grab_move", hold=2, target=target)
        bob.wait_for(lambda: len(bob.notices) == 2 and abs(bob.places[0][0] - 0.2) < 0.1)
        step = ada.last["poses"]["step"]
        ada.wait_for(lambda: ada.last["poses"]["step"] > step + 10)
        assert ada.notices == [] and all(map(math.isfinite, ada.places[0]))


def test_a_hand_is_on_what_the_body_became_part_of_and_then_on_the_part_at_its_point(run_world: Runner) -> None:
    system = iota.System(gravity=(0, 0, 0))
    left, right = system.body(), system.body()
    for body, x in ((left, -1), (left, 0), (right, 0), (right, 1)):
        body.particle((x, 1, 0), mass=0.1)
    world = iota.World(system, ground=None)
    slots = left.slot, right.slot
    told: list[tuple[str, iota.Body | None]] = []

    @world.on_drag(right)
    def drag(event: iota.Event) -> None:
        told.append((event.phase, event.body))

    @world.on_release(right)
    def let_go(event: iota.Event) -> None:
        told.append(("release", event.body))

    with PageClient(run_world(world)) as page:

        def held() -> iota.Body | None:
            return world.call(world.users.held)

        def slot_held() -> int:
            return page.last["poses"]["holds"][0]["body"]

        page.send("grab_start", hold=1, body=page.body(slots[1]), local_point=(0.3, 0, 0), target=(0.8, 1, 0))
        page.wait_for(lambda: held() == right and page.last["poses"]["holds"])
        world.call(lambda: left.combine(right))
        page.wait_for(lambda: slot_held() == slots[0])
        assert held() == left
        (taken,) = world.call(lambda: left.parts[1].separate().created_bodies)
        page.wait_for(lambda: slot_held() == taken.slot)
        assert held() == taken and world.call(lambda: left.alive), "not on the rest of the body, which goes on to exist"
        page.send("grab_move", hold=1, target=(0.8, 1.1, 0))
        page.wait_for(lambda: told[-1] == ("update", taken))
        page.send("grab_end", hold=1)
        page.wait_for(lambda: held() is None)
        assert told[0] == ("start", right) and told[-2:] == [("end", taken), ("release", taken)]


@pytest.mark.parametrize("limit", [60.0, 20.0])
def test_a_hand_far_away_pulls_with_its_largest_force_and_no_more(limit: float) -> None:
    system = iota.System(gravity=(0, 0, 0))
    ball = system.body(shape=iota.Sphere(0.05), mass=2.0, position=(0, 1, 0))
    system.grip(ball, target=(1000, 1, 0), max_acceleration=limit)
    system.step(1 / 120)
    assert 0.8 * limit / 120 < ball.velocity.x <= limit / 120, "its damping takes some of it"


def hand(world: iota.World, *messages: object, body: iota.Body | None = None) -> None:
    """A user's hand does this, without a page; then the functions of a frame are called."""
    first = () if 5 in world._state.clients.by_id else (protocol.Join("Ada", protocol.Role.HOST),)
    inputs: list[Any] = [(5, message) for message in (*first, *messages)]
    world._inputs.take(inputs, lambda ids: [] if body is None else [body])
    world._inputs.frame()


def take_up(world: iota.World, body: iota.Body, target: tuple[float, float, float], seconds: float = 1.0) -> None:
    """A hand takes a body at its center and moves."""
    start = protocol.GrabStart(1, protocol.Id(0, 1), iota.Vec3(0, 0, 0), body.center_of_mass, "mouse")
    hand(world, start, protocol.GrabMove(1, iota.Vec3(*target)), body=body)
    run(world, seconds)


def run(world: iota.World, seconds: float) -> None:
    for _ in range(round(seconds / world.dt)):
        world.step()
        world._inputs.frame()


def box_on_ground() -> tuple[iota.World, iota.Body]:
    system = iota.System()
    box = system.body(shape=iota.Box((0.3, 0.3, 0.3)), mass=1, position=(0, 0.15, 0))
    world = iota.World(system, ground=0)
    world.offer("rewind")
    return world, box


@pytest.mark.parametrize("mode", ["energy_keeping", "robust"])
def test_a_hand_on_a_small_body_has_not_the_strength_for_a_large_one_beside_it(mode: Any) -> None:
    """It pulled 50 g with the strength for half of the 400 kg that they touched."""
    system = iota.System(mode=mode)
    system.usual_material = iota.Material(friction=0)
    system.obstacle(iota.HalfSpace((0, 1, 0)))
    system.body(shape=iota.Box((1, 1, 1)), mass=400, position=(-0.55, 0.5, 0))
    small = system.body(shape=iota.Box((0.1, 0.1, 0.1)), mass=0.05, position=(0, 0.05, 0))
    for _ in range(5):
        system.step(1 / 120)
    system.grip(small, target=small.position + iota.Vec3(10, 0, 0), max_acceleration=60)
    system.step(1 / 120)
    assert 60 < 120 * small.velocity.x < 3.5 * 60, "its damping takes some of five times as much"


def test_a_hand_lifts_a_tray_with_ten_times_its_weight_on_it() -> None:
    system = iota.System()
    system.usual_material = iota.Material(friction=0.5)
    system.obstacle(iota.HalfSpace((0, 1, 0)))
    tray = system.body(shape=iota.Box((0.5, 0.02, 0.4)), mass=0.5, position=(0, 0.01, 0))
    load = system.body(shape=iota.Box((0.2, 0.2, 0.2)), mass=5, position=(0, 0.12, 0))
    for _ in range(10):
        system.step(1 / 60)
    system.grip(tray, target=(0, 0.3, 0))
    for _ in range(120):
        system.step(1 / 60)
    assert tray.position.y > 0.15 and load.position.y == pytest.approx(tray.position.y + 0.11, abs=1e-3)


@pytest.mark.parametrize("lets_go_first", [False, True])
def test_a_hand_of_then_does_not_come_back_with_a_rewind(lets_go_first: bool) -> None:
    world, box = box_on_ground()
    take_up(world, box, (0, 1, 0), seconds=3)
    if lets_go_first:
        hand(world, protocol.GrabEnd(1))
    world.controls.act("rewind")
    hand(world, *(() if lets_go_first else (protocol.GrabEnd(1),)))
    assert box.center_of_mass.y > 0.5, "it was in the hand then"
    run(world, 2)
    assert box.center_of_mass.y == pytest.approx(0.15, abs=1e-3)


def test_a_hand_of_then_does_not_come_back_with_an_undo_or_a_redo_and_the_grip_of_the_script_does() -> None:
    system = iota.System(damping=3)
    links = iota.builder.chain(6, 1.2, top=(0, 2, 0)).realize(system).bodies
    ball = system.body(shape=iota.Sphere(0.1), mass=1, position=(2, 1, 0))
    world = iota.World(system, ground=None)
    world.offer("break", "undo", "redo")
    own = system.grip(ball)
    take_up(world, links[3], (1, 2, 0))
    world.controls.act("break", links[3])
    hand(world, protocol.GrabEnd(1))
    for move in (world.undo, world.redo, world.undo):
        assert move() and own.alive
        run(world, 0.1)
    run(world, 8)
    assert abs(links[3].center_of_mass.x) < 0.02, "nothing pulls at the chain"
    assert ball.center_of_mass.y > 0.9


@pytest.mark.parametrize("lets_go_first", [False, True])
def test_what_a_hand_carried_then_is_let_go_by_a_rewind(lets_go_first: bool) -> None:
    world, box = box_on_ground()
    world.tools.carry(box)
    statue = world.system.body(shape=iota.Box((0.3, 0.3, 0.3)), mass=1, position=(2, 1, 0))
    statue.kind = "scripted"
    take_up(world, box, (0, 1, 0), seconds=3)
    if lets_go_first:
        hand(world, protocol.GrabEnd(1))
    world.controls.act("rewind")
    hand(world)
    assert box.center_of_mass.y > 0.5 and (box.kind, statue.kind) == ("dynamic", "scripted")
    run(world, 2)
    assert box.center_of_mass.y == pytest.approx(0.15, abs=1e-3)
    # It can be carried again, also after a reset, which knows no hands.
    for begin in (run, lambda world, seconds: world.reset()):
        begin(world, 0.1)
        hand(world, protocol.GrabEnd(1))
        take_up(world, box, (0, 1, 0))
        assert box.kind == "scripted" and box.center_of_mass.y == pytest.approx(1)


def test_the_pull_of_a_socket_on_a_plug_of_then_ends_with_a_rewind() -> None:
    system = iota.System(gravity=(0, 0, 0), damping=2.0)
    place = system.body().particle((0, 1, 0))
    place.nail()
    plug = system.body().particle((1, 1, 0))
    world = iota.World(system, ground=None)
    world.offer("rewind")
    world.tools.socket(place, [plug], within=0.2, pull=3)
    take_up(world, plug.body, (0.35, 1, 0), seconds=1)
    hand(world, protocol.GrabMove(1, iota.Vec3(0.351, 1, 0)))
    run(world, 2)
    assert len(system.bonds) == 1
    hand(world, protocol.GrabEnd(1))
    assert len(system.bonds) == 0
    world.controls.act("rewind")
    assert len(system.bonds) == 0


def cube_in_world(size: float, gravity: float = 9.81) -> tuple[iota.World, iota.Body]:
    system = iota.System(gravity=(0, -gravity, 0))
    cube = system.body(shape=iota.Box((size, size, size)), density=500, position=(0, size / 2, 0))
    world = iota.World(system, ground=0)
    run(world, 0.2)
    return world, cube


@pytest.mark.parametrize("size", [0.01, 0.03, 0.1, 0.3])
def test_a_hand_gives_way_under_a_body_by_a_tenth_of_its_size_and_throws_it(size: float) -> None:
    world, cube = cube_in_world(size)
    take_up(world, cube, (0, 3 * size, 0), seconds=1.5)
    heights = []
    for _ in range(60):
        run(world, world.dt)
        heights.append(cube.center_of_mass.y)
    assert heights[-1] == pytest.approx(3 * size, abs=0.1 * size + 1e-6 if size < 0.3 else 0.05)
    assert max(heights) - min(heights) < 1e-3 * size, "it hangs still"
    # The hand goes on sideways at five sizes per second, and opens.
    speed = 5 * size
    for step in range(1, 61):
        hand(world, protocol.GrabMove(1, iota.Vec3(speed * world.dt * step, 3 * size, 0)))
        run(world, world.dt)
    hand(world, protocol.GrabEnd(1))
    assert cube.velocity.x == pytest.approx(speed, rel=0.1) and abs(cube.velocity.z) < 0.01 * speed
    run(world, 2)
    assert cube.center_of_mass.y == pytest.approx(size / 2, abs=0.02 * size) and abs(cube.velocity) < 0.01 * speed


@pytest.mark.parametrize("size", [1e-3, 0.01, 0.03, 0.1])
def test_a_hand_that_is_pulled_away_and_pressed_on_the_ground_explodes_nothing(size: float) -> None:
    world, cube = cube_in_world(size)
    take_up(world, cube, (0, -10, 0), seconds=1)
    assert abs(cube.center_of_mass.y - size / 2) < 0.3 * size
    for target in ((50, 50, 0), (-50, 1, 0), (0, 3 * size, 0)):
        hand(world, protocol.GrabMove(1, iota.Vec3(*target)))
        for _ in range(60):
            run(world, world.dt)
            assert abs(cube.velocity) < 3, "no faster than a hand that holds a large body"
    run(world, 2)
    assert abs(cube.velocity) < 1


@pytest.mark.parametrize(("size", "gravity"), [(0.5, 9.81), (2.0, 9.81), (0.01, 0.0), (0.01, 0.05)])
def test_a_hand_on_what_is_large_or_light_is_as_soft_as_ever(size: float, gravity: float) -> None:
    world, cube = cube_in_world(size, gravity)
    assert hand_frequency(cube, world.dt) == 2.5


def test_a_hand_on_a_link_is_as_stiff_as_all_that_hangs_on_it_needs() -> None:
    system = iota.System()
    links = iota.builder.chain(3, 0.03, top=(0, 2, 0), nailed=False).realize(system).bodies
    assert hand_frequency(links[0], 1 / 120) > 6
    long = iota.builder.chain(30, 3, top=(1, 2, 0)).realize(system).bodies
    assert hand_frequency(long[0], 1 / 120) == 2.5
    assert hand_frequency(links[0], 1 / 4) == 2.5, "a long step resolves no more"
