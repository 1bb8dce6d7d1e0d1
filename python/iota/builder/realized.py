# SPDX-License-Identifier: Apache-2.0
"""Puts a structure into a system and a world."""

from __future__ import annotations

import gc
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from itertools import chain, groupby, islice
from typing import TYPE_CHECKING, Any

import numpy as np

from iota import _core
from iota.builder.actuators import ActuatorOnJoint, actuate
from iota.builder.checks import label, problems
from iota.builder.contents import Contents
from iota.builder.parts import Place, RigidBody
from iota.frames import Quaternion, into_frame, one_after_another, relative_turn, turned

if TYPE_CHECKING:
    from iota.builder.parts import Actuator, Coupling, Joint, SoftBond, Tie
    from iota.world import World

MOST_SHOWN = 5  # problems in one error


@dataclass(frozen=True, slots=True)
class PlaceOnBody:
    """A place that moves with a body, as long as that is not combined with another one.

    lamp = arm["tool0"].attachment()
    """

    body: _core.Body
    _offset: _core.Vec3  # in axes of the body
    _turn: Quaternion

    @property
    def position(self) -> _core.Vec3:
        """World, m."""
        return self.body.position + turned(self.body.orientation, self._offset)

    @property
    def orientation(self) -> tuple[float, float, float, float]:
        """Unit quaternion x y z w, in the world."""
        x, y, z, w = one_after_another(self.body.orientation, self._turn)
        return (x, y, z, w)

    @property
    def velocity(self) -> _core.Vec3:
        """World, m/s."""
        return self.body.velocity + self.body.angular_velocity.cross(self.position - self.body.position)

    def attachment(self) -> _core.Particle:
        """A new particle of the body there, for bonds, ropes and all else that takes particles."""
        return self.body.attachment(self.position)


def place_on(body: _core.Body, place: Place) -> PlaceOnBody:
    """The place, on a body in the pose in which it was made."""
    offset = into_frame(_core.Vec3(*place.position), body.position, body.orientation)
    return PlaceOnBody(body, offset, relative_turn(body.orientation, place.orientation))


@dataclass
class Realized:
    """The handles of a realized structure, in the structure's order; `realized["door"]` by name."""

    points: list[_core.Particle] = field(default_factory=list)
    bodies: list[_core.Body] = field(default_factory=list)
    bonds: list[_core.Bond] = field(default_factory=list)
    joints: list[_core.Constraint] = field(default_factory=list)
    ties: list[_core.Constraint] = field(default_factory=list)
    couplings: list[_core.Constraint] = field(default_factory=list)
    actuators: list[ActuatorOnJoint] = field(default_factory=list)
    groups: dict[str, _core.Group] = field(default_factory=dict)
    names: dict[str, Any] = field(default_factory=dict)

    def __getitem__(self, name: str) -> Any:
        """The point, body, place, bond, joint, tie, coupling or actuator of that name. Raises KeyError."""
        return self.names[name]


def realize(structure: Contents, system: _core.System, world: World | None = None) -> Realized:
    """See `Structure.realize`."""
    wrong = list(islice(problems(structure), MOST_SHOWN + 1))
    if wrong:
        more = ["..."] if len(wrong) > MOST_SHOWN else []
        raise ValueError("\n".join(["the structure cannot be realized:", *wrong[:MOST_SHOWN], *more]))
    made = Realized()
    with _without_collector(), system.edit():
        _make_bodies(structure, system, made)
        _make_connections(structure, system, world, made)
        known = {group.name: group for group in system.groups}
        for name, members in structure.groups.items():
            made.groups[name] = known[name] if name in known else system.group(name)  # an empty one is False
            made.groups[name].add(*(made.points[member] for member in members))
    made.names |= {place.name: place_on(made.bodies[place.body], place) for place in structure.places}
    made.names |= {name: made.points[point] for name, point in structure.point_names.items()}
    if world is not None:
        _draw(structure, world, made)
    return made


@contextmanager
def _without_collector() -> Iterator[None]:
    """Thousands of handles are made, and none becomes garbage: the garbage collector took a third of the time."""
    was_on = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if was_on:
            gc.enable()


def _make_bodies(structure: Contents, system: _core.System, made: Realized) -> None:
    points: list[_core.Particle | None] = [None] * len(structure.points)
    for is_plain, group in groupby(structure.bodies, _is_plain):
        parts = list(group)
        if is_plain:
            _make_plain(structure, system, parts, points, made)
        else:
            _make_others(structure, system, parts, points, made)
    alone = [number for number, point in enumerate(points) if point is None]
    if alone:
        _make_plain(structure, system, [RigidBody([number]) for number in alone], points, Realized())
    made.points = [point for point in points if point is not None]
    for number in np.flatnonzero(structure.points.radius).tolist():
        point = made.points[number]
        point.radius = structure.points.radius[number]
        point.color = structure.points.color[number]
    made.names |= {part.name: body for part, body in zip(structure.bodies, made.bodies, strict=True) if part.name}


def _is_plain(part: RigidBody) -> bool:
    return part.shape is None and part.kind == "dynamic" and part.damping == 0


def _make_plain(
    structure: Contents,
    system: _core.System,
    parts: list[RigidBody],
    points: list[_core.Particle | None],
    made: Realized,
) -> None:
    """Makes many at once: bodies of particles only."""
    numbers = list(chain.from_iterable(part.points for part in parts))
    rows, counts = structure.points, [len(part.points) for part in parts]
    bodies, particles = _core.make_bodies(
        system, counts, rows.position[numbers], rows.mass[numbers], rows.velocity[numbers]
    )
    for number, particle in zip(numbers, particles, strict=True):
        points[number] = particle
    for part, body in zip(parts, bodies, strict=True):
        if part.rod is not None:
            body.set_rod(*part.rod)
    made.bodies += bodies


def _make_others(
    structure: Contents,
    system: _core.System,
    parts: list[RigidBody],
    points: list[_core.Particle | None],
    made: Realized,
) -> None:
    rows = structure.points
    for part in parts:
        try:
            if part.shape is None:
                body = system.body(part.kind, part.damping)
                for number in part.points:
                    points[number] = body.particle(
                        rows.position[number], float(rows.mass[number]), rows.velocity[number]
                    )
                if part.rod is not None:
                    body.set_rod(*part.rod)
            else:
                body = _solid(part, system)
                for number in part.points:
                    points[number] = body.attachment(rows.position[number])
        except (ValueError, TypeError) as error:
            raise ValueError(f"{label('body', len(made.bodies), part.name)}: {error}") from None
        made.bodies.append(body)


def _solid(part: RigidBody, system: _core.System) -> _core.Body:
    assert part.shape is not None
    density, mass = part.density, part.mass
    if part.others and mass is not None:
        shapes = [part.shape, *(shape for shape, _, _ in part.others)]
        # With an inertia of its own the masses of single shapes count for nothing, and they need no volume.
        density = mass / sum(s.mass_properties.volume for s in shapes) if part.inertia is None else None
        mass = None if part.inertia is None else mass / len(shapes)
    body = system.body(
        part.kind,
        part.damping,
        shape=part.shape,
        density=density,
        mass=mass,
        position=part.position,
        orientation=part.orientation,
        velocity=part.velocity,
        spin=part.spin,
    )
    for shape, place, orientation in part.others:
        other = system.body(
            part.kind, part.damping, shape=shape, density=density, mass=mass, position=place, orientation=orientation
        )
        body.combine(other)
    if not part.touches:
        body.material = _core.Material(**{**(part.material or {}), "touches": "nothing"})
    elif part.material is not None:
        body.material = _core.Material(**part.material)
    if part.inertia is not None:
        assert part.mass is not None and part.center is not None  # as `problems` says
        body.set_mass_properties(part.mass, part.center, part.inertia)
    if part.others and part.kind not in ("static", "scripted"):
        body.velocity, body.angular_velocity = part.velocity, part.spin
    return body


def _make_connections(structure: Contents, system: _core.System, world: World | None, made: Realized) -> None:
    points = made.points
    for p, q in structure.lines:
        system.cosmetic_bond(points[p], points[q])
    for p, q in structure.hinges:
        points[p].combine(points[q])
    for one, other in structure.passing:
        system.ignore_contacts(made.bodies[one], made.bodies[other])
    for point in structure.nails:
        points[point].nail()
    _lift(structure, system, made)
    what = ""
    try:
        for number, joint in enumerate(structure.joints):
            what = label(joint.kind, number, joint.name)
            b = None if joint.b is None else made.bodies[joint.b]
            made.joints.append(getattr(system, joint.kind)(made.bodies[joint.a], b, **joint.options))
        for number, tie in enumerate(structure.ties):
            what = label(tie.kind, number, tie.name)
            if tie.over:
                line = [points[number] for number in (tie.p, *tie.over, tie.q)]
                made.ties.append(system.rope(line, tie.length, break_force=tie.break_force))
                continue
            make = getattr(system, tie.kind)
            made.ties.append(make(points[tie.p], points[tie.q], tie.length, break_force=tie.break_force))
        for number, coupling in enumerate(structure.couplings):
            what = label("coupling", number, coupling.name)
            terms = [(getattr(made.joints[joint], coordinate), ratio) for joint, coordinate, ratio in coupling.terms]
            made.couplings.append(system.couple(terms, length=coupling.length, one_sided=coupling.one_sided))
        what = "the actuators"
        made.actuators = actuate(structure.actuators, made.joints, world)
        for number, bond in enumerate(structure.bonds):
            what = label("bond", number, bond.name)
            made.bonds.append(
                system.bond(
                    points[bond.p],
                    points[bond.q],
                    bond.law,
                    implicit=bond.implicit,
                    break_force=bond.break_force,
                    **bond.parameters,
                )
            )
    except AttributeError as error:  # a coordinate that a joint does not have
        raise ValueError(f"{what}: {error}") from None
    except (ValueError, TypeError) as error:
        # Not its own type: that of a text which is no UTF-8 takes other arguments.
        raise (TypeError if isinstance(error, TypeError) else ValueError)(f"{what}: {error}") from None
    _name(made, structure.joints, made.joints)
    _name(made, structure.ties, made.ties)
    _name(made, structure.couplings, made.couplings)
    _name(made, structure.actuators, made.actuators)
    _name(made, structure.bonds, made.bonds)


def _lift(structure: Contents, system: _core.System, made: Realized) -> None:
    """One field for all bodies that are lifted by the same share."""
    lifted: dict[float, list[_core.Body]] = {}
    for part, body in zip(structure.bodies, made.bodies, strict=True):
        if part.lift != 0:
            lifted.setdefault(part.lift, []).append(body)
    used = {group.name for group in system.groups}
    for share, bodies in lifted.items():
        name = f"lifted by {share:g}"
        while name in used:
            name += " too"
        used.add(name)
        group = system.group(name)
        group.add(*bodies)
        system.field("uniform", group=group, acceleration=-share * system.gravity, name=name)


def _name(
    made: Realized, parts: Sequence[Joint | Tie | Coupling | SoftBond | Actuator], handles: Sequence[Any]
) -> None:
    made.names |= {part.name: handle for part, handle in zip(parts, handles, strict=True) if part.name}


def _draw(structure: Contents, world: World, made: Realized) -> None:
    of_look: dict[str, list[_core.Body]] = {}
    for part, body in zip(structure.bodies, made.bodies, strict=True):
        if part.look:
            of_look.setdefault(part.look, []).append(body)
    for look, bodies in of_look.items():
        world.draw(bodies, structure.looks[look])
