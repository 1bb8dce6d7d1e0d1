# SPDX-License-Identifier: Apache-2.0
"""Winds as sums of primitive flows (Wejchert and Haumann, Animation aerodynamics, SIGGRAPH 1991)."""

from __future__ import annotations

from dataclasses import dataclass

from iota._core import Field, Group, System, Vec3
from iota.builder.points import Vector


@dataclass(frozen=True)
class Wind:
    """A velocity at each place, as expressions of x, y, z and t in m/s. Winds can be added, and scaled by a number."""

    x: str = "0"
    y: str = "0"
    z: str = "0"

    def __add__(self, other: Wind) -> Wind:
        return Wind(*(f"{a} + {b}" for a, b in zip(self.parts, other.parts, strict=True)))

    def __mul__(self, factor: float) -> Wind:
        return Wind(*(f"{factor!r}*({part})" for part in self.parts))

    @property
    def parts(self) -> tuple[str, str, str]:
        """Along x, y and z."""
        return self.x, self.y, self.z

    def blow(self, system: System, group: Group | None = None, drag: float = 0.01) -> Field:
        """A field that acts on a group, or on all particles: drag (N s/m) times the velocity of the wind relative to
        the particle. Raises ValueError for a sum that is longer than the limit of an expression (999 characters).

            wind = effects.uniform((2, 0, 0)) + effects.vortex((0, 1, 0), circulation=3)
            wind.blow(system, leaves, drag=0.002)
        """
        text = "; ".join(f"f{axis} = drag*({part} - v{axis})" for axis, part in zip("xyz", self.parts, strict=True))
        if len(text) > 999:
            raise ValueError(f"the wind is {len(text)} characters long, at most 999 are possible: add fewer flows")
        return system.field(text, group=group, drag=drag)


def uniform(velocity: Vector) -> Wind:
    """A uniform velocity, m/s."""
    x, y, z = Vec3(*velocity)
    return Wind(repr(x), repr(y), repr(z))


def vortex(center: Vector, circulation: float, core: float = 0.2) -> Wind:
    """A vortex about a vertical axis through a place: circulation / (2 pi r) m/s at distance r, counter-clockwise from
    above; slower within the core (m)."""
    x, _, z = Vec3(*center)
    k = circulation / 6.283185307179586
    share = f"{k:.6g}/((x-{x:.6g})^2 + (z-{z:.6g})^2 + {core**2:.6g})"
    return Wind(f"(z-{z:.6g})*{share}", "0", f"({x:.6g}-x)*{share}")


def source(center: Vector, strength: float, core: float = 0.2) -> Wind:
    """A source at a place: strength / (4 pi r^2) m/s outwards; a negative one is a sink."""
    x, y, z = Vec3(*center)
    k = strength / 12.566370614359172
    share = f"{k:.6g}/((x-{x:.6g})^2 + (y-{y:.6g})^2 + (z-{z:.6g})^2 + {core**2:.6g})^1.5"
    return Wind(f"(x-{x:.6g})*{share}", f"(y-{y:.6g})*{share}", f"(z-{z:.6g})*{share}")


def gust(velocity: Vector, period: float) -> Wind:
    """A periodic gust: from zero to a velocity (m/s) and back in each period (s)."""
    x, y, z = Vec3(*velocity)
    share = f"*sin({3.141592653589793 / period:.9g}*t)^2"
    return Wind(*(f"{v!r}{share}" for v in (x, y, z)))
