# SPDX-License-Identifier: Apache-2.0
"""Emitters with suitable numbers (Reeves, Particle systems, 1983). Further arguments are passed to `System.emitter`."""

from __future__ import annotations

import math
from typing import Any

from iota._core import Box, Cylinder, Emitter, Sphere, System, Vec3
from iota.builder.points import Vector
from iota.colors import ColorLike, rgba

UPRIGHT = (0.0, 0.0, math.sqrt(0.5), math.sqrt(0.5))  # turns x to y


def fire(system: System, at: Vector = (0, 0, 0), size: float = 0.25, **more: Any) -> Emitter:
    """Flames that rise from a disk of radius `size` m. The sparks' velocity compensates gravity for their lifetime, as
    buoyancy would.

    effects.fire(system, at=(0, 0.1, 0))
    """
    life = 0.45
    settings = {
        "rate": 260, "source": Cylinder(size, 0.04), "orientation": UPRIGHT, "velocity": (4.0 * size + 3.0, 0, 0),
        "velocity_spread": 1.2 * size, "lifetime": life, "lifetime_spread": 0.15, "mass": 0.0005, "damping": 1.5,
        "curve": [
            (0, 0.05 * size, (1, 0.95, 0.6)), (0.3, 0.14 * size, (1, 0.55, 0.1)), (0.7, 0.1 * size, (0.8, 0.15, 0.05)),
            (1, 0.05 * size, (0.15, 0.12, 0.12)),
        ],
    }  # fmt: skip
    return system.emitter(**{**settings, "position": at, **more})


def waterfall(system: System, at: Vector = (0, 3, 0), width: float = 1.0, drop: float = 3.0, **more: Any) -> Emitter:
    """Water over an edge along z, `width` m wide, that falls `drop` m."""
    life = math.sqrt(2 * drop / max(abs(system.gravity), 0.1))
    settings = {
        "rate": 700, "source": Box((0.05, 0.05, width)), "velocity": (0.7, 0, 0), "velocity_spread": 0.25,
        "lifetime": life, "lifetime_spread": 0.05 * life, "mass": 0.001, "max_count": math.ceil(750 * life),
        "curve": [(0, 0.012, (0.35, 0.6, 0.85)), (0.7, 0.018, (0.6, 0.8, 0.95)), (1, 0.03, (0.95, 0.98, 1))],
    }  # fmt: skip
    return system.emitter(**{**settings, "position": at, **more})


def burst(
    system: System, at: Vector, color: ColorLike = (1, 0.4, 0.2), count: int = 250, speed: float = 5.0,
    seed: int = 1, **more: Any,
) -> Emitter:  # fmt: skip
    """The star of a firework: `count` sparks in all directions, born within a tenth of a second. Then switch it off:
    `world.after(0.1)(lambda: setattr(star, "active", False))`."""
    color = rgba(color)[:3]
    pale = tuple((2 + c) / 3 for c in color)
    settings = {
        "rate": 10.0 * count, "source": Sphere(0.05), "velocity": (0, 0, 0), "velocity_spread": speed, "lifetime": 1.6,
        "lifetime_spread": 0.4, "mass": 0.0005, "damping": 1.2, "max_count": count, "seed": seed,
        "curve": [(0, 0.03, pale), (0.2, 0.035, color), (0.8, 0.025, color), (1, 0.005, (0.1, 0.1, 0.1))],
    }  # fmt: skip
    return system.emitter(**{**settings, "position": tuple(Vec3(*at)), **more})
