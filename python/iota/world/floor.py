# SPDX-License-Identifier: Apache-2.0
"""A level floor that supports particles and bodies by forces that are calculated once a step.

A body touches the floor at a list of spheres fixed on it: its particles, or the corners, rims and ends of its shape; of
more than 26 particles those that are farthest in as many directions. A body that is a thousand times heavier than the
particles it stands on comes to rest within 1 % of its size.
Each step calculates the impulses that stop those points at the floor, with dry friction, as if only gravity acted on
their body (sequential impulses: E. Catto, Iterative Dynamics with Temporal Coherence, GDC 2005). Other loads of the
body appear as a speed of a resting point; `load` estimates them step by step. A floor that is a row of the solver would
not need this.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from iota._core import Body, Box, Capsule, Cylinder, HalfSpace, Mesh, Particle, Shape, Sphere, System, Torus, Vec3
from iota.simulator import Simulator
from iota.world.frames import turned

Array = NDArray[np.float64]
Indices = NDArray[np.intp]
Flags = NDArray[np.bool_]

GIVEN_BACK = 0.2  # share of the depth corrected in a step
LOAD_GAIN = 0.3  # share of the missing force added in a step
MOST_LOAD = 100.0  # times the weight of the body
MOST_FORCE = 0.99e9  # N, on a particle: the engine's limit
ROUNDS = 4  # over the points of a body
SINKING = 0.02  # share of the speed of a step of free fall that may remain
ROUND_POINTS = 8  # on a rim
DIRECTIONS = 26  # for the support points of a rounded body or a mesh
SAME = 1e-6  # relative error up to which four particles have kept their places on a body
CORNERS = np.array([[x, y, z] for x in (-1.0, 1.0) for y in (-1.0, 1.0) for z in (-1.0, 1.0)])  # of a box
UNITS = (Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1))
ALONE = np.array([[1.0, 0, 0, 0]])  # weights of a particle
NO_POINTS = (np.empty((0, 4)), np.empty(0))  # weights and radii


@dataclass
class Carrier:
    """Points of a body: of its shapes, or a particle. Up to four particles carry them: where each point is, and what it is
    pushed with, is their weighted sum."""

    body: Body
    number: int  # among those of the body; a particle's slot
    slots: list[int]  # of its particles; four
    weights: Array  # (n, 4), of each point
    radii: Array  # (n,), m
    is_solid: bool  # four particles span space, so that a push on the surface turns the body


@dataclass
class Known:
    """The carriers of a body, and what they follow from."""

    particles: list[Particle]
    traits: list[float]  # masses, radii and the like
    slots: list[int]  # of the particles that its mass is in
    masses: list[float]  # of those, kg
    edges: Array  # squares of distances of the particles that carry its shapes, m2
    carriers: list[Carrier]
    reach: float  # largest distance of a point from its particles, m


@dataclass(frozen=True)
class Impact:
    """A body that fell on the floor. position: m. speed: m/s."""

    position: Vec3
    speed: float


class Touches:
    """All points, as arrays with a row for each, and what is remembered of each."""

    def __init__(self, known: list[Known], is_joined: list[bool], before: Touches | None) -> None:
        carriers = [carrier for body in known for carrier in body.carriers]
        bodies = np.repeat(np.arange(len(known)), [len(body.carriers) for body in known])
        counts = [len(each.radii) for each in carriers]
        of = np.repeat(np.arange(len(carriers)), counts)
        starts = np.cumsum([0, *counts]).tolist()
        self.ranges = {
            (each.body, each.number): (start, count)
            for each, start, count in zip(carriers, starts[:-1], counts, strict=True)
        }
        self.bodies = bodies[of]
        self.slots = np.array([each.slots for each in carriers], np.intp).reshape(-1, 4)[of]
        self.rows = self.slots  # of `System.positions`
        self.weights = np.concatenate([np.empty((0, 4)), *(each.weights for each in carriers)])
        self.radius = np.concatenate([np.empty(0), *(each.radii for each in carriers)])
        self.is_solid = np.array([each.is_solid for each in carriers], bool)[of]
        self.is_joined = np.array(is_joined, bool)[self.bodies]  # other bodies are hinged to its body
        # Particles with a mass, body by body.
        self.mass_slots = np.array([slot for body in known for slot in body.slots], np.intp)
        self.mass_rows = self.mass_slots
        self.masses = np.array([mass for body in known for mass in body.masses], float)
        self.mass_bodies = np.repeat(np.arange(len(known)), [len(body.slots) for body in known])
        self.load = np.zeros(len(of))  # down, besides the weight of the body, N
        self.was_above = np.zeros(len(of), bool)
        self.is_touching = np.ones(len(of), bool)  # nothing that begins on the floor has fallen on it
        self.is_new = True
        for key, (start, count) in self.ranges.items():
            if before is not None and (found := before.ranges.get(key)) is not None:
                both = min(count, found[1])
                new, old = slice(start, start + both), slice(found[0], found[0] + both)
                self.load[new], self.was_above[new] = before.load[old], before.was_above[old]
                self.is_touching[new] = before.is_touching[old]

    def leave(self) -> None:
        """Resets the state: all points are above the floor."""
        self.load[:] = 0
        self.is_touching[:] = False
        self.was_above[:] = True


def level_below(system: System | Simulator) -> float:
    """Height of a ground below all bodies and the reach of those that hang from nails, m: at most 0."""
    places = system.positions
    if not len(places):
        return 0.0
    size = float(np.linalg.norm(np.ptp(places, axis=0)))
    lowest = float(places[:, 1].min())
    if isinstance(system, System):
        for part in system.articulates:
            particles = [p for body in part for p in body.particles]
            nails = [p.position for p in particles if p.is_nailed]
            if len(nails) == 1:  # it can swing
                lowest = min(lowest, nails[0].y - max(abs(p.position - nails[0]) for p in particles))
    return 0.0 if lowest >= -1e-6 * size else lowest - 0.1 * size


class Floor:
    """Keeps all moving bodies of a system above `height` m against gravity. friction: coefficient. A body of
    particles rests on balls of its `Body.radius`."""

    def __init__(
        self,
        system: System,
        height: float,
        friction: float = 0.6,
    ) -> None:
        self._system, self.height, self._friction = system, height, friction
        self._version = self._scene = self._row_count = -1
        self._touches: Touches | None = None
        self._particles: list[Particle] = []
        self._known: dict[Body, Known] = {}
        self._reach = 0.0  # largest distance of a point from the particles of its body, m
        self.impact: Impact | None = None  # the hardest of the last step

    def forget(self) -> None:
        """Call it after the system was restored."""
        self._version = self._scene = -1
        self._touches = None
        self._known = {}

    def push(self, dt: float) -> None:
        """Adds the floor's forces to the next step of dt s."""
        self.impact = None
        gravity = -self._system.gravity.y
        positions = self._system.positions
        if not (gravity > 0 and len(positions)):
            return
        velocities = self._system.velocities
        lowest = positions[:, 1].min() - self.height - self._reach
        is_clear = lowest > 0 and lowest + (velocities[:, 1].min() - gravity * dt) * dt > 0
        version = self._system.structure_version
        # Edits high above the floor have no effect, but new bodies may reach farther than all before.
        if self._touches is None or (self._version != version and not (is_clear and len(positions) == self._row_count)):
            self._version, self._row_count = version, len(positions)
            self._take_structure(positions)
            lowest = positions[:, 1].min() - self.height - self._reach
            is_clear = lowest > 0 and lowest + (velocities[:, 1].min() - gravity * dt) * dt > 0
        assert self._touches is not None
        if is_clear:
            self._touches.leave()
        elif len(self._touches.bodies):
            self._push(self._touches, positions, velocities, gravity, dt)

    # --- forces ---------------------------------------------------------------------------------------------------

    def _push(self, touches: Touches, positions: Array, velocities: Array, gravity: float, dt: float) -> None:
        heights = (positions[touches.rows, 1] * touches.weights).sum(axis=1) - touches.radius - self.height
        speeds = (velocities[touches.rows, 1] * touches.weights).sum(axis=1) - gravity * dt
        if touches.is_new:
            # Points that start below the floor are ignored until they have been above; a little below counts as on it.
            size = float(np.linalg.norm(np.ptp(positions, axis=0)))
            touches.was_above |= heights >= -(0.05 * size + 0.2 * self._reach)
            touches.is_new = False
        is_near = touches.was_above & ((heights < 0) | (heights + speeds * dt < 0))
        touches.was_above |= heights >= 0
        touches.load[~is_near] = 0
        self._find_impact(touches, positions, np.where(is_near & ~touches.is_touching, -speeds, 0), gravity, dt)
        touches.is_touching[:] = is_near
        near = np.flatnonzero(is_near)
        if not near.size:
            return
        rows, heights = touches.rows[near], heights[near]
        x, v, w = positions[rows], velocities[rows], touches.weights[near]
        is_solid = touches.is_solid[near]
        place = np.einsum("nij,ni->nj", x, w)
        place[:, 1] -= np.where(is_solid, touches.radius[near], 0)  # a particle is pushed at its middle
        w = weights_at(x, w, place, is_solid & (touches.radius[near] > 0))

        bodies, of = _moving(touches, near, positions, velocities)
        ways = bodies.ways_to(place, of)
        speed = np.einsum("ni,ni->n", v[:, :, 1], w)
        resting = touches.is_joined[near] & (np.abs(speed) < 4 * gravity * dt)
        load = touches.load[near]
        load[resting] -= LOAD_GAIN * ways.felt[resting, 1] * speed[resting] / dt
        load = np.clip(load, 0, MOST_LOAD * gravity * ways.felt[:, 1])
        touches.load[near] = load

        # Velocities after the next step without a floor.
        motion = bodies.motion
        motion[:, 1] -= gravity * dt
        np.add.at(motion, of, -ways.gain[:, :, 1] * (load * dt)[:, None])
        wanted = np.zeros((len(near), 3))
        # Depth is corrected slowly enough to throw no body higher than a tenth of it.
        depth = np.maximum(-heights, 0)
        wanted[:, 1] = np.where(
            heights < 0, np.minimum(GIVEN_BACK * depth / dt, np.sqrt(0.2 * gravity * depth)), -heights / dt
        )
        push = self._push_of(bodies, ways, of, wanted, is_solid, SINKING * gravity * dt)

        pushes = np.zeros_like(positions)
        np.add.at(pushes, rows, w[:, :, None] * (push / dt)[:, None, :])
        pushes = np.clip(pushes, -MOST_FORCE, MOST_FORCE)
        for row in np.unique(rows):
            self._particles[row].apply_force(Vec3(*pushes[row]))

    def _push_of(
        self, bodies: _Bodies, ways: _Ways, of: Indices, wanted: Array, is_solid: Flags, small: float
    ) -> Array:
        """Impulses at places `of` bodies, N s, by which they get the `wanted` speeds up to a small one, m/s. Adds them to the
        motion."""
        motion, push = bodies.motion, np.zeros((len(of), 3))
        turns = list(_turns(of))

        def improve() -> None:
            for _ in range(ROUNDS if len(turns) > 1 else 1):
                change = 0.0
                for which in turns:
                    body = of[which]
                    lacking = wanted[which] - np.einsum("nij,nj->ni", ways.speed[which], motion[body])
                    before = push[which]
                    after = before + ways.felt[which] * lacking
                    after[:, 1] = np.maximum(after[:, 1], 0)
                    _into_cone(after, self._friction)
                    push[which] = after
                    motion[body] += np.einsum("nij,nj->ni", ways.gain[which], after - before)
                    change = max(change, float(np.abs((after - before) / ways.felt[which]).max()))
                if change < 0.05 * small:
                    return

        improve()
        if len(turns) > 1:
            # A heavy body on light feet: a push on one foot turns the body more than it lifts it, and hundreds of rounds would
            # be needed. The pushes that stop it are calculated at once. The particles of a shape are never so unequal.
            lacking = wanted - np.einsum("nij,nj->ni", ways.speed, motion[of])
            slow = np.zeros(len(motion), bool)
            slow[of[(lacking[:, 1] > small) & ~is_solid]] = True
            if slow.any():
                which = np.flatnonzero(slow[of])
                np.add.at(motion, of[which], -np.einsum("nij,nj->ni", ways.gain[which], push[which]))
                unmet = wanted[which] - np.einsum("nij,nj->ni", ways.speed[which], motion[of[which]])
                push[which] = _balanced(ways.speed[which] @ bodies.root[of[which]], of[which], unmet)
                _into_cone(push, self._friction)
                np.add.at(motion, of[which], np.einsum("nij,nj->ni", ways.gain[which], push[which]))
                improve()
        return push

    def _find_impact(self, touches: Touches, positions: Array, speeds: Array, gravity: float, dt: float) -> None:
        """speeds: downwards, of points that come to the floor in this step, others 0, m/s."""
        hardest = int(speeds.argmax())
        # A body that only settles by the fall of a few steps makes no impact.
        if speeds[hardest] > 4 * gravity * dt:
            place = touches.weights[hardest] @ positions[touches.rows[hardest]]
            self.impact = Impact(Vec3(float(place[0]), self.height, float(place[2])), float(speeds[hardest]))

    # --- touch points -------------------------------------------------------------------------------------

    def _take_structure(self, positions: Array) -> None:
        """Lists the points again; if only sparks have changed, only the rows are updated."""
        self._particles = self._system.particles
        slots = np.fromiter((particle.slot for particle in self._particles), np.intp, len(self._particles))
        rows = np.full(slots.max() + 1, -1)
        rows[slots] = np.arange(len(slots))
        scene = self._system.scene_version
        if self._touches is None or scene != self._scene:
            self._scene = scene
            self._list(positions, rows)
        assert self._touches is not None
        self._touches.rows = rows[self._touches.slots]
        self._touches.mass_rows = rows[self._touches.mass_slots]

    def _list(self, positions: Array, row_of: Indices) -> None:
        """Of bodies that are as they were, what is known is used again."""
        joined = {part.number for part in self._system.articulates if len(part) > 1}
        bodies = [b for b in self._system.bodies if b.kind in ("dynamic", "resting") and not b.is_spark]
        particles = [body.particles for body in bodies]
        traits = [self._traits(body, its) for body, its in zip(bodies, particles, strict=True)]
        kept = self._kept(bodies, particles, traits, positions, row_of)
        is_joined: list[bool] = []
        self._known, self._reach = {}, 0.0
        for body, its, numbers in zip(bodies, particles, traits, strict=True):
            known = kept.get(body) or self._describe(body, its, numbers, positions, row_of)
            self._known[body] = known
            is_joined.append(body.articulate.number in joined)
            self._reach = max(self._reach, known.reach)
        self._touches = Touches(list(self._known.values()), is_joined, self._touches)

    def _kept(
        self,
        bodies: list[Body],
        particles: list[list[Particle]],
        traits: list[list[float]],
        positions: Array,
        row_of: Indices,
    ) -> dict[Body, Known]:
        """The kept data of bodies that have not changed."""
        same = {
            body: known
            for body, its, numbers in zip(bodies, particles, traits, strict=True)
            if (known := self._known.get(body)) is not None and known.traits == numbers and known.particles == its
        }
        solid = [body for body, known in same.items() if len(known.edges)]
        if solid:  # of those the script may have moved a particle
            slots = np.array([same[body].slots[:4] for body in solid])
            before = np.array([same[body].edges for body in solid])
            off = np.abs(edges_of(positions[row_of[slots]]) - before).max(axis=1) > SAME * before.max(axis=1)
            for number in np.flatnonzero(off):
                del same[solid[number]]
        return same

    def _traits(self, body: Body, particles: list[Particle]) -> list[float]:
        """Numbers that its carriers depend on, besides its particles."""
        traits = [particle.mass for particle in particles]
        solids = len(body.solids)
        traits.append(solids)
        if not (solids and len(particles) >= 4):
            traits.append(body.radius)
            traits += [particle.radius if particle.has_attributes else 0 for particle in particles]
        return traits

    def _describe(
        self, body: Body, particles: list[Particle], traits: list[float], positions: Array, row_of: Indices
    ) -> Known:
        slots, masses = [p.slot for p in particles], [p.mass for p in particles]
        corners = positions[row_of[slots[:4]]]
        weights, radii = _of_shapes(body, corners) if body.solids and len(slots) >= 4 else NO_POINTS
        if len(radii):
            reaches = radii + np.linalg.norm(weights @ corners - corners[0], axis=1)
            carrier = Carrier(body, -1, slots[:4], weights, radii, True)
            edges = edges_of(corners[None])[0]
            return Known(particles, traits, slots[:4], masses[:4], edges, [carrier], float(reaches.max()))
        heavy = [n for n, mass in enumerate(masses) if mass > 0]
        held, their_masses = [slots[n] for n in heavy], [masses[n] for n in heavy]
        thick = np.array(
            [p.radius if p.has_attributes and p.radius > 0 else body.radius for p in (particles[n] for n in heavy)]
        )
        carriers = [
            Carrier(body, held[n], [held[n]] * 4, ALONE, thick[n : n + 1], False)
            for n in _outermost(positions[row_of[held]], thick)
        ]
        reach = float(thick.max(initial=0.0))
        is_flat = bool(body.solids) and len(slots) >= 4  # its traits do not have radii
        return Known(particles, [] if is_flat else traits, held, their_masses, np.empty(0), carriers, reach)


def _outermost(places: Array, radii: Array) -> list[int]:
    """Of a body of many particles, those that are farthest in some directions; otherwise all."""
    if len(places) <= DIRECTIONS:
        return list(range(len(places)))
    return sorted(set(np.argmax(places @ _directions().T + radii[:, None], axis=0).tolist()))


def edges_of(corners: Array) -> Array:
    """Squares of the distances of four points: (n, 4, 3) -> (n, 6)."""
    ways = corners[:, [0, 0, 0, 1, 1, 2]] - corners[:, [1, 2, 3, 2, 3, 3]]
    return np.asarray(np.einsum("nij,nij->ni", ways, ways))


@dataclass
class _Ways:
    """The relation between places on bodies and the motion of those bodies (velocity and spin, six numbers)."""

    speed: Array  # (n, 3, 6): motion -> velocity of the place
    gain: Array  # (n, 6, 3): push at the place, N s -> change of motion
    felt: Array  # (n, 3): effective mass along x, y or z, kg


def _moving(touches: Touches, near: Indices, positions: Array, velocities: Array) -> tuple[_Bodies, Indices]:
    """The bodies of the near points, and for each point which of them."""
    numbers, of = np.unique(touches.bodies[near], return_inverse=True)
    place = np.full(touches.bodies.max() + 1, -1)
    place[numbers] = np.arange(len(numbers))
    mass_of = place[touches.mass_bodies]
    which = np.flatnonzero(mass_of >= 0)
    rows = touches.mass_rows[which]
    return _Bodies(positions[rows], velocities[rows], touches.masses[which], mass_of[which], len(numbers)), of


class _Bodies:
    """Rigid bodies of point masses, x, v: (n, 3), m, of: (n,), without other forces."""

    def __init__(self, x: Array, v: Array, m: Array, of: Indices, count: int) -> None:
        self.mass = np.bincount(of, m, count)
        self.center = _sums(x * m[:, None], of, count) / self.mass[:, None]
        velocity = _sums(v * m[:, None], of, count) / self.mass[:, None]
        arms = x - self.center[of]
        inertia = _sums(m[:, None, None] * ((arms**2).sum(axis=1)[:, None, None] * np.eye(3)), of, count)
        inertia -= _sums(m[:, None, None] * arms[:, :, None] * arms[:, None, :], of, count)
        size = np.trace(inertia, axis1=1, axis2=2)
        self._inverse = np.zeros_like(inertia)
        spread = size > 0
        # A rod has no inertia about its own axis, but no force has an arm about it either.
        self._inverse[spread] = np.linalg.inv(inertia[spread] + 1e-9 * size[spread, None, None] * np.eye(3))
        momentum = _sums(np.cross(arms, v - velocity[of]) * m[:, None], of, count)
        self.motion = np.hstack([velocity, np.einsum("njk,nk->nj", self._inverse, momentum)])
        self._spread = spread

    @property
    def root(self) -> Array:
        """Of the inverse of mass and inertia: (n, 6, 6)."""
        root = np.zeros((len(self.mass), 6, 6))
        root[:, :3, :3] = np.eye(3) / np.sqrt(self.mass)[:, None, None]
        root[self._spread, 3:, 3:] = np.linalg.cholesky(self._inverse[self._spread])
        return root

    def ways_to(self, place: Array, of: Indices) -> _Ways:
        """place: (n, 3), m. of: the body of each."""
        cross = _crosses(place - self.center[of])
        unit = np.broadcast_to(np.eye(3), cross.shape)
        speed = np.concatenate([unit, -cross], axis=2)
        gain = np.concatenate([unit / self.mass[of, None, None], self._inverse[of] @ cross], axis=1)
        return _Ways(speed, gain, 1 / np.einsum("nij,nji->ni", speed, gain))


def _balanced(ways: Array, of: Indices, lacking: Array) -> Array:
    """The smallest impulses at places, N s, that change their speeds by what is lacking, or as nearly so as rigid bodies can,
    and pull at none. ways: (n, 3, 6), of a motion of bodies in which each number is scaled to the same energy."""
    count = int(of.max()) + 1
    pushed = np.ones(len(of), bool)
    push = np.zeros((len(of), 3))
    for _ in range(ROUNDS):  # a place that would be pulled at is left out
        used = np.where(pushed[:, None, None], ways, 0)
        pinv = np.linalg.pinv(_sums(np.einsum("nij,nik->njk", used, used), of, count), 1e-10, True)
        change = _sums(np.einsum("nij,ni->nj", used, lacking), of, count)
        push = np.einsum("nij,nj->ni", used, np.einsum("nij,njk,nk->ni", pinv, pinv, change)[of])
        if (push[:, 1] >= 0).all():
            break
        pushed &= push[:, 1] > 0
    push[push[:, 1] < 0] = 0
    return push


def _sums(values: Array, of: Indices, count: int) -> Array:
    """Of each body: (n, ...) -> (count, ...)."""
    out = np.zeros((count, *values.shape[1:]))
    np.add.at(out, of, values)
    return out


def _crosses(arms: Array) -> Array:
    """Matrices that give arm x v: (..., 3) -> (..., 3, 3)."""
    out = np.zeros((*arms.shape, 3))
    x, y, z = arms[..., 0], arms[..., 1], arms[..., 2]
    out[..., 0, 1], out[..., 0, 2] = -z, y
    out[..., 1, 0], out[..., 1, 2] = z, -x
    out[..., 2, 0], out[..., 2, 1] = -y, x
    return out


def _into_cone(force: Array, friction: float) -> None:
    """Limits the horizontal parts to `friction` times the vertical ones."""
    sideways = np.hypot(force[:, 0], force[:, 2])
    most = friction * force[:, 1]
    scale = np.where(sideways > most, most / np.maximum(sideways, 1e-300), 1.0)
    force[:, 0] *= scale
    force[:, 2] *= scale


def _turns(of: Indices) -> Iterator[Indices]:
    """Groups the points: all first ones of bodies, all second ones, and so on."""
    order = np.argsort(of, kind="stable")
    starts = np.flatnonzero(np.diff(of[order], prepend=-1))
    rank = np.empty(len(of), np.intp)
    rank[order] = np.arange(len(of)) - np.repeat(starts, np.diff(starts, append=len(of)))
    return (np.flatnonzero(rank == turn) for turn in range(rank.max() + 1))


def weights_at(x: Array, w: Array, place: Array, which: Flags) -> Array:
    """Weights of four points each, x: (n, 4, 3), whose weighted sum is a place; rows that are not requested stay as in
    `w`."""
    if not which.any():
        return w
    w = w.copy()
    edges = np.swapaxes(x[which, 1:] - x[which, :1], 1, 2)
    shares = np.linalg.solve(edges, (place[which] - x[which, 0])[:, :, None])[:, :, 0]
    w[which, 1:] = shares
    w[which, 0] = 1 - shares.sum(axis=1)
    return w


def _of_shapes(body: Body, corners: Array) -> tuple[Array, Array]:
    """Of each point at which a body's shapes can touch: weights of four particles (n, 4), and radius (n,)."""
    edges = (corners[1:] - corners[0]).T
    if abs(np.linalg.det(edges)) < 1e-9 * np.abs(edges).max() ** 3:
        return NO_POINTS
    places, radii = [np.empty((0, 3))], [np.empty(0)]
    for solid in body.solids:
        local, thickness = touching_points(solid.shape)
        axes = [tuple(turned(solid.orientation, unit)) for unit in UNITS]
        places.append(np.array(tuple(solid.position)) + local @ np.array(axes))
        radii.append(np.full(len(local), thickness))
    shares = np.linalg.solve(edges, (np.concatenate(places) - corners[0]).T).T
    return np.hstack([1 - shares.sum(axis=1, keepdims=True), shares]), np.concatenate(radii)


def touching_points(shape: Shape) -> tuple[Array, float]:
    """Round points, in the frame of a shape, whose hull is about the shape's: places (n, 3) and their radius, m."""
    if isinstance(shape, Sphere):
        return np.zeros((1, 3)), shape.radius
    if isinstance(shape, Capsule):
        return np.array([[side * shape.length / 2, 0, 0] for side in (-1, 1)]), shape.radius
    if isinstance(shape, Box):
        return CORNERS * (np.array(tuple(shape.size)) / 2 - shape.rounding), shape.rounding
    around = 2 * np.pi * (np.arange(ROUND_POINTS) + 0.5) / ROUND_POINTS
    if isinstance(shape, Cylinder):
        rim = np.stack([0 * around, np.cos(around), np.sin(around)], axis=1) * (shape.radius - shape.rounding)
        half = shape.length / 2 - shape.rounding
        return np.concatenate([rim + [side * half, 0, 0] for side in (-1, 1)]), shape.rounding
    if isinstance(shape, Torus):
        ring = np.stack([np.cos(around), np.sin(around), 0 * around], axis=1) * shape.radius
        ring[:, 0] += np.sign(ring[:, 0]) * shape.stretch / 2
        return ring, shape.tube
    if isinstance(shape, Mesh):
        vertices = np.array([tuple(v) for v in shape.vertices])
        return vertices[np.unique(np.argmax(vertices @ _directions().T, axis=0))], 0.0
    if isinstance(shape, HalfSpace):
        return np.empty((0, 3)), 0.0
    return support_points(shape, _directions()), 0.0


def support_points(shape: Shape, directions: Array) -> Array:
    """The points of a bounded shape, or of its convex hull, that are farthest in some directions, in its frame: (n, 3), m."""
    # The point nearest to a far place is the farthest in its direction.
    far = 1e3 * max(abs(number) for number in shape.numbers)
    return np.array([tuple(shape.closest(tuple(far * direction))) for direction in directions])


def _directions() -> Array:
    """Uniform directions: a spiral on the sphere."""
    n = np.arange(DIRECTIONS)
    height = 1 - 2 * (n + 0.5) / DIRECTIONS
    turn = n * np.pi * (3 - np.sqrt(5))
    side = np.sqrt(1 - height**2)
    return np.stack([side * np.cos(turn), height, side * np.sin(turn)], axis=1)
