# SPDX-License-Identifier: Apache-2.0
"""The chain in MuJoCo, both ways: a tree of ball joints (its own way), and free bodies tied by `connect` equalities."""

from __future__ import annotations

import mujoco
import numpy as np
from chain import AXIAL, GRAVITY, LENGTH, MASS, TRANSVERSE, State


def make_model(links: int, hz: float, tied: bool) -> mujoco.MjModel:
    """Compiles the chain at defaults but for the time step; nothing is ever reset behind our back."""
    spec = mujoco.MjSpec()
    spec.option.timestep = 1 / hz
    spec.option.gravity = [0, -GRAVITY, 0]
    spec.option.disableflags |= mujoco.mjtDisableBit.mjDSBL_AUTORESET
    parent = spec.worldbody
    for i in range(links):
        body = parent.add_body(name=f"link{i}")
        body.mass, body.inertia, body.explicitinertial = MASS, [AXIAL, TRANSVERSE, TRANSVERSE], True
        if tied:
            body.pos, body.ipos = [(i + 0.5) * LENGTH, 0, 0], [0, 0, 0]
            body.add_freejoint()
            tie = spec.add_equality(type=mujoco.mjtEq.mjEQ_CONNECT, objtype=mujoco.mjtObj.mjOBJ_BODY)
            tie.name1, tie.name2 = f"link{i}", f"link{i - 1}" if i else "world"
            tie.data[:3] = [-LENGTH / 2, 0, 0]
        else:
            body.pos, body.ipos = [LENGTH if i else 0, 0, 0], [LENGTH / 2, 0, 0]
            body.add_joint(type=mujoco.mjtJoint.mjJNT_BALL)
            parent = body
    return spec.compile()


class MujocoChain:
    """`substeps` steps of MuJoCo a frame."""

    def __init__(self, links: int, hz: int, substeps: int, tied: bool) -> None:
        self.substeps = substeps
        self.model = make_model(links, hz * substeps, tied)
        self.data = mujoco.MjData(self.model)

    def advance(self, steps: int) -> None:
        mujoco.mj_step(self.model, self.data, nstep=steps * self.substeps)

    def read(self) -> State:
        model, data = self.model, self.data
        # After a step the derived quantities are those of its start: bring them up to date.
        mujoco.mj_kinematics(model, data)
        mujoco.mj_comPos(model, data)
        mujoco.mj_comVel(model, data)
        spin = data.cvel[1:, :3].copy()
        centre = data.xipos[1:].copy()
        # cvel is taken at the centre of mass of the whole tree that a body belongs to.
        velocity = data.cvel[1:, 3:] + np.cross(spin, centre - data.subtree_com[model.body_rootid[1:]])
        return State(centre, data.xmat[1:].reshape(-1, 3, 3)[:, :, 0].copy(), velocity, spin)

    def trouble(self) -> str:
        bad = (mujoco.mjtWarning.mjWARN_BADQPOS, mujoco.mjtWarning.mjWARN_BADQVEL, mujoco.mjtWarning.mjWARN_BADQACC)
        return "its own warning" if any(self.data.warning[int(kind)].number for kind in bad) else ""
