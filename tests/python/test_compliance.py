# SPDX-License-Identifier: Apache-2.0
"""Joints, rods and ropes that yield: against beams, springs and pendulums on paper."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest

import iota

MODES = ("plausible", "robust", "energy_keeping", "accurate")


def settle(system: iota.System, seconds: float = 4.0) -> None:
    for _ in range(round(seconds * 240)):
        assert system.step(1 / 240).unconverged == 0


@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("compliance", [1e-8, 1e-5, 1e-2])
def test_a_weld_yields_to_a_load_by_its_compliance(mode: str, compliance: float) -> None:
    system = iota.System(mode=mode)
    body = system.body(shape=iota.Box((0.2, 0.2, 0.2)), mass=2.0)
    weld = system.weld(body, at=(0, 0, 0))
    weld.compliance = (compliance, 0, 0.1)
    settle(system)
    assert body.position.y == pytest.approx(-2 * 9.81 * compliance, rel=1e-3, abs=1e-12)
    assert weld.force.y == pytest.approx(2 * 9.81, rel=1e-4)
    assert weld.gap < 1e-12, "what yields is not violated"


@pytest.mark.parametrize("size", [1e-3, 1.0, 1e2])
@pytest.mark.parametrize("mode", ["robust", "energy_keeping"])
def test_a_torque_turns_a_weld_by_its_angular_compliance_at_any_size(mode: str, size: float) -> None:
    system = iota.System(gravity=(0, 0, 0), mode=mode)
    bodies = [system.body(shape=iota.Box((size, size, size)), mass=2.0, position=(k * size, 0, 0)) for k in (0, 1)]
    system.weld(bodies[0], at=(0, 0, 0))
    joint = system.weld(bodies[0], bodies[1], at=(0.5 * size, 0, 0))
    torque = 1e-2 * 2.0 * size**2
    joint.compliance = (0, 0.05 / torque, 3)  # its own period is 9 s
    for _ in range(1500):
        bodies[1].apply_torque((0, 0, torque))
        assert system.step(1 / 30).unconverged == 0
    along = np.array(bodies[1].orientation)
    assert 2 * math.atan2(along[2], along[3]) == pytest.approx(0.05, rel=2e-3)


@pytest.mark.parametrize("mode", ["energy_keeping", "accurate"])
def test_a_weight_on_a_compliant_rod_swings_with_the_frequency_of_its_spring_and_keeps_its_energy(mode: str) -> None:
    system = iota.System(mode=mode)
    top, weight = system.particle_array([(0, 0, 0), (0, -1, 0)], masses=0.5)
    top.nail()
    rod = system.rod(top, weight)
    rod.compliance = 1 / 200  # 200 N/m
    start = system.energy
    lowest, crossings = 0.0, []
    middle = -1 - 0.5 * 9.81 / 200
    before = weight.position.y
    for i in range(2000):
        system.step(1 / 500)
        now = weight.position.y
        lowest = min(lowest, now)
        if before > middle >= now:
            crossings.append(i + (before - middle) / (before - now))
        before = now
    period = (crossings[-1] - crossings[0]) / (len(crossings) - 1) / 500
    assert period == pytest.approx(2 * math.pi * math.sqrt(0.5 / 200), rel=2e-2)
    assert lowest == pytest.approx(-1 - 2 * 0.5 * 9.81 / 200, rel=2e-3)
    end = system.energy
    assert end.kinetic + end.potential == pytest.approx(start.kinetic + start.potential, abs=1e-8)


def test_a_compliant_rope_pulls_like_a_spring_and_never_pushes() -> None:
    system = iota.System()
    top, weight = system.particle_array([(0, 0, 0), (0, -0.5, 0)])
    top.nail()
    rope = system.rope(top, weight, 1.0)
    rope.compliance = (1e-2, 0, 0.5)
    for _ in range(40):
        system.step(1 / 240)
    fallen = 40 / 240
    assert weight.position.y == pytest.approx(-0.5 - 0.5 * 9.81 * fallen**2, abs=0.03), "slack: it falls"
    settle(system, 10)
    assert weight.position.y == pytest.approx(-1 - 9.81e-2, rel=5e-3)


def test_compliance_may_change_while_the_world_runs_and_is_saved() -> None:
    system = iota.System()
    body = system.body(shape=iota.Box((0.2, 0.2, 0.2)), mass=2.0)
    weld = system.weld(body, at=(0, 0, 0))
    assert weld.compliance == (0, 0, 0)
    with system.edit():
        weld.compliance = (1e-2, 0, 0.1)
    settle(system)
    assert body.position.y == pytest.approx(-2 * 9.81e-2, rel=1e-3)
    snapshot = system.snapshot()
    weld.compliance = 0
    settle(system, 0.1)
    assert abs(body.position.y) < 1e-9
    system.restore(snapshot)
    assert weld.compliance == (1e-2, 0, 0.1)
    weld.compliance = 0
    assert weld.compliance == (0, 0, 0)


def test_an_angle_can_be_set_in_a_loop_with_a_compliant_joint() -> None:
    system = iota.System(gravity=(0, 0, 0))
    places = [(0, 0, 0), (0, 1, 0), (2, 1.5, 0), (2, 0, 0)]
    links = [
        system.body(shape=iota.Box((0.1, 0.1, 0.1)), mass=1.0, position=np.mean([p, q], axis=0))
        for p, q in pairwise(places)
    ]
    ends = [None, *links, None]
    joints = [
        system.revolute(b or a, a if b else None, at=place, axis=(0, 0, 1))
        for a, b, place in zip(ends[:-1], ends[1:], places, strict=True)
    ]
    joints[2].compliance = (1e-4, 1e-4)
    joints[0].angle.value = 0.2
    assert joints[0].angle.value == pytest.approx(0.2, abs=1e-8)
    assert joints[2].compliance == (1e-4, 1e-4, 0)
    for _ in range(10):
        assert system.step(1 / 120).unconverged == 0
    assert joints[0].angle.value == pytest.approx(0.2, abs=1e-6), "nothing was stretched"


def test_a_callback_that_cannot_yield_is_a_clear_error() -> None:
    system = iota.System()
    a, b = system.particle_array([(0, 0, 0), (1, 0, 0)])
    path = system.on_path(a, [(0, 0, 0), (1, 0, 0), (2, 1, 0)])
    rod = system.rod(a, b)
    with pytest.raises(ValueError, match="a path is always exact"):
        path.compliance = 1e-3
    with pytest.raises(ValueError, match="compliance"):
        rod.compliance = -1
    with pytest.raises(TypeError, match=r"compliance must be m/N or \(m/N, rad"):
        rod.compliance = "soft"
    assert rod.compliance == (0, 0, 0)


@pytest.mark.parametrize("compliance", [1e-6, 1e-7, 1e-9])
def test_a_stiff_joint_costs_accurate_no_sub_steps_and_the_told_error_holds(compliance: float) -> None:
    """Against explicit steps that follow each vibration."""

    def swing(hz: int, tolerance: float) -> tuple[np.ndarray, float, int]:
        system = iota.System(mode="accurate")
        system.tolerance = tolerance
        anchor = system.body(kind="static").particle((0, 0, 0))
        bob = system.body().particle((1, 0, 0), mass=1)
        system.rod(anchor, bob).compliance = compliance
        told, most = 0.0, 0
        for _ in range(hz):
            report = system.step(1 / hz)
            told, most = told + report.error / hz, max(most, report.substeps_max)
        assert abs(system.energy.balance) < 1e-12
        return np.array(bob.position), told, most

    place, told, most = swing(60, 1e-4)
    assert most < 10
    assert abs(np.linalg.norm(place) - 1 - compliance * 3 * 9.81 * -place[1]) < 1e-3 * compliance, (
        "its load stretches it"
    )
    if compliance == 1e-6:
        truth, _, _ = swing(600, 1e-9)
        assert np.linalg.norm(place - truth) < max(told, 1e-5)
