# SPDX-License-Identifier: Apache-2.0
"""Nets of bars that are nailed exactly taut: only the compliance of their rows decides, which is no part of the world's energy."""

from __future__ import annotations

import numpy as np
import pytest

import iota


def taut_net(count: int, load: float) -> iota.System:
    system = iota.System()
    knots: dict[tuple[int, int], iota.Particle] = {}
    for i in range(count):
        for j in range(count):
            for end in ((i + 1, j), (i, j + 1)):
                if count in end:
                    continue
                bar = system.body()
                for at in ((i, j), end):
                    p = bar.particle((0.1 * at[0], 0, 0.1 * at[1]), mass=0.005)
                    if at in knots:
                        knots[at].combine(p)
                    else:
                        knots[at] = p
    for i in (0, count - 1):
        for j in (0, count - 1):
            knots[i, j].nail()
    middle = knots[count // 2, count // 2]
    middle.combine(system.body().particle(middle.position, mass=load))
    return system


@pytest.mark.parametrize(("count", "rate", "most"), [(6, 60, 1), (8, 60, 1), (10, 60, 1), (12, 60, 2), (6, 120, 1)])
def test_a_load_on_a_taut_net_does_not_get_as_motion_what_its_rows_have_stored(
    count: int, rate: int, most: float
) -> None:
    system = taut_net(count, 100)
    mass = np.array([p.mass for p in system.particles])

    def energy() -> float:
        places, speeds = (np.array([getattr(p, name) for p in system.particles]) for name in ("position", "velocity"))
        return float(mass @ (0.5 * (speeds**2).sum(1) + 9.81 * places[:, 1]))

    before = energy()
    for _ in range(rate // 2):
        system.step(1 / rate)
        now = energy()
        assert now <= before + most, "J: where the motion has not as much, a rest of it lifts the load"
        before = now
    assert system.energy.made < 0.1
    assert system.energy.balance == pytest.approx(0, abs=1e-6)
