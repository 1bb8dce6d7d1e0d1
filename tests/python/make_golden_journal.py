#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Makes the journal of the present format that tests/python/test_journal.py keeps. For a new format only.

.venv/bin/python tests/python/make_golden_journal.py
"""

from __future__ import annotations

import os
from pathlib import Path

import iota
from iota import _protocol as protocol
from iota.journal import records
from iota.world import journal as journals

FOLDER = Path(__file__).parent / "golden" / "journal" / str(records.FORMAT)


def main() -> None:
    journals.HAND_OVER = float("inf")  # only as below
    system = iota.System()
    ball = system.body(shape=iota.Sphere(0.1), position=(0, 1, 0))
    world = iota.World(system, title="kept")
    world.controls.slider("gravity", 0, 20, 9.81)
    world.keep(FOLDER)
    with system.edit():
        ball.position = (0, 2, 0)
    world._begin()
    journal = world._stepper.journal
    assert journal is not None
    world._inputs.take([(1, protocol.Join("Ada", protocol.Role.ACTOR))], lambda ids: [])
    world.keep_state("score", 3)
    for piece in range(5):
        world.step()
        if piece == 2:
            with system.edit():
                ball.position = (1, 1, 0)
        world.step()
        if piece < 4:
            journal.hand_over()
    journal.hand_over()
    journal._writer.flush()  # type: ignore[union-attr]
    (FOLDER / "lock").unlink()
    os._exit(0)  # as if it was killed


if __name__ == "__main__":
    main()
