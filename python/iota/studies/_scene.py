# SPDX-License-Identifier: Apache-2.0
"""What stands in a system as plain data: to be saved, loaded, and written as a script."""

from __future__ import annotations

from typing import Any

import iota
from iota import looks, shapes
from iota.builder import Structure

SCRIPT = '''"""Made in the playground of Iota."""

import iota
from iota import looks, shapes

made = iota.builder.Structure()
{lines}

system = iota.System(gravity={gravity}, damping={damping!r})
world = iota.World(system, title="made in the playground")
made.looks |= {{"rod": looks.capsule({rod!r}, "brass"), "solid": looks.solid("wood")}}
bodies = made.realize(system, world).bodies
{combined}world.run()
'''
ROD = 0.018  # m, how thick rods are drawn
LOOKS = {"rod": looks.by_style(looks.capsule(ROD, "brass")), "solid": looks.by_style(looks.solid("wood"))}


class Scene:
    """A structure, and which of its bodies are one with which: a body of several solids is a body for each, combined."""

    def __init__(self, structure: Structure, combined: list[tuple[int, int]]) -> None:
        self.structure, self.combined = structure, combined

    @classmethod
    def of(cls, system: iota.System) -> Scene:
        """Raises ValueError for joints, and for forces of code: they cannot be saved."""
        made, combined = Structure(looks=dict(LOOKS)), []
        if any(True for _ in system.constraints):
            raise ValueError("joints and ropes cannot be saved here")
        number: dict[iota.Particle, int] = {}
        for body in system.bodies:
            if body.is_spark:
                continue
            solids = body.solids
            points = []
            for particle in body.attachments if solids else body.particles:
                mass = 0.0 if solids else particle.mass
                points.append(made.point(particle.position, mass, particle.velocity))
                made.points.radius[points[-1]], made.points.color[points[-1]] = particle.radius, particle.color[:3]
                number[particle] = points[-1]
            if not solids:
                made.body(*points, look="rod" if len(points) > 1 else "")
                continue
            whole = len(made.bodies)
            for solid, part in zip(solids, body.parts, strict=True):
                made.body(
                    *points, shape=solid.shape, mass=part.mass, position=tuple(solid.position), spin=body.angular_velocity,
                    orientation=tuple(float(v) for v in solid.orientation), velocity=body.velocity, look="solid",
                )  # fmt: skip
                points = []
            combined += [(whole, other) for other in range(whole + 1, len(made.bodies))]
        for particle, point in number.items():
            first = next(other for other in particle.ring if other in number)
            if first != particle:
                made.hinge(number[first], point)
            elif particle.is_nailed:
                made.nail(point)
        for bond in system.bonds:
            p, q = bond.ends
            numbers: dict[str, Any] = dict(bond.parameters)
            made.bond(number[p], number[q], bond.law.name, **numbers)
        return cls(made, combined)

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
        try:
            structure = Structure.from_json(data["structure"])
            combined = [(int(a), int(b)) for a, b in data["combined"]]
        except (KeyError, TypeError, AttributeError, IndexError) as error:
            raise ValueError(f"this is no saved playground: {error!r}") from None
        if not all(0 <= a < len(structure.bodies) and 0 <= b < len(structure.bodies) for a, b in combined):
            raise ValueError("this is no saved playground: it combines bodies that are not there")
        return cls(structure, combined)

    def script(self, system: iota.System) -> str:
        """A script that makes it."""
        made = self.structure
        lines = [
            f"made.point({row(p)}, mass={m:.6g}, velocity={row(v)})"
            for p, m, v in zip(made.points.position, made.points.mass, made.points.velocity, strict=True)
        ]
        lines += [
            f"made.points.radius[{n}], made.points.color[{n}] = {made.points.radius[n]:.6g}, {row(made.points.color[n])}"
            for n in range(len(made.points)) if made.points.radius[n]
        ]  # fmt: skip
        for body in made.bodies:
            words = [str(point) for point in body.points] + ([f"look={body.look!r}"] if body.look else [])
            if body.shape is not None:
                words += [
                    f"shape=shapes.from_json({shapes.to_json(body.shape)})", f"mass={body.mass:.6g}",
                    f"position={row(body.position)}", f"orientation={row(body.orientation, 9)}",
                    f"velocity={row(body.velocity)}", f"spin={row(body.spin)}",
                ]  # fmt: skip
            lines.append(f"made.body({', '.join(words)})")
        lines += [f"made.hinge({p}, {q})" for p, q in made.hinges]
        lines += [f"made.nail({point})" for point in made.nails]
        for bond in made.bonds:
            numbers = ", ".join(f"{name}={value:.6g}" for name, value in bond.parameters.items() if value is not None)
            lines.append(f"made.bond({bond.p}, {bond.q}, {bond.law!r}, {numbers})")
        combined = "".join(f"bodies[{a}].combine(bodies[{b}])\n" for a, b in self.combined)
        return SCRIPT.format(
            lines="\n".join(lines), combined=combined, gravity=row(system.gravity), damping=system.damping, rod=ROD
        )


def row(values: Any, digits: int = 6) -> str:
    """Numbers as they are read in a script."""
    return f"({', '.join(f'{round(float(value), digits) + 0.0:.{digits}g}' for value in values)})"
