# SPDX-License-Identifier: Apache-2.0
"""A structure in the place of a thing: it has the thing's mass, its center of mass and its momentum, and never more energy."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from iota._core import Body, Particle, System, Vec3
from iota.arguments import SHORT
from iota.frames import one_after_another
from iota.levels.fitting import up_of, way_out, work_of_gravity

Floats = NDArray[np.float64]
SAME = 1e-6  # of the mass
MOST_LEFT = 0.9  # of the stand-in's points: fewer are left if somebody has taken it apart


class Structure(Protocol):
    """One of `iota.builder`, which is above this folder."""

    def __add__(self, offset: Any) -> Structure: ...

    def realize(self, system: System, world: Any = None) -> Any: ...


class Motion:
    """The motion of some bodies about their center of mass. momentum: kg m/s; spin: angular momentum, kg m^2/s."""

    def __init__(self, system: System, bodies: Sequence[Body]) -> None:
        self.points = system.array([p for body in bodies for p in body.particles])
        self.masses = np.asarray(self.points.masses, dtype=float)
        self.places = np.asarray(self.points.positions, dtype=float)
        self.velocities = np.asarray(self.points.velocities, dtype=float)
        self.mass = float(self.masses.sum())
        self.center = self.masses @ self.places / self.mass
        self.momentum = self.masses @ self.velocities
        self.arms = self.places - self.center
        self.spin = np.cross(self.arms, self.masses[:, None] * self.velocities).sum(axis=0)
        self.is_nailed = any(p.is_nailed for body in bodies for p in body.particles)

    @property
    def kinetic(self) -> float:
        """J."""
        return float(0.5 * self.masses @ (self.velocities**2).sum(axis=1))

    def turning(self, spin: Floats, most: float = math.inf) -> Floats:
        """The angular velocity, rad/s, as of one rigid body with an angular momentum, but with no more energy than `most`, J."""
        squares = (self.arms**2).sum(axis=1)
        inertia = (self.masses * squares).sum() * np.eye(3)
        inertia -= np.einsum("n,ni,nj->ij", self.masses, self.arms, self.arms)
        turn: Floats = np.linalg.pinv(inertia, rcond=1e-9) @ spin  # a rod has no spin about itself
        energy = 0.5 * float(turn @ inertia @ turn)
        return turn * math.sqrt(max(most, 0.0) / energy) if energy > most else turn

    def rigid(self, momentum: Floats, turn: Floats) -> Floats:
        """Velocities of all points."""
        velocities: Floats = momentum / self.mass + np.cross(turn, self.arms)
        return velocities

    def energy_of(self, momentum: Floats) -> float:
        """The kinetic energy of the center of mass, J."""
        return 0.5 * float(momentum @ momentum) / self.mass

    def limited(self, momentum: Floats, most: float) -> Floats:
        """A momentum of which the center of mass has no more energy than `most`, J."""
        energy = self.energy_of(momentum)
        return momentum * math.sqrt(most / energy) if energy > most else momentum

    @property
    def extent(self) -> float:
        """The distance of the farthest point from the center of mass, m."""
        return float(np.sqrt((self.arms**2).sum(axis=1).max()))


class StandIn:
    """In the place of `bodies`, which are inactive meanwhile.

    Its points have the velocities of a rigid motion with the momentum and the angular momentum that the bodies had; nails take
    what they take. A structure that is more compact would have more energy with that angular momentum: it turns as fast as the
    energy allows, and the rest of the angular momentum is given back when it leaves. `leave` brings the bodies back in the same way, moved as
    the stand-in has moved, with their own inner motion as far as energy is left for it. Either comes out of what it would overlap. What is held,
    by nails or, as is_held says, by joints, comes back where it was.
    """

    def __init__(
        self,
        system: System,
        scene: Any,
        bodies: Sequence[Body],
        structure: Structure,
        level: str,
        is_held: bool = False,
    ) -> None:
        """Raises TypeError and ValueError, before anything has changed, for what is not a structure or has another mass."""
        if not callable(getattr(structure, "realize", None)):
            raise TypeError(
                f"the level {level!r} must make an iota.builder.Structure to stand in, not {SHORT.repr(structure)}"
            )
        self._system, self._originals = system, list(bodies)
        before = self._before = Motion(system, bodies)
        self._poses = {body: (np.array(list(body.center_of_mass)), body.orientation) for body in bodies if body.solids}
        made = structure.realize(System())
        if not made.bodies:
            raise ValueError(f"the level {level!r} has made a structure without bodies")
        trial = Motion(made.bodies[0].system, made.bodies)
        mass = trial.mass
        if abs(mass - before.mass) > SAME * before.mass:
            raise ValueError(
                f"the structure of level {level!r} has {mass:.6g} kg, but what it stands in for has {before.mass:.6g} kg:"
                " give its points or bodies the same mass in all"
            )
        self._is_held, lifted = is_held or before.is_nailed, 0.0
        if not trial.is_nailed:
            offset = Vec3(*(before.center - trial.center))
            way = way_out(system, made.bodies, self._originals, before.extent + trial.extent, offset)
            structure, lifted = structure + (offset + way), work_of_gravity(system, before.mass, way)
        with system.edit(undoable=False):  # an undo of a user takes back what people did
            self.bodies = structure.realize(system, scene).bodies
        for body in self._originals:
            body.active = False
        now = Motion(system, self.bodies)
        self._parts = len({body.articulate.number for body in self.bodies})
        energy = max(before.kinetic - lifted, 0.0)
        momentum = before.limited(before.momentum, energy)
        turn = now.turning(before.spin, energy - before.energy_of(momentum))
        now.points.velocities = now.rigid(momentum, turn)
        begun = self._begun = Motion(system, self.bodies)
        self._owed = np.zeros(3) if begun.is_nailed else before.spin - begun.spin
        self._inner = max(energy - begun.kinetic, 0.0)

    @property
    def is_there(self) -> bool:
        """All of its bodies are."""
        return all(body.alive for body in self.bodies)

    @property
    def is_whole(self) -> bool:
        """Nobody has destroyed a part of it, combined, cut or nailed it."""
        return (
            self.is_there
            and all(body.alive for body in self._originals)
            and len({body.articulate.number for body in self.bodies}) == self._parts
            and sum(len(body.articulate.bodies) for body in self.roots) == len(self.bodies)
        )

    @property
    def roots(self) -> list[Body]:
        """A body of each of its articulates."""
        found = {body.articulate.number: body for body in reversed(self.bodies) if body.alive}
        return list(found.values())[::-1]

    def leave(self) -> None:
        """The bodies are back. One that is not whole any more stays instead, and the bodies are destroyed."""
        if not self.is_whole:
            self.keep()
            return
        now, before = Motion(self._system, self.bodies), self._before
        turn = np.eye(3)
        lifted = 0.0
        if not self._is_held:
            turn, lifted = self._come(now)
        for body in self.bodies:
            body.destroy()
        for body in self._originals:
            body.active = True
        there = Motion(self._system, self._originals)
        if self._is_held:  # back where they were, they move as they did: else they would have fallen, and not be lower
            there.points.velocities = before.velocities
            return
        allowed = max(now.kinetic + self._inner - lifted, 0.0)
        momentum = there.limited(now.momentum, allowed)
        rest = allowed - there.energy_of(momentum)
        velocities = there.rigid(momentum, there.turning(now.spin + self._owed, rest))
        inner = (before.velocities - before.rigid(before.momentum, before.turning(before.spin))) @ turn.T
        left = allowed - 0.5 * float(there.masses @ (velocities**2).sum(axis=1))
        energy = 0.5 * float(there.masses @ (inner**2).sum(axis=1))
        there.points.velocities = velocities + inner * (
            math.sqrt(min(1.0, max(left, 0.0) / energy)) if energy > 0 else 0.0
        )

    def _come(self, now: Motion) -> tuple[Floats, float]:
        """Puts the bodies, which are inactive, where the stand-in has gone, and out of what they overlap there. What a ball stood for may have
        rolled, and would stand in the ground: then it lies, if it is lifted less so. Returns how they were turned, and the work of lifting, J."""
        system, arms, masses = self._system, self._before.arms, self._before.masses
        turn = turn_between(self._begun.arms, now.arms, now.masses)
        present, extent = {*self._originals, *self.bodies}, self._before.extent + now.extent
        found: list[tuple[float, Floats, Vec3]] = []
        for each in (turn, lying(arms @ turn.T, masses, up_of(system)) @ turn):
            self._move(each, now.center)
            way = way_out(system, self._originals, present, extent)
            found.append((work_of_gravity(system, self._before.mass, way), each, way))
            if way == Vec3():
                break
        lifted, turn, way = min(found, key=lambda each: each[0])
        if len(found) > 1:
            self._move(turn, now.center + np.array(list(way)))
        return turn, lifted

    def _move(self, turn: Floats, center: Floats) -> None:
        quaternion, before = quaternion_of(turn), self._before
        poses = {
            body: (center + turn @ (place - before.center), one_after_another(quaternion, orientation))
            for body, (place, orientation) in self._poses.items()
        }
        places = dict(zip(before.points, center + before.arms @ turn.T, strict=True))
        put(self._system, poses, places)

    def keep(self) -> None:
        """It is the thing from now on."""
        for body in self._originals:
            if body.alive:
                body.destroy()


def put(system: System, poses: Mapping[Body, tuple[Any, Any]], places: Mapping[Particle, Any]) -> None:
    """Puts bodies at poses, centers of mass and orientations, and particles of others at places; hinged ones pull at none."""
    if poses:
        system.array(list(poses)).poses = np.array([[*place, *turn] for place, turn in poses.values()])
    taken = {mate for body in poses for p in body.particles for mate in p.ring}
    points = [p for p in places if p not in taken]
    if points:
        system.array(points).positions = np.array([list(places[p]) for p in points])


def quaternion_of(turn: Floats) -> tuple[float, float, float, float]:
    """x y z w of a rotation matrix (Shepperd 1978)."""
    trace = float(np.trace(turn))
    w = 1 + trace
    x, y, z = (1 + 2 * float(turn[k, k]) - trace for k in range(3))
    row = int(np.argmax([w, x, y, z]))
    (_, b, c), (d, _, f), (g, h, _) = turn.tolist()
    found = np.array(
        [(h - f, c - g, d - b, w), (x, b + d, c + g, h - f), (b + d, y, f + h, c - g), (c + g, f + h, z, d - b)][row]
    )
    qx, qy, qz, qw = (found / np.linalg.norm(found)).tolist()
    return (qx, qy, qz, qw)


def lying(arms: Floats, masses: Floats, up: Vec3) -> Floats:
    """The smallest rotation after which masses, at arms from their center, are spread least upwards."""
    axis = np.linalg.svd((masses[:, None] * arms).T @ arms)[0][:, 2]
    axis = axis if axis @ list(up) >= 0 else -axis
    return half_turn(axis + np.array(list(up))) @ half_turn(axis)


def half_turn(axis: Floats) -> Floats:
    """The rotation by 180 degrees about an axis of any length."""
    turn: Floats = 2 * np.outer(axis, axis) / (axis @ axis) - np.eye(3)
    return turn


def turn_between(before: Floats, after: Floats, masses: Floats) -> Floats:
    """The rotation that brings arms nearest to others (Kabsch 1976)."""
    left, _, right = np.linalg.svd((masses[:, None] * before).T @ after)
    sign = np.sign(np.linalg.det(left @ right))
    turn: Floats = (left @ np.diag([1.0, 1.0, sign if sign else 1.0]) @ right).T
    return turn
