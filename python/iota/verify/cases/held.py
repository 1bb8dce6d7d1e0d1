# SPDX-License-Identifier: Apache-2.0
"""Forces that are held over a step: fields of velocities, torques."""

from __future__ import annotations

import math

import numpy as np

import iota
from iota.verify.reference import GRAVITY, Array, integrate
from iota.verify.run import Run

MODES = ("plausible", "robust", "energy_keeping", "accurate")
TURN = np.array([0.3, 0.8, 0.1])  # rad/s
START = np.array([0.5, -1.2, 0, 0, 0, 0.6])  # m, m/s: a pendulum of 1.3 m


def foucault(mode: str, hz: int, seconds: float) -> tuple[Array, float]:
    """The place of the bob, and the error that the mode estimates, m."""
    system = iota.System(mode=mode)  # type: ignore[arg-type]
    rod = system.body()
    rod.particle((0, 0, 0)).nail()
    bob = rod.particle(tuple(START[:3]), mass=2, velocity=tuple(START[3:]))
    system.field(
        "fx = -2*m*(wy*vz - wz*vy); fy = -2*m*(wz*vx - wx*vz); fz = -2*m*(wx*vy - wy*vx)",
        wx=TURN[0], wy=TURN[1], wz=TURN[2],
    )  # fmt: skip
    told = sum(system.step(1 / hz).error for _ in range(round(seconds * hz))) / hz
    return np.array(bob.position), told * math.hypot(*START[:2])


def rate_of_the_bob(_: float, state: Array) -> Array:
    x, v = state[:3], state[3:]
    free = np.array([0, -GRAVITY, 0]) - 2 * np.cross(TURN, v)
    return np.concatenate([v, free - (v @ v + free @ x) / (x @ x) * x])


def held_forces(run: Run) -> None:
    """Held forces.

    Fields that depend on velocities, and torques. A force across the velocity must keep the speed of a free particle in
    every mode, at any turn a step; a drag in a fall must leave the exact velocity. A Foucault pendulum of 1.3 m with the
    Coriolis force as a field is compared with its equations of motion, integrated by Dormand-Prince 8(5,3). A torque
    times its time must be the angular momentum that a free disk gets.
    """
    hz = 60
    for mode in MODES:
        worst = 0.0
        for turn in (0.01, 0.3, 1.0, 3.0):
            system = iota.System(gravity=(0, 0, 0), mode=mode)  # type: ignore[arg-type]
            particle = system.body().particle((0, 0, 0), mass=2, velocity=(1, 0.5, 0))
            system.field("fx = -m*w*vz; fz = m*w*vx", w=turn * hz)
            for _ in range(5 * hz):
                system.step(1 / hz)
            worst = max(worst, abs(math.hypot(*particle.velocity) / math.sqrt(1.25) - 1))
        run.at_most(f"{mode}: change of a speed in a magnetic field, 0.01 to 3 rad a step", worst, 1e-12)
        worst = 0.0
        for drag in (0.1, 10.0, 1e3, 1e6):
            system = iota.System(mode=mode)  # type: ignore[arg-type]
            particle = system.body().particle((0, 0, 0), mass=1)
            system.field("fy = -c*vy", c=drag)
            for _ in range(hz):
                system.step(1 / hz)
            worst = max(worst, abs(particle.velocity.y * drag / GRAVITY / math.expm1(-drag) - 1))
        run.at_most(f"{mode}: relative error of the velocity of a fall with drag", worst, 1e-10)
        system = iota.System(gravity=(0, 0, 0), mode=mode)  # type: ignore[arg-type]
        disk = system.body(shape=iota.Cylinder(0.1, 0.02), mass=1)
        for _ in range(2 * hz):
            disk.apply_torque((0, 0.25, 0))
            system.step(1 / hz)
        run.near(f"{mode}: angular momentum by 0.25 N m in 2 s, kg m2/s", disk.angular_momentum.y, 0.5, 1e-4)
    seconds = run.size(10.0, 2.0)
    truth = integrate(rate_of_the_bob, START, np.array([0.0, seconds]))[-1][:3]
    for mode, order in (("robust", 1), ("energy_keeping", 2)):
        errors = [float(np.linalg.norm(foucault(mode, hz, seconds)[0] - truth)) for hz in (240, 480)]
        run.note(f"{mode}: error of a Foucault pendulum after {seconds:g} s at 480 Hz, m", errors[1])
        run.near(f"{mode}: order of convergence", math.log2(errors[0] / errors[1]), order, 0.15)
    place, told = foucault("accurate", hz, seconds)
    error = float(np.linalg.norm(place - truth))
    run.at_most("accurate: error of the pendulum at 60 Hz, m", error, 1e-6)
    run.at_most("accurate: the same, over what it estimates", error / told, 2)
