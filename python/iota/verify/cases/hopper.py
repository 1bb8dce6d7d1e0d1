# SPDX-License-Identifier: Apache-2.0
"""Balls that run out of a bin through a hole: their rate against Beverloo's law."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

import iota
from iota.verify.reference import GRAVITY as G
from iota.verify.reference import Array
from iota.verify.run import Run

DIAMETER, DENSITY = 0.02, 1000.0  # of the balls, m, kg/m^3; their sizes differ by 10 %
EMPTY = 1.5  # diameters by which the hole is narrower for centers of balls (Beverloo's k)
DT = 1 / 120
BEGIN = 0.25  # s, after which the flow is steady


def hopper(run: Run) -> None:
    """Hopper.

    Balls lie in a bin, and run out through a round hole in its floor. Unlike water they do so at a rate that does not depend on how
    high they lie, W = C rho sqrt(g) (D - k d)^2.5 with the width D of the hole, the diameter d of the balls and the density rho of
    the heap (Beverloo, Leniger and van de Velde 1961; k about 1.5 for balls, C about 0.58, less with friction). The heaps are solved
    by sweeps. Balls are counted by their places.
    """
    widths = run.size((6.0, 7.0, 8.0, 9.0), (5.0,))
    count, side = run.size((3000, 14), (350, 8))
    flows = []
    for k, width in enumerate(widths):
        flows.append(Flow(width, count, side, run.size(1.6, 0.7)))
        run.progress((k + 1) / len(widths))
    rates = np.array([flow.rate() for flow in flows])
    wide = np.array(widths) - EMPTY
    if len(widths) > 1:
        exponent = float(np.polyfit(np.log(wide), np.log(rates), 1)[0])
        run.near("exponent of the rate by D - 1.5 d", exponent, 2.5, 0.1)
    for flow, rate, free in zip(flows, rates, wide, strict=True):
        known = flow.bulk * math.sqrt(G) * (free * DIAMETER) ** 2.5
        run.near(f"D = {flow.width:g} d: C", rate / known, 0.55, run.size(0.1, 0.15))
        if run.scale != "quick":
            late, early = flow.rate(second=True), flow.rate(second=False)
            run.near(f"D = {flow.width:g} d: rate from half the height, of that before", late / early, 1, 0.15)
    run.at_most("deepest overlap, of a diameter", max(flow.overlap for flow in flows), 0.05)
    run.at_most("balls that left the bin by another way", max(flow.lost for flow in flows), 0)

    def draw(figure: Any) -> None:
        axes = figure.subplots()
        line = np.linspace(0.9 * wide.min(), 1.1 * wide.max(), 50)
        scale = flows[0].bulk * math.sqrt(G) * DIAMETER**2.5
        axes.loglog(line, 0.5 * scale * line**2.5, lw=1, label="Beverloo, C = 0.5")
        axes.loglog(wide, rates, "o", ms=4, label="balls")
        axes.set(xlabel="(D - 1.5 d) / d", ylabel="rate, kg/s")
        axes.legend(fontsize=7)

    run.picture("hopper", "The rate at which balls run out by the width of the hole.", draw, size=(5, 3))


@dataclass
class Flow:
    """width: of the hole, side: of the bin, both in diameters. seconds: that are watched, or until half of the balls are out."""

    width: float
    count: int
    side: int
    seconds: float

    def __post_init__(self) -> None:
        self.system = iota.System()
        self.system.usual_material = iota.Material(friction=0.5)
        self.system.budget_contacts = 1
        self.system.rest_after = 1e9
        plug = self._bin()
        self._fill()
        for _ in range(round(0.5 / DT)):
            self.system.step(DT)
        self.bulk = self._bulk_density()
        plug.destroy()
        self.out, self.overlap = [0.0], 0.0
        strays = np.zeros(self.count, dtype=bool)
        while len(self.out) * DT < self.seconds and self.out[-1] < 0.5 * self.masses.sum():
            self.overlap = max(self.overlap, self.system.step(DT).worst_gap / DIAMETER)
            self.out.append(float(self.masses[self._heights() < -DIAMETER].sum()))
            strays |= self._strays()
        self.lost = int(strays.sum())

    def rate(self, second: bool | None = None) -> float:
        """In kg/s; of the first or second half of the time."""
        begin, end = round(BEGIN / DT), len(self.out) - 1
        middle = (begin + end) // 2
        begin, end = (begin, end) if second is None else (middle, end) if second else (begin, middle)
        return (self.out[end] - self.out[begin]) / ((end - begin) * DT)

    def _heights(self) -> Array:
        return np.asarray(self.balls.positions[:, 1])

    def _strays(self) -> NDArray[np.bool_]:
        """Which are beyond a wall, or just below the floor and beside the hole."""
        x, y, z = self.balls.positions.T / DIAMETER
        beyond = (y > -1) & (np.maximum(abs(x), abs(z)) > self.side / 2)
        return np.asarray(beyond | ((y > -2.5) & (y < -1) & (np.hypot(x, z) > self.width / 2 + 1)))

    def _bulk_density(self) -> float:
        """Between a diameter above the floor and the upper third."""
        heights = self._heights()
        low, high = 1.5 * DIAMETER, 2 / 3 * float(heights.max())
        within = self.masses[(heights > low) & (heights < high)].sum()
        return float(within / ((self.side * DIAMETER) ** 2 * (high - low)))

    def _bin(self) -> iota.Body:
        """Walls, a floor with a hole, and what closes it."""
        side, wall, high = self.side * DIAMETER, 2 * DIAMETER, 6 * self.count / self.side**2 * DIAMETER
        places, triangles = _plate(self.width * DIAMETER / 2, side + 2 * wall, DIAMETER)
        self.system.obstacle(iota.Mesh(places, triangles))
        for x, z in ((1, 0), (-1, 0), (0, 1), (0, -1)):
            size = (wall if x else side + 2 * wall, high, wall if z else side + 2 * wall)
            off = (side + wall) / 2
            self.system.obstacle(iota.Box(size), (x * off, high / 2, z * off))
        size = ((self.width + 1) * DIAMETER, DIAMETER, (self.width + 1) * DIAMETER)
        return self.system.obstacle(iota.Box(size), (0, -DIAMETER / 2, 0))

    def _fill(self) -> None:
        """Layers of balls whose sizes and places are a little uneven."""
        dice = np.random.default_rng(1)
        row = self.side - 1
        pitch = self.side / row * DIAMETER
        bodies = []
        for k in range(self.count):
            layer, i = divmod(k, row * row)
            place = np.array([i % row - (row - 1) / 2, 0.6 + 1.1 * layer, i // row - (row - 1) / 2]) * pitch
            place += dice.uniform(-0.02, 0.02, 3) * DIAMETER
            radius = DIAMETER / 2 * dice.uniform(0.9, 1.1)
            bodies.append(self.system.body(shape=iota.Sphere(radius), density=DENSITY, position=tuple(place)))
        self.balls = self.system.array(bodies)
        self.masses = np.array([body.mass for body in bodies])


def _plate(radius: float, side: float, thick: float, corners: int = 32) -> tuple[Array, NDArray[np.int64]]:
    """A square plate with a round hole; its upper face is at the height 0."""
    angles = 2 * math.pi * np.arange(corners) / corners
    ring = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    square = side / 2 * ring / np.abs(ring).max(axis=1, keepdims=True)
    flat = np.concatenate([radius * ring, square])
    upper, lower = (np.insert(flat, 1, height, axis=1) for height in (0.0, -thick))
    triangles = []
    for k in range(corners):
        inner, outer, low = np.array([k, (k + 1) % corners]), np.array([k, (k + 1) % corners]) + corners, 2 * corners
        quads = (
            (inner[0], inner[1], outer[1], outer[0]),
            (low + inner[1], low + inner[0], low + outer[0], low + outer[1]),
            (inner[1], inner[0], low + inner[0], low + inner[1]),
            (outer[0], outer[1], low + outer[1], low + outer[0]),
        )
        triangles += [(a, b, c) for a, b, c, _ in quads] + [(a, c, d) for a, _, c, d in quads]
    return np.concatenate([upper, lower]), np.array(triangles)
