# SPDX-License-Identifier: Apache-2.0
"""Ropes that yield: nothing acts before they are taut, and no energy is made, by places and velocities alone."""

from __future__ import annotations

import random
from typing import Literal

import numpy as np
import pytest
from amount import sampled

import iota

Mode = Literal["energy_keeping", "robust", "plausible", "accurate"]
MODES: tuple[Mode, ...] = ("energy_keeping", "robust", "plausible", "accurate")
STIFF, DAMPED, SOFT = (5e-6, 0.0, 0.0), (5e-6, 0.0, 0.05), (1e-3, 0.0, 0.05)


def thrown(mode: Mode, compliance: tuple[float, float, float]) -> tuple[iota.System, iota.Particle, iota.Constraint]:
    """A mass at 2 m/s on a rope of 1 m that is slack by 0.1 m."""
    system = iota.System(gravity=(0, 0, 0), mode=mode)
    nail = system.body().particle((0, 0, 0))
    nail.nail()
    mass = system.body().particle((0.9, 0, 0), mass=10, velocity=(2, 0.3, 0))
    rope = system.rope(nail, mass)
    rope.length, rope.compliance = 1.0, compliance
    return system, mass, rope


@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("compliance", [STIFF, DAMPED, SOFT])
def test_a_slack_rope_that_yields_acts_on_nothing(mode: Mode, compliance: tuple[float, float, float]) -> None:
    system, mass, rope = thrown(mode, compliance)
    for k in range(11):  # 2/240 m a step: it is taut in the 12th
        system.step(1 / 240)
        assert mass.position == pytest.approx((0.9 + 2 * (k + 1) / 240, 0.3 * (k + 1) / 240, 0), abs=1e-12)
        assert abs(rope.force) == 0


@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("compliance", [STIFF, DAMPED, SOFT])
@pytest.mark.parametrize("dt", [1 / 60, 1 / 240])
def test_a_rope_that_catches_a_mass_makes_no_energy(
    mode: Mode, compliance: tuple[float, float, float], dt: float
) -> None:
    system, mass, _ = thrown(mode, compliance)
    before, highest = 0.5 * 10 * abs(mass.velocity) ** 2, 0.0
    for _ in range(round(1 / dt)):
        system.step(dt)
        highest = max(highest, 0.5 * 10 * abs(mass.velocity) ** 2)
        assert abs(system.energy.balance) < 1e-6
    assert highest <= before * (1 + 1e-9)
    assert system.energy.made < 1e-9
    assert system.energy.dissipated <= before * (1 + 1e-9)
    if compliance == STIFF and mode in ("energy_keeping", "accurate"):
        assert 0.5 * 10 * abs(mass.velocity) ** 2 == pytest.approx(before, rel=1e-6), "a spring gives back what it took"


@pytest.mark.parametrize("mode", ["energy_keeping", "accurate"])
@pytest.mark.parametrize("dt", [1 / 60, 1 / 240])
def test_a_rope_over_several_points_catches_a_load_as_a_plain_one_does(mode: Mode, dt: float) -> None:
    """Its load kept a part of its speed for another step, and what that took was told as lost."""
    ends = []
    for is_plain in (True, False):
        system = iota.System(mode=mode)
        nail, drum, load = (system.body().particle((0, y, 0)) for y in (0, -1, -1.7))
        nail.nail()
        drum.nail()
        rope = system.rope(nail, load) if is_plain else system.rope([drum, nail, load])
        rope.length += 0.3
        forces = []
        for _ in range(round(0.5 / dt)):
            system.step(dt)
            forces.append(abs(rope.force))
        energy = system.energy
        assert energy.dissipated == pytest.approx(0.3 * 9.81, rel=1e-8) and energy.lost == pytest.approx(0, abs=1e-8)
        assert sum(force > 10 for force in forces) == 1, "caught in one step"
        ends.append((max(forces), forces[-1]))
    assert ends[0] == pytest.approx(ends[1], rel=5e-3)


@pytest.mark.parametrize("seed", sorted({*range(sampled(200)), 98, 101}))  # two once took minutes for a step
def test_random_ropes_and_tackles_of_changing_length_make_no_energy(seed: int) -> None:
    """Masses on ropes that yield and on a tackle, of which some are hauled, in any mode and step."""
    dice = random.Random(seed)
    mode, dt = dice.choice(MODES), dice.choice((1 / 60, 1 / 120, 1 / 240))
    system = iota.System(mode=mode)
    nails = [system.body().particle((x, 3, 0)) for x in (-1.0, 0.0, 1.0)]
    for nail in nails:
        nail.nail()
    masses = [
        system.body().particle(
            (dice.uniform(-1, 1), dice.uniform(0, 2), dice.uniform(-1, 1)),
            mass=10 ** dice.uniform(-1, 2),
            velocity=[dice.uniform(-3, 3) for _ in range(3)],
        )
        for _ in range(3)
    ]
    ropes = []
    for mass in masses:
        for end in dice.sample([*nails, *(other for other in masses if other is not mass)], 2):
            rope = system.rope(mass, end)
            rope.length = abs(mass.position - end.position) * dice.uniform(0.9, 1.3)
            rope.compliance = (10 ** dice.uniform(-6, -3), 0.0, dice.choice((0.0, 0.01, 0.05)))
            ropes.append(rope)
    spans = [system.span(nail, masses[0]) for nail in nails[:2]]
    system.couple([(span.slide, 1.0) for span in spans], one_sided=True)
    hauled = dice.sample(ropes, 2) if dice.random() < 0.5 else []
    speed = dice.uniform(-0.3, 0.3)
    for _ in range(round(1 / dt)):
        for rope in hauled:
            rope.length = max(0.2, rope.length + speed * dt)
        report = system.step(dt)
        assert not [warning for warning in report.warnings if "energy.made" in warning]
    energy = system.energy
    assert energy.made <= 1e-6 * (energy.kinetic + abs(energy.potential) + 1)
    assert np.isfinite(energy.kinetic)


def test_a_drawer_at_rest_in_mode_accurate_warns_of_nothing() -> None:
    system = iota.System(mode="accurate")
    world = iota.World(system, dt=1 / 120)
    drawer = world.drawer((0, 1, 0))
    drawer.use()
    for _ in range(360):
        drawer.act()
        assert system.step(1 / 120).warnings == []


def two_tumbling_pairs(mode: Mode, rope: float | None, apart: float = 0.0) -> tuple[iota.System, list[iota.Body]]:
    """Two pairs of hinged boxes in space, tied by a rope of that length."""
    system = iota.System(gravity=(0, 0, 0), mode=mode)
    boxes, ends = [], []
    for side in (-1, 1):
        pair = [
            system.body(
                shape=iota.Box((0.3, 0.2, 0.1)),
                mass=1 + k,
                position=(side + 0.3 * k, 0, 0),
                attachments=[(0, 0.1, 0)],
                velocity=(side * apart, 0.2, 0),
                spin=(3 * side, 2, 5 + k),
            )
            for k in range(2)
        ]
        system.ball(*pair, at=(side + 0.15, 0.1, 0.05))
        boxes += pair
        ends.append(pair[0].attachments[0])
    if rope is not None:
        system.rope(*ends, rope)
    return system, boxes


def momenta(boxes: list[iota.Body]) -> np.ndarray:
    linear = np.sum([b.mass * np.array(b.velocity) for b in boxes], axis=0)
    turning = np.sum([np.cross(b.position, b.mass * np.array(b.velocity)) + b.angular_momentum for b in boxes], axis=0)
    return np.concatenate([linear, turning])


@pytest.mark.parametrize(("mode", "close"), [("robust", 1e-6), ("energy_keeping", 1e-9), ("accurate", 1e-6)])
def test_a_rope_that_is_never_taut_changes_no_motion_and_costs_little(mode: Mode, close: float) -> None:
    places, work = [], []
    for rope in (None, 9.0):
        system, boxes = two_tumbling_pairs(mode, rope)
        iterations = 0
        for _ in range(60):
            system.step(1 / 60)
            iterations += sum(island.iterations for island in system.islands())
        places.append(np.array([b.position for b in boxes] + [b.angular_velocity for b in boxes]))
        work.append(iterations)
    assert np.abs(places[1] - places[0]).max() < close
    assert work[1] < 1.5 * work[0]


@pytest.mark.parametrize("mode", ["energy_keeping", "accurate"])
def test_what_a_slack_rope_ties_keeps_momenta_and_energy_each_for_itself(mode: Mode) -> None:
    system, boxes = two_tumbling_pairs(mode, 9.0)
    system.step(1 / 60)
    before, energy = [momenta(boxes[:2]), momenta(boxes[2:])], system.energy.kinetic
    for _ in range(60):
        system.step(1 / 60)
    assert momenta(boxes[:2]) == pytest.approx(before[0], abs=1e-10)
    assert momenta(boxes[2:]) == pytest.approx(before[1], abs=1e-10)
    assert system.energy.kinetic == pytest.approx(energy, rel=1e-10)


@pytest.mark.parametrize("mode", MODES)
def test_a_rope_that_becomes_taut_between_two_free_things_keeps_what_both_have_together(mode: Mode) -> None:
    system, boxes = two_tumbling_pairs(mode, 2.6, apart=1)
    before = momenta(boxes)
    tight = 0
    highest = kinetic = system.energy.kinetic
    for _ in range(120):
        system.step(1 / 60)
        tight += any(abs(c.force) > 0 for c in system.constraints if c.kind == "rope")
        highest = max(highest, system.energy.kinetic)
    assert tight > 0
    assert momenta(boxes) == pytest.approx(before, abs=1e-9 if mode in ("energy_keeping", "accurate") else 1e-6)
    assert highest <= kinetic * (1 + 1e-9)


@pytest.mark.parametrize("mode", ["plausible", "robust", "energy_keeping"])
def test_a_box_on_a_rope_that_is_never_taut_turns_as_a_free_one(mode: Mode) -> None:
    ways = []
    for tied in (False, True):
        system, boxes = two_tumbling_pairs(mode, None)
        lone = system.body(
            shape=iota.Box((0.2, 0.3, 0.1)), position=(0, 5, 0), spin=(3, 20, 1), attachments=[(0.1, 0.1, 0)]
        )
        if tied:
            system.rope(lone.attachments[0], boxes[0].attachments[0], 100)
        for _ in range(60):
            system.step(1 / 60)
        ways.append(lone.attachments[0].position)
    assert ways[1] == pytest.approx(ways[0], abs=1e-9)
