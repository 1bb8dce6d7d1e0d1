# SPDX-License-Identifier: Apache-2.0
"""Bullet (pybullet): rigid bodies in maximal coordinates and point-to-point constraints."""

from __future__ import annotations

import numpy as np
import pybullet as bullet
from judge import State, quaternions_of, rotations_from
from scene import GRAVITY, WORLD, Scene


class BulletPeer:
    """`substeps` sub-steps a frame; otherwise pybullet's defaults."""

    def __init__(self, scene: Scene, hz: int, substeps: int) -> None:
        bullet.connect(bullet.DIRECT)
        bullet.setGravity(0, -GRAVITY, 0)
        # 0 and 1 mean the same to Bullet's own engine, but pybullet documents 0 as the default.
        bullet.setPhysicsEngineParameter(fixedTimeStep=1 / hz, numSubSteps=substeps if substeps > 1 else 0)
        shape = bullet.createCollisionShape(bullet.GEOM_SPHERE, radius=0.001)  # rigid bodies need one
        world = self.add(0, shape, [0, 0, 0], [0, 0, 0, 1])
        turns = quaternions_of(scene.rotation)
        self.bodies = [
            self.add(scene.mass[k], shape, scene.center[k], turns[k], scene.inertia[k]) for k in range(len(scene.mass))
        ]
        for (first, second), one, other in zip(scene.joints, *scene.anchors(), strict=True):
            parent = world if first == WORLD else self.bodies[first]
            bullet.createConstraint(
                parent, -1, self.bodies[second], -1, bullet.JOINT_POINT2POINT, [0, 0, 0], list(one), list(other)
            )

    @staticmethod
    def add(mass, shape, center, turn, inertia=None) -> int:  # type: ignore[no-untyped-def]
        body: int = bullet.createMultiBody(mass, shape, -1, list(center), list(turn), useMaximalCoordinates=1)
        bullet.setCollisionFilterGroupMask(body, -1, 0, 0)
        if inertia is not None:
            # Set the mass again: otherwise the inertia is that of a body without mass.
            bullet.changeDynamics(
                body, -1, mass=mass, localInertiaDiagonal=list(inertia),
                linearDamping=0, angularDamping=0, activationState=bullet.ACTIVATION_STATE_DISABLE_SLEEPING,
            )  # fmt: skip
        return body

    def advance(self, steps: int) -> None:
        for _ in range(steps):
            bullet.stepSimulation()

    def read(self) -> State:
        poses = [bullet.getBasePositionAndOrientation(body) for body in self.bodies]
        velocities = np.array([bullet.getBaseVelocity(body) for body in self.bodies])
        turns = rotations_from(np.array([pose[1] for pose in poses]))
        return State(np.array([pose[0] for pose in poses]), turns, velocities[:, 0], velocities[:, 1])

    def trouble(self) -> str:
        return ""
