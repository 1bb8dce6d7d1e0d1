# SPDX-License-Identifier: Apache-2.0
"""Each kind of change wakes the island that it moves: judged from places, beside a twin that never sleeps."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Literal

import numpy as np
import pytest

import iota

DT = 1 / 120
Things = dict[str, Any]
Mode = Literal["robust", "energy_keeping"]


def particle(system: iota.System, x: float, y: float = 0.0) -> iota.Particle:
    return system.body().particle((x, y, 0))


def link(system: iota.System, kind: str = "dynamic", start: float = 0, end: float = 1) -> iota.Body:
    body = system.body(kind=kind)
    middle = 0.5 * (start + end)
    for place in ((start, 0, 0), (end, 0, 0), (middle, 0.3, 0), (middle, -0.3, 0), (middle, 0, 0.3), (middle, 0, -0.3)):
        body.particle(place)
    return body


def still_pair(system: iota.System) -> Things:
    p, q = particle(system, 0), particle(system, 1)
    return {"p": p, "q": q, "bond": system.bond(p, q, "spring", stiffness=5, length=1)}


def still_particle(system: iota.System) -> Things:
    return {"p": particle(system, 1)}


def still_box(system: iota.System) -> Things:
    return {"box": system.body(shape=iota.Box((0.2, 0.3, 0.4)))}


def hinged(system: iota.System) -> Things:
    body = link(system)
    joint = system.revolute(body, at=(0, 0, 0), axis=(0, 0, 1))
    return {"body": body, "joint": joint, "end": body.particles[1]}


def guided(system: iota.System) -> Things:
    body = link(system)
    return {"body": body, "joint": system.prismatic(body, at=(0, 0, 0), axis=(1, 0, 0))}


def nailed(system: iota.System) -> Things:
    body = link(system)
    body.particles[0].nail()
    return {"body": body, "top": body.particles[0], "end": body.particles[1]}


def hanging(system: iota.System) -> Things:
    """A particle that hangs still on a spring in gravity."""
    system.gravity = (0, -10, 0)
    anchor = system.body(kind="static").particle((0, 1, 0))
    p = particle(system, 0, 0)
    return {"p": p, "bond": system.bond(p, anchor, "spring", stiffness=20, length=0.5, damping=1)}


def scripted(join: Callable[[iota.System, iota.Body, iota.Body], object]) -> Callable[[iota.System], Things]:
    def build(system: iota.System) -> Things:
        table, body = link(system, "scripted", -1, 0), link(system)
        join(system, table, body)
        return {"table": table, "body": body}

    return build


def move_table(things: Things) -> None:
    things["table"].position = tuple(np.array(things["table"].position) + (0.05, 0.02, 0))


def bond_on(law: Any, **parameters: Any) -> Callable[[iota.System], Things]:
    def build(system: iota.System) -> Things:
        p, q = particle(system, 0), particle(system, 1)
        return {"p": p, "q": q, "bond": system.bond(p, q, law, **parameters)}

    return build


def field_on(field: Any, build: Callable[[iota.System], Things] = still_particle, **parameters: Any) -> Any:
    def both(system: iota.System) -> Things:
        things = build(system)
        return {**things, "field": system.field(field, **parameters)}

    return both


def late_push(batch: iota.ParticleBatch) -> np.ndarray:
    return np.array([[0, 1.0, 0]]) * (batch.time > 0.75) * np.ones((len(batch), 1))


def in_group(system: iota.System) -> Things:
    things = still_particle(system)
    group = system.group("g")
    system.field("fx = 1", group=group)
    return {**things, "group": group}


def geared(system: iota.System) -> Things:
    a, b = hinged(system), hinged(system)
    return {"coupling": system.couple([(a["joint"].angle, 1), (b["joint"].angle, 1)]), "end": a["end"]}


def roped(system: iota.System) -> Things:
    p, q = particle(system, 0), particle(system, 1)
    return {"rope": system.rope(p, q, 1.5), "p": p}


def squeezed(system: iota.System) -> Things:
    """A spring that presses a hinged link against its stop."""
    things = hinged(system)
    things["joint"].angle.limits = (0, 1)
    things["joint"].angle.spring = (5, 0.5, -1)
    return things


def rubbing(system: iota.System) -> Things:
    """A spring that friction holds."""
    things = hinged(system)
    things["joint"].angle.friction = 10
    things["joint"].angle.spring = (5, 0.5, 1)
    return things


def bent(system: iota.System) -> Things:
    p, q, r = particle(system, 0), particle(system, 1), particle(system, 1, 1)
    for a, b in ((p, q), (q, r)):
        system.rod(a, b)
    return {"spring": system.angle_spring(p, q, r, 1.0, damping=0.1), "r": r}


def on_scripted_path(system: iota.System) -> Things:
    table, p = link(system, "scripted", -1, 0), particle(system, 0)
    system.on_path(p, [(-1, 0, 0), (0, 0, 0), (1, 0, 0)], body=table)
    return {"table": table, "p": p}


def on_scripted_surface(system: iota.System) -> Things:
    table, p = link(system, "scripted", -1, 0), particle(system, 0.5)
    system.on_surface(p, iota.Sphere(0.5), body=table)
    return {"table": table, "p": p}


def undone(system: iota.System) -> Things:
    """A sleeper that was woken, and put back to sleep by an undo."""
    things = nailed(system)
    for _ in range(60):
        system.step(DT)
    with system.edit():
        things["end"].mass = 3
    system.step(DT)
    system.undo()
    return things


def two_links(system: iota.System) -> Things:
    system.gravity = (3, 0, 0)
    a, b = nailed(system), link(system, start=1, end=2)
    a["end"].combine(b.particles[0])
    return {"p": a["end"], "q": b.particles[0]}


def set_joint(name: str, value: Any, coordinate: str = "angle") -> Callable[[Things], None]:
    return lambda things: setattr(getattr(things["joint"], coordinate), name, value)


def set_on(thing: str, name: str, value: Any) -> Callable[[Things], None]:
    return lambda things: setattr(things[thing], name, value)


def nothing(_: Things) -> None:
    pass


CASES: dict[str, tuple[Callable[[iota.System], Things], Callable[[Things], object]]] = {
    # Bonds and laws.
    "a parameter of a bond": (still_pair, lambda t: t["bond"].set(length=0.5)),
    "a bond switched off": (hanging, set_on("bond", "active", False)),
    "a bond destroyed": (hanging, lambda t: t["bond"].destroy()),
    "a new bond": (
        still_particle,
        lambda t: t["p"].system.bond(t["p"], particle(t["p"].system, 3), "spring", stiffness=5, length=1),
    ),
    "a bond of t": (bond_on("force = 5*max(t - 0.75, 0)"), nothing),
    "an energy of t": (bond_on("energy = 0.5*k*(r - 1 - 0.3*max(t - 0.75, 0))^2", k=5), nothing),
    "a drag of t": (bond_on("drag = t; force = 2*max(t - 0.75, 0)"), nothing),
    "a held bond of t": (bond_on("force = 5*max(t - 0.75, 0)", implicit=False), nothing),
    "a bond of t between held ends": (
        lambda s: {
            "p": particle(s, 0),
            "bond": s.bond(s.particles[0], s.body(kind="static").particle((1, 0, 0)), "force = 5*max(t - 0.75, 0)"),
        },
        nothing,
    ),
    "a bond of t on links": (
        lambda s: {
            **nailed(s),
            "bond": s.bond(s.particles[1], s.body(kind="static").particle((1, 1, 0)), "force = 5*max(t - 0.75, 0)"),
        },
        nothing,
    ),
    "a function of a bond": (bond_on(lambda b: (max(b.time - 0.75, 0), 0, 0)), nothing),
    "an angle spring's rest": (bent, lambda t: setattr(t["spring"], "rest", 1.0)),
    # Fields and pairs.
    "a field of t": (field_on("fx = max(t - 0.75, 0)"), nothing),
    "a field's energy of t": (field_on("energy = -x*max(t - 0.75, 0)", still_box), nothing),
    "a function of a field": (field_on(late_push, nailed), nothing),
    "a field's parameter": (field_on("fx = a", a=0), lambda t: t["field"].set(a=1)),
    "a field's parameter on a link": (field_on("fy = a", nailed, a=0), lambda t: t["field"].set(a=1)),
    "a new field": (nailed, lambda t: t["end"].system.field("fy = 1")),
    "a new field on a box": (still_box, lambda t: t["box"].system.field("fy = 1")),
    "a member of a group": (in_group, lambda t: t["group"].add(t["p"])),
    "a pair force": (still_pair, lambda t: t["p"].system.pair_force("energy = r", cutoff=2)),
    "gravity": (nailed, lambda t: setattr(t["end"].system, "gravity", (0, -1, 0))),
    "gravity of a box": (still_box, lambda t: setattr(t["box"].system, "gravity", (0, -1, 0))),
    # Joints.
    "a motor": (hinged, set_joint("motor", (2, 50))),
    "a servo": (hinged, set_joint("servo", (0.5, 50))),
    "a spring of a joint": (hinged, set_joint("spring", (5, 0.1, 0.5))),
    "a limit that opens": (squeezed, set_joint("limits", None)),
    "a limit that moves": (squeezed, set_joint("limits", (-0.5, 1))),
    "friction that ends": (rubbing, set_joint("friction", 0)),
    "friction that is less": (rubbing, set_joint("friction", 0.5)),
    "a motor that is slower than the speed of rest": (hinged, set_joint("motor", (0.005, 50))),
    "a value of a joint": (hinged, set_joint("value", 0.7)),
    "a motor of a slide": (guided, set_joint("motor", (2, 50), "slide")),
    "a joint switched off": (
        lambda s: {**hinged(s), "g": setattr(s, "gravity", (3, 0, 0))},
        lambda t: setattr(t["joint"], "active", False),
    ),
    "a joint destroyed": (
        lambda s: {**hinged(s), "g": setattr(s, "gravity", (3, 0, 0))},
        lambda t: t["joint"].destroy(),
    ),
    "a joint that yields": (
        lambda s: {**hinged(s), "g": setattr(s, "gravity", (3, 0, 0))},
        lambda t: setattr(t["joint"], "compliance", (0.05, 0.05, 0.1)),
    ),
    "the length of a rope": (roped, set_on("rope", "length", 0.8)),
    "the sum of a coupling": (geared, set_on("coupling", "length", 0.8)),
    # What is scripted, nails.
    "a table that moves slowly": (scripted(lambda s, a, b: s.ball(a, b, at=(0, 0, 0))), nothing),
    "a scripted body at a joint": (scripted(lambda s, a, b: s.ball(a, b, at=(0, 0, 0))), move_table),
    "a scripted body at a hinge": (scripted(lambda s, a, b: a.particles[1].combine(b.particles[0])), move_table),
    "a scripted body at a spring": (
        scripted(lambda s, a, b: s.bond(a.particles[0], b.particles[0], "spring", stiffness=50, length=1)),
        move_table,
    ),
    "a scripted body at a held spring": (
        scripted(
            lambda s, a, b: s.bond(a.particles[0], b.particles[0], "spring", stiffness=50, length=1, implicit=False)
        ),
        move_table,
    ),
    "a scripted body at a rope": (scripted(lambda s, a, b: s.rope(a.particles[0], b.particles[1], 2)), move_table),
    "a scripted body under a path": (on_scripted_path, move_table),
    "a scripted body under a surface": (on_scripted_surface, move_table),
    "a nail that moves": (nailed, lambda t: t["top"].nail((0.1, 0.1, 0))),
    "a nail that goes": (lambda s: {**nailed(s), "g": setattr(s, "gravity", (3, 0, 0))}, lambda t: t["top"].release()),
    "a nail that comes": (still_particle, lambda t: t["p"].nail((1.2, 0, 0))),
    # Forces, motion, masses.
    "a force": (nailed, lambda t: t["end"].apply_force((0, 30, 0))),
    "a force on a box": (still_box, lambda t: t["box"].apply_force((0, 300, 0))),
    "a torque": (still_box, lambda t: t["box"].apply_torque((0, 0, 30))),
    "a velocity": (nailed, set_on("end", "velocity", (0, 1, 0))),
    "an angular velocity": (
        lambda s: {"box": s.body(shape=iota.Box((0.2, 0.3, 0.4)), position=(1, 0, 0))},
        set_on("box", "angular_velocity", (0, 0, 2)),
    ),
    "a place": (still_pair, set_on("p", "position", (-0.5, 0, 0))),
    "a mass": (hanging, set_on("p", "mass", 3)),
    "a grip": (nailed, lambda t: t["body"].system.grip(t["body"], (0.5, 0, 0), (1, 1, 0))),
    "velocities of all": (
        nailed,
        lambda t: setattr(
            t["body"].system, "velocities", np.tile((0.0, 1.0, 0.0), (len(t["body"].system.particles), 1))
        ),
    ),
    # Structure.
    "a combine": (still_pair, lambda t: t["p"].combine(particle(t["p"].system, -0.5))),
    "a slow combine": (still_pair, lambda t: t["p"].combine(particle(t["p"].system, -0.5), over=0.3)),
    "a separate": (two_links, lambda t: t["p"].separate(t["q"])),
    "a destroyed neighbor": (hanging, lambda t: t["bond"].ends[1].body.destroy()),
    "a change after an undo": (undone, lambda t: t["end"].apply_force((0, 30, 0))),
    "a change of gravity after an undo": (undone, lambda t: setattr(t["end"].system, "gravity", (0, -3, 0))),
}


def free_bodies(system: iota.System) -> list[iota.Body]:
    return [body for body in system.bodies if body.kind in ("dynamic", "resting")]


def creep(things: Things) -> None:
    """A scripted body that goes at half the speed of rest."""
    things["table"].position = tuple(np.array(things["table"].position) + (0.005 * DT, 0, 0))


def run(name: str, rest_after: float) -> tuple[np.ndarray, np.ndarray, list[str]]:
    """Places before the change and after it, and the kinds of the bodies that can move before it."""
    build, change = CASES[name]
    system = iota.System(gravity=(0, 0, 0), damping=0.2)
    system.rest_after, system.rest_speed = rest_after, 0.01
    things = build(system)
    for _ in range(80):
        system.step(DT)
    kinds = [body.kind for body in free_bodies(system)]
    before = np.array(system.positions)
    change(things)
    for _ in range(60):
        if "slowly" in name:
            creep(things)
        system.step(DT)
    return before, np.array(system.positions), kinds


@pytest.mark.parametrize("name", CASES)
def test_wakes_what_it_moves(name: str) -> None:
    before, after, kinds = run(name, 0.2)
    assert kinds and set(kinds) == {"resting"}
    twin_before, twin_after, _ = run(name, 0)
    assert np.abs(before - twin_before).max() < 1e-6
    count = min(len(before), len(after))  # a change may make particles, or destroy the last ones
    moved = np.abs(twin_after[:count] - twin_before[:count]).max()
    assert moved > 1e-4
    assert np.abs(after - twin_after).max() < 0.02 * moved + 1e-6


def pushed_pair(system: iota.System) -> list[iota.Body]:
    """A box on a hinge, a free box, and a particle."""
    size = iota.Box((0.2, 0.2, 0.2))
    hung, free = (system.body(shape=size, mass=1, position=(x, 0, 0)) for x in (0, 1))
    system.revolute(hung, at=(0, 0.3, 0), axis=(0, 0, 1))
    return [hung, free, particle(system, 2).body]


@pytest.mark.parametrize("which", [0, 1, 2])
def test_a_force_of_round_off_keeps_nothing_awake_and_wakes_nothing(which: int) -> None:
    system = iota.System(gravity=(0, 0, 0))
    system.rest_after, system.rest_speed = 0.2, 0.01
    body = pushed_pair(system)[which]
    for _ in range(80):
        body.apply_force((1e-17, 0, 0))
        system.step(DT)
    assert body.kind == "resting"
    for _ in range(20):
        body.apply_force((1e-17, 0, 0))
        system.step(DT)
        assert body.kind == "resting"
    body.apply_force((1e-6, 0, 0))
    system.step(DT)
    assert body.kind == "dynamic"


@pytest.mark.parametrize("which", [0, 1, 2])
def test_a_small_force_moves_what_could_sleep_as_what_never_does(which: int) -> None:
    ways = []
    for rest_after in (0.0, 0.2):
        system = iota.System(gravity=(0, 0, 0))
        system.rest_after, system.rest_speed = rest_after, 0.01
        body = pushed_pair(system)[which]
        for _ in range(120):
            body.apply_force((1e-6, 0, 0))
            system.step(DT)
        ways.append(body.position.x)
    assert ways[1] == pytest.approx(ways[0], rel=1e-9)


def move_floor(system: iota.System, floor: iota.Body, place: tuple[float, float, float]) -> None:
    floor.position = place


def set_material(system: iota.System, floor: iota.Body, material: iota.Material) -> None:
    floor.material = material


def set_usual_material(system: iota.System, floor: iota.Body, material: iota.Material | None) -> None:
    system.usual_material = material


FLOORS: dict[str, tuple[Callable[..., None], Any]] = {
    "moved down": (move_floor, (0, -5, 0)),
    "moved aside": (move_floor, (50, -0.5, 0)),
    "moved up": (move_floor, (0, -0.45, 0)),
    "touches nothing": (set_material, iota.Material(touches="nothing")),
    "a sensor": (set_material, iota.Material(touches="sensor")),
    "of ice": (set_material, iota.Material(friction=0)),
    "nothing touches": (set_usual_material, iota.Material(touches="nothing")),
    "all of ice": (set_usual_material, iota.Material(friction=0)),
    "no material": (set_usual_material, None),
}


@pytest.mark.parametrize("kind", ["obstacle", "static"])
@pytest.mark.parametrize("change", FLOORS)
def test_what_lies_on_a_floor_wakes_in_the_step_in_which_that_changes(change: str, kind: str) -> None:
    """A box slept in the air above a floor that was gone, and one that woke felt its old friction for a step."""

    def fall(rest_after: float) -> np.ndarray:
        system = iota.System(gravity=(2, -9.81, 0))
        system.usual_material = iota.Material(friction=0.6)
        system.rest_after, system.rest_speed = rest_after, 0.01
        make = system.obstacle if kind == "obstacle" else lambda shape, position: system.body(
            "static", shape=shape, position=position
        )  # fmt: skip
        floor = make(iota.Box((4, 1, 4)), position=(0, -0.5, 0))
        box = system.body(shape=iota.Box((0.2, 0.2, 0.2)), density=1000, position=(0, 0.1, 0))
        system.step(1 / 60, 60)
        assert box.kind == ("resting" if rest_after else "dynamic")
        apply, value = FLOORS[change]
        apply(system, floor, value)
        start = np.array(box.position)
        system.step(1 / 60, 20)
        return np.array(box.position) - start

    awake = fall(0)
    assert np.abs(awake).max() > 0.04
    assert np.abs(fall(0.2) - awake).max() < 1e-6


def _moved(make: Callable[..., iota.Body]) -> Callable[[], None]:
    wall = make(5)

    def move() -> None:
        wall.position = (0.2, 0.1, 0)

    return move


def _shown(make: Callable[..., iota.Body]) -> Callable[[], None]:
    wall = make(0.2)
    wall.kind = "inactive"

    def show() -> None:
        wall.kind = "static"

    return show


def _given_a_material(make: Callable[..., iota.Body]) -> Callable[[], None]:
    wall = make(0.2)
    wall.material = iota.Material(touches="nothing")

    def give() -> None:
        wall.material = iota.Material(friction=0.6)

    return give


WALLS = {"made": lambda make: lambda: make(0.2), "moved": _moved, "shown": _shown, "of matter": _given_a_material}


@pytest.mark.parametrize("kind", ["obstacle", "static"])
@pytest.mark.parametrize("shape", [iota.Box((0.2, 0.2, 0.2)), iota.Cylinder(0.1, 0.2)])
@pytest.mark.parametrize("how", WALLS)
def test_a_wall_that_is_put_into_a_sleeping_body_wakes_it(how: str, shape: iota.Shape, kind: str) -> None:
    """It slept on within the wall: neither looked for the other."""

    def pushed(rest_after: float) -> np.ndarray:
        system = iota.System(gravity=(0, -9.81, 0))
        system.usual_material = iota.Material(friction=0.6)
        system.rest_after, system.rest_speed = rest_after, 0.01
        system.obstacle(iota.HalfSpace((0, 1, 0)))

        def make(x: float) -> iota.Body:
            if kind == "obstacle":
                return system.obstacle(shape, position=(x, 0.1, 0))
            return system.body("static", shape=shape, position=(x, 0.1, 0))

        put = WALLS[how](make)
        box = system.body(shape=iota.Box((0.24, 0.2, 0.2)), density=1000, position=(0, 0.1, 0))
        system.step(1 / 60, 60)
        assert box.kind == ("resting" if rest_after else "dynamic")
        put()
        system.step(1 / 60, 10)
        return np.array(box.position)

    awake = pushed(0)
    assert awake[0] < -0.01
    assert np.abs(pushed(0.2) - awake).max() < 1e-6


@pytest.mark.parametrize("rate", [60, 240])
@pytest.mark.parametrize("mode", ["robust", "plausible"])
def test_what_is_eased_out_of_a_wall_does_not_fall_asleep_within_it(
    mode: Literal["robust", "plausible"], rate: int
) -> None:
    """Its velocity is none in these modes, though it moves: it slept 2 cm deep in the wall."""
    system = iota.System(gravity=(0, -9.81, 0), mode=mode)
    system.usual_material = iota.Material(friction=0.6)
    system.rest_after, system.rest_speed = 0.1, 0.01
    system.obstacle(iota.HalfSpace((0, 1, 0)))
    box = system.body(shape=iota.Box((0.2, 0.2, 0.2)), density=1000, position=(0, 0.1, 0))
    system.step(1 / rate, rate)
    assert box.kind == "resting"
    system.obstacle(iota.Box((0.2, 0.2, 0.2)), position=(0.15, 0.1, 0))  # 5 cm deep
    system.step(1 / rate, 2 * rate)
    assert box.kind == "resting"
    assert box.position.x == pytest.approx(-0.05, abs=1.5e-3)


@pytest.mark.parametrize("how", ["a force", "a velocity"])
@pytest.mark.parametrize("mode", ["plausible", "robust", "energy_keeping", "accurate"])
def test_what_throws_a_sleeper_lets_it_meet_other_sleepers_in_the_same_step(mode: Any, how: str) -> None:
    """A force of 1000 times its weight put it through a tower that slept on."""

    def places(rest_after: float) -> np.ndarray:
        system = iota.System(gravity=(0, -9.81, 0), mode=mode)
        system.usual_material = iota.Material(friction=0.6)
        system.rest_after, system.rest_speed = rest_after, 0.01
        system.obstacle(iota.HalfSpace((0, 1, 0)))
        bodies = [
            system.body(shape=iota.Box((0.2, 0.2, 0.2)), mass=mass, position=(x, y, 0))
            for mass, x, y in ((1, 0, 0.1), (5, 1, 0.1), (5, 1, 0.3))
        ]
        system.step(1 / 60, 30)
        assert {each.kind for each in bodies} == {"resting" if rest_after else "dynamic"}
        if how == "a force":
            bodies[0].apply_force((100 * 60, 0, 0))
        else:
            bodies[0].velocity = (100, 0, 0)
        system.step(1 / 60, 2)
        return np.array([each.position for each in bodies])

    never = places(0)
    assert never[1][0] > 1.01
    assert np.abs(places(0.1) - never).max() < 0.02  # it was 0.4 m


@pytest.mark.parametrize("how", ["restored", "restored by one that had other bodies", "undone"])
def test_a_sleeper_of_a_former_state_meets_what_a_force_throws_it_at(how: str) -> None:
    """Whatever the system knew of its own bodies, none of which slept."""

    def build(system: iota.System, rest_after: float) -> list[iota.Body]:
        system.usual_material = iota.Material(friction=0.6)
        system.rest_after, system.rest_speed = rest_after, 0.01
        system.obstacle(iota.HalfSpace((0, 1, 0)))
        return [
            system.body(shape=iota.Box((0.2, 0.2, 0.2)), mass=mass, position=(x, 0.1, 0))
            for mass, x in ((1, 0), (5, 1))
        ]

    system = iota.System(gravity=(0, -9.81, 0))
    if how == "undone":
        bodies = build(system, 0.1)
        system.step(1 / 60, 30)
        with system.edit():
            for body in bodies:
                body.velocity = (0, 3, 0)
        system.step(1 / 60, 3)
        assert {body.kind for body in bodies} == {"dynamic"}
        system.undo()
    else:
        other = iota.System(gravity=(0, -9.81, 0))
        build(other, 0.1)
        other.step(1 / 60, 30)
        if "other" in how:
            build(system, 0)
            system.step(1 / 60, 3)
        system.restore(other.snapshot())
    thrown, hit = (body for body in system.bodies if body.kind in ("dynamic", "resting"))
    assert thrown.kind == hit.kind == "resting"
    thrown.apply_force((100 * 60, 0, 0))
    system.step(1 / 60)
    assert hit.position.x > 1.003, "in the same step"


@pytest.mark.parametrize("shape", [iota.Box((0.2, 0.2, 0.2)), iota.Sphere(0.1)])
def test_contacts_begin_when_the_usual_material_lets_them(shape: iota.Shape) -> None:
    """After a usual material that touches nothing, what moves passed through each other."""
    system = iota.System()
    system.usual_material = iota.Material(touches="nothing")
    system.obstacle(iota.HalfSpace((0, 1, 0)))
    bodies = [system.body(shape=shape, density=500, position=(0, 0.12 + 0.22 * k, 0)) for k in range(3)]
    system.step(1e-6)
    system.usual_material = iota.Material(friction=0.6)
    system.step(1 / 120, 120)
    assert [body.position.y for body in bodies] == pytest.approx([0.1, 0.3, 0.5], abs=1e-6)


@pytest.mark.parametrize("mode", ["energy_keeping", "robust"])
@pytest.mark.parametrize(("step", "speed"), [(1 / 30, 5), (1 / 60, 5), (1 / 60, 20), (1 / 120, 60)])
def test_a_tower_that_a_ball_wakes_within_a_step_moves_as_one_that_never_slept(
    mode: Mode, step: float, speed: float
) -> None:
    """The step goes on in parts, whose contacts were those of bodies that were awake at its begin: the tower fell for a step, by 5 mm."""
    places = []
    for rest_after in (0.1, 0):
        system = iota.System(mode=mode)
        system.usual_material = iota.Material(friction=0.5)
        system.obstacle(iota.HalfSpace((0, 1, 0)))
        system.rest_after, system.rest_speed = rest_after, 0.01
        cube = iota.Box((0.2, 0.2, 0.2))
        tower = [system.body(shape=cube, density=500, position=(0, 0.1 + 0.2 * k, 0)) for k in range(6)]
        for _ in range(round(0.5 / step)):
            system.step(step)
        assert all((body.kind == "resting") == (rest_after > 0) for body in tower)
        ball = system.body(shape=iota.Sphere(0.05), density=7800, position=(-0.6, 0.1, 0))
        ball.velocity = (speed, 0, 0)
        while tower[0].position.x < 1e-3:
            system.step(step)
        places.append([np.array(body.position) for body in tower])
    # Half of g h^2 is 5.4 mm at 30 Hz, 0.3 mm at 120 Hz.
    assert np.abs(np.array(places[0]) - np.array(places[1])).max() < 1e-4


@pytest.mark.parametrize("speed", [5, 20, 60])
@pytest.mark.parametrize("height", [0.1, 0.3])
def test_a_tower_that_is_hit_within_a_step_touches_at_each_place_once(speed: float, height: float) -> None:
    """Contacts of what was awake were listed again in the parts of a step, where theirs had the bodies in another order."""
    system = iota.System()
    system.usual_material = iota.Material(friction=0.5)
    system.obstacle(iota.Box((4, 0.2, 4)), (0, -0.1, 0))
    random = np.random.default_rng(2)
    for k in range(4):
        aside, askew = random.uniform(-0.02, 0.02, 2), ("y", random.uniform(-5, 5))
        place = (aside[0], 0.1 + 0.2 * k, aside[1])
        system.body(shape=iota.Box((0.2, 0.2, 0.2)), density=500, position=place, orientation=askew)
    for _ in range(10):
        system.step(1 / 60)
    ball = system.body(shape=iota.Sphere(0.05), density=7800, position=(-0.6, height, 0))
    ball.velocity = (speed, 0, 0)
    for _ in range(20):
        system.step(1 / 60)
        places = np.round(system.contacts.positions, 9)
        assert len(np.unique(places, axis=0)) == len(places)


# Whether the floor and the box are members of the two groups before.
MEMBERS: dict[str, tuple[tuple[bool, bool], Callable[..., Any]]] = {
    "the box joins": ((True, False), lambda system, groups, floor, box: groups[1].add(box)),
    "the floor joins": ((False, True), lambda system, groups, floor, box: groups[0].add(floor)),
    "the box leaves": ((True, True), lambda system, groups, floor, box: groups[1].remove(box)),
    "the floor leaves": ((True, True), lambda system, groups, floor, box: groups[0].remove(floor)),
    "the group of the box ends": ((True, True), lambda system, groups, floor, box: groups[1].destroy()),
    "the group of the floor ends": ((True, True), lambda system, groups, floor, box: groups[0].destroy()),
    "they touch again": ((True, True), lambda system, groups, floor, box: system.allow_contacts(*groups)),
    "they ignore each other": ((False, False), lambda system, groups, floor, box: system.ignore_contacts(floor, box)),
}


@pytest.mark.parametrize("kind", ["static", "scripted"])
@pytest.mark.parametrize("change", MEMBERS)
def test_a_change_of_groups_that_ignore_each_other_wakes_their_members(
    change: str, kind: Literal["static", "scripted"]
) -> None:
    """A box that joined a group which ignores the floor slept on in the air."""
    members, alter = MEMBERS[change]
    is_within = all(members)  # without gravity, until they touch

    def way(rest_after: float) -> float:
        system = iota.System(gravity=(0, 0 if is_within else -9.81, 0))
        system.usual_material = iota.Material(friction=0)
        system.rest_after, system.rest_speed = rest_after, 0.01
        floor = system.body(kind, shape=iota.Box((1, 0.2, 1)), mass=1, position=(0, -0.17 if is_within else -0.1, 0))
        box = system.body(shape=iota.Box((0.2, 0.2, 0.2)), mass=1, position=(0, 0 if is_within else 0.1, 0))
        groups = (system.group("floors"), system.group("boxes"))
        if change != "they ignore each other":
            system.ignore_contacts(*groups)
        for group, thing, is_member in zip(groups, (floor, box), members, strict=True):
            if is_member:
                group.add(thing)
        system.step(1 / 60, 60)
        assert box.kind == ("resting" if rest_after else "dynamic")
        start = box.position.y
        alter(system, groups, floor, box)
        system.step(1 / 60, 20)
        return box.position.y - start

    awake = way(0)
    assert abs(awake) > 0.02
    # What is pushed out of another body goes so slowly at last that it sleeps again.
    assert way(0.2) == pytest.approx(awake, abs=0.01 if is_within else 1e-6)


@pytest.mark.parametrize("radius", [0.02, 0.09])
@pytest.mark.parametrize("whose", ["own", "usual", "ball"])
def test_what_lies_on_a_floor_wakes_when_its_radius_changes(whose: str, radius: float) -> None:
    """It slept on in the air, or within the floor."""

    def height(rest_after: float) -> float:
        system = iota.System(gravity=(0, -9.81, 0))
        system.usual_material = iota.Material(friction=0.5)
        system.usual_radius, system.rest_after = 0.05, rest_after
        system.obstacle(iota.HalfSpace((0, 1, 0)))
        body = system.body()
        for place in ((0, 0.05, 0), (0.5, 0.05, 0), (0, 0.05, 0.5))[: 1 if whose == "ball" else 3]:
            body.particle(place, mass=1)
        if whose == "ball":
            body.radius = 0.05
        system.step(1 / 120, 120)
        assert body.kind == ("resting" if rest_after else "dynamic")
        if whose == "usual":
            system.usual_radius = radius
        else:
            body.radius = radius
        system.step(1 / 120, 60)
        return body.position.y

    assert height(0.2) == pytest.approx(radius, abs=1e-3) == height(0)
