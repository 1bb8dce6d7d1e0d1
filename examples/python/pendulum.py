# SPDX-License-Identifier: Apache-2.0
import iota

system = iota.System()
links = iota.builder.chain(system, links=3, length=1.5, top=(0, 2, 0), direction=(1, 0.3, 0))
weight = system.body().particle(links[-1].particles[-1].position, mass=5)
links[-1].particles[-1].combine(weight)

world = iota.World(system, title="pendulum")


@world.action("cut", key="b", help="cuts the weight off", on="world")
def cut():
    links[-1].particles[-1].separate(weight)


world.run()
