# SPDX-License-Identifier: Apache-2.0
"""Describes the bodies of a custom simulator, in the format of a room."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np

from iota._core import Vec3
from iota.frames import into_frame, relative_turn
from iota.simulator import SimulatedBody, Simulator


def describe(simulator: Simulator) -> list[tuple[Any, ...]]:
    """Slot, generation, kind, name, articulate, number of particles, lines and solids of each body; places in its frame."""
    articulates = dict(simulator.body_articulates())
    lines: dict[SimulatedBody, list[tuple[Any, Any]]] = {}
    for p, q in simulator.cosmetic_lines:
        if p.body is q.body:
            lines.setdefault(p.body, []).append((p, q))
    return [_describe(body, articulates.get(body.slot, body.slot), lines.get(body, [])) for body in simulator.bodies]


def extent(simulator: Simulator) -> float:
    """Diagonal of the box around all particles, m."""
    places = simulator.positions
    return float(np.linalg.norm(np.ptp(places, axis=0))) if len(places) else 0.0


def _describe(body: SimulatedBody, articulate: int, lines: list[tuple[Any, Any]]) -> tuple[Any, ...]:
    center, orientation = body.center_of_mass, [float(v) for v in body.orientation]
    particles = body.particles
    local = [
        (into_frame(Vec3(*p.position), center, orientation), into_frame(Vec3(*q.position), center, orientation))
        for p, q in lines or pairwise(particles)
    ]
    solids = [
        (
            solid.shape,
            into_frame(solid.position, center, orientation),
            tuple(relative_turn(orientation, solid.orientation)),
        )
        for solid in body.solids
    ]
    return (body.slot, body.generation, body.kind, body.name, articulate, len(particles), local, solids)
