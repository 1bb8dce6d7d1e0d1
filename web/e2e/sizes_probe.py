# SPDX-License-Identifier: Apache-2.0
"""The same hanging rods at sizes from a molecule to a valley, as worlds of one server, for browser tests."""

from __future__ import annotations

import iota
from iota.world import Server, options

SIZES = (1e-9, 1e-6, 1e-3, 1.0, 30.0, 1e3)


def make(size: float) -> iota.World:
    """Six rods on a nail, `size` m is their length; they swing as slowly at every size."""
    system = iota.System(gravity=(0, -9.81 * size, 0), damping=1.0)
    last = None
    for number in range(6):
        rod = system.body()
        start = rod.particle((0.3 * size * number, size * (7 - number), 0))
        end = rod.particle((0.3 * size * (number + 1), size * (6 - number), 0))
        if last is None:
            start.nail()
        else:
            last.combine(start)
        last = end
    return iota.World(system, title=f"rods of {size:g} m")


server = Server(port=options.current().port or 8080)
worlds = [make(size) for size in SIZES]
for size, world in zip(SIZES, worlds, strict=True):
    world.serve(server=server, id=f"{size:g}")
print(server.url, flush=True)
while True:
    for world in worlds:
        world.step()
