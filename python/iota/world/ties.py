# SPDX-License-Identifier: Apache-2.0
"""What ties bodies together, as the page draws it: springs, ropes and rods, each between two points."""

from __future__ import annotations

import json
from typing import Any

from iota._core import Particle, System
from iota.looks import Looks, cylinder, spring
from iota.world.frames import into_frame

KINDS = ("spring", "rope", "rod")


def default_looks(radius: float) -> dict[str, Looks]:
    """How each kind is drawn unless the script has a class of that name; radius: that of a rod, m."""
    return {
        "spring": {"*": spring(0.8 * radius, 0.12 * radius)},
        "rope": {"*": cylinder(0.35 * radius, "rope")},
        "rod": {"*": cylinder(0.4 * radius, "steel")},
    }


def describe(system: System) -> str:
    """JSON text of the scene's "ties": those that are active, of kinds that one can see."""
    ties = [
        _tie("spring", bond.parameters["length"], *bond.ends)
        for bond in system.bonds
        if bond.active and bond.law.name == "spring"
    ]
    ties += [
        _tie(constraint.kind, constraint.length, *constraint.particles[:2])
        for constraint in system.constraints
        if constraint.active and constraint.kind in KINDS
    ]
    return json.dumps(ties, separators=(",", ":"))


def _tie(kind: str, length: float, p: Particle, q: Particle) -> dict[str, Any]:
    return {"kind": kind, "class": kind, "length": length, "a": _end(p), "b": _end(q)}


def _end(particle: Particle) -> dict[str, Any]:
    body = particle.body
    point = into_frame(particle.position, body.center_of_mass, body.orientation)
    # To a micrometer: the same point of a body that has moved gives the same text, and is not sent again.
    return {"body": body.slot, "point": [round(v, 6) + 0.0 for v in point]}
