# SPDX-License-Identifier: Apache-2.0
"""The ground of a World holds what falls on it."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest

import iota
from iota.world import options
from iota.world.floor import Floor, touching_points

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
    """Of the shape's touching points where the body is now, m."""
    x, y, z, w = body.orientation
    up = (2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x))  # world y in the body's frame
    places, radius = touching_points(shape)
    return body.center_of_mass.y + min(sum(a * b for a, b in zip(up, p, strict=True)) for p in places) - radius


@pytest.mark.parametrize("size", [0.02, 0.3, 3.0])
@pytest.mark.parametrize("kind", SHAPES)
def test_dropped_bodies_come_to_rest_on_the_ground(kind: str, size: float) -> None:
    shape = SHAPES[kind](size)
    world, body = dropped(shape, 5 * size)
    run(world, 3 + 2 * math.sqrt(size))
    assert body.center_of_mass.y < 3.3 * size
    assert lowest(body, shape) > -0.05 * size
    assert abs(body.velocity.y) < 0.3 * math.sqrt(9.81 * size)


@pytest.mark.parametrize("rounding", [0, 0.15, 0.5])
def test_a_cylinder_touches_the_ground_with_its_rounded_edges(rounding: float) -> None:
    shape = iota.Cylinder(0.5, 2, rounding)
    places, radius = touching_points(shape)
    for tilt in np.linspace(-1.5, 1.5, 7):
        down = np.array(
            [math.sin(tilt), math.cos(tilt) * math.cos(math.pi / 8), math.cos(tilt) * math.sin(math.pi / 8)]
        )
        lowest_point = np.array(tuple(shape.closest(tuple(1e6 * down))))
        assert max(places @ down) + radius == pytest.approx(lowest_point @ down, rel=1e-6)


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
    # v^2 / (2 mu g) with mu = 0.6; corners catch a little
    assert box.center_of_mass.x == pytest.approx(0.76, rel=0.5)
    place = box.center_of_mass
    run(iota.World(system, ground=0.0), 2)
    assert abs(box.center_of_mass - place) < 0.02
    assert box.center_of_mass.y == pytest.approx(0.1, abs=0.002)


def test_a_particle_slides_as_far_as_the_friction_of_the_ground_allows() -> None:
    system = iota.System()
    point = system.body().particle((0, 0.05, 0), mass=1, velocity=(3, 0, 0))
    point.radius = 0.05
    run(iota.World(system, ground=0.0), 2)
    assert point.position.x == pytest.approx(3**2 / (2 * 0.6 * 9.81), rel=0.05)


def test_a_chain_that_was_cut_off_lies_on_the_ground_as_thick_as_it_is_drawn() -> None:
    system = iota.System()
    chain = iota.builder.chain(24, 2.4, top=(0, 3, 0), direction=(0.85, -0.55, 0.1)).realize(system)
    chain.points[0].release()
    world = iota.World(system, ground=0.0)
    world.draw(chain.bodies, iota.looks.capsule(0.02, "rope"))
    run(world, 4)
    heights = system.positions[:, 1]
    assert heights.min() > 0.012
    assert heights.max() < 0.1


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
    floor, start = Floor(system, 0.0), system.energy.kinetic + system.energy.potential
    for _ in range(round(1.5 / dt)):
        floor.push(dt)
        report = system.step(dt)
        energy = report.energy.kinetic + report.energy.potential
        assert energy < 1.001 * start  # a turn in a step is calculated as if it were small
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
    floor = Floor(system, 0.0)
    for _ in range(360):
        floor.push(1 / 120)
        system.step(1 / 120)
    assert np.abs(system.positions[:, 1]).max() < 0.002


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


def test_the_kept_list_of_bodies_equals_a_new_list_after_edits() -> None:
    """A floor that has followed random edits, and one that lists everything anew."""
    random = np.random.default_rng(3)
    system = iota.System(damping=1.0)
    blocks = [system.body(shape=iota.Box((0.2, 0.1, 0.3)), mass=1, position=(0.5 * n, 0.4, 0)) for n in range(6)]
    balls = [system.body(shape=iota.Sphere(0.1), mass=1, position=(0.5 * n, 0.4, 1)) for n in range(3)]
    iota.builder.chain(6, 1.2, top=(0, 1.5, 2), direction=(1, 0, 0)).realize(system)
    system.emitter(rate=300, position=(0, 0.2, 3), velocity=(0, 1, 0), lifetime=0.1)
    floor = Floor(system, 0.0)
    cluster = system.body()
    for place in ((0, 0.5, -1), (0.3, 0.5, -1), (0, 0.8, -1), (0, 0.5, -0.7)):
        cluster.particle(place, 0.2)
    cluster.combine(blocks.pop())
    hinges: list[tuple[iota.Particle, iota.Particle]] = []
    added: list[iota.Body] = []

    def some() -> iota.Body:
        return random.choice([body for body in system.bodies if not body.is_spark])

    def hinge() -> None:
        place = tuple(random.uniform(0, 1, 3))
        hinges.append((random.choice(blocks).particle(place), random.choice(balls).particle(place)))
        iota.Particle.combine(*hinges[-1])

    def add() -> None:
        added.append(system.body(shape=iota.Capsule(0.05, 0.2), mass=1, position=tuple(random.uniform(0.3, 1, 3))))

    edits: list[Callable[[], object]] = [
        add,
        lambda: setattr(some(), "kind", random.choice(["dynamic", "static"])),
        lambda: setattr(some(), "mass", random.uniform(0.5, 2)),
        lambda: setattr(some().particles[0], "radius", random.uniform(0.01, 0.2)),
        hinge,
        lambda: iota.Particle.separate(*hinges.pop()),
        lambda: added[0].combine(added.pop()),
        lambda: some().particle(tuple(random.uniform(0, 1, 3))),
        lambda: setattr(cluster.particles[0], "position", cluster.particles[0].position + (0.02, 0.01, 0)),
        lambda: setattr(added[-1].particles[0], "position", added[-1].particles[0].position + (0.02, 0.01, 0)),
        lambda: added.pop(0).destroy(),
        lambda: setattr(some(), "radius", random.uniform(0.01, 0.05)),
    ]  # fmt: skip
    done = 0
    for _ in range(300):
        before = system.scene_version
        try:
            random.choice(edits)()
            done += 1
        except (ValueError, RuntimeError, IndexError, iota.StaleIdError):
            pass  # some edits do not fit some bodies
        floor.push(1 / 120)
        system.step(1 / 120)
        if system.scene_version == before:
            continue  # it lists bodies after edits of them only
        floor._take_structure(system.positions)
        fresh = Floor(system, 0.0)
        fresh._take_structure(system.positions)
        kept, new = floor._touches, fresh._touches
        assert kept is not None and new is not None and kept.ranges == new.ranges
        for name in ("rows", "mass_rows", "masses", "mass_bodies", "radius", "is_solid", "is_joined", "bodies"):
            np.testing.assert_array_equal(getattr(kept, name), getattr(new, name), err_msg=name)
        np.testing.assert_allclose(kept.weights, new.weights, atol=1e-6)
        assert floor._reach == pytest.approx(fresh._reach, rel=1e-6)
    assert done > 150


def test_a_body_that_is_let_go_later_is_held_too() -> None:
    system = iota.System()
    box = system.body(shape=iota.Box((0.2, 0.2, 0.2)), mass=1, position=(0, 0.5, 0), kind="static")
    system.body(shape=iota.Box((0.2, 0.2, 0.2)), mass=1, position=(1, 0.1, 0))
    world = iota.World(system, ground=0.0)
    world.at(0.5)(lambda: setattr(box, "kind", "dynamic"))
    run(world, 2)
    assert box.center_of_mass.y == pytest.approx(0.1, abs=0.01)


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
