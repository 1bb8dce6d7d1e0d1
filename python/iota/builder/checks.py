# SPDX-License-Identifier: Apache-2.0
"""Checks of a structure; the errors name the item."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from itertools import chain
from operator import index
from typing import TYPE_CHECKING, Any

import numpy as np

from iota.builder.parts import ACTUATOR_LAWS, COORDINATES, JOINT_KINDS, TIE_KINDS

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from iota.builder.contents import Contents
    from iota.builder.parts import Actuator, Coupling

    Numbers = NDArray[np.int64]

NEAR = 1e-6  # m: largest distance of a hinge's two points


def label(what: str, number: int, name: str = "") -> str:
    """'body 3 "door"'."""
    return f'{what} {number} "{name}"' if name else f"{what} {number}"


def problems(structure: Contents) -> Iterator[str]:
    """One sentence for each inconsistency; none for a structure that can be realized."""
    members = _members(structure)
    wrong = [*_missing_points(structure, members), *_missing_bodies(structure), *_missing_joints(structure)]
    if wrong:  # the other checks need valid indices
        yield from wrong
        return
    owner = np.full(len(structure.points), -1)
    owner[members] = np.repeat(np.arange(len(structure.bodies)), [len(body.points) for body in structure.bodies])
    yield from _points(structure, members)
    yield from _bodies(structure)
    yield from _hinges(structure, owner)
    yield from _kinds(structure)
    yield from _actuators(structure)
    yield from _names(structure)


def _members(structure: Contents) -> Numbers:
    """The points of all bodies, in one list."""
    return _numbers(chain.from_iterable(body.points for body in structure.bodies))


def _numbers(values: Iterable[int]) -> Numbers:
    """As an array; items that are not whole numbers become -1."""
    listed = list(values)
    try:
        return np.fromiter(map(index, listed), int, len(listed))
    except (TypeError, OverflowError):
        return np.array([value if isinstance(value, int) and abs(value) < 2**62 else -1 for value in listed], int)


def _missing_points(structure: Contents, members: Numbers) -> Iterator[str]:
    """References to points that do not exist."""
    count = len(structure.points)

    def all_there(numbers: Numbers) -> bool:
        return bool(((numbers >= 0) & (numbers < count)).all())

    def unknown(owner: str, numbers: Iterable[int]) -> Iterator[str]:
        for number in numbers:
            if not all_there(_numbers([number])):
                yield f"{owner}: there is no point {number!r}, only {count} points"

    if not all_there(members):
        for number, body in enumerate(structure.bodies):
            yield from unknown(label("body", number, body.name), body.points)
    for number, bond in enumerate(structure.bonds):
        yield from unknown(label("bond", number, bond.name), (bond.p, bond.q))
    for number, tie in enumerate(structure.ties):
        yield from unknown(label(tie.kind, number, tie.name), (tie.p, *tie.over, tie.q))
    for what, pairs in (("hinge", structure.hinges), ("line", structure.lines)):
        if not all_there(_numbers(chain.from_iterable(pairs))):
            for number, pair in enumerate(pairs):
                yield from unknown(label(what, number), pair)
    yield from unknown("nails", structure.nails)
    for name, group in structure.groups.items():
        yield from unknown(f'group "{name}"', group)
    for name, point in structure.point_names.items():
        yield from unknown(f'name "{name}"', (point,))


def _missing_bodies(structure: Contents) -> Iterator[str]:
    count = len(structure.bodies)
    for number, joint in enumerate(structure.joints):
        for body in (joint.a, joint.b):
            if body is not None and not 0 <= body < count:
                yield f"{label(joint.kind, number, joint.name)}: there is no body {body!r}, only {count} bodies"

    for number, pair in enumerate(structure.passing):
        for body in pair:
            if body not in range(count):
                yield f"passing {number}: there is no body {body!r}, only {count} bodies"

    for place in structure.places:
        if place.body not in range(count):
            yield f'place "{place.name}": there is no body {place.body!r}, only {count} bodies'


def _missing_joints(structure: Contents) -> Iterator[str]:
    count = len(structure.joints)
    driven: list[tuple[str, int, Coupling | Actuator]] = [
        *(("coupling", number, coupling) for number, coupling in enumerate(structure.couplings)),
        *(("actuator", number, actuator) for number, actuator in enumerate(structure.actuators)),
    ]
    for what, number, each in driven:
        for joint, coordinate, _ in each.terms:
            owner = label(what, number, each.name)
            if not 0 <= joint < count:
                yield f"{owner}: there is no joint {joint!r}, only {count} joints"
            elif coordinate not in COORDINATES:
                yield f"{owner}: a coordinate must be one of {', '.join(COORDINATES)}, not {coordinate!r}"


def _points(structure: Contents, members: Numbers) -> Iterator[str]:
    points = structure.points
    for name, rows in (("position", points.position), ("velocity", points.velocity)):
        for number in np.flatnonzero(~np.isfinite(rows).all(axis=1)):
            yield f"point {number}: its {name} must be finite, not {tuple(rows[number].tolist())}"
    for number in np.flatnonzero(~(np.isfinite(points.mass) & (points.mass >= 0))):
        yield f"point {number}: its mass must be finite and at least 0 kg, not {points.mass[number]}"
    for number in np.flatnonzero(~(np.isfinite(points.radius) & (points.radius >= 0))):
        yield f"point {number}: its radius must be finite and at least 0 m, not {points.radius[number]}"
    uses = np.bincount(members, minlength=len(points))
    for number in np.flatnonzero(uses > 1):
        yield f"point {number} is in {uses[number]} bodies, or twice in one; hinge two points instead"
    for number in np.flatnonzero((uses == 0) & (points.mass == 0)):
        yield f"point {number}: it is a body of its own, so its mass must be above 0 kg"


def _bodies(structure: Contents) -> Iterator[str]:
    for number, body in enumerate(structure.bodies):
        name = label("body", number, body.name)
        if body.shape is None and not body.points:
            yield f"{name} has neither points nor a shape"
        if body.shape is not None:
            for point in body.points:
                if structure.points.mass[point] != 0:
                    yield f"{name} has its mass from its shape, so the mass of point {point} must be 0 kg"
        elif body.others or body.inertia is not None:
            yield f"{name} has other shapes or an inertia, but no shape"
        if body.inertia is not None and (body.mass is None or body.center is None):
            yield f"{name} has an inertia, so it needs a mass and a center"
        if body.rod is not None and len(body.points) != 2:
            yield f"{name}: a rod has two points, not {len(body.points)}"
        if body.look and body.look not in structure.looks:
            yield f"{name}: there is no look {body.look!r}"

    for place in structure.places:
        if structure.bodies[place.body].shape is None:
            yield f'place "{place.name}": its body has no shape'


def _hinges(structure: Contents, owner: Numbers) -> Iterator[str]:
    if not structure.hinges:
        return
    pairs = _numbers(chain.from_iterable(structure.hinges)).reshape(-1, 2)
    p, q = pairs[:, 0], pairs[:, 1]
    gaps = np.linalg.norm(structure.points.position[p] - structure.points.position[q], axis=1)
    for number in np.flatnonzero(~(gaps <= NEAR)):
        yield f"hinge {number}: points {p[number]} and {q[number]} are {gaps[number]:.6g} m apart"
    for number in np.flatnonzero((p == q) | ((owner[p] == owner[q]) & (owner[p] >= 0))):
        yield f"hinge {number}: points {p[number]} and {q[number]} are of one body"


def _kinds(structure: Contents) -> Iterator[str]:
    for number, joint in enumerate(structure.joints):
        if joint.kind not in JOINT_KINDS:
            yield f"{label('joint', number, joint.name)}: kind must be one of {', '.join(JOINT_KINDS)}, not {joint.kind!r}"
    for number, tie in enumerate(structure.ties):
        if tie.kind not in TIE_KINDS:
            yield f"{label('tie', number, tie.name)}: kind must be one of {', '.join(TIE_KINDS)}, not {tie.kind!r}"


def _actuators(structure: Contents) -> Iterator[str]:
    uses = Counter((joint, name) for each in structure.actuators for joint, name, _ in each.terms)
    for number, each in enumerate(structure.actuators):
        owner = label("actuator", number, each.name)
        if each.law not in ACTUATOR_LAWS:
            yield f"{owner}: law must be one of {', '.join(ACTUATOR_LAWS)}, not {each.law!r}"
            continue
        if not each.terms:
            yield f"{owner} drives no joint"
        has_spring = each.stiffness != 0 or each.damping != 0
        values = {"gain": each.gain, "constant": each.constant, "control": each.control}
        values |= {"stiffness": each.stiffness, "damping": each.damping}
        for name, value in values.items():
            is_positive = name in ("stiffness", "damping")
            if not _is_number(value) or (is_positive and value < 0):
                yield f"{owner}: {name} must be finite{' and at least 0' if is_positive else ''}, not {value}"
        for _, _, ratio in each.terms:
            if not _is_number(ratio) or ratio == 0:
                yield f"{owner}: a ratio must be finite and not 0, not {ratio}"
        for name in ("control_range", "force_range", "travel"):
            ends = getattr(each, name)
            if ends is not None and not (len(ends) == 2 and all(end == end for end in ends) and ends[0] <= ends[1]):
                yield f"{owner}: {name} must be two numbers, the lower one first, not {ends}"
        if len(each.terms) > 1 and (has_spring or each.law != "force"):
            yield f"{owner}: one of several coordinates has a constant force only, no stiffness, damping or other law"
        if each.law != "force":
            if each.force_range is None or not all(map(_is_number, each.force_range)):
                yield f"{owner}: the law {each.law!r} needs a finite force_range"
            if any(uses[joint, name] > 1 for joint, name, _ in each.terms):
                yield f"{owner}: a coordinate with the law {each.law!r} has no other actuator"


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float | np.number) and bool(np.isfinite(value))


def _names(structure: Contents) -> Iterator[str]:
    named: tuple[Sequence[Any], ...] = (
        structure.bodies,
        structure.bonds,
        structure.joints,
        structure.ties,
        structure.couplings,
        structure.actuators,
        structure.places,
    )
    names = Counter(item.name for items in named for item in items if item.name)
    names.update(structure.point_names.keys())
    for name, count in names.items():
        if count > 1:
            yield f'the name "{name}" is given {count} times'
