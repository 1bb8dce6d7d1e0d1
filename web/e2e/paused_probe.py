# SPDX-License-Identifier: Apache-2.0
"""A study, named by IOTA_STUDY, that stays at its start, for pictures of it."""

from __future__ import annotations

import os
from pathlib import Path
from tempfile import mkdtemp

import iota
from iota import studies

NAME = os.environ["IOTA_STUDY"]


def build() -> iota.World:
    make = studies.module(NAME).build
    world: iota.World = make(Path(mkdtemp())) if NAME == "playground" else make()
    world.paused = True
    return world
