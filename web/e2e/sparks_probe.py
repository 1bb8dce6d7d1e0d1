# SPDX-License-Identifier: Apache-2.0
"""More than 10 000 particles of an emitter above a ball, for benchmarks of the page."""

from __future__ import annotations

import iota


def build() -> iota.World:
    system = iota.System()
    system.body(shape=iota.Sphere(0.2), position=(0, 0.2, 0), kind="static")
    system.emitter(
        rate=6000, position=(0, 0.5, 0), velocity=(0, 4, 0), velocity_spread=1.5, lifetime=2, max_count=12_000,
        curve=[(0, 0.01, (1, 0.9, 0.3)), (1, 0.02, (0.3, 0, 0, 0))],
    )  # fmt: skip
    return iota.World(system, title="sparks")
