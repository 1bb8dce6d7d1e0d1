# SPDX-License-Identifier: Apache-2.0
"""Joints, bonds and angle springs: which bodies they tie together, and copies of them between copies of the bodies."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Mapping
from itertools import count
from string import ascii_letters
from typing import Any

from iota._core import AngleSpring, Body, Bond, Constraint, JointCoordinate, Law, Particle, System

Tie = Constraint | Bond | AngleSpring

ANGLES, SLIDES = ("revolute", "planar", "cylindrical"), ("prismatic", "cylindrical")  # kinds of joints with an axis
WITH_PLACE, PLAIN, BETWEEN_PARTICLES = ("ball", "weld"), ("orientation",), ("rod", "rope", "span")
SCREW, UNIVERSAL, PATH = "screw", "universal", "path"
ON_SURFACE, SURFACES = {"surface": "on_surface", "inside": "inside", "outside": "outside"}, ("apart", "touching")
COUPLINGS = ("coupling", "tackle")  # of coordinates of other joints: gears, and ropes over pulleys, which are one-sided
LAWS = ("predefined", "expression")  # other ones are functions of the script
INPUTS = "mrtvxyz"  # of expressions
LONGEST_TEXT, LONG_NUMBER = 1000, -1.2345678901234567e-300  # bytes of an expression; s


class Ties:
    """The ties of a system, as they are now."""

    def __init__(self, system: System) -> None:
        self._of: dict[Body, list[Tie]] = {}
        ties: list[Tie] = [*system.constraints, *system.bonds, *system.angle_springs]
        for tie in ties:
            for body in set(bodies_of(tie)):
                self._of.setdefault(body, []).append(tie)

    def hold(self, bodies: Iterable[Body]) -> bool:
        """Whether one of them is an end of a tie."""
        return any(tie.alive for body in bodies for tie in self._of.get(body, []))

    def beyond(self, bodies: Iterable[Body]) -> tuple[bool, Tie | None]:
        """Whether ties hold bodies at the world, or at what never moves, and a tie to something else that is none of them."""
        own, is_held = set(bodies), False
        for tie in dict.fromkeys(tie for body in own for tie in self._of.get(body, []) if tie.alive):
            others = [body for body in bodies_of(tie) if body not in own]
            if any(not _is_fixed(body) for body in others):
                return is_held, tie
            is_held = (
                is_held or bool(others) or (isinstance(tie, Constraint) and tie.kind not in COUPLINGS and tie.b is None)
            )
        return is_held, None

    def around(self, bodies: Iterable[Body]) -> tuple[list[Body], list[Tie]]:
        """Bodies, with all that moves and is connected to them by ties and hinges, and these ties."""
        found, ties = dict.fromkeys(bodies), dict[Tie, None]()
        waiting = list(found)
        while waiting:
            for tie in self._of.get(waiting.pop(), []):
                if not tie.alive or tie in ties:
                    continue
                ties[tie] = None
                for body in bodies_of(tie):
                    for mate in body.articulate.bodies if body.kind != "static" else []:
                        if mate not in found:
                            found[mate] = None
                            waiting.append(mate)
        return list(found), list(ties)


def bodies_of(tie: Tie) -> list[Body]:
    """The bodies that it ties together, without the world."""
    if isinstance(tie, Constraint):
        return list(dict.fromkeys(p.body for p in tie.particles))
    return [end.body for end in tie.ends]


def _is_fixed(body: Body) -> bool:
    return body.kind == "static" or (body.kind != "scripted" and all(p.is_nailed for p in body.particles))


def can_be_copied(tie: Tie) -> bool:
    """Whether `copy_ties` knows its kind."""
    if isinstance(tie, Bond):
        return can_copy_law(tie.law)
    if isinstance(tie, AngleSpring):
        return True
    if tie.kind in COUPLINGS:
        return all(can_be_copied(coordinate.joint) for coordinate, _ in tie.terms)
    if tie.kind in BETWEEN_PARTICLES:
        return True
    known = (*ANGLES, *SLIDES, *WITH_PLACE, *PLAIN, SCREW, UNIVERSAL, PATH, *ON_SURFACE, *SURFACES)
    return tie.a.kind != "static" and tie.kind in known


def needed_particles(ties: Iterable[Tie]) -> set[Particle]:
    """The particles of which copies of ties need copies."""
    found: set[Particle] = set()
    for tie in ties:
        if isinstance(tie, Constraint):
            is_of_one = tie.kind == PATH or tie.kind in ON_SURFACE
            found.update(tie.particles if tie.kind in BETWEEN_PARTICLES else tie.particles[:1] if is_of_one else [])
        else:
            found.update(tie.ends)
    return found


def copy_ties(
    ties: Iterable[Tie],
    system: System,
    body_of: Mapping[Body, Body],
    particle_of: Mapping[Particle, Particle],
    begin: float,
) -> None:
    """Makes the same ones of a system between copies of their bodies, at the same places; static bodies are the world there, and nails
    hold their particles. They do not break. Couplings are made last, of the copies of their joints. begin: see `at_time`."""
    particle_of = _Ends(system, particle_of)
    joint_of: dict[Constraint, Constraint] = {}
    couplings: list[Constraint] = []
    for tie in ties:
        if isinstance(tie, AngleSpring):
            p, middle, q = (particle_of[end] for end in tie.ends)
            system.angle_spring(p, middle, q, tie.stiffness, tie.damping, tie.rest)
        elif isinstance(tie, Bond):
            if tie.active:
                p, q = (particle_of[end] for end in tie.ends)
                system.bond(p, q, copy_of_law(tie.law, begin), implicit=tie.implicit, **tie.parameters)
        elif tie.kind in COUPLINGS:
            couplings.append(tie)
        elif tie.active:
            joint_of[tie] = _copy_joint(tie, system, body_of, particle_of)
    for coupling in couplings:
        if coupling.active and all(coordinate.joint in joint_of for coordinate, _ in coupling.terms):
            joint_of[coupling] = _copy_coupling(coupling, system, joint_of)
    for tie, copy in joint_of.items():
        if any(tie.compliance):
            copy.compliance = tie.compliance


def can_copy_law(law: Law) -> bool:
    """Whether `copy_of_law` can copy it."""
    return law.kind == "predefined" or (law.kind == "expression" and can_be_shifted(law.text))


def copy_of_law(law: Law, begin: float) -> str:
    """The name or the text of the same law in another system: see `at_time`."""
    return law.name if law.kind == "predefined" else at_time(law.text, begin)


def at_time(text: str, begin: float) -> str:
    """An expression whose time is `begin`, s, when that of its system is 0. Its time is defined once, so that it stays short."""
    words = set(re.findall(r"\w+", text))
    if "t" not in words:
        return text
    free = [name for name in ascii_letters if name not in words and name not in INPUTS]
    name = free[0] if free else next(f"t{number}" for number in count() if f"t{number}" not in words)
    return f"{name} = {begin!r} + t; " + re.sub(r"\bt\b", name, text)


def can_be_shifted(text: str) -> bool:
    """Whether `at_time` gives a text that the engine takes."""
    return len(at_time(text, LONG_NUMBER).encode()) < LONGEST_TEXT


class _Ends(dict[Particle, Particle]):
    """Copies of particles. Those of static bodies are made when they are needed."""

    def __init__(self, system: System, known: Mapping[Particle, Particle]) -> None:
        super().__init__(known)
        self._system = system

    def __missing__(self, own: Particle) -> Particle:
        self[own] = made = self._system.body().particle(own.position, mass=1.0)
        made.nail()
        return made


def _copy_coupling(coupling: Constraint, system: System, joint_of: Mapping[Constraint, Constraint]) -> Constraint:
    """Coordinates of the copies may count from elsewhere."""
    terms, length = list[tuple[JointCoordinate, float]](), coupling.length
    for own, ratio in coupling.terms:
        copy: JointCoordinate = getattr(joint_of[own.joint], own.name)
        terms.append((copy, ratio))
        length += ratio * (copy.value - own.value)
    is_rope = coupling.kind == "tackle"
    return system.couple(terms, length=length if is_rope else None, one_sided=is_rope)


def _copy_joint(
    joint: Constraint, system: System, body_of: Mapping[Body, Body], particle_of: Mapping[Particle, Particle]
) -> Constraint:
    made: Constraint
    if joint.kind in BETWEEN_PARTICLES:
        p, q = (particle_of[end] for end in joint.particles)
        if joint.kind == "span":
            made = system.span(p, q)
            _copy_coordinate(joint.slide, made.slide)
        else:
            made = getattr(system, joint.kind)(p, q, joint.length)
        return made
    a, b = body_of[joint.a], None if joint.b is None or joint.b.kind == "static" else body_of[joint.b]
    if joint.kind == PATH:
        made = system.on_path(particle_of[joint.particles[0]], body=b, **joint.path)
        _copy_coordinate(joint.slide, made.slide)
        return made
    if joint.kind in ON_SURFACE:
        hold: Any = getattr(system, ON_SURFACE[joint.kind])
        made = hold(particle_of[joint.particles[0]], body=b, **joint.surfaces[0])
        return made
    if joint.kind in SURFACES:
        of_a, of_b = joint.surfaces
        return system.surface_to_surface(
            a, of_a["surface"], b, of_b["surface"], one_sided=joint.kind == "apart",
            at_a=of_a["at"], orientation_a=of_a["orientation"], at_b=of_b["at"], orientation_b=of_b["orientation"],
        )  # fmt: skip
    make: Any = getattr(system, joint.kind)
    if joint.kind in PLAIN:
        made = make(a, b)
    elif joint.kind in WITH_PLACE:
        made = make(a, b, at=joint.position)
    elif joint.kind == SCREW:
        made = make(a, b, at=joint.position, axis=joint.axis, lead=2 * math.pi * joint.length)
    elif joint.kind == UNIVERSAL:
        made = make(a, b, at=joint.position, axis=joint.axis, second_axis=joint.second_axis)
        _copy_coordinate(joint.second_angle, made.second_angle)
    else:
        made = make(a, b, at=joint.position, axis=joint.axis)
    if joint.kind in (*ANGLES, SCREW, UNIVERSAL):
        _copy_coordinate(joint.angle, made.angle)
    if joint.kind in (*SLIDES, SCREW):
        _copy_coordinate(joint.slide, made.slide)
    return made


def _copy_coordinate(own: JointCoordinate, copy: JointCoordinate) -> None:
    """A new joint counts from the pose in which it is made; spans and paths count from their ends."""
    here = copy.value
    now = own.value - here
    if own.limits is not None:
        low, high = own.limits
        copy.limits = (min(low - now, here), max(high - now, here))
    if own.motor is not None:
        copy.motor = own.motor
    if own.servo is not None:
        target, most, speed = own.servo
        copy.servo = (target - now, most, speed)
    if own.friction:
        copy.friction = own.friction
    if own.spring is not None:
        stiffness, damping, rest = own.spring
        copy.spring = (stiffness, damping, rest - now)
