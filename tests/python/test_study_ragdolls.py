# SPDX-License-Identifier: Apache-2.0
"""The ragdolls: they fall into a heap that comes to rest, knees bend one way, limbs come off and go on again."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np
import pytest

import iota
from iota.frames import axes_of
from iota.studies import ragdolls
from iota.studies._figure import Figure

FALLS = ragdolls.EACH * 12 + 0.8  # s, until all have left their hooks
INNER = {"hand": "arm", "shank": "thigh"}


@dataclass
class Run:
    """All of a story until the heap is at rest, judged from poses. bent: the least and largest angle of each kind of joint, rad."""

    made: ragdolls.Ragdolls
    bent: dict[str, tuple[float, float]] = field(default_factory=dict)
    widest: float = 0.0  # gap of a joint, m


def bend(figure: Figure, name: str) -> float:
    """Of a knee or elbow, about the axis that points to the left of the figure, rad."""
    side, kind = name.split()
    inner, outer = (axes_of(figure.bodies[f"{side} {part}"].orientation) for part in (INNER[kind], kind))
    left, up = -inner[:, 1], outer[:, 0]
    return math.atan2(float(left @ np.cross(inner[:, 0], up)), float(inner[:, 0] @ up))


@pytest.fixture(scope="module")
def run() -> Run:
    world = ragdolls.make_world()
    run = Run(ragdolls.Ragdolls(world))
    while world.system.time < FALLS + 3.9:
        world.step()
        if world.system.step_count % 10:
            continue
        for figure in run.made.figures:
            for side in ("left", "right"):
                for kind in INNER:
                    low, high = run.bent.get(kind, (0.0, 0.0))
                    angle = bend(figure, f"{side} {kind}")
                    run.bent[kind] = min(low, angle), max(high, angle)
        for joint, places in run.made.sockets.items():
            run.widest = max(run.widest, abs(ragdolls.gaps(joint, places[:1])[0]))
    return run


def test_all_fall_and_the_heap_comes_to_rest_between_the_panes(run: Run) -> None:
    bodies = run.made.system.bodies
    assert run.made.hung == [] and len(bodies) == 12 * 11
    assert all(body.kind == "resting" for body in bodies)
    places = np.array([tuple(body.position) for body in bodies])
    assert np.abs(places[:, 0]).max() < ragdolls.WIDE / 2 and places[:, 2].max() < ragdolls.FOOT + ragdolls.FRONT
    assert places[:, 1].min() > 0.04 and places[:, 1].max() < 2.0
    assert np.mean(places[:, 2] > ragdolls.FOOT - 0.5) > 0.5, "most are at the foot of the stairs"
    assert run.made.system.validate() == []


def test_knees_and_elbows_bend_one_way_and_no_joint_opens(run: Run) -> None:
    assert run.bent["shank"][0] > -0.2 and run.bent["shank"][1] > 1.0
    assert run.bent["hand"][1] < 0.2 and run.bent["hand"][0] < -1.0
    assert run.widest < 1e-6


def test_an_explosion_throws_the_heap_up_and_apart(run: Run) -> None:
    made, system = run.made, run.made.system
    chests = [figure.bodies["chest"] for figure in made.figures]

    def spread() -> tuple[float, float]:
        places = np.array([tuple(chest.position) for chest in chests])
        return float(places[:, 1].mean()), float(np.linalg.norm(places - places.mean(axis=0), axis=1).mean())

    before, highest = spread(), (0.0, 0.0)
    made.blow_up()
    for _ in range(60):
        made.world.step()
        highest = max(highest, spread())
    assert highest[0] > before[0] + 0.15 and highest[1] > before[1] + 0.05
    assert system.validate() == []


def hang_one() -> tuple[iota.World, ragdolls.Ragdolls, Figure]:
    world = ragdolls.make_world()
    made = ragdolls.Ragdolls(world, 1)
    made.story.touch()
    world.step()
    return world, made, made.figures[0]


def test_a_limb_comes_off_falls_and_goes_on_again() -> None:
    world, made, figure = hang_one()
    joint, arm = figure.joints["left arm"], figure.bodies["left arm"]

    def apart() -> float:
        return abs(ragdolls.gaps(joint, made.sockets[joint])[0])

    world.controls.act("limb", arm)
    world.advance(120)
    assert apart() > 1.0 and not joint.active, "it lies on the stairs"
    world.controls.act("limb", arm)
    world.advance(240)
    assert joint.active and apart() < 1e-6 and made.mending == {}
    assert len(made.hung) == 1


def test_a_hand_takes_a_figure_off_its_hook_and_carries_it(monkeypatch: pytest.MonkeyPatch) -> None:
    world, made, figure = hang_one()
    chest = figure.bodies["chest"]
    world.advance(30)
    assert made.hung == [figure]
    monkeypatch.setattr(type(world.users), "held", lambda *_: chest)
    goal = chest.position + (0.3, 0.2, 1.2)
    made.system.grip(chest, target=goal, max_acceleration=300 / chest.mass)
    world.advance(180)
    assert made.hung == [] and abs(chest.position - goal) < 0.15


def test_c_hangs_all_up_whole_and_k_says_when_none_is_left() -> None:
    world, made, figure = hang_one()
    start = figure.bodies["head"].position
    world.controls.act("limb", figure.bodies["head"])
    world.controls.act("drop")
    world.advance(120)
    assert made.hung == [] and figure.bodies["head"].position.y < start.y - 0.5
    world.controls.act("hang up")
    world.step()
    assert made.hung == [figure] and figure.joints["head"].active
    assert abs(figure.bodies["head"].position - start) < 1e-3
