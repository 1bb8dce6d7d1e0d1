# SPDX-License-Identifier: Apache-2.0
"""A study, named by IOTA_STUDY, for browser tests; prints what Python knows of it as JSON lines. With IOTA_PAUSED it stays at its
start, or as it is after IOTA_AFTER seconds, for pictures of it."""

from __future__ import annotations

import json
import os
from pathlib import Path
from tempfile import mkdtemp

import iota
from iota import studies

NAME = os.environ["IOTA_STUDY"]


def build() -> iota.World:
    make = studies.module(NAME).build
    world: iota.World = make(Path(mkdtemp())) if NAME == "playground" else make()
    world.clock.paused = "IOTA_PAUSED" in os.environ
    if "IOTA_AFTER" in os.environ:
        world.advance(round(float(os.environ["IOTA_AFTER"]) / world.dt))
    watch(world)
    return world


def watch(world: iota.World) -> None:
    """A line each 0.05 s of simulated time."""
    system = world.system

    def report() -> None:
        bodies, held = [body for body in system.bodies if not body.is_spark], world.users.held()
        facts = {
            "time": system.time,
            "bodies": len(bodies),
            "dynamic": sum(body.kind == "dynamic" for body in bodies),
            "articulates": system.articulate_count,
            "bonds": sum(bond.active for bond in system.bonds),
            "sticks": len(system.cosmetic_bonds),
            "joints": sum(constraint.active for constraint in system.constraints),
            "nails": sum(particle.is_nailed for particle in system.particles),
            "fields": [field.active for field in system.fields],
            "groups": {group.name: len(group) for group in system.groups},
            "kinetic": system.energy.kinetic,
            "held": None if held is None else [held.slot, *held.center_of_mass],
        }
        print(json.dumps(facts), flush=True)

    world.every(0.05)(report)
    world.on_reset(report)
