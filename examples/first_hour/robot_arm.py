# SPDX-License-Identifier: Apache-2.0
"""A robot arm from a URDF file, with a slider for each joint."""

from pathlib import Path

import iota
from iota import shapelib

system = iota.System()
world = iota.World(system, title="robot arm")
arm = shapelib.mechanism(Path(__file__).with_name("arm.urdf")).realize(system, world)

for name, first in (("turn", 0.5), ("shoulder", 0.6), ("elbow", 0.8)):
    angle = arm[name].angle
    slider = world.controls.slider(name, *angle.limits, value=first, unit="rad")

    @slider.on_change
    def changed(angle=angle, slider=slider):
        angle.servo = (slider.value, 60, 2)

    changed()

world.run()
