# SPDX-License-Identifier: Apache-2.0
"""The parts of a structure besides its points. Points and bodies are referred to by their numbers."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any, Literal, get_args

from iota._core import Shape
from iota.builder.points import Vector

Law = str | Callable[..., Any]
BodyKind = Literal["dynamic", "static", "scripted", "inactive", "resting"]
JointKind = Literal["ball", "weld", "revolute", "prismatic", "cylindrical", "universal", "planar", "orientation"]
TieKind = Literal["rod", "rope"]
Coordinate = Literal["angle", "slide", "second_angle"]

JOINT_KINDS: tuple[str, ...] = get_args(JointKind)
TIE_KINDS: tuple[str, ...] = get_args(TieKind)
COORDINATES: tuple[str, ...] = get_args(Coordinate)


@dataclass
class RigidBody:
    """A rigid connection of points. With a shape, it has the shape's mass and inertia, and its points, of mass 0, are
    attachments. rod: mass (kg) and radius (m) of a solid cylinder between its two points.

    others: further shapes of it, each with the place of its origin (m) and its orientation (x y z w). All have one density: that given,
    or that of the mass. inertia: about `center`, world axes, kg m^2, with `mass` and `center`: of a body that is not homogeneous."""

    points: list[int]
    name: str = ""
    kind: BodyKind = "dynamic"
    damping: float = 0.0  # 1/s
    rod: tuple[float, float] | None = None
    shape: Shape | None = None
    density: float | None = None  # kg/m^3; None: 1000, unless mass is given
    mass: float | None = None  # kg, instead of a density
    position: Vector = (0.0, 0.0, 0.0)  # of the shape's origin, m
    orientation: tuple[float, ...] = (0.0, 0.0, 0.0, 1.0)  # of the shape, x y z w
    velocity: Vector = (0.0, 0.0, 0.0)  # m/s, of a body with a shape
    spin: Vector = (0.0, 0.0, 0.0)  # rad/s, of a body with a shape
    look: str = ""  # name of one of the structure's looks
    touches: bool = True  # False: it passes through everything
    others: Sequence[tuple[Shape, Vector, tuple[float, ...]]] = ()
    center: Vector | None = None  # of mass, m
    inertia: Sequence[Sequence[float]] | None = None


@dataclass
class Place:
    """A named place on a body with a shape, which moves with it: of a tool, a camera, a link without mass. position: m;
    orientation: x y z w; both when it is realized, in the world."""

    name: str
    body: int
    position: Vector
    orientation: tuple[float, ...] = (0.0, 0.0, 0.0, 1.0)


@dataclass
class SoftBond:
    """A force between two points, see `System.bond`."""

    p: int
    q: int
    law: Law
    parameters: dict[str, float | None] = field(default_factory=dict)
    implicit: bool | None = None
    break_force: float = float("inf")  # N
    name: str = ""


@dataclass
class Joint:
    """A joint between two bodies, see the method of `System` of that name. b: None for the world."""

    kind: JointKind
    a: int
    b: int | None = None
    options: dict[str, Any] = field(default_factory=dict)  # at, axis, limits, motor ...
    name: str = ""


@dataclass
class Coupling:
    """A sum of ratio times coordinate that is kept, see `System.couple`. terms: the number of a joint, the name of its
    coordinate, and the ratio, of each."""

    terms: list[tuple[int, Coordinate, float]]
    length: float | None = None  # None: the sum when it is realized
    one_sided: bool = False
    name: str = ""


@dataclass
class Tie:
    """A rod or rope between two points of different bodies."""

    kind: TieKind
    p: int
    q: int
    length: float | None = None  # m, None: their distance
    break_force: float = float("inf")  # N
    name: str = ""
