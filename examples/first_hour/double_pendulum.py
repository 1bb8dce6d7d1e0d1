# SPDX-License-Identifier: Apache-2.0
"""A double pendulum with its trace, two plots, a slider for gravity and a label."""

import iota

system = iota.System()
rods = iota.builder.chain(links=2, length=1.6, top=(0, 2, 0), direction=(1, 0.4, 0)).realize(system)
end = rods.points[-1]
weight = system.body(shape=iota.Sphere(0.09), mass=3, position=end.position, attachments=[(0, 0, 0)], color="gold")
end.combine(weight.attachments[0])

world = iota.World(system, title="double pendulum")
world.draw(rods.bodies, iota.looks.capsule(0.02, "steel"))
world.drawings.trace(weight, seconds=4, color="crimson")
world.label("chaos", at=weight, offset=(0, 0.2, 0))
world.controls.plot("height", lambda: weight.position.y, unit="m", color="royalblue")
world.controls.plot("energy", lambda: system.energy.total, unit="J", color="crimson")
gravity = world.controls.slider("gravity", 0, 20, 9.81, unit="m/s²")


@gravity.on_change
def changed():
    system.gravity = (0, -gravity.value, 0)


world.run()
