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
ActuatorLaw = Literal["force", "speed", "target"]

JOINT_KINDS: tuple[str, ...] = get_args(JointKind)
TIE_KINDS: tuple[str, ...] = get_args(TieKind)
COORDINATES: tuple[str, ...] = get_args(Coordinate)
ACTUATOR_LAWS: tuple[str, ...] = get_args(ActuatorLaw)


@dataclass
class RigidBody:
    """A rigid connection of points. With a shape, it has the shape's mass and inertia, and its points, of mass 0, are
    attachments. rod: mass (kg) and radius (m) of a solid cylinder between its two points.

    material: keywords of `iota.Material`, such as {"friction": 0.8}; None: the system's usual one. lift: share of its weight,
    by the gravity of the system when it is realized, that a field takes off.

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
    material: dict[str, Any] | None = None
    lift: float = 0.0


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
class Actuator:
    """Drives coordinates of joints by a control that a script sets. terms: the number of a joint, the name of its coordinate, and the
    ratio, of each; the sum of ratio times coordinate is its length, and each coordinate gets ratio times its force. Its force is

        gain * control + constant - stiffness * length - damping * speed (N m or N, of the length)

    or, with `speed`, whatever moves the length at the speed that is its control, up to the ends of `travel`. With `target`, whatever moves
    it to gain * control + constant, at most at `top_speed`. force_range must be finite for these two."""

    terms: list[tuple[int, Coordinate, float]]
    gain: float = 1.0
    constant: float = 0.0
    stiffness: float = 0.0
    damping: float = 0.0
    law: ActuatorLaw = "force"
    control: float = 0.0  # when it is realized
    control_range: tuple[float, float] | None = None
    force_range: tuple[float, float] | None = None
    travel: tuple[float, float] | None = None  # rad or m
    top_speed: float | None = None  # rad/s or m/s
    name: str = ""


@dataclass
class Tie:
    """A rod or rope between two points of different bodies. over: of a rope, the points over which it runs between them."""

    kind: TieKind
    p: int
    q: int
    length: float | None = None  # m, None: their distance
    break_force: float = float("inf")  # N
    name: str = ""
    over: Sequence[int] = ()
