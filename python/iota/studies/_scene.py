# SPDX-License-Identifier: Apache-2.0
"""The content of a world as plain data: to be saved, loaded, and written as a script."""

from __future__ import annotations

import math
from dataclasses import fields
from typing import Any, Literal, cast

import iota
from iota import looks
from iota.arguments import of_type
from iota.builder import Structure

SCRIPT = '''"""Made in the playground of Iota."""

import iota
from iota import looks

made = iota.builder.Structure()
{lines}

system = iota.System(gravity={gravity}, damping={damping!r})
world = iota.World(system, title="made in the playground", camera={camera})
{ties}
{frame}
with system.edit():
    bodies = made.realize(system, world).bodies
{combined}world.run()
'''
COORDINATES = {
    "ball": (), "weld": (), "orientation": (), "revolute": ("angle",), "prismatic": ("slide",),
    "planar": ("angle",), "cylindrical": ("angle", "slide"),
}  # fmt: skip
"""The joints that can be saved, and their coordinates."""

DIGITS = 12  # after the decimal point
CAMERA = iota.Camera((0.6, 1.5, 4.0), (0, 1.1, 0))
BEAM = looks.cylinder(0.025, "wood")
FRAME = (((-1.3, 0, 0), (-1.3, 2.05, 0)), ((1.2, 0, 0), (1.2, 2.05, 0)), ((-1.4, 2.05, 0), (1.3, 2.05, 0)))  # m
TIES: dict[Literal["spring", "rope", "rod"], looks.Look] = {
    "spring": looks.spring(0.03, 0.004, "steel"), "rope": looks.cylinder(0.008, "rope"),
    "rod": looks.cylinder(0.008, "steel"),
}  # fmt: skip


class Scene:
    """A structure, and which of its bodies are combined: a combined body is a body for each of its parts."""

    def __init__(self, structure: Structure, combined: list[tuple[int, int]]) -> None:
        self.structure, self.combined = structure, combined

    @classmethod
    def of(cls, world: iota.World) -> Scene:
        """Raises ValueError for constraints that cannot be saved, and for forces of code."""
        made = _Made(world)
        for body in world.system.bodies:
            if not body.is_spark:
                made.add_body(body)
        made.add_hinges()
        for bond in world.system.bonds:
            if bond.active:
                p, q = bond.ends
                numbers: dict[str, Any] = dict(bond.parameters)
                made.structure.bond(
                    made.point[p], made.point[q], bond.law.name, break_force=bond.break_force, **numbers
                )
        for constraint in world.system.constraints:
            if constraint.active:
                made.add_constraint(constraint)
        return cls(made.structure, made.combined)

    def realize(self, world: iota.World) -> None:
        """Into a world, all or nothing. Raises ValueError."""
        with world.system.edit():
            bodies = self.structure.realize(world.system, world).bodies
            for whole, part in self.combined:
                bodies[whole].combine(bodies[part])

    def to_json(self) -> dict[str, Any]:
        return {"structure": self.structure.to_json(), "combined": self.combined}

    @classmethod
    def from_json(cls, data: Any) -> Scene:
        """Raises ValueError that says what is wrong."""
        for name in ("structure", "combined"):
            if name not in of_type(data, dict, "a saved playground"):
                raise ValueError(f"this is not a saved playground: it has no {name!r}")
        structure, pairs = Structure.from_json(data["structure"]), of_type(data["combined"], list, "'combined'")
        for pair in pairs:
            if len(of_type(pair, list, "each of 'combined'")) != 2:
                raise ValueError(f"each of 'combined' must be two bodies, not {len(pair)}")
            if not all(0 <= of_type(body, int, "a body in 'combined'") < len(structure.bodies) for body in pair):
                raise ValueError("this is not a saved playground: it combines bodies that are not there")
        return cls(structure, [(a, b) for a, b in pairs])

    def script(self, system: iota.System) -> str:
        """A script that makes it, of the same numbers as a file."""
        made, points = self.structure, self.structure.points
        lines = [f"made.looks[{name!r}] = {call_of(look)}" for name, look in made.looks.items()]
        lines += [
            f"made.point({row(p)}, mass={float(m)!r}, velocity={row(v)})"
            for p, m, v in zip(points.position, points.mass, points.velocity, strict=True)
        ]
        lines += [
            f"made.points.radius[{n}], made.points.color[{n}] = {float(points.radius[n])!r}, {row(points.color[n])}"
            for n in range(len(points)) if points.radius[n]
        ]  # fmt: skip
        for body in made.bodies:
            words = [str(point) for point in body.points] + ([f"look={body.look!r}"] if body.look else [])
            if body.shape is not None:
                words += [
                    f"shape=iota.{body.shape!r}", f"mass={body.mass!r}", f"position={row(body.position)}",
                    f"orientation={row(body.orientation)}", f"velocity={row(body.velocity)}", f"spin={row(body.spin)}",
                ]  # fmt: skip
            lines.append(f"made.body({', '.join(words)})")
        lines += [f"made.hinge({p}, {q})" for p, q in made.hinges]
        lines += [f"made.nail({point})" for point in made.nails]
        for bond in made.bonds:
            lines.append(f"made.bond({bond.p}, {bond.q}, {bond.law!r}{words_of(bond.parameters, bond.break_force)})")
        for joint in made.joints:
            lines.append(f"made.joint({joint.kind!r}, {joint.a}, {joint.b}{words_of(joint.options)})")
        for tie in made.ties:
            lines.append(f"made.tie({tie.kind!r}, {tie.p}, {tie.q}, {tie.length!r}{words_of({}, tie.break_force)})")
        return SCRIPT.format(
            lines="\n".join(lines), gravity=row(system.gravity), damping=system.damping,
            camera=f"iota.Camera({row(CAMERA.position)}, {row(CAMERA.target)})",
            ties="\n".join(f"world.draw_ties({kind!r}, {call_of(look)})" for kind, look in TIES.items()),
            frame="\n".join(f"world.add_strut({row(a)}, {row(b)}, {call_of(BEAM)})" for a, b in FRAME),
            combined="".join(f"    bodies[{a}].combine(bodies[{b}])\n" for a, b in self.combined),
        )  # fmt: skip


class _Made:
    """A structure that is being made of a world. point, body: the numbers there of particles and bodies."""

    def __init__(self, world: iota.World) -> None:
        self.world, self.structure = world, Structure()
        self.combined: list[tuple[int, int]] = []
        self.point: dict[iota.Particle, int] = {}
        self.body: dict[iota.Body, int] = {}

    def add_body(self, body: iota.Body) -> None:
        """A body for each of its parts. A part with a solid has its mass from that, and keeps its attachments."""
        made, solids, places = self.structure, iter(body.solids), set(body.attachments)
        self.body[body] = whole = len(made.bodies)
        for part in body.parts:
            is_solid = any(particle.mass > 0 and particle not in places for particle in part.particles)
            own = [particle for particle in part.particles if particle in places]
            points = [self._add_point(particle, 0.0 if is_solid else particle.mass) for particle in own]
            options: dict[str, Any] = {"look": self._look_of(part.origin)}
            if is_solid:
                solid = next(solids)
                options |= {
                    "shape": solid.shape, "mass": part.mass, "position": numbers(solid.position),
                    "orientation": numbers(solid.orientation), "velocity": numbers(velocity_of(part)),
                    "spin": numbers(body.angular_velocity),
                }  # fmt: skip
            self.combined += [(whole, len(made.bodies))] if len(made.bodies) > whole else []
            made.body(*points, **options)

    def _add_point(self, particle: iota.Particle, mass: float) -> int:
        points = self.structure.points
        number = self.structure.point(numbers(particle.position), mass, numbers(particle.velocity))
        points.radius[number], points.color[number] = particle.radius, numbers(particle.color[:3])
        self.point[particle] = number
        return number

    def _look_of(self, body: iota.Body) -> str:
        """The name of its look in the structure; "" without one."""
        look, known = self.world.scene.look_of(body), self.structure.looks
        if look is None:
            return ""
        name = next((name for name, other in known.items() if other == look), f"look {len(known) + 1}")
        known[name] = look
        return name

    def add_hinges(self) -> None:
        """And nails: particles of one ring are hinged to its first."""
        for particle, point in self.point.items():
            first = next(other for other in particle.ring if other in self.point)
            if first != particle:
                self.structure.hinge(self.point[first], point)
            elif particle.is_nailed:
                self.structure.nail(point)

    def add_constraint(self, constraint: iota.Constraint) -> None:
        made, kind = self.structure, cast(Any, constraint.kind)
        if kind in ("rod", "rope"):
            p, q = constraint.particles
            made.tie(kind, self.point[p], self.point[q], constraint.length, break_force=constraint.break_force)
            return
        if kind not in COORDINATES or any(constraint.compliance):
            what = f"constraint {constraint.slot}, a {kind}{' with compliance' if kind in COORDINATES else ''},"
            raise ValueError(f"{what} cannot be saved here")
        options: dict[str, Any] = {}
        if kind != "orientation":
            options["at"] = numbers(constraint.position)
            options |= finite(break_force=constraint.break_force)
        if COORDINATES[kind]:
            options["axis"] = numbers(constraint.axis)
        of_each = {name: coordinate_options(getattr(constraint, name)) for name in COORDINATES[kind]}
        options |= of_each if len(of_each) > 1 else next(iter(of_each.values()), {})
        options |= finite(break_torque=constraint.break_torque)
        b = None if constraint.b is None else self.body[constraint.b]
        made.joint(kind, self.body[constraint.a], b, **options)


def velocity_of(part: Any) -> iota.Vec3:
    """The velocity of its center of mass, m/s."""
    return sum((p.velocity * (p.mass / part.mass) for p in part.particles), iota.Vec3())


def coordinate_options(coordinate: Any) -> dict[str, Any]:
    """The options of a joint that is made in the present pose, in which its coordinate is 0. Raises ValueError for a servo."""
    if coordinate.servo is not None:
        raise ValueError("a joint with a servo cannot be saved here")
    now, options = coordinate.value, dict[str, Any]()
    if coordinate.limits is not None:
        options["limits"] = numbers(limit - now for limit in coordinate.limits)
    if coordinate.motor is not None:
        options["motor"] = coordinate.motor
    if coordinate.friction > 0:
        options["friction"] = coordinate.friction
    if coordinate.friction_coefficient > 0:
        options["friction_coefficient"] = coordinate.friction_coefficient
    if coordinate.spring is not None:
        stiffness, damping, rest = coordinate.spring
        options["spring"] = numbers((stiffness, damping, rest - now))
    return options


def finite(**options: float) -> dict[str, float]:
    return {name: value for name, value in options.items() if math.isfinite(value)}


def numbers(values: Any) -> tuple[float, ...]:
    """As plain numbers of few digits, with 0 for -0: what is saved and what the script has are the same numbers."""
    return tuple(round(float(value), DIGITS) + 0.0 for value in values)


# --- as a script ------------------------------------------------------------------------------------------------------


def row(values: Any) -> str:
    return repr(numbers(values))


def words_of(options: dict[str, Any], break_force: float = math.inf) -> str:
    """Further arguments of a call."""
    given = options | finite(break_force=break_force)
    return "".join(f", {name}={value!r}" for name, value in given.items() if value is not None)


def call_of(drawn: looks.Drawn) -> str:
    """An expression that makes this look. Raises ValueError for a mesh."""
    if isinstance(drawn, dict):
        if list(drawn) == ["*"]:
            return call_of(drawn["*"])
        return f"{{{', '.join(f'{style!r}: {call_of(each)}' for style, each in drawn.items())}}}"
    if isinstance(drawn, list):
        return f"[{', '.join(call_of(each) for each in drawn)}]"
    if isinstance(drawn.shape, iota.Mesh):
        raise ValueError("a look that is a mesh cannot be written as a script; save it instead")
    given = {f.name: value for f in fields(drawn) if (value := getattr(drawn, f.name)) != f.default}
    given.pop("shape", None)
    shape = "None" if drawn.shape is None else f"iota.{drawn.shape!r}"
    return f"looks.Look({shape}{words_of(given)})"
