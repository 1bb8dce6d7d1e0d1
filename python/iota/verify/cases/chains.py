# SPDX-License-Identifier: Apache-2.0
"""The thesis' own verification (section 4.3.6, Figures 4.15 to 4.17): a chain of six links, 50 m long."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

import iota
from iota.verify import scenes
from iota.verify.reference import Array, PlanarChain, StepByFsolve
from iota.verify.run import Run

LINKS, LENGTH = 6, 50.0
LENGTHS = np.full(LINKS, LENGTH / LINKS)
THESIS = 3.5e-4  # m: the largest mean displacement of Figure 4.16, of a chain 50 long


def lissajous(run: Run) -> None:
    """Lissajous nail (Fig. 4.15).

    The top nail of a hanging six-link chain of length 50 m is led along a Lissajous figure, 1/60 s a step. Position for
    position against the same step equations solved by MINPACK's hybrid method (fsolve), and against the equations of
    motion in angles, integrated to 1e-13: halving the step quarters that error (second order).
    """
    seconds = run.size(40.0, 8.0)

    def path(t: float) -> tuple[Array, Array, Array]:
        """Starts at rest: the rate of the phase s(t) rises smoothly to that of time."""
        ease = np.exp(-t)
        s, ds, dds = t - 1 + ease, 1 - ease, ease
        size, rate = np.array([8.0, 5.0]), np.array([0.4, 0.6])
        value, first, second = (
            size * np.sin(rate * s),
            size * rate * np.cos(rate * s),
            -size * rate**2 * np.sin(rate * s),
        )
        return value, first * ds, second * ds**2 + first * dds

    def drive(h: float, fsolve: bool) -> tuple[Array, Array, int]:
        """Places of the rings below the nail after each step, by iota and by fsolve."""
        points = scenes.hanging_points((0, 0), LENGTHS, np.zeros(LINKS))
        system = iota.System()
        rings = scenes.string_of_links(system, points)
        twin = StepByFsolve(LENGTHS, scenes.masses_of(LINKS), points[1:], np.zeros((LINKS, 3)))
        ours, theirs = [], []
        nail = points[0]
        for step in range(1, round(seconds / h) + 1):
            target = np.array([*path(step * h)[0], 0.0])
            rings[0].nail(target)
            system.step(h)
            ours.append(scenes.places(rings[1:]))
            if fsolve:
                twin.step(h, nail, target)
                theirs.append(twin.position)
                run.progress(step * h / seconds / 2)
            nail = target
        return np.array(ours), np.array(theirs), twin.failures

    h = 1 / 60
    ours, theirs, failures = drive(h, True)
    apart = np.linalg.norm(ours - theirs, axis=-1)
    run.note("steps", len(ours))
    run.at_most("largest distance of any ring from fsolve's, m", float(apart.max()), 1e-6)
    run.at_most("steps that fsolve could not solve", failures, 0)

    times = np.arange(len(ours) + 1) * h
    truth = PlanarChain(LENGTHS, scenes.masses_of(LINKS), path).places(times, np.zeros(LINKS), np.zeros(LINKS))[1:]
    error = float(np.abs(ours[..., :2] - truth).max())
    finer = drive(h / 2, False)[0][1::2]
    finer_error = float(np.abs(finer[..., :2] - truth).max())
    run.note("largest error against the ODE at 1/60 s, m", error)
    run.near("order of convergence, 1/60 to 1/120 s", float(np.log2(error / finer_error)), 2.0, 0.15)

    def draw(figure: Any) -> None:
        left, right = figure.subplots(1, 2, width_ratios=[1, 1])
        nails = np.array([path(t)[0] for t in times])
        left.plot(*nails.T, color="C1", label="nail")
        left.plot(ours[:, -1, 0], ours[:, -1, 1], color="C0", label="end, iota")
        left.plot(theirs[::12, -1, 0], theirs[::12, -1, 1], ".", color="k", ms=2.5, label="end, fsolve")
        left.set(xlabel="x, m", ylabel="y, m", aspect="equal")
        left.legend(loc="center left", fontsize=7)
        right.semilogy(times[1:], np.maximum(apart.max(axis=1), 1e-16))
        right.set(xlabel="time, s", ylabel="farthest from fsolve, m")

    run.picture("lissajous", "The nail's path, the end of the chain, and its distance from fsolve's.", draw)


def falling(h: float, steps: int, damping: float, seed: int, tick: Callable[[int], None]) -> tuple[Array, Array, int]:
    """(steps, 3) places of the end of a chain released about level, by iota and by fsolve; and fsolve's failures."""
    angles = np.pi / 2 + np.random.default_rng(seed).uniform(-0.02, 0.02, LINKS)
    points = scenes.hanging_points((0, 0), LENGTHS, angles)
    system = iota.System(damping=damping)
    rings = scenes.string_of_links(system, points)
    twin = StepByFsolve(LENGTHS, scenes.masses_of(LINKS), points[1:], np.zeros((LINKS, 3)), damping=damping)
    ours, theirs = np.empty((steps, 3)), np.empty((steps, 3))
    for step in range(steps):
        system.step(h)
        twin.step(h, points[0], points[0])
        ours[step], theirs[step] = scenes.place(rings[-1]), twin.position[-1]
        tick(step)
    return ours, theirs, twin.failures


def falling_chain(run: Run) -> None:
    """Falling chain (Fig. 4.16).

    Six links, 50 m, nailed at one end and released within a degree of level, 1/30 s a step, damped at 0.1/s so that it
    comes to rest in the 2 500 steps. Distance of its end from the solution of the same step equations by fsolve,
    averaged over 20 runs. The thesis reached 3.5e-4.
    """
    runs, steps, h = run.size(20, 2), run.size(2500, 300), 1 / 30
    apart, failures = np.zeros(steps), 0

    def tick(seed: int, step: int) -> None:
        run.progress((seed + step / steps) / runs)

    for seed in range(runs):
        ours, theirs, failed = falling(h, steps, 0.1, seed, partial(tick, seed))
        apart += np.linalg.norm(ours - theirs, axis=1) / runs
        failures += failed
    run.note("runs x steps", f"{runs} x {steps}")
    run.at_most("largest mean displacement of the end, m (thesis: 3.5e-4)", float(apart.max()), THESIS / 10)
    run.at_most("steps that fsolve could not solve", failures, 0)

    def draw(figure: Any) -> None:
        axes = figure.subplots()
        axes.semilogy(np.arange(1, steps + 1), np.maximum(apart, 1e-16))
        axes.axhline(THESIS, color="C1", lw=1, ls="--")
        axes.annotate("largest in the thesis", (steps, THESIS), ha="right", va="bottom", color="C1", fontsize=8)
        axes.set(xlabel="step", ylabel="mean displacement of the end, m", ylim=(1e-16, 1e-2))

    run.picture("falling-chain", f"Displacement of the chain's end from fsolve's, mean of {runs} runs.", draw)


def divergence(run: Run) -> None:
    """Divergence of chaotic runs (Fig. 4.17).

    The falling chain without damping. Two solvers that agree to 1e-14 in the first steps diverge at the rate at which
    neighboring states of the chain diverge, which is not an error of either. Required is that they agree at first, that
    they diverge later (otherwise the scene is not chaotic), and that the diverged run still keeps its energy.
    """
    steps, h = run.size(2500, 900), 1 / 30
    ours, theirs, _ = falling(h, steps, 0.0, 0, lambda step: run.progress(step / steps))
    apart = np.linalg.norm(ours - theirs, axis=1)
    early = apart[:60]
    run.at_most("apart after 2 s, m", float(early.max()), 1e-9)
    run.at_least("apart in the end, m", float(apart.max()), run.size(10.0, 1e-6))
    first = int(np.argmax(apart > 1e-10)), int(np.argmax(apart > run.size(1e-2, 1e-6)))
    rate = np.log(apart[first[1]] / apart[first[0]]) / ((first[1] - first[0]) * h)
    run.note("rate at which they part, 1/s", float(rate))

    def draw(figure: Any) -> None:
        left, right = figure.subplots(1, 2, width_ratios=[1.5, 1])
        time = np.arange(1, steps + 1) * h
        left.plot(time, ours[:, 1], label="iota")
        left.plot(time, theirs[:, 1], label="fsolve", lw=1)
        left.set(xlabel="time, s", ylabel="height of the end, m")
        left.legend(fontsize=7)
        right.semilogy(time, np.maximum(apart, 1e-16))
        right.set(xlabel="time, s", ylabel="apart, m")

    run.picture("divergence", "The end of an undamped chain by two solvers of the same equations.", draw)
