# SPDX-License-Identifier: Apache-2.0
"""Independence of units: sizes, masses, places, and the number of links that share a conflict."""

from __future__ import annotations

from typing import Any

import numpy as np

import iota
from iota.verify import scenes
from iota.verify.reference import GRAVITY, Array
from iota.verify.run import Run


def scaled_scene(mode: str, length: float, mass: float) -> iota.System:
    """Six links, a plate on a joint and a spring between them; lengths and masses times these factors, times as they are."""
    system = iota.System(gravity=(0, -GRAVITY * length, 0), mode=mode)  # type: ignore[arg-type]
    points = length * scenes.hanging_points((0, 0), [0.1] * 6, np.radians([80, 70, 60, 50, 60, 70]))
    rings = scenes.string_of_links(system, points, link_mass=0.1 * mass)
    corners = length * np.array([(0.5, 0, 0), (0.5, -0.2, 0), (0.55, -0.1, 0.05), (0.45, -0.1, 0.03)])
    plate = scenes.rigid_body(system, corners, [0.1 * mass] * 4)
    system.revolute(plate[0].body, None, at=corners[0], axis=(0, 0, 1))
    system.bond(rings[-1], plate[1], "spring", stiffness=40.0 * mass, damping=0.1 * mass, length=0.3 * length)
    return system


def path_of(mode: str, length: float, mass: float, steps: int) -> Array:
    """(steps, particles, 3) in units of the scale."""
    system = scaled_scene(mode, length, mass)
    path = []
    for _ in range(steps):
        system.step(1 / 120)
        path.append(system.positions / length)
    return np.array(path)


def scales(run: Run) -> None:
    """Any unit of length and mass.

    Six links, a plate on a revolute joint and a damped spring between them, 1/120 s. Lengths and masses are multiplied by
    powers of ten, gravity and forces to match, so that the motion must be the same: the largest distance of any particle from
    where it is in the unscaled scene, in units of the scale (a link is 0.1 long).
    """
    steps = run.size(240, 60, 1200)
    factors = ((1e-9, 1e-12), (1e-3, 1e-6), (1e-2, 1e6), (1e2, 1e-6), (1e4, 1e12), (1e6, 1e9))
    for mode in ("robust", "energy_keeping"):
        unscaled = path_of(mode, 1, 1, steps)
        run.at_least(f"{mode}: largest motion of a particle, m", float(np.abs(unscaled - unscaled[0]).max()), 0.1)
        for i, (length, mass) in enumerate(factors):
            off = float(np.abs(path_of(mode, length, mass, steps) - unscaled).max())
            run.at_most(f"{mode}: lengths times {length:g}, masses times {mass:g}", off, 1e-6)
            run.progress((i + 1) / len(factors))


def places(run: Run) -> None:
    """Far from the origin.

    50 links of 2 cm, released level, 1/60 s, at 0, 1e5 and 1e7 m: the distance of the swinging end from its place in
    the scene at the origin after a second, and the error of the links' lengths. Positions are doubles: at 1e7 m they
    are 2e-9 m apart.
    """
    for mode in ("robust", "energy_keeping"):
        ends = {}
        for far in (0.0, 1e5, 1e7):
            system = iota.System(mode=mode)
            rings = scenes.string_of_links(system, scenes.level_points((far, 2), 50, 0.02), link_mass=0.02)
            unconverged, stretch = 0, 0.0
            for _ in range(60):
                unconverged += system.step(1 / 60).unconverged
                stretch = max(stretch, float(np.abs(scenes.lengths_between(rings) / 0.02 - 1).max()))
            ends[far] = scenes.place(rings[-1]) - (far, 0, 0)
            rounding = max(far * 2.0**-52, 1e-10)
            run.at_most(f"{mode}, at {far:g} m: steps without a solution", unconverged, 0)
            run.at_most(f"{mode}, at {far:g} m: largest stretch of a link", stretch, 4 * rounding / 0.02)
            if far:
                off = float(np.linalg.norm(ends[far] - ends[0.0]))
                run.at_most(f"{mode}, at {far:g} m: end's distance from that at home, m", off, 1e-5)


def masses(run: Run) -> None:
    """Masses over fourteen decades.

    Twenty links of 0.1 m whose masses rise by 8 to 14 decades from the nail down, released level, 1/60 s: the largest
    change of a link's length, from positions, relative to the link.
    """
    for mode in ("robust", "energy_keeping"):
        for decades in (8, 10, 12, 14):
            system = iota.System(mode=mode)
            rings = scenes.string_of_links(system, scenes.level_points((0, 2), 20, 0.1))
            links = [ring.body for ring in rings[1:]]
            for i, link in enumerate(links):
                for particle in link.particles:
                    particle.mass = 0.5 * 10 ** (-decades / 2 + decades * i / 19)
            stretch = 0.0
            for _ in range(run.size(240, 60, 2400)):
                system.step(1 / 60)
                stretch = max(stretch, float(np.abs(scenes.lengths_between(rings) / 0.1 - 1).max()))
            run.at_most(f"{mode}: {decades} decades, largest stretch / link", stretch, 2e-6)


def conflicts(run: Run) -> None:
    """A conflict is shared.

    A chain of n links, 1 m long, is nailed 1.5 m apart: no solution. All links must share the gap: the longest link
    relative to their mean, from positions, after two seconds. Then the nail moves back within two seconds: all links
    must have their length again, and no snap may leave more kinetic energy than a fall of two meters.
    """
    longest = []
    counts = (2, 20, 50, 100, 200)
    for count in counts:
        system = iota.System()
        rings = scenes.string_of_links(system, scenes.level_points((0, 2), count, 1 / count), link_mass=1 / count)
        rings[-1].nail((1.5, 2, 0))
        for _ in range(120):
            system.step(1 / 60)
        lengths = scenes.lengths_between(rings)
        longest.append(float(lengths.max() / lengths.mean()))
        run.at_most(f"{count} links: longest / mean", longest[-1], 1.25)
        kinetic = 0.0
        for step in range(1, 121):
            rings[-1].nail((1.5 - 0.6 * step / 120, 2, 0))
            kinetic = max(kinetic, system.step(1 / 60).energy.kinetic)
        lengths = count * scenes.lengths_between(rings)
        run.at_most(f"{count} links, nail back: largest stretch", float(np.abs(lengths - 1).max()), 1e-6)
        run.at_most(f"{count} links, nail back: largest kinetic energy / that of a fall of 1 m", kinetic / GRAVITY, 2)

    def draw(figure: Any) -> None:
        axes = figure.subplots()
        axes.semilogx(counts, longest, "o-")
        axes.set(xlabel="links", ylabel="longest link / mean", ylim=(0.9, 1.5))

    run.picture("conflicts", "How evenly the links of a chain that is nailed too far apart share the gap.", draw)
