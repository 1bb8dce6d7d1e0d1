# SPDX-License-Identifier: Apache-2.0
"""Closed loops of rigid bodies with pins: each joint is two shared points, each bar a plate."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

import iota
from iota.verify import scenes
from iota.verify.reference import Array
from iota.verify.run import Run

WIDTH = 0.1  # m: half the length of a pin


class Linkage:
    """A planar linkage in space. Each bar is a plate with two points, at z = +-WIDTH, at each of its joints."""

    def __init__(self, system: iota.System, joints: dict[str, Array]) -> None:
        self.system = system
        self.joints = {name: np.array([*xy, 0.0]) for name, xy in joints.items()}
        self.pins: dict[str, list[iota.Particle]] = {}

    def bar(self, *names: str, mass: float = 1.0) -> None:
        body = self.system.body()
        for name in names:
            ends = [
                body.particle(self.joints[name] + np.array([0, 0, z]), mass=mass / (2 * len(names)))
                for z in (-WIDTH, WIDTH)
            ]
            if name in self.pins:
                for old, new in zip(self.pins[name], ends, strict=True):
                    old.combine(new)
            else:
                self.pins[name] = ends

    def nail(self, name: str, place: Array | None = None) -> None:
        for pin, z in zip(self.pins[name], (-WIDTH, WIDTH), strict=True):
            if place is None:
                pin.nail()
            else:
                pin.nail((place[0], place[1], z))

    def place(self, name: str) -> Array:
        return np.asarray(np.mean(scenes.places(self.pins[name]), axis=0)[:2])

    def out_of_plane(self) -> float:
        """Tilt of the pins, m."""
        ends = np.array([scenes.places(pins) for pins in self.pins.values()])
        return float(max(np.abs(ends[:, 0, :2] - ends[:, 1, :2]).max(), np.abs(np.abs(ends[..., 2]) - WIDTH).max()))


def meet(a: Array, ra: float, b: Array, rb: float) -> Array:
    """The intersection of circles about a and b to the left of a -> b."""
    d = float(np.linalg.norm(b - a))
    along = (ra * ra - rb * rb + d * d) / (2 * d)
    across = np.sqrt(max(0.0, ra * ra - along * along))
    e = (b - a) / d
    return np.asarray(a + along * e + across * np.array([-e[1], e[0]]))


def watch(linkage: Linkage, seconds: float, h: float, each: Callable[[int], None]) -> tuple[float, int]:
    """Steps; returns the worst gap (m) and the number of unconverged steps."""
    gap, unconverged = 0.0, 0
    for step in range(1, round(seconds / h) + 1):
        each(step)
        report = linkage.system.step(h)
        gap, unconverged = max(gap, report.worst_gap), unconverged + report.unconverged
    return gap, unconverged


def four_bar(run: Run) -> None:
    """Four-bar linkage.

    A crank, a coupler plate and a rocker that turn freely, without gravity: a closed loop with many more constraints than
    freedoms. In a minute of turning the hinges stay closed, the coupler's point stays on the geometric curve for the
    crank's angle, and energy is kept.
    """
    crank, coupler, rocker, ground = 0.4, 1.2, 1.0, 1.1
    a, d = np.zeros(2), np.array([ground, 0.0])

    def geometry(angle: float) -> dict[str, Array]:
        b = a + crank * np.array([np.cos(angle), np.sin(angle)])
        c = meet(b, coupler, d, rocker)
        along = (c - b) / coupler
        tip = b + 0.6 * along * coupler + 0.5 * np.array([-along[1], along[0]])
        return {"A": a, "B": b, "C": c, "D": d, "tip": tip}

    system = iota.System(gravity=(0, 0, 0))
    linkage = Linkage(system, geometry(0.6))
    linkage.bar("A", "B", mass=2.0)
    linkage.bar("B", "C", "tip")
    linkage.bar("C", "D")
    linkage.nail("A")
    linkage.nail("D")
    across = np.array([-np.sin(0.6), np.cos(0.6), 0])
    for pin in linkage.pins["B"]:
        pin.velocity = 2.0 * across
    seconds, h = run.size(60.0, 6.0, 600.0), 1 / 240
    system.step(h)
    start = system.energy.total
    off, turned, last, path = 0.0, 0.0, 0.6, []
    drift = 0.0

    def each(step: int) -> None:
        nonlocal off, turned, last, drift
        b = linkage.place("B")
        angle = float(np.arctan2(b[1], b[0]))
        turned += (angle - last + np.pi) % (2 * np.pi) - np.pi
        last = angle
        truth = geometry(angle)
        off = max(off, *(float(np.linalg.norm(linkage.place(n) - truth[n])) for n in ("C", "tip")))
        drift = max(drift, abs(system.energy.total / start - 1))
        path.append(linkage.place("tip"))
        if step % 500 == 0:
            run.progress(step * h / seconds)

    gap, unconverged = watch(linkage, seconds, h, each)
    run.note("turns of the crank", abs(turned) / (2 * np.pi))
    run.at_least("turns of the crank", abs(turned) / (2 * np.pi), run.size(20, 2))
    run.at_most("worst gap, m", gap, 1e-9)
    run.at_most("farthest a joint or the coupler's point is from geometry, m", off, 1e-8)
    run.at_most("farthest out of the plane, m", linkage.out_of_plane(), 1e-8)
    run.at_most("energy, relative deviation", drift, run.size(2e-8, 2e-8, 1e-7))
    run.at_most("steps without a solution", unconverged, 0)

    def draw(figure: Any) -> None:
        axes = figure.subplots()
        axes.plot(*np.array(path[:2000]).T, lw=1, label="the coupler's point")
        now = geometry(0.6)
        axes.plot(*np.array([now[n] for n in ("A", "B", "tip", "C", "B", "C", "D")]).T, "o-", color="k", lw=1, ms=3)
        axes.set(xlabel="x, m", ylabel="y, m", aspect="equal")
        axes.legend(fontsize=7)

    run.picture("four-bar", "The four-bar linkage and the path of its coupler's point.", draw, size=(4.6, 3.6))


# Theo Jansen's "holy numbers", in units of the drawing.
JANSEN = {name: 0.02 * value for name, value in zip(
    "abcdefghijklm", (38.0, 41.5, 39.3, 40.1, 55.8, 39.4, 36.7, 65.7, 49.0, 50.0, 61.9, 7.8, 15.0), strict=True)}  # fmt: skip


def jansen_geometry(angle: float) -> dict[str, Array]:
    """Every joint of the leg for the crank's angle, by intersections of circles."""
    s = JANSEN
    crank, pivot = np.zeros(2), np.array([-s["a"], -s["l"]])
    tip = crank + s["m"] * np.array([np.cos(angle), np.sin(angle)])
    upper = meet(pivot, s["b"], tip, s["j"])
    lower = meet(tip, s["k"], pivot, s["c"])
    back = meet(pivot, s["d"], upper, s["e"])
    knee = meet(lower, s["g"], back, s["f"])
    foot = meet(lower, s["i"], knee, s["h"])
    return {
        "crank": crank,
        "pivot": pivot,
        "tip": tip,
        "upper": upper,
        "lower": lower,
        "back": back,
        "knee": knee,
        "foot": foot,
    }


def jansen(run: Run) -> None:
    """Jansen's linkage.

    One leg of a strandbeest: seven bodies, three closed loops, pinned in space (twice redundant at every joint), its
    crank driven at one turn a second. The gap stays at the solver's tolerance, every joint at its geometric place, and
    the path of the foot repeats in each turn. (In public engines it drifts apart within seconds:
    JuliaRobotics/RigidBodyDynamics.jl, issue 480.)
    """
    system = iota.System()
    linkage = Linkage(system, jansen_geometry(0.0))
    for bar in (
        ("tip", "upper"),
        ("tip", "lower"),
        ("pivot", "upper", "back"),
        ("pivot", "lower"),
        ("back", "knee"),
        ("lower", "knee", "foot"),
    ):
        linkage.bar(*bar)
    linkage.bar("crank", "tip")
    linkage.nail("pivot")
    linkage.nail("crank")
    linkage.nail("tip")
    seconds, h = run.size(60.0, 4.0, 600.0), 1 / 120
    off, path = 0.0, []

    def each(step: int) -> None:
        nonlocal off
        if step > 1:
            truth = jansen_geometry(2 * np.pi * (step - 1) * h)
            off = max(
                off, *(float(np.linalg.norm(linkage.place(n) - truth[n])) for n in ("upper", "back", "knee", "foot"))
            )
            path.append(linkage.place("foot"))
        linkage.nail("tip", jansen_geometry(2 * np.pi * step * h)["tip"])
        if step % 100 == 0:
            run.progress(step * h / seconds)

    gap, unconverged = watch(linkage, seconds, h, each)
    turn = round(1 / h)
    laps = np.array(path[: len(path) // turn * turn]).reshape(-1, turn, 2)
    run.note("turns of the crank", len(laps))
    run.at_most("worst gap, m", gap, 1e-9)
    run.at_most("farthest a joint is from geometry, m", off, 1e-7)
    run.at_most("the foot's path, largest deviation from its first turn, m", float(np.abs(laps - laps[0]).max()), 1e-7)
    run.at_most("farthest out of the plane, m", linkage.out_of_plane(), 1e-7)
    run.at_most("steps without a solution", unconverged, 0)

    def draw(figure: Any) -> None:
        axes = figure.subplots()
        for angle, color in ((0.0, "k"), (2.1, "0.6"), (4.2, "0.8")):
            at = jansen_geometry(angle)
            for bar in ("crank tip upper back pivot upper", "tip lower pivot", "back knee lower foot knee"):
                axes.plot(*np.array([at[n] for n in bar.split()]).T, "o-", ms=2, lw=1, color=color)
        axes.plot(*laps[0].T, lw=1.5, color="C0", label="path of the foot")
        axes.set(xlabel="x, m", ylabel="y, m", aspect="equal")
        axes.legend(fontsize=7)

    run.picture("jansen", "Jansen's leg at three angles of its crank, and the path of its foot.", draw, size=(4.6, 4.2))
