# SPDX-License-Identifier: Apache-2.0
"""Meshes of robots, as they are found: closed where they can be, open ones to be drawn."""

from __future__ import annotations

from typing import Any

import numpy as np

from iota._core import Mesh


def mesh_of(vertices: Any, triangles: Any, scale: Any = (1.0, 1.0, 1.0)) -> tuple[Mesh, bool]:
    """A mesh, and whether it was inside out and is turned round. scale: of each axis; a mirrored mesh is turned right side out.
    Raises ValueError for what is no mesh at all."""
    places, faces = np.asarray(vertices, float) * scale, np.asarray(triangles)
    if np.prod(scale) < 0:
        faces = faces[:, ::-1]
    try:
        return Mesh(places, faces), False
    except ValueError as error:
        if "inside out" in str(error):
            return Mesh(places, faces[:, ::-1]), True
    return Mesh(places, faces, closed=False), False


def hull_of(mesh: Mesh) -> Mesh:
    """The convex hull, by which an open mesh touches that is on a body that moves. Raises ValueError for a flat one."""
    return Mesh.convex_hull(mesh.vertices)
