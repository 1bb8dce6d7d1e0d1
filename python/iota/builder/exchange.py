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
from iota.arguments import SHORT, of_type
from iota.builder.checks import label
from iota.builder.contents import Contents
from iota.builder.parts import Actuator, Coupling, Joint, Place, RigidBody, SoftBond, Tie

PARTS: dict[str, type[Any]] = {
    "bodies": RigidBody, "bonds": SoftBond, "joints": Joint, "ties": Tie, "couplings": Coupling,
    "places": Place, "actuators": Actuator,
}  # fmt: skip
PAIRS = ("hinges", "lines", "passing")
PLAIN = ("nails", "groups", "point_names")
COLUMNS = {"position": 3, "mass": 1, "velocity": 3, "radius": 1, "color": 3}
# The fields of parts that are not numbers; the engine checks numbers.
FIELDS: dict[str, type] = {
    "points": list, "name": str, "kind": str, "look": str, "p": int, "q": int, "a": int, "body": int, "law": str, "parameters": dict,
    "options": dict, "terms": list, "shape": dict, "others": list, "touches": bool, "material": dict, "over": list,
    "control_range": list, "force_range": list, "travel": list,
}  # fmt: skip

VERSION = 1  # rises when files of before can no longer be read, or would be read wrongly

Filled = TypeVar("Filled", bound=Contents)


def to_json(structure: Contents) -> dict[str, Any]:
    data: dict[str, Any] = {"version": VERSION, "points": structure.points.to_json()}
    for name, kind in PARTS.items():
        data[name] = [
            _part(part, label(kind.__name__, number, part.name)) for number, part in _counted(structure, name)
        ]
    for name in (*PAIRS, *PLAIN):
        data[name] = _plain(getattr(structure, name), name)
    for name in ("passing", "places", "actuators"):  # those without are as of files of before
        if not data[name]:
            del data[name]
    data["looks"] = {name: looks.to_json(styles) for name, styles in structure.looks.items()}
    return data


def from_json(structure: Filled, data: dict[str, Any]) -> Filled:
    """Fills an empty structure."""
    known = {"version", "points", "looks", *PARTS, *PAIRS, *PLAIN}
    # The version comes first, since another one has other parts; files of before it had one are of version 1.
    if (version := of_type(data, dict, "a structure").get("version", 1)) != VERSION:
        raise ValueError(f"the structure has version {SHORT.repr(version)}, and this iota reads version {VERSION}")
    if unknown := sorted(data.keys() - known):
        raise ValueError(f"a structure has no {', '.join(unknown)}; it has {', '.join(sorted(known))}")
    if "points" not in data:
        raise ValueError("the structure has no points")
    structure.points.add(**_rows(data["points"]))
    for name, kind in PARTS.items():
        for number, entry in enumerate(of_type(data.get(name, []), list, name)):
            owner = label(kind.__name__, number, of_type(entry, dict, label(kind.__name__, number)).get("name", ""))
            for key in entry.keys() & FIELDS.keys():
                of_type(entry[key], FIELDS[key], f"{owner}: {key}")
            try:
                read: dict[str, Any] = {"shape": shapes.from_json(entry["shape"])} if "shape" in entry else {}
                if "others" in entry:
                    read["others"] = [_placed(other) for other in entry["others"]]
                getattr(structure, name).append(kind(**entry | read))
            except (TypeError, ValueError) as error:
                raise ValueError(f"{owner}: {error}") from None
    for name in PAIRS:
        for number, pair in enumerate(of_type(data.get(name, []), list, name)):
            if len(of_type(pair, list, f"{name} {number}")) != 2:
                raise ValueError(
                    f"{name} {number} must be two {'bodies' if name == 'passing' else 'points'}, not {len(pair)}"
                )
        setattr(structure, name, [(p, q) for p, q in data.get(name, ())])
    for name in PLAIN:
        usual = getattr(structure, name)
        setattr(structure, name, of_type(data.get(name, usual), type(usual), name))
    for name, members in structure.groups.items():
        of_type(members, list, f"group {name!r}")
    for name, styles in of_type(data.get("looks", {}), dict, "looks").items():
        try:
            structure.looks[name] = looks.from_json(styles)
        except ValueError as error:
            raise ValueError(f"look {name!r}: {error}") from None
    return structure


def _placed(other: Any) -> tuple[Any, Any, Any]:
    if len(of_type(other, list, "each of others")) != 3:
        raise ValueError(f"each of others must be a shape, its place and its orientation, not {SHORT.repr(other)}")
    shape, place, orientation = other
    return shapes.from_json(shape), place, orientation


def _rows(points: Any) -> dict[str, Any]:
    """The columns of points as arrays. Raises ValueError that names one that is wrong."""
    rows: dict[str, Any] = {}
    for name, values in of_type(points, dict, "points").items():
        wide = COLUMNS.get(name)
        if wide is None:
            raise ValueError(f"points have no {name}; they have {', '.join(COLUMNS)}")
        try:
            rows[name] = np.array(values, float).reshape(-1 if wide == 1 else (-1, wide))
        except (TypeError, ValueError, OverflowError):
            what = "numbers" if wide == 1 else f"rows of {wide} numbers"
            raise ValueError(f"points: {name} must be {what}") from None
    if "position" not in rows:
        raise ValueError("points: position is missing")
    for name, values in rows.items():
        if len(values) not in (1, len(rows["position"])):
            raise ValueError(f"points: {name} has {len(values)} rows for {len(rows['position'])} points")
    return rows


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
