# SPDX-License-Identifier: Apache-2.0
"""Random changes of random things that sleep: they move as those that never slept. Judged by places alone.

IOTA_SLEEP_SCENES: how many scenes of each kind; `make soak` plays ten thousand.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import pytest
from amount import TRIES_ALL
from test_sleep import CASES, Things, free_bodies

import iota

SCENES = int(os.environ.get("IOTA_SLEEP_SCENES", "400" if TRIES_ALL else "40"))
AT_ONCE = 20  # scenes in a test
REST_AFTER, REST_SPEED = 0.2, 0.01
MODES = ("plausible", "robust", "energy_keeping", "accurate")

Place = np.ndarray[Any, np.dtype[np.float64]]


def is_still(name: str) -> bool:
    """Whether a case is at rest without gravity, and its change is no matter of chance for others: a pair force between points that
    are at one place, velocities of bodies that have none of their own."""
    system = iota.System(gravity=(0, 0, 0))
    CASES[name][0](system)
    return (
        tuple(system.gravity) == (0, 0, 0) and name not in {"a pair force", "velocities of all"} and "undo" not in name
    )


STILL = [name for name in CASES if is_still(name)]


@dataclass
class Played:
    """The places of a scene: of each thing those of its points, before the changes and at the end (None: it is gone)."""

    what: str
    kinds: set[str]
    before: list[list[Place]]
    after: list[list[Place | None]]


def off_and_moved(one: Played, twin: Played, thing: int) -> tuple[float, float]:
    """How far a thing of one is from that of its twin, and how far the twin moved, m."""
    off = moved = 0.0
    for a, b, start in zip(one.after[thing], twin.after[thing], twin.before[thing], strict=True):
        if a is not None and b is not None:
            off, moved = max(off, float(np.abs(a - b).max())), max(moved, float(np.abs(b - start).max()))
    return off, moved


def play_cases(seed: int, rest_after: float) -> Played:
    """One to four cases of the list in one system, changed one after the other; some systems are restored before."""
    dice = np.random.default_rng(seed)
    system = iota.System(gravity=(0, 0, 0), damping=0.2, mode=str(dice.choice(MODES)))
    system.rest_after, system.rest_speed = rest_after, REST_SPEED
    step = float(dice.choice([1 / 60, 1 / 120, 1 / 240]))
    names = [str(name) for name in dice.choice(STILL, size=dice.integers(1, 5), replace=False)]
    times, is_restored = dice.uniform(0.667, 0.85, len(names)), dice.random() < 0.3
    things: list[Things] = []
    points: list[list[iota.Particle]] = []
    for name in names:
        first = len(system.particles)
        things.append(CASES[name][0](system))
        points.append(list(system.particles[first:]))
    while system.time < 0.66:
        system.step(step)
    kinds = {body.kind for body in free_bodies(system)}
    if is_restored:
        system.restore(system.snapshot())
    before = [[np.array(p.position) for p in each] for each in points]
    done: set[int] = set()
    while system.time < 1.2:
        for i, name in enumerate(names):
            if system.time >= times[i] and i not in done:
                CASES[name][1](things[i])
                done.add(i)
            if i in done and "slowly" in name:
                table = things[i]["table"]
                table.position = tuple(np.array(table.position) + (0.5 * REST_SPEED * step, 0, 0))
        system.step(step)
    after = [[np.array(p.position) if p.alive else None for p in each] for each in points]
    return Played(f"{system.mode}, {1 / step:.0f} Hz, restored: {is_restored}, {names}", kinds, before, after)


def blocks(count: int) -> list[Any]:
    return [range(first, min(first + AT_ONCE, count)) for first in range(0, count, AT_ONCE)]


@pytest.mark.parametrize("seeds", blocks(5 * SCENES), ids=str)
def test_things_that_sleep_beside_each_other_move_as_those_that_never_slept(seeds: range) -> None:
    for seed in seeds:
        one, twin = play_cases(seed, REST_AFTER), play_cases(seed, 0)
        assert one.kinds == {"resting"}, f"{seed}: {one.what}"
        for thing in range(len(one.after)):
            off, moved = off_and_moved(one, twin, thing)
            assert off <= 0.02 * moved + 2e-6, f"{seed}: {one.what}, thing {thing} is {off:.1e} m off, of {moved:.1e} m"


@dataclass
class Stack:
    """Boxes on a floor of their own."""

    floor: iota.Body
    boxes: list[iota.Body]
    system: iota.System
    dice: np.random.Generator

    @property
    def top(self) -> iota.Body:
        return self.boxes[-1]

    @property
    def lowest(self) -> iota.Body:
        return self.boxes[0]

    def any(self) -> iota.Body:
        return self.boxes[self.dice.integers(len(self.boxes))]

    def beside(self, body: iota.Body, x: float, y: float = 0.0) -> tuple[float, float, float]:
        place = body.position
        return (place.x + x, place.y + y, place.z)

    def throw(self, x: float, y: float, velocity: tuple[float, float, float]) -> None:
        ball = self.system.body(shape=iota.Sphere(0.05), density=7800, position=self.beside(self.top, x, y))
        ball.velocity = velocity

    def slide(self) -> None:
        self.system.gravity = (1, -9.81, 0)

    def anchor(self, x: float, y: float) -> iota.Particle:
        return self.system.body("static").particle(self.beside(self.top, x, y))


def sink(stack: Stack) -> None:
    if stack.floor.kind == "static":
        stack.floor.position = stack.beside(stack.floor, 0, -3)
    else:
        stack.floor.position = stack.beside(stack.floor, 0, -0.02)


def combine(stack: Stack) -> None:
    if len(stack.boxes) > 1:
        stack.lowest.combine(stack.top)
    stack.slide()


def weld(stack: Stack) -> None:
    if len(stack.boxes) > 1:
        stack.system.weld(stack.lowest, stack.top)
    stack.top.apply_force((0, 4000, 0))


def destroy(stack: Stack) -> None:
    if len(stack.boxes) > 1:
        stack.boxes.pop(stack.dice.integers(len(stack.boxes))).destroy()
    else:
        stack.lowest.apply_force((0, 500, 0))


def nail(stack: Stack) -> None:
    stack.top.particles[0].nail()
    stack.slide()


def of_ice(stack: Stack) -> None:
    stack.floor.material = iota.Material(friction=0)
    stack.slide()


def all_of_ice(stack: Stack) -> None:
    stack.system.usual_material = iota.Material(friction=0)
    stack.slide()


CHANGES: dict[str, Callable[[Stack], object]] = {
    "the floor sinks": sink,
    "the floor is destroyed": lambda s: s.floor.destroy(),
    "a floor of ice": of_ice,
    "all of ice": all_of_ice,
    "the floor touches nothing": lambda s: setattr(s.floor, "material", iota.Material(touches="nothing")),
    "the floor is inactive": lambda s: setattr(s.floor, "kind", "inactive"),
    "a box touches nothing": lambda s: setattr(s.any(), "material", iota.Material(touches="nothing")),
    "a box is destroyed": destroy,
    "a box is inactive": lambda s: setattr(s.lowest, "kind", "inactive"),
    "a box is static": lambda s: setattr(s.lowest, "kind", "static"),
    "gravity": lambda s: setattr(s.system, "gravity", (3, -5, 0)),
    "a force": lambda s: s.any().apply_force((s.dice.uniform(-2e4, 2e4), 0, 0)),
    "a velocity": lambda s: setattr(s.top, "velocity", (0.5, 0.5, 0)),
    "a place": lambda s: setattr(s.top, "position", s.beside(s.top, 0, 0.3)),
    "a mass": lambda s: setattr(s.top, "mass", 50),
    "a grip": lambda s: s.system.grip(s.lowest, (0.05, 0, 0), s.beside(s.lowest, 1, 0.5)),
    "the floor is ignored": lambda s: s.system.ignore_contacts(s.floor, s.lowest),
    "a box is ignored": lambda s: s.system.ignore_contacts(s.lowest, s.top if len(s.boxes) > 1 else s.floor),
    "a combine": combine,
    "a weld": weld,
    "a motor": lambda s: s.system.revolute(s.top, at=s.beside(s.top, 0.1), axis=(0, 0, 1), motor=(3, 500)),
    "a wall": lambda s: s.system.obstacle(iota.Box((0.2, 0.2, 0.2)), position=s.beside(s.lowest, 0.15)),
    "a ball from aside": lambda s: s.throw(-0.5, 0, (8, 0, 0)),
    "a ball from above": lambda s: s.throw(0.03, 0.3, (0, -4, 0)),
    "a spring": lambda s: s.system.bond(s.top.particles[0], s.anchor(1, 1), "spring", stiffness=2000, length=0.1),
    "a rope": lambda s: s.system.rope(s.top.particles[0], s.anchor(0, 1), 0.7),
    "a nail": nail,
    "a field": lambda s: s.system.field("fx = 8*m"),
    "a field of the time": lambda s: s.system.field("fx = 20*m*max(t - 1.1, 0)"),
}


@dataclass
class Scene:
    """Stacks on floors, and their changes."""

    system: iota.System
    step: float
    stacks: list[Stack]
    dice: np.random.Generator
    names: list[str] = field(default_factory=list)

    @staticmethod
    def make(seed: int, rest_after: float) -> Scene:
        dice = np.random.default_rng(seed)
        system = iota.System(mode=str(dice.choice(MODES)))
        system.rest_after, system.rest_speed = rest_after, REST_SPEED
        system.budget_contacts = 0  # of a shared one sleepers leave the others more
        system.usual_material = iota.Material(friction=0.6)
        scene = Scene(system, float(dice.choice([1 / 60, 1 / 120, 1 / 240])), [], dice)
        for x in range(0, 2 * int(dice.integers(1, 4)), 2):
            scene.add_stack(float(x))
        return scene

    def add_stack(self, x: float) -> None:
        kind = str(self.dice.choice(["static", "scripted"]))
        floor = self.system.body(kind, shape=iota.Box((1, 0.2, 1)), mass=5, position=(x, -0.1, 0))  # type: ignore[call-overload]
        stack, top = Stack(floor, [], self.system, self.dice), 0.0
        for _ in range(self.dice.integers(1, 5)):
            size = self.dice.permuted([0.15, 0.2, 0.3])
            place = (x + self.dice.uniform(-0.01, 0.01), top + 0.5 * size[1], self.dice.uniform(-0.01, 0.01))
            density = float(self.dice.choice([200, 1000, 5000]))
            stack.boxes.append(self.system.body(shape=iota.Box(tuple(size)), density=density, position=place))
            top += size[1]
        self.stacks.append(stack)

    def change(self) -> None:
        for _ in range(self.dice.integers(1, 4)):
            self.names.append(str(self.dice.choice(list(CHANGES))))
            try:
                CHANGES[self.names[-1]](self.stacks[self.dice.integers(len(self.stacks))])
            except (ValueError, iota.StaleIdError):  # of what an earlier change took away
                self.names[-1] += " (refused)"
            for _ in range(self.dice.integers(6)):
                self.system.step(self.step)


def play_stacks(seed: int, rest_after: float, shake: float = 0.0) -> Played:
    """shake: all boxes are put off their places by so much at most before the changes, m."""
    scene = Scene.make(seed, rest_after)
    system, boxes = scene.system, [box for stack in scene.stacks for box in stack.boxes]
    while system.time < 0.7:
        system.step(scene.step)
    kinds = {box.kind for box in boxes}
    if shake > 0:
        shaker = np.random.default_rng([seed, round(1e12 * shake)])
        for box in boxes:
            box.position = tuple(np.array(box.position) + shake * shaker.uniform(-1, 1, 3) * (1, 0, 1))
    if scene.dice.random() < 0.3:
        system.restore(system.snapshot())
    before = [[np.array(box.position)] for box in boxes]
    scene.change()
    until = system.time + 0.12
    while system.time < until:
        system.step(scene.step)
    after: list[list[Place | None]] = [[np.array(box.position) if box.alive else None] for box in boxes]
    return Played(f"{system.mode}, {1 / scene.step:.0f} Hz, {scene.names}", kinds, before, after)


def worst_off(one: Played, twin: Played) -> tuple[float, float]:
    each = [off_and_moved(one, twin, thing) for thing in range(len(one.after))]
    return max(off for off, _ in each), max(moved for _, moved in each)


@pytest.mark.parametrize("seeds", blocks(SCENES), ids=str)
def test_stacks_that_sleep_move_as_those_that_never_slept(seeds: range) -> None:
    """What a force threw in its first step went through them, and what was pushed out of a wall slept again within it."""
    for seed in seeds:
        one, twin = play_stacks(seed, REST_AFTER), play_stacks(seed, 0)
        assert one.kinds == {"resting"}, f"{seed}: {one.what}"
        off, moved = worst_off(one, twin)
        if off <= 0.02 * moved + 2e-5:
            continue
        # Falling things that tip or hit edges are a matter of chance: then a twin that was shaken a little is as far off.
        by_chance = max(worst_off(play_stacks(seed, 0, shake), twin)[0] for shake in (1e-9, 2e-9, 1e-8, 1e-7, 2e-7))
        assert off <= 3 * by_chance, f"{seed}: {one.what}: {off:.1e} m off, of {moved:.1e} m, {by_chance:.1e} by chance"
