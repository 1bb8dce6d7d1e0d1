# SPDX-License-Identifier: Apache-2.0
"""Sleeping bodies against ones that never sleep."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

import iota
from iota.verify.run import Run

Change = Callable[[], object]
HZ, STILL, MOVING = 120, 1.0, 1.0  # steps a second; seconds before and after the change


def _ball(system: iota.System, x: float = 0.0) -> iota.Body:
    return system.body(shape=iota.Sphere(0.1), position=(x, 0, 0), attachments=[(0, 0, 0)])


def _bond_of_time(system: iota.System) -> Change:
    anchor = system.body(kind="static").particle((2, 0, 0))
    system.bond(_ball(system).attachments[0], anchor, f"force = -3*max(t - {STILL}, 0)")
    return lambda: None


def _field_of_time(system: iota.System) -> Change:
    _ball(system)
    system.field(f"fx = 3*max(t - {STILL}, 0)")
    return lambda: None


def _parameter(system: iota.System) -> Change:
    anchor = system.body(kind="static").particle((2, 0, 0))
    bond = system.bond(_ball(system).attachments[0], anchor, "spring", stiffness=30, length=2)
    return lambda: bond.set(length=1.5)


def _slow_motor(system: iota.System) -> Change:
    arm = system.body(shape=iota.Box((1, 0.1, 0.1)), position=(0.5, 0, 0))
    joint = system.revolute(arm, at=(0, 0, 0), axis=(0, 0, 1))

    def start() -> None:
        joint.angle.motor = (0.008, 100)

    return start


def _scripted(system: iota.System) -> Change:
    table = system.body("scripted", shape=iota.Box((0.2, 0.2, 0.2)), position=(-1, 0, 0))
    system.ball(table, _ball(system), at=(-0.5, 0, 0))

    def move() -> None:
        table.position = (-0.7, 0.2, 0)

    return move


def _gravity(system: iota.System) -> Change:
    _ball(system)

    def pull() -> None:
        system.gravity = (1, 0, 0)

    return pull


SCENES: dict[str, Callable[[iota.System], Change]] = {
    "a bond of the time": _bond_of_time,
    "a field of the time": _field_of_time,
    "a bond's parameter": _parameter,
    "a motor slower than rest_speed": _slow_motor,
    "a scripted body": _scripted,
    "gravity": _gravity,
}


def sleep(run: Run) -> None:
    """Sleep.

    Bodies that sleep are not solved, and wake when something begins to act on them. Each scene is at rest for a second, and
    then something changes: it must move as one that never sleeps.
    """
    times = np.arange(round((STILL + MOVING) * HZ)) / HZ
    ways: dict[str, list[np.ndarray]] = {}
    for number, (name, build) in enumerate(SCENES.items()):
        slept = 0
        for rest_after in (0.0, 0.3):
            system = iota.System(gravity=(0, 0, 0))
            system.rest_after, system.rest_speed = rest_after, 0.01
            change = build(system)
            places: list[np.ndarray] = []
            for time in times:
                if time == STILL:
                    slept += sum(body.kind == "resting" for body in system.bodies)
                    change()
                system.step(1 / HZ)
                places.append(np.array(system.positions))
            ways.setdefault(name, []).append(np.array(places))
        awake, asleep = ways[name]
        moved = np.abs(awake[-1] - awake[0]).max()
        run.at_least(f"{name}: bodies that slept before it", slept, 1)
        run.at_most(f"{name}: difference / motion", float(np.abs(awake - asleep).max() / moved), 1e-2)
        run.progress((number + 1) / len(SCENES))

    def draw(figure: Any) -> None:
        axes = figure.subplots()
        for name, (awake, asleep) in ways.items():
            (line,) = axes.plot(times, np.abs(awake - awake[0]).max(axis=(1, 2)), label=name, lw=1)
            axes.plot(times, np.abs(asleep - asleep[0]).max(axis=(1, 2)), "--", color=line.get_color(), lw=2)
        axes.set(xlabel="time, s", ylabel="moved, m", yscale="log", ylim=(1e-5, 2))
        axes.legend(fontsize=7)

    run.picture("sleep", "Motion without sleep (thin) and with it (dashed).", draw, size=(5, 3.4))
