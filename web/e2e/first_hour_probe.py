# SPDX-License-Identifier: Apache-2.0
"""A script of the first hour, named by IOTA_SCRIPT, as it is after IOTA_AFTER seconds, for pictures of it."""

from __future__ import annotations

import os
import runpy
from pathlib import Path

import iota
from iota.world.options import RunOptions, use

NAME, AFTER = os.environ["IOTA_SCRIPT"], float(os.environ["IOTA_AFTER"])
SCRIPTS = Path(__file__).resolve().parents[2] / "examples" / "first_hour"


def build() -> iota.World:
    with use(RunOptions(headless=True, seconds=0.02)):
        world: iota.World = runpy.run_path(str(SCRIPTS / f"{NAME}.py"), run_name="__main__")["world"]
    world.advance(round(AFTER / world.dt))
    world.clock.paused = True
    return world
