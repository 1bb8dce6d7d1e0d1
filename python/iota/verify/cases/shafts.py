# SPDX-License-Identifier: Apache-2.0
"""Fast shafts, and motors at their bounds."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

import iota
from iota.verify.reference import Array, integrate
from iota.verify.run import Run

HZ = 60
ACROSS = (0, math.sqrt(0.5), 0, math.sqrt(0.5))  # turns a cylinder's axis from x to z
LEAD = 0.01  # m a turn
CRANK, ROD, TORQUE = 0.2, 0.6, 2.0  # m, m, N m


def _system(mode: str) -> iota.System:
    return iota.System(gravity=(0, 0, 0), mode=mode)  # type: ignore[arg-type]


def _disc(system: iota.System, x: float, speed: float) -> iota.Body:
    disc = system.body(shape=iota.Cylinder(0.2, 0.1), mass=1, position=(x, 0, 0), orientation=ACROSS)
    disc.angular_velocity = (0, 0, speed)
    return disc


def _attitude(body: iota.Body) -> float:
    """The angle of its y axis about z, by its orientation, rad; within half a turn."""
    x, y, z, w = body.orientation
    return math.atan2(1 - 2 * (x * x + z * z), 2 * (x * y - w * z))


def _gears(mode: str, turns: float) -> tuple[float, float, float]:
    """Missing parts after a second that begins with so many turns a step: of the turns that a joint counts, of the way of a
    screw, and of the speed of a gear."""
    system = _system(mode)
    speed = 2 * math.pi * turns * HZ
    first, second = (_disc(system, x, part * speed) for x, part in ((0, 1), (1, -0.5)))
    joints = [system.revolute(disc, at=disc.position, axis=(0, 0, 1)) for disc in (first, second)]
    system.gear(joints[0], joints[1], -0.5)
    nut = _disc(system, 2, speed)
    system.screw(nut, at=(2, 0, 0), axis=(0, 0, 1), lead=LEAD)
    nut.velocity = (0, 0, LEAD * turns * HZ)
    for _ in range(HZ):
        system.step(1 / HZ)
    counted = joints[0].angle.value / speed - 1
    slid = nut.position.z / (LEAD * turns * HZ) - 1
    before, short = _attitude(second), 0.1 / speed
    system.step(short)
    now = math.remainder(_attitude(second) - before, 2 * math.pi) / short
    return abs(counted), abs(slid), abs(now / (-0.5 * speed) - 1)


def fast_shafts(run: Run) -> None:
    """Fast shafts.

    Two wheels that are geared 2 : 1 and a nut on a screw turn for a second at up to ten turns a step of 1/60 s. Speed and way
    are found from places and attitudes alone; what joints count must be what the bodies turn. Energy-keeping mode turns a body
    by 2 atan(w h / 2) in a sub-step of h, up to 0.1 less than w h for the 1.1 rad that it allows.
    """
    turns = run.size([0.1, 0.3, 0.7, 1.5, 3.0, 10.0], [0.3, 1.5])
    found: dict[str, list[tuple[float, float, float]]] = {}
    for mode, most, close in (("energy_keeping", 1.0, 0.1), ("accurate", 10.0, 1e-4)):
        for number in turns:
            missing = _gears(mode, number)
            found.setdefault(mode, []).append(missing)
            name = f"{mode}, {number:g} turns a step"
            if number > most:
                run.note(f"{name}: part of the turns that is not counted", missing[0])
                continue
            run.at_most(f"{name}: part of the turns that is not counted", missing[0], close)
            run.at_most(f"{name}: part of the screw's way that is missing", missing[1], close)
            run.at_most(f"{name}: part of the speed that a gear loses", missing[2], 1e-2)
        run.progress(len(found) / 3)
    for number in turns:
        system = _system("robust")
        wheel = _disc(system, 0, 2 * math.pi * number * HZ)
        system.revolute(wheel, at=(0, 0, 0), axis=(0, 0, 1))
        worst = 0.0
        for _ in range(HZ):
            before = _attitude(wheel)
            system.step(1 / HZ)
            says = wheel.angular_velocity.z / HZ
            worst = max(worst, abs(math.remainder(_attitude(wheel) - before - says, 2 * math.pi)) / abs(says))
        run.at_most(f"robust, {number:g} turns a step: what a wheel says beyond its turn, part", worst, 1e-3)

    def draw(figure: Any) -> None:
        axes = figure.subplots()
        for mode, list_of_errors in found.items():
            axes.loglog(turns, [max(error[0], 1e-16) for error in list_of_errors], "o-", ms=4, label=mode)
        axes.set(xlabel="turns a step at the start", ylabel="part of the turns not counted")
        axes.legend(fontsize=7)

    run.picture("fast-shafts", "What is missing of the turns of a gear after a second.", draw, size=(5, 3.4))


def _inertia(angle: float) -> float:
    """Twice the kinetic energy of crank, rod and slider at 1 rad/s of the crank, kg m^2, by its angle."""
    c, s = math.cos(angle), math.sin(angle)
    lean = CRANK * s / ROD  # sine of the rod's angle
    across = math.sqrt(1 - lean * lean)
    turning = CRANK * c / (ROD * across)  # of the rod, a rad of the crank
    slide = -CRANK * s - CRANK * lean * c / across
    middle = (-CRANK * s + slide) / 2, CRANK * c / 2
    of_crank, of_rod = (length**2 + 0.05**2 for length in (CRANK, ROD))
    crank = of_crank / 12 + CRANK**2 / 4
    return crank + middle[0] ** 2 + middle[1] ** 2 + of_rod / 12 * turning**2 + slide**2


def _crank(mode: str, hz: int, seconds: float) -> tuple[list[float], float]:
    """Angles of the crank by its attitude, rad, one a step; and the kinetic energy at the end, J."""
    system = _system(mode)
    shaft = system.body(shape=iota.Box((CRANK, 0.05, 0.05)), mass=1, position=(CRANK / 2, 0, 0))
    rod = system.body(shape=iota.Box((ROD, 0.05, 0.05)), mass=1, position=(CRANK + ROD / 2, 0, 0))
    slider = system.body(shape=iota.Box((0.1, 0.1, 0.1)), mass=1, position=(CRANK + ROD, 0, 0))
    motor = system.revolute(shaft, at=(0, 0, 0), axis=(0, 0, 1))
    system.revolute(rod, shaft, at=(CRANK, 0, 0), axis=(0, 0, 1))
    system.revolute(slider, rod, at=(CRANK + ROD, 0, 0), axis=(0, 0, 1))
    system.prismatic(slider, at=(CRANK + ROD, 0, 0), axis=(1, 0, 0))
    motor.angle.value = 0.5
    motor.angle.motor = (1e6, TORQUE)  # a speed that it never has
    angles, before = [0.5], _attitude(shaft)
    for _ in range(round(seconds * hz)):
        system.step(1 / hz)
        now = _attitude(shaft)
        # Within half a turn of that of the speed.
        step = shaft.angular_velocity.z / hz
        angles.append(angles[-1] + step + math.remainder(now - before - step, 2 * math.pi))
        before = now
    parts = (shaft, rod, slider)
    kinetic = sum(
        0.5 * b.mass * b.velocity.dot(b.velocity) + 0.5 * b.angular_velocity.dot(b.angular_momentum) for b in parts
    )
    return angles, kinetic


def motors(run: Run) -> None:
    """Motors at their bounds.

    A motor of 2 N m that never reaches its speed drives a slider-crank of three boxes of 1 kg, crank 0.2 m, rod 0.6 m. The
    kinetic energy, by velocities, must be torque times the angle that the crank has turned, and the angle that of Lagrange's
    equation for the one coordinate, integrated to 1e-13. Between two free wheels such a motor must give both the angular
    momentum torque times time.
    """
    seconds = run.size(3.0, 1.0)

    def rate(_: float, state: Array) -> Array:
        angle, speed = state
        bend = (_inertia(angle + 1e-5) - _inertia(angle - 1e-5)) / 2e-5
        return np.array([speed, (TORQUE - 0.5 * bend * speed * speed) / _inertia(angle)])

    times = np.linspace(0, seconds, round(seconds * HZ) + 1)
    truth = integrate(rate, [0.5, 0.0], times)[:, 0]
    rates = run.size((60, 120, 240, 480), (240, 480))
    errors: list[float] = []
    shown: list[float] = []
    for hz in rates:
        angles, kinetic = _crank("energy_keeping", hz, seconds)
        errors.append(abs(angles[-1] - truth[-1]))
        shown = shown or angles[:: hz // HZ]
        work = TORQUE * (angles[-1] - 0.5)
        run.at_most(f"energy_keeping, 1/{hz} s: energy over torque times angle, from 1", abs(kinetic / work - 1), 1e-9)
        run.progress(len(errors) / (len(rates) + 1))
    run.note(f"angle of the crank after {seconds:g} s, rad", float(truth[-1]))
    run.note(f"energy_keeping: error of the angle at 1/{rates[-1]} s, rad", errors[-1])
    run.at_least("energy_keeping: order of convergence", math.log2(errors[-2] / errors[-1]), 1.85)
    angles, kinetic = _crank("accurate", HZ, seconds)
    work = TORQUE * (angles[-1] - 0.5)
    run.at_most("accurate, 1/60 s: energy over torque times angle, from 1", abs(kinetic / work - 1), 1e-6)
    run.at_most("accurate, 1/60 s: error of the angle, rad", abs(angles[-1] - truth[-1]), 1e-3)
    for mode in ("plausible", "robust", "energy_keeping", "accurate"):
        system = _system(mode)
        pair = [_disc(system, 0, 0), _disc(system, 0, 0)]
        pair[1].set_pose((0, 0, 0.3), ACROSS)
        motor = system.revolute(pair[1], pair[0], at=(0, 0, 0.15), axis=(0, 0, 1))
        motor.angle.motor = (1e6, 0.05)
        for _ in range(2 * HZ):
            system.step(1 / HZ)
        missing = max(abs(abs(disc.angular_momentum.z) / 0.1 - 1) for disc in pair)
        run.at_most(f"{mode}: part of torque times time that two wheels miss", missing, 1e-3)

    def draw(figure: Any) -> None:
        axes = figure.subplots()
        axes.plot(times, truth, "k", lw=0.8, label="Lagrange's equation")
        axes.plot(times, shown, ".", ms=2.5, label=f"energy_keeping, 1/{rates[0]} s")
        axes.set(xlabel="time, s", ylabel="angle of the crank, rad")
        axes.legend(fontsize=7)

    run.picture("motors", "A slider-crank that a motor at its largest torque drives.", draw, size=(5, 3.2))
