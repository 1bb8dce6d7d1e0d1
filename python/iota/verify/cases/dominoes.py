# SPDX-License-Identifier: Apache-2.0
"""A row of dominoes: the speed of its wave against an integration of those that lean on the ones in front of them."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

import iota
from iota.verify.reference import GRAVITY as G
from iota.verify.reference import Array
from iota.verify.run import Run

HIT = 0.02  # rad, by which one has turned that has been hit
PUSH = 3.0  # rad/s, of the first


def dominoes(run: Run) -> None:
    """Dominoes.

    The first of a row is pushed. Each falls about its edge on the floor against the next one; all that have fallen lean on the one in
    front of them and push it (van Leeuwen 2004). Hits are without rebound, edges slide down the faces with friction. Such a train
    has one freedom, so that its motion and the speed of its wave follow by quadrature. The times of hits in the row of bodies are
    those at which their leans, by orientations, pass 0.02 rad.
    """
    tracks: dict[float, tuple[Array, Array]] = {}
    rows = ((0.01, 0.012), (0.2, 0.012), (0.01, 0.02), (0.2, 0.02), (0.4, 0.02))
    for friction, gap in run.size(rows, rows[3:4]):
        row = Row(gap=gap, friction=friction)
        count, shown = run.size((26, 15), (14, 9))
        known = row.hits(count)
        measured = _hits(row, count, 1 / run.size(2000, 500))
        speeds = [row.pitch / float(np.diff(times[shown:]).mean()) for times in (measured, known)]
        name = f"{1e3 * gap:g} mm apart, friction {friction:g}"
        run.near(f"{name}: speed of the wave, m/s", speeds[0], speeds[1], run.size(0.005, 0.02) * speeds[1])
        late = float(np.abs(measured - known).max() / np.diff(known)[-1])
        run.at_most(f"{name}: error of the times of all hits, of the time between two", late, 0.1)
        if gap == 0.02:
            tracks[friction] = measured, known

    def draw(figure: Any) -> None:
        axes = figure.subplots()
        for friction, (measured, known) in tracks.items():
            pitch = Row(gap=0.02).pitch
            (line,) = axes.plot(np.arange(1, len(known)), pitch / np.diff(known), lw=1, label=f"friction {friction:g}")
            axes.plot(np.arange(1, len(known)), pitch / np.diff(measured), ".", ms=4, color=line.get_color())
        axes.set(xlabel="domino", ylabel="speed, m/s")
        axes.legend(fontsize=7)

    run.picture(
        "dominoes", "The wave finds its speed. Lines: the equations of the train; dots: bodies.", draw, size=(5, 3)
    )


@dataclass
class Row:
    """Equal dominoes. Lengths in m; friction: between two of them."""

    height: float = 0.048
    thickness: float = 0.0075
    gap: float = 0.02
    friction: float = 0.2

    @property
    def pitch(self) -> float:
        return self.gap + self.thickness

    def behind(self, lean: float) -> tuple[float, float, float, float]:
        """The one whose edge lies on the face of one with this lean: its lean, first and second derivatives by it, and the
        ratio of the torques of the force between them, on the one in front and against that on the one behind."""
        c, s = math.cos(lean), math.sin(lean)
        # height sin(its lean - lean) = pitch cos(lean) - thickness
        u = (self.pitch * c - self.thickness) / self.height
        rate, bend = -self.pitch * s / self.height, -self.pitch * c / self.height
        across = math.sqrt(1 - u * u)
        first, second = 1 + rate / across, bend / across + u * rate**2 / across**3
        up = self.height * across - self.pitch * s  # of the edge on the face; it slides down
        ratio = (up - self.friction * self.thickness) / (self.height * (across + self.friction * u))
        return lean + math.asin(u), first, second, ratio

    def train(self, lean: float, count: int) -> Array:
        """(count, 4), from the front: leans, their derivatives by the first one, and weights of their torques."""
        rows = [(lean, 1.0, 0.0, 1.0)]
        while len(rows) < count:
            last, first, second, weight = rows[-1]
            at, by, by_twice, ratio = self.behind(last)
            rows.append((at, by * first, by_twice * first**2 + by * second, weight * ratio))
        return np.array(rows)

    def hits(self, count: int) -> Array:
        """The times at which each has turned by HIT, from the push of the first, s."""
        moment = (self.height**2 + self.thickness**2) / 3

        def rate(_: float, state: Array, falling: int) -> Array:
            lean, first, second, weight = self.train(state[0], falling).T
            torque = G / 2 * (self.height * np.sin(lean) - self.thickness * np.cos(lean))
            force = weight @ (torque - moment * second * state[1] ** 2)
            return np.array([state[1], force / (moment * weight @ first)])

        def passes(angle: float) -> Any:
            def event(_: float, state: Array, __: int) -> float:
                return float(state[0]) - angle

            event.terminal = angle > HIT  # type: ignore[attr-defined]
            return event

        events = [passes(HIT), passes(math.asin(self.gap / self.height))]
        times, spin, now = [], PUSH, 0.0
        for falling in range(1, count + 1):
            found = solve_ivp(
                rate, (0, 1), [0, spin], "DOP853", events=events, args=(falling,), rtol=1e-10, atol=1e-12
            )  # fmt: skip
            times.append(now + float(found.t_events[0][0]))
            now += float(found.t[-1])
            # The next one is hit: an impulse at each place changes all spins to those of the longer train.
            _, first, _, weight = self.train(0.0, falling + 1).T
            before = found.y[1, -1] * self.train(found.y[0, -1], falling)[:, 1]
            spin = float(weight[1:] @ before / (weight @ first))
        return np.array(times)


def _hits(row: Row, count: int, dt: float) -> Array:
    """The same of bodies. On the floor they neither slide nor have another hold."""
    system = iota.System()
    system.usual_material = iota.Material(friction=row.friction)
    system.obstacle(iota.HalfSpace((0, 1, 0)), material=iota.Material(friction=100 / row.friction))
    size = (row.thickness, row.height, 0.024)
    bodies = [
        system.body(shape=iota.Box(size), density=700, position=(row.pitch * k, row.height / 2, 0))
        for k in range(count)
    ]
    bodies[0].angular_velocity = (0, 0, -PUSH)
    bodies[0].velocity = (PUSH * row.height / 2, PUSH * row.thickness / 2, 0)
    times: list[float] = []
    last, step = 0.0, 0
    while len(times) < count:
        report = system.step(dt)
        step += 1
        assert report.unconverged == 0 and step * dt < 5
        _, _, z, w = bodies[len(times)].orientation
        lean = -2 * math.atan2(z, w)
        if lean > HIT:
            times.append(dt * (step - (lean - HIT) / (lean - last)))
            _, _, z, w = bodies[min(len(times), count - 1)].orientation
            lean = -2 * math.atan2(z, w)
        last = lean
    return np.array(times)
