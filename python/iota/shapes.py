# SPDX-License-Identifier: Apache-2.0
"""Conversion of shapes to plain data and back, for files."""

from __future__ import annotations

import copyreg
from collections.abc import Callable
from typing import Any, get_args

from iota._core import Mesh, Shape
from iota.arguments import of_type

KINDS: dict[str, type[Any]] = {shape.kind: shape for shape in get_args(Shape)}


def to_json(shape: Shape) -> dict[str, Any]:
    """A dictionary that JSON can hold: {"kind": "box", "size": [1, 2, 3], "rounding": 0}."""
    if isinstance(shape, Mesh):
        mesh = {"kind": "mesh", "vertices": shape.vertices.tolist(), "triangles": shape.triangles.tolist()}
        return mesh if shape.closed else mesh | {"closed": False}
    sizes = {name: getattr(shape, name) for name in shape.sizes}
    return {"kind": shape.kind} | {name: v if isinstance(v, float) else list(v) for name, v in sizes.items()}


def from_json(data: dict[str, Any]) -> Shape:
    """Reads the result of `to_json`. Raises ValueError that names the error."""
    sizes = dict(of_type(data, dict, "a shape"))
    kind = sizes.pop("kind", None)
    if not isinstance(kind, str) or kind not in KINDS:
        raise ValueError(f"the kind of a shape must be one of {', '.join(KINDS)}, not {kind!r}")
    try:
        shape: Shape = KINDS[kind](**sizes)
    except TypeError:
        raise ValueError(f"a {kind} is described wrongly by {', '.join(sizes) or 'no sizes'}") from None
    return shape


def _pickled(shape: Shape) -> tuple[Callable[..., Shape], tuple[Any, ...]]:
    if isinstance(shape, Mesh):
        return _mesh, (shape.vertices, shape.triangles, shape.closed)
    return type(shape), tuple(getattr(shape, name) for name in shape.sizes)


def _mesh(vertices: Any, triangles: Any, closed: bool) -> Mesh:
    return Mesh(vertices, triangles, closed=closed)


for _kind in KINDS.values():
    copyreg.pickle(_kind, _pickled)
