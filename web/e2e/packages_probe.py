# SPDX-License-Identifier: Apache-2.0
"""A red ball at rest and a stone, served to the application whose folder IOTA_PAGE_FOLDER names, for browser tests."""

from __future__ import annotations

import os

import iota
from iota import looks
from iota.world import Server, options

system = iota.System(gravity=(0, 0, 0))
ball = system.body(shape=iota.Sphere(0.25), position=(0, 1.2, 0), density=100)
stone = system.body(shape=iota.Sphere(0.1), position=(1, 0.4, 0), density=100)
world = iota.World(system, title="embedded", ground=None)
world.draw(ball, looks.sphere(0.25, "paint", color="#ff0000"))


@world.action("hail", key="h", on="world")
def hail() -> None:
    print("hailed", flush=True)


server = Server(port=options.current().port or 8080, folder=os.environ["IOTA_PAGE_FOLDER"])
print(world.serve(server=server), flush=True)
while True:
    world.step()
