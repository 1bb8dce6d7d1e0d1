# SPDX-License-Identifier: Apache-2.0
"""The crowd: what is near the lamp is full, the rest costs what is left, and nothing comes apart."""

from __future__ import annotations

import numpy as np

from iota.studies import crowd


def test_what_is_near_the_lamp_is_full_though_the_budget_is_far_too_small() -> None:
    world = crowd.build(18, 1e-3)
    reduced = 0
    for step in range(300):
        world.step()
        eye = np.array(next(iter(world.levels.viewers())))  # type: ignore[misc]
        for thing in world.levels.things:
            points = np.array([list(p.position) for body in thing.bodies for p in body.particles])
            apart = float(np.linalg.norm(points - eye, axis=1).min())
            if step > 60 and apart < world.levels.reach - 0.3:
                assert thing.level.name == "full" and thing.root.stride == 1
            reduced += thing.index > 0
    assert reduced > 300 * 9, "most are reduced"
    assert world.system.validate() == []
    energy = world.system.energy  # which level a figure has depends on the clock; some changes make 1.5e-6 J
    assert energy.made < 1e-9 * energy.potential


def test_nothing_comes_apart_at_any_level() -> None:
    world = crowd.build(12, 0.1)
    chains = [thing.root for thing in world.levels.things if not thing.root.solids and len(thing.bodies) == crowd.LINKS]
    names, widest = set(), 0.0
    for _ in range(300):
        report = world.step()
        assert report is not None and report.worst_gap < 1e-3
        names |= set(world.levels.counts())
        for root in chains:  # its first two particles are a link, stiff or not
            upper, lower = root.particles[:2]
            widest = max(widest, abs(abs(lower.position - upper.position) - crowd.LINK))
    assert len(chains) == 4 and widest < 1e-4
    assert {"full", "frozen"} < names


def test_t_takes_the_tint_away() -> None:
    world = crowd.build(3, None)
    root = world.levels.things[0].root
    begin = world.scene.look_of(root)
    world.controls.act("tint")
    paint = world.scene.look_of(root)
    world.controls.act("tint")
    assert paint != begin == world.scene.look_of(root)
