# SPDX-License-Identifier: Apache-2.0
"""Accurate mode against exact solutions, and angular momentum in all modes."""

from __future__ import annotations

from typing import Any

import numpy as np

import iota
from iota.verify import scenes
from iota.verify.reference import PlanarChain, still
from iota.verify.run import Run


def accurate(run: Run) -> None:
    """Accurate mode.

    Strings of two and three links of 1 m, released level: compared after two seconds with the equations of motion in
    angles, integrated to 1e-13 by Dormand-Prince 8(5,3). The error must be below what the tolerance allows, and the
    energy must be kept better than in energy-keeping mode, whose error is of second order.
    """
    tolerances = run.size([1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8], [1e-2, 1e-4, 1e-8])
    seconds, hz = 2.0, 60
    errors: dict[int, list[float]] = {2: [], 3: []}
    for links, list_of_errors in errors.items():
        angles = np.full(links, np.pi / 2)
        chain = PlanarChain(np.ones(links), scenes.masses_of(links), still((0, 0)))
        truth = chain.places(np.array([0.0, seconds]), angles, np.zeros(links))[-1]

        def swing(mode: str, tolerance: float, links: int = links, truth: Any = truth) -> tuple[float, float]:
            system = iota.System(mode=mode)  # type: ignore[arg-type]
            system.tolerance = tolerance
            points = scenes.hanging_points((0, 0), np.ones(links), np.full(links, np.pi / 2))
            rings = scenes.string_of_links(system, points)
            start, worst = system.energy.total, 0.0
            for _ in range(round(seconds * hz)):
                worst = max(worst, abs(system.step(1 / hz).energy.total - start))
            return float(np.abs(scenes.places(rings[1:])[:, :2] - truth).max()), worst

        second_order, kept = swing("energy_keeping", 1e-4)
        for index, tolerance in enumerate(tolerances):
            error, energy = swing("accurate", tolerance)
            list_of_errors.append(error)
            run.at_most(f"{links} links, tolerance {tolerance:.0e}: error after 2 s, m", error, seconds * tolerance)
            run.at_most(f"{links} links, tolerance {tolerance:.0e}: error of energy, J", energy, max(kept, 1e-12))
            run.progress((links - 2 + (index + 1) / len(tolerances)) / 2)
        run.at_most(f"{links} links: error at 1e-8 / that of energy-keeping", list_of_errors[-1] / second_order, 1e-4)

    def draw(figure: Any) -> None:
        axes = figure.subplots()
        for links, list_of_errors in errors.items():
            axes.loglog(tolerances, list_of_errors, "o-", ms=4, label=f"{links} links")
        axes.loglog(tolerances, seconds * np.array(tolerances), "k--", lw=0.7, label="allowed")
        axes.set(xlabel="tolerance, links per second", ylabel="error after 2 s, m")
        axes.legend(fontsize=7)

    run.picture("accurate", "Error after 2 s against the tolerance.", draw, size=(5, 3.4))


def angular_momentum(run: Run) -> None:
    """Angular momentum.

    Two links of 1 m that are hinged, spinning at 10 rad/s in empty space, and the same on a nail without gravity, for
    two seconds at 1/60 s. Energy-keeping and accurate mode keep their angular momentum, about the nail if there is one.
    """
    steps = run.size(120, 30)
    for nailed in (False, True):
        for mode, allowed in (("energy_keeping", 1e-9), ("accurate", 1e-5 if nailed else 1e-11)):
            system = iota.System(gravity=(0, 0, 0), mode=mode)  # type: ignore[arg-type]
            points = np.array([[0, 0, 0], [1, 0, 0], [1.6, 0.8, 0]])
            rings = scenes.string_of_links(system, points, velocities=np.cross([0, 0, 10.0], points))
            if not nailed:
                rings[0].release()
            start = np.asarray(system.angular_momentum)
            for _ in range(steps):
                system.step(1 / 60)
            change = float(np.linalg.norm(np.asarray(system.angular_momentum) - start) / np.linalg.norm(start))
            place = "on a nail" if nailed else "free"
            run.at_most(f"{mode}, {place}: relative change of angular momentum", change, allowed)
