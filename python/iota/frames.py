# SPDX-License-Identifier: Apache-2.0
"""Frames of bodies: a place and a unit quaternion x y z w."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from iota._core import Vec3

Quaternion = Sequence[float]


def into_frame(point: Vec3, center: Vec3, orientation: Quaternion) -> Vec3:
    """Transforms a world place to the body's drawn frame."""
    x, y, z, w = orientation
    axis, arm = Vec3(-x, -y, -z), point - center
    twice = axis.cross(arm) * 2.0
    return arm + twice * w + axis.cross(twice)


def turned(q: Quaternion, v: Vec3) -> Vec3:
    """Rotates a vector by q."""
    axis = Vec3(q[0], q[1], q[2])
    twice = axis.cross(v) * 2.0
    return v + twice * q[3] + axis.cross(twice)


def axes_of(q: Quaternion) -> NDArray[np.float64]:
    """The axes of a frame in the world, as columns of (3, 3)."""
    return np.column_stack([list(turned(q, Vec3(*axis))) for axis in np.eye(3)])


def turn_from_x(direction: Vec3) -> tuple[float, float, float, float]:
    """The smallest rotation from +x to a unit vector, as a quaternion x y z w."""
    if direction.x < -0.999999:
        return (0.0, 0.0, 1.0, 0.0)
    w = ((1 + direction.x) / 2) ** 0.5
    axis = Vec3(1, 0, 0).cross(direction) * (0.5 / w)
    return (axis.x, axis.y, axis.z, w)


def relative_turn(frame: Quaternion, turned: Quaternion) -> Quaternion:
    """The rotation from one frame to another, as a quaternion x y z w with w at least 0."""
    ax, ay, az, aw = -frame[0], -frame[1], -frame[2], frame[3]
    bx, by, bz, bw = turned
    w = aw * bw - ax * bx - ay * by - az * bz
    q = (
        aw * bx + ax * bw + ay * bz - az * by,
        aw * by - ax * bz + ay * bw + az * bx,
        aw * bz + ax * by - ay * bx + az * bw,
        w,
    )
    return q if w >= 0 else (-q[0], -q[1], -q[2], -w)


def one_after_another(outer: Quaternion, inner: Quaternion) -> Quaternion:
    """The rotation by `inner` and then by `outer`, as a quaternion x y z w."""
    x, y, z, w = outer
    return relative_turn((-x, -y, -z, w), inner)
