# SPDX-License-Identifier: Apache-2.0
"""Stands on the ground from which something hangs."""

from __future__ import annotations

import math

import iota
from iota import looks


def tripod(world: iota.World, eye: iota.Vec3) -> None:
    """On the ground, with an eye to hang things from."""
    x, y, z = eye
    for foot in ((-0.8, 0, 0.5), (0.8, 0, 0.5), (0, 0, -1.0)):
        side = math.hypot(foot[0], foot[2])
        top = (x + 0.035 * foot[0] / side, y + 0.16, z + 0.035 * foot[2] / side)
        world.add_strut((x + foot[0], 0, z + foot[2]), top, looks.cylinder(0.018, "wood"))
    world.add_strut((x, y + 0.10, z), (x, y + 0.22, z), looks.cylinder(0.05, "brass"))
    world.add_static(looks.torus(0.03, 0.007, "steel"), (x, y + 0.03, z))
    world.add_strut((x, y + 0.06, z), (x, y + 0.10, z), looks.cylinder(0.012, "steel"))


def arm(world: iota.World, nail: iota.Vec3) -> None:
    """An arm on a post, with a nail at its end."""
    x, y, z = nail
    world.add_static(looks.sphere(0.03, "steel"), (x, y, z))
    world.add_strut((x, y, z - 0.5), (x, y, z), looks.cylinder(0.012, "steel"))
    world.add_strut((x, 0, z - 0.5), (x, y + 0.06, z - 0.5), looks.cylinder(0.025, "wood"))
    world.add_static(looks.box((0.7, 0.03, 0.5), "wood"), (x, 0.015, z - 0.5))
