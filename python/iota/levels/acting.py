# SPDX-License-Identifier: Apache-2.0
"""Fields and pair forces: which of them act on bodies, and copies of them that act on copies of the bodies."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from iota._core import Body, Box, Field, Group, PairForce, Particle, ParticleBatch, Places, System, Vec3
from iota.levels.ties import at_time, can_be_shifted, can_copy_law, copy_of_law

Force = Field | PairForce


def forces_on(system: System, bodies: Sequence[Body]) -> list[Force]:
    """The active ones that act on a particle of the bodies."""
    particles = _particles_of(bodies)
    forces: list[Force] = [*system.fields, *system.pair_forces]
    return [force for force in forces if force.active and any(_has_any(group, particles) for group in _groups(force))]


def can_copy_force(force: Force, bodies: Sequence[Body], places: Places) -> bool:
    """Whether `copy_forces` can copy it for these bodies. A function of the script gets all of its group, in its order. places: of the system."""
    for group in _groups(force):
        if group is not None and any(len({p in group for p in _own_points(body)}) > 1 for body in bodies):
            return False  # a copy of a solid has points of its own: all of them, or none
    if isinstance(force, PairForce):
        return can_copy_law(force.law) and not _meets_others(force, bodies, places)
    if force.kind == "expression":
        return can_be_shifted(force.text)
    if force.kind != "function":
        return True
    particles = _particles_of(bodies)
    if force.function is None or force.group is None or len(force.group) > len(particles):
        return False
    return all(p in particles and p.mass > 0 and len(p.ring) == 1 and not p.body.solids for p in force.group.particles)


def pushed_places(forces: Sequence[Force], bodies: Sequence[Body]) -> set[Particle]:
    """The attachments of bodies that forces act on: each is pushed as a point of its own."""
    places = {p for body in bodies for p in body.attachments}
    groups = (group for force in forces for group in _groups(force))
    return {p for group in groups for p in places if group is None or p in group}


def copy_forces(
    forces: Sequence[Force],
    system: System,
    body_of: Mapping[Body, Body],
    particle_of: Mapping[Particle, Particle],
    begin: float,
) -> None:
    """Makes the same ones of a system between copies of the particles. begin: see `at_time`; turbulence is that of the time of the copy."""
    groups: dict[Group, Group] = {}

    def group_of(own: Group | None) -> Group | None:
        if own is None:
            return None
        if own in groups:
            return groups[own]
        groups[own] = made = system.group(own.name)
        for body, twin in body_of.items():  # a group may have thousands of others
            for p in body.particles:
                if p.mass > 0 and p in own:
                    made.add(*([particle_of[p]] if p in particle_of else _own_points(twin)))
        return made

    for force in forces:
        if isinstance(force, PairForce):
            law, group, other = copy_of_law(force.law, begin), group_of(force.group), group_of(force.other)
            system.pair_force(
                law, cutoff=force.cutoff, group=group, other=other, shifted=force.shifted, **force.parameters
            )
            continue
        field: Any = force.text
        if force.kind == "expression":
            field = at_time(force.text, begin)
        elif force.kind == "function":
            assert force.group is not None and force.function is not None
            field = _Later(force.function, force.group.particles, particle_of, begin)
        parameters: dict[str, Any] = dict(force.parameters)
        system.field(field, group=group_of(force.group), name=force.name, **parameters)


class _Later:
    """A function of the script for copies of the particles that it expects, at another time."""

    def __init__(
        self,
        function: Callable[[Any], Any],
        particles: Sequence[Particle],
        particle_of: Mapping[Particle, Particle],
        begin: float,
    ) -> None:
        self._function, self._particles, self._begin = function, list(particles), begin
        self._own_of = {twin: own for own, twin in particle_of.items()}

    def __call__(self, batch: ParticleBatch) -> Any:
        row_of = {self._own_of[twin]: row for row, twin in enumerate(batch.particles)}
        rows = np.array([row_of[own] for own in self._particles])
        forces = np.empty((len(rows), 3))
        forces[rows] = self._function(_Batch(batch, rows, self._particles, self._begin))
        return forces


class _Batch:
    """The rows of a ParticleBatch of copies, as if they were the particles themselves."""

    def __init__(self, batch: ParticleBatch, rows: Any, particles: Sequence[Particle], begin: float) -> None:
        self.position, self.velocity, self.mass = batch.position[rows], batch.velocity[rows], batch.mass[rows]
        self.time, self.dt, self.particles = begin + batch.time, batch.dt, list(particles)

    def __len__(self) -> int:
        return len(self.particles)


def _groups(force: Force) -> list[Group | None]:
    return [force.group] if isinstance(force, Field) or force.other is None else [force.group, force.other]


def _meets_others(force: PairForce, bodies: Sequence[Body], places: Places) -> bool:
    """Whether others are as near as it reaches: copies without them would have an energy of their own."""
    own = _particles_of(bodies)
    first, second = force.group, force.other or force.group
    pairs = [(first, second)] if first == second else [(first, second), (second, first)]
    for mine, others in pairs:
        at = _places([p for p in own if mine is None or p in mine])
        if not len(at):
            continue
        low, high = at.min(axis=0) - force.cutoff, at.max(axis=0) + force.cutoff
        if not np.isfinite(high - low).all():
            return True
        near = places.overlap(Box(high - low), Vec3(*(low + high) / 2), (0, 0, 0, 1), None)
        points = [p for body in near for p in body.particles if p not in own and (others is None or p in others)]
        found = _places(points)
        if ((found >= low) & (found <= high)).all(axis=1).any():
            return True
    return False


def _places(particles: Sequence[Particle]) -> NDArray[np.float64]:
    return np.array([list(p.position) for p in particles]).reshape(len(particles), 3)


def _has_any(group: Group | None, particles: Iterable[Particle]) -> bool:
    return group is None or any(p in group for p in particles)


def _own_points(body: Body) -> list[Particle]:
    """The points of a solid without its attachments; none of other bodies."""
    if not body.solids:
        return []
    places = set(body.attachments)
    return [p for p in body.particles if p.mass > 0 and p not in places]


def _particles_of(bodies: Sequence[Body]) -> set[Particle]:
    return {p for body in bodies for p in body.particles}
