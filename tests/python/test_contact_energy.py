# SPDX-License-Identifier: Apache-2.0
"""Bodies that fly, spin, hit each other and lie on the ground: their energy never rises, and all of it is in some account.

Random scenes of 1 to 13 solids of 1 cm to 10 m, in all ways to solve contacts, judged by the sums of their energies.
"""

from __future__ import annotations

import math
import random
from typing import Any

import numpy as np
import pytest
from amount import sampled

import iota

GRAVITY = 9.81


class Blows:
    """A random scene; its time between two steps."""

    def __init__(self, seed: int) -> None:
        random = np.random.default_rng(seed)
        size = 10 ** random.uniform(-2, 1)
        hz = float(random.choice([30, 60, 120, 240, 1000]))
        count = int(random.integers(1, 14))
        friction, restitution = float(random.choice([0, 0.3, 0.8])), float(random.choice([0, 0, 0.5, 1]))
        self.h, self.steps = 1 / hz, min(600, int(1.5 * math.sqrt(size) * hz) + 20)
        mode = "robust" if seed % 2 else "energy_keeping"
        self.system = iota.System(gravity=(0, -GRAVITY, 0), mode=mode, threads=1)
        self.system.usual_material = iota.Material(friction=friction, restitution=restitution)
        self.system.obstacle(iota.Box((400 * size, 10 * size, 400 * size)), position=(0, -5 * size, 0))
        shapes = (
            iota.Box((size, 0.7 * size, 1.3 * size)),
            iota.Sphere(size / 2),
            iota.Capsule(radius=0.3 * size, length=0.8 * size),
            iota.Cylinder(radius=0.4 * size, length=size),
        )
        speed = math.sqrt(GRAVITY * size)
        for k in range(count):
            shape, turn = shapes[int(random.integers(0, 4))], random.normal(size=4)
            body = self.system.body(
                shape=shape,
                mass=10 ** random.uniform(-1, 1) * size**3,
                position=tuple(size * np.array([1.7 * (k % 3), 1.5 + 1.7 * (k // 9), 1.7 * (k // 3 % 3)])),
                orientation=tuple(turn / np.linalg.norm(turn)),
            )
            body.velocity = tuple(3 * speed * random.normal(size=3))
            body.angular_velocity = tuple(3 * speed / size * random.normal(size=3))
        if seed % 5 == 0:
            self.system.budget_contacts = 1.0  # all heaps by sweeps

    def play(self) -> tuple[float, float]:
        """The largest rise of energy in a step and what is in no account at the end, of the energy after the first step."""
        first = self.system.step(self.h).energy
        whole, last, rise = first.kinetic + abs(first.potential), first.kinetic + first.potential, 0.0
        for _ in range(self.steps):
            energy = self.system.step(self.h).energy
            rise, last = max(rise, energy.kinetic + energy.potential - last), energy.kinetic + energy.potential
        return rise / whole, abs(energy.balance) / whole


# The first ones made energy: bodies that had swung into each other were lifted for nothing, friction of rebounds drove, and
# rebounds of sweeps rose higher than they had fallen.
SEEDS = [404, 408, 456, 462, 324, 638, 400, 490, *range(sampled(1000))]


@pytest.mark.parametrize("seed", SEEDS)
def test_energy_of_what_hits_each_other_never_rises(seed: int) -> None:
    rise, missing = Blows(seed).play()
    by_sweeps = seed % 5 == 0
    assert rise < (1e-3 if by_sweeps else 1e-7)  # contacts give back what their compliance had stored, 4e-8
    assert missing < 1e-9


# Jams at 0.6: no friction along the slip balances what presses itself (Painleve 1895). At 1 and 2 most only slip, but would pull if they stuck.
WHIPS = {
    0.6: [492, 614, 770, 854, 1960, 2412, 2870, 3017, 4322, 4736, 5250, 5290, 5487],
    1.0: [2946, 2998],
    2.0: [2928, 2942, 2998],
}


@pytest.mark.parametrize(
    ("friction", "seed"), [(friction, seed) for friction, seeds in WHIPS.items() for seed in seeds]
)
def test_the_tip_of_a_whip_that_meets_another_link_is_solved(friction: float, seed: int) -> None:
    dice = random.Random(seed)
    system = iota.System(threads=1)
    system.usual_material = iota.Material(friction=friction)
    count, length, angle = dice.randint(4, 10), dice.uniform(0.1, 0.5), dice.uniform(-0.3, 1.2)
    at, links = iota.Vec3(0, 0, 0), list[iota.Body]()
    for _ in range(count):
        link = system.body()
        upper = link.particle(at)
        aside = 0.0 if seed % 2 == 0 else 0.3 * dice.uniform(-1, 1)
        at = at + iota.Vec3(math.cos(angle), math.sin(angle), aside) * length * dice.uniform(0.7, 1.3)
        link.particle(at)
        angle += dice.uniform(-0.3, 0.3)
        if links:
            links[-1].particles[1].combine(upper)
        else:
            upper.nail()
        links.append(link)
    before = system.energy
    for step in range(240):
        assert system.step(1 / 120).unconverged == 0, step
        energy = system.energy
        rise = energy.kinetic + energy.potential - before.kinetic - before.potential
        assert rise <= 1e-4 * energy.kinetic + 1e-9, step
        before = energy


def test_what_bounces_makes_no_energy_in_the_parts_of_a_step_either() -> None:
    """`accurate` goes on within the step after an impact: what the contact had stored was counted twice as released."""
    for shape in (iota.Sphere(0.1), iota.Box((0.3, 0.2, 0.4)), iota.Cylinder(0.1, 0.4)):
        for mode in ("energy_keeping", "accurate"):
            system = iota.System(mode=mode)
            system.usual_material = iota.Material(friction=0.5, restitution=0.5)
            system.obstacle(iota.HalfSpace((0, 1, 0)))
            body = system.body(shape=shape, position=(0, 0.6, 0), velocity=(1, -2, 0.5))
            body.angular_velocity = (3, -2, 4)
            system.step(1 / 60)
            before = system.energy
            for _ in range(90):
                assert system.step(1 / 60).warnings == [], (shape, mode)
            taken = before.total - system.energy.total
            assert system.energy.made < 1e-9 * before.kinetic
            assert taken == pytest.approx(system.energy.dissipated + system.energy.lost, rel=1e-6)


@pytest.mark.parametrize("mode", ["energy_keeping", "robust"])
def test_what_falls_on_a_scripted_plate_that_turns_loses_no_more_than_its_own_energy(mode: Any) -> None:
    """The plate was stopped and driven on where contacts began: 23 times in 6 s its energy, 2 kJ, was told as dissipated."""
    system = iota.System(mode=mode)
    system.usual_material = iota.Material(friction=0.6)
    plate = system.body("scripted", shape=iota.Box((1, 0.1, 1)), position=(0, 1, 0), mass=1000)
    for k in range(2):
        system.body(shape=iota.Sphere(0.06), mass=0.2, position=(0.05 + 0.1 * k, 1.2 + 0.13 * k, 0))
    system.step(1 / 120, 10)
    edits, work = system.energy.edits, system.energy.external_work
    for k in range(250):
        plate.set_pose((0, 1, 0), ("y", 5 * k / 120 * 180 / math.pi))
        system.step(1 / 120)
        energy = system.energy
        assert abs(energy.dissipated) + abs(energy.lost) < 2 * 0.2 * GRAVITY * 0.3
    assert energy.external_work - work == pytest.approx(plate.energy.kinetic, rel=1e-3)
    assert energy.edits == pytest.approx(edits, abs=20)
