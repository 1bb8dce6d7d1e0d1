# SPDX-License-Identifier: Apache-2.0
"""Rigid bodies on ball hinges with springs, by SciPy: Newton's and Euler's equations in maximal coordinates, rows at the
level of accelerations, Dormand and Prince's rule of eighth order. No code of the engine."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from iota.shapelib.frames import from_quaternion
from iota.verify.reference import GRAVITY, integrate

Array = NDArray[Any]
Point = tuple[int, Array]  # a body, and a place in its frame, m


def cross_matrix(v: Array) -> Array:
    return np.array([[0, -v[2], v[1]], [v[2], 0, -v[0]], [-v[1], v[0], 0]])


@dataclass
class Solid:
    mass: float
    inertia: Array  # principal moments in its frame, kg m^2
    position: Array  # of its center of mass
    orientation: Array  # x, y, z, w
    velocity: Array
    spin: Array  # world axes

    def state(self) -> Array:
        return np.concatenate([self.position, self.orientation, self.velocity, self.spin])


@dataclass
class RigidReference:
    solids: list[Solid] = field(default_factory=list)
    hinges: list[tuple[Point, Point]] = field(default_factory=list)
    nails: list[Point] = field(default_factory=list)
    springs: list[tuple[Point, Point, float, float]] = field(default_factory=list)  # stiffness, N/m; length, m

    def start(self) -> Array:
        return np.concatenate([solid.state() for solid in self.solids])

    def after(self, seconds: float) -> Array:
        """The state, one row of 13 numbers for each solid."""
        states = integrate(self.rate, self.start(), np.array([0.0, seconds]))
        return np.asarray(states[-1].reshape(len(self.solids), 13))

    def rate(self, _: float, state: Array) -> Array:
        rows = state.reshape(len(self.solids), 13)
        mass, force, gradient, centripetal = self.equations(rows)
        acceleration = solve_held(mass, gradient, force, -centripetal)
        change = np.zeros_like(rows)
        for i, row in enumerate(rows):
            x, y, z, w = row[3:7]
            turning = np.array([[w, z, -y], [-z, w, x], [y, -x, w], [-x, -y, -z]])
            change[i, :3] = row[7:10]
            change[i, 3:7] = 0.5 * turning @ row[10:13]
            change[i, 7:13] = acceleration[6 * i : 6 * i + 6]
        return change.ravel()

    def meet_hinges(self) -> None:
        """Changes the velocities by the least kinetic energy that meets all hinges and nails."""
        rows = self.start().reshape(len(self.solids), 13)
        mass, _, gradient, _ = self.equations(rows)
        motion = rows[:, 7:13].ravel()
        motion = motion + solve_held(mass, gradient, np.zeros_like(motion), -gradient @ motion)
        for i, solid in enumerate(self.solids):
            solid.velocity, solid.spin = motion[6 * i : 6 * i + 3], motion[6 * i + 3 : 6 * i + 6]

    def equations(self, rows: Array) -> tuple[Array, Array, Array, Array]:
        """Mass matrix, forces and torques; gradients of the rows, and their accelerations without any of the bodies."""
        turns = [from_quaternion(*row[3:7]) for row in rows]
        count = 6 * len(rows)
        mass, force = np.zeros((count, count)), np.zeros(count)
        for i, (solid, row) in enumerate(zip(self.solids, rows, strict=True)):
            inertia = turns[i] @ np.diag(solid.inertia) @ turns[i].T
            spin = row[10:13]
            mass[6 * i : 6 * i + 3, 6 * i : 6 * i + 3] = solid.mass * np.eye(3)
            mass[6 * i + 3 : 6 * i + 6, 6 * i + 3 : 6 * i + 6] = inertia
            force[6 * i + 1] -= solid.mass * GRAVITY
            force[6 * i + 3 : 6 * i + 6] -= np.cross(spin, inertia @ spin)

        def arm(point: Point) -> Array:
            return np.asarray(turns[point[0]] @ point[1])

        for p, q, stiffness, length in self.springs:
            apart = rows[q[0]][:3] + arm(q) - rows[p[0]][:3] - arm(p)
            tension = stiffness * (np.linalg.norm(apart) - length) * apart / np.linalg.norm(apart)
            for point, pull in ((p, tension), (q, -tension)):
                force[6 * point[0] : 6 * point[0] + 3] += pull
                force[6 * point[0] + 3 : 6 * point[0] + 6] += np.cross(arm(point), pull)

        held: list[list[tuple[Point, float]]] = [[(p, 1.0), (q, -1.0)] for p, q in self.hinges]
        held += [[(p, 1.0)] for p in self.nails]
        gradient, centripetal = np.zeros((3 * len(held), count)), np.zeros(3 * len(held))
        for k, points in enumerate(held):
            for point, sign in points:
                i, r, spin = point[0], arm(point), rows[point[0]][10:13]
                gradient[3 * k : 3 * k + 3, 6 * i : 6 * i + 3] += sign * np.eye(3)
                gradient[3 * k : 3 * k + 3, 6 * i + 3 : 6 * i + 6] -= sign * cross_matrix(r)
                centripetal[3 * k : 3 * k + 3] += sign * np.cross(spin, np.cross(spin, r))
        return mass, force, gradient, centripetal


def solve_held(mass: Array, gradient: Array, force: Array, rate: Array) -> Array:
    """x of mass x + gradient' y = force, gradient x = rate."""
    rows = len(rate)
    whole = np.block([[mass, gradient.T], [gradient, np.zeros((rows, rows))]])
    return np.asarray(np.linalg.solve(whole, np.concatenate([force, rate]))[: len(force)])


def place_of(state: Array, point: Point) -> Array:
    row = state[point[0]]
    return np.asarray(row[:3] + from_quaternion(*row[3:7]) @ point[1])
