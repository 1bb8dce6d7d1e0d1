# SPDX-License-Identifier: Apache-2.0
"""Scenes of contact_scene.py in iota, Rapier, MuJoCo and Bullet: one thread, no sleep, no damping."""

from __future__ import annotations

from typing import Protocol

import numpy as np
from contact_scene import Array, Scene
from judge import quaternions_of, rotations_from


class Engine(Protocol):
    def step(self) -> None: ...
    def poses(self) -> tuple[Array, Array]: ...


class Iota:
    def __init__(self, scene: Scene, hz: int, mode: str) -> None:
        import iota

        self.system = iota.System(gravity=scene.gravity, mode=mode, threads=1)  # type: ignore[arg-type]
        material = iota.Material(friction=scene.friction, restitution=scene.restitution)
        self.system.usual_material = material
        self.h = 1 / hz
        self.bodies, self.push = [], []
        pins = dict(scene.pivots)
        for k, thing in enumerate(scene.things):
            make = iota.Sphere if thing.is_ball else iota.Capsule if thing.is_capsule else iota.Box
            shape = make(thing.sides) if make is iota.Box else make(*thing.sides)  # type: ignore[arg-type]
            turn = quaternions_of(thing.turn[None])[0]
            if thing.mass == 0:
                self.system.obstacle(shape, position=thing.place, orientation=turn, material=material)
                continue
            body = self.system.body(shape=shape, mass=thing.mass, position=thing.place, orientation=turn)
            if k in pins:
                self.system.revolute(body, at=pins[k], axis=(0, 0, 1))
            if k in scene.push:
                self.push.append((body, scene.push[k]))
            body.velocity = thing.velocity
            self.bodies.append(body)
        for i, j, at in scene.joints:
            self.system.ball(*(self.bodies[scene.moving.index(k)] for k in (i, j)), at=at)

    def step(self) -> None:
        for body, force in self.push:
            body.apply_force(force)
        self.system.step(self.h)

    def poses(self) -> tuple[Array, Array]:
        places = np.array([tuple(body.position) for body in self.bodies])
        return places, rotations_from(np.array([tuple(body.orientation) for body in self.bodies]))


class Rapier:
    """stiffness: of contacts, Hz; Rapier's own: 30."""

    def __init__(self, scene: Scene, hz: int, substeps: int, stiffness: float) -> None:
        import rapier3d as rapier

        self.world, self.substeps = rapier.PhysicsWorld(gravity=scene.gravity), substeps
        self.world.set_num_threads(1)
        parameters = self.world.integration_parameters
        parameters.dt = 1 / (hz * substeps)
        if stiffness != 30:
            softness = rapier.SpringCoefficients(stiffness, 10)
            parameters.contact_softness = softness
        self.bodies = []
        for k, thing in enumerate(scene.things):
            kind = rapier.RigidBodyType.DYNAMIC if thing.mass > 0 else rapier.RigidBodyType.FIXED
            turn = quaternions_of(thing.turn[None])[0]
            turn = turn if turn[3] >= 0 else -turn
            sine = np.linalg.norm(turn[:3])
            vector = turn[:3] * (2 * np.arctan2(sine, turn[3]) / sine if sine > 0 else 2)
            made = (
                rapier.RigidBodyBuilder(kind).translation(tuple(thing.place)).rotation(tuple(vector)).can_sleep(False)
            )
            body = self.world.add_body(made.linvel(tuple(thing.velocity)))
            if thing.is_ball:
                shape = rapier.Collider.ball(*thing.sides)
            elif thing.is_capsule:
                end = thing.sides[1] / 2
                shape = rapier.Collider.capsule_x(end, thing.sides[0])
            else:
                shape = rapier.Collider.cuboid(*(side / 2 for side in thing.sides))
            shape = shape.friction(scene.friction).restitution(scene.restitution)
            self.world.add_collider(shape.mass(thing.mass) if thing.mass > 0 else shape, body)
            if thing.mass > 0:
                self.bodies.append(body)
            if k in scene.push:
                self.world.rigid_bodies[body].add_force(scene.push[k], True)
        fixed = self.world.add_body(rapier.RigidBodyBuilder(rapier.RigidBodyType.FIXED))
        for k, at in scene.pivots:
            arm = np.subtract(at, scene.things[k].place) @ scene.things[k].turn
            joint = rapier.SphericalJointBuilder().local_anchor1(tuple(at)).local_anchor2(tuple(arm)).build()
            self.world.impulse_joints.insert(fixed, self.bodies[scene.moving.index(k)], joint)
        for i, j, at in scene.joints:
            arms = [np.subtract(at, scene.things[k].place) @ scene.things[k].turn for k in (i, j)]
            joint = (
                rapier.SphericalJointBuilder()
                .local_anchor1(tuple(arms[0]))
                .local_anchor2(tuple(arms[1]))
                .contacts_enabled(False)
            )
            self.world.impulse_joints.insert(*(self.bodies[scene.moving.index(k)] for k in (i, j)), joint.build())

    def step(self) -> None:
        for _ in range(self.substeps):
            self.world.step()

    def poses(self) -> tuple[Array, Array]:
        places, turns = np.empty((len(self.bodies), 3)), np.empty((len(self.bodies), 4))
        for i, handle in enumerate(self.bodies):
            body = self.world.rigid_bodies[handle]
            places[i] = body.translation.x, body.translation.y, body.translation.z
            turns[i] = body.rotation.i, body.rotation.j, body.rotation.k, body.rotation.w
        return places, rotations_from(turns)


class Mujoco:
    """hard: contacts of two steps, elliptic cones, its discrete integrator. It has no restitution."""

    def __init__(self, scene: Scene, hz: int, hard: bool) -> None:
        import mujoco

        self.engine = mujoco
        self.along: list[Array] = []  # from the axes of a shape to those of its thing
        spec = mujoco.MjSpec()
        spec.option.timestep = 1 / hz
        spec.option.gravity = list(scene.gravity)
        if hard:
            spec.option.integrator = mujoco.mjtIntegrator.mjINT_DISCRETE
            spec.option.cone = mujoco.mjtCone.mjCONE_ELLIPTIC
        pins = dict(scene.pivots)
        parents = {j: (i, at) for i, j, at in scene.joints}
        bodies, origins = {}, {}
        for k, thing in enumerate(scene.things):
            parent, at = parents.get(k, (None, thing.place))
            origins[k] = origin = np.array(pins.get(k, at))
            # A figure begins upright: its bodies have the axes of the world, and their shapes are turned.
            frame = np.eye(3) if scene.joints else thing.turn
            holder, beside = (spec.worldbody, 0.0) if parent is None else (bodies[parent], origins[parent])
            turn = np.roll(quaternions_of(frame[None])[0], 1)
            bodies[k] = body = holder.add_body(name=f"body{k}", pos=list(origin - beside), quat=list(turn))
            size = [thing.sides[0], 0, 0] if thing.is_ball else [side / 2 for side in thing.sides]
            kind = mujoco.mjtGeom.mjGEOM_SPHERE if thing.is_ball else mujoco.mjtGeom.mjGEOM_BOX
            along = thing.turn if scene.joints else np.eye(3)
            if thing.is_capsule:  # along z
                kind, size = mujoco.mjtGeom.mjGEOM_CAPSULE, [thing.sides[0], thing.sides[1] / 2, 0]
                along = along @ np.array([[0, 0, 1.0], [1, 0, 0], [0, 1, 0]])
            shape = body.add_geom(
                type=kind, size=size, pos=list(frame.T @ np.subtract(thing.place, origin)),
                quat=list(np.roll(quaternions_of(along[None])[0], 1)),
            )  # fmt: skip
            self.along.append(along.T @ (thing.turn if scene.joints else np.eye(3)))
            shape.friction = [scene.friction, 0, 0]
            shape.condim = 3
            if hard:
                shape.solref, shape.solimp = [2 / hz, 1], [0.99, 0.9999, 0.001, 0.5, 2]
            if thing.mass > 0:
                shape.mass = thing.mass
                if k in pins:
                    body.add_joint(type=mujoco.mjtJoint.mjJNT_HINGE, axis=[0, 0, 1])
                elif parent is not None:
                    body.add_joint(type=mujoco.mjtJoint.mjJNT_BALL)
                else:
                    body.add_freejoint()
        self.model = spec.compile()
        self.data = mujoco.MjData(self.model)
        self.order = [self.model.body(f"body{k}").id for k in scene.moving]
        for k, force in scene.push.items():
            self.data.xfrc_applied[self.model.body(f"body{k}").id, :3] = force
        self.turns = np.array([self.along[k] for k in scene.moving])
        self.geoms = [int(self.model.body_geomadr[k]) for k in self.order]

    def step(self) -> None:
        self.engine.mj_step(self.model, self.data)

    def poses(self) -> tuple[Array, Array]:
        self.engine.mj_kinematics(self.model, self.data)
        turns = self.data.geom_xmat[self.geoms].reshape(-1, 3, 3)
        return self.data.geom_xpos[self.geoms].copy(), turns @ self.turns


class Bullet:
    def __init__(self, scene: Scene, hz: int, substeps: int) -> None:
        import pybullet as bullet

        self.engine, self.push = bullet, {}
        bullet.connect(bullet.DIRECT)
        bullet.setGravity(*scene.gravity)
        bullet.setPhysicsEngineParameter(fixedTimeStep=1 / hz, numSubSteps=substeps if substeps > 1 else 0)
        self.bodies = []
        pins = dict(scene.pivots)
        fixed = bullet.createMultiBody(
            0, bullet.createCollisionShape(bullet.GEOM_SPHERE, radius=1e-3), useMaximalCoordinates=1
        )
        bullet.setCollisionFilterGroupMask(fixed, -1, 0, 0)
        for k, thing in enumerate(scene.things):
            if thing.is_ball:
                shape = bullet.createCollisionShape(bullet.GEOM_SPHERE, radius=thing.sides[0])
            elif thing.is_capsule:  # along z, here turned along x
                radius, height = thing.sides
                along = [0, 0.5**0.5, 0, 0.5**0.5]
                shape = bullet.createCollisionShape(
                    bullet.GEOM_CAPSULE, radius=radius, height=height, collisionFrameOrientation=along
                )
            else:
                shape = bullet.createCollisionShape(bullet.GEOM_BOX, halfExtents=[side / 2 for side in thing.sides])
            turn = list(quaternions_of(thing.turn[None])[0])
            body = bullet.createMultiBody(thing.mass, shape, -1, list(thing.place), turn, useMaximalCoordinates=1)
            # Bullet multiplies both frictions and both restitutions.
            bullet.changeDynamics(
                body, -1, lateralFriction=scene.friction**0.5, restitution=scene.restitution**0.5,
                linearDamping=0, angularDamping=0, activationState=bullet.ACTIVATION_STATE_DISABLE_SLEEPING,
            )  # fmt: skip
            if thing.mass > 0:
                self.bodies.append(body)
                bullet.resetBaseVelocity(body, thing.velocity)
            if k in pins:
                arm = np.subtract(pins[k], thing.place) @ thing.turn
                bullet.createConstraint(
                    fixed, -1, body, -1, bullet.JOINT_POINT2POINT, [0, 0, 0], list(pins[k]), list(arm)
                )
            if k in scene.push:
                self.push[body] = scene.push[k]
        for i, j, at in scene.joints:
            a, b = (self.bodies[scene.moving.index(k)] for k in (i, j))
            arms = [list(np.subtract(at, scene.things[k].place) @ scene.things[k].turn) for k in (i, j)]
            bullet.createConstraint(a, -1, b, -1, bullet.JOINT_POINT2POINT, [0, 0, 0], *arms)
            bullet.setCollisionFilterPair(a, b, -1, -1, 0)

    def step(self) -> None:
        for body, force in self.push.items():
            place = self.engine.getBasePositionAndOrientation(body)[0]
            self.engine.applyExternalForce(body, -1, force, place, self.engine.WORLD_FRAME)
        self.engine.stepSimulation()

    def poses(self) -> tuple[Array, Array]:
        poses = [self.engine.getBasePositionAndOrientation(body) for body in self.bodies]
        return np.array([pose[0] for pose in poses]), rotations_from(np.array([pose[1] for pose in poses]))


ENGINES = {
    "iota": lambda scene, hz: Iota(scene, hz, "energy_keeping"),
    "iota robust": lambda scene, hz: Iota(scene, hz, "robust"),
    "Rapier": lambda scene, hz: Rapier(scene, hz, 1, 30),
    "Rapier stiff120+sub4": lambda scene, hz: Rapier(scene, hz, 4, 120),
    "MuJoCo": lambda scene, hz: Mujoco(scene, hz, False),
    "MuJoCo hard+discrete": lambda scene, hz: Mujoco(scene, hz, True),
    "Bullet": lambda scene, hz: Bullet(scene, hz, 1),
}
