# SPDX-License-Identifier: Apache-2.0
import iota

system = iota.System()
chain = iota.builder.chain(links=3, length=1.5, top=(0, 2, 0), direction=(1, 0.3, 0)).realize(system)
end = chain.points[-1]
weight = system.body().particle(end.position, mass=5)
end.combine(weight)

world = iota.World(system, title="pendulum")


@world.action("cut", key="b", help="cuts the weight off", on="world")
def cut():
    end.separate(weight)


world.run()
