# SPDX-License-Identifier: Apache-2.0
"""Finds how a frozen thing would have moved while nobody saw it, by a few long steps of a copy of it among the obstacles near it."""

from __future__ import annotations

import math
import time
from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from iota._core import Body, Box, Particle, Places, System, Vec3
from iota.errors import ForceError
from iota.levels.acting import Force, can_copy_force, copy_forces, forces_on, pushed_places
from iota.levels.fitting import passing_pairs
from iota.levels.stand_ins import put
from iota.levels.ties import Tie, can_be_copied, copy_ties, needed_particles

Floats = NDArray[np.float64]
STEPS, LONGEST = 48, 1 / 20  # of the copy; s: longer ones let thin things pass through each other
WORK, MOST_STEPS = 1600, 400  # particles times steps of a copy that takes more: of a pendulum, of what drifts
GAIN = 1e-3  # of the kinetic energy, J: a copy with more has come into something
MOST_DAMPING = 3.0  # 1/s: what swings is at rest at the end
AT_ONCE = 4  # bodies that are copied in a piece
MOST_POINTS = 200  # of what fields act on: a step of more takes too long, and a flag flutters before and after
ROOM, MOST_OBSTACLES = 4.0, 200  # m around the way of a thing; how many are looked at
FARTHEST = 1e8  # m
AHEAD, LOOKS = 0.5, 4  # s of a way that turned out to lead elsewhere; steps from one look at it to the next


def catch_up(system: System, bodies: Sequence[Body], seconds: float, ties: Sequence[Tie] = ()) -> bool:
    """Moves bodies on by `seconds` at once: see CatchUp. False for what cannot be copied."""
    made = CatchUp(system, bodies, seconds, ties, Places(system))
    made.go_on()
    return made.finish()


class CatchUp:
    """Moves bodies on by `seconds`, in pieces: `go_on` until it is done, then `finish`. places: of the system. ties: all that connect them to each other and to the
    world but for hinges and nails. Takes up to STEPS steps of LONGEST, or more of few bodies that are held or that fields act on; what lasts longer counts as
    that, but what is held has lost as much energy by damping as in all the time. Others do not meet the bodies on their way. What stands on
    something that may move cannot be copied, nor functions of the script but for surfaces and fields, and a field only with all of its group."""

    def __init__(
        self, system: System, bodies: Sequence[Body], seconds: float, ties: Sequence[Tie], places: Places
    ) -> None:
        self._system = system
        self._copy: _Copy | None = None
        self._places: list[Vec3] = []
        self._pieces: Iterator[None] = iter(())
        forces = forces_on(system, bodies)
        parts: list[Body | Tie | Force] = [*bodies, *ties, *forces]
        self._parts = [(part, getattr(part, "active", True)) for part in parts]
        if seconds > 0 and _can_be_copied(bodies, ties, forces, places):
            self._places = _places_of(bodies)
            self._pieces = self._work(bodies, seconds, ties, forces, places)

    def go_on(self, until: float = math.inf) -> bool:
        """Does pieces of the work until a processor time, s, but at least one. Whether it is done, or in vain as a part of it has ended or
        was switched."""
        if not self._is_whole():
            self._pieces, self._copy = iter(()), None
        return not any(time.process_time() > until for _ in self._pieces)

    def _is_whole(self) -> bool:
        return all(part.alive and getattr(part, "active", True) == was for part, was in self._parts)

    def _work(
        self, bodies: Sequence[Body], seconds: float, ties: Sequence[Tie], forces: Sequence[Force], places: Places
    ) -> Iterator[None]:
        """Leaves no copy of what cannot be found."""
        self._copy = _Copy(self._system, bodies)
        try:
            yield from self._find(self._copy, bodies, seconds, ties, forces, places)
        except (_LostError, ForceError):  # a function of the script is told when it fails in the world
            self._copy = None

    def _find(
        self,
        copy: _Copy,
        bodies: Sequence[Body],
        seconds: float,
        ties: Sequence[Tie],
        forces: Sequence[Force],
        places: Places,
    ) -> Iterator[None]:
        yield from copy.copy_bodies(needed_particles(ties) | pushed_places(forces, bodies))
        copy.is_held |= bool(ties)
        points = sum(len(twin.particles) for twin in copy.twins)
        most = min(max(STEPS, WORK // points), MOST_STEPS) if copy.is_held or forces else STEPS
        steps = max(1, min(most, max(round(seconds / LONGEST), min(STEPS, round(seconds / (4 * LONGEST / STEPS))))))
        length = min(seconds / steps, LONGEST)
        copy.copy_what_acts(ties, forces, self._system.time - steps * length)
        yield
        copy.move_as_before()
        copy.require_near()
        yield from copy.copy_obstacles(places, seconds)
        if copy.is_held:
            copy.raise_damping(seconds / (steps * length))
        for step in range(steps):
            if step > 0 and step % LOOKS == 0:
                copy.require_near()
                yield from copy.copy_obstacles_ahead(places)
            copy.system.step(length)
            yield

    def finish(self) -> bool:
        """The bodies get the state of the copy. False if it has gained energy, if something has moved them meanwhile, or without a copy."""
        copy = self._copy
        if copy is None or not (self._is_whole() and copy.is_as_it_was(self._places)):
            return False
        energy = copy.system.energy
        if energy.total > copy.energy + max(energy.external_work, 0.0) + GAIN * (1 + energy.kinetic):
            return False
        copy.put_back(self._system)
        return True


def _places_of(bodies: Sequence[Body]) -> list[Vec3]:
    return [p.position for body in bodies for p in body.particles]


def _can_be_copied(bodies: Sequence[Body], ties: Sequence[Tie], forces: Sequence[Force], places: Places) -> bool:
    if not all(can_be_copied(tie) for tie in ties):
        return False
    if not all(can_copy_force(force, bodies, places) for force in forces):
        return False
    if forces and sum(len(body.particles) for body in bodies) > MOST_POINTS:
        return False
    own = set(bodies)
    if any(contact.other not in own and contact.other.particles for body in bodies for contact in body.contacts):
        return False  # it stands on something that may move
    return all(body.kind == "dynamic" and len(body.solids) <= 1 and len(body.parts) <= 1 for body in bodies)


class _LostError(Exception):
    """A copy cannot tell where its bodies would have come."""


class _Copy:
    """An empty one at first; its functions that yield do so between pieces of their work."""

    def __init__(self, system: System, bodies: Sequence[Body]) -> None:
        self.bodies = list(bodies)
        is_replaced = any(field.active and field.replaces_gravity for field in system.fields)
        gravity = Vec3() if is_replaced else system.gravity
        self.system = System(gravity=gravity, damping=system.damping, mode="energy_keeping")
        self.system.usual_material = system.usual_material
        self.twin_of: dict[Particle, Particle] = {}
        self.twins: list[Body] = []
        self.energy = 0.0
        self.is_held = False
        self._obstacles: dict[Body, Body] = {}  # their copies
        self._passing = passing_pairs(system, self.bodies)

    def copy_bodies(self, needed: set[Particle]) -> Iterator[None]:
        """Copies the bodies and their hinges. needed: particles of which others need copies."""
        for body in self.bodies:
            self.twins.append(self._copy(body, needed))
            if len(self.twins) % AT_ONCE == 0:
                yield
        yield
        yield from self._copy_hinges()
        twin_of_body = self._twin_of_body()
        for pair in self._passing:
            if len(pair) == 2 and pair <= twin_of_body.keys():
                self.system.ignore_contacts(*(twin_of_body[body] for body in pair))
        self.is_held = any(p.is_nailed for p in self.twin_of)
        yield

    def copy_what_acts(self, ties: Sequence[Tie], forces: Sequence[Force], begin: float) -> None:
        """Copies what ties the bodies, and the forces on them. begin: s, the time from which the copy goes on."""
        try:
            copy_ties(ties, self.system, self._twin_of_body(), self.twin_of, begin)
            copy_forces(forces, self.system, self._twin_of_body(), self.twin_of, begin)
        except ValueError as error:  # a joint that has come apart too far to be made where it is
            raise _LostError from error

    def _twin_of_body(self) -> dict[Body, Body]:
        return dict(zip(self.bodies, self.twins, strict=True))

    def move_as_before(self) -> None:
        """The copy gets the velocities of the bodies. energy: J, then."""
        move_as(
            self.system, [(self.twin_of[p], p) for p in self.twin_of], list(zip(self.twins, self.bodies, strict=True))
        )
        self.energy = self.system.energy.total

    def _copy(self, body: Body, needed: set[Particle]) -> Body:
        if body.solids:
            solid, places = body.solids[0], set(body.attachments)
            twin = self.system.body(
                shape=solid.shape, mass=body.mass, position=solid.position, orientation=solid.orientation
            )
            for p in body.particles:
                if p in needed or (p in places and (p.is_nailed or len(p.ring) > 1)):
                    self.twin_of[p] = twin.attachment(p.position)
        else:
            twin = self.system.body()
            for p in body.particles:
                if p.mass > 0:  # others are marks of joints, or places
                    self.twin_of[p] = twin.particle(p.position, mass=p.mass)
            for p in body.particles:
                if p not in self.twin_of and (p in needed or p.is_nailed or len(p.ring) > 1):
                    self.twin_of[p] = twin.attachment(p.position)
        twin.material, twin.damping = body.material, body.damping
        if body.radius > 0:
            twin.radius = body.radius
        return twin

    def raise_damping(self, factor: float) -> None:
        """So that as much is lost in the time of the copy as in `factor` times that time."""
        self.system.damping = _raised(self.system.damping, factor)
        for twin in self.twins:
            twin.damping = _raised(twin.damping, factor)

    def is_as_it_was(self, places: Sequence[Vec3]) -> bool:
        """Whether all of it is still there, at the same places."""
        is_whole = len(self.twins) == len(self.bodies) and all(body.alive for body in self.bodies)
        return is_whole and _places_of(self.bodies) == places

    def _copy_hinges(self) -> Iterator[None]:
        done: set[Particle] = set()
        for count, (own, twin) in enumerate(self.twin_of.items()):
            if count % (4 * AT_ONCE) == 0:
                yield
            if own in done:
                continue
            for mate in own.ring:
                done.add(mate)
                if mate != own and mate in self.twin_of:
                    twin.combine(self.twin_of[mate])
            if own.is_nailed:
                twin.nail()

    def copy_obstacles(self, places: Places, seconds: float) -> Iterator[None]:
        """Copies those near the way of the thing, which goes downwards at most as far as it falls."""
        time = min(seconds, STEPS * LONGEST)
        low, high = self._way(time)
        pull = 0.5 * np.array(list(self.system.gravity)) * time**2
        yield from self._copy_within(places, low + np.minimum(pull, 0), high + np.maximum(pull, 0))

    def require_near(self) -> None:
        """Raises _LostError for what has been thrown out of any world."""
        low, high = self._way(AHEAD)
        if not (np.isfinite(high - low).all() and np.abs([low, high]).max() < FARTHEST):
            raise _LostError

    def copy_obstacles_ahead(self, places: Places) -> Iterator[None]:
        """Copies more of them where the copy is about to leave the room in which they were copied, as in a wind or on a slope."""
        low, high = self._way(LOOKS * LONGEST)
        if (low + ROOM / 2 < self._low).any() or (high - ROOM / 2 > self._high).any():
            yield from self._copy_within(places, *self._way(AHEAD))

    def _way(self, seconds: float) -> tuple[Floats, Floats]:
        """Room around the way that the copy goes straight on."""
        centers = np.array([list(twin.center_of_mass) for twin in self.twins])
        moved = centers + seconds * np.array([list(twin.velocity) for twin in self.twins])
        return np.minimum(centers, moved).min(axis=0) - ROOM, np.maximum(centers, moved).max(axis=0) + ROOM

    def _copy_within(self, places: Places, low: Floats, high: Floats) -> Iterator[None]:
        self._low, self._high = low, high
        near = places.overlap(Box(high - low), Vec3(*(low + high) / 2), (0, 0, 0, 1), None)
        yield
        known = self._obstacles
        found = [body for body in near if body.alive and body.kind == "static" and body not in known][:MOST_OBSTACLES]
        for count, obstacle in enumerate(found):
            if count % AT_ONCE == 0:
                yield
            if not (obstacle.alive and obstacle.solids):
                continue
            solid = obstacle.solids[0]
            known[obstacle] = twin = self.system.obstacle(solid.shape, solid.position, solid.orientation)
            twin.material = obstacle.material
            for own, mate in zip(self.bodies, self.twins, strict=True):
                if frozenset((own, obstacle)) in self._passing:
                    self.system.ignore_contacts(mate, twin)

    def put_back(self, system: System) -> None:
        """The state of the copy becomes that of the thing."""
        pairs = list(zip(self.bodies, self.twins, strict=True))
        poses = {own: (twin.center_of_mass, twin.orientation) for own, twin in pairs if own.solids}
        points = {p: q for p, q in self.twin_of.items() if not p.body.solids}
        put(system, poses, {p: q.position for p, q in points.items() if p.mass > 0})
        move_as(system, list(self.twin_of.items()), pairs)


def move_as(system: System, points: Sequence[tuple[Particle, Particle]], bodies: Sequence[tuple[Body, Body]]) -> None:
    """Gives particles and bodies, which are hinged, the velocities of others at the same places. Bodies of shapes have points of their
    own."""
    moved, velocities = [], []
    for body, twin in bodies:
        if body.solids:
            velocity, turn, center = twin.velocity, twin.angular_velocity, twin.center_of_mass
            moved += body.particles
            velocities += [list(velocity + turn.cross(p.position - center)) for p in body.particles]
    for p, q in points:
        if not p.body.solids:
            moved.append(p)
            velocities.append(list(q.velocity))
    system.array(moved).velocities = np.array(velocities)


def _raised(damping: float, factor: float) -> float:
    return min(damping * factor, max(damping, MOST_DAMPING))
