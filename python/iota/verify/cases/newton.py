# SPDX-License-Identifier: Apache-2.0
"""Newton's method alone, and the failures of the thesis' solver."""

from __future__ import annotations

from typing import Any

import numpy as np

import iota
from iota.verify import scenes
from iota.verify.reference import GRAVITY, Array
from iota.verify.run import Run


def newton_fractal(run: Run) -> None:
    """Newton fractal (Fig. 4.18).

    Iterations that Newton's method needs for z^3 = 1 from each point of the plane: plain steps z - (z^3 - 1)/(3 z^2)
    give the thesis' picture and are the reference for a solver with a line search. iota.solve, from a grid of the same
    points, always ends at a root and in fewer steps.
    """
    side = run.size(600, 120)
    x = np.linspace(-1.5, 1.5, side)
    z = x[None, :] + 1j * x[:, None]
    roots = np.exp(2j * np.pi * np.arange(3) / 3)
    count = np.zeros(z.shape, int)
    for step in range(60):
        going = np.abs(z**3 - 1) > 1e-10
        count += going
        with np.errstate(divide="ignore", invalid="ignore"):
            z = np.where(going, z - (z**3 - 1) / (3 * z**2), z)
        run.progress(0.2 * step / 60)
    nearest = np.argmin(np.abs(z[..., None] - roots), axis=-1)
    distance = np.abs(z - roots[nearest])
    run.at_least("plain steps: share of points at a root after 60", float((distance < 1e-8).mean()), 0.999)
    run.near("plain steps: share of the upper half that goes to exp(2 pi i/3), of the lower to its mirror",
             float((nearest[side // 2 :] == 1).mean()), float((nearest[: side // 2] == 2).mean()), 1e-3)  # fmt: skip
    run.at_least("plain steps: most", int(count.max()), 15)

    def cube(p: Array) -> Array:
        value = complex(p[0], p[1]) ** 3 - 1
        return np.array([value.real, value.imag])

    def slope(p: Array) -> Array:
        value = 3 * complex(p[0], p[1]) ** 2
        return np.array([[value.real, -value.imag], [value.imag, value.real]])

    coarse = np.linspace(-1.5, 1.5, run.size(150, 30))
    ours = np.zeros((len(coarse), len(coarse)), int)
    farthest = 0.0
    for row, imaginary in enumerate(coarse):
        for column, real in enumerate(coarse):
            found = iota.solve(cube, [real, imaginary], slope)
            farthest = max(farthest, float(np.abs(complex(*found.x) - roots).min()))
            ours[row, column] = found.iterations
        run.progress(0.2 + 0.8 * row / len(coarse))
    run.at_most("iota.solve: farthest from a root", farthest, 1e-8)
    run.at_most("iota.solve: most iterations", int(ours.max()), 30)

    def draw(figure: Any) -> None:
        left, right = figure.subplots(1, 2)
        for axes, counts, title in ((left, count, "plain steps"), (right, ours, "iota.solve")):
            shown = axes.imshow(
                np.minimum(counts, 24), extent=(-1.5, 1.5, -1.5, 1.5), origin="lower", cmap="turbo", vmin=0
            )
            axes.plot(roots.real, roots.imag, "w+", ms=6)
            axes.set(xlabel="Re z", ylabel="Im z", title=title)
            axes.grid(False)
        figure.colorbar(shown, ax=(left, right), label="iterations", shrink=0.8)

    run.picture("newton-fractal", "Iterations for z³ = 1 from each point.", draw, size=(8, 3.6), raster=True)


class ThesisChain:
    """The thesis' scheme for a chain of two-point links (section 4.3.2): each body has a velocity and an angular velocity;
    the unknowns are the forces at the hinges that make the particles of each hinge coincide after the step.

    P += h V,  p += R(h w) applied to the arm; hinge forces act at the arms at the start of the step
    (Equation 4.3), so torques are explicit. Solved by Newton's method with a backtracking line search from the forces of
    the last step, as its appendix C.4. Units are ours (seconds), c = 1.
    """

    def __init__(self, points: Array, link_mass: float) -> None:
        self.mass = link_mass
        self.center = (points[1:] + points[:-1]) / 2
        self.arm = (points[1:] - points[:-1]) / 2  # to the lower end; the upper one is its opposite
        self.velocity = np.zeros_like(self.center)
        self.spin = np.zeros_like(self.center)
        self.nail = points[0].copy()
        self.force = np.zeros_like(self.center)  # of hinge i on link i at its upper end

    def moved(self, force: Array, h: float) -> tuple[Array, Array, Array, Array]:
        """Velocity, spin, center and arm of each link after a step under hinge forces (..., n, 3)."""
        pull = force.copy()
        pull[..., :-1, :] -= force[..., 1:, :]
        velocity = self.velocity + h * (pull / self.mass - np.array([0, GRAVITY, 0]))
        inertia = self.mass * np.einsum("ij,ij->i", self.arm, self.arm)
        both = force.copy()  # torque of both ends: -arm x force - arm x below
        both[..., :-1, :] += force[..., 1:, :]
        spin = self.spin - h * np.cross(self.arm, both) / inertia[:, None]
        angle = h * np.linalg.norm(spin, axis=-1, keepdims=True)
        axis = np.divide(h * spin, angle, out=np.zeros_like(spin), where=angle > 0)
        turned = self.arm * np.cos(angle) + np.cross(axis, self.arm) * np.sin(angle)
        turned += axis * np.sum(axis * self.arm, axis=-1, keepdims=True) * (1 - np.cos(angle))
        return velocity, spin, self.center + h * velocity, turned

    def mismatch(self, force: Array, h: float) -> Array:
        """Upper end of each link minus the lower end of the one above, (..., 3 n), m."""
        _, _, center, arm = self.moved(force, h)
        apart = center - arm
        apart[..., 0, :] -= self.nail
        apart[..., 1:, :] -= (center + arm)[..., :-1, :]
        return apart.reshape(*apart.shape[:-2], -1)

    def step(self, h: float) -> bool:
        """True if the hinges could be met to 1e-6 of a link."""
        tolerance = 1e-6 * 2 * float(np.linalg.norm(self.arm[0]))
        force = self.force.ravel().copy()
        size = force.size
        residual = self.mismatch(force.reshape(-1, 3), h)
        solved = False
        for _ in range(60):
            if np.abs(residual).max() < tolerance:
                solved = True
                break
            nudge = 1e-6 * max(1.0, float(np.abs(force).max()))
            shifted = (force + nudge * np.eye(size)).reshape(size, -1, 3)
            jacobian = ((self.mismatch(shifted, h) - residual) / nudge).T
            try:
                direction = -np.linalg.solve(jacobian, residual)
            except np.linalg.LinAlgError:
                break
            length = 1.0
            while length > 1e-3:
                trial = self.mismatch((force + length * direction).reshape(-1, 3), h)
                if np.linalg.norm(trial) < (1 - 1e-4 * length) * np.linalg.norm(residual):
                    break
                length /= 2
            else:
                break
            force, residual = force + length * direction, trial
        self.force = force.reshape(-1, 3)
        self.velocity, self.spin, self.center, self.arm = self.moved(self.force, h)
        return solved


def failure_rate(run: Run) -> None:
    """Failure rate against the length of a chain.

    Chains of 2.4 m in 1 to 16 links, released about level at 1/60 s for four seconds, several starts each. The number
    of runs with a step that cannot be solved: by the thesis' scheme, reimplemented from its section 4.3.2, and by iota
    in both modes. In the thesis failures began at eight links.
    """
    counts = run.size([1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 12, 14, 16], [2, 12])
    starts, seconds, h = run.size(10, 1), run.size(4.0, 2.5), 1 / 60
    theirs, ours = [], {"robust": 0, "energy_keeping": 0}
    for index, links in enumerate(counts):
        failed = 0
        for seed in range(starts):
            angles = np.pi / 2 + np.random.default_rng(100 * links + seed).uniform(-0.05, 0.05, links)
            points = scenes.hanging_points((0, 0), [2.4 / links] * links, angles)
            chain = ThesisChain(points, 1.2 / links)
            failed += not all(chain.step(h) for _ in range(round(seconds / h)))
            for mode in ours:
                system = iota.System(mode=mode)  # type: ignore[arg-type]
                scenes.string_of_links(system, points, link_mass=1.2 / links)
                ours[mode] += sum(system.step(h).unconverged for _ in range(round(seconds / h))) > 0
            run.progress((index + (seed + 1) / starts) / len(counts))
        theirs.append(failed / starts)
    run.note("runs of each scheme", len(counts) * starts)
    run.at_most("thesis' scheme: failed runs of the shortest chain", theirs[0], 0)
    first = next((n for n, share in zip(counts, theirs, strict=True) if share > 0), None)
    run.note("thesis' scheme: fails from this many links", first if first is not None else "none failed")
    run.at_least("thesis' scheme: share of runs that fail with the most links", theirs[-1], 0.5)
    for mode, count in ours.items():
        run.at_most(f"iota, {mode}: failed runs", count, 0)

    def draw(figure: Any) -> None:
        axes = figure.subplots()
        axes.plot(counts, 100 * np.array(theirs), "o-", ms=4, label="thesis' scheme")
        axes.plot(counts, np.zeros(len(counts)), "o-", ms=3, label="iota, both modes")
        axes.set(xlabel="links", ylabel="runs with a failed step, %", ylim=(-3, 103))
        axes.legend(fontsize=7)

    run.picture("failure-rate", "Runs in which a step could not be solved.", draw, size=(5, 3.2))
