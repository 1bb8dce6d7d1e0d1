# SPDX-License-Identifier: Apache-2.0
"""The part of a system that its time step is too long for, in words for who wrote the script."""

from __future__ import annotations

import math

import numpy as np

from iota._core import Body, Bond, System

TURN = 0.15  # rad in a step, from which on it is told
MOST = 2000  # bodies or bonds that are looked at


def told_of_energy(system: System, dt: float) -> str:
    """Says that the steps have made energy, by which part most likely, and what helps. dt: length of a step, s."""
    step = f"a step of {1e3 * dt:.2g} ms"
    return (
        f"The world gained energy that nothing gave it, as {step} is too long for {_fast_part(system, dt)}. "
        f"Try shorter steps: world.clock.dt = 1 / {math.ceil(2 / dt)}"
    )


def _fast_part(system: System, dt: float) -> str:
    bodies = [body for body in system.bodies if body.kind == "dynamic"][:MOST]
    if bodies:
        turns = dt * np.linalg.norm(system.array(bodies).angular_velocities, axis=1)
        fastest = int(np.argmax(turns))
        if turns[fastest] > TURN:
            return f"{_named(bodies[fastest])}, which turns by {math.degrees(turns[fastest]):.0f} degrees in it"
    bonds = [bond for bond in system.bonds if bond.active][:MOST]
    if bonds:
        strongest = max(bonds, key=lambda bond: _kick(bond, dt))
        a, b = (_named(end.body) for end in strongest.ends)
        kick = _kick(strongest, dt)
        return f"the bond between {a} and {b}, which changes a speed by {kick:.2g} m/s in it"
    return "what moves in it"


def _kick(bond: Bond, dt: float) -> float:
    """Change of the speed of its lighter end in a step, m/s."""
    lighter = min(end.body.mass for end in bond.ends)
    return abs(bond.force) * dt / lighter if lighter > 0 else 0.0


def _named(body: Body) -> str:
    return repr(body.name) if body.name else f"body {body.slot}"
