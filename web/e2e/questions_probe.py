# SPDX-License-Identifier: Apache-2.0
"""A world that asks its visitors; prints each answer as a JSON line."""

from __future__ import annotations

import json
from pathlib import Path
from tempfile import mkdtemp

import iota

LONG = "Which of the motions that you have seen here did you find plausible, and what about the others disturbed you?"


def build() -> iota.World:
    system = iota.System(gravity=(0, 0, 0))
    system.body(shape=iota.Sphere(0.3), mass=1.0)
    world = iota.World(system, title="questions")
    asked = world.ask(
        {LONG: str, "Was the motion as a whole plausible?": ["yes, in every respect that I can think of", "no"]},
        file=Path(mkdtemp()) / "answers.csv",
        on_answer=lambda: print(json.dumps(asked.answers[-1]), flush=True),
    )
    return world
