# SPDX-License-Identifier: Apache-2.0
"""Small parts to combine: winds, sparks, bonds that creep and melt, skins. Each needs only a `System`."""

from iota.arguments import explain_module
from iota.effects.soft import Melting, Unit, viscoelastic
from iota.effects.sparks import burst, fire, waterfall
from iota.effects.winds import Wind, gust, source, uniform, vortex
from iota.implicit import skin

__all__ = [
    "Melting",
    "Unit",
    "Wind",
    "burst",
    "fire",
    "gust",
    "skin",
    "source",
    "uniform",
    "viscoelastic",
    "vortex",
    "waterfall",
]

explain_module(__name__)
