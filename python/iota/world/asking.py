# SPDX-License-Identifier: Apache-2.0
"""Questions about places: what a ray meets, what is nearest, what is within a distance."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from iota._core import Body, Places, System, Vec3
from iota.world.state import State

Place = Sequence[float] | Vec3


@dataclass(frozen=True)
class Hit:
    """A body and a place on its surface. point: world, m. distance: from the start of the ray, or from the asked place, m;
    negative for a place inside."""

    body: Body
    point: Vec3
    distance: float


class Asking:
    """Questions about places. They know the shapes of solid bodies exactly, and rods, ropes and balls of particles by the
    thickness with which they are drawn; not what has no physics. bodies: only these; None: all but inactive ones and
    sparks. A tree of boxes finds them, which follows the motion: each question about 10 000 bodies takes some 0.15 ms, the
    first one after a step 0.5 ms, and after bodies came or went tens of ms. They raise TypeError for a World of another
    Simulator."""

    _state: State
    _places: Places | None = None

    def ray(
        self, origin: Place, direction: Place, farthest: float = math.inf, bodies: Iterable[Body] | None = None
    ) -> Hit | None:
        """The first body that a ray meets, within `farthest` m; None without one. Raises ValueError for a direction of zero.

        hit = world.ray(eye, (0, -1, 0))
        """
        found = self._index().ray(Vec3(*origin), Vec3(*direction), farthest, _listed(bodies))
        return None if found is None else Hit(*found)

    def nearest(self, place: Place, bodies: Iterable[Body] | None = None) -> Hit | None:
        """The body whose surface is nearest to a place; None without bodies."""
        found = self._index().nearest(Vec3(*place), _listed(bodies))
        return None if found is None else Hit(*found)

    def within(self, place: Place, radius: float, bodies: Iterable[Body] | None = None) -> list[Body]:
        """The bodies of which a part is within `radius` m of a place: those that a ball there overlaps."""
        return self._index().within(Vec3(*place), radius, _listed(bodies))

    def _index(self) -> Places:
        """With the thickness of all bodies that were given another look since the last question."""
        state = self._state
        if self._places is None:
            if not isinstance(state.system, System):
                raise TypeError("questions about places need a System; this world has a simulator of its own")
            self._places = Places(state.system)
            self._places.set_usual_thickness(state.usual_thickness, 2 * state.usual_thickness)
        for body in state.scene.take_drawn():
            if isinstance(body, Body) and body.alive:
                self._places.set_thickness(body, state.thickness_of(body))
        return self._places


def _listed(bodies: Iterable[Body] | None) -> list[Body] | None:
    return None if bodies is None else list(bodies)
