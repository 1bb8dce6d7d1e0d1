# SPDX-License-Identifier: Apache-2.0
"""What a script can get wrong: each is refused with the condition and the value, and the system stays as it was."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Literal

import pytest

import iota

NAN, INF = math.nan, math.inf


def particle(system: iota.System) -> iota.Particle:
    return system.particles[0]


BAD_VALUES: dict[str, tuple[Callable[[iota.System], object], str]] = {
    "nan position": (lambda s: s.bodies[0].particle((NAN, 0, 0)), r"position must be finite, not \(nan, 0, 0\)"),
    "infinite position": (lambda s: s.bodies[0].particle((0, INF, 0)), r"position.*\(0, inf, 0\)"),
    "nan velocity": (lambda s: s.bodies[0].particle(velocity=(0, 0, NAN)), "velocity must be finite"),
    "zero mass off the body": (lambda s: s.bodies[0].particle((0, 9, 0), mass=0), "massless.*do not reach"),
    "negative mass": (lambda s: s.bodies[0].particle(mass=-1), "mass.*above 0 kg, not -1"),
    "nan mass": (lambda s: s.bodies[0].particle(mass=NAN), "mass.*not nan"),
    "infinite mass": (lambda s: s.bodies[0].particle(mass=INF), "mass.*not inf"),
    "assigned position": (lambda s: setattr(particle(s), "position", (INF, 0)), "position must be finite"),
    "assigned velocity": (lambda s: setattr(particle(s), "velocity", (0, NAN)), "velocity must be finite"),
    "assigned mass": (lambda s: setattr(particle(s), "mass", 0.0), "mass.*not 0"),
    "force": (lambda s: particle(s).apply_force((NAN, 0, 0)), "force must be finite"),
    "nail": (lambda s: particle(s).nail((NAN, 0, 0)), "position must be finite"),
    "gravity": (lambda s: setattr(s, "gravity", (0, NAN)), "gravity must be finite"),
    "damping": (lambda s: setattr(s, "damping", -1.0), "damping must be finite and at least 0 1/s, not -1"),
    "body damping": (lambda s: s.body(damping=NAN), "damping"),
    "mode": (
        lambda s: setattr(s, "mode", "robut"),
        "mode must be one of 'plausible', 'robust', 'energy_keeping', 'accurate', not 'robut'",
    ),
    "kind": (lambda s: s.body(kind="frozen"), "kind must be one of 'dynamic', 'static'.* not 'frozen'"),
    "dt zero": (lambda s: s.step(0), "dt"),
    "dt negative": (lambda s: s.step(-0.01), "dt"),
    "dt nan": (lambda s: s.step(NAN), "dt"),
    "dt too long": (lambda s: s.step(1.5), "dt"),
    "law": (
        lambda s: s.bond(*s.particles[:2], "sprong"),
        "no law is called 'sprong'; did you mean 'spring'",
    ),
    "drag with a length": (
        lambda s: s.bond(*s.particles[:2], "drag", length=1),
        "drag has no parameter 'length'; it has damping",
    ),
    "stiffness": (lambda s: s.bond(*s.particles[:2], "spring", stiffness=-1), "stiffness.*got -1"),
    "length": (lambda s: s.bond(*s.particles[:2], "spring", length=INF), "length.*not inf"),
    "drag damping": (lambda s: s.bond(*s.particles[:2], "drag", damping=NAN), "damping.*not nan"),
    "over": (lambda s: s.particles[0].combine(s.particles[1], over=-1), "over.*at least 0 s, not -1"),
    "rod mass": (lambda s: s.bodies[0].set_rod(0, 0.1), "mass"),
    "rod radius": (lambda s: s.bodies[0].set_rod(1, -0.1), "radius"),
    "rod of one particle": (lambda s: s.bodies[2].set_rod(1, 0.1), "two massive particles"),
    "grip point": (lambda s: s.grip(s.bodies[0], (NAN, 0, 0)), "local_point"),
    "grip target": (lambda s: s.grip(s.bodies[0], target=(0, INF)), "target"),
    "grip frequency": (lambda s: s.grip(s.bodies[0], frequency=0), "frequency"),
    "snapshot": (lambda s: s.restore(b"this is no snapshot"), "snapshot"),
    "empty snapshot": (lambda s: s.restore(b""), "snapshot"),
    "cut snapshot": (lambda s: s.restore(s.snapshot()[:-8]), "snapshot"),
    "chain links": (
        lambda s: iota.builder.chain(links=0).realize(s).bodies,
        "links must be a whole number from 1 up, not 0",
    ),
    "chain length": (lambda s: iota.builder.chain(length=-2).realize(s).bodies, "length must be above 0 m.* not -2"),
    "chain direction": (
        lambda s: iota.builder.chain(direction=(0, 0, 0)).realize(s).bodies,
        "direction must not be zero",
    ),
    "world dt": (lambda s: iota.World(s, dt=0), "dt must be above 0"),
    "world speed": (lambda s: setattr(iota.World(s).clock, "speed", NAN), "speed"),
    "event time": (lambda s: iota.World(s).at(NAN)(print), "time"),
    "event period": (lambda s: iota.World(s).every(0)(print), "period"),
}

BAD_TYPES: dict[str, tuple[Callable[[iota.System], object], str]] = {
    "function with a stiffness": (
        lambda s: s.bond(*s.particles[:2], lambda b: (0, 0, 0), stiffness=1),
        "a function has no stiffness",
    ),
    "no law": (
        lambda s: s.bond(*s.particles[:2], 7),
        "law must be a predefined law, an expression, a Law or a function, not 7",
    ),
    "text for a number": (lambda s: s.bodies[0].particle(mass="heavy"), "mass"),
    "shape for a kind": (
        lambda s: s.body(iota.Box((1, 1, 1))),
        r"body: kind must be one of 'dynamic'.*, not Box\(.*\); did you mean shape=\.\.\.\?",
    ),
    "body for a particle": (lambda s: s.particles[0].separate(s.bodies[1]), "separate: q must be a Particle"),
    "two arguments": (lambda s: iota.World(s).on_step(lambda a, b: None), "takes 2 arguments"),
}


def two_rods_and_a_ball() -> iota.System:
    system = iota.System()
    for x in (0, 2):
        body = system.body()
        body.particle((x, 0, 0))
        body.particle((x + 1, 0, 0))
    system.body().particle((5, 0, 0))
    return system


@pytest.mark.parametrize("name", BAD_VALUES)
def test_a_bad_value_is_refused_with_its_condition(name: str) -> None:
    system = two_rods_and_a_ball()
    before = system.state_hash()
    use, text = BAD_VALUES[name]
    with pytest.raises(ValueError, match=text):
        use(system)
    assert system.validate() == []
    if not name.startswith(("chain", "body")):
        assert system.state_hash() == before, "the system changed"


@pytest.mark.parametrize("name", BAD_TYPES)
def test_a_wrong_kind_of_thing_is_a_type_error(name: str) -> None:
    system = two_rods_and_a_ball()
    use, text = BAD_TYPES[name]
    with pytest.raises(TypeError, match=text):
        use(system)
    assert system.validate() == []


def test_particles_of_two_systems_cannot_be_combined() -> None:
    one, other = two_rods_and_a_ball(), two_rods_and_a_ball()
    p, q = one.particles[0], other.particles[1]
    text = "combine takes two of one system, but particle 0 and particle 1 belong to different systems"
    with pytest.raises(ValueError, match=text):
        p.combine(q)
    for use in (p.separate, lambda q: one.cosmetic_bond(p, q), lambda q: one.bond(p, q, "spring")):
        with pytest.raises(ValueError, match="different systems"):
            use(q)
    with pytest.raises(ValueError, match="different systems"):
        p.body.combine(q.body)
    assert one.validate() == other.validate() == []


def test_an_empty_system_steps() -> None:
    report = iota.System().step(1 / 60)
    assert report.articulates == 0 and report.energy.total == 0


def test_a_body_without_particles_steps() -> None:
    system = iota.System()
    body = system.body()
    system.step()
    assert body.particles == [] and system.validate() == []


def test_a_callback_that_is_registered_twice_for_the_same_events_is_refused() -> None:
    system = iota.System()
    ball, other = (system.body(shape=iota.Sphere(0.1), position=(x, 0, 0)) for x in (0, 1))
    world = iota.World(system)

    class Game:
        def hit(self) -> None:
            pass

    game = Game()
    for register in (
        world.on_step,
        world.on_reset,
        world.on_frame,
        world.on_join,
        world.on_click(ball),
        world.on_key("k"),
    ):
        register(game.hit)
        with pytest.raises(ValueError, match=r"hit is registered by on_\w+ already"):
            register(game.hit)
    world.on_click(other)(game.hit)
    world.on_drag(ball)(game.hit)
    world.on_key("k", release=True)(game.hit)
    world.on_click(ball)(Game().hit)
    assert world.events.forget(game.hit) and not world.events.forget(game.hit)
    world.on_click(ball)(game.hit)


def test_a_coordinate_is_once_in_a_coupling() -> None:
    system = iota.System()
    hinge = system.revolute(system.body(shape=iota.Box((1, 1, 1))), at=(0, 0, 0), axis=(0, 0, 1))
    with pytest.raises(ValueError, match="names the angle of revolute 0 twice; add up its ratios"):
        system.couple([(hinge.angle, 1), (hinge.angle, -1)])


@pytest.mark.parametrize(("length", "way"), [(0.5, "together"), (5.0, "apart")])
def test_a_rod_that_moves_its_ends_in_the_next_step_says_so(length: float, way: str) -> None:
    system = iota.System()
    p, q = system.body().particle((0, 0, 0)), system.body().particle((3, 0, 0))
    system.rod(p, q, length)
    assert any(w.endswith(f"the next step moves them {way}") for w in system.step(1 / 60).warnings)


@pytest.mark.parametrize("kind", ["scripted", "static"])
def test_a_particle_of_a_body_that_does_not_move_by_itself_has_no_velocity_of_its_own(
    kind: Literal["scripted", "static"],
) -> None:
    system = iota.System()
    body = system.body(kind)
    particle = body.particle((0, 0, 0))
    match = "a scripted body goes where its places are set" if kind == "scripted" else "a static body does not move"
    with pytest.raises(ValueError, match=match):
        particle.velocity = (1, 0, 0)
    with pytest.raises(ValueError, match=match):
        body.particle((1, 0, 0), velocity=(1, 0, 0))
    particle.velocity = (0, 0, 0)
    assert particle.velocity == (0, 0, 0)


def test_a_rope_whose_length_changes_by_a_leap_says_that_it_moves_its_ends_and_a_winch_does_not() -> None:
    system = iota.System()
    top, weight = system.body().particle((0, 0, 0)), system.body().particle((0, -1, 0))
    top.nail()
    rope = system.rope(top, weight, 1.0)
    for k in range(20):
        rope.length = 1 - 0.01 * k
        assert system.step(1 / 60).warnings == []
    rope.length = 0.3
    assert any(w.endswith("the next step moves them together") for w in system.step(1 / 60).warnings)


def test_a_point_that_is_far_outside_of_its_room_says_that_it_moves_there() -> None:
    system = iota.System(gravity=(0, 0, 0))
    far, near = system.body().particle((5, 0, 0)), system.body().particle((0.5, 0, 0))
    system.inside(near, iota.Sphere(1))
    assert system.step(1 / 60).warnings == []
    system.inside(far, iota.Sphere(1))
    assert any(w.endswith("the next step moves its bodies until it does") for w in system.step(1 / 60).warnings)


def test_a_bead_that_is_far_from_its_wire_says_that_it_moves_there() -> None:
    system = iota.System(gravity=(0, 0, 0))
    far, near = system.body().particle((0, 5, 0)), system.body().particle((1, 0, 0))
    wire = [(0, 0, 0), (1, 0, 0), (2, 0, 0)]
    system.on_path(near, wire)
    assert system.step(1 / 60).warnings == []
    system.on_path(far, wire)
    assert any(w.endswith("the next step moves its bodies until it does") for w in system.step(1 / 60).warnings)


def test_a_coupling_whose_sum_is_another_one_says_that_it_turns_its_bodies() -> None:
    system = iota.System(gravity=(0, 0, 0))
    boxes = [system.body(shape=iota.Box((1, 1, 1)), position=(0, 2 * k, 0)) for k in range(3)]
    hinges = [system.revolute(boxes[k], boxes[k + 1], at=(0, 2 * k + 1, 0), axis=(0, 0, 1)) for k in range(2)]
    gear = system.couple([(hinges[0].angle, 1), (hinges[1].angle, 1)])
    assert system.step(1 / 60).warnings == []
    gear.destroy()
    system.couple([(hinges[0].angle, 1), (hinges[1].angle, 1)], length=-1.0)
    assert any(w.endswith("the next step moves its bodies until it does") for w in system.step(1 / 60).warnings)
