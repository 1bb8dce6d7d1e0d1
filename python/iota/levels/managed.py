# SPDX-License-Identifier: Apache-2.0
"""A thing whose level is managed."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from iota._core import Body, Particle, Vec3
from iota._core import Part as Weld
from iota.levels.level import Level
from iota.levels.stand_ins import StandIn
from iota.levels.stiffness import Clothes, Stiffness


@dataclass(eq=False)
class Managed:
    """A thing whose level is managed: see `Levels.manage`. root: its first body. others: a body of each further articulate that
    belongs to it. middle: the particle from which its other points are least far; extent: how far the farthest was when it came under
    management, m."""

    name: str
    root: Body
    levels: tuple[Level, ...]
    size: float
    middle: Particle
    extent: float = 0.0
    others: tuple[Body, ...] = ()
    significance: Callable[[Managed], float] | None = None
    on_level: Callable[[Managed, Level], None] | None = None
    is_pinned: bool = False
    is_chosen: bool = False  # by a call of `manage`
    is_jointed: bool = field(default=False, repr=False)  # joints, bonds or angle springs hold it
    index: int = field(default=0, repr=False)
    _stand_in: StandIn | None = field(default=None, repr=False)
    _former: deque[StandIn] = field(default_factory=lambda: deque(maxlen=4), repr=False)  # that an undo may bring back
    _lines: list[tuple[Particle, Particle]] = field(default_factory=list, repr=False)  # that it lacks as one body
    _welded: deque[Stiffness] = field(default_factory=lambda: deque(maxlen=4), repr=False)  # to become stiff
    _members: list[Body] = field(default_factory=list, repr=False)  # its bodies when its level was decided last
    _version: int = field(default=-1, repr=False)  # of the structure then
    _middles: dict[Body, tuple[Particle, float]] = field(default_factory=dict, repr=False)  # by the roots of several

    @property
    def level(self) -> Level:
        """Its present level."""
        return self.levels[self.index]

    @property
    def bodies(self) -> list[Body]:
        """Its bodies that are left, of which there is one while it is stiff; those of the structure that stands in for it. Those of a thing that
        was stiff are others than before, but for the first one."""
        if self._stand_in is not None:
            stands: list[Body] = [body for body in self._stand_in.bodies if body.alive]
            return stands
        found: list[Body] = []
        for root in self._roots:
            if root not in found:
                found = [*found, *root.articulate.bodies]
        return found

    @property
    def _spots(self) -> list[tuple[Particle, float]]:
        """Particles by which it is looked at, and from each to the farthest point of its articulate at most, m. Of several articulates each has
        one, as loose ones go their own ways."""
        if self._stand_in is not None:
            return [(self.bodies[0].particles[0], 2 * max(self.extent, self.size))]
        if self.others:
            return [self._middle_of(root) for root in self._roots]
        if self.middle.alive:
            return [(self.middle, self.extent)]
        return [(self.root.particles[0], 2 * max(self.extent, self.size))]  # stiffness has ended the middle

    def _middle_of(self, root: Body) -> tuple[Particle, float]:
        known = self._middles.get(root)
        if known is None or not known[0].alive:
            _, middle, extent = measured(root.articulate.bodies)
            self._middles[root] = known = middle, extent
        return known

    @property
    def _roots(self) -> list[Body]:
        if self._stand_in is not None:
            return self._stand_in.roots
        return [body for body in (self.root, *self.others) if body.alive]

    def _swap(self, scene: Any, level: Level, is_held: bool = False) -> None:
        """To the structure of a level, or back to the thing's own bodies. is_held: joints hold it at the world."""
        if self._stand_in is not None:
            whole = self._stand_in.is_whole
            self._former.append(self._stand_in)
            if whole:
                stand_in, self._stand_in = self._stand_in, None
                stand_in.leave()
            else:
                self._keep_stand_in()
        if level.structure is not None:
            structure = level.structure(self)
            self._stand_in = StandIn(self.root.system, scene, self.bodies, structure, level.name, is_held)

    def _keep_stand_in(self) -> None:
        """Somebody has taken the stand-in apart: what is left of it is the thing from now on, at the level full."""
        assert self._stand_in is not None
        left = self._stand_in.roots
        self._stand_in.keep()
        self._stand_in = None
        if left:
            self.root, self.others = left[0], tuple(left[1:])
            self._measure()
            self.levels, self.index = self.levels[:1], 0

    def _measure(self) -> None:
        """Its size, its middle and its extent now."""
        self.size, self.middle, self.extent = measured(self.bodies)
        self._middles.clear()

    @property
    def mass(self) -> float:
        """The sum of those of its bodies, kg."""
        return sum(body.mass for body in self.bodies)

    @property
    def position(self) -> Vec3:
        """Its center of mass, m."""
        total = Vec3()
        for body in self.bodies:
            total = total + body.center_of_mass * body.mass
        return total / self.mass

    def _lives(self) -> bool:
        """Whether something of it is left. If its root is gone, what has absorbed the root, or a body of another of its articulates,
        is its root. A stand-in that is gone takes the thing with it."""
        if self._stand_in is not None:
            if self._stand_in.is_there:
                return True
            self._keep_stand_in()
        if not self.root.alive:
            left = [self.root.survivor, *self.others]
            before, self.root = self.root, next((body for body in left if body is not None and body.alive), self.root)
            if self.others:  # an undo may bring the former root back
                self.others = (before, *(body for body in self.others if body not in (before, self.root)))
        return self.root.alive

    def _has(self, body: Body) -> bool:
        return any(root.articulate == body.articulate for root in self._roots)

    def _set_stride(self, stride: int) -> None:
        for root in self._roots:
            root.articulate.stride = stride

    @property
    def _welds(self) -> list[Weld]:
        """The parts of its first body that stiffness has made of other bodies. A script may have welded more."""
        if not self._welded:
            return []
        known = frozenset().union(*(each.others for each in self._welded))
        return [part for part in self.root.parts if part.origin in known]

    def _set_stiff(self, stiff: bool, visuals: Clothes) -> None:
        if not stiff:
            self._come_apart(visuals)
            self._members = self.bodies
            if not self.middle.alive:
                self._measure()
            return
        for p, q in self._lines:
            if p.alive and q.alive and p.body == q.body:
                self.root.system.cosmetic_bond(p, q)
        self._lines = []
        others = [body for body in self.bodies if body != self.root and len(body.parts) == 1]
        self._welded.append(Stiffness(self.root, others))
        self._members = self.bodies

    def _come_apart(self, visuals: Clothes) -> None:
        welds = self._welds
        of_these = {part.origin for part in welds}
        known = next((each for each in reversed(self._welded) if of_these <= each.others), None)
        changed = known.changed(self.root) if known is not None else None
        members = {self.root: self.root}
        for part in reversed(welds):  # so that they are in their former order
            origin = part.origin
            created = part.separate().created_bodies
            if created:
                members[origin] = created[0]
        if known is not None and changed is not None:
            known.give_back(members, visuals, changed)

    def _reread(self) -> None:
        """Its bodies tell its level: the system was restored or undone."""
        if self._stand_in is not None:
            self._former.append(self._stand_in)
        self._stand_in = next((each for each in self._former if each.is_whole), None)
        if not self._lives():
            return
        if self._stand_in is not None:
            self.index = next((i for i, level in enumerate(self.levels) if level.structure is not None), 0)
            return
        stride, is_stiff = self.root.stride, bool(self._welds)
        fitting = [
            i
            for i, level in enumerate(self.levels)
            if level.enter is None
            and level.structure is None
            and level.stride == stride
            and (level.is_stiff == is_stiff or stride == 0)
        ]
        self.index = fitting[0] if fitting else 0


def is_hung(bodies: list[Body]) -> bool:
    return any(p.is_nailed for body in bodies for p in body.particles)


def measured(bodies: list[Body]) -> tuple[float, Particle, float]:
    """The size of bodies, m, the particle in their middle, and the distance of their farthest point from it, m."""
    points = [p for body in bodies for p in body.particles]
    places = np.array([list(p.position) for p in points])
    thick = max(body.radius for body in bodies)
    size = float(np.linalg.norm(np.ptp(places, axis=0))) + thick
    center = (places.min(axis=0) + places.max(axis=0)) / 2
    middle = int(np.linalg.norm(places - center, axis=1).argmin())
    extent = float(np.linalg.norm(places - places[middle], axis=1).max()) + thick
    return max(size, 1e-6), points[middle], extent
