# SPDX-License-Identifier: Apache-2.0
"""How deep what is drawn of a world lies in what else is drawn."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

import iota
from iota import looks
from iota.frames import axes_of, turn_from_x
from iota.world.visuals import listed

Array = np.ndarray[Any, np.dtype[np.float64]]

PLACES = 24  # of a shape, at its surface, and as many below it
NEAR = 0.03  # m: so near to its nail or its joint to the world, a body is at what holds it
SMALL = 0.008  # m: nobody sees a knot of a cloth in another one
GROUND = "ground"
SURFACES = ("on_surface", "inside", "outside")  # kinds of constraints by which nothing is held


@dataclass
class Piece:
    """A drawn shape. owner: body or bond; place: of its origin, m; turn: (3, 3), from its frame to the world."""

    owner: Any
    shape: iota.types.Shape
    place: Array
    turn: Array

    @property
    def bounds(self) -> tuple[Array, Array]:
        """Of its own box, in its frame, m."""
        low, high = self.shape.bounds
        return np.array(tuple(low)), np.array(tuple(high))

    @property
    def box(self) -> Array:
        """Lowest and highest corner of a box around it along the world's axes, m."""
        low, high = self.bounds
        middle, half = self.place + self.turn @ ((low + high) / 2), (high - low) / 2
        if isinstance(self.shape, iota.Sphere | iota.Capsule) or (
            isinstance(self.shape, iota.Torus) and not self.shape.stretch
        ):
            radius = half.min()  # of a ball that goes along a segment or a circle
            half = np.sqrt(self.turn**2 @ (half - radius) ** 2) + radius
        elif isinstance(self.shape, iota.Ellipsoid):
            half = np.sqrt(self.turn**2 @ half**2)
        else:
            half = np.abs(self.turn) @ half
        return np.array([middle - half, middle + half])

    @property
    def size(self) -> float:
        """Longest side of its own box, m."""
        low, high = self.bounds
        return float(np.max(high - low))

    def depth(self, places: Array) -> Array:
        """How deep places of the world are below its surface, m; negative outside."""
        distance = self.shape.distance
        return np.array([-distance(place) for place in ((places - self.place) @ self.turn).tolist()])


@dataclass
class Overlap:
    """Of two things, or of one with the ground. depth: m; share: of the longest side of the smaller shape; time: s."""

    a: Any
    b: Any
    depth: float
    share: float
    time: float


class Drawn:
    """What is drawn of a world in one of its styles."""

    def __init__(self, world: iota.World, style: str = "") -> None:
        self.world, self.style = world, style
        self._known: dict[Any, Array] = {}
        self._fixed = [
            piece
            for body in world.system.obstacles if body != world.scene.ground_body
            for piece in self._of(body)
        ]  # fmt: skip

    def overlaps(self, least: float) -> list[Overlap]:
        """Of things that do not meet by design, as deep as they are in the next picture; least: share."""
        world = self.world
        world._inputs.frame()  # what the script does before each picture
        pieces = [*self._of_bodies(), *self._of_springs(), *self._fixed]
        boxes, moving = np.array([piece.box for piece in pieces]), len(pieces) - len(self._fixed)
        meeting, held = joined(world), held_at(world)
        rooted = {body for body, _ in held}
        found: list[Overlap] = []

        def add(a: Any, b: Any, depth: float, size: float) -> None:
            if depth > least * size:
                found.append(Overlap(a, b, depth, depth / size, world.system.time))

        for k, a in enumerate(pieces[:moving]):
            if world.scene.ground is not None and a.owner not in rooted:
                add(a.owner, GROUND, world.scene.ground - boxes[k, 0, 1], a.size)
            near = (boxes[:, 0] < boxes[k, 1]).all(axis=1) & (boxes[:, 1] > boxes[k, 0]).all(axis=1)
            near[: k + 1] = False
            for n in np.flatnonzero(near):
                b = pieces[n]
                if b.owner == a.owner or not meeting.get(a.owner, {a.owner}).isdisjoint(
                    meeting.get(b.owner, {b.owner})
                ):
                    continue
                if n >= moving:
                    mine = [place for body, place in held if body in (a.owner, *meeting.get(a.owner, ()))]
                    if mine and b.depth(np.array(mine)).max() > -NEAR:
                        continue
                add(a.owner, b.owner, self._depth(a, b), min(a.size, b.size))
        return found

    def _depth(self, a: Piece, b: Piece) -> float:
        """Convex shapes overlap by the largest sum of a place's depths in both; negative if they do not."""
        small, large = sorted((a, b), key=lambda piece: piece.size)
        low, high = small.bounds
        reach = float(np.linalg.norm(high - low)) / 2
        outside = -large.depth((small.place + small.turn @ ((low + high) / 2))[None])[0]
        if outside > reach:  # by one distance instead of dozens, which are slow to a room
            return reach - float(outside)
        places = np.concatenate([self._places(a), self._places(b)])
        return float((a.depth(places) + b.depth(places)).max())

    def _places(self, piece: Piece) -> Array:
        if piece.shape not in self._known:
            (low, high), random = piece.bounds, np.random.default_rng(1)
            # From outside of its box the nearest points are also those of edges and corners.
            around = [low + share * (high - low) for share in random.uniform(-0.3, 1.3, (PLACES, 3))]
            surface = np.array([tuple(piece.shape.closest(place)) for place in around])
            middle = (low + high) / 2
            below = middle + np.linspace(0, 0.9, PLACES)[:, None] * (surface - middle)
            self._known[piece.shape] = np.concatenate([surface, below])
        return piece.place + self._known[piece.shape] @ piece.turn.T

    def _styled(self, drawn: looks.Looks | None) -> list[looks.Look]:
        return listed(drawn.get(self.style, drawn.get("*", []))) if drawn else []

    def _of_bodies(self) -> Iterator[Piece]:
        for body in self.world.system.bodies:
            if not body.is_spark:
                yield from self._of(body)

    def _of(self, body: iota.Body) -> Iterator[Piece]:
        solids = [
            Piece(body, solid.shape, np.array(tuple(solid.position)), axes_of(solid.orientation))
            for solid in body.solids
        ]
        known = self._styled(self.world.scene.look_of(body))
        if not known:
            yield from solids
        place, turn = np.array(tuple(body.position)), axes_of(body.orientation)
        for look in known:
            if look.shape is None:
                yield from solids
            else:
                at = place + turn @ np.array(look.offset)
                yield Piece(body, self._fitted(look, body).shape, at, turn @ axes_of(look.rotation))
        for particle in body.particles:
            if 2 * particle.radius > SMALL:
                yield Piece(body, iota.Sphere(particle.radius), np.array(tuple(particle.position)), np.eye(3))

    def _fitted(self, look: looks.Look, body: iota.Body) -> looks.Look:
        return look.of_length(abs(body.particles[-1].position - body.particles[0].position)) if look.fits else look

    def _of_springs(self) -> Iterator[Piece]:
        """Those that are drawn as a stick."""
        for look in self._styled(self.world._state.visuals.looks.get("spring")):
            for bond in self.world.system.bonds if look.fits else []:
                if bond.active and bond.law.name == "spring":
                    p, q = (end.position for end in bond.ends)
                    shape = look.of_length(abs(q - p)).shape
                    if shape is not None:
                        yield Piece(bond, shape, np.array(tuple((p + q) * 0.5)), axes_of(turn_from_x((q - p).unit())))


def joined(world: iota.World) -> dict[Any, set[Any]]:
    """Of each thing its joints: things with one in common meet by design."""
    joints: dict[Any, set[Any]] = {}

    def join(joint: Any, *things: Any) -> None:
        for thing in things:
            joints.setdefault(thing, {thing}).add(joint)

    for particle in world.system.particles:
        if len(ring := particle.ring) > 1:
            join(min(each.slot for each in ring), *(each.body for each in ring))
    for constraint in world.system.constraints:
        if constraint.active:
            join(constraint, *({each.body for each in constraint.particles} | {constraint.a, constraint.b}) - {None})
    beside: dict[iota.Body, set[iota.Body]] = {}
    bonds = {bond: {end.body for end in bond.ends} for bond in world.system.bonds if bond.active}
    for ends in bonds.values():
        for body in ends:
            beside.setdefault(body, set()).update(ends)
    # Two bodies that a spring joins do not meet, but it meets them, and what is between them.
    for bond, ends in bonds.items():
        joints[bond] = set.intersection(*(beside[body] for body in ends))
    return joints


def held_at(world: iota.World) -> list[tuple[iota.Body, Array]]:
    """Bodies that something holds in the world, and where, m."""
    system = world.system
    held = [(particle.body, particle.position) for particle in system.particles if particle.is_nailed]
    held += [
        (joint.a, joint.position)
        for joint in system.constraints
        if joint.active and joint.a is not None and joint.b is None and joint.kind not in SURFACES
    ]  # fmt: skip
    return [(body, np.array(tuple(place))) for body, place in held]
