# SPDX-License-Identifier: Apache-2.0
"""Impacts of balls: bouncing, a cradle, and a crystal that collapses."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

import iota
from iota.verify.reference import GRAVITY as G
from iota.verify.reference import Array
from iota.verify.run import Run


def impacts(run: Run) -> None:
    """Impacts.

    A ball with restitution 1 comes back to its height, bounce after bounce: the tops of its parabolas, by three places each. In a
    cradle of five balls on hinges as many leave as arrive; after ten swings the energy is that of the balls' heights and speeds.
    SimBenchmark's 666: balls in a cubic crystal without friction fall and collapse; the largest overlap by the distances of all
    pairs.
    """
    _bounces(run)
    _cradle(run)
    run.progress(0.5)
    _crystal(run)


def _bounces(run: Run) -> None:
    radius, height, count = 0.02, 0.05, run.size(1000, 100)
    for dt in (1 / 120, 1 / 240):
        system = iota.System()
        system.usual_material = iota.Material(restitution=1)
        system.obstacle(iota.HalfSpace((0, 1, 0)), material=system.usual_material)
        ball = system.body(shape=iota.Sphere(radius), position=(0, radius + height, 0))
        heights = [height]
        tops: list[float] = []
        while len(tops) < count:
            assert system.step(dt).unconverged == 0
            heights.append(ball.center_of_mass.y - radius)
            a, b, c = heights[-3:] if len(heights) > 2 else (0.0, 0.0, 0.0)
            if a <= b > c and len(heights) > 4:
                bend, slope = (a - 2 * b + c) / 2, (c - a) / 2
                tops.append(b - slope**2 / (4 * bend))
        name = f"{count} bounces at 1/{1 / dt:.0f} s"
        run.at_most(f"{name}: lowest top below the height of the fall, of it", 1 - min(tops) / height, 1e-5)
        run.at_most(f"{name}: highest top above it, of it", max(tops) / height - 1, 1e-9)


def _cradle(run: Run) -> None:
    radius, length, lift, dt, count = 0.02, 0.2, math.radians(20), 1 / 240, 5
    tracks: dict[int, Array] = {}
    for lifted in (1, 2, 3):
        system = iota.System()
        system.usual_material = iota.Material(friction=0, restitution=1)
        frame = system.body("static", shape=iota.Box((0.01, 0.01, 0.01)), position=(0, 1, 0))
        balls, tops = [], []
        for number in range(count):
            top = iota.Vec3(2 * radius * (number - (count - 1) / 2), 0, 0)
            angle = -lift if number < lifted else 0.0
            ball = system.body(
                shape=iota.Sphere(radius),
                position=top + (length * math.sin(angle), -length * math.cos(angle), 0),
                orientation=("z", math.degrees(angle)),
            )
            system.revolute(ball, frame, at=top, axis=(0, 0, 1))
            balls.append(ball)
            tops.append(top)
        period = 2 * math.pi * math.sqrt((length**2 + 0.4 * radius**2) / (G * length)) * (1 + lift**2 / 16)
        angles = []
        for _ in range(round(run.size(10, 2) * period / dt)):
            assert system.step(dt).unconverged == 0
            angles.append(
                [
                    math.atan2(ball.position.x - top.x, top.y - ball.position.y)
                    for ball, top in zip(balls, tops, strict=True)
                ]
            )
        track = tracks[lifted] = np.array(angles)
        half = round(period / 2 / dt)
        wanted = np.where(np.arange(count) >= count - lifted, lift, 0)
        off = float(np.degrees(np.abs(track[half - 1] - wanted).max()))
        run.at_most(f"cradle, {lifted} of {count} arrive: error of the angles after half a swing, degrees", off, 0.01)
        # Pendulums of one length: their energies go with the squares of speeds and 1 - cos.
        speeds = np.diff(track, axis=0) / dt
        middle = (track[1:] + track[:-1]) / 2
        share = (length**2 + 0.4 * radius**2) * speeds**2 / 2 + G * length * (1 - np.cos(middle))
        energy = share.sum(1) / (lifted * G * length * (1 - math.cos(lift)))
        run.note(f"energy after {run.size(10, 2)} swings, of that at the start", float(energy[-1]))
        run.at_most("energy: largest gain, of it", float(energy.max()) - 1, 1e-3)
        run.at_least("energy at the end, of it", float(energy[-1]), 0.99)

    def draw(figure: Any) -> None:
        axes = figure.subplots()
        shown = tracks[2][: round(3 / dt)]
        for number in range(count):
            axes.plot(dt * np.arange(len(shown)), np.degrees(shown[:, number]), lw=1)
        axes.set(xlabel="time, s", ylabel="angle, degrees")

    run.picture("impacts", "A cradle of five balls, of which two are lifted.", draw, size=(6, 2.8))


def _crystal(run: Run) -> None:
    edge, radius, dt = run.size(6, 3), 0.05, 1 / 120
    system = iota.System()
    system.budget_contacts = 0  # all exact
    system.usual_material = iota.Material(friction=0)
    system.obstacle(iota.HalfSpace((0, 1, 0)), material=system.usual_material)
    spacing = 2.04 * radius
    grid = [
        (spacing * i, radius + spacing * j, spacing * k) for i in range(edge) for j in range(edge) for k in range(edge)
    ]
    balls = [system.body(shape=iota.Sphere(radius), position=at) for at in grid]
    worst = 0.0
    for _ in range(round(run.size(0.6, 0.5) / dt)):
        assert system.step(dt).unconverged == 0
        places = np.array([ball.center_of_mass for ball in balls])
        apart = np.linalg.norm(places[:, None] - places[None], axis=2) + 10 * radius * np.eye(len(places))
        worst = max(worst, (2 * radius - apart.min()) / radius, (radius - places[:, 1].min()) / radius)
    run.at_most(f"crystal of {edge} x {edge} x {edge} balls: largest overlap, of a radius", worst, 1e-8)
