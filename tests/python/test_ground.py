# SPDX-License-Identifier: Apache-2.0
"""The ground of a World holds what falls on it."""

from __future__ import annotations

import math
import pickle
from collections.abc import Callable

import numpy as np
import pytest

import iota
from iota.world import options

TILTED = (0.3, 0.5, 0.1, 0.8)
SHAPES = {
    "box": lambda s: iota.Box((3 * s, 2 * s, s)),
    "ball": lambda s: iota.Sphere(s),
    "cylinder": lambda s: iota.Cylinder(s, 2 * s),
    "capsule": lambda s: iota.Capsule(s, 2 * s),
    "cone": lambda s: iota.Cone(s, 3 * s),
    "torus": lambda s: iota.Torus(2 * s, 0.5 * s),
    "ellipsoid": lambda s: iota.Ellipsoid((s, 2 * s, 3 * s)),
}


def run(world: iota.World, seconds: float) -> None:
    with options.use(options.RunOptions(headless=True, seconds=seconds)):
        world.run()


def dropped(shape: iota.Shape, height: float, **more: object) -> tuple[iota.World, iota.Body]:
    system = iota.System()
    norm = math.hypot(*TILTED)
    turn = tuple(x / norm for x in TILTED)
    body = system.body(shape=shape, density=1000, position=(0, height, 0), orientation=turn, **more)
    return iota.World(system, ground=0.0), body


def lowest(body: iota.Body, shape: iota.Shape) -> float:
    """Of the shape's surface where the body is now, m."""
    (solid,) = body.solids
    x, y, z, w = solid.orientation
    up = iota.Vec3(2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x))  # world y in the shape's frame
    farthest = shape.closest(tuple(-1e6 * up))  # the point nearest to a far place is the farthest in its direction
    return solid.position.y + sum(a * b for a, b in zip(up, farthest, strict=True))


@pytest.mark.parametrize("size", [0.02, 0.3, 3.0])
@pytest.mark.parametrize("kind", SHAPES)
def test_dropped_bodies_come_to_lie_on_the_ground(kind: str, size: float) -> None:
    shape = SHAPES[kind](size)
    world, body = dropped(shape, 5 * size)
    deepest = 0.0

    @world.on_step
    def watch() -> None:
        nonlocal deepest
        deepest = min(deepest, lowest(body, shape))

    run(world, 3 + 2 * math.sqrt(size))
    assert deepest > -0.01 * size, "also while it falls on an edge"
    assert -1e-4 * size < lowest(body, shape) < 1e-3 * size
    assert kind == "ellipsoid" or abs(body.velocity.y) < 0.05 * math.sqrt(9.81 * size), "an egg rolls on"


def test_a_body_that_is_thrown_down_fast_hardly_bounces() -> None:
    """It falls as from 80 m; what it keeps is spin, of which its corners make a little height."""
    world, body = dropped(iota.Box((0.3, 0.2, 0.1)), 1.0, velocity=(2, -40, 0))
    highest = 0.0

    @world.on_step
    def watch() -> None:
        nonlocal highest
        if world.system.time > 0.2:
            highest = max(highest, body.center_of_mass.y)

    run(world, 3)
    assert highest < 3


def test_a_box_that_slides_is_stopped_by_friction_and_stays_where_it_is() -> None:
    system = iota.System()
    box = system.body(shape=iota.Box((0.3, 0.2, 0.1)), density=1000, position=(0, 0.1, 0), velocity=(3, 0, 0))
    world = iota.World(system, ground=0.0)
    run(world, 2)
    assert box.center_of_mass.x == pytest.approx(3**2 / (2 * 0.6 * 9.81), rel=0.03)
    place = box.center_of_mass
    run(iota.World(system, ground=0.0), 2)
    assert abs(box.center_of_mass - place) < 1e-8
    assert box.center_of_mass.y == pytest.approx(0.1, abs=1e-8)


def test_a_particle_slides_as_far_as_the_friction_of_the_ground_allows() -> None:
    system = iota.System()
    point = system.body().particle((0, 0.05, 0), mass=1, velocity=(3, 0, 0))
    point.radius = 0.05
    run(iota.World(system, ground=0.0), 2)
    assert point.position.x == pytest.approx(3**2 / (2 * 0.6 * 9.81), rel=0.02)


def test_a_chain_that_was_cut_off_lies_on_the_ground_as_thick_as_it_is_drawn() -> None:
    system = iota.System()
    chain = iota.builder.chain(24, 2.4, top=(0, 3, 0), direction=(0.85, -0.55, 0.1)).realize(system)
    chain.points[0].release()
    world = iota.World(system, ground=0.0)
    world.draw(chain.bodies, iota.looks.capsule(0.02, "rope"))
    run(world, 4)
    heights = system.positions[:, 1]
    assert heights.min() > 0.0199
    assert heights.max() < 0.2, "two links may stand on each other"


FEET = [(0.3 * math.cos(turn), 0, 0.3 * math.sin(turn)) for turn in (0, 2.1, 4.2)]
UNEQUAL = {
    "a dumbbell with a light end up": ([(0, 0, 0), (0.05, 0.5, 0)], [1, 1e-3]),
    "a dumbbell with a heavy end up": ([(0, 0, 0), (0.05, 0.5, 0)], [1, 1e3]),
    "a heavy ball on three feet": ([(0, 0.5, 0), *FEET], [1, 1e-3, 1e-3, 1e-3]),
    "a very heavy ball on three feet": ([(0, 0.5, 0), *FEET], [1e3, 1, 1, 1]),
}


@pytest.mark.parametrize("per_second", [60, 240, 960])
@pytest.mark.parametrize("name", UNEQUAL)
def test_a_rigid_body_of_unequal_masses_falls_and_rests_on_its_points(name: str, per_second: int) -> None:
    """Its ends or feet touch the ground and nothing is below; each is pushed as hard as the whole body presses there."""
    places, masses = UNEQUAL[name]
    system, dt = iota.System(), 1 / per_second
    system.usual_radius = 1e-6
    body = system.body()
    for (x, y, z), mass in zip(places, masses, strict=True):
        body.particle((x, y + 0.1, z), mass)
    world, start = iota.World(system, dt=dt, ground=0.0), system.energy.kinetic + system.energy.potential

    @world.on_step
    def watch() -> None:
        assert system.energy.kinetic + system.energy.potential < 1.0001 * start

    run(world, 1.5)
    heights = np.sort(system.positions[:, 1])
    assert np.abs(heights[: min(len(places), 3)]).max() < 0.005
    assert len(places) < 4 or heights[3] == pytest.approx(0.5, abs=0.005)


def test_a_body_of_many_particles_lies_on_the_outermost_ones() -> None:
    """A plate of 100 particles, one of them as heavy as the rest together."""
    system = iota.System()
    system.usual_radius = 1e-6
    plate = system.body()
    for n in range(100):
        plate.particle((0.1 * (n % 10), 0.3, 0.1 * (n // 10)), 99 if n == 34 else 1)
    run(iota.World(system, ground=0.0), 3)
    assert np.abs(system.positions[:, 1]).max() < 1e-5


def test_the_ground_is_under_all_bodies_and_what_hangs_from_them() -> None:
    def ground_of(make: Callable[[iota.System], None]) -> float | None:
        system = iota.System()
        make(system)
        world = iota.World(system)
        run(world, 0.01)
        return world.scene.ground

    assert ground_of(lambda system: system.body().particle((0, 1, 0))) == 0

    def pendulum(system: iota.System) -> None:
        rod = system.body()
        rod.particle((0, 0, 0)).nail()
        rod.particle((1, 0, 0))

    low = ground_of(pendulum)
    assert low is not None
    assert -1.5 < low < -1


def test_the_ground_is_where_a_solid_stands_though_something_hangs_lower() -> None:
    system = iota.System()
    hung = system.body()
    for x in (0.0, 2.0):
        hung.particle((x, 1, 0))
    hung.particles[0].nail()
    box = system.body(shape=iota.Box((0.3, 0.4, 0.5)), position=(5, 0.2, 0), orientation=("y", 30))
    world = iota.World(system)
    run(world, 0.5)
    assert world.scene.ground == 0.0 and box.position.y == pytest.approx(0.2, abs=1e-6)


@pytest.mark.parametrize("way", ["obstacle", "static", "look", "later"])
def test_a_ramp_without_a_material_holds_what_slides_on_it(way: str) -> None:
    system = iota.System()
    world = iota.World(system, ground=0.0)
    size, place, turn = (3, 0.1, 1), (0, 1.5, 0), ("z", -40)
    if way == "obstacle":
        system.obstacle(iota.Box(size), place, turn)
    elif way == "static":
        system.body("static", shape=iota.Box(size), position=place, orientation=turn)
    elif way == "look":
        world.add_static(iota.looks.box(size), place, turn)
    box = system.body(shape=iota.Box((0.2, 0.2, 0.2)), position=(0, 1.75, 0), orientation=turn)
    if way == "later":
        world.advance(2)
        system.obstacle(iota.Box(size), place, turn)
    for _ in range(50):
        world.advance(1)
        assert box.position.y > 1.5 - box.position.x * math.tan(math.radians(40)), "above the ramp"
    assert box.position.x > 0.1, "it slides"


def test_what_only_looks_says_so() -> None:
    system = iota.System()
    world = iota.World(system, ground=0.0)
    world.add_static(iota.looks.box((2, 0.1, 2)), (0, 1, 0)).material = iota.Material(touches="nothing")
    box = system.body(shape=iota.Box((0.2, 0.2, 0.2)), position=(0, 2, 0))
    world.advance(240)
    assert box.position.y == pytest.approx(0.1, abs=1e-5)


def test_a_pendulum_swings_through_the_beam_that_it_is_nailed_in() -> None:
    system = iota.System()
    rod = iota.builder.chain(links=3, length=1.2, top=(0, 2, 0), direction=(1, 0, 0)).realize(system)
    world = iota.World(system)
    world.add_strut((0, 2, -0.5), (0, 2, 0.5), iota.looks.cylinder(0.03, "wood"))
    before, farthest = system.energy.total, 0.0
    for _ in range(240):
        report = world.step()
        assert report is not None and report.worst_gap < 1e-8
        farthest = min(farthest, rod.points[-1].position.x)
    assert system.energy.total == pytest.approx(before, rel=1e-6) and farthest < -0.3


def test_bodies_that_start_below_a_given_ground_are_left_there() -> None:
    system = iota.System(gravity=(0, -9.81, 0))
    below, above = system.body().particle((0, -1, 0)), system.body().particle((1, 1, 0))
    run(iota.World(system, ground=0.0), 2)
    assert below.position.y < -15
    assert above.position.y == pytest.approx(0, abs=0.1)


def test_without_a_ground_things_fall_on() -> None:
    system = iota.System()
    point = system.body().particle((0, 1, 0))
    run(iota.World(system, ground=None), 2)
    assert point.position.y == pytest.approx(1 - 9.81 * 2, rel=0.02)


def test_without_a_ground_solids_touch_each_other_too_and_one_word_turns_it_off() -> None:
    def box_on_a_table(touches: str | None) -> float:
        system = iota.System()
        if touches:
            system.usual_material = iota.Material(touches=touches)
        system.obstacle(iota.Box((2, 0.2, 2)), position=(0, -0.1, 0))
        box = system.body(shape=iota.Box((0.2, 0.2, 0.2)), mass=1, position=(0, 0.3, 0))
        former = system.snapshot()
        world = iota.World(system, ground=None)
        run(world, 0.1)
        system.restore(former)  # as a script that begins anew by itself
        run(world, 1)
        return box.center_of_mass.y

    assert box_on_a_table(None) == pytest.approx(0.1, abs=1e-6)
    assert box_on_a_table("nothing") < -2


def test_a_body_that_is_let_go_later_is_held_too() -> None:
    system = iota.System()
    box = system.body(shape=iota.Box((0.2, 0.2, 0.2)), mass=1, position=(0, 0.5, 0), kind="static")
    system.body(shape=iota.Box((0.2, 0.2, 0.2)), mass=1, position=(1, 0.1, 0))
    world = iota.World(system, ground=0.0)
    world.at(0.5)(lambda: setattr(box, "kind", "dynamic"))
    run(world, 2)
    assert box.center_of_mass.y == pytest.approx(0.1, abs=1e-6)


def test_emitted_sparks_pass_and_the_rest_is_held() -> None:
    system = iota.System()
    system.emitter(rate=200, position=(0, 0.2, 0), velocity=(0, 1, 0), lifetime=1.0)
    point = system.body().particle((0.5, 1, 0))
    run(iota.World(system, ground=0.0), 2)
    assert point.position.y == pytest.approx(0, abs=0.1)
    assert system.positions[:, 1].min() < -0.5


@pytest.mark.parametrize("size", [0.02, 0.3, 3.0])
def test_a_fall_on_the_ground_is_heard_once_where_it_is_and_rest_is_silent(size: float) -> None:
    world, body = dropped(iota.Sphere(size), 5 * size)
    still = world.system.body(shape=iota.Box((size, size, size)), density=1000, position=(9 * size, 0.5 * size, 0))
    heard: list[tuple[str, iota.Vec3, float]] = []
    world._state.things.effect = lambda kind, place, volume: heard.append((kind, place, volume))
    run(world, 2 * math.sqrt(8 * size / 9.81))
    assert [kind for kind, *_ in heard] == ["impact"]
    place = heard[0][1]
    assert abs(place - iota.Vec3(body.center_of_mass.x, 0, body.center_of_mass.z)) < 0.01 * size
    assert 0.3 < heard[0][2] <= 1 and still.alive


@pytest.mark.parametrize("dt", [1 / 60, 1 / 120])
@pytest.mark.parametrize("radius", [0.02, 0.05, 0.1, 0.5])
@pytest.mark.parametrize("is_ball", [True, False])
def test_what_rolls_keeps_its_speed(is_ball: bool, radius: float, dt: float) -> None:
    system, speed = iota.System(), min(1.0, 0.5 * radius / dt)
    shape = iota.Sphere(radius) if is_ball else iota.Cylinder(radius, 2 * radius)
    turn = (0, math.sqrt(0.5), 0, math.sqrt(0.5))  # its axis along z
    body = system.body(
        shape=shape, position=(0, radius, 0), orientation=turn, velocity=(speed, 0, 0), spin=(0, 0, -speed / radius)
    )
    run(iota.World(system, ground=0.0, dt=dt), 5)
    assert body.center_of_mass.x == pytest.approx(5 * speed, rel=0.005)
    assert body.center_of_mass.y == pytest.approx(radius, rel=1e-3)
    assert body.velocity.x == pytest.approx(speed, rel=0.005)


def table(system: iota.System, top: float, leg: float) -> list[iota.Body]:
    """A table with four legs that are welded to it, kg."""
    board = system.body(shape=iota.Box((1, 0.05, 0.6)), mass=top, position=(0, 0.625, 0))
    legs = []
    for x in (-0.45, 0.45):
        for z in (-0.25, 0.25):
            legs.append(system.body(shape=iota.Box((0.05, 0.6, 0.05)), mass=leg, position=(x, 0.3, z)))
            system.weld(board, legs[-1], at=(x, 0.6, z))
    return [board, *legs]


@pytest.mark.parametrize("leg", [0.01, 0.25, 2.5])
def test_a_heavy_table_stands_on_light_legs(leg: float) -> None:
    system = iota.System()
    parts = table(system, 10, leg)
    before = [part.center_of_mass for part in parts]
    run(iota.World(system, ground=0.0), 3)
    assert max(abs(part.center_of_mass - place) for part, place in zip(parts, before, strict=True)) < 1e-6


def test_a_table_of_one_body_does_not_glide() -> None:
    system = iota.System()
    board, *legs = table(system, 90, 2.5)
    for leg in legs:
        board.combine(leg)
    before = board.center_of_mass
    run(iota.World(system, ground=0.0), 4)
    assert abs(board.center_of_mass - before) < 1e-6


@pytest.mark.parametrize("share", [0.5, 0.9, 1.1])
@pytest.mark.parametrize("dt", [1 / 60, 1 / 120])
def test_a_box_that_is_pulled_with_less_than_its_friction_stays(share: float, dt: float) -> None:
    system = iota.System()
    box = system.body(shape=iota.Box((0.4, 0.2, 0.4)), mass=5, position=(0, 0.1, 0))
    system.field("fx = q", q=share * 0.6 * 5 * 9.81 / 4)  # on each of its four particles
    run(iota.World(system, ground=0.0, dt=dt), 4)
    if share < 1:
        assert abs(box.center_of_mass - iota.Vec3(0, 0.1, 0)) < 1e-4
    else:
        assert box.center_of_mass.x > 1


@pytest.mark.parametrize("dt", [1 / 60, 1 / 120])
@pytest.mark.parametrize("height", [1.0, 5.0])
def test_what_falls_is_never_seen_below_the_ground(height: float, dt: float) -> None:
    system = iota.System()
    box = system.body(shape=iota.Box((0.2, 0.2, 0.2)), mass=1, position=(0, 0.1 + height, 0))
    world = iota.World(system, ground=0.0, dt=dt)
    seen: list[float] = []
    world.on_step(lambda: seen.append(box.center_of_mass.y))
    run(world, 2)
    assert min(seen) > 0.1 - 1e-6
    assert seen[-1] == pytest.approx(0.1, abs=1e-6)


def test_a_restored_world_moves_on_as_before() -> None:
    system = iota.System()
    box = system.body(shape=iota.Box((0.3, 0.2, 0.4)), position=(0, 0.5, 0), velocity=(1, 0, 0), spin=(1, 2, 3))
    world = iota.World(system, ground=0.0)
    run(world, 0.5)
    saved = system.snapshot()
    for _ in range(60):
        system.step(1 / 120)
    there = box.center_of_mass
    system.restore(saved)
    for _ in range(60):
        system.step(1 / 120)
    assert box.center_of_mass == there


def test_a_ground_of_ice_has_the_material_that_the_script_gives_it() -> None:
    system = iota.System(damping=0)
    box = system.body(shape=iota.Box((0.4, 0.2, 0.4)), position=(0, 0.1, 0), velocity=(1, 0, 0))
    world = iota.World(system, ground=0.0)
    assert world.scene.ground_body is not None
    world.scene.ground_body.material = iota.Material(friction=0)
    run(world, 2)
    assert box.velocity.x == pytest.approx(1, abs=1e-6)
    contacts = box.contacts
    assert len(contacts) == 4 and {contact.other for contact in contacts} == {world.scene.ground_body}
    assert sum(contact.force.y for contact in contacts) == pytest.approx(box.mass * 9.81, rel=1e-6)


def test_a_material_says_what_is_wrong_with_it() -> None:
    with pytest.raises(ValueError, match=r"friction must be finite and at least 0, not -0\.1"):
        iota.Material(friction=-0.1)
    with pytest.raises(TypeError):
        iota.System().body().material = 0.5  # type: ignore[assignment]
    with pytest.raises(ValueError, match=r"restitution must be at most 1, not 1\.5"):
        iota.Material(restitution=1.5)
    with pytest.raises(ValueError, match=r"restitution must be finite and at least 0"):
        iota.Material(restitution=float("nan"))
    with pytest.raises(ValueError, match=r"rolling must be finite and at least 0, not -1"):
        iota.Material(rolling=-1)
    assert repr(iota.Material(friction=0.25)) == "Material(friction=0.25)"
    rubber = iota.Material(friction=0.9, restitution=0.8, rolling=0.01)
    assert repr(rubber) == "Material(friction=0.9, restitution=0.8, rolling=0.01)"
    assert pickle.loads(pickle.dumps(rubber)) == rubber != iota.Material(friction=0.9)
    assert iota.Material() == iota.Material(friction=0.5)
