# SPDX-License-Identifier: Apache-2.0
"""All studies: each goes on for as long as it is watched, with its story told over and over."""

from __future__ import annotations

import os
import re
import runpy
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from amount import TRIES_ALL
from built_studies import built
from penetration import Drawn
from repeatable import REPEATABLE

import iota
from iota import studies
from iota._core import Log
from iota.world.actions import PAGE_KEYS

SECONDS = float(os.environ.get("IOTA_STUDY_SECONDS", "5" if TRIES_ALL else "3"))  # tools/soak.py asks for ten minutes
USUAL_LOOK = 0.25 if TRIES_ALL else 0.5  # s, between two looks
USUALLY_LOOKED_AT = 8.0 if TRIES_ALL else 3.0  # s
LOOKS = {"lab": 1.0, "museum": 1.0}  # a room of 65 000 triangles; 900 bodies
DEEPEST = 0.03  # share of the smaller shape
# A fish that feeds is between leaves, and fish do not know of weed. Blocks that are hit and turn fast may get into each
# other, and are eased out within 0.1 s: docs/contact.md, Not here yet. So may what falls on a heap. An acrobat's own limbs do not touch,
# nor do the threads of a flag.
DEEPER = {
    "museum": 0.2,
    "stack": 0.07,
    "crowd": 0.4,
    "undersea": 0.2,
    "wrecking-ball": 0.15,
    "pour": 0.35,
    "ragdolls": 0.1,
}
LOOKED_AT = {
    "museum": 3.0,
    "undersea": 16.0 if TRIES_ALL else 4.0,
    "molecule": 13.0,
    "lab": 5.0 if TRIES_ALL else 3.0,
    "pour": 4.0 if TRIES_ALL else 3.0,
    "capstan": 3.0,
    "knot": 2.0,
    "ragdolls": 6.0 if TRIES_ALL else 4.0,
}
STYLES = {"chain": ("rope", "chain")}
NOT_LOOKED_AT = {"shoal"}  # a thousand fish: at their start in test_penetration.py, later in test_study_cloth.py
GAPS = {"pour": 0.02, "ragdolls": 0.02}  # m, if more than usual: of what falls on a heap that is solved by sweeps


@pytest.mark.parametrize("name", studies.names())
def test_something_moves_it_goes_on_and_nothing_passes_through_anything(name: str) -> None:
    """For its first seconds or its story nothing that is drawn does; something moves within two seconds."""
    world = studies.module(name).build()
    system, unconverged = world.system, 0
    begin = {particle: particle.position for particle in system.particles}
    size, farthest = float(np.linalg.norm(np.ptp([tuple(place) for place in begin.values()], axis=0))), 0.0
    styles = [] if name in NOT_LOOKED_AT else [Drawn(world, style) for style in STYLES.get(name, ("",))]
    looked_at = round((LOOKED_AT.get(name, USUALLY_LOOKED_AT) if styles else 0.0) / world.dt)
    steps = max(looked_at, round(SECONDS / world.dt))
    for step in range(steps):
        if step < looked_at and step % round(LOOKS.get(name, USUAL_LOOK) / world.dt) == 0:
            for drawn in styles:
                assert drawn.overlaps(DEEPER.get(name, DEEPEST)) == []
        report = world.step()
        assert report is not None and report.worst_gap < GAPS.get(name, 1e-3)
        unconverged += report.unconverged > 0
        if farthest < 0.02 * size and system.time < 2 and step % 10 == 9:
            farthest = max(abs(particle.position - place) for particle, place in begin.items() if particle.alive)
    assert farthest >= 0.02 * size, f"{farthest / size:.3f} of its size"
    assert unconverged < 1e-2 * steps
    assert system.validate() == []
    places = system.positions
    assert np.isfinite(places).all() and np.abs(places).max() < 100, "nothing flies away"


def goes_on_from(log: Log, system: iota.System, step: Callable[[], object], count: int) -> int | None:
    """The first of so many steps after which another system that was restored before them is in another state."""
    log.take()
    other = iota.System()
    other.restore(log.snapshot())
    log.take()
    for number in range(count):
        step()
        taken = log.take()
        assert taken is not None
        Log(other).repeat(taken[0])
        if other.state_hash() != system.state_hash():
            return number
    return None


# Those in which restored states once went on in another way, after so many steps: by pairs of bodies that the tree of boxes found,
# whose boxes depend on their history; by a length of springs that was measured when their equations were set up; by velocities that
# were given to the last acrobat.
RESTORED = {"ragdolls": 300, "cloth": 60, "crowd": 0}


@pytest.mark.parametrize("name", REPEATABLE)
def test_its_states_go_on_with_the_same_bits_in_another_system(name: str) -> None:
    world = studies.module(name).build()
    world._begin()
    system, log = world.system, Log(world.system)
    assert log.functions() == []
    log.start()
    for _ in range(RESTORED.get(name, 0)):
        world.step()
    for _ in range(10 if TRIES_ALL else 1):
        assert goes_on_from(log, system, world.step, 60 if TRIES_ALL or name in RESTORED else 30) is None
    log.stop()


@pytest.mark.parametrize("name", studies.names())
def test_its_title_says_how_large_it_is(name: str) -> None:
    assert re.search(r": .*\b\d+(\.\d+)? (nm|mm|cm|m)\b", built(name).title)


@pytest.mark.parametrize("name", studies.names())
def test_it_leaves_the_page_its_keys(name: str) -> None:
    """But for l, which changes between looks, where there are none, and r where it does the same."""
    taken = {action.key for action in built(name)._state.actions if action.key in PAGE_KEYS}
    assert taken <= ({"molecule": {"r"}, "cradle": {"l"}, "cradle-contact": {"l"}, "lab": {"l"}}.get(name) or set())


# But for the one whose nail is the middle of the ball.
@pytest.mark.parametrize("name", sorted(set(studies.names()) - {"bucky"}))
def test_every_nail_is_at_something_visible(name: str) -> None:
    world = built(name)
    cages = next(
        (group for group in world.system.groups if group.name == "cages"), ()
    )  # of the museum: its bucky balls
    held = [p for p in world.system.particles if p.is_nailed and p not in cages]
    held += [joint for joint in world.system.constraints if joint.kind == "revolute" and joint.b is None]
    for thing in held:
        near = world.queries.overlap(iota.Sphere(0.03), thing.position)
        assert not set(world.system.obstacles).isdisjoint(near), thing


def test_the_scripts_of_the_thesis_are_less_than_half_as_long_and_their_table_is_up_to_date() -> None:
    tables = runpy.run_path(str(Path(__file__).parents[2] / "tools" / "study_tables.py"))
    lines = tables["line_table"]()
    assert lines in tables["PAGE"].read_text(), "run tools/study_tables.py"
    ours, theirs = re.search(r"those of the thesis.*?(\d+)\D+(\d+)\*\* \|", lines).groups()  # type: ignore[union-attr]
    assert int(ours) < int(theirs) / 2
