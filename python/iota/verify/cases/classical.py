# SPDX-License-Identifier: Apache-2.0
"""Textbook problems with exact answers."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np
from scipy.optimize import brentq
from scipy.special import ellipk

import iota
from iota.verify import scenes
from iota.verify.reference import GRAVITY, Array, PlanarChain, still
from iota.verify.run import Run


def crossings(values: Array, h: float) -> Array:
    """Times of downward zero crossings of a sampled motion, by the cubic through the four nearest samples."""
    times = []
    for i in np.flatnonzero((values[1:-2] > 0) & (values[2:-1] <= 0)) + 1:
        cubic = np.polynomial.Polynomial.fit([-1, 0, 1, 2], values[i - 1 : i + 3], 3)
        times.append((i + brentq(cubic, 0, 1)) * h)
    return np.array(times)


def pendulum(run: Run) -> None:
    """Pendulum.

    A mass on a massless rod of 1 m, released at up to 170 degrees: its period is 4 sqrt(L/g) K(sin(a/2)), with K the
    complete elliptic integral of the first kind. Energy-keeping mode, 1/1000 s a step.
    """
    length, h = 1.0, run.size(1 / 1000, 1 / 500)
    degrees = run.size([5, 30, 60, 90, 120, 150, 170], [30, 90, 170])
    measured, expected = [], []
    for index, angle in enumerate(np.radians(degrees)):
        system = iota.System()
        rod = system.body()
        rod.particle((0, 0)).nail()
        bob = rod.particle((length * np.sin(angle), -length * np.cos(angle)))
        exact = 4 * np.sqrt(length / GRAVITY) * ellipk(np.sin(angle / 2) ** 2)
        x = [bob.position.x]
        while len(x) * h < 1.3 * exact:
            system.step(h)
            x.append(bob.position.x)
        fall = crossings(np.array(x), h)
        measured.append(fall[1] - fall[0] if len(fall) > 1 else np.nan)
        expected.append(exact)
        if np.isnan(measured[-1]):  # from rest: a quarter period to the first downward zero crossing
            measured[-1] = 4 * fall[0]
        run.near(f"period from {degrees[index]}°, s", measured[-1], exact, run.size(1e-5, 4e-5) * exact)
        run.progress((index + 1) / len(degrees))

    def draw(figure: Any) -> None:
        left, right = figure.subplots(1, 2)
        angles = np.linspace(0.1, 175, 300)
        periods = 4 * np.sqrt(length / GRAVITY) * ellipk(np.sin(np.radians(angles) / 2) ** 2)
        left.plot(angles, periods, color="k", lw=1, label="4 √(L/g) K(sin a/2)")
        left.plot(degrees, measured, "o", ms=4, label="iota")
        left.set(xlabel="let go at, degrees", ylabel="period, s")
        left.legend(fontsize=7)
        right.semilogy(degrees, np.abs(np.array(measured) / np.array(expected) - 1), "o-", ms=3)
        right.set(xlabel="let go at, degrees", ylabel="relative error of the period")

    run.picture("pendulum", "Period of a pendulum against its amplitude.", draw)


def double_pendulum(run: Run) -> None:
    """Double pendulum.

    Two links of 1 m, released level: compared with the equations of motion in two angles, integrated to 1e-13, over two
    seconds. Energy-keeping mode is of second order, robust mode of first.
    """
    lengths, masses, angles = np.array([1.0, 1.0]), np.array([1.0, 0.5]), np.array([np.pi / 2, np.pi / 2])
    counts = run.size([120, 240, 480, 960, 1920, 3840], [240, 480, 960])
    truth = PlanarChain(lengths, masses, still((0, 0))).places(np.array([0.0, 2.0]), angles, np.zeros(2))[-1]
    errors: dict[str, list[float]] = {"energy_keeping": [], "robust": []}
    for mode, list_of_errors in errors.items():
        for steps in counts:
            system = iota.System(mode=mode)  # type: ignore[arg-type]
            rings = scenes.string_of_links(system, scenes.hanging_points((0, 0), lengths, angles))
            for _ in range(steps):
                system.step(2 / steps)
            list_of_errors.append(float(np.abs(scenes.places(rings[1:])[:, :2] - truth).max()))
    for mode, order, tolerance in (("energy_keeping", 2, 0.1), ("robust", 1, 0.25)):
        found = np.log2(errors[mode][-2] / errors[mode][-1])
        run.near(f"order of convergence, {mode}", float(found), order, tolerance)
    run.at_most(f"error after 2 s at 1/{counts[-1] // 2} s, energy_keeping, m", errors["energy_keeping"][-1], 1e-3)

    def draw(figure: Any) -> None:
        axes = figure.subplots()
        steps = 2 / np.array(counts)
        for mode, order in (("energy_keeping", 2), ("robust", 1)):
            (line,) = axes.loglog(steps, errors[mode], "o-", ms=4, label=mode)
            axes.loglog(steps, errors[mode][-1] * (steps / steps[-1]) ** order, color=line.get_color(), lw=0.7, ls="--")
        axes.set(xlabel="step, s", ylabel="error after 2 s, m")
        axes.legend(fontsize=7)

    run.picture(
        "double-pendulum", "Error after 2 s against the step; dashed: second and first order.", draw, size=(5, 3.4)
    )


def catenary(run: Run) -> None:
    """Catenary.

    A chain between two nails, damped to rest. With equal links its rest shape is known exactly: the tangents of
    successive links increase uniformly. With more links it converges to the catenary y = a cosh(x/a), with the square
    of a link's length.
    """
    span, length = 1.0, 1.5
    a = brentq(lambda a: 2 * a * np.sinh(span / (2 * a)) - length, 0.05, 10)
    sag = a * (np.cosh(span / (2 * a)) - 1)

    def rest_shape(links: int) -> Array:
        """Points of the discrete chain in equilibrium: tan(angle_i) = (i - (n - 1)/2) k, with k from the span."""
        rank = np.arange(links) - (links - 1) / 2
        k = brentq(lambda k: np.sum(length / links / np.hypot(1, rank * k)) - span, 1e-6, 1e3)
        steps = np.stack([np.ones(links), rank * k], axis=1) / np.hypot(1, rank * k)[:, None] * length / links
        return np.vstack([[0.0, 0.0], np.cumsum(steps, axis=0)])

    counts = run.size([8, 16, 32, 64, 128], [8, 16, 32])
    sag_errors, shapes = [], {}
    for index, links in enumerate(counts):
        # Starts as a tent: two straight halves that meet above the rest shape.
        half = links // 2
        tip = np.array([span / 2, np.sqrt((length / 2) ** 2 - (span / 2) ** 2) * -1.0])
        points = np.vstack([np.linspace([0, 0], tip, half + 1), np.linspace(tip, [span, 0], links - half + 1)[1:]])
        system = iota.System(damping=6.0)
        rings = scenes.string_of_links(system, np.column_stack([points, np.zeros(links + 1)]))
        rings[-1].nail()
        for _ in range(900):
            system.step(1 / 60)
        shape = scenes.places(rings)[:, :2]
        shapes[links] = shape
        run.at_most(
            f"farthest from the exact rest shape, {links} links, m",
            float(np.abs(shape - rest_shape(links)).max()),
            1e-8,
        )
        sag_errors.append(abs(-shape[:, 1].min() - sag))
        run.progress((index + 1) / len(counts))
    order = np.log2(sag_errors[-2] / sag_errors[-1])
    run.near("order at which the sag nears the catenary's", float(order), 2, 0.05)

    def draw(figure: Any) -> None:
        axes = figure.subplots()
        x = np.linspace(0, span, 200)
        axes.plot(x, a * np.cosh((x - span / 2) / a) - a * np.cosh(span / (2 * a)), color="k", lw=1, label="catenary")
        for links in (counts[0], counts[-1]):
            axes.plot(*shapes[links].T, "o-", ms=2.5, lw=0.8, label=f"{links} links")
        axes.set(xlabel="x, m", ylabel="y, m", aspect="equal")
        axes.legend(fontsize=7)

    run.picture("catenary", "Chains at rest between two nails.", draw, size=(5, 3.4))


def spring_chain(run: Run) -> None:
    """Normal modes of a spring chain.

    Eight masses on nine equal springs between two nails, along a line: mode k has the circular frequency
    2 sqrt(k/m) sin(k pi / 18). The mid-point rule changes a frequency w to (2/h) atan(w h / 2), exactly. Each mode is
    started alone; its phase after ten periods gives its frequency.
    """
    masses, stiffness, mass, gap = 8, 400.0, 0.5, 0.2
    h = 1 / 240
    worst, ratios = 0.0, []
    for mode in range(1, masses + 1):
        shape = np.sin(np.pi * mode * np.arange(1, masses + 1) / (masses + 1))
        omega = 2 * np.sqrt(stiffness / mass) * np.sin(np.pi * mode / (2 * (masses + 1)))
        system = iota.System(gravity=(0, 0, 0))
        row = []
        for i in range(masses + 2):
            x = i * gap + (1e-3 * shape[i - 1] if 0 < i <= masses else 0)
            row.append(system.body().particle((x, 0, 0), mass=mass))
        row[0].nail()
        row[-1].nail()
        for p, q in pairwise(row):
            system.bond(p, q, "spring", stiffness=stiffness, damping=0, length=gap)
        steps = round(run.size(10, 3) * 2 * np.pi / omega / h)
        for _ in range(steps):
            system.step(h)
        home = gap * np.arange(1, masses + 1)
        x, v = scenes.places(row)[1:-1, 0] - home, np.array([p.velocity.x for p in row[1:-1]])
        phase = np.arctan2(-(v @ shape) / omega, x @ shape)
        turned = steps * 2 * np.arctan(omega * h / 2)
        worst = max(worst, float(abs((phase - turned + np.pi) % (2 * np.pi) - np.pi)) / turned)
        ratios.append(turned / (steps * h) / omega)
        other = x - (x @ shape) / (shape @ shape) * shape
        run.at_most(f"what of mode {mode} has gone to others", float(np.abs(other).max()) / 1e-3, 1e-7)
        run.progress(mode / masses)
    run.at_most("frequencies, relative error against (2/h) atan(w h / 2)", worst, 1e-7)
    run.at_most("frequencies, relative error against the continuous ones", 1 - min(ratios), (omega * h) ** 2 / 11)


def oscillator(run: Run) -> None:
    """Damped oscillator.

    A mass on a spring with a dashpot, released at 0.1 m, in all three regimes: x(t) of the linear oscillator. 1/960 s a
    step.
    """
    mass, stiffness, seconds = 2.0, 80.0, 3.0
    omega = np.sqrt(stiffness / mass)
    traces = {}
    for name, zeta in (("underdamped", 0.1), ("critical", 1.0), ("overdamped", 2.0)):
        errors = []
        for h in (1 / 480, 1 / 960):
            system = iota.System(gravity=(0, 0, 0))
            wall, bob = (system.body().particle((x, 0, 0), mass=mass) for x in (0.0, 1.1))
            wall.nail()
            system.bond(wall, bob, "spring", stiffness=stiffness, damping=2 * zeta * omega * mass, length=1.0)
            x = []
            for _ in range(round(seconds / h)):
                system.step(h)
                x.append(bob.position.x - 1.0)
            t = np.arange(1, len(x) + 1) * h
            if zeta < 1:
                wd = omega * np.sqrt(1 - zeta**2)
                exact = np.exp(-zeta * omega * t) * (np.cos(wd * t) + zeta * omega / wd * np.sin(wd * t))
            elif zeta == 1:
                exact = np.exp(-omega * t) * (1 + omega * t)
            else:
                r1, r2 = omega * (-zeta + np.array([1, -1]) * np.sqrt(zeta**2 - 1))
                exact = (r1 * np.exp(r2 * t) - r2 * np.exp(r1 * t)) / (r1 - r2)
            errors.append(float(np.abs(np.array(x) - 0.1 * exact).max()))
            traces[name] = (t, np.array(x), 0.1 * exact)
        run.at_most(f"{name}: largest error of x, m", errors[1], 1e-5)
        run.near(f"{name}: order of convergence", float(np.log2(errors[0] / errors[1])), 2, 0.1)

    def draw(figure: Any) -> None:
        axes = figure.subplots()
        for index, (name, (t, x, exact)) in enumerate(traces.items()):
            axes.plot(t[::20], x[::20], "o", ms=2, color=f"C{index}", label=name)
            axes.plot(t, exact, color=f"C{index}", lw=0.8)
        axes.set(xlabel="time, s", ylabel="x, m")
        axes.legend(fontsize=7)

    run.picture(
        "oscillator", "Damped oscillator: steps of iota (dots, every 20th) on the exact motion.", draw, size=(5, 3.2)
    )


def orbit(run: Run) -> None:
    """Two-body orbit.

    Two bodies under Newton's law of gravity, implicit in the energy-keeping scheme, on an ellipse of eccentricity 0.5: the
    period is that of Kepler's third law, and energy and angular momentum are kept to round-off. With a scripted force,
    held over a step of robust mode, the orbit closes too, and angular momentum is kept.
    """
    masses, strength = np.array([3.0, 1.0]), 1 / 3  # G in m^3/(kg s^2)
    mu = strength * masses.sum()
    axis, eccentricity = 1.0, 0.5
    period = 2 * np.pi * np.sqrt(axis**3 / mu)
    near = axis * (1 - eccentricity)
    speed = np.sqrt(mu * (2 / near - 1 / axis))
    per_orbit, orbits = run.size(4000, 2000), run.size(5, 2)
    h = period / per_orbit
    share = np.array([-masses[1], masses[0]]) / masses.sum()

    def travel(scripted: bool) -> tuple[Array, float, float]:
        """The path of one relative to the other; largest relative changes of energy and angular momentum."""
        system = iota.System(gravity=(0, 0, 0), mode="robust" if scripted else "energy_keeping")
        p, q = (
            system.body().particle((s * near, 0, 0), mass=m, velocity=(0, s * speed, 0))
            for s, m in zip(share, masses, strict=True)
        )
        pull = strength * masses.prod()
        if scripted:
            system.bond(p, q, lambda bond: pull / bond.distance**2 * bond.direction)
        else:
            system.bond(p, q, "gravity", strength=strength)

        def energy() -> float:
            return float(system.energy.kinetic - pull / abs(q.position - p.position))

        start, spin = energy(), system.angular_momentum.z
        path, drift, twist = [], 0.0, 0.0
        for step in range(orbits * per_orbit + per_orbit // 50):
            system.step(h)
            path.append(np.asarray(q.position - p.position)[:2])
            drift = max(drift, abs(energy() / start - 1))
            twist = max(twist, abs(system.angular_momentum.z / spin - 1))
            if step % 1000 == 0:
                run.progress((step / orbits / per_orbit + scripted) / 2)
        return np.array(path), drift, twist

    def period_of(path: Array) -> float:
        angle = np.unwrap(np.arctan2(path[:, 1], path[:, 0]))
        return float(np.interp(2 * np.pi * orbits, angle, np.arange(1, len(angle) + 1) * h)) / orbits

    path, drift, twist = travel(scripted=False)
    run.near("period, s", period_of(path), period, 2e-5 * period)
    run.near("farthest, m", float(np.linalg.norm(path, axis=1).max()), axis * (1 + eccentricity), 1e-5)
    run.at_most("energy, largest relative deviation", drift, 1e-11)
    run.at_most("angular momentum, largest relative deviation", twist, 1e-12)
    scripted, drift, twist = travel(scripted=True)
    run.near("scripted force, robust: period, s", period_of(scripted), period, run.size(2e-3, 4e-3) * period)
    run.at_most("scripted force, robust: angular momentum, largest relative deviation", twist, 1e-12)

    def draw(figure: Any) -> None:
        axes = figure.subplots()
        turn = np.linspace(0, 2 * np.pi, 400)
        ellipse = axis * (np.cos(turn) - eccentricity), axis * np.sqrt(1 - eccentricity**2) * np.sin(turn)
        axes.plot(-ellipse[0] if path[0, 0] < 0 else ellipse[0], ellipse[1], "k", lw=1, label="Kepler's ellipse")
        axes.plot(*path[:: per_orbit // 60].T, "o", ms=2, label="iota")
        axes.set(xlabel="x, m", ylabel="y, m", aspect="equal")
        axes.legend(fontsize=7)

    run.picture("orbit", "The orbit of one body as seen from the other.", draw, size=(4.6, 3.4))
