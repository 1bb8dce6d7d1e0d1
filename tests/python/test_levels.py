# SPDX-License-Identifier: Apache-2.0
"""Complexity management: what matters least is simulated less until a step takes its budget. Judged by places and energies."""

from __future__ import annotations

import random
import time
from collections.abc import Callable, Iterator
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from page_client import PageClient

import iota
from iota import looks
from iota.builder import Structure
from iota.levels.arrays import REFUSED
from iota.levels.level import STANDARD, STIFF, Level
from iota.levels.managed import Managed
from iota.levels.things import Things
from iota.studies import crowd
from iota.world.clients import Client, Hold
from iota.world.levels import OWN_REST
from iota.world.visuals import Visuals

PLENTY, LITTLE = 1e4, 1e-6  # ms
FAR = 200.0  # m


@pytest.fixture
def made() -> Iterator[tuple[iota.World, list[iota.Body]]]:
    """Chains that swing, each farther away than the one before."""
    world = iota.World(iota.System(), ground=None)
    roots = [chain(world.system, (0, 0, -20.0 * number)) for number in range(6)]
    world.levels.viewers = lambda: [(0, 0, 2)]
    yield world, roots


def chain(system: iota.System, at: tuple[float, float, float], links: int = 5) -> iota.Body:
    made: list[iota.Body] = []
    for k in range(links):
        link = system.body()
        upper = link.particle(iota.Vec3(*at) + (0.3 * k, 0, 0))
        link.particle(iota.Vec3(*at) + (0.3 * (k + 1), 0, 0))
        if made:
            made[-1].particles[1].combine(upper)
        else:
            upper.nail()
        made.append(link)
    return made[0]


def run(world: iota.World, steps: int) -> None:
    for _ in range(steps):
        world.step()


def run_until(world: iota.World, condition: Callable[[], bool]) -> None:
    """Ten steps at a time: on a busy machine a step changes fewer levels."""
    for _ in range(50):
        run(world, 10)
        if condition():
            return
    raise AssertionError("it did not come to that")


def test_without_a_budget_nothing_changes(made: tuple[iota.World, list[iota.Body]]) -> None:
    world, roots = made
    run(world, 20)
    assert [root.stride for root in roots] == [1] * 6
    assert world.levels.things == [] and str(world.levels) == "no budget: all is full"


def test_a_budget_that_is_too_small_reduces_all_but_what_is_in_reach(
    made: tuple[iota.World, list[iota.Body]],
) -> None:
    world, roots = made
    world.levels.budget_ms = LITTLE
    run_until(world, lambda: [root.stride for root in roots[1:]] == [0] * 5)
    assert roots[0].stride == 1, "2 m from the viewer"
    assert world.levels.counts() == {"full": 1, "frozen": 5}
    assert {change.reason for change in world.levels.changes} == {"over budget"}
    assert "frozen" in str(world.levels)
    assert world.system.validate() == []


def test_all_is_full_again_within_a_second_after_the_load_falls(made: tuple[iota.World, list[iota.Body]]) -> None:
    world, roots = made
    world.levels.budget_ms = LITTLE
    run(world, 120)
    world.levels.budget_ms = PLENTY
    run(world, 120)
    assert world.levels.counts() == {"full": 6}
    assert all(len(root.articulate.bodies) == 5 for root in roots), "what was stiff came apart"


def test_little_time_is_given_to_many_things_at_strides_before_a_few_are_full(
    made: tuple[iota.World, list[iota.Body]],
) -> None:
    world, _ = made
    world.levels.budget_ms = LITTLE
    run(world, 120)
    arrays = world.levels._arrays
    rows = np.nonzero(arrays.level > 0)[0]
    arrays.significance[rows] = 1.0
    at, level, gain, cost = arrays.steps_up(rows, np.full(len(rows), 8.0))
    order = np.argsort(-gain / cost, kind="stable")
    names = [world.levels.things[rows[at[i]]].levels[level[i]].name for i in order]
    assert names == ["1/8"] * 5 + ["1/4"] * 5 + ["1/2"] * 5 + ["full"] * 5
    assert np.allclose(np.bincount(at, cost), 8.0), "up to the cost of all in full"
    assert np.allclose(np.bincount(at, gain), 1 - 0.05), "and to all of the significance"


def test_a_viewer_who_comes_finds_all_in_full(made: tuple[iota.World, list[iota.Body]]) -> None:
    world, roots = made
    place = [0.0, 0.0, 2.0]
    world.levels.viewers = lambda: [place]
    world.levels.budget_ms = LITTLE
    run(world, 100)
    for number in (5, 3, 1):  # teleports
        place[2] = -20.0 * number + 2
        world.step()
        assert roots[number].stride == 1 and len(roots[number].articulate.bodies) == 5
        run(world, 60)
        assert roots[number].stride == 1


def test_a_viewer_who_flies_past_finds_all_in_full(made: tuple[iota.World, list[iota.Body]]) -> None:
    world, roots = made
    eye = [0.0, 0.0, 2.0]
    world.levels.viewers = lambda: [eye]
    world.levels.budget_ms = LITTLE
    run(world, 60)
    passed = 0
    while eye[2] > -110:
        eye[0] = 1.5 * (eye[0] == 0.0)
        eye[2] -= 1.0
        world.step()
        for root in roots:
            places = [p.position for body in root.articulate.bodies for p in body.particles]
            if min(abs(place - iota.Vec3(*eye)) for place in places) < world.levels.reach - 0.1:
                passed += 1
                assert root.stride == 1
    assert passed > 20


def test_two_viewers_count_as_the_nearer_one(made: tuple[iota.World, list[iota.Body]]) -> None:
    world, roots = made
    world.levels.viewers = lambda: [(0, 0, 2), (0, 0, -102)]
    world.levels.budget_ms = LITTLE
    run(world, 100)
    assert roots[0].stride == roots[5].stride == 1 and roots[2].stride == 0


def test_what_is_pinned_or_has_a_significance_of_its_own_is_kept(made: tuple[iota.World, list[iota.Body]]) -> None:
    world, roots = made
    system = world.system
    told: list[str] = []
    for number, root in enumerate(roots[:5]):
        world.levels.manage(
            root.articulate,
            significance=lambda thing, number=number: 100.0 * number,
            on_level=lambda thing, level: told.append(level.name),
        )
    world.levels.pin(roots[5])
    world.levels.viewers = lambda: [(FAR, FAR, FAR)]
    run(world, 1)
    world.levels.budget_ms = LITTLE
    run(world, 60)
    assert roots[5].stride == 1
    assert "frozen" in told
    assert system.validate() == []


def test_what_the_script_says_of_one_thing_leaves_the_others_managed(made: tuple[iota.World, list[iota.Body]]) -> None:
    world, roots = made
    world.levels.pin(roots[3])
    world.levels.manage(roots[4].articulate, levels=["full", "1/4"])
    world.levels.budget_ms = LITTLE
    run(world, 100)
    assert [root.stride for root in roots[1:]] == [0, 0, 1, 4, 0]
    late = world.levels.manage(roots[5].articulate, levels=["full", "1/8"])  # it came under management by itself
    with pytest.raises(ValueError, match="is managed already"):
        world.levels.manage(roots[5])
    run(world, 60)
    assert late.level.name == "1/8" and len(world.levels.things) == 6
    world.levels.off()
    assert [root.stride for root in roots] == [1] * 6
    world.levels.budget_ms = LITTLE
    run(world, 100)
    assert [root.stride for root in roots[1:]] == [0, 0, 1, 4, 8], "what was said is known after `off`"
    assert world.system.validate() == []


def test_a_thing_of_several_articulates_has_one_level(made: tuple[iota.World, list[iota.Body]]) -> None:
    world, roots = made
    thing = world.levels.manage([roots[3], roots[4]], name="two chains")
    assert len(thing.bodies) == 10 and all(level.name != "stiff" for level in thing.levels)
    world.levels.budget_ms = LITTLE
    run(world, 150)
    assert thing.level.name == "frozen" and roots[3].stride == roots[4].stride == 0
    roots[4].articulate.bodies[-1].velocity = (0, 0, 1)
    for _ in range(12):
        world.step()
        if thing.level.name == "full":
            break
    assert roots[3].stride == roots[4].stride == 1, "an edit of one of them"
    assert [change.reason for change in world.levels.changes if change.thing == "two chains"][-1] == "touched"
    roots[3].destroy()
    world.levels.budget_ms = PLENTY
    run(world, 60)
    assert thing.root == roots[4] and thing.level.name == "full" and world.system.validate() == []


def test_a_loose_part_of_a_thing_that_comes_to_a_viewer_makes_it_full(
    made: tuple[iota.World, list[iota.Body]],
) -> None:
    """A fish of a shoal may leave it: where it was when it came under management counts no more."""
    world, _ = made
    system = world.system
    system.gravity = (0, 0, 0)
    rods = [system.body() for _ in range(3)]
    for number, rod in enumerate(rods):
        for x in (0.0, 0.3):
            rod.particle((x, number, -FAR))
    thing = world.levels.manage(rods)
    world.levels.budget_ms = LITTLE
    run(world, 150)
    assert thing.level.name == "frozen"
    rods[1].position = (0, 0, 0)
    run(world, 2)
    world.levels.budget_ms = 2 * LITTLE
    run(world, 150)
    assert thing.level.name == "full" and all(rod.stride == 1 for rod in rods)
    rods[1].position = (0, 1, -FAR)
    run(world, 150)
    assert thing.level.name == "frozen"


def test_a_thing_is_full_in_each_step_in_which_a_user_holds_a_loose_part_of_it(
    made: tuple[iota.World, list[iota.Body]],
) -> None:
    """The others were frozen in every ninth step."""
    world, roots = made
    thing = world.levels.manage([roots[4], roots[5]])
    world.levels.budget_ms = LITTLE
    run_until(world, lambda: thing.level.name == "frozen")
    client = world._state.clients.by_id[1] = Client(1)
    client.holds[1] = hold = Hold(1, 1, roots[4], roots[4])
    world._state.clients.grip(hold, roots[4], iota.Vec3(0, 0, 0), roots[4].position + (0, 0.5, 0))
    for _ in range(60):
        world.step()
        assert thing.level.name == "full" and all(body.stride == 1 for body in thing.bodies)


def test_a_part_that_an_undo_brings_back_belongs_to_its_thing(made: tuple[iota.World, list[iota.Body]]) -> None:
    world, roots = made
    thing = world.levels.manage([roots[3], roots[4], roots[5]])
    world.levels.budget_ms = LITTLE
    run(world, 150)
    assert thing.level.name == "frozen"
    with world.system.edit():
        roots[3].destroy()
    run(world, 60)
    assert thing.root == roots[4]
    world.system.undo()
    run(world, 60)
    assert roots[3] in thing.bodies and all(each.root != roots[3] for each in world.levels.things)
    assert thing.level.name == "frozen" and all(body.stride == 0 for body in thing.bodies)


def test_things_are_managed_without_a_look_at_all_others(monkeypatch: pytest.MonkeyPatch) -> None:
    """A look at all joints for each thing took a minute for a thousand of them."""
    world = iota.World(iota.System(), ground=None)
    looks = 0
    jointed = Things.jointed

    def counted(self: Things) -> set[iota.Body]:
        nonlocal looks
        looks += 1
        return jointed(self)

    monkeypatch.setattr(Things, "jointed", counted)
    things = []
    for number in range(20):
        door = world.system.body(shape=iota.Box((1, 1, 0.1)), mass=1, position=(0, 0, -5.0 * number))
        world.system.revolute(door, at=(-0.5, 0, -5.0 * number), axis=(0, 1, 0))
        things.append(world.levels.manage(door))
        things.append(world.levels.manage(chain(world.system, (3, 0, -5.0 * number))))
    world.levels.budget_ms = LITTLE
    run(world, 2)
    assert looks <= 1
    assert [thing.is_jointed for thing in things] == [True, False] * 20


def test_what_is_made_and_what_is_parted_is_managed_soon(made: tuple[iota.World, list[iota.Body]]) -> None:
    world, roots = made
    world.levels.budget_ms = LITTLE
    run(world, 60)
    late = chain(world.system, (0, 0, -150.0))
    above, tail = roots[3].articulate.bodies[2:4]
    above.particles[1].separate(tail.particles[0])
    run(world, 120)
    assert late.stride == tail.stride == 0
    assert world.system.validate() == []


def test_what_is_near_at_its_far_end_is_full() -> None:
    world = iota.World(iota.System(gravity=(0, 0, 0)), ground=None)
    root = chain(world.system, (0, 0, 0), links=40)  # 12 m
    world.levels.viewers = lambda: [(12.0, 0.0, 2.0)]
    world.levels.budget_ms = LITTLE
    run(world, 60)
    assert root.stride == 1


def test_things_are_called_by_their_names_and_kinds() -> None:
    world = iota.World(iota.System(), ground=None)
    system = world.system
    for number, name in enumerate(["rope", "rope", ""]):
        root = chain(system, (0, 0, -20.0 * number), links=3)
        root.name = name
        world.levels.manage(root.articulate)
    ball = system.body(shape=iota.Sphere(0.1), mass=1, position=(0, 5, 0))
    assert world.levels.manage(ball).name == f"sphere {ball.slot}"
    assert [thing.name for thing in world.levels.things[:3]] == [
        "3 rods 'rope'",
        f"3 rods 'rope {world.levels.things[1].root.slot}'",
        f"3 rods from rod {world.levels.things[2].root.slot}",
    ]


def test_an_edit_makes_full_at_once(made: tuple[iota.World, list[iota.Body]]) -> None:
    world, roots = made
    world.levels.budget_ms = LITTLE
    run(world, 100)
    roots[3].articulate.bodies[-1].velocity = (0, 0, 1)
    world.system.step(world.dt)
    assert roots[3].stride == 1


def test_where_the_engine_ends_strides_they_are_not_tried_at_once_again(
    made: tuple[iota.World, list[iota.Body]],
) -> None:
    """A torn flag was full and at half rate in turns, for ever, and never frozen."""
    world, roots = made
    world.levels.budget_ms = LITTLE
    run_until(world, lambda: roots[-1].stride == 0)
    thing = next(each for each in world.levels.things if each.root == roots[-1])
    thing._set_stride(1)  # as if something had touched it
    run(world, 120)
    changes = [change.after for change in world.levels.changes if change.thing == thing.name]
    assert changes[changes.index("full") :] == ["full", "frozen"]


def test_what_hangs_on_a_beam_takes_its_strides() -> None:
    world = crowd.build(3, None)
    run(world, 20)
    roots = [thing.root for thing in world.levels.things]
    for root in roots:
        root.articulate.stride = 4
    run(world, 9)
    steps = world.system.array(roots).work[:, 1]
    assert steps.tolist() == [4, 4, 4], "an acrobat, a rope ladder and a chain, beside gallows and each other"
    assert world.system.validate() == []


def test_a_thing_that_is_destroyed_just_after_stiffness_ends_is_no_error() -> None:
    world = iota.World(iota.System(gravity=(0, 0, 0)), ground=None)
    first, second = world.system.body(), world.system.body()
    first.particle((0, 0, 0)), first.particle((0.3, 0, 0))
    second.particle((0.3, 0, 0)).combine(first.particles[1])
    second.particle((0.6, 0, 0))
    thing = world.levels.manage(first.articulate, levels=["full", "stiff"])
    world.levels.viewers = lambda: [(0, 0, 90)]
    world.levels.budget_ms = LITTLE
    run(world, 60)
    assert thing.level.name == "stiff"
    world.system.body().particle((5, 0, 0))  # articulates were counted just now
    run(world, 2)
    world.levels._change(thing, 0, 1.0, 0.0, "in reach")
    for body in thing.bodies:
        body.destroy()
    run(world, 10)
    assert world.levels.things == [] and world.system.validate() == []


def test_things_that_joints_tie_together_are_reduced_together_however_little_time_there_is() -> None:
    world = iota.World(iota.System(), ground=None)
    wheels = [world.system.body(shape=iota.Cylinder(0.2, 0.1), mass=2, position=(0.6 * k, 3, 0)) for k in range(4)]
    joints = [world.system.revolute(body, at=body.position, axis=(0, 0, 1)) for body in wheels]
    for joint, other in pairwise(joints):
        world.system.gear(joint.angle, other.angle, -1.0)
    world.levels.viewers = lambda: [(0, 0, 90)]
    world.levels.budget_ms = LITTLE
    run(world, 120)
    assert [body.stride for body in wheels] == [0, 0, 0, 0]
    world.levels.pin(wheels[3])
    run(world, 60)
    assert [body.stride for body in wheels] == [1, 1, 1, 1]
    changes = len(world.levels.changes)
    run(world, 60)
    assert len(world.levels.changes) == changes, "what is tied to something pinned is not tried again and again"


def test_stiff_things_keep_momentum_and_gain_no_energy() -> None:
    system = iota.System(gravity=(0, 0, 0))
    root = chain(system, (0, 0, 0))
    root.particles[0].release()
    root.articulate.bodies[-1].velocity = (0, 2, 1)
    system.step(0.01)
    thing = Managed("chain", root, STANDARD, 1.5, root.particles[0])
    energy, momentum, spin = system.energy.kinetic, system.momentum, system.angular_momentum
    places = [list(p.position) for body in thing.bodies for p in body.particles]
    thing._set_stiff(True, Visuals())
    assert len(thing.bodies) == 1
    assert energy >= system.energy.kinetic > 0.1 * energy
    stiff = system.energy.kinetic
    thing._set_stiff(False, Visuals())
    assert len(thing.bodies) == 5 and len(thing.root.articulate.bodies) == 5
    assert system.energy.kinetic == pytest.approx(stiff, rel=1e-9)
    assert abs(system.momentum - momentum) < 1e-12 and abs(system.angular_momentum - spin) < 1e-12
    after = np.array([list(p.position) for body in thing.bodies for p in body.particles])
    nearest = np.linalg.norm(after[:, None] - np.array(places)[None], axis=2).min(axis=1)
    assert len(after) == len(places) and nearest.max() < 1e-7, "a straight chain is a line"
    assert system.validate() == []


def test_a_level_of_ones_own_is_entered_and_left(made: tuple[iota.World, list[iota.Body]]) -> None:
    world, roots = made
    calls: list[str] = []
    far = Level(
        "far",
        quality=0.5,
        share=0.1,
        enter=lambda thing: calls.append("enter"),
        leave=lambda thing: calls.append("leave"),
    )
    world.levels.manage(roots[4].articulate, levels=["full", far])
    world.levels.budget_ms = LITTLE
    run_until(world, lambda: calls == ["enter"])
    world.levels.budget_ms = PLENTY
    run_until(world, lambda: calls == ["enter", "leave"])


def test_a_level_whose_function_raises_is_told_and_not_tried_again(
    made: tuple[iota.World, list[iota.Body]], capsys: pytest.CaptureFixture[str]
) -> None:
    world, roots = made

    def fail(thing: Managed) -> None:
        raise RuntimeError("no such model")

    thing = world.levels.manage(roots[4].articulate, levels=["full", Level("far", share=0.1, quality=0.5, enter=fail)])
    world.levels.budget_ms = LITTLE
    run(world, 80)
    assert thing.is_pinned
    assert capsys.readouterr().err.count("RuntimeError: no such model") == 1


def test_a_world_that_is_too_slow_reduces_by_itself_what_nobody_sees(made: tuple[iota.World, list[iota.Body]]) -> None:
    world, roots = made
    levels, slow, enough = world.levels, 0.5, 1e4
    levels._keep_pace(slow, LITTLE)
    run(world, 10)
    assert levels.budget_ms is None, "nobody looks"
    world._state.clients.by_id[1] = Client(1)
    levels.pin(roots[5])
    levels._keep_pace(slow, LITTLE)
    assert "to keep up with real time" in str(levels)
    run(world, 200)
    at = [thing.level.name for thing in sorted(levels.things, key=lambda thing: thing.root.slot)]
    assert at == ["full", "1/8", "1/8", "frozen", "frozen", "full"], "2, 22, 42, ... m away, the last one pinned"
    for _ in range(100):
        roots[1].articulate.bodies[-1].velocity += (0, 0, 1e-6)  # ends its strides, and it may not be frozen
        world.step()
    assert all(change.before != change.after for change in levels.changes)
    levels.viewers = lambda: [(0, 0, -20.0 * 3 + 20)]  # one of them comes into sight
    run(world, 60)
    assert roots[3].stride == 8
    for _ in range(3):
        levels._keep_pace(1.0, enough)
        run(world, 60)
    assert [root.stride for root in roots] == [1] * 6
    for _ in range(OWN_REST + 2):
        levels._keep_pace(1.0, enough)
    assert levels.budget_ms is None
    levels._keep_pace(slow, LITTLE)
    assert levels.budget_ms is not None
    levels.off()
    levels._keep_pace(slow, LITTLE)
    assert levels.budget_ms is None, "this is for good"
    levels.budget_ms = PLENTY
    levels._keep_pace(slow, LITTLE)
    assert levels.budget_ms == PLENTY
    assert world.system.validate() == []


def test_a_served_world_gives_itself_a_budget_while_a_page_shows_it(run_world: Callable[[iota.World], str]) -> None:
    world = iota.World(iota.System(), ground=None, dt=1e-5)  # no machine takes these steps in time
    chain(world.system, (0, 0, 0))
    url = run_world(world)
    time.sleep(0.3)
    assert world.levels.budget_ms is None
    with PageClient(url) as page:
        page.wait_for(lambda: world.levels.budget_ms is not None)
    end = time.monotonic() + 10
    while world.levels.budget_ms is not None and time.monotonic() < end:
        time.sleep(0.01)
    assert world.levels.budget_ms is None


@pytest.mark.parametrize("value", [0, -1, float("nan"), float("inf")])
def test_a_budget_is_above_zero(value: float) -> None:
    world = iota.World(iota.System())
    with pytest.raises(ValueError, match="budget_ms must be above 0"):
        world.levels.budget_ms = value
    with pytest.raises(ValueError, match="reach must be"):
        world.levels.reach = -1


def test_wrong_levels_are_refused(made: tuple[iota.World, list[iota.Body]]) -> None:
    world, roots = made
    manage = world.levels.manage
    with pytest.raises(ValueError, match="no level is called 'half'"):
        manage(roots[0], levels=["full", "half"])
    with pytest.raises(ValueError, match="levels begin with 'full'"):
        manage(roots[1], levels=["1/2"])
    with pytest.raises(ValueError, match="stiff if it is one articulate"):
        manage([roots[2], roots[3]], levels=["full", "stiff"])
    with pytest.raises(TypeError, match="manage takes"):
        manage([])
    manage(roots[0])
    with pytest.raises(ValueError, match="is managed already, as '5 rods from rod "):
        manage(roots[0])
    system = world.system
    door = system.body(shape=iota.Box((1, 1, 1)), position=(0, 50, 0))
    frame = system.body(shape=iota.Box((1, 1, 1)), position=(2, 50, 0))
    system.revolute(door, frame, at=(1, 50, 0), axis=(0, 1, 0))
    with pytest.raises(ValueError, match="joints would end"):
        manage([door], levels=["full", "stiff"])


@pytest.mark.parametrize(
    "viewers",
    [lambda: None, lambda: ["a"], lambda: [None], lambda: (1.0, 2.0, 3.0), lambda: 1 / 0, lambda: [(1, 2, 3, 4)]],
)
def test_viewers_that_fail_are_told_and_the_eyes_of_users_count(
    made: tuple[iota.World, list[iota.Body]], viewers: Any, capsys: pytest.CaptureFixture[str]
) -> None:
    world, roots = made
    world.camera = iota.Camera(position=(0, 0, 2))
    world.levels.viewers = viewers
    world.levels.budget_ms = LITTLE
    run(world, 60)
    told = capsys.readouterr().err
    assert ("levels.viewers must return a list of places" in told or "ZeroDivision" in told) and told.count(
        "Error"
    ) == 1
    assert world.levels.viewers is None and roots[0].stride == 1 and roots[5].stride != 1


def test_a_place_of_two_numbers_is_a_place(made: tuple[iota.World, list[iota.Body]]) -> None:
    world, roots = made
    world.levels.viewers = lambda: [(0, 1)]
    world.levels.budget_ms = LITTLE
    run(world, 60)
    assert world.levels.viewers is not None and roots[0].stride == 1


@pytest.mark.parametrize(
    ("given", "error", "words"),
    [
        ({"name": ""}, TypeError, "name of a level"),
        ({"stride": -1}, ValueError, "level 'x': stride must be"),
        ({"stride": 17}, ValueError, "1 to 16, or 0"),
        ({"stride": 2.5}, ValueError, "stride must be"),
        ({"quality": float("nan")}, ValueError, "quality must be a number from 0 to 1"),
        ({"share": -0.1}, ValueError, "share must be a number from 0 to 1"),
        ({"enter": 3}, TypeError, "level 'x': enter must be a function"),
        ({"structure": 3}, TypeError, "structure must be a function"),
    ],
)
def test_a_level_without_sense_is_refused(given: dict[str, Any], error: type[Exception], words: str) -> None:
    with pytest.raises(error, match=words):
        Level(**{"name": "x", **given})


def test_wrong_arguments_of_manage_are_refused(made: tuple[iota.World, list[iota.Body]]) -> None:
    world, roots = made
    wrong: list[tuple[dict[str, Any], type[Exception], str]] = [
        ({"levels": [3]}, TypeError, "names or of the type Level"),
        ({"levels": ["full", "frozen", "frozen"]}, ValueError, "two levels 'frozen'"),
        ({"levels": [Level("full", stride=4)]}, ValueError, "begin with 'full'"),
        ({"significance": 3}, TypeError, "significance must be a function"),
        ({"on_level": "loud"}, TypeError, "on_level must be a function"),
        ({"name": 3}, TypeError, "name of a thing must be a text"),
    ]
    for given, error, words in wrong:
        with pytest.raises(error, match=words):
            world.levels.manage(roots[0].articulate, **given)
    with pytest.raises(ValueError, match="another one"):
        world.levels.manage(chain(iota.System(), (0, 0, 0)).articulate)
    assert world.levels.things == []


def test_an_undo_after_off_does_not_bring_strides_back(made: tuple[iota.World, list[iota.Body]]) -> None:
    world, roots = made
    world.levels.budget_ms = LITTLE
    run(world, 120)
    reduced = world.system.snapshot()
    world.levels.budget_ms = None
    run(world, 5)
    world.system.restore(reduced)
    assert roots[3].stride == 0
    run(world, 1)
    assert [root.stride for root in roots] == [1] * 6


def test_what_was_stiff_twice_has_the_shape_that_it_had() -> None:
    system = iota.System()
    system.usual_material = iota.Material(friction=0.5)
    world = iota.World(system, ground=None)
    root = crowd.ladder(world, iota.Vec3(0, 3.4, 0), "#888888", 1)
    thing = world.levels.manage(root.articulate)
    energy = system.energy.total
    for _ in range(2):
        thing._set_stiff(True, Visuals())
        run(world, 1)
        thing._set_stiff(False, Visuals())
        for _ in range(12):
            report = world.step()
            assert report is not None and report.worst_gap < 1e-4
            assert sum(len(body.contacts) for body in thing.bodies) == 0
    assert system.energy.total < energy + 1


def test_what_the_script_has_welded_stays_welded() -> None:
    world = iota.World(iota.System(), ground=None)
    welded = chain(world.system, (0, 0, 0))
    links = welded.articulate.bodies
    links[3].combine(links[4])
    block, other = (world.system.body(shape=iota.Box((1, 1, 1)), mass=1, position=(x, 0, 0)) for x in (8, 9))
    block.combine(other)
    eye = [0.0, 0.0, FAR]
    world.levels.viewers = lambda: [eye]
    world.levels.manage(welded.articulate, levels=["full", "1/4", "stiff"])
    for _ in range(3):
        eye[2] = FAR
        world.levels.budget_ms = LITTLE
        run(world, 90)
        assert world.levels.things[0].level.name == "stiff" and len(welded.articulate.bodies) == 2
        eye[2] = 1.0
        run(world, 10)
        assert [len(body.parts) for body in welded.articulate.bodies] == [1, 1, 1, 2]
    world.levels.off()
    run(world, 2)
    assert [len(body.parts) for body in welded.articulate.bodies] == [1, 1, 1, 2]
    assert len(block.parts) == 2 and world.system.validate() == []


def test_what_is_joined_to_something_pinned_is_never_reduced(made: tuple[iota.World, list[iota.Body]]) -> None:
    world, roots = made
    pinned, other = roots[3], roots[4]
    world.levels.pin(pinned)
    world.levels.manage(other.articulate, levels=["full", "1/8"])
    world.levels.budget_ms = LITTLE
    run(world, 10)
    with world.system.edit():
        pinned.articulate.bodies[-1].particles[1].combine(other.articulate.bodies[-1].particles[1])
    for _ in range(80):
        world.step()
        assert pinned.stride == other.stride == 1
    assert pinned.articulate == other.articulate
    assert sum(thing._has(pinned) for thing in world.levels.things) == 1


def test_what_is_joined_to_something_stiff_comes_apart_and_is_near_with_all_its_points() -> None:
    world = iota.World(iota.System(), ground=None)
    near, far = chain(world.system, (0, 0, 0)), chain(world.system, (1.5, 0, 0))
    eye = [0.0, 0.0, FAR]
    world.levels.viewers = lambda: [eye]
    for root in (near, far):
        world.levels.manage(root.articulate, levels=["full", "stiff"])
    world.levels.budget_ms = LITTLE
    run(world, 60)
    assert [len(root.articulate.bodies) for root in (near, far)] == [1, 1]
    with world.system.edit():
        near.particles[-1].combine(far.particles[0])
    run(world, 40)
    assert len(world.levels.things) == 1
    thing = world.levels.things[0]
    eye[:] = [3.0, 0.0, 2.0]
    run(world, 10)
    assert thing.level.name == "full" and len(thing.bodies) == 10 and world.system.validate() == []


def test_an_undo_inside_of_a_change_leaves_nothing_reduced_that_counts_as_full(
    made: tuple[iota.World, list[iota.Body]],
) -> None:
    world, roots = made
    eye = [0.0, 0.0, 2.0]
    world.levels.viewers = lambda: [eye]
    undone: list[int] = []

    def undo(thing: Managed, level: Level) -> None:
        if level.name == "full" and not undone:
            undone.append(world.system.step_count)
            world.system.undo()

    thing = world.levels.manage(roots[5].articulate, levels=["full", "1/8"], on_level=undo)
    other = world.levels.manage(roots[4].articulate, levels=["full", "1/8"])
    world.levels.budget_ms = LITTLE
    run(world, 60)
    with world.system.edit():
        roots[3].particles[0].release()  # to be undone
    run(world, 3)
    assert roots[4].stride == roots[5].stride == 8
    world.levels.pin(other)
    run(world, 2)
    eye[2] = -99.0
    run(world, 1)
    assert undone
    run(world, 2)
    assert thing.level.name == other.level.name == "full"
    assert roots[4].stride == roots[5].stride == 1


def test_what_an_undo_brings_back_is_managed_again(made: tuple[iota.World, list[iota.Body]]) -> None:
    world, roots = made
    thing = world.levels.manage(roots[5].articulate, levels=["full", "1/8"])
    world.levels.manage(roots[0].articulate)
    world.levels.budget_ms = LITTLE
    run(world, 60)
    assert roots[5].stride == 8
    with world.system.edit():
        for body in roots[5].articulate.bodies:
            body.destroy()
    run(world, 40)
    assert thing not in world.levels.things
    while not roots[5].alive:
        world.system.undo()
    run(world, 10)
    assert thing in world.levels.things
    world.levels.off()
    assert roots[5].stride == 1


def test_a_joint_that_is_made_later_is_not_ended_by_stiffness() -> None:
    world = iota.World(iota.System(), ground=None)
    first, other = chain(world.system, (0, 0, 0)), chain(world.system, (0, 0, -20))
    world.levels.viewers = lambda: [(0, 0, FAR)]
    for root in (first, other):
        world.levels.manage(root.articulate, levels=["full", "1/4", "stiff"])
    links = first.articulate.bodies
    rope = world.system.rope(links[0].particles[1], links[4].particles[1])
    world.levels.budget_ms = LITTLE
    run(world, 90)
    assert rope.alive and len(first.articulate.bodies) == 5
    assert len(other.articulate.bodies) == 1, "this one is stiff"
    assert [thing.level.name for thing in world.levels.things] == ["1/4", "stiff"]


def test_off_makes_all_full(made: tuple[iota.World, list[iota.Body]]) -> None:
    world, roots = made
    world.levels.budget_ms = LITTLE
    run(world, 100)
    world.levels.off()
    assert [root.stride for root in roots] == [1] * 6 and world.levels.things == []
    run(world, 5)
    assert world.system.validate() == []


def test_the_costs_have_a_row_for_management(made: tuple[iota.World, list[iota.Body]]) -> None:
    world, _ = made
    run(world, 3)
    assert "levels" not in world.clock.costs
    world.levels.budget_ms = LITTLE
    run(world, 3)
    assert 0 < world.clock.costs["levels"] < 1


def test_a_reset_finds_the_levels_of_the_start(made: tuple[iota.World, list[iota.Body]]) -> None:
    world, roots = made
    world.levels.budget_ms = LITTLE
    run(world, 100)
    world.levels.budget_ms = PLENTY
    world.reset()
    run(world, 3)
    assert world.levels.counts() == {"full": 6} and [root.stride for root in roots] == [1] * 6


def test_what_is_replayed_has_the_same_bits() -> None:
    world = iota.World(iota.System(), ground=None)
    for number in range(4):
        chain(world.system, (0, 0, -20.0 * number))
    world.levels.viewers = lambda: [(0, 0, 2)]
    world.system.start_recording()
    world.levels.budget_ms = LITTLE
    run(world, 60)
    world.levels.budget_ms = PLENTY
    run(world, 60)
    recording = world.system.stop_recording()
    assert iota.System().replay(recording) is None


@pytest.mark.parametrize("seed", range(6))
def test_random_scenes_budgets_and_viewers_keep_the_promises(seed: int) -> None:
    dice = random.Random(seed)
    system = iota.System()
    world = iota.World(system, ground=None)
    roots = [
        chain(system, tuple(dice.uniform(-30, 30) for _ in range(3)), dice.randint(2, 6))
        for _ in range(dice.randint(2, 8))
    ]
    place = [0.0, 0.0, 0.0]
    world.levels.viewers = lambda: [tuple(place), (dice.uniform(-9, 9), 0, 0)]
    start = system.energy.total
    edits = 0
    for step in range(120):
        if step % 10 == 0:
            world.levels.budget_ms = 10 ** dice.uniform(-5, 1)
            place[:] = [dice.uniform(-30, 30) for _ in range(3)]
        choice = dice.random()
        alive = [root for root in roots if root.alive]
        if choice < 0.02 and len(alive) > 1:
            dice.choice(alive).destroy()
            edits += 1
        elif choice < 0.04:
            grip = system.grip(dice.choice(alive), (0, 0, 0), tuple(place))
            world.step()
            grip.destroy()
            edits += 1
        report = world.step()
        assert report is not None and report.unconverged == 0
        assert abs(system.energy.balance) < 1e-6 * max(1.0, system.energy.kinetic)
        assert edits or system.energy.total <= start + 1e-4 * max(1.0, system.energy.kinetic)
    assert system.validate() == []


@pytest.mark.parametrize("stride", [8, 0])
@pytest.mark.parametrize("tie", ["contact", "rope", "spring"])
def test_a_scripted_body_moves_on_with_what_takes_strides_or_is_frozen(tie: str, stride: int) -> None:
    """It stood still while something frozen lay on it, and then threw that up with 29 m/s."""

    def run(stride: int) -> tuple[iota.Body, iota.Body]:
        system = iota.System()
        system.usual_material = iota.Material()
        lift = system.body("scripted", shape=iota.Box((2, 0.2, 2)), mass=9, attachments=[(0, 0, 0)])
        box = system.body(shape=iota.Box((0.4, 0.4, 0.4)), mass=5, position=(0, 0.3, 0), attachments=[(0, 0.2, 0)])
        if tie != "contact":
            box.position = (0, -2, 0)
        if tie == "rope":
            system.rope(lift.attachments[0], box.attachments[0])
        elif tie == "spring":
            system.bond(lift.attachments[0], box.attachments[0], "spring", stiffness=500, damping=9)
        system.step(count=60)
        box.stride = stride
        for step in range(60):
            lift.position = (0, 0.5 * (step + 1) / 60, 0)
            system.step()
            assert abs(lift.position.y - 0.5 * (step + 1) / 60) < 1e-9, "it is where the script has put it"
        assert abs(box.velocity) < 2.5
        box.stride = 1
        system.step(count=30)
        assert system.validate() == []
        return lift, box

    (_, full), (_, box) = run(1), run(stride)
    assert abs(box.center_of_mass - full.center_of_mass) < (0.02 if tie == "spring" else 1e-3)


@pytest.mark.parametrize("level", ["stiff", "frozen", "own"])
def test_what_is_pushed_by_something_in_a_hand_is_full(level: str) -> None:
    """It stayed stiff all the while, and was frozen in one of eight steps."""
    system = iota.System()
    system.usual_material = iota.Material()
    world = iota.World(system, ground=0.0)
    world.levels.viewers = lambda: [(0, 1.7, 20.0)]
    left = system.body(shape=iota.Box((0.4, 0.4, 0.4)), mass=2, position=(0, 0.2, 0), attachments=[(0.2, 0, 0)])
    right = system.body(shape=iota.Box((0.4, 0.4, 0.4)), mass=2, position=(0.5, 0.2, 0), attachments=[(-0.3, 0, 0)])
    left.attachments[0].combine(right.attachments[0])
    ball = system.body(shape=iota.Sphere(0.3), mass=9, position=(-0.6, 0.3, 0))
    own = Level("own", share=0.1, quality=0.5, enter=lambda thing: None)
    thing = world.levels.manage(left.articulate, levels=["full", own if level == "own" else level])
    world.levels.budget_ms = LITTLE
    run_until(world, lambda: thing.level.name == level)
    client = world._state.clients.by_id[1] = Client(1)
    client.holds[1] = hold = Hold(1, 1, ball, ball)
    world._state.clients.grip(hold, ball, iota.Vec3(0, 0, 0), ball.position)
    reduced, touches = 0, 0
    for _ in range(60):
        hold.move(ball.position + (0.3, 0, 0))
        world.step()
        touches += any(contact.other in thing.bodies for contact in ball.contacts)
        reduced += touches > 0 and thing.level.name != "full"
    assert touches > 10 and reduced <= 1, "it is full in the step after the first touch"
    assert thing.position.x > 0.3


def test_bodies_that_were_one_get_back_what_was_their_own() -> None:
    """All had the name, color, look and material of the first one, and passed through what one of them did."""
    system = iota.System()
    system.usual_material = iota.Material()
    world = iota.World(system, ground=0.0)
    links = [
        system.body(
            shape=iota.Box((0.3, 0.1, 0.1)),
            mass=1,
            position=(0.4 * k, 0.05, 0),
            attachments=[(x, 0, 0) for x in (-0.2, 0.2)],
        )
        for k in range(4)
    ]
    for one, other in pairwise(links):
        one.attachments[1].combine(other.attachments[0])
    wall = system.obstacle(iota.Box((1, 1, 1)), (9, 0, 0))
    system.ignore_contacts(links[3], wall)
    system.ignore_contacts(links[0], links[2])
    group = system.group("marked")
    group.add(links[1])
    for k, link in enumerate(links):
        link.name, link.color, link.damping = f"link {k}", f"#{k}{k}{k}{k}{k}{k}", 0.1 * k
        link.material = iota.Material(friction=0.1 * k)
        world.draw(link, looks.solid("brass" if k % 2 else "wood"))

    def told() -> list[Any]:
        materials = [link.material for link in thing.bodies]
        drawn = [world.scene.look_of(link) for link in thing.bodies]
        pairs = {frozenset(getattr(side, "name", side) for side in pair) for pair in system.ignored_contacts}
        marked = [set(link.particles) <= set(group.particles) for link in thing.bodies]
        return [(b.name, b.color, b.damping) for b in thing.bodies] + [materials, drawn, pairs, marked]

    thing = world.levels.manage(links[0].articulate, levels=["full", "stiff"])
    world.levels.viewers = lambda: [(0, 0, FAR)]
    before = told()
    for _ in range(2):
        world.levels.budget_ms = LITTLE
        run_until(world, lambda: thing.level.name == "stiff")
        assert len(thing.bodies) == 1
        world.levels.budget_ms = PLENTY
        run_until(world, lambda: thing.level.name == "full")
        assert told() == before and system.validate() == []
    world.levels.budget_ms = LITTLE
    run_until(world, lambda: thing.level.name == "stiff")
    thing.bodies[0].color = "#abcdef"
    world.levels.off()
    assert [link.color for link in thing.bodies] == ["#abcdef"] * 4, "what the script has painted stays so"
    assert [link.name for link in thing.bodies] == [f"link {k}" for k in range(4)]


def test_what_touches_is_frozen_together_or_not_at_all() -> None:
    """Half of a wall was said to be frozen, none of it was, and levels changed in each step."""
    system = iota.System()
    system.usual_material = iota.Material()
    world = iota.World(system, ground=0.0)
    boxes = [
        system.body(shape=iota.Box((0.4, 0.2, 0.4)), mass=9, position=(0.5 * (k // 4) + x, 0.1 + 0.2 * (k % 4), 0))
        for x in (0, 30)
        for k in range(12)
    ]
    world.levels.viewers = lambda: [(15, 0, FAR)]
    world.levels.pin(boxes[-1])
    world.levels.budget_ms = LITTLE
    run_until(world, lambda: all(box.stride == 0 for box in boxes[:12]))
    run(world, 60)
    before = len(world.levels.changes)
    run(world, 120)
    assert [box.stride for box in boxes] == [0] * 20 + [1] * 4, "what the pinned one stands on would be woken by it"
    assert len(world.levels.changes) - before < 12
    world.levels.budget_ms = PLENTY
    run_until(world, lambda: world.levels.counts() == {"full": 24})
    assert all(box.stride == 1 for box in boxes)


def test_what_touched_may_take_strides_again_when_it_has_parted() -> None:
    system = iota.System()
    system.usual_material = iota.Material()
    world = iota.World(system, ground=0.0)
    boxes = [system.body(shape=iota.Box((0.4, 0.2, 0.4)), mass=9, position=(0, 0.1 + 0.2 * k, 0)) for k in range(2)]
    eye = [0.0, 0.0, FAR]
    world.levels.viewers = lambda: [tuple(eye)]
    world.levels.budget_ms = LITTLE
    run_until(world, lambda: all(box.stride == 0 for box in boxes))
    eye[2] = 1.0
    run(world, 3)
    assert world.levels.counts() == {"full": 2}
    world.levels.budget_ms = PLENTY
    system.gravity = (0, 0, 0)
    for k, box in enumerate(boxes):
        box.position = (0, 30, 40 * k)
    run(world, REFUSED + 10)
    eye[2], before = FAR, len(world.levels.changes)
    world.levels.budget_ms = LITTLE
    run_until(world, lambda: all(box.stride == 0 for box in boxes))
    assert "1/2" in [change.after for change in world.levels.changes[before:]]


@pytest.mark.parametrize("way", ["off", "restore and off", "off and restore", "off and undo"])
def test_off_makes_one_body_several_again_whatever_was_restored_before_or_after(way: str) -> None:
    """They stayed one body, or a structure stayed in their place, for ever."""
    for level in (STIFF, Level("far", share=0.1, quality=0.5, structure=lambda thing: ball(thing.mass))):
        world = iota.World(iota.System(gravity=(0, 0, 0)), ground=None)
        system = world.system
        links = chain(system, (0, 0, 0)).articulate.bodies
        links[0].particles[0].release()
        thing = world.levels.manage(links[0].articulate, levels=["full", level])
        world.levels.viewers = lambda: [(0, 0, FAR)]
        world.levels.budget_ms = LITTLE
        run_until(world, lambda thing=thing: len(thing.bodies) == 1)
        snapshot = system.snapshot()
        with system.edit():
            system.body(shape=iota.Box((1, 1, 1)), position=(0, 9, 0)).destroy()
        world.levels.budget_ms = PLENTY
        run_until(world, lambda thing=thing: len(thing.bodies) == 5)
        for act in way.split(" and "):
            if act == "off":
                world.levels.off()
            else:
                run(world, 1)
                system.restore(snapshot) if act == "restore" else system.undo()
        run(world, 2)
        assert sum(body.active for body in system.bodies) == len(system.bodies) == 5 and system.validate() == []


def ball(mass: float) -> Structure:
    made = Structure()
    made.body(shape=iota.Sphere(0.1), mass=mass)
    return made


def test_a_negative_stride_is_told_as_it_was_given() -> None:
    """It was told as 4294967295."""
    body = chain(iota.System(), (0, 0, 0))
    for owner in (body, body.articulate):
        with pytest.raises(ValueError, match=r"stride must be .* got -1$"):
            owner.stride = -1
