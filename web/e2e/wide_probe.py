# SPDX-License-Identifier: Apache-2.0
"""A block of 0.1 m before the camera, in a world of 36 m, for browser tests."""

from __future__ import annotations

import iota

system = iota.System()
world = iota.World(system, title="a block", ground=0, camera=iota.Camera((-0.8, 0.7, 0.6), (-0.05, 0.05, -0.05)))
for x, z, size in ((0, 0, 0.1), (-18, -2, 2), (18, 4, 2)):
    system.body(shape=iota.Box((size, size, size)), mass=1, position=(x, size / 2, z))
world.run()
