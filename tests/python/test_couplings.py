# SPDX-License-Identifier: Apache-2.0
"""Gears, racks, screws, differentials, ropes over several points and rams against analytic truth, in every mode."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest

import iota

G = 9.81
MODES = ["plausible", "robust", "energy_keeping", "accurate"]
every_mode = pytest.mark.parametrize("mode", MODES)
# What turns loses speed to the robust scheme, by about the square of its turn in a step.
TURNING = {"plausible": 2e-2, "robust": 2e-2, "energy_keeping": 1e-3, "accurate": 2e-4}


def wheel(system: iota.System, x: float, inertia: float, body: iota.Body | None = None) -> iota.Constraint:
    """The joint of a wheel about z whose moment of inertia about its axis is `inertia`."""
    radius = math.sqrt(2 * inertia)  # of a cylinder of 1 kg
    across = (0, math.sqrt(0.5), 0, math.sqrt(0.5))  # a cylinder's axis is x
    disc = system.body(shape=iota.Cylinder(radius, 0.1), mass=1, position=(x, 0, 0), orientation=across)
    return system.revolute(disc, body, at=(x, 0, 0), axis=(0, 0, 1))


def run(system: iota.System, seconds: float, dt: float = 1 / 120) -> None:
    for _ in range(round(seconds / dt)):
        system.step(dt)


def stay(position: tuple[float, float, float], system: iota.System) -> iota.Particle:
    point = system.body().particle(position)
    point.nail()
    return point


# --- gears --------------------------------------------------------------------------------------------------------------


@every_mode
@pytest.mark.parametrize("ratio", [-0.5, 3.0, -20.0])
def test_gears_turn_as_their_ratio_says_and_pass_the_torque_on(mode: str, ratio: float) -> None:
    system = iota.System(mode=mode, gravity=(0, 0, 0))
    a, b = wheel(system, 0, 0.02), wheel(system, 1, 0.003)
    gear = system.gear(a, b, ratio)
    a.angle.motor = (1e6, 0.05)  # a constant torque
    run(system, 0.5)
    rate = 0.05 / (0.02 + ratio**2 * 0.003)
    assert a.angle.speed == pytest.approx(rate * 0.5, rel=TURNING[mode])
    assert b.angle.speed == pytest.approx(ratio * a.angle.speed, rel=1e-3)
    assert b.angle.value == pytest.approx(ratio * a.angle.value, rel=1e-6)
    assert gear.torque.z == pytest.approx(0.02 * rate - 0.05, rel=10 * TURNING[mode])  # on a
    assert gear.gap < 1e-6 and gear.kind == "coupling" and gear.a == a.a and gear.b == b.a


def test_gears_keep_the_energy_of_fast_wheels_that_turn_unlike_each_other() -> None:
    system = iota.System(gravity=(0, 0, 0))
    a, b = wheel(system, 0, 0.02), wheel(system, 1, 0.003)
    system.gear(a, b, -7)
    b.angle.spring = (0.4, 0, 0)  # which drives the pair to and fro
    a.a.angular_velocity = (0, 0, 6)
    system.step(1e-6)
    before = system.energy.total
    run(system, 5)
    assert system.energy.total == pytest.approx(before, rel=1e-6)
    assert abs(b.angle.value) > 0.1


@every_mode
def test_a_gear_box_on_a_turning_carrier_is_planetary(mode: str) -> None:
    """Sun held, planet rolls round it: the planet turns by (1 + teeth) for each turn of the carrier."""
    system = iota.System(mode=mode, gravity=(0, 0, 0))
    carrier = system.body(shape=iota.Box((2, 0.1, 0.1)), mass=1)
    arm = system.revolute(carrier, at=(0, 0, 0), axis=(0, 0, 1))
    planet = wheel(system, 1, 0.01, carrier)
    # Relative to the carrier the sun turns by minus the arm: planet = -2 * (0 - arm).
    system.gear(arm, planet, 2)
    carrier.angular_velocity = (0, 0, 3)
    run(system, 1)
    assert planet.angle.value == pytest.approx(2 * arm.angle.value, rel=1e-6)
    assert planet.a.angular_velocity.z == pytest.approx(3 * carrier.angular_velocity.z, rel=1e-2)
    if mode in ("energy_keeping", "accurate"):  # nothing but rolling: as fast as at the start
        start = system.energy.kinetic
        run(system, 1)
        assert system.energy.kinetic == pytest.approx(start, rel=1e-5)


@every_mode
def test_rack_and_pinion(mode: str) -> None:
    system = iota.System(mode=mode)
    pinion = wheel(system, 0, 0.02)
    rack = system.body(shape=iota.Box((0.1, 1, 0.1)), mass=3, position=(0.5, 0, 0))
    slide = system.prismatic(rack, at=(0.5, 0, 0), axis=(0, 1, 0))
    system.gear(pinion, slide, 0.25)
    run(system, 0.1)
    a = -G * 3 / (3 + 0.02 / 0.25**2)
    assert slide.slide.speed == pytest.approx(a * 0.1, rel=TURNING[mode])
    assert pinion.angle.value == pytest.approx(slide.slide.value / 0.25, rel=1e-6)


def test_a_sum_that_has_a_length_goes_there_or_ends_there() -> None:
    for one_sided in (False, True):
        system = iota.System(gravity=(0, 0, 0))
        a, b = wheel(system, 0, 0.02), wheel(system, 1, 0.003)
        system.couple([(a.angle, 1), (b.angle, 0.5)], length=0.3, one_sided=one_sided)
        system.step()
        assert a.angle.value + 0.5 * b.angle.value == pytest.approx(0 if one_sided else 0.3, abs=1e-6)
        a.angle.motor = (1.0, 5)
        b.angle.motor = (0.0, 100)
        run(system, 1)
        assert a.angle.value + 0.5 * b.angle.value == pytest.approx(0.3, abs=1e-4)
    with pytest.raises(ValueError, match="length"):
        system.couple([(a.angle, 1)], length=math.inf)


@every_mode
def test_a_nut_screws_itself_down(mode: str) -> None:
    system = iota.System(mode=mode)
    nut = system.body(shape=iota.Box((0.4, 0.1, 0.4)), mass=2)
    joint = system.screw(nut, at=(0, 0, 0), axis=(0, 1, 0), lead=0.05 * 2 * math.pi)
    run(system, 0.2)
    inertia = 2 / 12 * (0.4**2 + 0.4**2)
    assert joint.slide.speed == pytest.approx(-G * 2 / (2 + inertia / 0.05**2) * 0.2, rel=TURNING[mode])
    assert joint.slide.value == pytest.approx(joint.angle.value * 0.05, rel=1e-6)


@every_mode
def test_a_screw_of_two_bodies_holds_them_and_passes_torque_on(mode: str) -> None:
    system = iota.System(mode=mode, gravity=(0, 0, 0))
    bolt = system.body(shape=iota.Box((0.2, 1, 0.2)), mass=3, position=(0, 0, 0))
    nut = system.body(shape=iota.Box((0.4, 0.1, 0.4)), mass=2, position=(0, 0.3, 0))
    joint = system.screw(nut, bolt, at=(0, 0.3, 0), axis=(0, 1, 0), lead=-0.1, angle={"motor": (3.0, 1e5)})
    before = system.momentum
    run(system, 2)
    assert joint.angle.value == pytest.approx(6, rel=1e-3)
    assert joint.slide.value == pytest.approx(-0.1 / (2 * math.pi) * joint.angle.value, rel=1e-6)
    assert system.momentum == pytest.approx(before, abs=1e-9)
    assert 3 * bolt.velocity.y + 2 * nut.velocity.y == pytest.approx(0, abs=1e-9)
    assert joint.gap < 1e-7 and joint.kind == "screw"


@every_mode
def test_a_planar_joint_slides_and_turns_in_its_plane(mode: str) -> None:
    system = iota.System(mode=mode)
    slope = np.array([0.0, math.cos(0.4), math.sin(0.4)])  # the normal of an inclined plane
    puck = system.body(shape=iota.Box((0.3, 0.1, 0.2)), mass=2, position=(1, 2, 3))
    joint = system.planar(puck, at=(1, 2, 3), axis=tuple(slope), spring=(0.5, 0, 0))
    puck.velocity = (0.7, 0, 0)
    run(system, 0.5)
    down = np.array([0, -G, 0]) + G * slope[1] * slope
    np.testing.assert_allclose(puck.velocity, np.array([0.7, 0, 0]) + 0.5 * down, atol=1e-6)
    assert abs(np.dot(np.array(puck.position) - (1, 2, 3), slope)) < 1e-7
    assert joint.force == pytest.approx(tuple(2 * G * slope[1] * slope), abs=1e-4)
    joint.angle.motor = (2, 1e5)
    run(system, 0.5)
    np.testing.assert_allclose(puck.angular_velocity, 2 * slope, atol=2 * TURNING[mode])
    assert joint.gap < 1e-7


@every_mode
def test_a_differential_shares_torque_and_adds_speeds(mode: str) -> None:
    system = iota.System(mode=mode, gravity=(0, 0, 0))
    left, right, case = wheel(system, 0, 0.02), wheel(system, 1, 0.05), wheel(system, 2, 0.01)
    system.couple([(left.angle, 1), (right.angle, 1), (case.angle, -2)])
    case.angle.motor = (1e6, 0.08)
    run(system, 0.5)
    s = 1 / 0.02 + 1 / 0.05
    pull = 0.08 / (2 + 0.01 * s / 2)
    assert left.angle.speed == pytest.approx(pull / 0.02 * 0.5, rel=TURNING[mode])
    assert right.angle.speed == pytest.approx(pull / 0.05 * 0.5, rel=TURNING[mode])
    assert case.angle.value == pytest.approx((left.angle.value + right.angle.value) / 2, rel=1e-6)


def test_a_train_of_gears_on_one_plate_stays_in_mesh() -> None:
    system = iota.System(gravity=(0, 0, 0))
    plate = system.body("static", shape=iota.Box((40, 1, 0.1)), position=(20, 0, 0))
    wheels = [wheel(system, i, 0.01, plate) for i in range(30)]
    for a, b in itertools.pairwise(wheels):
        system.gear(a, b, -1)
    wheels[0].angle.motor = (4, 1e9)
    run(system, 0.5)
    assert [w.angle.speed for w in wheels] == pytest.approx([4 * (-1) ** i for i in range(30)], rel=1e-3)
    assert wheels[0].angle.value == pytest.approx(-wheels[29].angle.value, rel=1e-6)


def test_setting_a_geared_joint_turns_its_partner() -> None:
    system = iota.System(gravity=(0, 0, 0))
    a, b = wheel(system, 0, 0.02), wheel(system, 1, 0.003)
    system.gear(a, b, -3)
    a.angle.value = 2.5
    assert a.angle.value == pytest.approx(2.5) and b.angle.value == pytest.approx(-7.5, abs=1e-6)


# --- ropes --------------------------------------------------------------------------------------------------------------


@every_mode
def test_atwood(mode: str) -> None:
    system = iota.System(mode=mode)
    pulley = stay((0, 5, 0), system)
    light, heavy = (system.body().particle((0, y, 0), mass=m) for y, m in [(2, 1), (3, 4)])
    rope = system.rope([light, pulley, heavy])
    assert rope.length == pytest.approx(5) and rope.kind == "tackle"
    run(system, 0.25)
    assert heavy.velocity.y == pytest.approx(-G * 3 / 5 * 0.25, rel=1e-6)
    assert light.velocity.y == pytest.approx(G * 3 / 5 * 0.25, rel=1e-6)
    assert rope.force.y == pytest.approx(2 * 1 * 4 / 5 * G, rel=1e-5)
    assert pulley.nail_force.y == pytest.approx(2 * 2 * 1 * 4 / 5 * G + G, rel=1e-5)  # and its own weight


@every_mode
@pytest.mark.parametrize("strands", [2, 3, 4, 5])
def test_block_and_tackle_holds_as_many_times_the_weight(mode: str, strands: int) -> None:
    system = iota.System(mode=mode)
    ceiling = stay((0, 10, 0), system)
    block = system.body().particle((0, 4, 0), mass=strands * 1.5)
    weight = system.body().particle((1e-3, 7, 0), mass=1.5)
    # The last strand runs from the ceiling to the weight; an odd number begins at the block.
    points = [block, ceiling] * ((strands + 1) // 2) if strands % 2 else [ceiling, block] * (strands // 2) + [ceiling]
    rope = system.rope([*points, weight])
    run(system, 0.5)
    assert block.velocity.y == pytest.approx(0, abs=1e-4) and rope.gap < 1e-7
    assert sum(ratio for _, ratio in rope.terms) == strands + 1


@every_mode
def test_a_rope_pulls_and_never_pushes(mode: str) -> None:
    system = iota.System(mode=mode)
    left, right = stay((-1, 5, 0), system), stay((1, 5, 0), system)
    ball = system.body().particle((0, 5, 0), mass=2)
    rope = system.rope([left, ball, right], length=2 * math.hypot(1, 0.75))
    run(system, 0.3)
    assert rope.force == (0, 0, 0)
    assert ball.position.y == pytest.approx(5 - G / 2 * 0.3**2, abs=0.02)
    met = []
    for _ in range(120):
        system.step(1 / 120)
        met += [event.constraint for event in system.stops if event.met]
    assert rope in met
    assert ball.position.y == pytest.approx(4.25, abs=1e-6)
    tension = 2 * G / (2 * 0.75 / 1.25)
    assert rope.force.y == pytest.approx(0, abs=1e-9) or abs(rope.force.x) > 0  # on the nailed end
    assert math.hypot(*rope.force) == pytest.approx(tension, rel=1e-4)


def test_a_swinging_atwood_machine_is_that_of_a_runge_kutta_solution() -> None:
    m, heavy = 1.0, 3.0
    system = iota.System(mode="accurate")
    pulley = stay((0, 0, 0), system)
    r0, angle0 = 1.5, 1.2
    bob = system.body().particle((r0 * math.sin(angle0), -r0 * math.cos(angle0), 0), mass=m)
    counter = system.body().particle((0, -6, 0), mass=heavy)
    rope = system.rope([bob, pulley, counter])

    def slope(y: np.ndarray) -> np.ndarray:
        r, v, angle, w = y
        return np.array(
            [
                v,
                (m * r * w**2 - heavy * G + m * G * math.cos(angle)) / (m + heavy),
                w,
                (-G * math.sin(angle) - 2 * v * w) / r,
            ]
        )

    y, dt = np.array([r0, 0.0, angle0, 0.0]), 1e-4
    seconds = 0.55
    for _ in range(round(seconds / dt)):
        k1 = slope(y)
        k2 = slope(y + dt / 2 * k1)
        k3 = slope(y + dt / 2 * k2)
        k4 = slope(y + dt * k3)
        y = y + dt / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
    run(system, seconds, 1 / 400)
    expected = (y[0] * math.sin(y[2]), -y[0] * math.cos(y[2]), 0)
    assert bob.position == pytest.approx(expected, abs=1e-4)
    assert rope.gap < 1e-8


def test_swinging_loads_on_one_rope_keep_their_energy_and_robust_never_gains() -> None:
    for mode in MODES:
        system = iota.System(mode=mode)
        left, right = stay((-1, 5, 0), system), stay((1, 5, 0.3), system)
        loads = [system.body().particle(x, mass=m) for x, m in [((-2, 3, 0.5), 2), ((0.3, 3, 0), 3), ((1.5, 2, -1), 2)]]
        rope = system.rope([loads[0], left, loads[1], right, loads[2]])
        before = system.energy.total
        highest = before
        for _ in range(120):
            system.step(1 / 120)
            highest = max(highest, system.energy.total)
        assert rope.gap < 1e-6, mode
        assert highest < before + 1e-6 * abs(before), mode
        if mode in ("energy_keeping", "accurate"):
            # Going slack keeps it, and going taut loses what the tension cannot give back.
            assert system.energy.total > before - 0.2 * abs(before)


@every_mode
def test_a_rope_over_pulleys_on_a_solid_presses_on_it(mode: str) -> None:
    """A beam on a hinge carries two pulleys; the rope's pull turns it as two forces would."""
    system = iota.System(mode=mode)
    beam = system.body(shape=iota.Box((2, 0.2, 0.2)), mass=5, position=(0, 5, 0))
    pivot = system.revolute(beam, at=(0, 5, 0), axis=(0, 0, 1))
    ends = [beam.particle((x, 5, 0), mass=0) for x in (-0.9, 0.9)]
    loads = [system.body().particle((x, 3, 0), mass=1) for x in (-0.9, 0.9)]
    rope = system.rope([loads[0], *ends, loads[1]])
    run(system, 1)
    assert pivot.angle.value == pytest.approx(0, abs=1e-6)
    assert pivot.force.y == pytest.approx(7 * G, rel=1e-5)
    assert loads[0].position.y == pytest.approx(3, abs=1e-5)
    rope.length = rope.length - 0.5
    run(system, 1)
    assert loads[0].position.y + loads[1].position.y == pytest.approx(6.5, abs=1e-2)


@every_mode
def test_a_winch_hauls_a_load(mode: str) -> None:
    """The rope that hangs from the drum's edge gets shorter as the drum turns: a span coupled with an angle."""
    system = iota.System(mode=mode)
    drum = wheel(system, 0, 0.05)
    top, load = stay((0, 5, 0), system), system.body().particle((0, 1, 0), mass=3)
    length = system.span(top, load)
    system.couple([(length.slide, 1), (drum.angle, 0.2)], one_sided=True)
    drum.angle.motor = (2, 100)
    run(system, 1)
    assert load.position.y == pytest.approx(1 + 0.4, abs=0.01)
    assert drum.angle.effort == pytest.approx(3 * G * 0.2, rel=1e-3)
    assert length.slide.value == pytest.approx(5 - load.position.y, abs=1e-9)


@every_mode
def test_a_span_is_a_ram_and_a_damper(mode: str) -> None:
    system = iota.System(mode=mode)
    foot, head = stay((0, 0, 0), system), system.body().particle((0, 2, 0), mass=2)
    guide = system.on_path(head, [(0, 0.5, 0), (0, 4, 0)])
    ram = system.span(foot, head, motor=(0.5, 1e4))
    run(system, 1)
    assert head.position.y == pytest.approx(2.5, abs=1e-4)
    assert ram.slide.effort == pytest.approx(-2 * G, rel=1e-4) or ram.slide.effort == pytest.approx(2 * G, rel=1e-4)
    ram.slide.motor = None
    ram.slide.limits = (1.5, 3.0)
    run(system, 2)
    assert head.position.y == pytest.approx(1.5, abs=1e-6) and guide.gap < 1e-9


# --- as any other constraint ---------------------------------------------------------------------------------------------


def crane() -> tuple[iota.System, iota.Constraint, iota.Constraint, iota.Particle]:
    system = iota.System()
    pulley = stay((0, 5, 0), system)
    light, heavy = (system.body().particle((x, y, 0), mass=m) for x, y, m in [(-0.5, 2, 1), (0.5, 3, 4)])
    rope = system.rope([light, pulley, heavy])
    gear = system.gear(wheel(system, 5, 0.02), wheel(system, 6, 0.01), -2)
    gear.terms[0][0].motor = (3, 0.2)
    return system, rope, gear, heavy


def test_couplings_are_restored_undone_and_replayed() -> None:
    system, rope, gear, _heavy = crane()
    snapshot = system.snapshot()
    run(system, 0.2)
    after = system.state_hash()
    system.restore(snapshot)
    assert system.validate() == [] and rope.length == pytest.approx(math.hypot(0.5, 3) + math.hypot(0.5, 2))
    run(system, 0.2)
    assert system.state_hash() == after
    with system.edit():
        rope.destroy()
        gear.destroy()
    assert not rope.alive and len(system.constraints) == 2
    system.undo()
    assert system.validate() == [] and [c.kind for c in system.constraints].count("tackle") == 1
    run(system, 0.1)


def test_couplings_end_with_their_joints_and_report_it() -> None:
    system, rope, gear, heavy = crane()
    (_joint, _), (_, ratio) = gear.terms
    assert ratio == -1
    heavy.destroy()
    assert not rope.alive and system.validate() == []
    assert sorted(c.kind for c in system.constraints) == ["coupling", "revolute", "revolute"]
    next(c for c in system.constraints if c.kind == "revolute").destroy()
    assert not gear.alive and system.validate() == []
    run(system, 0.1)


def test_a_rope_breaks_and_is_repaired_and_switched_off() -> None:
    system, rope, _, heavy = crane()
    rope.break_force = 5
    system.step(1 / 120)
    assert rope.broken and system.broken[0].constraint == rope
    run(system, 0.1)
    speed = heavy.velocity.y
    run(system, 0.1)
    assert heavy.velocity.y == pytest.approx(speed - 0.1 * G, rel=1e-6)
    rope.break_force = math.inf
    rope.length = 20
    rope.active = True
    run(system, 0.1)
    assert rope.active and system.validate() == []


def test_combining_and_separating_carries_couplings_along() -> None:
    system, rope, _, heavy = crane()
    hook = system.body().particle(tuple(heavy.position), mass=1)
    hook.combine(heavy)
    run(system, 0.2)
    assert rope.alive and rope.gap < 1e-7
    hook.separate(heavy)
    run(system, 0.1)
    assert rope.alive and rope.gap < 1e-7 and system.validate() == []


def test_a_coupling_is_off_while_one_of_its_joints_is() -> None:
    system = iota.System(gravity=(0, 0, 0))
    a, b = wheel(system, 0, 0.02), wheel(system, 1, 0.003)
    gear = system.gear(a, b, -2)
    b.active = False
    a.angle.motor = (1e6, 0.5)
    run(system, 0.1)
    assert a.angle.speed == pytest.approx(0.5 / 0.02 * 0.1, rel=1e-4)
    assert gear.torque == (0, 0, 0) and b.a.angular_velocity.z == pytest.approx(0, abs=1e-9)


def test_diagnosis_names_a_coupling_that_is_one_too_many() -> None:
    system = iota.System(gravity=(0, 0, 0))
    a, b, c = (wheel(system, x, 0.02) for x in range(3))
    for p, q, ratio in [(a, b, -1), (b, c, -1), (c, a, 1)]:
        system.gear(p, q, ratio)
    told = system.diagnose(a.a)
    assert told.degrees_of_freedom == 1 and "coupling" in str(told.findings)


def test_wrong_couplings_are_refused_with_the_reason() -> None:
    system = iota.System()
    a = wheel(system, 0, 0.02)
    p, q = stay((0, 5, 0), system), stay((1, 5, 0), system)
    with pytest.raises(ValueError, match="at least two points"):
        system.rope([p])
    with pytest.raises(ValueError, match="the same particle"):
        system.rope([p, p, q])
    with pytest.raises(ValueError, match="ratio"):
        system.couple([(a.angle, 0)])
    with pytest.raises(ValueError, match="at least one"):
        system.couple([])
    with pytest.raises(TypeError, match=r"\(coordinate, ratio\)"):
        system.couple([a.angle])
    with pytest.raises(TypeError, match="no coordinate"):
        system.gear(a, system.rope(p, q), 2)
    cylinder = system.cylindrical(system.body(shape=iota.Box((1, 1, 1))), at=(0, 0, 0), axis=(0, 1, 0))
    with pytest.raises(TypeError, match="several coordinates"):
        system.gear(a, cylinder, 2)
    with pytest.raises(ValueError, match="another system"):
        iota.System().gear(a, a, 2)
    solids = [system.body(shape=iota.Box((1, 1, 1)), position=(3 * i, 9, 0)) for i in range(9)]
    with pytest.raises(ValueError, match="36 points"):
        system.rope([s.particle(tuple(s.position), mass=0) for s in solids])
    with pytest.raises(ValueError, match="no length"):
        a.length = 3


def test_a_term_of_a_coupling_tells_its_joint_and_its_name() -> None:
    system = iota.System()
    nut, wheel = (system.body(shape=iota.Cylinder(0.1, 0.1), mass=1, position=(x, 0, 0)) for x in (0, 1))
    screw = system.screw(nut, at=(0, 0, 0), axis=(0, 1, 0), lead=0.1)
    axle = system.revolute(wheel, at=(1, 0, 0), axis=(0, 1, 0))
    rack = system.gear(axle.angle, screw.slide, 0.05)
    assert [(each.joint, each.name) for each, _ in rack.terms] == [(axle, "angle"), (screw, "slide")]


@every_mode
@pytest.mark.parametrize("order", ["cbcw", "wcbc", "cbcbcw"])
def test_a_rope_that_runs_several_times_between_two_points_tells_its_tension(mode: str, order: str) -> None:
    system = iota.System(mode=mode)
    ceiling = system.body().particle((0, 5, 0))
    ceiling.nail()
    strands = order.count("b") * 2
    block, load = system.body().particle((0, 2, 0), mass=strands), system.body().particle((0, 3, 0), mass=1)
    points = {"c": ceiling, "b": block, "w": load}
    rope = system.rope([points[name] for name in order], break_force=1.5 * G)
    for _ in range(10):
        system.step(1 / 120)
    assert not rope.broken
    assert abs(rope.force) == pytest.approx(G, rel=1e-6)
