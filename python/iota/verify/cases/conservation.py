# SPDX-License-Identifier: Apache-2.0
"""Conserved quantities: momentum, angular momentum, energy, and the length of a link under any load."""

from __future__ import annotations

from typing import Any

import numpy as np

import iota
from iota.verify import scenes
from iota.verify.reference import GRAVITY, Array
from iota.verify.run import Run


def flying_mixture() -> iota.System:
    """Chains, a plate, a general body, loops and stiff springs between them, tumbling freely without gravity."""
    system = iota.System(gravity=(0, 0, 0))
    dice = np.random.default_rng(5)
    hub = scenes.rigid_body(
        system,
        dice.uniform(-0.3, 0.3, (6, 3)),
        dice.uniform(0.2, 3, 6),
        velocity=(0.3, 0.1, -0.2),
        spin=(1.0, 2.0, -1.5),
    )
    tips = []
    for arm in range(4):
        end = hub[arm]
        for _ in range(5):
            link = system.body()
            here = np.asarray(end.position)
            upper = link.particle(here, mass=0.1, velocity=end.velocity)
            there = here + dice.uniform(-0.2, 0.2, 3)
            lower = link.particle(there, mass=dice.uniform(0.05, 1), velocity=dice.uniform(-1, 1, 3))
            end.combine(upper)
            end = lower
        tips.append(end)
    plate = scenes.rigid_body(
        system,
        np.vstack([scenes.places(tips[:3]), dice.uniform(-0.5, 0.5, (1, 3))]),
        [0.3, 0.4, 0.5, 0.2],
        spin=(0, 1, 0),
    )
    for tip, corner in zip(tips[:3], plate[:3], strict=True):
        tip.combine(corner)  # closes two loops
    for p, q, stiffness in ((hub[4], plate[3], 1e4), (tips[3], hub[5], 50.0), (tips[3], plate[0], 1e6)):
        system.bond(p, q, "spring", stiffness=stiffness, damping=0)
    lone = system.body().particle((0.8, 0.1, 0), mass=0.7, velocity=(0, 0.5, 0))
    system.bond(lone, tips[3], "spring", stiffness=20.0, damping=0)
    return system


def momenta(run: Run) -> None:
    """Momentum and angular momentum.

    A tumbling mixture of chains, plates, a general body, closed loops and springs of 20 to 1e6 N/m, in free flight in
    energy-keeping mode at 1/240 s: momentum, angular momentum and energy, relative to the sums of the magnitudes.
    """
    system = flying_mixture()
    system.step(1 / 240)
    masses = np.array([p.mass for p in system.particles])
    steps = run.size(24_000, 1500, 240_000)

    def sizes() -> tuple[float, float]:
        v, x = system.velocities, system.positions
        return (
            float(masses @ np.linalg.norm(v, axis=1)),
            float(masses @ (np.linalg.norm(v, axis=1) * np.linalg.norm(x - x.mean(axis=0), axis=1))),
        )

    size, spin_size = sizes()
    momentum, spin = np.asarray(system.momentum), np.asarray(system.angular_momentum)
    energy = system.energy.total
    lost, twisted, drift, fallbacks = [], [], [], 0
    for step in range(steps):
        report = system.step(1 / 240)
        lost.append(float(np.linalg.norm(np.asarray(system.momentum) - momentum)) / size)
        twisted.append(float(np.linalg.norm(np.asarray(system.angular_momentum) - spin)) / spin_size)
        drift.append(abs(report.energy.total - energy) / energy)
        fallbacks += report.fallbacks
        if step % 500 == 0:
            run.progress(step / steps)
    run.note("steps", steps)
    run.at_most("momentum, relative deviation", max(lost), 1e-12)
    # In the long run the mixture moves 300 m away, where places have a hundred times lower precision.
    run.at_most("angular momentum, relative deviation", max(twisted), run.size(1e-12, 1e-12, 1e-9))
    run.at_most("energy, relative deviation", max(drift), run.size(1e-8, 1e-8, 1e-7))
    run.at_most("steps handed to the robust scheme", fallbacks, 0)

    def draw(figure: Any) -> None:
        axes = figure.subplots()
        time = np.arange(1, steps + 1) / 240
        for values, label in ((drift, "energy"), (twisted, "angular momentum"), (lost, "momentum")):
            axes.semilogy(
                time[:: max(1, steps // 800)], np.maximum(values, 1e-18)[:: max(1, steps // 800)], lw=1, label=label
            )
        axes.set(xlabel="time, s", ylabel="relative deviation")
        axes.legend(fontsize=7)

    run.picture("momenta", "A tumbling mixture of soft and rigid: what is kept.", draw, size=(6, 3.2))


def swing(
    mode: str, links: int, degrees: float, h: float, steps: int, run: Run, share: tuple[float, float]
) -> tuple[Array, float, int, int]:
    """Total energy above rest after each step (J), at the start, fall-backs and unconverged steps, of a swinging chain."""
    angle = np.radians(degrees)
    system = iota.System(mode=mode)  # type: ignore[arg-type]
    scenes.string_of_links(system, scenes.hanging_points((0, 0), [0.1] * links, [angle] * links), link_mass=0.1)
    height = -GRAVITY * float(scenes.masses_of(links, 0.1) @ (0.1 * np.arange(1, links + 1)))  # hanging straight down
    start = system.energy.total - height
    above, fallbacks, unconverged = np.empty(steps), 0, 0
    for step in range(steps):
        report = system.step(h)
        above[step] = report.energy.total - height
        fallbacks += report.fallbacks
        unconverged += report.unconverged
        if step % 1000 == 0:
            run.progress(share[0] + share[1] * step / steps)
    return above, start, fallbacks, unconverged


def energy(run: Run) -> None:
    """Energy of a swinging chain.

    64 links, released 10 degrees from straight down, undamped, 1/240 s. Energy-keeping mode may drift by at most a
    millionth of the initial energy above rest in 100 000 steps (7 minutes), without any fall-back. Robust mode loses
    energy and never gains any.
    """
    steps = run.size(100_000, 1500, 1_000_000)
    kept, start, fallbacks, unconverged = swing("energy_keeping", 64, 10, 1 / 240, steps, run, (0, 0.8))
    run.note("energy above rest at the start, J", start)
    run.note("steps", steps)
    run.at_most("energy-keeping: largest drift / energy above rest", float(np.abs(kept / start - 1).max()), 1e-6)
    run.at_most("energy-keeping: fall-backs", fallbacks, 0)
    run.at_most("energy-keeping: steps without a solution", unconverged, 0)
    # Each rise from one step to the next counts, also below the initial energy.
    for degrees in (10, 90, 170):
        lost, first, _, _ = swing(
            "robust", 64, degrees, 1 / 240, run.size(5000, 600), run, (0.8 + degrees / 1000, 0.05)
        )
        rises = float(np.diff(np.concatenate([[first], lost])).max())
        run.at_most(f"robust, from {degrees}°: largest rise in a step / energy above rest", rises / first, 1e-9)
        if degrees == 10:
            small = lost

    def draw(figure: Any) -> None:
        left, right = figure.subplots(1, 2)
        every = max(1, steps // 1000)
        left.plot(np.arange(1, steps + 1)[::every], (kept / start - 1)[::every], lw=0.8)
        left.set(xlabel="step", ylabel="drift / energy above rest", title="energy-keeping")
        right.plot(
            np.arange(1, len(small) + 1)[:: max(1, len(small) // 500)],
            (small / start)[:: max(1, len(small) // 500)],
            lw=1,
            color="C1",
        )
        right.set(xlabel="step", ylabel="energy / that at the start", title="robust", ylim=(0, 1.02))

    run.picture("energy", "Energy above rest of 64 links swinging from 10 degrees.", draw, size=(7, 3.0))


def heavy_end(run: Run) -> None:
    """Mass ratio of a million.

    100 links, the last a million times as heavy as the others, released level, 1/60 s: no step fails, no link is longer
    than a millionth of itself, and kinetic energy never exceeds the energy released by gravity.
    """
    for mode, allowed in (("robust", 1e-9), ("energy_keeping", 1e-6)):  # energy-keeping: within its drift
        system = iota.System(mode=mode)  # type: ignore[arg-type]
        links, length = 100, 0.1
        rings = scenes.string_of_links(system, scenes.level_points((0, 0), links, length), link_mass=0.1)
        last = rings[-1].body
        for particle in last.particles:
            particle.mass = 0.5 * 0.1 * 1e6
        start = system.energy
        steps, gap, unconverged, excess, kinetic = run.size(1200, 240, 36_000), 0.0, 0, 0.0, 0.0
        for step in range(steps):
            report = system.step(1 / 60)
            gap = max(gap, report.worst_gap / length)
            unconverged += report.unconverged
            kinetic = max(kinetic, report.energy.kinetic)
            released = start.potential - report.energy.potential
            excess = max(excess, (report.energy.kinetic - released) / kinetic)
            run.progress(step / steps)
        run.at_most(f"{mode}: worst gap / link", gap, 1e-6)
        run.at_most(f"{mode}: steps without a solution", unconverged, 0)
        run.at_most(f"{mode}: kinetic energy beyond what gravity released / largest kinetic", excess, allowed)
        run.at_least(
            f"{mode}: largest kinetic energy / what the fall can release",
            kinetic / (0.1e6 * GRAVITY * links * length),
            0.5,
        )
