# SPDX-License-Identifier: Apache-2.0
"""A rod that falls onto a ground 60 m below, for browser tests."""

from __future__ import annotations

import iota

system = iota.System(gravity=(0, -1, 0))
rod = system.body()
for x in (-15, 15):
    rod.particle((x, 0, 0)).radius = 2
world = iota.World(system, title="a rod", ground=-60, camera=iota.Camera((10, -15, 110), (0, -25, 0)))
world.run()
