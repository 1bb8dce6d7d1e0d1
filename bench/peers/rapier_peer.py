# SPDX-License-Identifier: Apache-2.0
"""Rapier (rapier3d): impulse joints, one thread, single precision, as in its package."""

from __future__ import annotations

import numpy as np
import rapier3d as rapier
from judge import State, quaternions_of, rotations_from
from scene import GRAVITY, WORLD, Scene


class RapierPeer:
    """`substeps` steps of h / substeps a frame; each has Rapier's own four small solver sub-steps inside."""

    def __init__(self, scene: Scene, hz: int, substeps: int) -> None:
        self.substeps = substeps
        self.world = rapier.PhysicsWorld(gravity=(0, -GRAVITY, 0))
        self.world.set_num_threads(1)
        self.world.integration_parameters.dt = 1 / (hz * substeps)
        self.bodies: list[rapier.RigidBodyHandle] = []
        for mass, inertia, center, turn in zip(
            scene.mass, scene.inertia, scene.center, quaternions_of(scene.rotation), strict=True
        ):
            turn = turn if turn[3] >= 0 else -turn
            sine = np.linalg.norm(turn[:3])
            vector = turn[:3] * (2 * np.arctan2(sine, turn[3]) / sine if sine > 0 else 2)
            body = rapier.RigidBodyBuilder(rapier.RigidBodyType.DYNAMIC).translation(tuple(center))
            body = body.rotation(tuple(vector)).can_sleep(False).gyroscopic_forces(True)
            body = body.additional_mass_properties(rapier.MassProperties((0, 0, 0), mass, tuple(inertia)))
            self.bodies.append(self.world.add_body(body))
        world = self.world.add_body(rapier.RigidBodyBuilder(rapier.RigidBodyType.FIXED))
        for (first, second), one, other in zip(scene.joints, *scene.anchors(), strict=True):
            joint = rapier.SphericalJointBuilder().local_anchor1(tuple(one)).local_anchor2(tuple(other)).build()
            self.world.impulse_joints.insert(
                world if first == WORLD else self.bodies[first], self.bodies[second], joint
            )

    def advance(self, steps: int) -> None:
        for _ in range(steps * self.substeps):
            self.world.step()

    def read(self) -> State:
        center, velocity, spin = (np.empty((len(self.bodies), 3)) for _ in range(3))
        turn = np.empty((len(self.bodies), 4))
        for i, handle in enumerate(self.bodies):
            body = self.world.rigid_bodies[handle]
            for into, vector in ((center, body.translation), (velocity, body.linvel), (spin, body.angvel)):
                into[i] = vector.x, vector.y, vector.z
            turn[i] = body.rotation.i, body.rotation.j, body.rotation.k, body.rotation.w
        return State(center, rotations_from(turn), velocity, spin)

    def trouble(self) -> str:
        return ""
