# SPDX-License-Identifier: Apache-2.0
"""The common data structure of builders and importers."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from iota._core import System, Vec3
from iota.builder import exchange
from iota.builder.checks import problems
from iota.builder.contents import Contents
from iota.builder.parts import Actuator, Coordinate, Coupling, Joint, JointKind, Law, RigidBody, SoftBond, Tie, TieKind
from iota.builder.points import Vector
from iota.builder.realized import Realized, realize

if TYPE_CHECKING:
    from iota.world import World


class Shift(NamedTuple):
    """The offsets of the numbers of points and bodies of a structure that was merged into another one."""

    points: int
    bodies: int


class Structure(Contents):
    """Points, rigid and soft connections, joints, nails, groups and looks as plain data: made without a system, copied,
    moved, merged, saved, and realized in a system any number of times.

    The methods that add something have the same names as those of `System`, and return its number.

        ladder = iota.builder.Structure()
        a, b = ladder.point((0, 2, 0)), ladder.point((0.3, 2, 0))
        ladder.body(a, b, name="rung")
        ladder.nail(a)
        rung = ladder.realize(system)["rung"]
    """

    # --- adding ---------------------------------------------------------------------------------------------------

    def point(self, position: Vector, mass: float = 1.0, velocity: Vector = (0.0, 0.0, 0.0), name: str = "") -> int:
        """A point; position in m, mass in kg, velocity in m/s. `points.add` takes arrays of many."""
        number = self.points.add(tuple(Vec3(*position)), mass, tuple(Vec3(*velocity)))[0]
        if name:
            self.point_names[name] = number
        return number

    def body(self, *points: int, **options: Any) -> int:
        """A rigid connection of points; options: the fields of `RigidBody`, such as shape, density, position, name."""
        self.bodies.append(RigidBody(list(points), **options))
        return len(self.bodies) - 1

    def hinge(self, p: int, q: int) -> None:
        """Makes two points of different bodies, at one place, a hinge."""
        self.hinges.append((p, q))

    def bond(
        self,
        p: int,
        q: int,
        law: Law,
        *,
        implicit: bool | None = None,
        break_force: float = float("inf"),
        name: str = "",
        **parameters: float | None,
    ) -> int:
        """A force between two points, see `System.bond`."""
        self.bonds.append(SoftBond(p, q, law, parameters, implicit, break_force, name))
        return len(self.bonds) - 1

    def joint(self, kind: JointKind, a: int, b: int | None = None, *, name: str = "", **options: Any) -> int:
        """A joint of body a with body b, None for the world; options: see the method of `System` of that name.

        cart.joint("revolute", wheel, frame, at=(0, 0.1, 0), axis=(0, 0, 1))
        """
        self.joints.append(Joint(kind, a, b, options, name))
        return len(self.joints) - 1

    def tie(
        self,
        kind: TieKind,
        p: int,
        q: int,
        length: float | None = None,
        *,
        break_force: float = float("inf"),
        name: str = "",
        over: Iterable[int] = (),
    ) -> int:
        """A 'rod' or 'rope' between two points of different bodies; length in m, None for their distance. over: of a rope, points over
        which it runs on its way."""
        self.ties.append(Tie(kind, p, q, length, break_force, name, tuple(over)))
        return len(self.ties) - 1

    def couple(
        self,
        *terms: tuple[int, Coordinate, float],
        length: float | None = None,
        one_sided: bool = False,
        name: str = "",
    ) -> int:
        """Keeps a sum of ratio times coordinate of joints, see `System.couple`.

        cart.couple((left, "angle", 1), (right, "angle", 1), (carrier, "angle", -2))
        """
        self.couplings.append(Coupling(list(terms), length, one_sided, name))
        return len(self.couplings) - 1

    def actuator(self, *terms: tuple[int, Coordinate, float], **options: Any) -> int:
        """Drives a coordinate of a joint, or a sum of ratio times coordinate; options: the fields of `Actuator`.

        arm.actuator((elbow, "angle", 1), gain=20, stiffness=20, damping=1, control_range=(-2, 2), name="elbow servo")
        """
        self.actuators.append(Actuator(list(terms), **options))
        return len(self.actuators) - 1

    def cosmetic_bond(self, p: int, q: int) -> None:
        """A line drawn between two points of one body."""
        self.lines.append((p, q))

    def nail(self, *points: int) -> None:
        """Nails points at their places."""
        self.nails += points

    def group(self, name: str, points: Iterable[int]) -> None:
        """Adds points to the named set of particles."""
        self.groups.setdefault(name, []).extend(points)

    # --- the whole structure
    # -----------------------------------------------------------------------------------------------

    def problems(self) -> list[str]:
        """One sentence for each inconsistency, naming the item; none for a structure that can be realized."""
        return list(problems(self))

    def realize(self, system: System, world: World | None = None) -> Realized:
        """Puts it into a system, completely or not at all, and returns the handles. With a world, its bodies get their
        looks there. Points of an existing group are added to it. Raises ValueError that names the errors.

            chain = iota.builder.chain(links=24).realize(system)
        """
        return realize(self, system, world)

    def copy(self) -> Structure:
        """An independent copy; immutable shapes and looks are shared."""
        twin = Structure()
        twin.points.add_all(self.points)
        twin.bodies = [replace(body, points=list(body.points)) for body in self.bodies]
        twin.bonds = [replace(bond, parameters=dict(bond.parameters)) for bond in self.bonds]
        twin.joints = [replace(joint, options=dict(joint.options)) for joint in self.joints]
        twin.ties = [replace(tie) for tie in self.ties]
        twin.couplings = [replace(coupling, terms=list(coupling.terms)) for coupling in self.couplings]
        twin.actuators = [replace(each, terms=list(each.terms)) for each in self.actuators]
        twin.passing = list(self.passing)
        twin.places = [replace(place) for place in self.places]
        twin.hinges, twin.lines, twin.nails = list(self.hinges), list(self.lines), list(self.nails)
        twin.groups = {name: list(members) for name, members in self.groups.items()}
        twin.point_names, twin.looks = dict(self.point_names), dict(self.looks)
        return twin

    def __add__(self, offset: Vector) -> Structure:
        """A copy, moved by a vector (m)."""
        way = Vec3(*offset)
        moved = self.copy()
        moved.points.position[:] += np.asarray(way)
        for body in moved.bodies:
            body.position = Vec3(*body.position) + way
            body.others = [(shape, Vec3(*at) + way, turn) for shape, at, turn in body.others] if body.others else ()
            body.center = None if body.center is None else Vec3(*body.center) + way
        for place in moved.places:
            place.position = Vec3(*place.position) + way
        for joint in moved.joints:
            if "at" in joint.options:
                joint.options["at"] = Vec3(*joint.options["at"]) + way
        return moved

    def merge(self, other: Structure, prefix: str = "") -> Shift:
        """Adds another structure, with `prefix` before its names. Groups with equal names are merged; looks with equal
        names must be equal. Returns the offsets of its numbers of points and bodies.

            for x in range(3):
                row.merge(tower + (x, 0, 0), prefix=f"{x} ")
        """
        for name, look in other.looks.items():
            if self.looks.setdefault(name, look) != look:
                raise ValueError(f"the two structures have different looks {name!r}")
        other = other.copy()
        points, bodies, joints = self.points, len(self.bodies), len(self.joints)
        shift = Shift(len(points), bodies)

        def named(name: str) -> str:
            return prefix + name if name else ""

        def pairs(listed: list[tuple[int, int]]) -> list[tuple[int, int]]:
            return [(p + shift.points, q + shift.points) for p, q in listed]

        points.add_all(other.points)
        self.bodies += [
            replace(body, points=[p + shift.points for p in body.points], name=named(body.name))
            for body in other.bodies
        ]
        self.hinges += pairs(other.hinges)
        self.lines += pairs(other.lines)
        self.passing += [(a + bodies, b + bodies) for a, b in other.passing]
        self.places += [replace(each, body=each.body + bodies, name=named(each.name)) for each in other.places]
        self.nails += [point + shift.points for point in other.nails]
        for bond in other.bonds:
            self.bonds.append(replace(bond, p=bond.p + shift.points, q=bond.q + shift.points, name=named(bond.name)))
        for tie in other.ties:
            over = [point + shift.points for point in tie.over]
            moved = replace(tie, p=tie.p + shift.points, q=tie.q + shift.points, over=over, name=named(tie.name))
            self.ties.append(moved)
        for joint in other.joints:
            b = None if joint.b is None else joint.b + bodies
            self.joints.append(replace(joint, a=joint.a + bodies, b=b, name=named(joint.name)))
        for coupling in other.couplings:
            terms = [(joint + joints, coordinate, ratio) for joint, coordinate, ratio in coupling.terms]
            self.couplings.append(replace(coupling, terms=terms, name=named(coupling.name)))
        for actuator in other.actuators:
            terms = [(joint + joints, coordinate, ratio) for joint, coordinate, ratio in actuator.terms]
            self.actuators.append(replace(actuator, terms=terms, name=named(actuator.name)))
        for name, members in other.groups.items():
            self.group(name, [member + shift.points for member in members])
        self.point_names |= {prefix + name: point + shift.points for name, point in other.point_names.items()}
        return shift

    def to_json(self) -> dict[str, Any]:
        """Lists, numbers and texts for `json.dumps`. Raises ValueError for a bond whose law is a function."""
        return exchange.to_json(self)

    @classmethod
    def from_json(cls, data: dict[str, Any]) -> Structure:
        """Reads the result of `to_json`. Raises ValueError that names the errors."""
        return exchange.from_json(cls(), data)
