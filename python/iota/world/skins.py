# SPDX-License-Identifier: Apache-2.0
"""A smooth surface around particles, kept up to date by the world."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from iota._core import Body, Particle
from iota._protocol import NO_BODY
from iota.arguments import SHORT
from iota.implicit import skin
from iota.looks import material_of
from iota.world.callbacks import Guard
from iota.world.things import Field, Thing, anchor, color, number, points

Source = Callable[[], Any] | list[Particle | Body]


def _source(value: Any) -> Source:
    if callable(value):
        return cast("Callable[[], Any]", value)
    if not isinstance(value, Iterable):
        raise TypeError(f"must be particles or bodies, or a function, not {SHORT.repr(value)}")
    particles = [value] if isinstance(value, Particle | Body) else list(value)
    for particle in particles:
        if not isinstance(particle, Particle | Body):
            raise TypeError(f"must be particles or bodies, or a function, not {particle!r}")
    return particles


class Skin(Thing):
    """An implicit surface around particles or bodies (their centers), or around the places (n, 3) that a function
    returns: it splits, merges and moves with them, and leaves out those that no longer exist. radius: of it around a
    single one, m. cell: of the grid of samples, m; None: a third of the radius."""

    kind = "surface"
    particles, color, radius = Field(_source), Field(color), Field(number(1e-12, 1e9))
    material = Field(material_of)
    cell = Field(lambda value: None if value is None else number(1e-12, 1e9)(value))

    def __init__(self, things: Any, **values: Any) -> None:
        self._places = np.zeros((0, 3))
        self._shown: tuple[Any, ...] | None = None
        self._surface: tuple[NDArray[np.float64], NDArray[np.int64]] = (np.zeros((0, 3)), np.zeros((0, 3), np.int64))
        self._is_off = False
        super().__init__(things, **values)
        self._follow()

    def sample(self, time: float, guard: Guard) -> None:
        """Follows the particles; called once a frame. An error switches it off and is told once."""
        if self.visible and not self._is_off:
            self._is_off = not guard.call("A skin", self._follow, hint="It is switched off. Correct the script.")

    def _follow(self) -> None:
        source = self.particles
        places = points(source() if callable(source) else [_place(p) for p in source if p.survivor is not None])
        wanted = (self.radius, self.cell)
        if self._shown == wanted and np.array_equal(places, self._places):
            return
        self._surface = skin(places, self.radius, self.cell)
        self._places, self._shown = places, wanted
        self._changed()

    def _record(self) -> dict[str, Any] | None:
        vertices, triangles = self._surface
        if not len(triangles):
            return None
        # Points of the world, each by itself: pages shade such a surface smoothly.
        bodies = np.full(len(vertices), NO_BODY, np.uint32)
        shape = {"at": anchor(None), "bodies": bodies, "points": vertices, "triangles": triangles, "coordinates": ()}
        return shape | {"material": self.material, "color": self.color}

    def _is_attached(self) -> bool:
        return False


def _place(particle: Any) -> Any:
    return particle.position if isinstance(particle, Particle) else particle.center_of_mass
