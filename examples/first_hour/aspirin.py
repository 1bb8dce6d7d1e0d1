# SPDX-License-Identifier: Apache-2.0
"""Aspirin from its SMILES: rigid rings that turn about the single bonds, hanging from one atom."""

import iota
from iota import shapelib

system = iota.System(damping=0.3)
world = iota.World(system, title="aspirin")
aspirin = shapelib.molecule("CC(=O)Oc1ccccc1C(=O)O", kind="flexible", at=(0, 1.5, 0)).realize(system, world)
aspirin.points[0].nail()
world.run()
