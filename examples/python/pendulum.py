# SPDX-License-Identifier: Apache-2.0
import iota

system = iota.System()
links = iota.builder.chain(system, links=3, length=1.5, top=(0, 2, 0), direction=(1, 0.3, 0))
weight = iota.Particle(iota.Body(system), links[-1].particles[-1].position, mass=5)
iota.combine(links[-1].particles[-1], weight)

world = iota.World(system, title="pendulum")


@world.action("cut", key="b", help="cuts the weight off", on="world")
def cut():
    iota.separate(links[-1].particles[-1], weight)


world.run()
