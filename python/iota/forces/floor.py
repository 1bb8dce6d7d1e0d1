# SPDX-License-Identifier: Apache-2.0
"""A soft floor for particles."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from iota._core import Vec3

if TYPE_CHECKING:
    from iota.world import World


def floor(world: World, height: float = 0.0, friction: float = 6.0) -> None:
    """Pushes particles below `height` m up again, once a step, and slows their sliding by `friction` 1/s.

    It acts on particles only: a link does not rest on its middle. The push is as stiff as a force that is held over a
    step can be: particles sink g / (0.4 / dt)^2, 4 mm at 1/120 s.
    """
    system = world.system

    def push() -> None:
        damping = 0.4 / world.dt
        stiffness = damping**2
        heights = system.positions[:, 1]
        below = np.flatnonzero(heights < height)
        if not below.size:
            return
        particles, velocities = system.particles, system.velocities
        for index in below:
            x, y, z = velocities[index]
            lift = stiffness * (height - heights[index]) - damping * y
            mass = particles[index].mass
            particles[index].apply_force(Vec3(-friction * x, max(lift, 0.0), -friction * z) * mass)

    world.on_step(push)
