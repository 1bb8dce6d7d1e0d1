# SPDX-License-Identifier: Apache-2.0
"""Mechanisms from URDF and MJCF files."""

from __future__ import annotations

from pathlib import Path
from typing import Literal

from iota.builder.points import Vector
from iota.shapelib.apart import apart
from iota.shapelib.files import FileError, PathLike
from iota.shapelib.imported import Imported
from iota.shapelib.mechanism_data import to_structure
from iota.shapelib.mjcf import read_mjcf
from iota.shapelib.trees import read_tree
from iota.shapelib.urdf import read_urdf

ENDINGS = (".urdf", ".mjcf", ".xml")


@apart()
def mechanism(
    path: PathLike,
    *,
    base: Literal["fixed", "free"] | None = None,
    scale: float = 1.0,
    at: Vector = (0.0, 0.0, 0.0),
) -> Imported:
    """A robot or machine from a URDF or MJCF file: a body for each link that can move, with the mass, inertia and
    shapes of the file, by which it touches, its friction, a joint of iota for each of its joints, with limits, damping and friction, and
    actuators, whose control a script sets (`iota.builder.ActuatorOnJoint`). Names are those
    of the file; a joint with the name of a link is "NAME joint". Files have z up, the structure has y up.

    Links without mass are parts of what they are fixed to, and their names are of places (`iota.builder.PlaceOnBody`).

    base: of URDF, whether root links are held by the world ("fixed", the default), those without mass as static bodies, or free; MJCF
    files specify it.
    scale: of lengths; masses and times are kept, so that forces grow as lengths, torques and inertia as their squares: springs, dampers
    and friction let it move as before, where gravity, that of the system, is as much larger. at: place of the file's origin, m. What is left out is
    listed in `notes`: gravity, actuators with a state, tendons over pulleys, nonlinear equalities, missing meshes, and every attribute that is not its default and has no counterpart. Joints that
    mimic others, equalities of joints and sums of joints (fixed tendons) become couplings. Raises `FileError` that names
    file and line, ImportError without MuJoCo for MJCF.

        arm = iota.shapelib.mechanism("arm.urdf").realize(system, world)
        arm["elbow"].angle.motor = (1.0, 20)
        arm["wrist servo"].control = 0.3  # an actuator of the file
    """
    if base not in (None, "fixed", "free"):
        raise ValueError(f"base must be 'fixed', 'free' or None, not {base!r}")
    if not 0 < scale < float("inf"):
        raise ValueError(f"scale must be above 0, not {scale}")
    if Path(path).suffix.lower() not in ENDINGS:
        raise FileError(path, f"mechanisms are in files that end in {', '.join(ENDINGS)}")
    root = read_tree(path)
    if root.tag not in ("robot", "mujoco"):
        raise root.wrong(f"has <{root.tag}> at its top, neither <robot> (URDF) nor <mujoco> (MJCF)")
    data = read_urdf(path, root, base) if root.tag == "robot" else read_mjcf(path)
    return to_structure(data, at, scale)
