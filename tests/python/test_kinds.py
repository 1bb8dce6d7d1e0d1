# SPDX-License-Identifier: Apache-2.0
from __future__ import annotations

import pytest

import iota


def test_a_body_falls_asleep_and_wakes(system: iota.System, chain: list[iota.Body]) -> None:
    system.damping, system.rest_after, system.rest_speed = 5, 0.2, 0.02
    for _ in range(1000):
        report = system.step(0.01)
        if report.resting:
            break
    assert report.resting == len(chain) and chain[0].kind == "resting"
    chain[2].particles[0].apply_force((1, 0, 0))
    assert system.step(0.01).resting == 0 and chain[0].kind == "dynamic"
    chain[0].kind = "resting"
    assert chain[-1].kind == "resting"
    with pytest.raises(ValueError, match="only dynamic bodies can rest"):
        system.body(kind="static").kind = "resting"


def test_things_are_switched_off_and_on(system: iota.System, chain: list[iota.Body]) -> None:
    end = chain[-1].particles[-1]
    mass = end.mass
    end.active = False
    assert not end.active and end.mass == mass and chain[-1].mass < 0.6 * 2 * mass
    end.active = True
    chain[-1].active = False
    place = end.position
    for _ in range(20):
        assert system.step(0.01).worst_gap < 1e-8
    assert end.position == place and chain[-1].kind == "inactive"
    chain[0].articulate.active = True
    assert chain[-1].active and system.worst_gap < 1e-8
    chain[0].articulate.active = False
    assert not any(link.active for link in chain) and system.validate() == []
