# SPDX-License-Identifier: Apache-2.0
"""Names that scripts look for in the wrong place, or know from other libraries, and what to use instead."""

from __future__ import annotations

from iota import arguments
from iota._core import (
    AngleSpring,
    Articulate,
    Body,
    Bond,
    Constraint,
    Emitter,
    Field,
    Grip,
    Group,
    Law,
    PairForce,
    Particle,
    System,
)

PLACES = {
    "particle": "body.particle(...), of a body such as system.body()",
    "particles": "body.particles or system.particles",
    "nail": "particle.nail()",
    "combine": "p.combine(q), of particles or bodies",
    "separate": "p.separate(q), of particles",
    "apply_force": "particle.apply_force(force) or body.apply_force(force)",
}
MOVING = {
    "pos": "position",
    "location": "position",
    "translation": "position",
    "vel": "velocity",
    "linear_velocity": "velocity",
    "add_force": "apply_force(force)",
    "force": "apply_force(force)",
    "impulse": "velocity: add the impulse divided by the mass",
    "apply_impulse": "velocity: add the impulse divided by the mass",
    "x": "position.x",
    "y": "position.y",
    "z": "position.z",
    "remove": "destroy()",
    "delete": "destroy()",
}
OF_BODY = MOVING | {
    "shape": "body.solids[0].shape",
    "size": "body.solids[0].shape.size",
    "density": "body.mass: a shape's mass is its density times its volume",
    "rotation": "orientation",
    "quaternion": "orientation",
    "rotate": "orientation: assign it, as in body.orientation = ('z', 30)",
    "omega": "angular_velocity",
    "spin": "angular_velocity",
    "add_torque": "apply_torque(torque)",
    "torque": "apply_torque(torque)",
    "friction": "body.material = iota.Material(friction=...)",
    "restitution": "body.material = iota.Material(restitution=...)",
    "static": "body.kind = 'static'",
    "fixed": "body.kind = 'static'",
    "is_static": "body.kind == 'static'",
    "visible": "world.draw(body, []), which hides it",
    "look": "world.draw(body, look)",
    "texture": "world.draw(body, looks.solid('paint', texture=...))",
    "on_click": "world.on_click(body)",
    "on_contact": "world.on_contact(body)",
    "label": "world.label(text, at=body)",
    "joints": "system.constraints",
    "add_particle": "body.particle(...)",
    "rope": "system.rope(p, q), of particles or attachments",
    "rod": "system.rod(p, q), of particles or attachments",
    "spring": "system.bond(p, q, 'spring', stiffness=...), of particles or attachments",
    "attach": "system.weld(a, b), or body.attachment(position)",
    "hinge": "system.revolute(a, b, at=..., axis=...)",
}
OF_PARTICLE = MOVING | {
    "fixed": "particle.nail()",
    "fix": "particle.nail()",
    "pin": "particle.nail()",
    "join": "p.combine(q)",
    "size": "radius",
    "bonds": "system.bonds",
    "attach": "p.combine(q)",
    "hinge": "p.combine(q), or system.revolute(a, b, at=..., axis=...) of bodies",
    "rope": "system.rope(p, q)",
    "rod": "system.rod(p, q)",
    "spring": "system.bond(p, q, 'spring', stiffness=...)",
}
SOLIDS = ("box", "cube", "sphere", "cylinder", "capsule", "cone", "mesh", "torus")
OF_SYSTEM = {
    **{name: f"system.body(shape=iota.{name.replace('cube', 'box').capitalize()}(...))" for name in SOLIDS},
    "ball": "system.ball(a, b, at=...), a joint; a round body is system.body(shape=iota.Sphere(radius))",
    "plane": "system.obstacle(iota.HalfSpace((0, 1, 0)))",
    "ground": "system.obstacle(iota.HalfSpace((0, 1, 0))); a World makes one by itself",
    "wall": "system.obstacle(iota.Box((4, 2, 0.1)), position=(0, 1, -2))",
    "hinge": "system.revolute(a, b, at=..., axis=...), or p.combine(q) of particles",
    "fixed": "system.weld(a, b)",
    "slider": "system.prismatic(a, b, at=..., axis=...)",
    "spring": "system.bond(p, q, 'spring', stiffness=...)",
    "joint": "system.revolute(...), ball, prismatic, cylindrical, universal, planar or weld",
    "joints": "system.constraints",
    "constraint": "system.revolute(...), ball, prismatic, weld, rod, rope and others",
    "force": "body.apply_force(force), or system.field(...) everywhere",
    "objects": "system.bodies",
    "run": "iota.World(system).run(), or system.step(dt)",
    "simulate": "system.step(dt, count)",
    "update": "system.step(dt)",
    "dt": "system.step(dt), or iota.World(system, dt=...)",
    "on_contact": "world.on_contact(a, b), or system.watch_contacts",
    "show": "iota.World(system).run()",
    "remove": "destroy(), of the body, particle or bond",
}
OF_MODULE = {
    "Cube": "iota.Box",
    "Ball": "iota.Sphere",
    "Pill": "iota.Capsule",
    "Plane": "iota.HalfSpace",
    "Pyramid": "iota.looks.pyramid, or an iota.Mesh",
    "Vector": "iota.Vec3",
    "Vector3": "iota.Vec3",
    "Quaternion": "four numbers x y z w, or axis and degrees: ('z', 30)",
    "Color": "a text: 'tomato' or '#ff6347'",
    "Rod": "system.rod(p, q), or a body with two particles",
    "Rope": "system.rope(p, q)",
    "Spring": "system.bond(p, q, 'spring', stiffness=...)",
    "Hinge": "system.revolute(a, b, at=..., axis=...)",
    "Joint": "system.revolute(a, b, at=..., axis=...), ball, prismatic and others",
    "Simulation": "iota.System, or iota.World to show one",
    "Scene": "iota.World",
    "Viewer": "iota.World",
    "Link": "a body: system.body()",
    "Look": "iota.looks.Look",
    "load": "iota.shapelib.load(path)",
    "run": "iota.World(system).run()",
    "step": "system.step(dt)",
    "label": "world.label(text, at=...)",
    "slider": "world.controls.slider",
}
WORDS_OF_MAKERS = ("add_", "create_", "make_", "new_", "spawn_")


def explain() -> None:
    """Lets the engine's classes say where names are that they do not have."""
    own = {Body: OF_BODY, Particle: OF_PARTICLE, System: OF_SYSTEM | made_otherwise()}
    kinds = (
        AngleSpring,
        Articulate,
        Body,
        Bond,
        Constraint,
        Emitter,
        Field,
        Grip,
        Group,
        Law,
        PairForce,
        Particle,
        System,
    )
    for kind in kinds:
        arguments.explain_reading(kind, PLACES | own.get(kind, {}))


def made_otherwise() -> dict[str, str]:
    """Names of makers in other libraries: add_body, create_box."""
    nouns = {name: f"system.{name}(...)" for name in dir(System) if name[0] != "_"} | OF_SYSTEM | PLACES
    return {word + noun: place for word in WORDS_OF_MAKERS for noun, place in nouns.items()}
