# SPDX-License-Identifier: Apache-2.0
"""The chain in Bullet (pybullet): rigid bodies in maximal coordinates and point-to-point constraints."""

from __future__ import annotations

import numpy as np
import pybullet as bullet
from chain import AXIAL, GRAVITY, LENGTH, MASS, TRANSVERSE, State


class BulletChain:
    """`substeps` sub-steps a frame; everything else as pybullet sets it."""

    def __init__(self, links: int, hz: int, substeps: int) -> None:
        bullet.connect(bullet.DIRECT)
        bullet.setGravity(0, -GRAVITY, 0)
        # 0 and 1 mean the same to Bullet's own engine, but pybullet documents 0 as the default.
        bullet.setPhysicsEngineParameter(fixedTimeStep=1 / hz, numSubSteps=substeps if substeps > 1 else 0)
        shape = bullet.createCollisionShape(bullet.GEOM_SPHERE, radius=0.001)  # rigid bodies need one; it meets nothing
        self.links: list[int] = []
        above = bullet.createMultiBody(0, shape, -1, [0, 0, 0], useMaximalCoordinates=1)
        bullet.setCollisionFilterGroupMask(above, -1, 0, 0)
        hook = [0.0, 0.0, 0.0]
        for i in range(links):
            link = bullet.createMultiBody(MASS, shape, -1, [(i + 0.5) * LENGTH, 0, 0], useMaximalCoordinates=1)
            bullet.setCollisionFilterGroupMask(link, -1, 0, 0)
            # The mass again: without it the inertia is taken for that of a body of no mass.
            bullet.changeDynamics(
                link, -1, mass=MASS, localInertiaDiagonal=[AXIAL, TRANSVERSE, TRANSVERSE],
                linearDamping=0, angularDamping=0, activationState=bullet.ACTIVATION_STATE_DISABLE_SLEEPING,
            )  # fmt: skip
            bullet.createConstraint(above, -1, link, -1, bullet.JOINT_POINT2POINT, [0, 0, 0], hook, [-LENGTH / 2, 0, 0])
            self.links.append(link)
            above, hook = link, [LENGTH / 2, 0, 0]

    def advance(self, steps: int) -> None:
        for _ in range(steps):
            bullet.stepSimulation()

    def read(self) -> State:
        poses = [bullet.getBasePositionAndOrientation(link) for link in self.links]
        velocities = np.array([bullet.getBaseVelocity(link) for link in self.links])
        x, y, z, w = np.array([pose[1] for pose in poses]).T
        axis = np.stack([1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w)], axis=1)
        return State(np.array([pose[0] for pose in poses]), axis, velocities[:, 0], velocities[:, 1])

    def trouble(self) -> str:
        return ""
