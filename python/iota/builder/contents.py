# SPDX-License-Identifier: Apache-2.0
"""The contents of a structure: plain data, without a system."""

from __future__ import annotations

from dataclasses import dataclass, field

from iota.builder.parts import Actuator, Coupling, Joint, Place, RigidBody, SoftBond, Tie
from iota.builder.points import Points
from iota.looks import Drawn


@dataclass
class Contents:
    """Points and their connections. A point that is in no body is a body of its own."""

    points: Points = field(default_factory=Points)
    bodies: list[RigidBody] = field(default_factory=list)
    hinges: list[tuple[int, int]] = field(default_factory=list)  # pairs of points at one place
    bonds: list[SoftBond] = field(default_factory=list)
    joints: list[Joint] = field(default_factory=list)
    ties: list[Tie] = field(default_factory=list)
    couplings: list[Coupling] = field(default_factory=list)
    lines: list[tuple[int, int]] = field(default_factory=list)  # cosmetic bonds
    passing: list[tuple[int, int]] = field(default_factory=list)  # bodies that do not touch each other
    nails: list[int] = field(default_factory=list)  # points
    groups: dict[str, list[int]] = field(default_factory=dict)  # points, for fields and pair forces
    point_names: dict[str, int] = field(default_factory=dict)
    places: list[Place] = field(default_factory=list)
    actuators: list[Actuator] = field(default_factory=list)
    looks: dict[str, Drawn] = field(default_factory=dict)  # how bodies are drawn, as `World.draw` takes it
