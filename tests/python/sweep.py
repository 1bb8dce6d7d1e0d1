# SPDX-License-Identifier: Apache-2.0
"""The public interface as a table of calls with good arguments, and what can be put in their place.

`test_sweep.py` gives each argument each bad value; `test_fuzz.py` calls at random. A new call is one line in CALLS.
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable
from typing import Any

import numpy as np

import iota

NAN, INF = math.nan, math.inf
REFUSALS = (ValueError, TypeError)  # StaleIdError is a ValueError

Call = tuple[Callable[..., Any], dict[str, Any]]


class Scene:
    """A little of everything, hung together. Handles are named after what they are."""

    def __init__(self) -> None:
        s = self.system = iota.System(threads=1)
        self.rods = iota.builder.chain(links=4, length=1.0, top=(0, 2, 0), direction=(1, 0, 0)).realize(s).bodies
        self.p, self.q = self.rods[0].particles[1], self.rods[2].particles[1]
        self.box = s.body(shape=iota.Box((0.4, 0.2, 0.3)), position=(0, 0, 3), attachments=[(0.2, 0, 0)])
        self.ball = s.body(shape=iota.Sphere(0.2), position=(1, 0, 3), attachments=[(-0.2, 0, 0)])
        self.brick = s.body(shape=iota.Box((0.2, 0.2, 0.2)), position=(0, 0, 5))
        self.corner, self.pole = self.box.attachments[0], self.ball.attachments[0]
        self.plate = s.body()
        for place in ((0, 0, -3), (1, 0, -3), (0, 1, -3), (1, 1, -3)):
            self.plate.particle(place, mass=0.5)
        self.point = s.body().particle((3, 3, 3))
        self.bend = s.angle_spring(self.p, self.q, self.point, 2.0, 0.1)
        self.line = s.cosmetic_bond(*self.plate.particles[:2])
        self.spring = s.bond(self.p, self.plate.particles[0], "spring", stiffness=50, damping=1)
        self.script = s.bond(self.q, self.corner, lambda bond: bond.direction * 0.5)
        self.hinge = s.revolute(self.box, self.ball, at=(0.5, 0, 3), axis=(0, 0, 1), limits=(-1, 1))
        self.slider = s.prismatic(self.plate, None, at=(0, 0, -3), axis=(0, 1, 0), motor=(0.1, 5))
        self.rope = s.rope(self.point, self.plate.particles[3], 12)
        self.crowd = s.group("crowd")
        self.crowd.add(self.plate, self.box)
        self.well = s.field("well", group=self.crowd, strength=0.1)
        self.swell = s.field("energy = k*x^2; fy = -c*vy", k=0.1, c=0.1)
        self.pair_force = s.pair_force("coulomb", cutoff=2.0, group=self.crowd, strength=0.1, softening=0.1)
        self.law = s.law("energy = 0.5*k*(r - r0)^2; force = -c*v", k=5, r0=None, c=0.1)
        self.unused_law, self.nobody = s.law("energy = r"), s.group("nobody")
        self.written = s.bond(self.p, self.point, self.law)
        self.fountain = s.emitter(rate=60, position=(8, 8, 8), lifetime=0.2)
        self.surfel = s.body().particle((7, 7, 7))
        self.surfel.orientation = (0, 0, 0, 1)
        self.grip = s.grip(self.rods[3], target=(1, 1, 1))
        self.gone = s.body()
        self.gone_particle = self.gone.particle((9, 9, 9))
        self.gone_bond = s.bond(self.gone_particle, self.point, "drag", damping=1)
        self.gone.destroy()
        self.other = iota.System()
        self.foreign = self.other.body()
        self.foreign_particle = self.foreign.particle()
        self.rods[3].particles[1].combine(self.pole, over=0.5)


def assign(thing: Any, name: str, value: Any) -> None:
    setattr(thing, name, value)


def set_member(name: str) -> Callable[..., None]:
    return lambda of, value: setattr(of, name, value)


V = (0.1, 0.2, 0.3)
HANDLES = ("of", "thing")  # whose attribute is assigned: Python's own AttributeError is what a wrong one gets
SPHERE = iota.Sphere(0.5)
TETRAHEDRON = iota.Mesh([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)], [(0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2)])


def calls(c: Scene) -> dict[str, Call]:
    """Each call with arguments that are good for a fresh scene."""
    s = c.system
    joint = {"a": c.brick, "b": c.box, "at": V, "axis": (0, 0, 1)}
    drive = {"limits": (-1, 1), "motor": (1, 2), "friction": 0.1, "spring": (1, 0.1, 0), "break_force": 100.0}
    member = {
        "gravity": (s, V),
        "mode": (s, "robust"),
        "damping": (s, 0.1),
        "threads": (s, 2),
        "solver": (s, "newton"),
        "positions": (s, s.positions),
        "velocities": (s, s.velocities),
    }
    table: dict[str, Call] = {
        "System": (iota.System, {"gravity": V, "mode": "robust", "damping": 0.1, "threads": 1}),
        "step": (s.step, {"dt": 1 / 60}),
        "diagnose": (s.diagnose, {"body": c.box}),
        "restore": (s.restore, {"snapshot": s.snapshot()}),
        "body": (s.body, {"kind": "dynamic", "damping": 0.1}),
        "body of a shape": (
            s.body,
            {"kind": "dynamic", "damping": 0.1, "shape": SPHERE, "density": 500.0, "position": V,
                "orientation": (0, 0, 0, 1), "velocity": V, "spin": V, "attachments": [V],
            },
        ),
        "body of a mass": (s.body, {"shape": TETRAHEDRON, "mass": 2.0}),
        "Sphere": (iota.Sphere, {"radius": 0.5}),
        "Box": (iota.Box, {"size": (1, 2, 3), "rounding": 0.1}),
        "Cylinder": (iota.Cylinder, {"radius": 0.5, "length": 1.0}),
        "Capsule": (iota.Capsule, {"radius": 0.5, "length": 1.0}),
        "Torus": (iota.Torus, {"radius": 0.5, "tube": 0.1, "stretch": 0.3}),
        "Cone": (iota.Cone, {"radius": 0.5, "length": 0.1}),
        "Mesh": (
            lambda vertices, triangles: iota.Mesh(vertices, triangles).mass_properties,
            {"vertices": TETRAHEDRON.vertices, "triangles": TETRAHEDRON.triangles},
        ),
        "set_pose": (c.box.set_pose, {"position": V, "orientation": (0, 1, 0, 0)}),
        "attachment": (c.box.attachment, {"position": V}),
        "set_rod": (c.rods[1].set_rod, {"mass": 1.0, "radius": 0.1}),
        "particle": (c.plate.particle, {"position": V, "mass": 1.0, "velocity": V}),
        "marker": (lambda position: c.box.particle(position, 0), {"position": V}),
        "nail": (c.point.nail, {"position": V}),
        "apply_force": (c.point.apply_force, {"force": V}),
        "combine": (c.point.combine, {"q": c.plate.particles[0]}),
        "combine over": (c.point.combine, {"q": c.plate.particles[0], "over": 0.2}),
        "combine bodies": (c.rods[0].combine, {"other": c.rods[1]}),
        "separate": (c.p.separate, {"q": c.rods[1].particles[0]}),
        "angle_spring": (
            s.angle_spring,
            {"p": c.p, "middle": c.q, "q": c.point, "stiffness": 2.0, "damping": 0.1, "rest": 1.0},
        ),
        "cosmetic_bond": (s.cosmetic_bond, {"p": c.plate.particles[0], "q": c.plate.particles[1]}),
        "spring": (
            lambda p, q, stiffness, damping, length: s.bond(
                p, q, "spring", stiffness=stiffness, damping=damping, length=length
            ),
            {"p": c.p, "q": c.point, "stiffness": 10.0, "damping": 0.1, "length": 1.0},
        ),
        "drag": (lambda p, q, damping: s.bond(p, q, "drag", damping=damping), {"p": c.p, "q": c.q, "damping": 1.0}),
        "scripted": (s.bond, {"p": c.p, "q": c.point, "law": lambda bond: (0, 0, 0)}),
        "grip": (
            s.grip,
            {"body": c.box, "local_point": V, "target": V, "client": 1, "hold": 2, "frequency": 2.0,
             "max_acceleration": 50.0},
        ),
        "grip.move": (c.grip.move, {"target": V}),
        "ball": (s.ball, {"a": c.brick, "b": c.box, "at": V, "break_force": 9.0, "break_torque": 9.0}),
        "weld": (s.weld, {"a": c.brick, "b": c.box, "at": V, "break_force": 9.0, "break_torque": 9.0}),
        "orientation": (s.orientation, {"a": c.brick, "b": c.box, "break_torque": 9.0}),
        "revolute": (s.revolute, {**joint, **drive, "break_torque": 9.0}),
        "prismatic": (s.prismatic, {**joint, **drive, "break_torque": 9.0}),
        "cylindrical": (s.cylindrical, {**joint, "angle": {"limits": (-1, 1)}, "slide": {"friction": 1.0}}),
        "universal": (s.universal, {**joint, "second_axis": (1, 0, 0), **drive}),
        "rod": (s.rod, {"p": c.point, "q": c.corner, "length": 4.0, "break_force": 1e6}),
        "rope": (s.rope, {"p": c.point, "q": c.corner, "length": 8.0, "break_force": 1e6}),
        "on_path": (
            s.on_path,
            {"p": c.point, "path": [(3, 3, 3), (4, 3, 3), (4, 4, 3)], "body": None, "closed": False, "smooth": True,
             "limits": (0, 1), "motor": (0.1, 2), "friction": 0.1, "spring": (1, 0.1, 0.2), "break_force": 1e6},
        ),
        "on a polyline": (
            s.on_path,
            {"p": c.point, "path": [(3, 3, 3), (4, 3, 3), (4, 4, 3)], "smooth": False, "rounding": 0.1},
        ),
        "on a function": (
            s.on_path,
            {"p": c.point, "path": lambda t: (3 + t, 3, 3), "interval": (0.0, 2.0), "samples": 16},
        ),
        "on_surface": (
            s.on_surface,
            {"p": c.point, "surface": SPHERE, "body": c.box, "at": (3, 3, 2.5), "orientation": (0, 0, 0, 1),
             "break_force": 1e6},
        ),
        "inside": (s.inside, {"p": c.point, "surface": iota.Sphere(9.0), "at": V}),
        "outside": (s.outside, {"p": c.point, "surface": iota.HalfSpace((0, 1, 0)), "at": V}),
        "inside a function": (
            s.inside,
            {"p": c.point, "surface": lambda x, y, z: math.sqrt(x * x + y * y + z * z) - 9, "size": 9.0},
        ),
        "HalfSpace": (lambda normal: s.outside(c.point, iota.HalfSpace(normal)), {"normal": (0, 1, 0)}),
        "Ellipsoid": (lambda size: s.inside(c.point, iota.Ellipsoid(size)), {"size": (9, 8, 7)}),
        "surface_to_surface": (
            s.surface_to_surface,
            {"a": c.box, "surface_a": iota.Sphere(0.1), "b": c.brick, "surface_b": iota.Sphere(0.2),
             "one_sided": True},
        ),
        "hinge.limits": (lambda value: assign(c.hinge.angle, "limits", value), {"value": (-1, 1)}),
        "hinge.motor": (lambda value: assign(c.hinge.angle, "motor", value), {"value": (1, 1)}),
        "hinge.friction": (lambda value: assign(c.hinge.angle, "friction", value), {"value": 0.1}),
        "hinge.spring": (lambda value: assign(c.hinge.angle, "spring", value), {"value": (1, 0.1, 0)}),
        "break_force": (lambda value: assign(c.hinge, "break_force", value), {"value": 10.0}),
        "break_torque": (lambda value: assign(c.hinge, "break_torque", value), {"value": 10.0}),
        "rope.length": (lambda value: assign(c.rope, "length", value), {"value": 5.0}),
        "law": (s.law, {"law": "energy = k*r^2", "name": "law", "k": 1.0}),
        "law of arrays": (
            lambda law, k: s.bond(c.point, c.corner, s.law(law, k=k)),
            {"law": lambda bonds: np.zeros((len(bonds), 3)), "k": 1.0},
        ),
        "bond of an expression": (
            lambda law, k: s.bond(c.point, c.corner, law, k=k),
            {"law": "energy = 0.5*k*r^2", "k": 1.0},
        ),
        "bond of a law": (s.bond, {"p": c.point, "q": c.corner, "law": c.law, "k": 3.0, "implicit": True}),
        "bond.set": (c.written.set, {"k": 2.0, "r0": 1.0, "c": 0.1}),
        "lennard_jones": (
            lambda depth, size: s.bond(c.point, c.corner, "lennard_jones", depth=depth, size=size),
            {"depth": 1.0, "size": 1.0},
        ),
        "morse": (
            lambda depth, width, length: s.bond(
                c.point, c.corner, "morse", depth=depth, width=width, length=length
            ),
            {"depth": 1.0, "width": 1.0, "length": 1.0},
        ),
        "group": (s.group, {"name": "few"}),
        "group.add": (lambda member: c.crowd.add(member), {"member": c.point}),
        "group.remove": (lambda member: c.crowd.remove(member), {"member": c.box}),
        "uniform": (
            s.field,
            {"field": "uniform", "group": c.crowd, "replaces_gravity": True, "acceleration": V},
        ),
        "wind": (s.field, {"field": "wind", "velocity": V, "drag": 0.1}),
        "current": (
            s.field,
            {"field": "current", "velocity": V, "drag": 0.1, "speed": 1.0, "size": 2.0, "octaves": 3.0,
             "evolution": 0.1, "seed": 1.0},
        ),
        "attractor": (s.field, {"field": "attractor", "center": V, "strength": 1.0, "range": 2.0}),
        "field of an expression": (
            lambda field, k: s.field(field, k=k),
            {"field": "energy = 0.5*k*y^2", "k": 0.1},
        ),
        "field of arrays": (s.field, {"field": lambda batch: np.zeros((len(batch), 3))}),
        "well.set": (c.well.set, {"center": V, "strength": 0.2, "softening": 0.1}),
        "pair_force": (s.pair_force, {"law": "soft_repulsion", "cutoff": 1.5, "group": c.crowd, "length": 1.0}),
        "pair_force.set": (c.pair_force.set, {"strength": 0.1, "softening": 0.2}),
        "emitter": (
            s.emitter,
            {"rate": 50.0, "source": SPHERE, "position": V, "orientation": (0, 0, 0, 1), "velocity": V,
             "velocity_spread": 0.1, "lifetime": 1.0, "lifetime_spread": 0.1, "mass": 0.1, "damping": 0.1,
             "max_count": 50, "curve": [(0.0, 0.1, (1, 1, 1)), (1.0, 0.2, (1, 0, 0, 0))], "seed": 3},
        ),
        "emitter.move": (c.fountain.move, {"position": V, "orientation": (0, 0, 0, 1)}),
        "align": (c.surfel.align, {"direction": V, "stiffness": 2.0, "damping": 0.1}),
        "apply_torque": (c.surfel.apply_torque, {"torque": V}),
        "Body.apply_force": (c.box.apply_force, {"force": V, "at": V}),
        "Body.apply_torque": (c.box.apply_torque, {"torque": V}),
        "hinge.value": (lambda value: assign(c.hinge.angle, "value", value), {"value": 0.1}),
        "hinge.servo": (lambda value: assign(c.hinge.angle, "servo", value), {"value": (0.1, 2.0, 3.0)}),
        "array": (s.array, {"handles": [c.box, c.ball]}),
        "particle_array": (
            s.particle_array,
            {"positions": np.eye(3), "masses": np.ones(3), "velocities": np.eye(3), "kind": "dynamic", "damping": 0.1},
        ),
        "rod_array": (
            s.rod_array,
            {"starts": np.eye(3), "ends": 2 * np.eye(3), "masses": 0.5, "radii": np.ones(3), "kind": "dynamic"},
        ),
        "bond_array": (
            lambda p, q, law, stiffness: s.bond_array([p], [q], law, stiffness=stiffness),
            {"p": c.point, "q": c.corner, "law": "spring", "stiffness": 5.0},
        ),
        "chain": (
            lambda links, length, top, direction: iota.builder.chain(links, length, top=top, direction=direction).realize(s).bodies,
            {"links": 3, "length": 1.0, "top": V, "direction": (1, 0, 0)},
        ),
        "World": (iota.World, {"system": s, "title": "t", "dt": 1 / 60}),
        "speed": (lambda value: assign(iota.World(s).clock, "speed", value), {"value": 1.0}),
        "at": (lambda time: iota.World(s).at(time)(print), {"time": 1.0}),
        "every": (lambda period: iota.World(s).every(period)(print), {"period": 1.0}),
    }  # fmt: skip
    for name, (thing, value) in member.items():
        table[f"System.{name}"] = (set_member(name), {"of": thing, "value": value})
    for name, value in (("kind", "static"), ("damping", 0.1), ("velocity", V), ("angular_velocity", V)):
        table[f"Body.{name}"] = (set_member(name), {"of": c.plate, "value": value})
    for name, value in (("position", V), ("orientation", (0, 0, 1, 1)), ("mass", 2.0), ("name", "box")):
        table[f"Body.{name}"] = (set_member(name), {"of": c.box, "value": value})
    for name, width in (("positions", 3), ("orientations", 4), ("poses", 7), ("velocities", 3), ("motions", 6)):
        table[f"BodyArray.{name}"] = (set_member(name), {"of": s.array([c.box, c.ball]), "value": np.ones((2, width))})
    for name, value in (("position", V), ("velocity", V), ("mass", 2.0)):
        table[f"Particle.{name}"] = (set_member(name), {"of": c.point, "value": value})
    for name, value in (("lifetime", 2.0), ("radius", 0.1), ("color", (1, 0.5, 0)), ("spin", V),
                        ("orientation", (0, 0, 0, 1)), ("moment", 0.1), ("break_force", 100.0)):  # fmt: skip
        table[f"surfel.{name}"] = (set_member(name), {"of": c.surfel, "value": value})
    for name, value in (("rest_after", 1.0), ("rest_speed", 0.01)):
        table[f"System.{name}"] = (set_member(name), {"of": s, "value": value})
    table["emitter.rate"] = (set_member("rate"), {"of": c.fountain, "value": 20.0})
    for name, value in (("stiffness", 3.0), ("damping", 0.2), ("rest", 2.0)):
        table[f"angle_spring.{name}"] = (set_member(name), {"of": c.bend, "value": value})
    table["spring.break_force"] = (set_member("break_force"), {"of": c.spring, "value": 100.0})
    for name, thing in (("field", c.well), ("pair_force", c.pair_force), ("emitter", c.fountain), ("bond", c.written)):
        table[f"{name}.active"] = (set_member("active"), {"of": thing, "value": False})
    table["Bond.active"] = (set_member("active"), {"of": c.spring, "value": False})
    table["Constraint.active"] = (set_member("active"), {"of": c.hinge, "value": False})
    things = {
        "body": c.box, "particle": c.p, "bond": c.spring, "cosmetic_bond": c.line, "angle_spring": c.bend, "grip": c.grip, "constraint": c.hinge,
        "field": c.well, "pair_force": c.pair_force, "emitter": c.fountain, "law": c.unused_law, "group": c.nobody,
    }  # fmt: skip
    for name in things:
        table[f"destroy {name}"] = (lambda thing: thing.destroy(), {"thing": things[name]})
    return table


OTHERS = (
    iota.AngleSpring, iota.Bond, iota.Grip, iota.CosmeticBond, iota.Constraint, iota.Field, iota.PairForce, iota.Emitter, iota.Law, iota.Group
)  # fmt: skip
HUGE = [1e300, -1e300, 1e12, 1e-12, 1e-300]


def bad_values(c: Scene, good: Any) -> list[Any]:
    """What a user might put in the place of a good argument."""
    if isinstance(good, bool):
        return ["yes", None, NAN]
    if isinstance(good, int):
        return [0, -1, 2**40, 1.5, NAN, "many", None]
    if isinstance(good, float):
        return [0.0, -1.0, NAN, INF, -INF, *HUGE, "much", None]
    if isinstance(good, str):
        return ["", "no such word", 7, None, "x" * 10_000, "\0"]
    if isinstance(good, bytes):
        return [b"", good[:-3], good + b"x", bytes(len(good)), good[:40] + b"\xff" * 9 + good[49:], None, "text"]
    if isinstance(good, dict):
        return [{}, {"limit": (0, 1)}, {"limits": (1, -1)}, {"friction": NAN}, 7, None]
    if isinstance(good, iota.Body):
        return [c.gone, c.foreign, c.system.body(), None, c.p, c.rods[0], c.plate, "body"]
    if isinstance(good, iota.Particle):
        return [c.gone_particle, c.foreign_particle, None, c.plate, c.p, c.q, c.plate.particles[1], "particle"]
    if isinstance(good, iota.System):
        return [c.other, None, "system"]
    if isinstance(good, OTHERS):
        return [c.gone_bond, None]
    if callable(good) and not isinstance(good, type):
        return [None, 7, raising, shapeless, not_finite, lambda: 1, lambda *a: (1e300, 0, 0)]
    if isinstance(good, np.ndarray):
        return [good[:-1], good * NAN, good.ravel(), "array", None, good.astype(object), [[1, 2], [3]], good * 1e300]
    if isinstance(good, tuple | list) and good and isinstance(good[0], int | float):
        numbers = list(good)
        ones = [[value, *numbers[1:]] for value in (NAN, INF, *HUGE, "a", None)]
        return [*ones, [0] * len(numbers), numbers[:1], numbers * 3, (), "abc", None, 3.0, list(reversed(numbers))]
    if isinstance(good, tuple | list):
        return [[], good[:1], [good[0]] * 3, [(NAN, 0, 0)] * 3, [(1e300, 0, 0), *good], "path", None, [1, 2, 3]]
    return [None, 7, "shape"]


def raising(*_: Any) -> Any:
    raise KeyError("the script's own mistake")


def shapeless(*_: Any) -> Any:
    return "not a number"


def not_finite(*_: Any) -> Any:
    return (NAN, NAN, NAN)


def check(c: Scene, steps: int = 2) -> None:
    """The system is whole, and goes on to finite places."""
    system = c.system
    assert system.validate() == []
    for _ in range(steps):
        try:
            report = system.step(1 / 60)
        except iota.ForceError as error:
            report = error.report
        assert math.isfinite(report.energy.kinetic), report
        assert math.isfinite(report.worst_gap), report
    assert np.isfinite(system.positions).all()
    assert np.isfinite(system.velocities).all()
    assert system.validate() == []


def refused(function: Callable[..., Any], arguments: dict[str, Any]) -> Exception | None:
    """Makes the call; what it was refused with."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of NumPy, for what is cast
        try:
            function(**arguments)
        except REFUSALS as error:
            return error
        except KeyError as error:  # of a function of the script's: passed on as it is
            assert "own mistake" in str(error)
            return error
    return None
