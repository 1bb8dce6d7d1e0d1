# SPDX-License-Identifier: Apache-2.0
"""MuJoCo in two models: trees of ball joints (its native one), and free bodies tied by `connect` equalities."""

from __future__ import annotations

import mujoco
import numpy as np
from judge import State, quaternions_of
from scene import GRAVITY, WORLD, Scene


def make_model(scene: Scene, hz: float, tied: bool) -> mujoco.MjModel:
    """Compiles the scene with defaults except for the time step; automatic resets are off."""
    spec = mujoco.MjSpec()
    spec.option.timestep = 1 / hz
    spec.option.gravity = [0, -GRAVITY, 0]
    spec.option.disableflags |= mujoco.mjtDisableBit.mjDSBL_AUTORESET
    turn = np.roll(quaternions_of(scene.rotation), 1, axis=1)  # MuJoCo's begin with w
    if tied:
        for k in range(len(scene.mass)):
            body = spec.worldbody.add_body(name=f"body{k}")
            body.mass, body.inertia, body.explicitinertial = scene.mass[k], scene.inertia[k], True
            body.pos, body.quat, body.ipos = scene.center[k], turn[k], [0, 0, 0]
            body.add_freejoint()
        anchors = scene.anchors()[1]
        for (first, second), anchor in zip(scene.joints, anchors, strict=True):
            tie = spec.add_equality(type=mujoco.mjtEq.mjEQ_CONNECT, objtype=mujoco.mjtObj.mjOBJ_BODY)
            tie.name1, tie.name2 = f"body{second}", "world" if first == WORLD else f"body{first}"
            tie.data[:3] = anchor
        return spec.compile()
    # Frames along the world's axes at the start, each with its origin at the body's joint.
    made = {WORLD: (spec.worldbody, np.zeros(3))}
    for (first, second), at in zip(scene.joints, scene.joint_at, strict=True):
        parent, origin = made[first]
        body = parent.add_body(name=f"body{second}")
        body.pos, body.mass, body.explicitinertial = at - origin, scene.mass[second], True
        body.ipos, body.iquat, body.inertia = scene.center[second] - at, turn[second], scene.inertia[second]
        body.add_joint(type=mujoco.mjtJoint.mjJNT_BALL)
        made[second] = body, at
    return spec.compile()


class MujocoPeer:
    """`substeps` steps of MuJoCo a frame."""

    def __init__(self, scene: Scene, hz: int, substeps: int, tied: bool) -> None:
        self.substeps = substeps
        self.model = make_model(scene, hz * substeps, tied)
        self.data = mujoco.MjData(self.model)
        self.order = [self.model.body(f"body{k}").id for k in range(len(scene.mass))]

    def advance(self, steps: int) -> None:
        mujoco.mj_step(self.model, self.data, nstep=steps * self.substeps)

    def read(self) -> State:
        model, data, order = self.model, self.data, self.order
        # After a step the derived quantities are those of its start: update them.
        mujoco.mj_kinematics(model, data)
        mujoco.mj_comPos(model, data)
        mujoco.mj_comVel(model, data)
        spin, center = data.cvel[order, :3], data.xipos[order]
        # cvel is taken at the center of mass of the whole tree that a body belongs to.
        velocity = data.cvel[order, 3:] + np.cross(spin, center - data.subtree_com[model.body_rootid[order]])
        return State(center, data.ximat[order].reshape(-1, 3, 3), velocity, spin)

    def trouble(self) -> str:
        bad = (mujoco.mjtWarning.mjWARN_BADQPOS, mujoco.mjtWarning.mjWARN_BADQVEL, mujoco.mjtWarning.mjWARN_BADQACC)
        return "its own warning" if any(self.data.warning[int(kind)].number for kind in bad) else ""
