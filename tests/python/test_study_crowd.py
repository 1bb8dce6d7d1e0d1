# SPDX-License-Identifier: Apache-2.0
"""The crowd: what is near the lamp is full, the rest costs what is left, and nothing comes apart."""

from __future__ import annotations

import numpy as np

import iota
from iota.studies import crowd


def test_what_is_near_the_lamp_is_full_though_the_budget_is_far_too_small() -> None:
    world = crowd.build(18, 1e-3)
    reduced = 0
    for step in range(300):
        world.step()
        eye = np.array(next(iter(world.levels.viewers())))  # type: ignore[misc]
        for thing in world.levels.things:
            points = np.array([list(p.position) for body in thing.bodies for p in body.particles])
            apart = float(np.linalg.norm(points - eye, axis=1).min())
            if step > 60 and apart < world.levels.reach - 0.3:
                assert thing.level.name == "full" and thing.root.stride == 1
            reduced += thing.index > 0
    assert reduced > 300 * 8, "most are reduced"
    assert world.system.validate() == []
    energy = world.system.energy  # which level a figure has depends on the clock; some changes make 1.5e-6 J
    assert energy.made < 1e-9 * energy.potential


def test_nothing_comes_apart_at_any_level() -> None:
    world = crowd.build(18, 0.1)
    roots = [thing.root for thing in world.levels.things]
    chains = [root for root in roots if not root.solids and len(root.articulate) == crowd.LINKS]
    names, widest = set(), 0.0
    for _ in range(300):
        report = world.step()
        assert report is not None and report.worst_gap < 1e-3
        names |= set(world.levels.counts())
        for root in chains:  # its first two particles are a link, stiff or not
            upper, lower = root.particles[:2]
            widest = max(widest, abs(abs(lower.position - upper.position) - crowd.LINK))
    assert len(chains) == 4 and widest < 1e-4
    assert {"full", "frozen"} < names


def test_t_takes_the_tint_away() -> None:
    world = crowd.build(3, None)
    root = world.levels.things[0].root
    begin = world.scene.look_of(root)
    world.controls.act("tint")
    paint = world.scene.look_of(root)
    world.controls.act("tint")
    assert paint != begin == world.scene.look_of(root)


def made(kind: str) -> tuple[iota.World, list[iota.Body]]:
    """The world, and the bodies of the first thing of a kind, in a crowd in full."""
    world = crowd.build(15, None)
    number = next(
        n for n in range(15) if crowd.KINDS[sum(divmod(n, crowd.ROWS)) % len(crowd.KINDS)].make.__name__ == kind
    )
    return world, world.levels.things[number].bodies


def test_a_shoal_swims_together_around_its_pole_and_no_fish_touches_another() -> None:
    world, shoal = made("shoal")
    pole = np.round(np.array(list(shoal[0].position)) / crowd.APART) * crowd.APART * (1, 0, 1)
    for step in range(1200):
        world.step()
        if step % 40 == 0:
            places = np.array([list(fish.position) for fish in shoal]) - pole
            gaps = np.linalg.norm(places[:, None] - places, axis=2) + 9 * np.eye(len(shoal))
            away = np.hypot(places[:, 0], places[:, 2])
            assert gaps.min() > crowd.LONG and away.min() > 0.7 and away.max() < 1.0
            assert places[:, 1].min() > 1.7 and places[:, 1].max() < 3.0
            around = np.exp(1j * np.arctan2(places[:, 2], places[:, 0]))
            assert abs(around.mean()) > 0.5, "they keep together"
    assert min(abs(fish.velocity) for fish in shoal) > 0.8
    ahead = [(fish.particles[1].position - fish.particles[0].position) / crowd.LONG for fish in shoal]
    assert min(way.dot(fish.velocity / abs(fish.velocity)) for way, fish in zip(ahead, shoal, strict=True)) > 0.9


def test_a_shoal_takes_strides() -> None:
    world, shoal = made("shoal")
    for _ in range(20):
        world.step()
    for fish in shoal:
        fish.stride = 4
    for _ in range(9):
        world.step()
    assert set(world.system.array(shoal).work[:, 1]) == {4}


def test_a_fish_that_is_put_elsewhere_swims_around_the_pole_there() -> None:
    world, (fish, *others) = made("shoal")
    home = fish.position.x
    fish.position += (5 * crowd.APART, 0, 0)
    for _ in range(600):
        world.step()
        assert abs(fish.position.x - home - 5 * crowd.APART) < crowd.APART
    assert all(abs(other.position.x - home) < crowd.APART for other in others)


def test_a_cradle_lets_as_many_balls_go_as_arrive() -> None:
    world, balls = made("cradle")
    start = [ball.position for ball in balls]
    lifted = [ball for ball in balls if ball.position.y > balls[-1].position.y + 0.1]
    for _ in range(240):
        world.step()
        risen = [ball.position.y - start[-1].y > 0.15 for ball in balls]
        if any(risen[len(lifted) :]):
            break
    while balls[-1].velocity.y > 0:
        world.step()
    risen = [ball.position.y - start[-1].y > 0.1 for ball in balls]
    assert risen == [False] * (len(balls) - len(lifted)) + [True] * len(lifted)


def test_a_ball_that_is_cut_loose_falls_and_its_cradle_goes_on() -> None:
    world = crowd.build(15, 1e-3)
    thing = next(each for each in world.levels.things if each.root.solids and each.others)
    ball = thing.bodies[-1]
    world.levels.viewers = lambda: [ball.position]
    for _ in range(10):
        world.step()
    next(joint for joint in world.system.constraints if ball in (joint.a, joint.b)).destroy()
    heights = []
    for _ in range(60):
        world.step()
        heights.append(ball.position.y)
    assert crowd.BALL < min(heights) < 1.3 * crowd.BALL and ball in thing.bodies, "it falls and bounces"
    assert world.system.validate() == [] and world.system.energy.made < 1e-6 * world.system.energy.kinetic


def test_t_tints_what_is_left() -> None:
    world = crowd.build(15, None)
    for thing in world.levels.things:
        thing.bodies[0].destroy()
    world.controls.act("tint")
    assert world.system.validate() == []
