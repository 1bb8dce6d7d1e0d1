# SPDX-License-Identifier: Apache-2.0
"""Three balls, one of which a key puts far away, for browser tests."""

from __future__ import annotations

import iota


def build() -> iota.World:
    system = iota.System(gravity=(0, 0, 0))
    *_, last = (system.body(shape=iota.Sphere(0.2), mass=1.0, position=(x, 1, 0)) for x in (-1, 0, 1))
    world = iota.World(system, title="leaving")

    @world.on_key("x")
    def leave() -> None:
        last.position = (30, 1, 0)

    return world
