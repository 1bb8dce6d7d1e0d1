# SPDX-License-Identifier: Apache-2.0
"""The studies cloth and shoal."""

from __future__ import annotations

import gc
import math
from typing import Any

import numpy as np
import pytest

import iota
from iota.studies import cloth, shoal


def school_of(world: iota.World) -> shoal.School:
    (school,) = (thing for thing in gc.get_objects() if type(thing) is shoal.School and thing._system is world.system)
    return school


def middle(school: shoal.School) -> Any:
    return school.bodies.positions.mean(axis=0)


@pytest.fixture(scope="module")
def swimming() -> tuple[iota.World, shoal.School]:
    """The shoal of the study without its hunter, after 10 s or more."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(shoal, "FIRST", math.inf)
        world = shoal.build()
        for _ in range(600):
            world.step()
    return world, school_of(world)


def columns_that_hang(system: iota.System) -> set[int]:
    """The columns of the knots that threads still connect to the bar, of the lower edge."""
    number = {point: index for index, point in enumerate(system.particles)}
    found, new = set[int](), set(range(cloth.COLUMNS))
    beside: dict[int, set[int]] = {index: set() for index in number.values()}
    for p, q in ([number[end] for end in bond.ends] for bond in system.bonds if not bond.broken):
        beside[p].add(q)
        beside[q].add(p)
    while new:
        found |= new
        new = set().union(*(beside[index] for index in new)) - found
    return {index % cloth.COLUMNS for index in found if index >= (cloth.ROWS - 1) * cloth.COLUMNS}


def test_the_cloth_hangs_in_the_wind_without_tearing() -> None:
    system = cloth.build().system
    for _ in range(480):
        assert system.step(1 / 120).unconverged == 0
    assert not any(bond.broken for bond in system.bonds)


def test_a_hem_that_is_pushed_against_its_own_cloth_does_not_pass_through_it() -> None:
    world = cloth.build()
    system, particles = world.system, world.system.particles[: cloth.ROWS * cloth.COLUMNS]
    for field in system.fields:
        field.active = False
    world.advance(60)
    start = [particle.position for particle in particles]
    middle = range(6, cloth.COLUMNS - 6)
    for row in range(3, 9):
        for column in range(2, cloth.COLUMNS - 2):
            knot = particles[row * cloth.COLUMNS + column]
            system.grip(knot.body, target=knot.position, max_acceleration=300)
    hem = [(cloth.ROWS - 1) * cloth.COLUMNS + column for column in middle]
    grips = [system.grip(particles[knot].body, target=start[knot], max_acceleration=120) for knot in hem]
    way = [(0, (0, 0, 0)), (60, (0, 0, 0.4)), (156, (0, 0.5, 0.4)), (276, (0, 0.5, -0.25))]  # steps; m
    for step in range(336):
        offset = [np.interp(step, [when for when, _ in way], [place[axis] for _, place in way]) for axis in range(3)]
        for grip, knot in zip(grips, hem, strict=True):
            grip.move(start[knot] + offset)
        world.step()
    places = np.array([tuple(particle.position) for particle in particles]).reshape(cloth.ROWS, cloth.COLUMNS, 3)
    sheet = (places[:-1, :-1] + places[1:, 1:]) / 2  # middles of cells
    normals = np.cross(places[:-1, 1:] - places[:-1, :-1], places[:-1, :-1] - places[1:, :-1])
    for knot in hem:
        away = np.array(tuple(particles[knot].position)) - sheet[: cloth.ROWS - 4]
        row, column = np.unravel_index(np.linalg.norm(away, axis=2).argmin(), away.shape[:2])
        assert float(away[row, column] @ normals[row, column]) > 0, "it is before the cloth"


@pytest.mark.parametrize("column", [8, 16])
def test_a_rip_runs_from_the_hem_to_the_bar_while_the_hand_keeps_what_it_holds(
    column: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    world = cloth.build()
    system = world.system
    for _ in range(60):
        world.step()
    knot = system.particles[(cloth.ROWS - 1) * cloth.COLUMNS + column]
    grip, start = system.grip(knot.body, target=knot.position), knot.position
    monkeypatch.setattr(type(world.users), "held", lambda *_: knot.body)
    torn, rows = 0, set()
    for step in range(240):
        grip.move(start + iota.Vec3(0.0, -0.4, 1.2) * min(step / 150, 1))
        world.step()
        torn += len(system.broken)
        rows |= {round((cloth.CORNER.y - broken.position.y) / cloth.SPACING) for broken in system.broken}
    assert torn > 25, f"{torn} of {len(system.bonds)} threads are torn"
    around = [bond for bond in system.bonds if knot in bond.ends]
    assert len(around) >= 5 and not any(bond.broken for bond in around), "the hand has not only a knot in it"
    assert len(columns_that_hang(system)) > 8, "most of it still hangs"
    middles = np.array([tuple((b.ends[0].position + b.ends[1].position) * 0.5) for b in system.bonds if b.broken])
    assert len(middles) == torn
    world.reset()
    assert not any(bond.broken for bond in system.bonds)


def test_no_thread_of_the_cloth_cuts_through_a_post() -> None:
    world = cloth.build()
    system = world.system
    posts = np.array([cloth.CORNER.x - 0.3, cloth.CORNER.x + (cloth.COLUMNS - 1) * cloth.SPACING + 0.3])
    corner = system.particles[-1]
    grip, nearest = system.grip(corner.body, target=corner.position), 1.0
    number = {point: index for index, point in enumerate(system.particles)}
    threads = system.bonds[: 2 * cloth.COLUMNS * cloth.ROWS - cloth.COLUMNS - cloth.ROWS]
    ends = np.array([[number[end] for end in bond.ends] for bond in threads])
    for step in range(360):
        turn = 2 * math.pi * min(step / 240, 1)  # around the right post
        grip.move((posts[1] - 0.15 * math.cos(turn), 1.3, 0.15 * math.sin(turn)))
        world.step()
        places, whole = system.positions, np.array([not thread.broken for thread in threads])
        for share in (0.0, 0.25, 0.5, 0.75):
            at = ((1 - share) * places[ends[:, 0]] + share * places[ends[:, 1]])[whole]
            nearest = min(nearest, np.hypot(at[:, 0] - posts[1], at[:, 2]).min())
    assert cloth.POST < nearest < 0.12, f"{nearest:.3f} m from the axis of a post"


def test_the_shoal_stays_together_apart_and_behind_its_leader(swimming: tuple[iota.World, shoal.School]) -> None:
    world, school = swimming
    system, fish = world.system, school.bodies
    places = fish.positions
    assert len(places) == shoal.FISH == 1000 and places[:, 1].min() > 0
    apart = np.linalg.norm(places[:, None] - places[None], axis=2) + 10 * np.eye(len(places))
    nearest = apart.min(axis=1)
    assert np.median(nearest) > 0.12 and np.quantile(nearest, 0.95) < 1.5
    center = middle(school)
    assert np.quantile(np.linalg.norm(places - center, axis=1), 0.9) < 4
    speeds = np.linalg.norm(fish.velocities, axis=1)
    assert 0.6 * shoal.CRUISE < speeds.mean() < 1.8 * shoal.CRUISE
    # Fish look where they swim, within their wag and bank.
    q = fish.orientations
    x = np.stack([1 - 2 * (q[:, 1] ** 2 + q[:, 2] ** 2), 2 * (q[:, 0] * q[:, 1] + q[:, 2] * q[:, 3])], axis=1)
    ahead = fish.velocities[:, :2] / speeds[:, None]
    assert np.median(np.abs(x - ahead)) < 0.25
    # In five seconds they go where the leader goes.
    leader = shoal.leader_at(system.time)
    assert np.linalg.norm(center - leader) < 2.5
    for _ in range(300):
        world.step()
    led = shoal.leader_at(system.time) - leader
    assert np.dot(middle(school) - center, led) > 0.4 * np.dot(led, led) > 0


def test_a_fish_in_a_hand_leads_the_others_and_the_golden_one_does_when_it_is_free(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(shoal, "FIRST", math.inf)
    world = shoal.build(fish=150)
    school = school_of(world)
    for _ in range(240):
        world.step()
    golden, led = next(fish for fish in school.fish if fish.body.name == "leader"), school.fish[7]
    assert abs(golden.position - iota.Vec3(*shoal.leader_at(world.system.time))) < 0.2
    assert np.linalg.norm(middle(school) - shoal.leader_at(world.system.time)) < 1.5
    target = np.array([4.0, 2.5, -3.0])
    monkeypatch.setattr(type(world.users), "held", lambda *_: led.body)
    grip = world.system.grip(led.body, target=tuple(target), max_acceleration=200)
    for _ in range(360):
        world.step()
    assert np.linalg.norm(middle(school) - target) < 1.5, "all are where the hand is"
    grip.destroy()
    monkeypatch.setattr(type(world.users), "held", lambda *_: None)
    for _ in range(360):
        world.step()
    assert np.linalg.norm(middle(school) - shoal.leader_at(world.system.time)) < 1.5


def test_the_hunter_comes_by_itself_the_fish_make_way_and_close_again() -> None:
    world = shoal.build(fish=300)
    school = school_of(world)
    *_, hunter = (particle for particle in world.system.particles if particle.body.name == "hunter")
    nearest, into, spread = [], [], []
    for _ in range(round(26 / world.dt)):
        world.step()
        if world.system.step_count % 6 == 0:
            apart = np.linalg.norm(school.bodies.positions - np.array(tuple(hunter.position)), axis=1)
            nearest.append(apart.min())
            into.append(np.linalg.norm(middle(school) - np.array(tuple(hunter.position))))
            spread.append(np.median(np.linalg.norm(school.bodies.positions - middle(school), axis=1)))
    assert nearest[0] > 8 and min(into) < 1.2, "it goes right into the shoal"
    assert min(nearest) > 0.3, "and finds a hole there"
    assert max(spread) > 1.2 * spread[35] and spread[-1] < 1.3 * spread[35]


def test_the_shoal_drifts_with_the_current(swimming: tuple[iota.World, shoal.School]) -> None:
    """The flow at each fish, from what it does to the velocity in a step, and where it takes them in a second."""
    world, school = swimming
    system, before = world.system, world.system.snapshot()
    velocities, places = [], []
    for active in (False, True):
        system.restore(before)
        school.current.active = active
        system.step(1 / 60)
        velocities.append(school.bodies.velocities)
        for _ in range(60):
            world.step()
        places.append(school.bodies.positions)
    system.restore(before)
    flow = (velocities[1] - velocities[0]) * 60 * shoal.MASS / 0.15 + school.bodies.velocities
    assert 0.3 < np.linalg.norm(flow, axis=1).mean() < 2.0
    # It is smooth: neighbors have the same flow, fish that are far apart have not.
    now = school.bodies.positions
    apart = np.linalg.norm(now[:, None] - now[None], axis=2)
    unlike = np.linalg.norm(flow[:, None] - flow[None], axis=2)
    assert unlike[(apart > 0) & (apart < 0.3)].mean() < 0.7 * unlike[apart > 2.5].mean()
    drift = places[1] - places[0]
    assert np.mean(np.sum(drift * flow, axis=1) > 0) > 0.65
    assert np.mean(np.linalg.norm(drift, axis=1)) > 0.03


def right_of(way: Any) -> Any:
    """Unit vectors, level, to the right of each way: (n, 3)."""
    right = np.cross(way, [0, 1, 0])
    return right / np.linalg.norm(right, axis=1, keepdims=True)


def test_fish_bank_into_their_turns_and_undulate_each_by_itself(swimming: tuple[iota.World, shoal.School]) -> None:
    world, school = swimming
    for _ in range(60):
        world.step()  # fish have to see their own turns, and another test has gone back in time
    wags: Any = []
    velocities, rolls = [], []
    for _ in range(120):
        world.step()
        x, y, z, w = school.headings().T
        nose = np.arctan2(2 * (w * y - x * z), 1 - 2 * (y * y + z * z))  # of the body's x axis, from above
        velocity = school.bodies.velocities
        wags.append(np.angle(np.exp(1j * (nose - np.arctan2(-velocity[:, 2], velocity[:, 0])))))
        velocities.append(velocity)
        back = np.stack([2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)], axis=1)
        rolls.append(np.sum(back * right_of(velocity), axis=1))
    wags = np.array(wags)
    assert 0.12 < wags.std() < 0.2 and np.abs(wags).max() < 0.25, "0.22 rad / sqrt(2)"
    assert np.abs(wags.mean(axis=1)).max() < 0.06, "never all to one side at once"
    beats = (np.diff(np.sign(wags), axis=0) != 0).sum(axis=0)
    assert beats.min() >= 3 and beats.max() <= 7 and len(set(beats)) > 2, "0.9 to 1.5 beats a second, not all alike"
    for since in range(0, 120, 30):
        pull = np.sum((velocities[since + 29] - velocities[since]) * right_of(velocities[since + 15]), axis=1)
        assert np.corrcoef(pull, np.mean(rolls[since : since + 30], axis=0))[0, 1] > 0.6


def test_they_scatter_on_request() -> None:
    world = shoal.build(fish=50)
    before = world.system.energy.kinetic
    world._state.actions["scatter"].hook.function()
    assert world.system.energy.kinetic > 3 * before


def test_a_thousand_fish_are_drawn_of_few_triangles() -> None:
    looks = shoal.fish_looks()
    assert all(look.shape.mass_properties.volume > 0 for look in looks if isinstance(look.shape, iota.Mesh))
    of_one = sum(len(look.shape.triangles) for look in looks if isinstance(look.shape, iota.Mesh))
    assert 2 * shoal.FISH * of_one < 120_000  # and as many for their shadows
