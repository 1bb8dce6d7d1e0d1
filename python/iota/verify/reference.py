# SPDX-License-Identifier: Apache-2.0
"""Independent solvers, by SciPy: minimal coordinates and a high-order ODE solver for exact motions, MINPACK's hybrid
method for the equations of one step. They share no code with the engine."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp
from scipy.optimize import fsolve

Array = NDArray[Any]
Path = Callable[[float], tuple[Array, Array, Array]]  # time -> position, velocity, acceleration of shape (2,)

GRAVITY = 9.81


def integrate(rate: Callable[[float, Array], Array], start: Sequence[float] | Array, times: Array) -> Array:
    """y(times) of y' = rate(t, y), y(times[0]) = start: shape (len(times), len(start)). Dormand-Prince 8(5,3), 1e-13."""
    solution = solve_ivp(
        rate, (times[0], times[-1]), start, method="DOP853", t_eval=times, rtol=1e-13, atol=1e-13, max_step=np.inf
    )
    if not solution.success:
        raise ArithmeticError(f"the reference solver stopped: {solution.message}")
    return np.asarray(solution.y.T)


def cross(a: Array, b: Array) -> Array:
    """The product of two vectors of three numbers, much faster than NumPy's."""
    return np.array([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]])


def still(position: Sequence[float]) -> Path:
    zero = np.zeros(2)
    place = np.array(position, dtype=float)
    return lambda _: (place, zero, zero)


@dataclass
class PlanarChain:
    """Point masses on massless rods, each hanging from the one above, in a vertical plane, in angles from straight
    down.

    lengths: (n,) m. masses: (n,) kg, at the lower end of each rod. pivot: the place of the first one's upper end.
    damping: 1/s, a force -damping m v on each mass. Lagrange's equations of the n-fold pendulum.
    """

    lengths: Array
    masses: Array
    pivot: Path
    damping: float = 0.0

    def __post_init__(self) -> None:
        below = np.cumsum(self.masses[::-1])[::-1]
        order = np.arange(len(self.lengths))
        self.coupling = np.outer(self.lengths, self.lengths) * below[np.maximum.outer(order, order)]
        self.pull = below * self.lengths

    def rate(self, time: float, state: Array) -> Array:
        angle, spin = np.split(state, 2)
        turn = angle[:, None] - angle[None, :]
        ax, ay = self.pivot(time)[2]
        inertia = self.coupling * np.cos(turn)
        force = -(self.coupling * np.sin(turn)) @ spin**2
        force -= self.pull * ((GRAVITY + ay) * np.sin(angle) + ax * np.cos(angle))
        force -= self.damping * (inertia @ spin)
        return np.concatenate([spin, np.linalg.solve(inertia, force)])

    def places(self, times: Array, angles: Sequence[float] | Array, spins: Sequence[float] | Array) -> Array:
        """The places of all masses at all times, from the state at times[0]: (len(times), n, 2), m."""
        states = integrate(self.rate, np.concatenate([angles, spins]), times)
        angle = states[:, : len(self.lengths)]
        steps = np.stack([self.lengths * np.sin(angle), -self.lengths * np.cos(angle)], axis=-1)
        hung = np.array([self.pivot(float(t))[0] for t in times])
        return np.asarray(hung[:, None, :] + np.cumsum(steps, axis=1))


@dataclass
class StepByFsolve:
    """The equations of one step of a hanging chain of point masses, solved by MINPACK's hybrid method.

    a M (x1 - x0 - h v0) - M g + G' lambda = 0 and |d|^2 = L^2 for each link, in 3-D, unknowns the n points and n
    multipliers: 24 for six links, as in the thesis. midpoint: the energy-keeping scheme; otherwise backward Euler.
    If the pivot's mean velocity differs from that of the previous step, velocities are first projected by the least
    impulses along the links, as iota does. If it rests, a mid-point step ends with such a projection too, and what that
    takes of the kinetic energy is given back by scaling velocities relative to the rigid rotation about the pivot.
    """

    lengths: Array
    masses: Array
    position: Array  # (n, 3)
    velocity: Array
    midpoint: bool = True
    damping: float = 0.0

    def __post_init__(self) -> None:
        self.multipliers = np.zeros(len(self.lengths))
        self.pivot_velocity = np.zeros(3)
        self.failures = 0

    def follow(self, pivot: Array, velocity: Array) -> None:
        """Projects velocities on the links when the pivot, at `pivot`, starts to move with `velocity`."""
        if np.linalg.norm(velocity - self.pivot_velocity) > 1e-9:
            self.project(pivot, velocity)
        self.pivot_velocity = velocity

    def project(self, pivot: Array, velocity: Array) -> None:
        links = np.diff(np.vstack([pivot, self.position]), axis=0) / self.lengths[:, None]
        n = len(links)
        rows = np.zeros((n, n, 3))
        rows[np.arange(n), np.arange(n)] = links
        rows[np.arange(1, n), np.arange(n - 1)] = -links[1:]
        rate = np.einsum("ijk,jk->i", rows, self.velocity)
        rate[0] -= links[0] @ velocity
        impulses = np.linalg.solve(np.einsum("ijk,ljk,j->il", rows, rows, 1 / self.masses), rate)
        self.velocity = self.velocity - np.einsum("ijk,i->jk", rows, impulses) / self.masses[:, None]

    def rotation_about(self, pivot: Array) -> Array:
        """Velocities (n, 3) of the rigid rotation about the pivot with the chain's angular momentum."""
        arms = self.position - pivot
        inertia = np.einsum("i,ij,ij->", self.masses, arms, arms) * np.eye(3) - np.einsum(
            "i,ij,ik->jk", self.masses, arms, arms
        )
        return np.cross(np.linalg.solve(inertia, self.masses @ np.cross(arms, self.velocity)), arms)

    def step(self, h: float, pivot_before: Array, pivot: Array) -> None:
        n = len(self.lengths)
        a = (2 if self.midpoint else 1) / h**2
        self.follow(pivot_before, (pivot - pivot_before) / h)
        start = self.position + h * self.velocity
        before = np.diff(np.vstack([pivot_before, self.position]), axis=0)
        fall = np.array([0, -GRAVITY, 0]) / a

        def links(x: Array) -> Array:
            return np.diff(np.vstack([pivot, x]), axis=0)

        def residual(z: Array) -> Array:
            x, multiplier = z[: 3 * n].reshape(n, 3), z[3 * n :]
            now = links(x)
            along = ((before + now) / 2 if self.midpoint else now) / self.lengths[:, None]
            pull = multiplier[:, None] * along  # of link i on its lower end
            force = pull.copy()
            force[:-1] -= pull[1:]
            motion = x - start - fall + force / (a * self.masses[:, None])
            gap = (np.einsum("ij,ij->i", now, now) - self.lengths**2) / (2 * self.lengths)
            return np.concatenate([motion.ravel(), gap])

        def jacobian(z: Array) -> Array:
            x, multiplier = z[: 3 * n].reshape(n, 3), z[3 * n :]
            now = links(x)
            along = ((before + now) / 2 if self.midpoint else now) / self.lengths[:, None]
            stiff = multiplier / self.lengths * (0.5 if self.midpoint else 1.0)
            out = np.eye(4 * n)
            out[3 * n :, 3 * n :] = 0
            for i in range(n):
                for end, sign in ((i, 1.0), (i - 1, -1.0)):
                    if end < 0:
                        continue
                    weight = sign / (a * self.masses[end])
                    rows = slice(3 * end, 3 * end + 3)
                    out[rows, 3 * n + i] += weight * along[i]
                    out[rows, 3 * i : 3 * i + 3] += weight * stiff[i] * np.eye(3)
                    if i > 0:
                        out[rows, 3 * i - 3 : 3 * i] -= weight * stiff[i] * np.eye(3)
                out[3 * n + i, 3 * i : 3 * i + 3] = now[i] / self.lengths[i]
                if i > 0:
                    out[3 * n + i, 3 * i - 3 : 3 * i] = -now[i] / self.lengths[i]
            return out

        guess = np.concatenate([start.ravel(), self.multipliers])
        solution, details, _, _ = fsolve(residual, guess, fprime=jacobian, xtol=1e-15, full_output=True)
        if not np.abs(details["fvec"]).max() < 1e-9 * self.lengths.max():
            self.failures += 1
        x = solution[: 3 * n].reshape(n, 3)
        self.multipliers = solution[3 * n :]
        moved = x - self.position
        self.position = x
        self.velocity = 2 * moved / h - self.velocity if self.midpoint else moved / h
        if self.midpoint and not self.pivot_velocity.any():
            kinetic = self.masses @ np.sum(self.velocity**2, axis=1)
            self.project(pivot, self.pivot_velocity)
            rigid = self.rotation_about(pivot)
            rest = self.velocity - rigid
            shared = self.masses @ np.sum(rigid**2, axis=1)
            self.velocity = rigid + rest * np.sqrt((kinetic - shared) / (self.masses @ np.sum(rest**2, axis=1)))
        self.velocity = self.velocity * np.exp(-self.damping * h)
