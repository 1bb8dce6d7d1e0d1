# SPDX-License-Identifier: Apache-2.0
"""Measurements of an engine on a scene."""

from __future__ import annotations

import math
import time
from dataclasses import asdict, dataclass
from typing import Protocol

import numpy as np
from scene import GRAVITY, LENGTH, WORLD, Array, Scene


@dataclass
class State:
    """Centers (n, 3) m, rotations (n, 3, 3), velocities (n, 3) m/s, spins (n, 3) rad/s in the world's axes."""

    center: Array
    rotation: Array
    velocity: Array
    spin: Array


class Peer(Protocol):
    """One engine with one scene."""

    def advance(self, steps: int) -> None:
        """Simulates `steps` frames."""

    def read(self) -> State:
        """The present state."""

    def trouble(self) -> str:
        """The engine's own warning, or nothing."""


@dataclass
class Row:
    """One measurement; energies are fractions of the largest kinetic energy seen. A link is a body."""

    engine: str
    setting: str
    scene: str
    size: int
    hz: int
    links: int = 0
    us_per_link_step: float = math.nan
    worst_gap_m: float = math.nan
    energy_end: float = math.nan
    energy_gain: float = math.nan
    kinetic_over_available: float = math.nan  # above 1: a gain of energy
    simulated_s: float = 0
    steps: int = 0
    blew_up: str = ""  # reason and time; empty: whole until simulated_s
    note: str = ""

    def as_dict(self) -> dict[str, object]:
        """Ready for strict JSON: numbers that are not finite become null."""
        return {k: None if isinstance(v, float) and not math.isfinite(v) else v for k, v in asdict(self).items()}


class Gaps:
    """The largest distance between two places that a joint should keep together, m."""

    def __init__(self, scene: Scene) -> None:
        self.first, self.second = np.array(scene.joints, dtype=np.intp).T
        self.anchors = scene.anchors()

    def worst(self, state: State) -> float:
        ends = [
            state.center[body] + np.einsum("nij,nj->ni", state.rotation[body], anchor)
            for body, anchor in zip((self.first, self.second), self.anchors, strict=True)
        ]
        ends[0][self.first == WORLD] = self.anchors[0][self.first == WORLD]
        return float(np.max(np.linalg.norm(ends[1] - ends[0], axis=1)))


def energies_of(scene: Scene, state: State) -> tuple[float, float]:
    """Kinetic and potential energy, J."""
    spin = np.einsum("nji,nj->ni", state.rotation, state.spin)
    twice = np.sum(scene.mass * np.sum(state.velocity**2, axis=1)) + np.sum(scene.inertia * spin**2)
    return float(twice / 2), float(GRAVITY * np.sum(scene.mass * state.center[:, 1]))


def measure(scene: Scene, peer: Peer, row: Row, seconds: float, cap: float) -> None:
    """Runs for `seconds` of simulation or `cap` seconds of wall clock and fills the row.

    Energy and gap are measured after each frame; less often if reading the poses takes longer than stepping.
    Time is processor time of this process inside the engine's step only, averaged over all steps.
    """
    total, row.links = round(seconds * row.hz), len(scene.mass)
    gaps, available = Gaps(scene), scene.available()
    began, spent = time.monotonic(), 0
    start = highest = end = sum(energies_of(scene, peer.read()))
    largest, worst, every = 0.0, 0.0, 1
    while row.steps < total and time.monotonic() - began < cap:
        count = min(every, total - row.steps)
        before = time.process_time_ns()
        peer.advance(count)
        took = time.process_time_ns() - before
        spent += took
        row.steps += count
        now = row.steps / row.hz
        with np.errstate(all="ignore"):
            state = peer.read()
            gap, (kinetic, potential) = gaps.worst(state), energies_of(scene, state)
        if time.process_time_ns() - before > 2 * took:
            every += 1
        if complaint := peer.trouble():
            row.blew_up = row.blew_up or f"{complaint} at {now:.2f} s"
        if not math.isfinite(gap + kinetic + potential):
            row.blew_up = row.blew_up or f"not a number at {now:.2f} s"
            break
        end = kinetic + potential
        highest, largest, worst = max(highest, end), max(largest, kinetic), max(worst, gap)
        if gap > LENGTH:
            row.blew_up = row.blew_up or f"gap over a link at {now:.2f} s"
        if kinetic > 1.5 * available:
            row.blew_up = row.blew_up or f"energy at {now:.2f} s"
    row.simulated_s = row.steps / row.hz
    row.us_per_link_step = spent / 1e3 / (row.steps * row.links)
    row.worst_gap_m = worst
    row.kinetic_over_available = largest / available
    if largest > 0:
        row.energy_end = (end - start) / largest
        row.energy_gain = (highest - start) / largest


def rotations_from(quaternions: Array) -> Array:
    """(n, 3, 3) of (n, 4) unit quaternions x, y, z, w."""
    x, y, z, w = quaternions.T
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ]
    return np.moveaxis(np.array(rows), 2, 0)


def quaternions_of(rotations: Array) -> Array:
    """The inverse of `rotations_from`: by the largest of the four, to avoid division by small numbers."""
    result = np.empty((len(rotations), 4))
    for k, m in enumerate(rotations):
        squares = np.array([
            1 + m[0, 0] - m[1, 1] - m[2, 2], 1 - m[0, 0] + m[1, 1] - m[2, 2],
            1 - m[0, 0] - m[1, 1] + m[2, 2], 1 + m[0, 0] + m[1, 1] + m[2, 2],
        ])  # fmt: skip
        a, b, c = m[2, 1] - m[1, 2], m[0, 2] - m[2, 0], m[1, 0] - m[0, 1]
        d, e, f = m[0, 1] + m[1, 0], m[0, 2] + m[2, 0], m[1, 2] + m[2, 1]
        table = np.array([
            [squares[0], d, e, a], [d, squares[1], f, b], [e, f, squares[2], c], [a, b, c, squares[3]],
        ])  # fmt: skip
        row = table[np.argmax(squares)]
        result[k] = row / np.linalg.norm(row)
    return result
