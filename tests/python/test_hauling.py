# SPDX-License-Identifier: Apache-2.0
"""Ropes and rods whose length a script changes between all steps: it runs evenly, and does work."""

from __future__ import annotations

import functools
import itertools
import math
import random
from typing import Literal

import numpy as np
import pytest
from amount import sampled

import iota

Mode = Literal["energy_keeping", "robust", "plausible", "accurate"]
MODES: tuple[Mode, ...] = ("energy_keeping", "robust", "plausible", "accurate")
EXACT: tuple[Mode, ...] = ("energy_keeping", "accurate")
HOLDS = ("nail", "static body", "pulley", "welded boom", "swing", "rod", "rope that yields")


def hung(hold: str, mode: Mode, angle: float) -> tuple[iota.System, iota.Particle | iota.Body, list[iota.Constraint]]:
    """1 kg that hangs on 2 m, turned by an angle."""
    system = iota.System(mode=mode)
    place = (2 * math.sin(angle), -2 * math.cos(angle), 0.0)
    beam = iota.Box((1, 0.1, 0.1))
    if hold == "swing":
        seat = system.body(shape=iota.Box((0.02, 0.02, 1)), mass=1, position=place)
        ropes = []
        for z in (-0.5, 0.5):
            top = system.body().particle((0, 0, z))
            top.nail()
            ropes.append(system.rope(top, seat.attachment((*place[:2], z))))
        return system, seat, ropes
    load = system.body().particle(place, mass=1)
    if hold in ("static body", "welded boom"):
        boom = system.body(shape=beam, mass=1)
        if hold == "static body":
            boom.kind = "static"
        else:
            system.weld(boom, at=(-0.5, 0, 0))
        return system, load, [system.rope(boom.attachment((0, 0, 0)), load)]
    top = system.body().particle((0, 0, 0))
    top.nail()
    if hold == "pulley":
        drum = system.body().particle((0, -1, 0))
        drum.nail()
        return system, load, [system.rope([drum, top, load])]
    line = system.rod(top, load) if hold == "rod" else system.rope(top, load)
    if hold == "rope that yields":
        line.compliance = (1e-6, 0, 0.01)
    return system, load, [line]


@functools.cache
def pendulum(rate: float, angle: float, time: float) -> tuple[float, float]:
    """Angle and angular velocity of a pendulum of 2 m that becomes longer at a constant rate."""
    h, y = 1e-4, np.array([angle, 0.0])

    def slope(t: float, y: np.ndarray) -> np.ndarray:
        return np.array([y[1], -(9.81 * math.sin(y[0]) + 2 * rate * y[1]) / (2 + rate * t)])

    for i in range(round(time / h)):
        a = slope(i * h, y)
        b = slope((i + 0.5) * h, y + 0.5 * h * a)
        c = slope((i + 0.5) * h, y + 0.5 * h * b)
        y = y + h / 6 * (a + 2 * b + 2 * c + slope((i + 1) * h, y + h * c))
    return float(y[0]), float(y[1])


@pytest.mark.parametrize("rate", [-0.5, 0.5])
@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("hold", HOLDS)
def test_a_load_that_is_hauled_swings_as_by_its_equation(hold: str, mode: Mode, rate: float) -> None:
    """All but the nail at the upper end had 1.7 rad/s instead of 2.49, with any step."""
    system, load, lines = hung(hold, mode, 0.5)
    before, dt = [line.length for line in lines], 1 / 240
    for i in range(480):
        for line, length in zip(lines, before, strict=True):
            line.length = length + rate * dt * (i + 1)
        assert system.step(dt).unconverged == 0
    x, v = np.array(load.position), np.array(load.velocity)
    angle, speed = pendulum(rate, 0.5, 2)
    wide = 3e-3 if mode in EXACT else 0.1
    assert np.hypot(x[0], x[1]) == pytest.approx(2 + 2 * rate, abs=1e-4)
    assert (x[0] * v[1] - x[1] * v[0]) / (x @ x) == pytest.approx(speed, abs=wide)
    assert math.atan2(x[0], -x[1]) == pytest.approx(angle, abs=wide)
    assert abs(system.energy.balance) < 1e-9


@pytest.mark.parametrize("mode", EXACT)
def test_a_load_on_a_free_trolley_is_hauled_as_by_their_equations(mode: Mode) -> None:
    system = iota.System(mode=mode)
    trolley = system.body(shape=iota.Box((0.3, 0.1, 0.1)), mass=5)
    system.prismatic(trolley, at=(0, 0, 0), axis=(1, 0, 0))
    load = system.body().particle((2 * math.sin(0.5), -2 * math.cos(0.5), 0), mass=1)
    rope = system.rope(trolley.attachment((0, 0, 0)), load)
    for i in range(240):
        rope.length = 2 - 0.5 * (i + 1) / 240
        system.step(1 / 240)
    assert load.velocity == pytest.approx((-0.8135, 1.1717, 0), abs=2e-3)  # by Lagrange's equations; it was 0.52
    assert trolley.velocity.x == pytest.approx(0.1627, abs=1e-3)
    assert system.momentum.x == pytest.approx(0, abs=1e-12)


def two(kind: str, mode: Mode, size: float) -> tuple[iota.System, iota.Constraint]:
    """Two bodies that nothing holds turn about each other, on a line."""
    system = iota.System(gravity=(0, 0, 0), mode=mode)
    if kind in ("rod", "rope"):
        p, q = system.body().particle((0, 0, 0), mass=1), system.body().particle((2 * size, 0, 0), mass=3)
        q.velocity, p.velocity = (0, 0.9 * size, 0.2 * size), (0, -0.5 * size, 0.1 * size)
        return system, system.rod(p, q) if kind == "rod" else system.rope(p, q)
    a = system.body(shape=iota.Box((0.4 * size, 0.2 * size, 0.3 * size)), mass=1)
    b = system.body(shape=iota.Box((0.3 * size, 0.2 * size, 0.5 * size)), mass=3, position=(2.4 * size, 0, 0))
    b.velocity, a.velocity = (0, 0.9 * size, 0.2 * size), (0, -0.5 * size, 0)
    end = b.attachment((2.25 * size, -0.1 * size, 0.2 * size))
    upper, lower = a.attachment((0.2 * size, 0.1 * size, 0)), a.attachment((0.2 * size, -0.1 * size, 0))
    return system, system.rope([upper, end, lower]) if kind == "tackle" else system.rope(upper, end)


@pytest.mark.parametrize("size", [1e-2, 1.0, 1e2])
@pytest.mark.parametrize("mode", EXACT)
@pytest.mark.parametrize("kind", ["rod", "rope", "rope of bodies", "tackle"])
def test_what_hauls_itself_together_keeps_its_momenta_and_gets_the_work_of_the_winch(
    kind: str, mode: Mode, size: float
) -> None:
    system, line = two(kind, mode, size)
    system.step(1 / 120)
    momentum, spin = np.array(system.momentum), np.array(system.angular_momentum)
    kinetic, dt, length = system.energy.kinetic, 1 / 120, line.length
    for i in range(240):
        line.length = length * (1 - 0.2 * dt * (i + 1))
        assert system.step(dt).unconverged == 0
    assert np.array(system.momentum) == pytest.approx(momentum, abs=1e-12 * np.linalg.norm(spin) / size)
    assert np.array(system.angular_momentum) == pytest.approx(spin, abs=1e-12 * np.linalg.norm(spin))
    energy = system.energy
    assert energy.kinetic - kinetic == pytest.approx(energy.external_work - energy.dissipated, abs=1e-4 * kinetic)
    assert energy.external_work > 0.3 * kinetic
    assert energy.made <= 1e-9 * kinetic and abs(energy.balance) < 1e-9 * kinetic


@pytest.mark.parametrize("rate", [-0.3, 0.3])
@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("hold", HOLDS)
def test_a_line_that_runs_steadily_tells_the_weight_and_its_work_is_that_of_the_winch(
    hold: str, mode: Mode, rate: float
) -> None:
    """While it was let out it told 0 to 250 N, and a tackle began to swing."""
    system, load, lines = hung(hold, mode, 0.0)
    dt, before, speed = 1 / 240, [line.length for line in lines], 0.0
    system.step(dt, 24)
    told = []
    for i in range(360):
        speed = min(abs(rate), speed + abs(rate) * dt / 0.5)  # it starts within half a second
        for k, line in enumerate(lines):
            before[k] += math.copysign(speed * dt, rate)
            line.length = before[k]
        work, height = system.energy.external_work, load.position.y
        system.step(dt)
        if i > 180:
            told.append(sum(abs(line.force) for line in lines))
            assert system.energy.external_work - work == pytest.approx(9.81 * (load.position.y - height), rel=1e-3)
    assert told == pytest.approx([9.81] * len(told), rel=1e-3)
    assert load.velocity == pytest.approx((0, -rate, 0), abs=1e-6)
    assert abs(system.energy.balance) < 1e-9


@pytest.mark.parametrize("mode", MODES)
def test_a_winch_that_speeds_up_pulls_with_more_than_the_weight(mode: Mode) -> None:
    system, _, (rope,) = hung("pulley", mode, 0.0)
    speed, length, dt = 0.0, rope.length, 1 / 120
    system.step(dt)
    for i in range(60):
        speed += 1.5 * dt
        length -= speed * dt
        rope.length = length
        system.step(dt)
        assert abs(rope.force) == pytest.approx(9.81 + 1.5, rel=1e-3), i


@pytest.mark.parametrize("mode", MODES)
def test_a_rope_breaks_by_how_a_winch_speeds_up_and_not_by_its_speed(mode: Mode) -> None:
    system, _, (rope,) = hung("static body", mode, 0.0)
    rope.break_force = 10.5
    length, speed, dt = rope.length, 0.0, 1 / 120
    system.step(dt, 10)
    for gain, steps, broken in ((0.3, 120, False), (0.0, 60, False), (-0.5, 70, False), (1.5, 30, True)):
        for _ in range(steps):
            speed += gain * dt
            length -= speed * dt
            rope.length = length
            system.step(dt)
        assert rope.broken is broken


@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("kind", ["rod", "rope"])
def test_what_a_line_has_hauled_stops_with_it(kind: str, mode: Mode) -> None:
    system, load, (line,) = hung("rod" if kind == "rod" else "nail", mode, 0.0)
    for i in range(60):
        line.length = 2 - 0.005 * (i + 1)
        system.step(1 / 60)
    system.step(1 / 60)
    if kind == "rod":
        assert abs(load.velocity) < 1e-9
    else:
        assert load.velocity == pytest.approx((0, 0.3 - 9.81 / 60, 0), abs=1e-9), "it flies on"
    system.step(1 / 60, 60)
    assert load.position == pytest.approx((0, -1.7, 0), abs=1e-6)
    assert abs(load.velocity) < 1e-9


@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("kind", ["rod", "rope"])
@pytest.mark.parametrize("factor", [0.5, 1.5])
def test_a_length_that_leaps_shoots_nothing_away(kind: str, mode: Mode, factor: float) -> None:
    system, load, (line,) = hung("rod" if kind == "rod" else "nail", mode, 0.0)
    system.step(1 / 60, 5)
    line.length = 2 * factor
    system.step(1 / 60)
    assert abs(load.velocity) < 0.2  # 9.81 / 60
    if kind == "rod" or factor < 1:
        assert load.position == pytest.approx((0, -2 * factor, 0), abs=1e-6)
    assert abs(system.energy.external_work) < 1e-9


def test_a_line_that_no_step_has_held_yet_only_closes_its_gap() -> None:
    system, load, (rod,) = hung("rod", "energy_keeping", 0.0)
    rod.length = 1.95
    system.step(1 / 60)
    assert abs(load.velocity) < 1e-9
    assert load.position.y == pytest.approx(-1.95)


def test_several_changes_between_two_steps_are_one() -> None:
    def hauled(parts: int) -> bytes:
        system, _, (rope,) = hung("pulley", "energy_keeping", 0.4)
        for i in range(10):
            for part in range(parts):
                rope.length = 3 - 0.0625 * (i + (part + 1) / parts)
            system.step(1 / 64)
        return bytes(system.snapshot())

    assert hauled(1) == hauled(4)


@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("hold", HOLDS)
def test_a_system_restored_between_a_change_and_its_step_goes_on_with_the_same_bits(hold: str, mode: Mode) -> None:
    def haul(system: iota.System, lengths: list[float], steps: range) -> None:
        lines = [c for c in system.constraints if c.kind in ("rod", "rope", "tackle")]
        for i in steps:
            system.step(1 / 60)
            for line, length in zip(lines, lengths, strict=True):
                line.length = length * (1 - 0.004 * min(i, 9))

    for last in (0, 1, 5, 8, 9, 10):
        system, _, lines = hung(hold, mode, 0.5)
        lengths = [line.length for line in lines]
        haul(system, lengths, range(last + 1))
        again = iota.System(mode=mode)
        again.restore(system.snapshot())
        for each in (system, again):
            haul(each, lengths, range(last + 1, 16))
        assert bytes(again.snapshot()) == bytes(system.snapshot()), last


@pytest.mark.parametrize("seed", range(sampled(60)))
def test_any_hauling_keeps_the_book(seed: int) -> None:
    dice = random.Random(seed)
    size, mode = 10 ** dice.uniform(-2, 2), dice.choice(MODES)
    system = iota.System(gravity=(0, -9.81 * size, 0), mode=mode)

    def vector(most: float) -> tuple[float, float, float]:
        return (dice.uniform(-most, most), dice.uniform(-most, most), dice.uniform(-most, most))

    ends: list[iota.Particle] = []
    for k in range(dice.randint(2, 4)):
        place, mass = (2 * k * size, dice.uniform(-1, 1) * size, dice.uniform(-1, 1) * size), 10 ** dice.uniform(-2, 2)
        if dice.random() < 0.5:
            body = system.body(shape=iota.Box((0.4 * size, 0.3 * size, 0.2 * size)), mass=mass, position=place)
            body.velocity = vector(size)
            ends.append(body.attachment((place[0], place[1] + 0.15 * size, place[2])))
        else:
            ends.append(system.body().particle(place, mass=mass, velocity=vector(size)))
    nail = system.body().particle((0, 3 * size, 0))
    nail.nail()
    ends.append(nail)
    lines = [system.rope(ends)] if dice.random() < 0.3 else []
    for p, q in itertools.pairwise(ends):
        line = system.rod(p, q) if dice.random() < 0.3 else system.rope(p, q)
        if dice.random() < 0.2:
            line.compliance = (10 ** dice.uniform(-6, -3), 0, dice.choice([0, 0.02]))
        lines.append(line)
    rates = [dice.uniform(-0.4, 0.4) * line.length for line in lines]
    dt, before = 1 / dice.choice([60, 240]), system.energy
    top = before.kinetic
    for i in range(120):
        if i < 80:
            for line, rate in zip(lines, rates, strict=True):
                line.length += rate * dt
        solved = system.step(dt).unconverged == 0
        energy = system.energy
        top = max(top, energy.kinetic, abs(energy.potential), abs(energy.external_work))
        assert abs(energy.balance) < 1e-6 * top
        if not solved:  # lines that contradict each other
            break
        assert energy.made < 1e-6 * top
