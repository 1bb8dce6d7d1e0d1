# SPDX-License-Identifier: Apache-2.0
"""Structures as JSON: the fields of the contents, without default values; shapes in the format of `iota.shapes`, looks
in that of `iota.looks`."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import fields
from typing import Any, TypeVar

import numpy as np

from iota import looks, shapes
from iota._core import Vec3
from iota.builder.checks import label
from iota.builder.contents import Contents
from iota.builder.parts import Coupling, Joint, RigidBody, SoftBond, Tie

PARTS: dict[str, type[Any]] = {
    "bodies": RigidBody, "bonds": SoftBond, "joints": Joint, "ties": Tie, "couplings": Coupling,
}  # fmt: skip
PAIRS = ("hinges", "lines")
PLAIN = ("nails", "groups", "point_names")

Filled = TypeVar("Filled", bound=Contents)


def to_json(structure: Contents) -> dict[str, Any]:
    data: dict[str, Any] = {"points": structure.points.to_json()}
    for name, kind in PARTS.items():
        data[name] = [
            _part(part, label(kind.__name__, number, part.name)) for number, part in _counted(structure, name)
        ]
    for name in (*PAIRS, *PLAIN):
        data[name] = _plain(getattr(structure, name), name)
    data["looks"] = {name: looks.to_json(styles) for name, styles in structure.looks.items()}
    return data


def from_json(structure: Filled, data: dict[str, Any]) -> Filled:
    """Fills an empty structure."""
    known = {"points", "looks", *PARTS, *PAIRS, *PLAIN}
    if unknown := sorted(data.keys() - known):
        raise ValueError(f"a structure has no {', '.join(unknown)}; it has {', '.join(sorted(known))}")
    structure.points.add(
        **{
            name: np.reshape(rows, -1 if name in ("mass", "radius") else (-1, 3))
            for name, rows in data["points"].items()
        }
    )
    for name, kind in PARTS.items():
        for number, entry in enumerate(data.get(name, ())):
            try:
                shape = {"shape": shapes.from_json(entry["shape"])} if "shape" in entry else {}
                getattr(structure, name).append(kind(**entry | shape))
            except (TypeError, ValueError) as error:
                raise ValueError(f"{label(kind.__name__, number, entry.get('name', ''))}: {error}") from None
    for name in PAIRS:
        setattr(structure, name, [(p, q) for p, q in data.get(name, ())])
    for name in PLAIN:
        setattr(structure, name, data.get(name, getattr(structure, name)))
    structure.looks = {name: looks.from_json(styles) for name, styles in data.get("looks", {}).items()}
    return structure


def _counted(structure: Contents, name: str) -> enumerate[Any]:
    return enumerate(getattr(structure, name))


def _part(part: Any, name: str) -> dict[str, Any]:
    entry = {}
    for field in fields(part):
        value = getattr(part, field.name)
        if isinstance(value, np.ndarray):
            value = tuple(value.tolist())
        if value != field.default:
            entry[field.name] = _plain(value, f"{name}: {field.name}")
    return entry


def _plain(value: Any, name: str) -> Any:
    """The value as lists, numbers and texts. Raises ValueError that names its owner."""
    if value is None or isinstance(value, bool | int | str):
        return value
    if isinstance(value, float) and math.isfinite(value):
        return value
    if isinstance(value, dict):
        return {key: _plain(item, f"{name}.{key}") for key, item in value.items()}
    if type(value) in shapes.KINDS.values():
        return shapes.to_json(value)
    if isinstance(value, np.ndarray | np.generic):
        return value.tolist()
    if isinstance(value, Vec3 | Sequence):
        return [_plain(item, name) for item in value]
    raise ValueError(f"{name} cannot be saved: {value!r}")
