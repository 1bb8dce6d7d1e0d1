# SPDX-License-Identifier: Apache-2.0
"""Dashpots that would stop a body within a fraction of a step: they stop it, and do not throw it back."""

from __future__ import annotations

from collections.abc import Callable

import pytest

import iota


def by_bond(system: iota.System, box: iota.Body, damping: float) -> None:
    anchor = system.body(kind="static").particle((-3, 0, 0))
    system.bond(box.attachment((-0.1, 0, 0)), anchor, "spring", stiffness=0, damping=damping, length=2.9)


def by_drag(system: iota.System, box: iota.Body, damping: float) -> None:
    anchor = system.body(kind="static").particle((-3, 0, 0))
    for at in ((-0.1, 0.1, 0), (-0.1, -0.1, 0.1), (-0.1, -0.1, -0.1), (0.1, 0, 0)):
        system.bond(box.attachment(at), anchor, "drag", damping=damping / 4)


def by_slide(system: iota.System, box: iota.Body, damping: float) -> None:
    system.prismatic(box, at=(0, 0, 0), axis=(1, 0, 0)).slide.spring = (0, damping, 0)


def by_hinge(system: iota.System, box: iota.Body, damping: float) -> None:
    """On an arm of 10 m, so that it goes almost straight on."""
    system.revolute(box, at=(0, 10, 0), axis=(0, 0, 1)).angle.spring = (0, 100 * damping, 0)


@pytest.mark.parametrize("mode", ["robust", "energy_keeping", "accurate"])
@pytest.mark.parametrize("hold", [by_bond, by_drag, by_slide, by_hinge])
def test_a_dashpot_of_any_strength_only_slows_what_it_holds(
    hold: Callable[[iota.System, iota.Body, float], None], mode: str
) -> None:
    for exponent in range(9):
        system = iota.System(gravity=(0, 0, 0), mode=mode)
        box = system.body(shape=iota.Box((0.2, 0.2, 0.2)), mass=1)
        hold(system, box, 10.0**exponent)
        box.velocity = (1, 0, 0)
        energy, book = system.energy.kinetic, system.energy.balance
        for _ in range(20):
            system.step(1 / 60)
            assert box.velocity.x > -1e-6, f"is thrown back by 1e{exponent} N s/m"
            assert system.energy.kinetic <= energy * (1 + 1e-9) + 1e-15
            energy = system.energy.kinetic
        assert system.energy.balance == pytest.approx(book, abs=1e-9)
        if mode == "energy_keeping":
            assert system.energy.lost + system.energy.made < 1e-4, "the dashpot has taken it"
        if exponent >= 2:
            assert energy < 1e-9, f"1e{exponent} N s/m stop it"


def test_a_dashpot_that_does_not_stop_a_body_within_a_step_is_followed_to_second_order() -> None:
    def error(rate: int) -> float:
        system = iota.System(gravity=(0, 0, 0))
        box = system.body(shape=iota.Box((0.2, 0.2, 0.2)), mass=1, velocity=(1, 0, 0))
        by_slide(system, box, 20)
        system.step(1 / rate, rate // 10)
        return abs(box.velocity.x - 2.718281828459045**-2)

    assert 3.7 < error(120) / error(240) < 4.3
