# SPDX-License-Identifier: Apache-2.0
"""Bodies that spin on the ground: against closed forms and independent equations of motion."""

from __future__ import annotations

import itertools
import math
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

import iota
from iota.verify.reference import GRAVITY as G
from iota.verify.reference import Array, cross, integrate
from iota.verify.run import Run

UP = np.array([0, 1.0, 0])


def spinning(run: Run) -> None:
    """Spinning on the ground.

    Euler's disk: a disk that leans by an angle a rolls in place at the rate W with W^2 = 4 g/(a sin a), here with its thickness.
    The tippe top turns over: its lean and Jellett's integral L . r against its equations of motion with a sliding contact,
    integrated by SciPy. The rattleback reverses its spin: against rolling without slip, Dormand-Prince at 1e-12. A disk that
    slides and spins ends both motions at once: its track against six places that carry the same load. All is measured from
    places and orientations.
    """
    _disk(run)
    run.progress(0.3)
    _tippe_top(run)
    run.progress(0.6)
    _rattleback(run)
    _sliding_disk(run)


def _ground(friction: float) -> iota.System:
    system = iota.System()
    system.usual_material = iota.Material(friction=friction)
    system.obstacle(iota.HalfSpace((0, 1, 0)), material=system.usual_material)
    return system


def _turn(body: iota.Body) -> Array:
    return np.asarray(Rotation.from_quat(body.orientation).as_matrix())


def _disk(run: Run) -> None:
    radius, half, mass = 0.1, 0.002, 1.0
    across, along = mass * (radius**2 / 4 + half**2 / 3), mass * radius**2 / 2
    errors = {}
    for degrees in (60, 40):
        lean = math.radians(degrees)
        s, c = math.sin(lean), math.cos(lean)
        squared = mass * G * (radius * c - half * s) / (s * (across * c - along * half / radius * s))
        rate = math.sqrt(squared)
        for per_second in run.size((500, 1000, 2000), (500, 1000)):
            system = _ground(0.5)
            down, axis = np.array([c, -s, 0]), np.array([s, c, 0])
            arm = radius * down - half * axis  # to the ground
            frame = np.stack([axis, cross(np.array([0, 0, 1.0]), axis), [0, 0, 1.0]], axis=1)
            disk = system.body(
                shape=iota.Cylinder(radius, 2 * half),
                mass=mass,
                position=(0, -arm[1], 0),
                orientation=tuple(Rotation.from_matrix(frame).as_quat()),
                spin=tuple(-rate * s / radius * arm),
            )
            azimuths, leans = [], []
            for _ in range(round(0.3 * per_second)):
                assert system.step(1 / per_second).unconverged == 0
                now = _turn(disk)[:, 0]
                azimuths.append(math.atan2(now[2], now[0]))
                leans.append(math.degrees(math.acos(now[1])))
            measured = np.polyfit(np.arange(len(azimuths)) / per_second, np.unwrap(azimuths), 1)[0]
            errors[degrees, per_second] = abs(abs(measured) / rate - 1)
        name = f"Euler's disk at {degrees} degrees, 1/{per_second} s:"
        run.at_most(f"{name} error of its rate, of {rate:.2f} rad/s", errors[degrees, per_second], run.size(2e-5, 1e-4))
        run.at_most(f"{name} change of its lean, degrees", float(np.ptp(leans)), run.size(1e-3, 2e-3))
        order = math.log2(errors[degrees, per_second // 2] / errors[degrees, per_second])
        run.near(f"order of convergence at {degrees} degrees", order, 2, 0.2)


class _TippeTop:
    """A ball whose center of mass is beside its middle, with the moments of four points in it."""

    radius, mass, offset = 0.02, 0.015, 0.003  # m, kg, m
    friction, lean, spin = 0.3, 0.3, 150.0

    def build(self) -> tuple[iota.System, iota.Body, iota.Particle]:
        system = _ground(self.friction)
        down = np.array([math.sin(self.lean), -math.cos(self.lean), 0])
        sides = np.array([[-down[1], down[0], 0], [0, 0, 1]])
        middle = self.radius * UP
        body = system.body(shape=iota.Sphere(self.radius), mass=0.010, position=tuple(middle))
        center = body.particle(middle, mass=0)
        for side in (*sides, *-sides):
            body.particle(middle + 0.009 * down + 0.0104 * side, mass=0.005 / 4)
        body.angular_velocity = self.spin * UP
        return system, body, center

    def leans(self, inertia: tuple[float, float], times: Array) -> Array:
        """Cosines of the angle between the axis and the vertical, by the equations of motion with friction that slides."""
        across, along = inertia
        slow = 1e-4  # m/s, below which friction grows with the speed

        def turned(q: Array) -> Array:
            """The axis from the middle to the center of mass."""
            u, w = q[:3], q[3]
            return np.asarray(-UP + 2 * cross(u, cross(u, -UP) - w * UP))

        def rate(_: float, state: Array) -> Array:
            q, w, v = state[:4], state[4:7], state[7:]
            axis = turned(q)
            arm = -self.radius * UP - self.offset * axis
            slip = v + cross(w, arm)
            slip -= slip @ UP * UP
            direction = UP - self.friction * slip / math.hypot(float(np.linalg.norm(slip)), slow)

            def spun(torque: Array) -> Array:
                return np.asarray(torque / across + (1 / along - 1 / across) * (axis @ torque) * axis)

            momentum = across * w + (along - across) * (axis @ w) * axis
            free, per_newton = spun(-cross(w, momentum)), spun(cross(arm, direction))
            rise = self.offset * ((cross(free, axis) + cross(w, cross(w, axis))) @ UP)
            load = (G + rise) / (1 / self.mass - self.offset * (cross(per_newton, axis) @ UP))
            turning = 0.5 * np.array([*(q[3] * w + cross(w, q[:3])), -w @ q[:3]])
            return np.concatenate([turning, free + load * per_newton, load * direction / self.mass - G * UP])

        start = [0, 0, math.sin(self.lean / 2), math.cos(self.lean / 2), *(self.spin * UP), 0, 0, 0]
        found = solve_ivp(rate, (0, times[-1]), start, method="LSODA", t_eval=times, rtol=1e-8, atol=1e-10)
        return np.array([-turned(q)[1] for q in found.y[:4].T])


def _tippe_top(run: Run) -> None:
    top, seconds = _TippeTop(), run.size(1.0, 0.25)
    drifts = []
    for per_second in run.size((1000, 2000, 4000), (1000, 2000)):
        dt = 1 / per_second
        system, body, center = top.build()
        turns = [_turn(body)]
        local = turns[0].T @ np.array(center.position - body.center_of_mass)
        inertia = turns[0].T @ np.asarray(body.inertia) @ turns[0]
        for _ in range(round(seconds * per_second)):
            assert system.step(dt).unconverged == 0
            turns.append(_turn(body))
        integrals, cosines = [], []
        for a, b in itertools.pairwise(turns):
            half = Rotation.from_matrix(b @ a.T).as_rotvec() / 2
            between = Rotation.from_rotvec(half).as_matrix() @ a
            momentum = between @ inertia @ between.T @ (2 * half / dt)
            integrals.append(momentum @ (between @ local - top.radius * UP))
            cosines.append(b @ local @ UP / top.offset)
        drifts.append(float(np.abs(np.array(integrals) / integrals[0] - 1).max()))
    moments = np.linalg.eigvalsh(inertia)
    times = np.arange(1, len(cosines) + 1) * dt
    known = top.leans((float(moments[0]), float(moments[2])), times)
    error = float(np.abs(known - cosines).max())
    run.note(
        "tippe top: I1/I3, and its center of mass beside the middle, of the radius",
        f"{moments[0] / moments[2]:.4f}, 0.15",
    )
    run.at_most(f"cosine of its lean, 1/{per_second} s: largest error", error, run.size(5e-3, 1e-2))
    run.at_most("Jellett's integral, relative deviation", drifts[-1], run.size(1e-4, 5e-4))
    run.near("order of convergence of Jellett's integral", math.log2(drifts[-2] / drifts[-1]), 2, 0.3)
    if run.scale != "quick":
        run.at_most("cosine of the lean at the end", cosines[-1], -0.85)

    def draw(figure: Any) -> None:
        axes = figure.subplots()
        axes.plot(times, cosines, label="iota")
        axes.plot(times[::80], known[::80], ".", ms=3, color="k", label="equations of motion")
        axes.set(xlabel="time, s", ylabel="cosine of the lean")
        axes.legend(fontsize=7)

    run.picture("spinning", "A tippe top turns over.", draw, size=(5, 3))


def _rattleback(run: Run) -> None:
    half, points, extra = np.array([0.1, 0.02, 0.025]), np.array([0.08, 0, 0.012]), 0.05
    for spin in run.size((-5.0, 5.0), (5.0,)):
        tracks, ends = [], []
        for per_second in run.size((500, 1000, 2000), (500, 1000)):
            system = _ground(2)
            body = system.body(shape=iota.Ellipsoid(tuple(2 * half)), mass=0.2, position=(0, half[1], 0))
            for side in (1, -1):
                body.particle(side * points + (0, half[1], 0), mass=extra)
            start = np.array([0, spin, 0.5])
            body.angular_velocity = start
            body.velocity = -cross(start, -half[1] * UP)
            head = body.particle((half[0], half[1], 0), mass=0)
            inertia, mass = np.asarray(body.inertia), body.mass
            track = []
            for _ in range(round(run.size(2.0, 1.0) * per_second)):
                assert system.step(1 / per_second).unconverged == 0
                track.append(head.position - body.center_of_mass)
            tracks.append(np.array(track))
            ends.append(math.atan2(track[-1].z, track[-1].x) - math.atan2(track[-20].z, track[-20].x))
        times = np.arange(len(track) + 1) / per_second
        known, spins = _rolling_ellipsoid(inertia, mass, half, start, times)
        errors = [
            float(np.abs(each - known[len(track) // len(each) :: len(track) // len(each)]).max()) / half[0]
            for each in tracks
        ]
        word = "stable" if spin < 0 else "reversing"
        name = f"rattleback, {word} sense, 1/{per_second} s: largest error of its end, of its half length"
        run.at_most(name, errors[-1], run.size(0.01, 0.02) if spin > 0 else 1e-4)
        run.note(f"order of convergence, {word} sense", math.log2(errors[-2] / errors[-1]))
        run.note(f"spin at the end by the equations of motion, {word} sense, rad/s", float(spins[-1]))
        same = np.sign(math.remainder(ends[-1], 2 * math.pi)) == -np.sign(spins[-1])
        run.at_least(f"it turns in the sense of these, {word} sense", float(same), 1)


def _rolling_ellipsoid(inertia: Array, mass: float, half: Array, spin: Array, times: Array) -> tuple[Array, Array]:
    """The end of its first axis and its spin about the vertical: rolling on a plane without slip, in the frame of the body."""
    squares = half**2

    def rate(_: float, state: Array) -> Array:
        up, w, east = state[:3], state[3:6], state[6:]
        reach = math.sqrt(up @ (squares * up))
        arm = -squares * up / reach
        up_rate = -cross(w, up)
        arm_rate = -squares * up_rate / reach + squares * up * (up @ (squares * up_rate)) / reach**3
        speed = -cross(w, arm)
        moment = -cross(w, inertia @ w) + mass * cross(arm, G * up - cross(w, arm_rate) + cross(w, speed))
        skew = np.array([[0, -arm[2], arm[1]], [arm[2], 0, -arm[0]], [-arm[1], arm[0], 0]])
        return np.concatenate([up_rate, np.linalg.solve(inertia - mass * skew @ skew, moment), -cross(w, east)])

    states = integrate(rate, [0, 1, 0, *spin, 1, 0, 0], times)
    up, w, east = states[:, :3], states[:, 3:6], states[:, 6:]
    north = np.cross(east, up)
    return half[0] * np.stack([east[:, 0], up[:, 0], north[:, 0]], axis=1), np.einsum("ij,ij->i", up, w)


def _sliding_disk(run: Run) -> None:
    radius, friction, dt = 0.1, 0.3, 1 / 960
    spots = radius * np.exp(1j * np.pi / 3 * np.arange(6))

    def slowing(_: float, state: Array) -> Array:
        v, w, angle = complex(state[0], state[1]), state[2], state[3]
        at = spots * np.exp(1j * angle)
        slip = v + 1j * w * at
        force = -friction * G / 6 * slip / np.maximum(np.abs(slip), 1e-9)
        return np.array([force.sum().real, force.sum().imag, (force / (1j * at)).real.sum() * 2, w])

    def at_rest(_: float, state: Array) -> float:
        return math.hypot(state[0], state[1]) + radius * abs(float(state[2])) - 1e-3

    at_rest.terminal = True  # type: ignore[attr-defined]
    for speed, spin in run.size(((1.0, 20.0), (0.5, 30.0), (1.0, 2.0)), ((1.0, 20.0),)):
        system = _ground(friction)
        disk = system.body(
            shape=iota.Cylinder(radius, 1e-3), position=(0, 5e-4, 0), orientation=("z", 90), velocity=(speed, 0, 0),
            spin=(0, -spin, 0),
        )  # fmt: skip
        places, turns = [disk.center_of_mass], [_turn(disk)]
        for _ in range(round(1.2 / dt)):
            assert system.step(dt).unconverged == 0
            places.append(disk.center_of_mass)
            turns.append(_turn(disk))
        speeds = np.linalg.norm(np.diff(np.array(places), axis=0), axis=1) / dt
        spins = np.array(
            [np.linalg.norm(Rotation.from_matrix(b @ a.T).as_rotvec()) / dt for a, b in itertools.pairwise(turns)]
        )
        stops = [int(np.nonzero(each > 1e-4)[0][-1]) for each in (speeds, radius * spins)]
        name = f"disk at {speed} m/s and {spin:g} rad/s:"
        run.at_most(f"{name} steps between the ends of sliding and spinning", abs(stops[0] - stops[1]), 2)
        found = solve_ivp(
            slowing, (0, 2), [speed, 0, spin, 0], method="LSODA", rtol=1e-9, atol=1e-11, events=at_rest, max_step=1e-3
        )
        run.near(f"{name} time until it rests, s", max(stops) * dt, float(found.t[-1]), 3e-3)
