# SPDX-License-Identifier: Apache-2.0
"""Small parts to put together: winds, sparks, bonds that creep and melt. Each works on a `System` and needs nothing else."""

from iota.effects.soft import Melting, Unit, viscoelastic
from iota.effects.sparks import burst, fire, waterfall
from iota.effects.winds import Wind, gust, source, uniform, vortex

__all__ = [
    "Melting",
    "Unit",
    "Wind",
    "burst",
    "fire",
    "gust",
    "source",
    "uniform",
    "viscoelastic",
    "vortex",
    "waterfall",
]
