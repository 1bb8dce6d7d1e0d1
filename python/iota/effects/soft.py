# SPDX-License-Identifier: Apache-2.0
"""Bonds that creep and bonds that melt."""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np

from iota._core import Bond, Particle, System
from iota.builder.points import Vector


class Unit(NamedTuple):
    """The result of `viscoelastic`."""

    middle: Particle
    bonds: tuple[Bond, Bond, Bond]


def viscoelastic(
    system: System, p: Particle, q: Particle, stiffness: float, creep_stiffness: float, viscosity: float
) -> Unit:
    """A unit of two springs and a dashpot: a spring between p and q and, in parallel, a second spring in series with a
    dashpot (the standard linear solid; Terzopoulos and Fleischer 1988). A fast pull meets the stiffness of both
    springs; after viscosity / creep_stiffness seconds only that of the first. stiffness: N/m; viscosity: N s/m. Between
    the second spring and the dashpot is a light particle, at first at the place of q.

        effects.viscoelastic(system, a, b, stiffness=50, creep_stiffness=200, viscosity=100)
    """
    mass = 1e-3 * min(part.mass for part in (p, q) if part.mass > 0)
    middle = system.body().particle(q.position, mass, q.velocity)
    length = abs(q.position - p.position)
    bonds = (
        system.bond(p, q, "spring", stiffness=stiffness, damping=0, length=length),
        system.bond(p, middle, "spring", stiffness=creep_stiffness, damping=0, length=length),
        system.bond(middle, q, "drag", damping=viscosity),
    )
    return Unit(middle, bonds)


class Melting:
    """Springs that conduct heat, soften when warm and are destroyed at their melting point (Terzopoulos, Platt and
    Fleischer, Heating and melting deformable models, 1989). Temperatures are those of particles; a bond has the mean of
    its ends.

    bonds: with the law "spring". melts_at: K above the present, uniform temperature. conduction: of a bond, W/K.
    capacity: heat capacity, J/(kg K). Call `step(dt)` once a step, for instance from `world.on_step`.

        ice = effects.Melting(made.bonds, melts_at=50)
        ice.heat((0, 1, 0), radius=0.2, energy=100)
    """

    def __init__(
        self, bonds: Iterable[Bond], melts_at: float = 50.0, conduction: float = 0.5, capacity: float = 100.0
    ) -> None:
        if not (melts_at > 0 and conduction >= 0 and capacity > 0):
            raise ValueError("melts_at and capacity must be above 0, conduction at least 0")
        self._bonds = list(bonds)
        ends = [bond.ends for bond in self._bonds]
        self.particles = list(dict.fromkeys(particle for pair in ends for particle in pair))
        number = {particle: at for at, particle in enumerate(self.particles)}
        self._ends = np.array([[number[p], number[q]] for p, q in ends], int).reshape(-1, 2)
        self._stiffness = np.array([bond.parameters["stiffness"] for bond in self._bonds])
        self._told = self._stiffness.copy()
        self._capacity = capacity * np.array([particle.mass for particle in self.particles])
        self._conduction, self._melts_at = conduction, melts_at
        self.temperature = np.zeros(len(self.particles))  # K, of each of `particles`
        self._solid = np.ones(len(self._bonds), bool)

    def heat(self, place: Vector, radius: float, energy: float) -> None:
        """Distributes an energy (J) over the particles within a radius (m), by their heat capacity."""
        places = np.array([tuple(particle.position) for particle in self.particles])
        near = np.linalg.norm(places - np.asarray(tuple(place)), axis=1) < radius
        if near.any():
            self.temperature[near] += energy / self._capacity[near].sum()

    def step(self, dt: float = 1 / 120) -> int:
        """Conducts heat for dt s, softens bonds, and destroys those that melt; returns their number. The time is
        divided into parts in which no particle's temperature overshoots."""
        p, q = self._ends[self._solid].T
        busiest = np.bincount(self._ends[self._solid].ravel(), minlength=len(self.particles)) * self._conduction
        parts = int(np.ceil(dt * float((busiest / self._capacity).max(initial=0)) * 2)) or 1
        for _ in range(parts):
            flow = self._conduction * (self.temperature[p] - self.temperature[q]) * (dt / parts)
            np.subtract.at(self.temperature, p, flow / self._capacity[p])
            np.add.at(self.temperature, q, flow / self._capacity[q])
        mean = self.temperature[self._ends].mean(axis=1)
        share = np.clip(1 - mean / self._melts_at, 0, 1)
        melted = np.flatnonzero(self._solid & (share == 0))
        for number in melted:
            if self._bonds[number].alive:
                self._bonds[number].destroy()
        self._solid[melted] = False
        wanted = share * self._stiffness
        for number in np.flatnonzero(self._solid & (np.abs(wanted - self._told) > 0.02 * self._stiffness)):
            if self._bonds[number].alive:
                self._bonds[number].set(stiffness=float(wanted[number]))
                self._told[number] = wanted[number]
        return len(melted)
