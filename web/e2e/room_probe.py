# SPDX-License-Identifier: Apache-2.0
"""The furnished laboratory of the study lab with finer furniture, of over 100 000 triangles, and a wall read from a GLB file."""

from __future__ import annotations

from pathlib import Path
from tempfile import mkdtemp

import trimesh

import iota
from iota.shapelib import read_model
from iota.studies import _laboratory


def build() -> iota.World:
    system = iota.System()
    system.body().particle((0, 1, 0)).nail()
    world = iota.World(system, title="room", ground=0)
    world.camera = iota.Camera(position=(0.3, 1.5, 1.5), target=(0, 1.2, 0))
    room = _laboratory.furnish(world, detail=2)
    assert room.triangles > 100_000
    # The laboratory is open to this side.
    file = Path(mkdtemp()) / "wall.glb"
    wall = trimesh.Trimesh([(-4.5, 0, 3.5), (4.5, 0, 3.5), (4.5, 3, 3.5), (-4.5, 3, 3.5)], [(0, 1, 2), (0, 2, 3)])
    trimesh.Scene(wall).export(file)
    world.drawings.model(read_model(file), solid=True)
    return world
