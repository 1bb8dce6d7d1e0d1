# SPDX-License-Identifier: Apache-2.0
"""All studies: each goes on for as long as it is watched, with its story told over and over."""

from __future__ import annotations

import os

import numpy as np
import pytest

from iota import studies

SECONDS = float(os.environ.get("IOTA_STUDY_SECONDS", "5"))  # tools/soak.py asks for ten minutes


@pytest.mark.parametrize("name", studies.names())
def test_it_goes_on(name: str) -> None:
    world = studies.module(name).build()
    system, unconverged = world.system, 0
    steps = round(SECONDS / world.dt)
    for _ in range(steps):
        report = world.step()
        assert report is not None and report.worst_gap < 1e-3
        unconverged += report.unconverged > 0
    assert unconverged < 1e-2 * steps
    assert system.validate() == []
    places = system.positions
    assert np.isfinite(places).all() and np.abs(places).max() < 100, "nothing flies away"


@pytest.mark.parametrize("name", studies.names())
def test_something_moves_within_two_seconds(name: str) -> None:
    world = studies.module(name).build()
    begin = {particle: particle.position for particle in world.system.particles}
    size = float(np.linalg.norm(np.ptp([tuple(place) for place in begin.values()], axis=0)))
    farthest = 0.0
    while world.system.time < 2 and farthest < 0.02 * size:
        world.step()
        farthest = max(abs(particle.position - place) for particle, place in begin.items() if particle.alive)
    assert farthest >= 0.02 * size, f"{farthest / size:.3f} of its size"
