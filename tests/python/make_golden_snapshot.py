#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Makes the snapshot and the journal of the present tables that tests/python/test_snapshots.py keeps. After a change of
tables, once before a release.

.venv/bin/python tests/python/make_golden_snapshot.py J2
"""

from __future__ import annotations

import json
import os
import sys
import zlib
from pathlib import Path

import sweep

import iota
from iota.world import journal as journals

GOLDEN = Path(__file__).parent / "golden" / "snapshot"


def everything() -> iota.System:
    """A little of all that tables hold, after some steps."""
    system = sweep.Scene().system
    corners, faces = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)], [(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)]
    system.body(shape=iota.Mesh(corners, faces), position=(0, 9, 0))
    system.usual_material = iota.Material(friction=0.4)
    system.body(shape=iota.Box((1, 1, 1)), position=(20, 0.49, 0))
    system.obstacle(iota.Box((4, 1, 4)), position=(20, -0.5, 0), material=iota.Material())
    system.body(shape=iota.Box((0.5, 0.5, 0.5)), position=(20, 1.2, 0)).name = "upper"
    for _ in range(30):
        system.step(1 / 120)
    return system


def kept_world(folder: Path) -> iota.World:
    system = iota.System(threads=1)
    chain = iota.builder.chain(links=3, length=1, top=(0, 2, 0), direction=(1, 0, 0)).realize(system)
    world = iota.World(system, title="kept")
    world.keep(folder)
    world.kept_state("chain", chain)
    return world


def recording() -> iota.types.Recording:
    """Many kinds of commands, with steps between them."""
    system = iota.System(threads=1)
    system.start_recording()
    chain = iota.builder.chain(links=4, length=1, top=(0, 2, 0), direction=(1, 0, 0)).realize(system)
    ball = system.body(shape=iota.Sphere(0.1), position=(0, 3, 0), color="tomato")
    ball.name = "ball"
    box = system.body(shape=iota.Box((0.2, 0.2, 0.2)), position=(2, 1, 0))
    hinge = system.revolute(ball, box, at=(1, 2, 0), axis=(0, 0, 1))
    spring = system.bond(chain.bodies[0].particles[0], ball.particle((0, 3, 0)), "spring", stiffness=20, length=1)
    system.field("fx = 0; fy = -m; fz = 0")
    for step in range(20):
        system.step(1 / 120)
        box.apply_force((0, 1, 0))
        if step == 8:
            hinge.angle.motor = (1, 5)
            spring.set(stiffness=30)
            with system.edit():
                ball.mass = 2
        if step == 12:
            system.undo()
        if step == 15:
            spring.destroy()
    return system.stop_recording()


def main(name: str) -> None:
    place = GOLDEN / name
    place.mkdir(parents=True)
    system = everything()
    (place / "everything.z").write_bytes(zlib.compress(system.snapshot(), 9))
    facts = {"time": system.time, "energy": system.energy.total, "positions": system.positions.tolist()}
    (place / "everything.json").write_text(json.dumps(facts))
    recording().save(place / "run-B.replay")
    journals.HAND_OVER = 0.0
    world = kept_world(place / "journal")
    world._begin()
    for _ in range(3):
        world.step()
    journal = world._stepper.journal
    assert journal is not None
    journal.hand_over()
    journal._writer.flush()  # type: ignore[union-attr]
    (place / "journal" / "lock").unlink()
    os._exit(0)  # as if it was killed


if __name__ == "__main__":
    main(sys.argv[1])
