# SPDX-License-Identifier: Apache-2.0
from __future__ import annotations

import math
from itertools import pairwise

import pytest
from conftest import Runner
from page_client import PageClient

import iota
from iota.frames import turned
from iota.studies import cradle


def build(left: int, right: int, balls: int = 5) -> tuple[iota.World, cradle.Cradle]:
    world = iota.World(iota.System(), dt=1 / 240)
    made = cradle.Cradle(world, balls=balls)
    made.lift(left, right)
    return world, made


def advance(world: iota.World, made: cradle.Cradle) -> None:
    """One step, and what is done before it is shown."""
    report = world.step()
    assert report is not None and report.unconverged == 0
    made.step()


def angles(made: cradle.Cradle) -> list[float]:
    return [made.motion(number)[0] for number in range(len(made.balls))]


def sizes(made: cradle.Cradle) -> list[int]:
    return [len(group.numbers) for group in made.groups]


def energy(made: cradle.Cradle) -> float:
    """Of all balls, each swings as its group does; J."""
    solid = 0.4 * cradle.RADIUS**2 + cradle.STRING**2
    return sum(
        len(g.numbers) * made.mass * (solid * g.speed**2 / 2 + 9.81 * cradle.STRING * (1 - math.cos(g.angle)))
        for g in made.groups
    )


def watch_swaps(made: cradle.Cradle) -> list[int]:
    """Each swap keeps energy and momentum; the list gets the number of groups at each."""
    collide, swaps = made.collide, []

    def sums() -> tuple[float, float]:
        return energy(made), sum(len(group.numbers) * group.speed for group in made.groups)

    def watched(held: set[int]) -> bool:
        before, has_met = sums(), collide(held)
        assert sums() == pytest.approx(before, rel=1e-12)
        swaps.extend([len(made.groups)] * has_met)
        return has_met

    made.collide = watched  # type: ignore[method-assign]
    return swaps


def test_balls_touch_at_rest_and_hang_from_the_bars() -> None:
    world, made = build(0, 0)
    for p, q in pairwise(made.balls):
        assert abs(q.center_of_mass - p.center_of_mass) == pytest.approx(2 * cradle.RADIUS, abs=1e-12)
    joints = [joint for joint in world.system.constraints if joint.a in made.balls]
    assert [joint.position.y for joint in joints] == pytest.approx([cradle.HEIGHT] * 5)
    (drawn,) = world.scene.look_of(made.balls[0]).values()  # type: ignore[union-attr]
    _, *strings = drawn
    for string, side in zip(strings, (-1, 1), strict=True):
        half = turned(string.rotation, iota.Vec3(string.shape.length / 2, 0, 0))
        ends = sorted((tuple(iota.Vec3(*string.offset) + half * way) for way in (-1, 1)), key=lambda end: end[1])
        assert ends == [pytest.approx((0, 0, 0)), pytest.approx((0, cradle.STRING, side * cradle.SPREAD))]


@pytest.mark.parametrize(
    ("balls", "left", "right"),
    [(5, 1, 0), (5, 0, 1), (5, 2, 0), (5, 3, 0), (5, 4, 0), (5, 1, 1), (5, 1, 2), (5, 2, 2), (7, 3, 1), (7, 0, 5)],
)
def test_as_many_balls_leave_as_arrive(balls: int, left: int, right: int) -> None:
    world, made = build(left, right, balls)
    swaps = watch_swaps(made)
    start, before = energy(made), (0, 0)
    seen: list[tuple[int, int]] = []
    for _ in range(700):
        advance(world, made)
        now = angles(made)
        places = [ball.center_of_mass.x for ball in made.balls]
        assert all(
            q - p > 2 * cradle.RADIUS - 1e-9 for p, q in pairwise(places)
        )  # none is within another, as it is shown
        # Pendulums simulated = groups.
        assert sum(ball.kind == "dynamic" for ball in made.balls) == len(made.groups) <= 3
        swing = 0.8 * cradle.LIFT
        out = (sum(angle < -swing for angle in now), sum(angle > swing for angle in now))
        if out not in ((0, 0), before):
            seen.append(out)
        before = out
    moves = [(left, right), (right, left)]
    if left and right:
        assert [out for out in seen if 0 not in out][:4] == moves * 2
    else:
        assert seen[:3] == [moves[0], moves[1], moves[0]]
    assert energy(made) == pytest.approx(start, rel=1e-3)
    assert len(swaps) >= 3


def test_groups_that_meet_swap_and_keep_energy_and_momentum() -> None:
    """Eq. 5.1: the left group's pendulum moves by +n_right ball widths, the right one's by -n_left."""
    _, made = build(0, 0, 6)
    made.groups = [cradle.Group(range(2), 0, 0.01, 1.0), cradle.Group(range(2, 6), 2, 0.0, -0.5)]
    made.put()
    middle = [(group.numbers.start + group.numbers.stop - 1) / 2 for group in made.groups]
    before = energy(made), sum(len(group.numbers) * group.speed for group in made.groups)
    made.step()
    assert sizes(made) == [4, 2]
    assert [group.speed for group in made.groups] == pytest.approx([-0.5, 1.0])
    after = [(group.numbers.start + group.numbers.stop - 1) / 2 for group in made.groups]
    assert after[1] - middle[0] == 4 and after[0] - middle[1] == -2
    assert (energy(made), sum(len(g.numbers) * g.speed for g in made.groups)) == pytest.approx(before, rel=1e-9)


def test_a_cascade_is_done_before_anything_is_shown() -> None:
    """A group that has swapped meets the next one at once."""
    _, made = build(0, 0)
    given = [(0.03, 1.0), (0.02, 0.4), (0.01, -0.2), (0.0, -0.5), (-0.01, -0.7)]
    made.groups = [cradle.Group(range(n, n + 1), n, angle, speed) for n, (angle, speed) in enumerate(given)]
    made.put()
    made.step()
    assert angles(made) == pytest.approx([-0.01, 0.0, 0.01, 0.02, 0.03], abs=1e-9)
    assert [group.speed for group in made.groups] == pytest.approx([-0.7, -0.5, -0.2, 0.4, 1.0])


@pytest.mark.parametrize(("way", "expected"), [(-1, [4, 3]), (1, [3, 4])])
def test_the_middle_one_of_seven_takes_four_along_to_either_side(way: int, expected: list[int]) -> None:
    world, made = build(0, 0, 7)
    ball = made.balls[3]
    world.step()
    grip = world.system.grip(ball, target=ball.center_of_mass)
    for step in range(120):
        hand = made.pivot(3) + (way * 0.0004 * step, 0.0001 * step - cradle.STRING, 0)
        made.hands[1] = (3, hand)
        grip.move(hand)
        advance(world, made)
    assert sizes(made) == expected
    moved = [abs(angle) > 0.1 for angle in angles(made)]
    assert moved == ([True] * 4 + [False] * 3 if way < 0 else [False] * 3 + [True] * 4)
    assert world.system.energy.total > 0
    # Let go, the four swing back and send four away.
    made.hands.clear()
    grip.destroy()
    for _ in range(90):
        advance(world, made)
    assert sizes(made) == expected[::-1]


def test_balls_that_meet_a_held_group_are_taken_along() -> None:
    world, made = build(0, 1)
    world.step()
    ball = made.balls[0]
    grip = world.system.grip(ball, target=ball.center_of_mass)
    for _ in range(100):  # held still while the ball from the right arrives
        made.hands[1] = (0, ball.center_of_mass)
        advance(world, made)
    assert sizes(made) == [5] and made.groups[0].leader == 0
    assert max(angles(made)) - min(angles(made)) < 1e-9
    grip.destroy()


def test_the_cradle_can_be_turned_round_while_it_swings() -> None:
    world, made = build(1, 0)
    start = energy(made)
    for step in range(480):
        made.turn_to(step * 2 * math.pi / 480)
        advance(world, made)
        for number, ball in enumerate(made.balls):
            arm = ball.center_of_mass - made.pivot(number)
            assert abs(arm) == pytest.approx(cradle.STRING, rel=1e-6)
            assert abs(arm.dot(made.axis)) < 1e-6  # it swings along the cradle
    assert energy(made) == pytest.approx(start, rel=0.02)
    assert abs(made.frame.orientation[1]) == pytest.approx(math.sin(math.pi * 479 / 480), abs=1e-6)


def test_keys_lift_one_more_ball_and_reset_begins_anew() -> None:
    world = cradle.build(1, 0)
    made = world._state.listeners.on_step[0].function.__self__  # type: ignore[attr-defined]
    for _ in range(50):
        world.step()
    world._state.actions["lift left"].hook.function()
    assert sizes(made) == [2, 3]
    world._state.actions["lift right"].hook.function()
    assert sizes(made) == [2, 2, 1]
    made.turn_to(1.0)
    world.step()
    world.reset()
    assert sizes(made) == [1, 4] and made.turn == 0
    assert angles(made) == pytest.approx([-cradle.LIFT, 0, 0, 0, 0], abs=1e-9)
    for _ in range(50):
        world.step()


def test_a_hand_on_a_page_drags_balls_and_turns_the_frame(run_world: Runner) -> None:
    world = iota.World(iota.System(), dt=1 / 240)
    made = cradle.Cradle(world)
    with PageClient(run_world(world)) as page:
        number = 1
        hand = made.pivot(number) - (0, cradle.STRING, 0)
        page.send(
            "grab_start", hold=1, body=page.body(made.balls[number].slot), local_point=(0, 0, 0), target=tuple(hand)
        )
        page.send("grab_move", hold=1, target=tuple(hand - (0.05, -0.01, 0)))
        page.wait_for(lambda: world.call(lambda: sizes(made) == [2, 3] and angles(made)[0] < -0.2))
        assert world.call(lambda: abs(angles(made)[4])) < 1e-6
        page.send("grab_end", hold=1)
        page.wait_for(lambda: world.call(lambda: sizes(made) == [3, 2]))  # two swing back, two leave
        frame = page.body(made.frame.slot)
        page.send("grab_start", hold=2, body=frame, local_point=(0, 0, 0), target=(0.1, 0, 0))
        page.send("grab_move", hold=2, target=(0.1, 0, -0.1))
        page.wait_for(lambda: world.call(lambda: abs(made.turn - math.pi / 4) < 1e-3))
        page.send("grab_end", hold=2)
