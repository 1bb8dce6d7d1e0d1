# SPDX-License-Identifier: Apache-2.0
"""Shapes that the page draws bodies with, as plain dictionaries.

A *class* of bodies has a shape, or a list of shapes, per look; users switch looks on the page while it runs. The look
"*" is used for every look:

    world.classes["link"] = {"rope": looks.cylinder(0.012, "rope"), "chain": looks.chain_link(0.1)}
    world.look(links, "link")

Lengths in m, colors as "#rrggbb", materials one of `MATERIALS`. The body's frame has its origin at the center of mass
and +x from its first particle to its last.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, TypeAlias

Shape: TypeAlias = dict[str, Any]
Looks: TypeAlias = dict[str, Shape | list[Shape]]

MATERIALS = ("steel", "brass", "rubber", "wood", "rope", "glass", "paint")


def _shape(kind: str, material: str, more: dict[str, Any], **sizes: float | None) -> Shape:
    if material not in MATERIALS:
        raise ValueError(f"material must be one of {', '.join(MATERIALS)}, not {material!r}")
    for name, size in sizes.items():
        if size is not None and not (math.isfinite(size) and size >= 0):
            raise ValueError(f"{name} of a {kind} must be finite and at least 0 m, not {size}")
    unknown = more.keys() - {"color", "offset", "rotation", "turn"}
    if kind == "solid":
        unknown = more.keys() - {"color"}
    if unknown:
        raise TypeError(f"a {kind} has no {', '.join(sorted(unknown))}")
    return {"type": kind, "material": material, **{n: s for n, s in sizes.items() if s is not None}, **more}


def sphere(radius: float, material: str = "brass", **more: Any) -> Shape:
    """A ball of `radius` m. `more`: color, offset=(x, y, z) and rotation=(x, y, z, w) in the body's frame."""
    return _shape("sphere", material, more, radius=radius)


def cylinder(radius: float, material: str = "steel", length: float | None = None, **more: Any) -> Shape:
    """A cylinder along local x. Without `length` it is as long as the body: from first to last particle."""
    return _shape("cylinder", material, more, radius=radius, length=length)


def capsule(radius: float, material: str = "steel", length: float | None = None, **more: Any) -> Shape:
    """A cylinder with round ends; `length` is that of the cylinder."""
    return _shape("capsule", material, more, radius=radius, length=length)


def torus(radius: float, tube: float, material: str = "steel", stretch: float = 0.0, **more: Any) -> Shape:
    """A ring in the local x-y plane: center line `radius`, wire radius `tube`, both halves pulled apart along x by
    `stretch`. `turn`: radians about local x for every other body of the class."""
    return _shape("torus", material, more, radius=radius, tube=tube, stretch=stretch)


def box(size: Sequence[float], material: str = "wood", **more: Any) -> Shape:
    """A box with edges `size` = (x, y, z)."""
    x, y, z = (float(edge) for edge in size)
    _shape("box", material, dict(more), x=x, y=y, z=z)
    return {"type": "box", "material": material, "size": [x, y, z], **more}


MOST_TRIANGLES = 50_000


def mesh(vertices: Any, triangles: Any, material: str = "paint", **more: Any) -> Shape:
    """A closed surface: vertices (n, 3) in m, triangles (k, 3), from outside counter-clockwise, as in `iota.Mesh`.
    Raises ValueError above 50 000 triangles."""
    if len(triangles) > MOST_TRIANGLES:
        raise ValueError(
            f"the page draws meshes of at most {MOST_TRIANGLES} triangles, this one has {len(triangles)}: make it coarser, "
            "or give its body a class with another look"
        )
    shape = _shape("mesh", material, more)
    places = [float(f"{x:.6g}") for vertex in vertices for x in vertex]
    return {**shape, "vertices": places, "triangles": [int(v) for triangle in triangles for v in triangle]}


def chain_link(length: float, material: str = "steel") -> Shape:
    """A link of a real chain for a body of `length` m: neighbors touch where they are hinged, turned by 90 degrees."""
    tube, radius = 0.085 * length, 0.26 * length
    return torus(radius, tube, material, stretch=length + 2 * (tube - radius), turn=math.pi / 2)


def solid(material: str, **more: Any) -> Shape:
    """For bodies given by shape: that shape in another material. `more`: color."""
    return _shape("solid", material, more)
