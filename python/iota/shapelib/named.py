# SPDX-License-Identifier: Apache-2.0
"""Polyhedra by their names."""

from __future__ import annotations

import difflib
import re

import numpy as np

from iota.shapelib.convex import dual, hull
from iota.shapelib.geodesic import fullerene, geodesic
from iota.shapelib.johnson import LAST, antiprism, johnson, prism, pyramid, ring
from iota.shapelib.surface import Surface
from iota.shapelib.uniform import SNUB, UNIFORM, uniform

CATALAN = {
    "triakis tetrahedron": "truncated tetrahedron", "rhombic dodecahedron": "cuboctahedron",
    "triakis octahedron": "truncated cube", "tetrakis hexahedron": "truncated octahedron",
    "deltoidal icositetrahedron": "rhombicuboctahedron", "disdyakis dodecahedron": "truncated cuboctahedron",
    "pentagonal icositetrahedron": "snub cube", "rhombic triacontahedron": "icosidodecahedron",
    "triakis icosahedron": "truncated dodecahedron", "pentakis dodecahedron": "truncated icosahedron",
    "deltoidal hexecontahedron": "rhombicosidodecahedron", "disdyakis triacontahedron": "truncated icosidodecahedron",
    "pentagonal hexecontahedron": "snub dodecahedron",
}  # fmt: skip
SIZED = ("antiprism", "fullerene", "geodesic", "prism", "pyramid")
MOST_SIDES = 1000


def polyhedron_names() -> list[str]:
    """Every name that `polyhedron` takes; N stands for a number."""
    return [
        *UNIFORM,
        *SNUB,
        *CATALAN,
        *(f"J{number}" for number in range(1, LAST + 1)),
        *(f"{name} N" for name in SIZED),
    ]


def named_polyhedron(name: str) -> Surface:
    """By one of those names; letter case, hyphens and repeated spaces do not matter. Raises ValueError."""
    plain = " ".join(name.lower().replace("-", " ").replace("_", " ").split())
    if plain in UNIFORM or plain in SNUB:
        return uniform(plain)
    if plain in CATALAN:
        return dual(uniform(CATALAN[plain]))
    found = re.fullmatch(r"(?:j|johnson) ?(\d{1,4})", plain)
    if found:
        return johnson(int(found.group(1)))
    found = re.fullmatch(rf"({'|'.join(SIZED)}) (\d{{1,6}})", plain) or re.fullmatch(r"(c)(\d{1,6})", plain)
    if found:
        return _sized(found.group(1), int(found.group(2)))
    near = difflib.get_close_matches(plain, [known.lower() for known in polyhedron_names()], n=1)
    hint = (
        f"; did you mean {near[0]!r}?"
        if near
        else "; polyhedron_names() lists them, files end in .off, .obj, .stl ..., and a molecule's text begins with smiles:"
    )
    raise ValueError(f"there is no polyhedron named {name[:60]!r}{hint}")


def _sized(kind: str, number: int) -> Surface:
    if kind in ("fullerene", "c"):
        return fullerene(number)
    if kind == "geodesic":
        return geodesic(number)
    most = 5 if kind == "pyramid" else MOST_SIDES
    if not 3 <= number <= most:
        raise ValueError(f"a {kind} with edges of one length has from 3 to {most} sides, not {number}")
    if kind == "prism":
        return hull(prism(number))
    if kind == "antiprism":
        return hull(antiprism(number))
    solid = hull(np.concatenate([ring(number), pyramid(number)]))
    solid.vertices -= solid.vertices.mean(axis=0)
    return solid
