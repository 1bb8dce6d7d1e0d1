# SPDX-License-Identifier: Apache-2.0
"""A thing for each ready part of interaction, all at rest, and what Python knows of them as JSON lines, for browser tests."""

from __future__ import annotations

import json

import iota
from iota import looks


def build() -> iota.World:
    system = iota.System(gravity=(0, 0, 0))
    world = iota.World(system, title="parts", ground=None)
    world.camera = iota.Camera(position=(0, 1.5, 3), target=(0, 1.5, 0))
    ball, stone, piece = (
        system.body(shape=iota.Sphere(0.1), mass=0.5, position=(x, 1.5, 0)) for x in (-0.9, -0.5, -0.1)
    )
    world.draw([ball, stone, piece], looks.solid("brass"))

    def rod(x: float, top: float, bottom: float) -> iota.Body:
        body = system.body()
        body.particle((x, top, 0), 0.2)
        body.particle((x, bottom, 0), 0.2)
        world.draw(body, looks.capsule(0.04, "steel"))
        return body

    upper, lower, post, plug = rod(0.3, 1.9, 1.6), rod(0.3, 1.6, 1.3), rod(0.7, 2.1, 1.9), rod(0.7, 1.5, 1.2)
    upper.particles[0].nail()
    for particle in post.particles:
        particle.nail()
    lower.particles[0].combine(upper.particles[1])
    world.offer()
    world.tools.carry(piece)
    socket = world.tools.socket(post.particles[1], [plug.particles[0]], within=0.15, pull=2)
    last: list[dict[str, object]] = []

    @world.on_frame
    def report() -> None:
        texts = [thing.text for thing in world.drawings.things if thing.kind == "label"]
        now = {
            "bodies": len(system.bodies),
            "arm": len(lower.articulate),
            "plugged": len(plug.articulate) > 1,
            "ghost": socket._ghost is not None,
            "measured": texts[0] if texts else "",
            "piece": str(piece.kind),
        }
        if not last or last[0] != now:
            last[:] = [now]
            print(json.dumps(now), flush=True)

    return world
