# SPDX-License-Identifier: Apache-2.0
"""Reports are values: they can be copied, and pickled for another process."""

from __future__ import annotations

import copy
import pickle
from typing import Any

import numpy as np
import pytest
import sweep

import iota

COPIES = {"pickled": lambda report: pickle.loads(pickle.dumps(report)), "copied": copy.copy, "deep": copy.deepcopy}


def shown(report: Any) -> dict[str, Any]:
    """All that a script sees of a report."""
    names = [n for n, m in vars(type(report)).items() if isinstance(m, property) and not n.startswith("_")]
    return {name: getattr(report, name) for name in names}


@pytest.mark.parametrize("way", COPIES)
def test_a_step_report_is_the_same_in_another_process(way: str) -> None:
    scene = sweep.Scene()
    for _ in range(5):
        report = scene.system.step(1 / 60)
    copied = COPIES[way](report)
    before, after = shown(report), shown(copied)
    assert before.pop("energy").__getstate__() == after.pop("energy").__getstate__()
    assert before == after
    assert report.births + report.deaths + report.iterations_max > 0, "the scene has nothing to show"


@pytest.mark.parametrize("way", COPIES)
def test_an_energy_and_a_diagnosis_are_the_same_in_another_process(way: str) -> None:
    scene = sweep.Scene()
    scene.system.step(1 / 60)
    energy, diagnosis = scene.system.energy, scene.system.diagnose(scene.box)
    assert shown(COPIES[way](energy)) == shown(energy) and energy.kinetic != 0
    assert shown(COPIES[way](diagnosis)) == shown(diagnosis) and len(diagnosis.singular_values) > 3


def test_a_report_of_an_edit_keeps_its_system_when_it_is_copied_and_loses_it_when_it_is_pickled() -> None:
    scene = sweep.Scene()
    report = scene.rods[1].particles[1].separate(scene.rods[2].particles[0])
    merged = scene.rods[0].combine(scene.rods[1])
    for original in (report, merged):
        assert shown(copy.copy(original)) == shown(copy.deepcopy(original)) == shown(original)
    far = pickle.loads(pickle.dumps(merged))
    assert far.notes == merged.notes and far.energy_change == merged.energy_change
    assert [a.slot for a, _ in far.absorbed_bodies] == [a.slot for a, _ in merged.absorbed_bodies] != []
    with pytest.raises(ValueError, match="this handle has no system: it comes from a report that was pickled"):
        _ = far.absorbed_bodies[0][0].mass


def test_a_body_is_moved_and_turned_by_assignment() -> None:
    system = iota.System(gravity=(0, 0, 0))
    box = system.body(shape=iota.Box((1, 2, 3)), position=(1, 2, 3), velocity=(0, 0, 1))
    assert box.position == box.center_of_mass == (1, 2, 3)
    box.position = (4, 5, 6)
    half = np.sqrt(0.5)
    box.orientation = (0, 0, half, half)
    np.testing.assert_allclose(box.position, (4, 5, 6), atol=1e-12)
    np.testing.assert_allclose(box.orientation, (0, 0, half, half), atol=1e-12)
    # A quarter turn about z swaps the moments about x and y.
    np.testing.assert_allclose(np.diag(box.inertia), np.array([10, 13, 5]) * 500, rtol=1e-9)
    system.step(0.5)
    np.testing.assert_allclose(box.position, (4, 5, 6.5), atol=1e-9)
