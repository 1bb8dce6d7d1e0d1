# SPDX-License-Identifier: Apache-2.0
"""Calls of the public interface at random, with good, odd and bad arguments: nothing but refusals in words may be raised,
and the system stays whole and finite. IOTA_FUZZ_CALLS asks for more than the usual thousand."""

from __future__ import annotations

import os
import random
from typing import Any

import pytest
import sweep
from amount import TRIES_ALL

import iota

CALLS = int(os.environ.get("IOTA_FUZZ_CALLS", "3000" if TRIES_ALL else "500"))
ROUNDS = 10
ITERATIONS = 0 if TRIES_ALL else 300  # of a step: a search for what has no solution takes seconds
# Slow, and swept elsewhere; threads: a crash in a worker thread is no finding that a seed repeats.
SKIPPED = {"System.positions", "System.velocities", "System.solver", "System.threads", "diagnose"}


def fresh() -> sweep.Scene:
    scene = sweep.Scene()
    scene.system.budget_iterations = ITERATIONS
    return scene


def arguments_for(scene: sweep.Scene, given: dict[str, Any], dice: random.Random) -> dict[str, Any]:
    """Good arguments, handles exchanged for others of their kind, and now and then a bad one."""
    system = scene.system
    pools = ((iota.Particle, system.particles), (iota.Body, system.bodies))
    out = {}
    for name, value in given.items():
        out[name] = value
        for kind, pool in pools:
            if isinstance(value, kind) and pool:
                out[name] = dice.choice(pool)
        if dice.random() < 0.1 and name not in sweep.HANDLES:
            out[name] = dice.choice(sweep.bad_values(scene, value))
    return out


@pytest.mark.parametrize("seed", range(ROUNDS))
@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")
def test_random_calls_leave_the_system_whole(seed: int) -> None:
    dice = random.Random(seed)
    scene = fresh()
    names = [name for name in sweep.calls(scene) if name not in SKIPPED]
    made: list[str] = []
    for number in range(CALLS // ROUNDS):
        table = {}
        while not table:  # what the table names may be gone: then a fresh start
            try:
                table = sweep.calls(scene)
            except (iota.StaleIdError, IndexError):
                scene = fresh()
                made.clear()
        name = dice.choice(names)
        function, given = table[name]
        given = arguments_for(scene, given, dice)
        made.append(f"{name}({', '.join(f'{k}={v!r:.60}' for k, v in given.items())})")
        try:
            sweep.refused(function, given)
            assert scene.system.validate() == []
            if number % 10 == 0:
                sweep.check(scene, steps=1)
        except iota.ForceError:
            pass
        except Exception as error:
            raise AssertionError(f"seed {seed}: {error!r} after\n" + "\n".join(made[-8:])) from error
        if len(scene.system.bodies) > 80:
            scene = fresh()
            made.clear()
