# SPDX-License-Identifier: Apache-2.0
"""Angle springs from a script: a beam, a molecule, and what is refused."""

from __future__ import annotations

import math
from itertools import pairwise

import pytest

import iota

MODES = ("plausible", "robust", "energy_keeping", "accurate")


@pytest.mark.parametrize("mode", MODES)
def test_a_chain_of_rods_sags_by_its_weight_as_a_clamped_beam(mode: str) -> None:
    """The tip of a beam of length L with the weight q per length sags by q L^4 / 8 EI."""
    count, length, mass, stiffness = 32, 1.0, 0.2, 40.0
    system = iota.System(mode=mode, damping=3.0)
    each = length / count
    rods = []
    for k in range(count):
        rod = system.body()
        rod.particle((k * each, 0, 0))
        rod.particle(((k + 1) * each, 0, 0))
        rod.set_rod(mass / count, 0.001)
        rods.append(rod)
    for before, after in pairwise(rods):
        before.particles[1].combine(after.particles[0])
        knee = system.angle_spring(
            before.particles[0], after.particles[0], after.particles[1], stiffness / each, 3.0, rest=math.pi
        )
        assert knee.ends == (before.particles[0], after.particles[0], after.particles[1])
    # The clamp is half a link before the first joint.
    rods[0].particles[0].nail()
    rods[0].particles[1].nail()
    for _ in range(480):
        assert system.step(1 / 120).unconverged == 0
    free = length - each / 2
    sag = mass * 9.81 / length * free**4 / (8 * stiffness)
    assert -rods[-1].particles[1].position.y == pytest.approx(sag, rel=0.05)
    assert system.energy.made < 1e-9


def test_its_options_and_readings_follow_assignments() -> None:
    system = iota.System(gravity=(0, 0, 0))
    one, other = system.body(), system.body()
    p, middle = one.particle((0, 1, 0)), one.particle((0, 0, 0))
    end, q = other.particle((0, 0, 0)), other.particle((1, 0, 0))
    middle.combine(end)
    spring = system.angle_spring(p, middle, q, 4.0)
    assert system.angle_springs == [spring] and spring.alive
    assert (spring.stiffness, spring.damping) == (4.0, 0.0)
    assert spring.rest == pytest.approx(math.pi / 2) and spring.angle == pytest.approx(math.pi / 2)
    assert spring.moment == pytest.approx(0, abs=1e-12)
    spring.rest, spring.damping = 2.0, 0.5
    assert spring.moment > 0, "it opens the angle"
    for _ in range(600):
        system.step(1 / 60)
    assert spring.angle == pytest.approx(2.0, abs=1e-3)
    assert repr(spring) == f"<AngleSpring {spring.slot}>"
    spring.destroy()
    assert not spring.alive
    with pytest.raises(iota.StaleIdError, match="angle spring 0 is gone"):
        spring.stiffness = 1.0


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({"stiffness": -1}, "stiffness must be zero or more"),
        ({"stiffness": 1, "damping": math.inf}, "damping must be zero or more and finite"),
        ({"stiffness": 1, "rest": 0}, "between 0.01 and pi"),
        ({"stiffness": 1, "rest": math.nan}, "rest must be a number or None"),
    ],
)
def test_numbers_that_are_no_angle_spring_are_refused(options: dict[str, float], said: str) -> None:
    system = iota.System()
    p, middle, q = (system.body().particle(at) for at in ((0, 1, 0), (0, 0, 0), (1, 0, 0)))
    with pytest.raises(ValueError, match=said):
        system.angle_spring(p, middle, q, **options)
    with pytest.raises(ValueError, match="needs three particles"):
        system.angle_spring(p, middle, p, 1.0)
    with pytest.raises(ValueError, match="another system"):
        system.angle_spring(p, middle, iota.System().body().particle(), 1.0)
    assert system.angle_springs == []
