# SPDX-License-Identifier: Apache-2.0
from __future__ import annotations

import math
from collections.abc import Callable

import pytest
from conftest import Runner
from page_client import PageClient

import iota
from iota.studies import _laboratory, cradle, lab, ladder


def test_the_room_is_rich_and_light_enough_for_a_headset() -> None:
    world = iota.World(iota.System())
    room = _laboratory.furnish(world)
    assert 50_000 < room.triangles < 75_000
    assert len(world.system.obstacles) < 40
    assert sum(len(body.solids[0].shape.triangles) for body in world.system.obstacles) == room.triangles


def test_surfaces_are_closed_and_turned_outwards() -> None:
    """By the volume that they enclose: `Mesh` refuses open ones."""
    room = _laboratory.Furniture()
    room.box(("paint", "#000000"), (1, 2, 3), (0.5, 0.2, 0.1), 0.3)
    room.box(("glass", "#000000"), (1, 2, 3), (0.5, 0.2, 0.1), 0.3, taper=0.5)
    room.turned(("wood", "#000000"), (1, 0, 0), [(0.2, 0), (0.2, 1)], 400)
    room.ball(("steel", "#000000"), (0, 1, 0), (0.3, 0.2, 0.1), 100, 200)
    volumes = [
        iota.Mesh(vertices, triangles).mass_properties.volume
        for pieces in room._pieces.values()
        for vertices, triangles in pieces
    ]
    assert volumes == pytest.approx([0.01, 0.01 * 7 / 12, math.pi * 0.04, 4 / 3 * math.pi * 0.006], rel=2e-3)


def test_both_toys_are_where_they_should_be_and_alive() -> None:
    world = lab.build()
    balls = [body for body in world.system.bodies if isinstance(getattr(body.solids[0], "shape", None), iota.Sphere)]
    start = [ball.center_of_mass for ball in balls]
    assert (
        min(ball.center_of_mass.y for ball in balls) > _laboratory.TOP + 0.016 + cradle.RADIUS
    )  # over the plate on the desk
    (axle,) = [joint for joint in world.system.constraints if joint.kind == "revolute" and joint.b is None]
    low = high = 0.0
    swings: list[float] = []
    while world.system.time < 4:
        report = world.step()
        assert report is not None and report.unconverged == 0
        blocks = [p for body in world.system.bodies if body not in balls for p in body.particles if p.mass > 0]
        low = min(low, *(p.position.y - lab.LADDER.y for p in blocks if abs(p.position.z - lab.LADDER.z) < 0.05))
        swings.append(balls[-1].center_of_mass.x - start[-1].x)
    assert axle.angle.value == pytest.approx(math.pi, abs=0.02)  # it has tipped by itself
    assert low > -7.2 * ladder.LENGTH and high == 0
    assert lab.LADDER.y - 7 * ladder.LENGTH > _laboratory.TOP  # it hangs clear of the desk
    assert max(swings) > 0.05  # the ball on the other side has left


def test_the_ladder_goes_on_by_itself_only_while_nobody_plays_with_the_cradle() -> None:
    world = lab.build()
    (axle,) = [joint for joint in world.system.constraints if joint.kind == "revolute" and joint.b is None]

    def run(until: float) -> None:
        while world.system.time < until:
            world.step()

    run(7.5)
    assert axle.angle.value == pytest.approx(math.pi, abs=0.02)
    world._state.actions["lift left"].hook.function()  # half a second before its story begins
    run(10.0)  # untouched, it would have tipped at 8 s
    assert axle.angle.value == pytest.approx(math.pi, abs=0.02)
    run(9.5 + ladder.PATIENCE)
    assert axle.angle.value == pytest.approx(0, abs=0.02)


def test_a_ladder_that_nobody_is_near_waits_where_time_is_short_and_goes_on_for_who_comes() -> None:
    world = lab.build()
    (thing,) = world.levels.things
    assert world.levels.budget_ms is not None
    place = iota.Vec3(0, 1.6, 6)
    world.levels.viewers = lambda: [place]
    world.levels.budget_ms = 1e-6
    while thing.level.name == "full" and world.system.time < 2:
        world.step()
    assert thing.level.name == "frozen"
    for _ in range(240):
        world.step()
    (axle,) = [joint for joint in world.system.constraints if joint.kind == "revolute" and joint.b is None]
    waits = axle.angle.value
    place = lab.LADDER + (0, 0.2, 1)
    for _ in range(480):
        report = world.step()
        assert report is not None and report.unconverged == 0
    assert thing.level.name == "full"
    assert abs(axle.angle.value - waits) > 1, "it has gone on"
    assert world.system.validate() == []


def test_a_hand_on_a_page_drags_a_ball_and_turns_the_cradle_on_its_desk(run_world: Runner) -> None:
    world = lab.build()
    balls = [body for body in world.system.bodies if isinstance(getattr(body.solids[0], "shape", None), iota.Sphere)]
    (frame,) = (body for body in world.system.bodies if body.name == "frame")
    start, out = balls[-1].center_of_mass, list[float]()
    world.on_step(lambda: out.append(balls[-1].center_of_mass.x - start.x))
    with PageClient(run_world(world)) as page:
        page.send("grab_start", hold=1, body=page.body(balls[-1].slot), local_point=(0, 0, 0), target=tuple(start))
        page.send("grab_move", hold=1, target=tuple(start + (0.06, 0.02, 0)))
        page.wait_for(lambda: len(out) > 240 and min(out[-240:]) > 0.05)  # a second, in which it would swing back
        page.send("grab_end", hold=1)
        page.wait_for(lambda: out[-1] < 0.01)
        at = world.call(lambda: tuple(frame.position))
        page.send(
            "grab_start", hold=2, body=page.body(frame.slot), local_point=(0, 0, 0), target=(at[0] + 0.1, *at[1:])
        )
        page.send("grab_move", hold=2, target=(at[0] + 0.1, at[1], at[2] - 0.1))
        page.wait_for(lambda: world.call(lambda: abs(abs(frame.orientation[1]) - math.sin(math.pi / 8)) < 1e-3))
        page.send("grab_end", hold=2)


def test_together_they_take_as_many_iterations_as_alone_and_stay_apart() -> None:
    """Counted, as times depend on what else the machine does."""

    def work(build: Callable[[], iota.World]) -> tuple[float, int]:
        world, iterations, articulates = build(), 0.0, 0
        while world.system.time < 3:
            report = world.step()
            iterations += report.iterations_mean * report.articulates
            articulates = max(articulates, report.articulates)
        return iterations, articulates

    (together, islands), (first, of_first), (second, of_second) = map(work, (lab.build, ladder.build, cradle.build))
    assert islands == of_first + of_second
    assert together < 1.2 * (first + second)
