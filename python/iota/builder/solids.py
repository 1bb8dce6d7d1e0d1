# SPDX-License-Identifier: Apache-2.0
"""Makers of structures of solids: cuboid, ladder, bridge, tower, tree, soft block."""

from __future__ import annotations

import math
from itertools import pairwise, product
from typing import Any

import numpy as np

from iota import looks
from iota._core import Box, Cylinder
from iota.builder.dressing import Dress, check, check_counts, dress, place
from iota.builder.points import Vector
from iota.builder.structure import Structure
from iota.colors import ColorLike


def cuboid(
    size: Vector = (0.3, 0.3, 0.3), position: Vector = (0, 1, 0), density: float = 700.0, look: Dress | None = None
) -> Structure:
    """A solid box whose eight corners are points, to be hinged, bonded or nailed. size: m. Bodies: "cuboid"."""
    x, y, z = place("size", size)
    check(x=x, y=y, z=z, density=density)
    middle = place("position", position)
    made = Structure()
    corners = made.points.add(middle + np.array(list(product((-0.5, 0.5), repeat=3))) * [x, y, z], 0.0)
    box = Box((x, y, z))
    made.body(*corners, shape=box, density=density, position=tuple(middle.tolist()), look="cuboid")
    return dress(made, {"cuboid": looks.solid("wood")}, look)


def bridge(
    planks: int = 12,
    length: float = 3.0,
    width: float = 0.6,
    thickness: float = 0.03,
    sag: float = 0.15,
    middle: Vector = (0, 1.5, 0),
    density: float = 600.0,
    look: Dress | None = None,
) -> Structure:
    """A footbridge along x: planks hinged by their edges, hanging in an arc from two nailed edges at the height of `middle`.
    length: of all planks, m. sag: share by which the distance of the ends is shorter. Each plank has four points.
    Bodies: "plank"."""
    check(length=length, width=width, thickness=thickness, density=density, sag=sag)
    check_counts(2, planks=planks)
    if sag > 0.9:
        raise ValueError(f"sag must be at most 0.9 of the length, by which the ends are nearer than it, not {sag:g}")
    step, low, high = length / planks, 1e-9, math.pi
    for _ in range(80):  # the corners are on a circle: half of its arc, by bisection
        half = (low + high) / 2
        low, high = (half, high) if math.sin(half) / (planks * math.sin(half / planks)) > 1 - sag else (low, half)
    radius = step / (2 * math.sin(half / planks))
    angle = np.linspace(-half, half, planks + 1)
    arc = np.stack([radius * np.sin(angle), radius * (math.cos(half) - np.cos(angle)), 0 * angle], axis=1)
    arc += place("middle", middle)
    made = Structure()
    for number, (p, q) in enumerate(pairwise(arc)):
        points = made.points.add([end + [0, 0, z] for end in (p, q) for z in (-width / 2, width / 2)], 0.0)
        lean = math.atan2(q[1] - p[1], q[0] - p[0]) / 2
        made.body(
            *points, shape=Box((0.94 * step, thickness, width)), density=density, position=tuple(((p + q) / 2).tolist()),
            orientation=(0, 0, math.sin(lean), math.cos(lean)), look="plank",
        )  # fmt: skip
        if number:
            made.hinge(points[0] - 2, points[0])
            made.hinge(points[0] - 1, points[1])
    made.nail(0, 1, len(made.points) - 2, len(made.points) - 1)
    return dress(made, {"plank": looks.solid("wood")}, look)


def ladder(
    rungs: int = 8,
    spacing: float = 0.25,
    width: float = 0.35,
    radius: float = 0.015,
    top: Vector = (0, 2.5, 0),
    density: float = 700.0,
    look: Dress | None = None,
) -> Structure:
    """A rope ladder: round rungs along x, tied to the ones above them by two ropes; the uppermost is nailed. spacing, width,
    radius: m. Bodies: "rung"."""
    check(spacing=spacing, width=width, radius=radius, density=density)
    check_counts(rungs=rungs)
    made, start = Structure(), place("top", top)
    for number in range(rungs):
        middle = start - [0, number * spacing, 0]
        ends = made.points.add(middle + np.array([(-0.45 * width, 0, 0), (0.45 * width, 0, 0)]), 0.0)
        made.body(
            *ends, shape=Cylinder(radius, width), density=density, position=tuple(middle.tolist()), look="rung"
        )  # fmt: skip
        if number:
            for end in ends:
                made.tie("rope", end - 2, end)
    made.nail(0, 1)
    return dress(made, {"rung": looks.solid("wood")}, look)


def tower(
    storeys: int = 6,
    size: Vector = (0.3, 0.2, 0.3),
    foot: Vector = (0, 0, 0),
    density: float = 700.0,
    strength: float = math.inf,
    look: Dress | None = None,
) -> Structure:
    """Boxes on top of each other, the lowest one fixed to the world, joined by welds that break at a torque of
    `strength` N m. size: of a box, m. Bodies: "storey"."""
    x, y, z = place("size", size)
    check(x=x, y=y, z=z, density=density, strength=min(strength, 1e30))
    check_counts(storeys=storeys)
    made, start = Structure(), place("foot", foot)
    for number in range(storeys):
        middle = start + [0, (number + 0.5) * y, 0]
        made.body(shape=Box((x, y, z)), density=density, position=tuple(middle.tolist()), look="storey")
        seam = tuple((middle - [0, y / 2, 0]).tolist())
        limit: dict[str, Any] = {"break_torque": strength} if strength < math.inf else {}
        made.joint("weld", number, number - 1 if number else None, at=seam, **limit)
    return dress(made, {"storey": looks.solid("wood")}, look)


def tree(
    levels: int = 4,
    branches: int = 3,
    height: float = 0.8,
    radius: float = 0.04,
    foot: Vector = (0, 0, 0),
    stiffness: float = 200.0,
    density: float = 600.0,
    look: Dress | None = None,
) -> Structure:
    """A trunk that forks: each branch is a cylinder joined by springs to the one below it, two thirds as long, half as
    thick. height, radius: of the trunk, m. stiffness: of its foot, N m/rad. The points are the ends of the outermost
    branches: the group "twigs". Bodies: "branch"."""
    check(height=height, radius=radius, stiffness=stiffness, density=density)
    check_counts(levels=levels, branches=branches)
    if branches**levels > 100_000:
        raise ValueError(f"{branches} branches on {levels} levels are too many")
    made = Structure()
    golden = math.pi * (3 - math.sqrt(5))

    def grow(below: int | None, start: np.ndarray, way: np.ndarray, level: int, turn: float) -> None:
        long, thick, hold = height * (2 / 3) ** level, radius / 2**level, stiffness / 8**level
        end, middle = start + long * way, start + long / 2 * way
        across = np.cross(way, [0.0, 0, 1] if abs(way[2]) < 0.9 else [1.0, 0, 0])
        across /= np.linalg.norm(across)
        half = math.acos(float(np.clip(way[0], -1, 1))) / 2  # from x, about an axis normal to both
        axis = np.cross([1.0, 0, 0], way)
        axis = axis / np.linalg.norm(axis) if np.linalg.norm(axis) > 1e-9 else np.array([0.0, 1, 0])
        turned = (*(math.sin(half) * axis).tolist(), math.cos(half))
        points = list(made.points.add(end, 0.0)) if level == levels - 1 else []
        number = made.body(
            *points, shape=Cylinder(thick, long), density=density, position=tuple(middle.tolist()), orientation=turned,
            look="branch",
        )  # fmt: skip
        spring = (hold, 0.05 * hold, 0.0)
        made.joint(
            "universal", number, below, at=tuple(start.tolist()), axis=tuple(across.tolist()),
            second_axis=tuple(np.cross(way, across).tolist()), spring=spring, second_angle={"spring": spring},
        )  # fmt: skip
        if level == levels - 1:
            return
        for branch in range(branches):
            angle = turn + 2 * math.pi * branch / branches
            side = math.cos(angle) * across + math.sin(angle) * np.cross(way, across)
            lean = 0.85 * way + 0.53 * side
            grow(number, end, lean / np.linalg.norm(lean), level + 1, angle + golden)

    grow(None, place("foot", foot), np.array([0.0, 1, 0]), 0, 0.0)
    made.group("twigs", range(len(made.points)))
    return dress(made, {"branch": looks.solid("wood")}, look)


def soft_block(
    size: Vector = (0.4, 0.3, 0.3),
    cells: tuple[int, int, int] = (4, 3, 3),
    position: Vector = (0, 1, 0),
    density: float = 300.0,
    stiffness: float = 400.0,
    color: ColorLike = (0.3, 0.65, 0.6),
) -> Structure:
    """A block of cells, each cut into six tetrahedra (Kuhn 1960), springs along their edges. size: m. stiffness: of an edge,
    N/m. Its points, z fastest, are the group "block"."""
    edges = place("size", size)
    check(x=edges[0], y=edges[1], z=edges[2], density=density, stiffness=stiffness)
    check_counts(x=cells[0], y=cells[1], z=cells[2])
    counts = np.array(cells) + 1
    made, grid = Structure(), np.indices(tuple(counts.tolist())).reshape(3, -1).T
    step = edges / cells
    mass = density * float(np.prod(edges)) / len(grid)
    points = place("position", position) + (grid - (counts - 1) / 2) * step
    made.points.add(points, mass, radius=0.12 * float(step.min()), color=color)
    number = np.arange(len(grid)).reshape(counts)
    nx, ny, nz = counts
    critical = 2 * math.sqrt(stiffness * mass / 2)
    for dx, dy, dz in list(product((0, 1), repeat=3))[1:]:  # axes, diagonals of faces and of the cell, all upwards
        p = number[: nx - dx, : ny - dy, : nz - dz].ravel().tolist()
        q = number[dx:, dy:, dz:].ravel().tolist()
        for a, b in zip(p, q, strict=True):
            made.bond(a, b, "spring", stiffness=stiffness, damping=0.1 * critical)
    made.group("block", range(len(grid)))
    return made
