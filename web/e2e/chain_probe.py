# SPDX-License-Identifier: Apache-2.0
"""The study `chain` without its timed break, for browser tests; prints what Python knows as JSON lines."""

from __future__ import annotations

import json

import iota
from iota.studies import chain


def build(links: int = 24) -> iota.World:
    chain.script_break = lambda world, links: None  # the tests break it themselves
    world = chain.build(links)
    world.system.damping = 2.0  # comes to rest in seconds: what the tests aim at is then where it was
    world.levels.off()  # on a busy machine it would give itself a budget, for which the page fetches more
    world.on_key("u")(world.undo)
    last: list[dict[str, int]] = []

    @world.every(0.05)
    def report() -> None:
        system = world.system
        now = {
            "articulates": system.articulate_count,
            "structure_version": system.structure_version,
            "held": sum(1 for client in world.users.clients if world.users.held(client.id) is not None),
        }
        if not last or last[0] != now:
            last[:] = [now]
            print(json.dumps(now), flush=True)

    return world
