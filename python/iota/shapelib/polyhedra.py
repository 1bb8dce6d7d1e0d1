# SPDX-License-Identifier: Apache-2.0
"""Polyhedra and other surfaces as structures: solid, soft, or a frame of hinged rods."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from iota import looks
from iota._core import Mesh
from iota.builder.parts import RigidBody
from iota.builder.points import Vector
from iota.looks import MOST_TRIANGLES, Drawn
from iota.shapelib.apart import apart
from iota.shapelib.files import FileError, PathLike, check_reach
from iota.shapelib.imported import Imported
from iota.shapelib.molecules import KINDS, Kind, add_springs
from iota.shapelib.named import named_polyhedron
from iota.shapelib.surface import Surface
from iota.shapelib.surface_files import READERS, read_surface

if TYPE_CHECKING:
    from numpy.typing import NDArray

WIDE, NARROW = 100.0, 1e-3  # m: files have numbers without a unit, and such solids are hardly made in meters
MOST_EDGES = 100_000
LIGHTEST, HEAVIEST = 1e-30, 1e15  # kg, of a body


def _is_file(source: PathLike) -> bool:
    return not isinstance(source, str) or Path(source).suffix.lower() in READERS


@apart(_is_file)
def polyhedron(
    source: PathLike,
    kind: Kind = "rigid",
    *,
    scale: float = 1.0,
    density: float = 1000.0,
    mass: float | None = None,
    at: Vector = (0.0, 0.0, 0.0),
    stiffness: float | None = None,
    damping: float = 0.05,
    radius: float | None = None,
    look: Drawn | None = None,
) -> Imported:
    """A polyhedron from a file that ends in .off, .obj, .stl, .ply, .gltf or .glb, or by its name: `polyhedron_names()` has
    the Platonic, Archimedean, Catalan and Johnson solids; "prism 7", "antiprism 5", "pyramid 4", "geodesic 4" (a ball of
    20 * 4^2 triangles) and "fullerene 60" (also 20, 80, 180, 240 ...) take a number. By name, edges are 1 m long before
    scaling; geodesic balls and fullerenes have a radius of 1 m.

    kind: "rigid", each connected piece of the surface is a solid body of a `density` (kg/m^3); "soft", vertices are points,
    edges are springs, and weaker springs hold their angles; "flexible", edges are rods, hinged at the vertices. mass: of all,
    kg, instead of the density; soft and flexible ones have 1 kg by default. at: place of the center of mass, m.
    stiffness, damping: see `molecule`. radius: of the vertices of soft ones and the rods of flexible ones, m. look: of
    the bodies.

    If all faces are wound inward, they are turned, with a note. Raises `FileError` (a ValueError) that names file, line
    and the first wrong edge of a surface that is not closed.

        ball = iota.shapelib.polyhedron("truncated icosahedron", kind="soft", scale=0.2, at=(0, 2, 0))
        part = iota.shapelib.polyhedron("part.stl", scale=0.001, density=7800)
    """
    if kind not in KINDS:
        raise ValueError(f"kind must be one of {', '.join(KINDS)}, not {kind!r}")
    if not 0 < scale < math.inf:
        raise ValueError(f"scale must be above 0, not {scale}")
    if mass is not None and not 0 < mass < math.inf:
        raise ValueError(f"mass must be above 0, not {mass}")
    surface = read_surface(source) if _is_file(source) else named_polyhedron(str(source))
    count = len(surface.vertices)
    check_reach(scale * surface.vertices, source)
    surface.weld()
    if not surface.faces:
        raise FileError(source, "has no faces with an area")
    structure = Imported(title=Path(source).stem if _is_file(source) else str(source), notes=surface.notes)
    edges, named = surface.edges(), set(surface.groups) - {""}
    structure.counts = {
        "vertices": count, "welded vertices": len(np.unique(edges)), "edges": len(edges), "faces": len(surface.faces),
        "triangles": len(surface.triangles()[0]), "area": surface.area() * scale**2,
    }  # fmt: skip
    if named:
        structure.counts["groups"] = len(named)
    surface.vertices *= scale
    if _is_file(source) and scale == 1:
        size = float(np.ptp(surface.vertices, axis=0).max())
        if size > WIDE or size < NARROW:
            structure.notes.append(
                f"it is {size:.3g} m large; if its unit is not the meter, give scale, as in scale=0.001"
            )
    if kind == "rigid":
        _make_solid(structure, surface, source, density, mass, look)
        _center(structure, at)
        return structure
    if len(edges) > MOST_EDGES:
        raise FileError(source, f"has {len(edges)} edges, more than {MOST_EDGES}, too many to be {kind}")
    used = np.unique(edges)
    edges = np.searchsorted(used, edges)
    places = surface.vertices[used]
    thickness = radius or 0.06 * float(np.linalg.norm(places[edges[:, 0]] - places[edges[:, 1]], axis=1).mean())
    if kind == "soft":
        structure.points.add(places, (mass or 1.0) / len(places), radius=thickness, color=(0.75, 0.55, 0.2))
        add_springs(structure, edges, stiffness, damping)
    else:
        _make_frame(structure, places, edges, mass or 1.0, thickness, look)
    _center(structure, at)
    return structure


def _make_solid(
    structure: Imported, surface: Surface, source: PathLike, density: float, mass: float | None, look: Drawn | None
) -> None:
    surface.check(source)
    parts = surface.split()
    volumes = [part.volume() for part in parts]
    if all(volume < 0 for volume in volumes):
        for part in (surface, *parts):
            part.faces = [face[::-1] for face in part.faces]
        volumes = [-volume for volume in volumes]
        structure.notes.append("its faces were wound inward and were turned")
    elif min(volumes) < 0:  # a cavity has to stay with its enclosing surface
        parts, volumes = [surface], [sum(volumes)]
    structure.counts |= {"pieces": len(parts), "volume": sum(volumes)}
    for volume in volumes:
        weight = density * volume if mass is None else mass * volume / sum(volumes)
        if not LIGHTEST <= weight <= HEAVIEST:
            raise FileError(source, f"a body of it has {weight:.3g} kg; give scale, density or mass")
    structure.looks["solid"] = look if look is not None else looks.solid("paint")
    for number, (part, volume) in enumerate(zip(parts, volumes, strict=True), 1):
        triangles, _ = part.triangles()
        if len(triangles) > MOST_TRIANGLES:
            structure.notes.append(f"the page draws a box for {len(triangles)} triangles, more than {MOST_TRIANGLES}")
        middle = part.vertices.mean(axis=0)
        try:
            shape = Mesh(part.vertices - middle, triangles)
        except ValueError as error:
            raise FileError(source, str(error)) from None
        names = set(part.groups)
        structure.bodies.append(
            RigidBody(
                [],
                name=names.pop() if len(names) == 1 and len(parts) > 1 else f"piece {number}" if len(parts) > 1 else "",
                shape=shape,
                density=density,
                mass=mass and mass * volume / sum(volumes),
                position=tuple(middle.tolist()),
                look="solid",
            )
        )
    names_given = [body.name for body in structure.bodies]
    for number, body in enumerate(structure.bodies, 1):
        if names_given.count(body.name) > 1:
            body.name = f"{body.name} {number}"


def _make_frame(
    structure: Imported,
    places: NDArray[np.float64],
    edges: NDArray[np.int64],
    mass: float,
    radius: float,
    look: Drawn | None,
) -> None:
    structure.looks["rod"] = look if look is not None else looks.capsule(radius, "steel")
    first: dict[int, int] = {}
    for pair in edges.tolist():
        ends = structure.points.add(places[pair], mass / len(edges) / 2)
        structure.body(*ends, look="rod")
        for vertex, end in zip(pair, ends, strict=True):
            if vertex in first:
                structure.hinge(first[vertex], end)
            first.setdefault(vertex, end)


def _center(structure: Imported, at: Vector) -> None:
    """Moves all points so that the center of mass is at a place."""
    weights, centers = list(structure.points.mass), [*structure.points.position]
    for body in structure.bodies:
        if body.shape is not None:
            found = body.shape.mass_properties
            weights.append(found.volume * (body.density or 1000.0) if body.mass is None else body.mass)
            centers.append(np.asarray(body.position) + np.asarray(found.center))
    way = np.asarray(at, float) - np.average(centers, axis=0, weights=weights)
    structure.points.position[:] += way
    for body in structure.bodies:
        body.position = tuple((np.asarray(body.position) + way).tolist())
