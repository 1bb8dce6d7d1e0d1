# SPDX-License-Identifier: Apache-2.0
"""Rotating rigid bodies, compared with Euler's equations."""

from __future__ import annotations

from typing import Any

import numpy as np

import iota
from iota.verify import scenes
from iota.verify.reference import GRAVITY, Array, integrate
from iota.verify.run import Run


def six_points(moments: Array, mass: float) -> tuple[Array, list[float]]:
    """Six equal point masses on the axes with these principal moments of inertia, kg m^2: points (6, 3), masses."""
    second = moments.sum() / 2 - moments  # sum of m x^2 along each axis
    reach = np.sqrt(second / (2 * mass / 6))
    return np.vstack([np.diag(reach), -np.diag(reach)]), [mass / 6] * 6


def turn(quaternion: Array, vectors: Array) -> Array:
    """Rotates (n, 3) by a quaternion x y z w."""
    axis, w = quaternion[:3], quaternion[3]
    return np.asarray(vectors + 2 * np.cross(axis, np.cross(axis, vectors) + w * vectors))


def free_motion(moments: Array, spin: Array, times: Array) -> tuple[Array, Array]:
    """Euler's equations of a free body, in its principal frame: angular velocities (body frame) and quaternions."""

    def rate(_: float, y: Array) -> Array:
        w, q = y[:3], y[3:]
        vector, scalar = q[:3], q[3]
        return np.concatenate(
            [
                np.cross(moments * w, w) / moments,
                0.5 * (scalar * w + np.cross(vector, w)),
                [-0.5 * vector @ w],
            ]
        )

    states = integrate(rate, np.concatenate([spin, [0, 0, 0, 1]]), times)
    return states[:, :3], states[:, 3:]


def asymmetric_top(run: Run) -> None:
    """Free asymmetric top.

    A body of six points with moments 1 : 2 : 3, spun about its intermediate axis with a perturbation of a hundredth: it
    flips repeatedly. All points are compared with Euler's equations in its principal frame, integrated to 1e-13,
    through three flips (one in a quick run); energy and angular momentum to round-off.
    """
    moments = np.array([1.0, 2.0, 3.0])
    points, masses = six_points(moments, 6.0)
    spin = np.array([0.05, 5.0, 0.05])
    seconds = run.size(12.0, 3.0)
    errors = []
    for per_second in run.size([480, 960, 1920], [480, 960]):
        h = 1 / per_second
        steps = round(seconds * per_second)
        system = iota.System(gravity=(0, 0, 0))
        body = scenes.rigid_body(system, points, masses, spin=spin)
        energy, momentum = system.energy.total, np.asarray(system.angular_momentum)
        times = np.arange(steps + 1) * h
        w, quaternions = free_motion(moments, spin, times)
        ours = np.empty((steps + 1, 6, 3))
        ours[0] = points
        drift = twist = 0.0
        for step in range(1, steps + 1):
            report = system.step(h)
            ours[step] = scenes.places(body)
            drift = max(drift, abs(report.energy.total / energy - 1))
            twist = max(twist, float(np.linalg.norm(np.asarray(system.angular_momentum) - momentum)))
        truth = np.array([turn(q, points) for q in quaternions])
        errors.append(float(np.abs(ours - truth).max()))
        run.progress(min(1.0, 4.0 ** len(errors) / 64))
    flips = int(np.count_nonzero(np.diff(np.sign(w[:, 1]))))
    run.note("flips", flips)
    run.at_least("flips that Euler's equations predict", flips, run.size(3, 1))
    run.near("order of convergence", float(np.log2(errors[-2] / errors[-1])), 2, 0.1)
    run.at_most(f"farthest any point is from Euler's, 1/{per_second} s, m", errors[-1], 1e-3)
    run.at_most("energy, relative deviation", drift, 1e-10)
    # Each step turns the body by an angle that gives energy back, and rounds.
    bound = run.size(1e-11, 1e-12)
    run.at_most("angular momentum, relative deviation", twist / float(np.linalg.norm(momentum)), bound)

    def draw(figure: Any) -> None:
        axes = figure.subplots()
        along = points[1] / np.linalg.norm(points[1])
        reach = float(np.linalg.norm(points[1]))
        axes.plot(times, ours[:, 1] @ along / reach, label="iota")
        axes.plot(times[::40], truth[::40, 1] @ along / reach, ".", ms=2.5, color="k", label="Euler's equations")
        axes.set(xlabel="time, s", ylabel="cosine of the axis to its start")
        axes.legend(fontsize=7)

    run.picture("asymmetric-top", "A body spun about its intermediate axis turns over and over.", draw, size=(7, 2.8))


def heavy_top(run: Run) -> None:
    """Heavy top.

    A symmetric top on a nail at its tip, leaning by 30 degrees and started in steady precession: the rate W solves
    I1 W^2 cos a - I3 w3 W + m g l = 0 and the lean is constant. Then the same top with spin only: it falls, and nutates
    between two leans that follow from the conserved quantities.
    """
    ring, height, mass, lean = 0.3, 0.8, 1.2, np.radians(30)
    spokes = 6
    around = 2 * np.pi * np.arange(spokes) / spokes
    disc = np.column_stack([ring * np.cos(around), np.full(spokes, height), ring * np.sin(around)])
    rod = np.array([[0, 0, 0], [0, 2 * height - 0.2, 0.0]])
    points = np.vstack([rod[:1], disc, rod[1:]])
    masses = [1e-3, *([mass / spokes] * spokes), 0.05]
    weights = np.array(masses)
    i1 = float(weights @ (points[:, 1] ** 2 + points[:, 0] ** 2))
    i3 = float(weights @ (points[:, 0] ** 2 + points[:, 2] ** 2))
    moment = GRAVITY * float(weights @ points[:, 1])  # m g l
    w3 = 60.0

    # World: y up. It leans about z, so that the axis is (-sin a, cos a, 0).
    tilt = np.array([[np.cos(lean), -np.sin(lean), 0], [np.sin(lean), np.cos(lean), 0], [0, 0, 1.0]])
    axis = tilt @ np.array([0, 1.0, 0])

    def simulate(spin: Array, seconds: float, h: float) -> tuple[Array, Array]:
        """Leans (rad) and azimuths (rad) of the axis after each step."""
        system = iota.System()
        body = system.body()
        made = [
            body.particle(p, mass=m, velocity=np.cross(spin, p)) for p, m in zip(points @ tilt.T, masses, strict=True)
        ]
        made[0].nail()
        tips = []
        for _ in range(round(seconds / h)):
            system.step(h)
            tips.append(made[-1].position)
        tip = np.array(tips) / (2 * height - 0.2)
        return np.arccos(np.clip(tip[:, 1], -1, 1)), np.unwrap(np.arctan2(-tip[:, 2], tip[:, 0]))

    cosine = np.cos(lean)
    root = np.sqrt((i3 * w3) ** 2 - 4 * i1 * cosine * moment)
    slow = (i3 * w3 - root) / (2 * i1 * cosine)
    seconds, h = run.size(6.0, 1.0), run.size(1 / 2000, 1 / 1000)
    # Angular velocity: w3 along the axis, and the precession's part normal to it.
    across = np.array([0, 1.0, 0]) - cosine * axis
    steady, azimuth = simulate(w3 * axis + slow * across, seconds, h)
    run.progress(0.4)
    rate = float((azimuth[-1] - azimuth[0]) / ((len(azimuth) - 1) * h))
    run.near("steady precession, rad/s", rate, slow, run.size(2e-3, 6e-3) * slow)
    run.at_most(
        "wobble of the lean in steady precession, degrees", float(np.degrees(np.ptp(steady))), run.size(0.02, 0.08)
    )

    nodding, _ = simulate(w3 * axis, seconds, h)
    # u = cos(lean) turns where 1 - u^2 = 2 b (u0 - u), b = (I3 w3)^2 / (4 I1 m g l): the lower turning point.
    b = (i3 * w3) ** 2 / (4 * i1 * moment)
    lowest = b - np.sqrt(b * b - 2 * b * cosine + 1)
    run.near(
        "deepest lean of the nutation, degrees",
        float(np.degrees(nodding.max())),
        float(np.degrees(np.arccos(lowest))),
        0.02,
    )
    run.near("smallest lean of the nutation, degrees", float(np.degrees(nodding.min())), 30.0, 0.02)

    def draw(figure: Any) -> None:
        axes = figure.subplots()
        times = np.arange(1, len(nodding) + 1) * h
        shown = times < 1.0
        axes.plot(times[shown], np.degrees(nodding[shown]), label="spin alone: nutation")
        axes.plot(times[shown], np.degrees(steady[shown]), label="steady precession")
        axes.axhline(np.degrees(np.arccos(lowest)), color="k", lw=0.7, ls="--")
        axes.axhline(30, color="k", lw=0.7, ls="--")
        axes.set(xlabel="time, s", ylabel="lean, degrees")
        axes.legend(fontsize=7)

    run.picture("heavy-top", "Lean of the top's axis; dashed: the turning points of theory.", draw, size=(5, 3))
