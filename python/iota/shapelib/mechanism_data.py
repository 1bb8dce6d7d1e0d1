# SPDX-License-Identifier: Apache-2.0
"""A mechanism as data: links with mass and looks, and the joints between them; and as a structure."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from iota import looks
from iota.builder.parts import BodyKind, Coordinate, JointKind, RigidBody
from iota.shapelib.frames import Y_UP, Frame, LinkSolid, look_in, to_quaternion
from iota.shapelib.imported import Imported


@dataclass
class Link:
    """frame: in the world, z up. solid: None for a link that is only a reference. drawn: looks and their places in the
    link's frame."""

    name: str
    frame: Frame
    solid: LinkSolid | None
    drawn: list[tuple[looks.Look, Frame]] = field(default_factory=list)
    kind: BodyKind = "dynamic"


@dataclass
class LinkJoint:
    """As a joint of iota: link a moves relative to b, None for the world. at, axis: in the world, z up."""

    kind: JointKind
    name: str
    a: str
    b: str | None
    at: Any
    axis: Any | None = None
    options: dict[str, Any] = field(default_factory=dict)


@dataclass
class JointCoupling:
    """As a coupling of iota: a sum of ratio times coordinate of revolute and prismatic joints, rad and m, that is kept, or
    that stays at most `length`. terms: names of joints, ratios."""

    name: str
    terms: list[tuple[str, float]]
    length: float | None = None
    one_sided: bool = False


@dataclass
class Mechanism:
    """The content of a file. ropes: two pairs of a link and a place in the world, and a length in m."""

    title: str
    links: list[Link] = field(default_factory=list)
    joints: list[LinkJoint] = field(default_factory=list)
    couplings: list[JointCoupling] = field(default_factory=list)
    ropes: list[tuple[str, tuple[str, Any], tuple[str, Any], float]] = field(default_factory=list)
    counts: dict[str, int | float | str] = field(default_factory=dict)
    notes: list[str] = field(default_factory=list)


def to_structure(mechanism: Mechanism, at: Any, scale: float) -> Imported:
    """y up, enlarged by `scale` (masses are kept), with the origin at `at`."""
    structure = Imported(title=mechanism.title, counts=mechanism.counts, notes=mechanism.notes)
    origin = np.asarray(at, float)
    number: dict[str, int] = {}

    def put(place: Any) -> tuple[float, ...]:
        return tuple((origin + scale * (Y_UP @ place)).tolist())

    used = {link.name for link in mechanism.links}

    def unused(name: str, what: str) -> str:
        """In files a link, a joint and a coupling may have one name."""
        while name in used:
            name += f" {what}"
        used.add(name)
        return name

    def add(link: Link) -> None:
        solid = link.solid
        if solid is None:
            return
        world = link.frame @ solid.frame
        number[link.name] = len(structure.bodies)
        drawn = [_scaled(look_in(solid.frame, look, place), scale) for look, place in link.drawn]
        structure.looks[link.name] = drawn or looks.solid("steel")
        structure.bodies.append(
            RigidBody(
                [],
                name=link.name,
                kind=link.kind,
                shape=type(solid.shape)([scale * size for size in solid.shape.size]),
                mass=solid.mass,
                position=put(world.place),
                orientation=to_quaternion(Y_UP @ world.turn),
                look=link.name,
            )
        )

    for link in mechanism.links:
        add(link)
    for joint in mechanism.joints:
        options = dict(joint.options, at=put(joint.at))
        if joint.axis is not None:
            options["axis"] = tuple((Y_UP @ joint.axis).tolist())
        if joint.kind == "prismatic" and "limits" in options:
            options["limits"] = tuple(scale * limit for limit in options["limits"])
        b = None if joint.b is None else number.get(joint.b)
        structure.joint(joint.kind, number[joint.a], b, name=unused(joint.name, "joint"), **options)
    joint_numbers = {joint.name: n for n, joint in enumerate(mechanism.joints)}
    for coupling in mechanism.couplings:
        terms: list[tuple[int, Coordinate, float]] = []
        for joint_name, ratio in coupling.terms:
            n = joint_numbers[joint_name]
            is_slide = mechanism.joints[n].kind == "prismatic"
            terms.append((n, "slide", ratio / scale) if is_slide else (n, "angle", ratio))
        structure.couple(
            *terms, length=coupling.length, one_sided=coupling.one_sided, name=unused(coupling.name, "coupling")
        )
    for name, (a, p), (b_link, q), length in mechanism.ropes:
        ends: list[int] = []
        for link_name, place in ((a, p), (b_link, q)):
            end = structure.point(put(place), mass=0.0 if link_name in number else 1.0)
            if link_name in number:
                structure.bodies[number[link_name]].points.append(end)
            else:
                structure.nail(end)
            ends.append(end)
        structure.tie("rope", ends[0], ends[1], length=scale * length, name=unused(name, "rope"))
    return structure


def _scaled(look: looks.Look, scale: float) -> looks.Look:
    """Scaled, with the shape's own sizes."""
    from dataclasses import replace

    from iota import shapes

    if scale == 1 or look.shape is None:
        return look
    sizes = shapes.to_json(look.shape)
    if "vertices" in sizes:
        sizes["vertices"] = (scale * np.array(sizes["vertices"])).tolist()
    else:
        for name in look.shape.sizes:
            sizes[name] = [scale * v for v in sizes[name]] if isinstance(sizes[name], list) else scale * sizes[name]
    sizes.pop("kind")
    larger = type(look.shape)(**sizes)
    return replace(look, shape=larger, offset=tuple(scale * v for v in look.offset))
