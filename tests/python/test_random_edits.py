# SPDX-License-Identifier: Apache-2.0
"""Random sequences of edits and steps: the structure stays whole and momentum is kept."""

from __future__ import annotations

import random
from collections.abc import Callable

import numpy as np
import pytest

import iota

Edit = Callable[[random.Random, iota.System], str]


def pick(dice: random.Random, system: iota.System) -> tuple[iota.Particle, iota.Particle]:
    particles = system.particles
    return dice.choice(particles), dice.choice(particles)


def combine(dice: random.Random, system: iota.System) -> str:
    p, q = pick(dice, system)
    over = dice.choice([0.0, 0.0, 0.05])
    try:
        p.combine(q, over=over)
    except ValueError as refused:  # a rigid body cannot have two of its particles in one place
        return f"refused: {refused}"
    return f"combine({p.slot}, {q.slot}, {over})"


def separate(dice: random.Random, system: iota.System) -> str:
    p = dice.choice(system.particles)
    q = dice.choice(p.ring if dice.random() < 0.7 else system.particles)
    if p == q and len(system.particles) > 40:
        return "nothing"
    p.separate(q)
    return f"separate({p.slot}, {q.slot})"


def weld(dice: random.Random, system: iota.System) -> str:
    a, b = dice.choice(system.bodies), dice.choice(system.bodies)
    if a == b or len(system.bodies) < 4:
        return "nothing"
    a.combine(b)
    return f"weld({a.slot}, {b.slot})"


def guide(dice: random.Random, system: iota.System) -> str:
    p = dice.choice(system.particles)
    x, y, z = p.position
    system.on_path(p, [(x + 0.2 * i, y + dice.uniform(-0.1, 0.1) * i, z) for i in range(-3, 4)])
    return f"guide({p.slot})"


def step(dice: random.Random, system: iota.System) -> str:
    system.step(1 / 120)
    return "step"


def scene(dice: random.Random) -> iota.System:
    """Six rods in space, at random places and speeds."""
    system = iota.System(gravity=(0, 0, 0))
    for _ in range(6):
        body = system.body()
        at = [dice.uniform(-1, 1) for _ in range(3)]
        body.particle(at, mass=dice.uniform(0.5, 2), velocity=[dice.uniform(-1, 1) for _ in range(3)])
        body.particle([at[0] + 0.3, at[1], at[2]], mass=dice.uniform(0.5, 2))
    return system


@pytest.mark.parametrize("seed", range(40))
def test_random_edits_keep_the_structure_whole_and_momentum(seed: int) -> None:
    """Edits keep momentum to round-off, steps to the solver's tolerance; nothing here is nailed."""
    dice = random.Random(seed)
    system = scene(dice)
    system.step(1 / 120)
    done: list[str] = []
    for _ in range(60):
        before = system.momentum
        edit: Edit = dice.choices([combine, separate, weld, step], [4, 4, 1, 6])[0]
        done.append(edit(dice, system))
        assert system.validate() == [], done
        assert abs(system.momentum - before) < (1e-3 if edit is step else 1e-11), done
        assert np.isfinite(system.positions).all() and system.worst_gap < 1e3, done


@pytest.mark.parametrize("seed", range(10))
def test_random_edits_replay_to_the_same_bits(seed: int) -> None:
    dice = random.Random(seed)
    system = scene(dice)
    for _ in range(3):
        system.start_recording()
        for _ in range(30):
            dice.choices([combine, separate, weld, guide, step], [4, 4, 1, 1, 6])[0](dice, system)
        recording = system.stop_recording()
        assert iota.System().replay(recording) is None
