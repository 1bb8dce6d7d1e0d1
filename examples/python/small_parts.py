# SPDX-License-Identifier: Apache-2.0
"""The small parts side by side: a fire, a waterfall, stars, a flock, a leaf in winds, a block that melts, a unit that creeps, a skin."""

import numpy as np

import iota
from iota import effects, looks

system = iota.System(mode="robust", damping=0.05)
world = iota.World(system, title="small parts", ground=0.0)
beam = looks.cylinder(0.02, "wood")
world.add_strut((-2.6, 2.0, 0), (2.6, 2.0, 0), beam)
for x in (-2.6, 2.6):
    world.add_strut((x, 0, 0), (x, 2.04, 0), beam)
world.draw_ties("spring", looks.cylinder(0.005, "steel"))

# Emitters.
effects.fire(system, at=(-2.2, 0.1, 0.6), size=0.12)
effects.waterfall(system, at=(-1.6, 1.98, 0), width=0.5, drop=1.9)
star = effects.burst(system, (0, 2.9, -1), color=(0.3, 0.6, 1.0), count=150, speed=2.0)


@world.every(2.0)
def sparkle():
    star.active = True
    world.after(0.1)(lambda: setattr(star, "active", False))


# A flock: neighbors attract and repel each other, swim alike, and are drawn to a place.
flock = iota.builder.Structure()
flock.points.add(np.random.default_rng(1).normal((0, 2.6, -1), 0.3, (60, 3)), 0.01, (0.6, 0, 0))
flock.points.radius[:], flock.points.color[:] = 0.02, (0.2, 0.3, 0.5)
flock.group("flock", range(60))
flock = flock.realize(system).groups["flock"]
system.pair_force(
    "attract_repel", cutoff=0.5, group=flock, attraction=0.002, attraction_range=0.4, repulsion=0.02,
    repulsion_range=0.1, alignment=0.001,
)  # fmt: skip
system.field("fx = -0.02*x; fy = 0.0981 - 0.02*(y - 2.6); fz = -0.02*(z + 1)", group=flock)

# A leaf in a wind that is the sum of three flows.
leaf = iota.builder.leaf(stem=(-0.9, 1.6, 0)).realize(system, world)
leaf.points[0].nail()
wind = (
    effects.uniform((2, 0.8, 0)) + effects.vortex((-0.6, 1.5, 0), circulation=1) + effects.gust((1.5, 0, 0), period=2)
)
wind.blow(system, leaf.groups["leaf"], drag=0.002)

# A block hangs over a hot plate: its springs conduct the heat, soften and melt.
block = iota.builder.soft_block(position=(0, 1.0, 0), stiffness=900).realize(system, world)
for point in block.points:
    if point.position.y > 1.14:
        point.nail()
ice = effects.Melting(block.bonds, melts_at=40, conduction=2)
world.add_static(looks.box((0.5, 0.04, 0.5), "paint", color="#c8502c"), (0, 0.7, 0))


@world.on_step
def warm():
    ice.heat((0, 0.8, 0), radius=0.3, energy=6000 * world.dt)
    ice.step(world.dt)


# The weight on two springs and a dashpot sinks slowly; the one on the first spring alone is down at once.
for x, creeps in ((0.8, True), (1.1, False)):
    hook, weight = system.body().particle((x, 2, 0)), system.body().particle((x, 1.6, 0))
    hook.nail()
    hook.radius = 0.03
    weight.radius, weight.color = 0.06, (0.8, 0.3, 0.2) if creeps else (0.3, 0.4, 0.5)
    if creeps:
        unit = effects.viscoelastic(system, hook, weight, stiffness=15, creep_stiffness=150, viscosity=150)
        unit.middle.radius = 0.01
    else:
        system.bond(hook, weight, "spring", stiffness=15, damping=0.5)

# A smooth skin around the particles of a soft block.
jelly = iota.builder.soft_block(size=(0.4, 0.4, 0.4), cells=(3, 3, 3), position=(1.9, 1.2, 0), density=60).realize(
    system
)
for point in jelly.points:
    if point.position.y > 1.39:
        point.nail()
world.drawings.skin(jelly.points, radius=0.13, color="#4c9a52")

world.camera = iota.Camera(position=(0.3, 1.6, 5.2), target=(0, 1.55, 0))
world.run()
