# SPDX-License-Identifier: Apache-2.0
"""One chain for two people: open the page twice, pull at both ends, break it and join it again."""

import iota

system = iota.System(damping=0.1)
chain = iota.builder.chain(links=20, length=2, top=(-0.6, 2, 0), direction=(1, -0.5, 0)).realize(system)

world = iota.World(system, title="two people")
world.draw(chain.bodies, iota.looks.chain_link(0.1, "brass"))
world.offer()
world.run()
