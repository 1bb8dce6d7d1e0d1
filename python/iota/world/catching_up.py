# SPDX-License-Identifier: Apache-2.0
"""Finds how a frozen thing would have moved while nobody saw it, by a few long steps of a copy of it among the obstacles near it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from iota._core import Body, Particle, System
from iota.world.stand_ins import put

Floats = NDArray[np.float64]
STEPS, LONGEST = 48, 1 / 20  # of the copy; s: longer ones let thin things pass through each other
GAIN = 1e-3  # of the kinetic energy, J: a copy with more has come into something
ROOM, MOST_OBSTACLES = 4.0, 200  # m around the way of a thing; how many are looked at


def catch_up(system: System, bodies: Sequence[Body], seconds: float) -> bool:
    """Moves a thing on by `seconds`, or by STEPS times LONGEST if that is less. Other things do not meet it on its way. False for what
    cannot be copied: only hinges and nails may hold it, and no field but those of all may act on it."""
    if seconds <= 0 or not _can_be_copied(system, bodies):
        return False
    copy = _Copy(system, bodies, seconds)
    steps = max(1, min(STEPS, round(seconds / (4 * LONGEST / STEPS))))
    length = min(seconds / steps, LONGEST)
    for _ in range(steps):
        copy.system.step(length)
    if copy.system.energy.total > copy.energy + GAIN * (1 + copy.system.energy.kinetic):
        return False
    copy.put_back(system)
    return True


def _can_be_copied(system: System, bodies: Sequence[Body]) -> bool:
    if len(system.fields) > 0 or len(system.pair_forces) > 0:
        return False
    own = set(bodies)
    if any(contact.other not in own and contact.other.particles for body in bodies for contact in body.contacts):
        return False  # it stands on something that may move
    return all(body.kind == "dynamic" and len(body.solids) <= 1 and len(body.parts) <= 1 for body in bodies)


class _Copy:
    def __init__(self, system: System, bodies: Sequence[Body], seconds: float) -> None:
        self.bodies = list(bodies)
        self.system = System(gravity=system.gravity, damping=system.damping, mode="energy_keeping")
        self.system.usual_material = system.usual_material
        self.twin_of: dict[Particle, Particle] = {}
        self.twins = [self._copy(body) for body in self.bodies]
        self._copy_hinges()
        self._copy_obstacles(system, seconds)
        move_as(self.system, self.twins, self.bodies)
        self.energy = self.system.energy.total

    def _copy(self, body: Body) -> Body:
        if body.solids:
            solid, places = body.solids[0], set(body.attachments)
            twin = self.system.body(
                shape=solid.shape, mass=body.mass, position=solid.position, orientation=solid.orientation
            )
            for p in body.particles:
                if p in places and (p.is_nailed or len(p.ring) > 1):
                    self.twin_of[p] = twin.attachment(p.position)
        else:
            twin = self.system.body()
            for p in body.particles:
                self.twin_of[p] = twin.particle(p.position, mass=p.mass)
        twin.material, twin.damping = body.material, body.damping
        if body.radius > 0:
            twin.radius = body.radius
        return twin

    def _copy_hinges(self) -> None:
        done: set[Particle] = set()
        for own, twin in self.twin_of.items():
            if own in done:
                continue
            for mate in own.ring:
                done.add(mate)
                if mate != own and mate in self.twin_of:
                    twin.combine(self.twin_of[mate])
            if own.is_nailed:
                twin.nail()

    def _copy_obstacles(self, system: System, seconds: float) -> None:
        """Copies those near the way of the thing, which goes downwards at most as far as it falls."""
        time = min(seconds, STEPS * LONGEST)
        places = np.array([list(body.center_of_mass) for body in self.bodies])
        moved = places + time * np.array([list(body.velocity) for body in self.bodies])
        low = np.minimum(places, moved).min(axis=0) - ROOM
        high = np.maximum(places, moved).max(axis=0) + ROOM
        pull = 0.5 * np.array(list(system.gravity)) * time**2
        low, high = low + np.minimum(pull, 0), high + np.maximum(pull, 0)
        for obstacle in system.obstacles[:MOST_OBSTACLES]:
            solid = obstacle.solids[0]
            place, bounds = np.array(list(solid.position)), _reach(solid.shape)
            if (place + bounds >= low).all() and (place - bounds <= high).all():
                twin = self.system.obstacle(solid.shape, solid.position, solid.orientation)
                twin.material = obstacle.material

    def put_back(self, system: System) -> None:
        """The state of the copy becomes that of the thing."""
        poses = {
            own: (twin.center_of_mass, twin.orientation)
            for own, twin in zip(self.bodies, self.twins, strict=True)
            if own.solids
        }
        places = {
            p: q.position
            for own, twin in zip(self.bodies, self.twins, strict=True)
            if not own.solids
            for p, q in zip(own.particles, twin.particles, strict=True)
        }
        put(system, poses, places)
        move_as(system, self.bodies, self.twins)


def move_as(system: System, bodies: Sequence[Body], twins: Sequence[Body]) -> None:
    """Gives bodies, which are hinged, the velocities of others at the same places. Bodies of shapes have points of their own."""
    points, velocities = [], []
    for body, twin in zip(bodies, twins, strict=True):
        if body.solids:
            velocity, turn, center = twin.velocity, twin.angular_velocity, twin.center_of_mass
            points += body.particles
            velocities += [list(velocity + turn.cross(p.position - center)) for p in body.particles]
        else:
            points += body.particles
            velocities += [list(p.velocity) for p in twin.particles]
    system.array(points).velocities = np.array(velocities)


def _reach(shape: Any) -> float:
    """The largest distance of its surface from its origin, m; infinite for a half-space."""
    try:
        low, high = shape.bounds
    except (AttributeError, TypeError, ValueError):
        return float("inf")
    corner = np.maximum(np.abs(np.array(list(low))), np.abs(np.array(list(high))))
    return float(np.linalg.norm(corner))
