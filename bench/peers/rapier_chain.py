# SPDX-License-Identifier: Apache-2.0
"""The chain in Rapier (rapier3d): impulse joints, one thread, single precision as its package is built."""

from __future__ import annotations

import numpy as np
import rapier3d as rapier
from chain import AXIAL, GRAVITY, LENGTH, MASS, TRANSVERSE, State


class RapierChain:
    """`substeps` steps of h / substeps a frame; each has Rapier's own four small solver sub-steps inside."""

    def __init__(self, links: int, hz: int, substeps: int) -> None:
        self.substeps = substeps
        self.world = rapier.PhysicsWorld(gravity=(0, -GRAVITY, 0))
        self.world.set_num_threads(1)
        self.world.integration_parameters.dt = 1 / (hz * substeps)
        rod = rapier.MassProperties((0, 0, 0), MASS, (AXIAL, TRANSVERSE, TRANSVERSE))
        above = self.world.add_body(rapier.RigidBodyBuilder(rapier.RigidBodyType.FIXED))
        hook = (0.0, 0.0, 0.0)
        self.links: list[rapier.RigidBodyHandle] = []
        for i in range(links):
            body = rapier.RigidBodyBuilder(rapier.RigidBodyType.DYNAMIC).translation(((i + 0.5) * LENGTH, 0, 0))
            body = body.additional_mass_properties(rod).can_sleep(False).gyroscopic_forces(True)
            link = self.world.add_body(body)
            joint = rapier.SphericalJointBuilder().local_anchor1(hook).local_anchor2((-LENGTH / 2, 0, 0)).build()
            self.world.impulse_joints.insert(above, link, joint)
            self.links.append(link)
            above, hook = link, (LENGTH / 2, 0, 0)

    def advance(self, steps: int) -> None:
        for _ in range(steps * self.substeps):
            self.world.step()

    def read(self) -> State:
        count = len(self.links)
        state = State(*(np.empty((count, 3)) for _ in range(4)))
        unit = rapier.Vec3(1, 0, 0)
        bodies = self.world.rigid_bodies
        for i, link in enumerate(self.links):
            body = bodies[link]
            for into, vector in (
                (state.centre, body.translation), (state.axis, body.rotation * unit),
                (state.velocity, body.linvel), (state.spin, body.angvel),
            ):  # fmt: skip
                into[i] = vector.x, vector.y, vector.z
        return state

    def trouble(self) -> str:
        return ""
