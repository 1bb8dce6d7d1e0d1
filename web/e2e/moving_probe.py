# SPDX-License-Identifier: Apache-2.0
"""IOTA_BODIES rods (500 without it) that swing for ever, each on its own nail, for long runs and benchmarks of the page."""

from __future__ import annotations

import math
import os

import numpy as np

import iota
from iota import looks

LENGTH, APART = 0.3, 0.4  # m


def build() -> iota.World:
    count = int(os.environ.get("IOTA_BODIES", "500"))
    numbers = np.arange(count)
    rows = math.ceil(math.sqrt(count))
    tops = np.column_stack([numbers % rows, np.full(count, 3.0), numbers // rows]) * (APART, 1, APART)
    angles = 0.4 + 0.6 * (numbers * 0.618) % 1.0
    ends = tops + LENGTH * np.column_stack([np.sin(angles), -np.cos(angles), 0.3 * np.sin(3 * angles)])
    system = iota.System()
    system.threads = 1  # so that the processor time of the server's thread can be told
    rods = system.rod_array(tops, ends, masses=0.1, radii=0.01)
    for top in list(rods.particles)[::2]:
        top.nail()
    world = iota.World(system, title=f"{count} rods", dt=1 / 60)
    world.draw(rods, looks.cylinder(0.02, "steel"))
    return world
