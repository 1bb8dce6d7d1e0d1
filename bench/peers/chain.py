# SPDX-License-Identifier: Apache-2.0
"""The benchmark's chain, for any engine: the scene, what is measured, and how.

Rods of 0.1 m, 0.1 kg and 5 mm radius (solid cylinders), joined end to end by ball joints, lie along x; the first end is
held at the origin and everything is released at rest. No damping, no contacts, no sleeping. y is up.
"""

from __future__ import annotations

import math
import time
from dataclasses import asdict, dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

LENGTH = 0.1  # m
MASS = 0.1  # kg
RADIUS = 0.005  # m
GRAVITY = 9.81  # m/s^2, down
AXIAL = MASS * RADIUS**2 / 2  # kg m^2, about the rod's axis
TRANSVERSE = MASS * (3 * RADIUS**2 + LENGTH**2) / 12  # kg m^2, across it

Array = NDArray[np.float64]


@dataclass
class State:
    """Centres (n, 3) m, axes (n, 3) unit vectors towards the free end, velocities (n, 3) m/s, spins (n, 3) rad/s."""

    centre: Array
    axis: Array
    velocity: Array
    spin: Array


class Chain(Protocol):
    """One engine's chain."""

    def advance(self, steps: int) -> None:
        """Simulates `steps` frames."""

    def read(self) -> State:
        """The state now."""

    def trouble(self) -> str:
        """What the engine itself complained about, or nothing."""


@dataclass
class Row:
    """One measurement; energies are fractions of the largest kinetic energy seen."""

    engine: str
    setting: str
    links: int
    hz: int
    us_per_link_step: float = math.nan
    worst_gap_m: float = math.nan
    energy_end: float = math.nan
    energy_gain: float = math.nan
    kinetic_over_available: float = math.nan  # above 1: made-up energy
    simulated_s: float = 0
    steps: int = 0
    observed_every: int = 1
    blew_up: str = ""  # why and when; empty: whole until simulated_s
    note: str = ""

    def as_dict(self) -> dict[str, object]:
        """Ready for strict JSON: numbers that are not finite become null."""
        return {k: None if isinstance(v, float) and not math.isfinite(v) else v for k, v in asdict(self).items()}


def gap_of(state: State) -> float:
    """Largest distance between two ends that should meet, m."""
    arm = state.axis * (LENGTH / 2)
    above = np.vstack([np.zeros((1, 3)), (state.centre + arm)[:-1]])
    return float(np.max(np.linalg.norm(state.centre - arm - above, axis=1)))


def energies_of(state: State) -> tuple[float, float]:
    """Kinetic and potential energy, J."""
    along = np.sum(state.spin * state.axis, axis=1)
    across = np.sum(state.spin**2, axis=1) - along**2
    twice = MASS * np.sum(state.velocity**2) + TRANSVERSE * np.sum(across) + AXIAL * np.sum(along**2)
    return float(twice / 2), float(MASS * GRAVITY * np.sum(state.centre[:, 1]))


def available(links: int) -> float:
    """What gravity can release, J: from lying level to hanging straight."""
    return MASS * GRAVITY * LENGTH * links**2 / 2


def measure(chain: Chain, row: Row, seconds: float, cap: float) -> None:
    """Runs for `seconds` of simulation or `cap` seconds of wall clock and fills the row.

    Energy and gap are looked at every `row.observed_every` frames. Time is processor time of this process inside the engine's step only, averaged over all steps.
    """
    every = row.observed_every
    total = round(seconds * row.hz)
    began, spent = time.monotonic(), 0
    start = highest = end = sum(energies_of(chain.read()))
    largest, worst = 0.0, 0.0
    while row.steps < total and time.monotonic() - began < cap:
        count = min(every, total - row.steps)
        before = time.process_time_ns()
        chain.advance(count)
        spent += time.process_time_ns() - before
        row.steps += count
        now = row.steps / row.hz
        with np.errstate(all="ignore"):
            state = chain.read()
            gap, (kinetic, potential) = gap_of(state), energies_of(state)
        if complaint := chain.trouble():
            row.blew_up = row.blew_up or f"{complaint} at {now:.2f} s"
        if not math.isfinite(gap + kinetic + potential):
            row.blew_up = row.blew_up or f"not a number at {now:.2f} s"
            break
        end = kinetic + potential
        highest, largest, worst = max(highest, end), max(largest, kinetic), max(worst, gap)
        if gap > LENGTH:
            row.blew_up = row.blew_up or f"gap over a link at {now:.2f} s"
        if kinetic > 1.5 * available(row.links):
            row.blew_up = row.blew_up or f"energy at {now:.2f} s"
    row.simulated_s = row.steps / row.hz
    row.us_per_link_step = spent / 1e3 / (row.steps * row.links)
    row.worst_gap_m = worst
    row.kinetic_over_available = largest / available(row.links)
    if largest > 0:
        row.energy_end = (end - start) / largest
        row.energy_gain = (highest - start) / largest
