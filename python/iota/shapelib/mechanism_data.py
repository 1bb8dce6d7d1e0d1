# SPDX-License-Identifier: Apache-2.0
"""A mechanism as data: links with mass and looks, and the joints between them; and as a structure."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field
from itertools import combinations
from typing import Any

import numpy as np

from iota import looks
from iota._core import Mesh, Shape, Sphere
from iota.builder.parts import BodyKind, Coordinate, JointKind, Place, RigidBody
from iota.shapelib.frames import Y_UP, Frame, LinkSolid, look_in, to_quaternion
from iota.shapelib.imported import Imported
from iota.shapelib.meshes import hull_of

ROTOR = "rotor of a motor"  # a look
# A spring that neither pulls nor pushes between the lengths a and b.
SLACK = "energy = 0.5*k*max(r - b, 0)^2 + 0.5*k*max(a - r, 0)^2; force = -c*v"


@dataclass
class Link:
    """frame: in the world, z up. solid: None for a link that is only a reference. drawn, touching: looks, and the shapes by
    which it touches, with their places in the link's frame. touches: False for one that is only seen. is_of: the link between
    two of whose joints this one is a ring. material: keywords of `iota.Material`. lift: share of its weight
    that is taken off."""

    name: str
    frame: Frame
    solid: LinkSolid | None
    drawn: list[tuple[looks.Look, Frame]] = field(default_factory=list)
    touching: list[tuple[Shape, Frame]] = field(default_factory=list)
    kind: BodyKind = "dynamic"
    touches: bool = True
    is_of: str = ""
    material: dict[str, float] | None = None
    lift: float = 0.0


def seen_shapes(link: Link) -> list[tuple[Shape, Frame]]:
    """The shapes that are drawn, to touch by."""
    return [(look.shape, place) for look, place in link.drawn if look.shape is not None]


def color_of(rgba: Iterable[float]) -> str:
    """Red, green, blue and opacity, from 0 to 1, as "#rrggbb" or "#rrggbbaa"."""
    parts = [round(255 * min(max(float(value), 0.0), 1.0)) for value in rgba]
    return "#" + "".join(f"{part:02x}" for part in (parts if parts[3] < 255 else parts[:3]))


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
    rotor: float = 0.0  # inertia that its coordinate has besides that of the links, kg m^2 or kg


@dataclass
class JointCoupling:
    """As a coupling of iota: a sum of ratio times coordinate of revolute and prismatic joints, rad and m, that is kept, or
    that stays at most `length`. terms: names of joints, ratios."""

    name: str
    terms: list[tuple[str, float]]
    length: float | None = None
    one_sided: bool = False


@dataclass
class JointActuator:
    """As an actuator of iota, of which `law` has the fields, for the coordinates of joints where they are when the file is read. terms: names
    of joints, ratios."""

    name: str
    terms: list[tuple[str, float]]
    law: dict[str, Any]


@dataclass
class LinkSpring:
    """A spring and damper between two places: N/m, N s/m, and the shortest and longest length at which it is at rest, m. ends: links and
    places in the world."""

    name: str
    ends: tuple[tuple[str, Any], tuple[str, Any]]
    stiffness: float
    damping: float
    rest: tuple[float, float]


@dataclass
class Mechanism:
    """The content of a file. ropes: pairs of a link and a place in the world, over which it runs, and a length in m. passing: names of links that do not
    touch each other. places: names of links that are parts of others, those others, and where they are in the world."""

    title: str
    links: list[Link] = field(default_factory=list)
    joints: list[LinkJoint] = field(default_factory=list)
    couplings: list[JointCoupling] = field(default_factory=list)
    ropes: list[tuple[str, list[tuple[str, Any]], float]] = field(default_factory=list)
    actuators: list[JointActuator] = field(default_factory=list)
    springs: list[LinkSpring] = field(default_factory=list)
    passing: list[tuple[str, str]] = field(default_factory=list)
    places: list[tuple[str, str, Frame]] = field(default_factory=list)
    counts: dict[str, int | float | str] = field(default_factory=dict)
    notes: list[str] = field(default_factory=list)


def to_structure(mechanism: Mechanism, at: Any, scale: float) -> Imported:
    """y up, enlarged by `scale` (masses are kept), with the origin at `at`."""
    structure = Imported(title=mechanism.title, counts=mechanism.counts, notes=mechanism.notes)
    origin = np.asarray(at, float)
    number: dict[str, int] = {}

    def put(place: Any) -> tuple[float, ...]:
        return tuple((origin + scale * (Y_UP @ place)).tolist())

    used = {link.name for link in mechanism.links} | {name for name, _, _ in mechanism.places}

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
        number[link.name] = len(structure.bodies)
        shapes = [(_scaled(shape, scale), link.frame @ place) for shape, place in _usable(link, structure.notes)]
        ellipsoid = (_scaled(solid.shape, scale), link.frame @ solid.frame)
        (shape, frame), *others = shapes or [ellipsoid]
        # The body's frame is at its center, and turned as its first shape.
        own = Frame(solid.frame.place, link.frame.inverse().turn @ frame.turn)
        drawn = [_scaled_look(look_in(own, look, place), scale) for look, place in link.drawn]
        structure.looks[link.name] = _dress(link, drawn, len(shapes))
        turn = Y_UP @ link.frame.turn @ solid.frame.turn
        inertia = scale**2 * turn @ solid.inertia @ turn.T
        structure.bodies.append(
            RigidBody(
                [],
                name=link.name,
                kind=link.kind,
                shape=shape,
                mass=solid.mass,
                position=put(frame.place),
                orientation=to_quaternion(Y_UP @ frame.turn),
                look=link.name,
                touches=link.touches and bool(shapes or not link.touching),
                others=[(other, put(at.place), to_quaternion(Y_UP @ at.turn)) for other, at in others],
                center=put(ellipsoid[1].place),
                inertia=((inertia + inertia.T) / 2).tolist(),
                material=link.material,
                lift=link.lift,
            )
        )

    for link in mechanism.links:
        add(link)
    for name, of, frame in mechanism.places:
        turn = to_quaternion(Y_UP @ frame.turn)
        structure.places.append(Place(name, number[of], put(frame.place), turn))
    passing = {(min(pair), max(pair)) for pair in (*mechanism.passing, *_neighbors(mechanism))}
    for one, other in sorted(passing):
        if one in number and other in number:
            structure.passing.append((number[one], number[other]))
    for joint in mechanism.joints:
        options = dict(joint.options, at=put(joint.at))
        if joint.axis is not None:
            options["axis"] = tuple((Y_UP @ joint.axis).tolist())
        options |= _scaled_options(joint, scale)
        b = None if joint.b is None else number.get(joint.b)
        structure.joint(joint.kind, number[joint.a], b, name=unused(joint.name, "joint"), **options)
    joint_numbers = {joint.name: n for n, joint in enumerate(mechanism.joints)}
    add_rotors(structure, mechanism.joints, scale, unused)

    def in_structure(term: tuple[str, float]) -> tuple[int, Coordinate, float]:
        """With a ratio that gives the unit of the file."""
        n = joint_numbers[term[0]]
        which = coordinate_of(mechanism.joints[n])
        return n, which, term[1] / scale if which == "slide" else term[1]

    for coupling in mechanism.couplings:
        terms = [in_structure(term) for term in coupling.terms]
        structure.couple(
            *terms, length=coupling.length, one_sided=coupling.one_sided, name=unused(coupling.name, "coupling")
        )

    for actuator in mechanism.actuators:
        terms = [in_structure(term) for term in actuator.terms]
        structure.actuator(*terms, name=unused(actuator.name, "actuator"), **scaled_law(actuator.law, scale))

    def held(end: tuple[str, Any]) -> int:
        """A point at the end of a rope or spring."""
        link_name, place = end
        point = structure.point(put(place), mass=0.0 if link_name in number else 1.0)
        if link_name in number:
            structure.bodies[number[link_name]].points.append(point)
        else:
            structure.nail(point)
        return point

    for name, places, length in mechanism.ropes:
        first, *over, last = map(held, places)
        structure.tie("rope", first, last, length=scale * length, name=unused(name, "rope"), over=over)
    for spring in mechanism.springs:
        values: dict[str, Any]
        shortest, longest = (scale * length for length in spring.rest)
        if shortest == longest:
            law, values = "spring", {"stiffness": spring.stiffness, "damping": spring.damping, "length": longest}
        else:
            law, values = SLACK, {"k": spring.stiffness, "c": spring.damping, "a": shortest, "b": longest}
        ends = held(spring.ends[0]), held(spring.ends[1])
        structure.bond(*ends, law, name=unused(spring.name, "spring"), **values)
    return structure


def coordinate_of(joint: LinkJoint) -> Coordinate:
    return "slide" if joint.kind == "prismatic" else "angle"


def scaled_law(law: dict[str, Any], scale: float) -> dict[str, Any]:
    """Returns the fields of an actuator of an enlarged mechanism. Its length and its control have the units of the file, so its force is a torque or
    an energy for each of these."""
    by = scale**2
    scaled: dict[str, Any] = {
        name: by * law[name] for name in ("gain", "constant", "stiffness", "damping") if name in law
    }
    if "force_range" in law:
        scaled["force_range"] = tuple(by * end for end in law["force_range"])
    return law | scaled


def add_rotors(structure: Imported, joints: list[LinkJoint], scale: float, unused: Callable[[str, str], str]) -> None:
    """Adds a wheel for the inertia of each motor's rotor, at the world and geared to the joint: the coordinate has that inertia, and the links
    have no other weight or gyroscopic moment, as in MuJoCo. Its size is such that its mass is a thousandth of the heaviest body's."""
    heaviest = max((body.mass or 0.0 for body in structure.bodies), default=0.0)
    for number, joint in enumerate(joints):
        if joint.rotor <= 0:
            continue
        # A slide turns its wheel by 1 rad for each m of the file.
        inertia = scale**2 * joint.rotor
        mass = 1e-3 * heaviest
        at = structure.joints[number].options["at"]
        wheel = structure.body(
            shape=Sphere(1e-3), mass=mass, position=at, center=at, inertia=(inertia * np.eye(3)).tolist(), touches=False,
            name=unused(f"{joint.name} rotor", "body"), look=ROTOR,
        )  # fmt: skip
        structure.looks[ROTOR] = looks.sphere(1e-3)
        axle = structure.joint(
            "revolute", wheel, at=at, axis=(0.0, 1.0, 0.0), name=unused(f"{joint.name} axle", "joint")
        )
        which = coordinate_of(joint)
        terms = (number, which, 1 / scale if which == "slide" else 1.0), (axle, "angle", -1.0)
        structure.couple(*terms, name=unused(f"{joint.name} gear", "coupling"))  # type: ignore[arg-type]


def _scaled_options(joint: LinkJoint, scale: float) -> dict[str, Any]:
    """Limits, spring and friction of an enlarged joint. Masses and times are kept, so forces grow as lengths, torques as their squares,
    and the stiffness and damping of a slide not at all."""
    is_slide = joint.kind == "prismatic"
    of_coordinate = scale if is_slide else 1.0
    of_effort = scale if is_slide else scale**2
    scaled: dict[str, Any] = {}
    for name, value in joint.options.items():
        if name == "limits":
            scaled[name] = tuple(of_coordinate * limit for limit in value)
        elif name == "spring":
            stiffness, damping, rest = value
            of_rate = of_effort / of_coordinate
            scaled[name] = (of_rate * stiffness, of_rate * damping, of_coordinate * rest)
        elif name == "friction":
            scaled[name] = of_effort * value
        else:
            raise ValueError(f"the option {name} of a joint has no known dimension")
    return scaled


def _dress(link: Link, drawn: list[looks.Look], touching: int) -> looks.Look | list[looks.Look]:
    """Its touching shapes where they are those that are drawn, with what is only drawn beside them; else what is drawn."""
    if not drawn:
        return looks.solid("steel")
    seen = {(id(look.shape), id(place)): number for number, (look, place) in enumerate(link.drawn)}
    same = [seen.get((id(shape), id(place))) for shape, place in link.touching]
    if touching != len(same) or None in same:
        return [looks.solid("paint", "#00000000"), *drawn] if touching > 1 else drawn
    solids = [looks.solid(link.drawn[n][0].material, link.drawn[n][0].color) for n in same if n is not None]
    return [*solids, *(look for n, look in enumerate(drawn) if n not in same)]


def _neighbors(mechanism: Mechanism) -> Iterator[tuple[str, str]]:
    """Links that overlap where a joint holds one at the other, as in MuJoCo: what is welded is one link here, and what is welded to
    neighbors is a neighbor. The engine itself leaves out the two of a joint only."""
    whole = {link.name: link.is_of or link.name for link in mechanism.links}

    def root(name: str) -> str:
        while whole[name] != name:
            name = whole[name]
        return name

    for joint in mechanism.joints:
        if joint.kind == "weld" and joint.b is not None:
            whole[root(joint.a)] = root(joint.b)
    members: dict[str, list[str]] = {}
    for link in mechanism.links:
        members.setdefault(root(link.name), []).append(link.name)
    for joint in mechanism.joints:
        if joint.b is not None:
            near = {*members[root(joint.a)], *members[root(joint.b)]}
            yield from combinations(near, 2)


def _usable(link: Link, notes: list[str]) -> list[tuple[Shape, Frame]]:
    """The shapes that its body can have: one that moves has a volume."""
    usable = []
    for shape, place in link.touching:
        try:
            if link.kind != "static":
                shape.mass_properties  # noqa: B018
            usable.append((shape, place))
        except ValueError as error:
            try:
                usable.append((hull_of(shape) if isinstance(shape, Mesh) else shape, place))
                notes.append(f"the link {link.name} touches by the convex hull of an open mesh")
            except ValueError:
                notes.append(f"the link {link.name} does not touch by one of its shapes: {error}")
    return usable


def _scaled_look(look: looks.Look, scale: float) -> looks.Look:
    """Scaled, with the shape's own sizes."""
    from dataclasses import replace

    shape = None if look.shape is None else _scaled(look.shape, scale)
    return replace(look, shape=shape, offset=tuple(scale * v for v in look.offset))


def _scaled(shape: Shape, scale: float) -> Shape:
    from iota import shapes

    if scale == 1:
        return shape
    sizes = shapes.to_json(shape)
    if "vertices" in sizes:
        sizes["vertices"] = (scale * np.array(sizes["vertices"])).tolist()
    else:
        for name in shape.sizes:
            sizes[name] = [scale * v for v in sizes[name]] if isinstance(sizes[name], list) else scale * sizes[name]
    sizes.pop("kind")
    larger: Shape = type(shape)(**sizes)
    return larger
