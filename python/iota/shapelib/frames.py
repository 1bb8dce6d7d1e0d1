# SPDX-License-Identifier: Apache-2.0
"""Places and rotations of links, and solids with the mass and inertia from a file."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from iota import looks
from iota._core import Ellipsoid

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Array = NDArray[np.float64]

Quaternion = tuple[float, float, float, float]  # x y z w

# Files of robots have z up.
Y_UP = np.array([[1.0, 0, 0], [0, 0, 1.0], [0, -1.0, 0]])


@dataclass
class Frame:
    """A place (m) and a rotation (3, 3) from this frame to its parent frame."""

    place: Array = field(default_factory=lambda: np.zeros(3))
    turn: Array = field(default_factory=lambda: np.eye(3))

    def __matmul__(self, other: Frame) -> Frame:
        """A child frame, in the parent frame."""
        return Frame(self.place + self.turn @ other.place, self.turn @ other.turn)

    def inverse(self) -> Frame:
        """The inverse."""
        return Frame(-self.turn.T @ self.place, self.turn.T)


def from_rpy(roll: float, pitch: float, yaw: float) -> Array:
    """Turns about the fixed x, y and z axes, in this order; rad."""
    (cr, sr), (cp, sp), (cy, sy) = ((math.cos(angle), math.sin(angle)) for angle in (roll, pitch, yaw))
    return np.array(
        [
            [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
            [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
            [-sp, cp * sr, cp * cr],
        ]
    )


def about(axis: Array, angle: float) -> Array:
    """A turn by an angle (rad) about an axis of any length above 0."""
    x, y, z = math.sin(angle / 2) * axis / np.linalg.norm(axis)
    return from_quaternion(x, y, z, math.cos(angle / 2))


def from_quaternion(x: float, y: float, z: float, w: float) -> Array:
    """The matrix of a quaternion of any length above 0."""
    x, y, z, w = np.array([x, y, z, w]) / math.sqrt(x * x + y * y + z * z + w * w)
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )


def to_quaternion(turn: Array) -> Quaternion:
    """The unit quaternion x y z w of a rotation, from its largest component (Shepperd 1978)."""
    m = turn
    squares = np.array(
        [
            1 + m[0, 0] - m[1, 1] - m[2, 2],
            1 - m[0, 0] + m[1, 1] - m[2, 2],
            1 - m[0, 0] - m[1, 1] + m[2, 2],
            1 + m[0, 0] + m[1, 1] + m[2, 2],
        ]
    )
    rows = (
        (squares[0], m[0, 1] + m[1, 0], m[0, 2] + m[2, 0], m[2, 1] - m[1, 2]),
        (m[0, 1] + m[1, 0], squares[1], m[1, 2] + m[2, 1], m[0, 2] - m[2, 0]),
        (m[0, 2] + m[2, 0], m[1, 2] + m[2, 1], squares[2], m[1, 0] - m[0, 1]),
        (m[2, 1] - m[1, 2], m[0, 2] - m[2, 0], m[1, 0] - m[0, 1], squares[3]),
    )
    q = np.array(rows[int(np.argmax(squares))])
    x, y, z, w = (q / np.linalg.norm(q)).tolist()
    return x, y, z, w


@dataclass
class LinkSolid:
    """A link as a solid: mass (kg), its center and principal axes in the link's frame, an ellipsoid of that inertia."""

    mass: float
    frame: Frame
    shape: Ellipsoid
    is_changed: bool  # the given inertia is impossible for a rigid body, or too thin

    @property
    def inertia(self) -> Array:
        """(3, 3), kg m^2, about the center, along the axes of `frame`."""
        squares = np.square(self.shape.size) / 20
        moments: Array = self.mass * np.diag(squares.sum() - squares)
        return moments


def solid_of(mass: float, inertia: Array, at: Frame) -> LinkSolid:
    """mass: kg, above 0. inertia: (3, 3), kg m^2, about the center, along the axes of `at`. The mean squares of a body along
    its principal axes are (I_y + I_z - I_x) / 2m; an ellipsoid of half axes a has a^2 / 5."""
    values, axes = np.linalg.eigh((inertia + inertia.T) / 2)
    if np.linalg.det(axes) < 0:
        axes[:, 0] *= -1
    squares = (values.sum() / 2 - values) / mass
    largest = max(float(squares.max()), 1e-8)
    kept = np.maximum(squares, 1e-6 * largest)
    size = 2 * np.sqrt(5 * kept)
    return LinkSolid(
        mass, Frame(at.place, at.turn @ axes), Ellipsoid(size.tolist()), bool((squares < -1e-3 * largest).any())
    )


def share_of(solid: LinkSolid, share: float) -> LinkSolid:
    """A solid with that share of the mass and inertia, in the same place."""
    return LinkSolid(share * solid.mass, solid.frame, solid.shape, solid.is_changed)


def sum_of(solids: list[LinkSolid], frames: list[Frame]) -> LinkSolid:
    """Solids that are rigidly connected, as one; frames: of each solid's link, in one frame, which is that of the sum."""
    mass = math.fsum(solid.mass for solid in solids)
    own = [frame @ solid.frame for solid, frame in zip(solids, frames, strict=True)]
    center = sum((solid.mass / mass * at.place for solid, at in zip(solids, own, strict=True)), np.zeros(3))
    inertia = np.zeros((3, 3))
    for solid, at in zip(solids, own, strict=True):
        arm = at.place - center
        inertia += at.turn @ solid.inertia @ at.turn.T + solid.mass * (arm @ arm * np.eye(3) - np.outer(arm, arm))
    return solid_of(mass, inertia, Frame(center))


def look_in(frame: Frame, look: looks.Look, at: Frame) -> looks.Look:
    """A look in the link's frame, converted to the frame of the link's solid."""
    from dataclasses import replace

    own = frame.inverse() @ at
    return replace(look, offset=tuple(own.place.tolist()), rotation=to_quaternion(own.turn))
