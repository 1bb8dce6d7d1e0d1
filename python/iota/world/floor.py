# SPDX-License-Identifier: Apache-2.0
"""A level floor that holds particles and bodies, by forces that are worked out once a step.

Where a body can touch the floor is a list of round points, fixed on the body: its particles, or the corners, rims and ends of its
shape. Each step finds the pushes that stop those points at the floor, with dry friction, as if nothing but gravity acted on their
body (sequential impulses: E. Catto, Iterative Dynamics with Temporal Coherence, GDC 2005). What else hangs on the body shows as a
speed that a resting point should not have: `load` learns it, a part each step. A floor that is rows of the solver would need none
of this.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from iota._core import Body, Box, Capsule, Cylinder, HalfSpace, Mesh, Particle, Shape, Sphere, System, Torus, Vec3
from iota.simulator import Simulator
from iota.world.frames import turned

Array = NDArray[np.float64]
Indices = NDArray[np.intp]
Flags = NDArray[np.bool_]

GIVEN_BACK = 0.2  # of the depth in a step
LOAD_GAIN = 0.3  # of what is lacking, a step
MOST_LOAD = 100.0  # times the weight of what is pushed
MOST_FORCE = 0.99e9  # N, on a particle: the engine takes no larger one
ROUNDS = 4  # over the points of a body
ROUND_POINTS = 8  # on a rim
DIRECTIONS = 26  # in which a rounded body or a mesh is looked at


@dataclass
class Touch:
    """One point at which a body can touch. Up to four particles carry it: where it is, and what it is pushed with, is their
    weighted sum."""

    key: tuple[Body, int]
    carrier: int  # what it is a part of: a solid, or a particle by itself
    rows: list[int]  # of `System.positions`; four
    weights: list[float]
    masses: list[float]  # kg
    radius: float  # m
    is_solid: bool  # four particles span space, so that a push on the surface turns the body
    is_joined: bool  # other bodies hang on its body


class Touches:
    """All of them, as arrays with a row for each, and what is remembered of each."""

    def __init__(self, touches: list[Touch], before: Touches | None) -> None:
        self.keys = [touch.key for touch in touches]
        self.carriers = np.array([touch.carrier for touch in touches], np.intp)
        self.rows = np.array([touch.rows for touch in touches], np.intp).reshape(-1, 4)
        self.weights = np.array([touch.weights for touch in touches], float).reshape(-1, 4)
        self.masses = np.array([touch.masses for touch in touches], float).reshape(-1, 4)
        self.radius = np.array([touch.radius for touch in touches], float)
        self.is_solid = np.array([touch.is_solid for touch in touches], bool)
        self.is_joined = np.array([touch.is_joined for touch in touches], bool)
        self.load = np.zeros(len(touches))  # down, besides the weight of the body, N
        self.was_above = np.zeros(len(touches), bool)
        self.is_new = True
        known = {} if before is None else {key: index for index, key in enumerate(before.keys)}
        for index, key in enumerate(self.keys):
            if before is not None and (old := known.get(key)) is not None:
                self.load[index], self.was_above[index] = before.load[old], before.was_above[old]

    def leave(self) -> None:
        """All of them are above."""
        self.load[:] = 0
        self.was_above[:] = True


def level_below(system: System | Simulator) -> float:
    """A height of the ground under all that is there and what hangs from nails, m: 0, or lower where that is lower."""
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
    """Holds all that moves in a system above `height` m, where gravity draws it down. friction: coefficient. thickness_of: radius
    of what a body of particles is drawn with, m; it rests on that."""

    def __init__(
        self,
        system: System,
        height: float,
        thickness_of: Callable[[Body], float] = lambda _: 0.0,
        friction: float = 0.6,
    ) -> None:
        self._system, self.height, self._friction, self._thickness_of = system, height, friction, thickness_of
        self._version = self._row_count = -1
        self._touches: Touches | None = None
        self._particles: list[Particle] = []
        self._bodies: list[Body] = []
        self._slots: Indices = np.empty((0, 4), np.intp)  # of the particles in `rows`
        self._particle_count = 0
        self._reach = 0.0  # how far a point is from the particles of its body, at most, m

    def forget(self) -> None:
        """After the system was restored."""
        self._version = -1
        self._touches = None

    def push(self, dt: float) -> None:
        """Adds the floor's forces to the next step of dt s."""
        gravity = -self._system.gravity.y
        positions = self._system.positions
        if not (gravity > 0 and len(positions)):
            return
        velocities = self._system.velocities
        lowest = positions[:, 1].min() - self.height - self._reach
        is_clear = lowest > 0 and lowest + (velocities[:, 1].min() - gravity * dt) * dt > 0
        version = self._system.structure_version
        # What is cut or joined high above the floor is of no concern; what is new may reach farther than all before.
        if self._touches is None or (self._version != version and not (is_clear and len(positions) == self._row_count)):
            self._version, self._row_count = version, len(positions)
            self._take_structure(positions)
            lowest = positions[:, 1].min() - self.height - self._reach
            is_clear = lowest > 0 and lowest + (velocities[:, 1].min() - gravity * dt) * dt > 0
        assert self._touches is not None
        if is_clear:
            self._touches.leave()
        elif self._touches.keys:
            self._push(self._touches, positions, velocities, gravity, dt)

    # --- forces ---------------------------------------------------------------------------------------------------

    def _push(self, touches: Touches, positions: Array, velocities: Array, gravity: float, dt: float) -> None:
        heights = (positions[touches.rows, 1] * touches.weights).sum(axis=1) - touches.radius - self.height
        speeds = (velocities[touches.rows, 1] * touches.weights).sum(axis=1) - gravity * dt
        if touches.is_new:
            # What begins below the floor is left there until it has been above; a little below is on it.
            size = float(np.linalg.norm(np.ptp(positions, axis=0)))
            touches.was_above |= heights >= -(0.05 * size + 0.2 * self._reach)
            touches.is_new = False
        is_near = touches.was_above & ((heights < 0) | (heights + speeds * dt < 0))
        touches.was_above |= heights >= 0
        touches.load[~is_near] = 0
        near = np.flatnonzero(is_near)
        if not near.size:
            return
        rows, heights = touches.rows[near], heights[near]
        x, v, m = positions[rows], velocities[rows], touches.masses[near]
        w = touches.weights[near]
        place = np.einsum("nij,ni->nj", x, w)
        place[:, 1] -= touches.radius[near]
        w = weights_at(x, w, place, touches.is_solid[near] & (touches.radius[near] > 0))

        _, first, of = np.unique(touches.carriers[near], return_index=True, return_inverse=True)
        bodies = _Bodies(x[first], v[first], m[first])
        ways = bodies.ways_to(place, of)
        speed = np.einsum("ni,ni->n", v[:, :, 1], w)
        resting = touches.is_joined[near] & (np.abs(speed) < 4 * gravity * dt)
        load = touches.load[near]
        load[resting] -= LOAD_GAIN * ways.felt[resting, 1] * speed[resting] / dt
        load = np.clip(load, 0, MOST_LOAD * gravity * ways.felt[:, 1])
        touches.load[near] = load

        # As the next step would leave the bodies without a floor.
        motion = bodies.motion
        motion[:, 1] -= gravity * dt
        np.add.at(motion, of, -ways.gain[:, :, 1] * (load * dt)[:, None])
        wanted = np.zeros((len(near), 3))
        # Depth is given back slowly enough to throw nothing higher than a tenth of it.
        depth = np.maximum(-heights, 0)
        wanted[:, 1] = np.where(
            heights < 0, np.minimum(GIVEN_BACK * depth / dt, np.sqrt(0.2 * gravity * depth)), -heights / dt
        )
        push = np.zeros((len(near), 3))  # N s
        turns = list(_turns(of))
        for _ in range(ROUNDS if len(turns) > 1 else 1):
            for which in turns:
                body = of[which]
                lacking = wanted[which] - np.einsum("nij,nj->ni", ways.speed[which], motion[body])
                before = push[which]
                after = before + ways.felt[which] * lacking
                after[:, 1] = np.maximum(after[:, 1], 0)
                _into_cone(after, self._friction)
                push[which] = after
                motion[body] += np.einsum("nij,nj->ni", ways.gain[which], after - before)

        pushes = np.zeros_like(positions)
        np.add.at(pushes, rows, w[:, :, None] * (push / dt)[:, None, :])
        pushes = np.clip(pushes, -MOST_FORCE, MOST_FORCE)
        for row in np.unique(rows):
            self._particles[row].apply_force(Vec3(*pushes[row]))

    # --- where bodies can touch -------------------------------------------------------------------------------------

    def _take_structure(self, positions: Array) -> None:
        """Lists points anew; where only sparks have come and gone, their rows are enough."""
        self._particles = self._system.particles
        slots = np.fromiter((particle.slot for particle in self._particles), np.intp, len(self._particles))
        rows = np.full(slots.max() + 1, -1)
        rows[slots] = np.arange(len(slots))
        everything = self._system.bodies
        bodies = [body for body in everything if not body.is_spark]
        count = len(slots) - (len(everything) - len(bodies))  # each spark is a body of one particle
        if self._touches is not None and count == self._particle_count and bodies == self._bodies:
            found = rows[np.minimum(self._slots, len(rows) - 1)]
            if (slots[found] == self._slots).all():
                self._touches.rows = found
                return
        self._bodies, self._particle_count = bodies, count
        self._list(positions, rows)
        assert self._touches is not None
        self._slots = slots[self._touches.rows]

    def _list(self, positions: Array, row_of: Indices) -> None:
        touches: list[Touch] = []
        self._reach = 0.0
        carrier = 0
        for body in self._bodies:
            if body.kind not in ("dynamic", "resting"):
                continue
            is_joined = len(body.articulate) > 1
            particles = body.particles
            rows, masses = [int(row_of[p.slot]) for p in particles], [p.mass for p in particles]
            corners = positions[rows[:4]]
            found = list(_of_shapes(body, corners)) if body.solids and len(rows) >= 4 else []
            carrier += 1
            for index, (weights, radius) in enumerate(found):
                touches.append(
                    Touch((body, index), carrier, rows[:4], list(weights), masses[:4], radius, True, is_joined)
                )
                self._reach = max(self._reach, radius + float(np.linalg.norm(weights @ corners - corners[0])))
            if found:
                continue
            thickness = self._thickness_of(body)
            for particle, row, mass in zip(particles, rows, masses, strict=True):
                carrier += 1
                if mass <= 0:
                    continue
                radius = particle.radius if particle.has_attributes and particle.radius > 0 else thickness
                key = (body, particle.slot)
                touches.append(Touch(key, carrier, [row] * 4, [1, 0, 0, 0], [mass, 0, 0, 0], radius, False, is_joined))
                self._reach = max(self._reach, radius)
        self._touches = Touches(touches, self._touches)


@dataclass
class _Ways:
    """How places on bodies and the motion of those bodies (velocity and spin, six numbers) hang together."""

    speed: Array  # (n, 3, 6): motion -> velocity of the place
    gain: Array  # (n, 6, 3): push at the place, N s -> change of motion
    felt: Array  # (n, 3): mass that a push along x, y or z feels, kg


class _Bodies:
    """Rigid bodies of up to four point masses each, x, v: (n, 4, 3), m: (n, 4), as long as nothing else acts on them."""

    def __init__(self, x: Array, v: Array, m: Array) -> None:
        self.mass = m.sum(axis=1)
        self.center = np.einsum("nij,ni->nj", x, m) / self.mass[:, None]
        velocity = np.einsum("nij,ni->nj", v, m) / self.mass[:, None]
        arms = x - self.center[:, None, :]
        inertia = np.einsum("ni,ni,jk->njk", m, (arms**2).sum(axis=2), np.eye(3))
        inertia -= np.einsum("ni,nij,nik->njk", m, arms, arms)
        size = np.trace(inertia, axis1=1, axis2=2)
        self._inverse = np.zeros_like(inertia)
        spread = size > 0
        # A rod has none about its own axis: there nothing can be pushed with an arm.
        self._inverse[spread] = np.linalg.inv(inertia[spread] + 1e-9 * size[spread, None, None] * np.eye(3))
        momentum = np.einsum("nijk,nik,ni->nj", _crosses(arms), v - velocity[:, None, :], m)
        self.motion = np.hstack([velocity, np.einsum("njk,nk->nj", self._inverse, momentum)])

    def ways_to(self, place: Array, of: Indices) -> _Ways:
        """place: (n, 3), m. of: the body of each."""
        cross = _crosses(place - self.center[of])
        unit = np.broadcast_to(np.eye(3), cross.shape)
        speed = np.concatenate([unit, -cross], axis=2)
        gain = np.concatenate([unit / self.mass[of, None, None], self._inverse[of] @ cross], axis=1)
        return _Ways(speed, gain, 1 / np.einsum("nij,nji->ni", speed, gain))


def _crosses(arms: Array) -> Array:
    """Matrices that give arm x v: (..., 3) -> (..., 3, 3)."""
    out = np.zeros((*arms.shape, 3))
    x, y, z = arms[..., 0], arms[..., 1], arms[..., 2]
    out[..., 0, 1], out[..., 0, 2] = -z, y
    out[..., 1, 0], out[..., 1, 2] = z, -x
    out[..., 2, 0], out[..., 2, 1] = -y, x
    return out


def _into_cone(force: Array, friction: float) -> None:
    """Shortens the sideways parts to `friction` of the upward ones."""
    sideways = np.hypot(force[:, 0], force[:, 2])
    most = friction * force[:, 1]
    scale = np.where(sideways > most, most / np.maximum(sideways, 1e-300), 1.0)
    force[:, 0] *= scale
    force[:, 2] *= scale


def _turns(of: Indices) -> Iterator[Indices]:
    """Which points are the first of their body, which the second, and so on."""
    order = np.argsort(of, kind="stable")
    starts = np.flatnonzero(np.diff(of[order], prepend=-1))
    rank = np.empty(len(of), np.intp)
    rank[order] = np.arange(len(of)) - np.repeat(starts, np.diff(starts, append=len(of)))
    return (np.flatnonzero(rank == turn) for turn in range(rank.max() + 1))


def weights_at(x: Array, w: Array, place: Array, which: Flags) -> Array:
    """Weights of four points each, x: (n, 4, 3), whose sum is at a place; those not asked for as they are in `w`."""
    if not which.any():
        return w
    w = w.copy()
    edges = np.swapaxes(x[which, 1:] - x[which, :1], 1, 2)
    shares = np.linalg.solve(edges, (place[which] - x[which, 0])[:, :, None])[:, :, 0]
    w[which, 1:] = shares
    w[which, 0] = 1 - shares.sum(axis=1)
    return w


def _of_shapes(body: Body, corners: Array) -> Iterable[tuple[Array, float]]:
    """Weights of four particles, and radius, of each point at which a body's shapes can touch."""
    edges = (corners[1:] - corners[0]).T
    if abs(np.linalg.det(edges)) < 1e-9 * np.abs(edges).max() ** 3:
        return
    inverse = np.linalg.inv(edges)
    for solid in body.solids:
        for local, radius in touching_points(solid.shape):
            place = np.array(tuple(solid.position + turned(solid.orientation, Vec3(*local))))
            shares = inverse @ (place - corners[0])
            yield np.array([1 - shares.sum(), *shares]), radius


def touching_points(shape: Shape) -> list[tuple[Array, float]]:
    """Round points, in the frame of a shape, whose hull is about the shape's: places and radii, m."""
    if isinstance(shape, Sphere):
        return [(np.zeros(3), shape.radius)]
    if isinstance(shape, Capsule):
        return [(np.array([side * shape.length / 2, 0, 0]), shape.radius) for side in (-1, 1)]
    if isinstance(shape, Box):
        half = np.array(tuple(shape.size)) / 2 - shape.rounding
        signs = np.stack(np.meshgrid([-1, 1], [-1, 1], [-1, 1]), axis=-1).reshape(-1, 3)
        return [(half * sign, shape.rounding) for sign in signs]
    around = 2 * np.pi * (np.arange(ROUND_POINTS) + 0.5) / ROUND_POINTS
    if isinstance(shape, Cylinder):
        rim = np.stack([0 * around, np.cos(around), np.sin(around)], axis=1) * shape.radius
        return [(place + [side * shape.length / 2, 0, 0], 0.0) for side in (-1, 1) for place in rim]
    if isinstance(shape, Torus):
        ring = np.stack([np.cos(around), np.sin(around), 0 * around], axis=1) * shape.radius
        ring[:, 0] += np.sign(ring[:, 0]) * shape.stretch / 2
        return [(place, shape.tube) for place in ring]
    if isinstance(shape, Mesh):
        vertices = np.array([tuple(v) for v in shape.vertices])
        return [(vertices[i], 0.0) for i in np.unique(np.argmax(vertices @ _directions().T, axis=0))]
    if isinstance(shape, HalfSpace):
        return []
    # What of a convex shape is nearest to a place far off lies farthest out in that direction.
    far = 1e3 * max(abs(number) for number in shape.numbers)
    return [(np.array(tuple(shape.closest(tuple(far * d)))), 0.0) for d in _directions()]


def _directions() -> Array:
    """All around, evenly: a spiral on the ball."""
    n = np.arange(DIRECTIONS)
    height = 1 - 2 * (n + 0.5) / DIRECTIONS
    turn = n * np.pi * (3 - np.sqrt(5))
    side = np.sqrt(1 - height**2)
    return np.stack([side * np.cos(turn), height, side * np.sin(turn)], axis=1)
