# SPDX-License-Identifier: Apache-2.0
"""Functions that a world calls when things meet, part, reach a stop or break."""

from __future__ import annotations

import pytest

import iota


def run(world: iota.World, seconds: float) -> None:
    for _ in range(round(seconds * 120)):
        world.step()


def pendulum(world: iota.World, x: float = 0) -> iota.Constraint:
    """A bar that falls on a stop 0.5 rad below the level."""
    bar = world.system.body(shape=iota.Box((1, 0.1, 0.1)), mass=1, position=(x + 0.5, 0, 0))
    return world.system.revolute(bar, at=(x, 0, 0), axis=(0, 0, 1), limits=(-0.5, 3))


def test_a_stop_calls_when_it_is_reached_and_left() -> None:
    world = iota.World(iota.System(), dt=1 / 120)
    hinge, other = pendulum(world), pendulum(world, 5)
    told: list[tuple[str, str | None]] = []

    def stopped(event: iota.Event) -> None:
        assert event.name == "stop" and event.stop is not None and event.target == hinge.a
        assert event.stop.constraint == hinge and event.point is not None
        told.append((event.phase, event.stop.coordinate))

    world.on_stop(hinge)(stopped)

    run(world, 1)
    assert told == [("start", "angle")]
    hinge.a.angular_velocity = (0, 0, 2)
    world.step()
    assert told == [("start", "angle"), ("end", "angle")]
    assert world.events.forget(stopped)
    run(world, 2)
    assert len(told) == 2 and other.alive


def test_a_body_hears_of_its_own_stops_and_anything_of_all() -> None:
    world = iota.World(iota.System(), dt=1 / 120)
    hinges = [pendulum(world, 5 * i) for i in range(3)]
    own: list[iota.Body | None] = []
    all_of_them: list[str] = []
    some: list[iota.Body | None] = []
    world.on_stop(hinges[1].a)(lambda event: own.append(event.target))
    world.on_stop([hinges[0], hinges[2].a])(lambda event: some.append(event.target))
    world.on_stop(lambda event: all_of_them.append(event.phase))
    run(world, 1)
    assert own == [hinges[1].a] and all_of_them == ["start"] * 3
    assert some == [hinges[0].a, hinges[2].a]


def test_a_break_calls_the_script_which_may_edit_there() -> None:
    world = iota.World(iota.System(), dt=1 / 120, ground=None)
    system = world.system
    hook, load = system.body(kind="static").particle((0, 0, 0)), system.body().particle((0, -1, 0), mass=1)
    spring = system.bond(hook, load, "spring", stiffness=50)
    spring.break_force = 12
    rope = system.rope(hook, load, 1.05, break_force=1)
    hinge = system.body().particle((0, -1, 0), mass=5)
    hinge.combine(load)
    told: list[object] = []

    def broke(event: iota.Event) -> None:
        assert event.broken is not None and event.broken.force > 1
        told.append(event.broken.constraint or event.broken.bond)
        load.velocity = (0, 0, 0)  # between two steps: any edit may be made

    world.on_break(load.body)(broke)

    run(world, 1)
    assert told == [rope, spring]


def test_one_that_raises_is_switched_off_and_the_others_go_on(capsys: pytest.CaptureFixture[str]) -> None:
    world = iota.World(iota.System(), dt=1 / 120)
    hinges = [pendulum(world, 5 * i) for i in range(2)]
    heard: list[str] = []
    world.on_stop(lambda event: 1 / 0)
    world.on_stop(lambda event: heard.append(event.phase))
    run(world, 1)
    assert heard == ["start", "start"] and hinges[0].alive
    assert capsys.readouterr().err.count("ZeroDivisionError") == 1


@pytest.mark.parametrize("target", ["nothing", "everything", 3, []])
def test_values_that_are_no_things_are_refused(target: object) -> None:
    with pytest.raises(TypeError, match="must be a body, a constraint, several"):
        iota.World(iota.System()).on_stop(target)
