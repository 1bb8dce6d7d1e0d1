# SPDX-License-Identifier: Apache-2.0
"""Iota: worlds of particles, bonds and exactly jointed bodies that can be restructured while they run.

    import iota

    system = iota.System()
    links = iota.builder.chain(links=24).realize(system).bodies
    world = iota.World(system, title="chain")
    world.run()          # prints the address of a page that shows it

This module has the names that scripts use; types of returned values are in `iota.types`. `iota.effects`, `film`, `implicit`,
`shapelib` and `testing` are imported when they are first used. SI units; right-handed, y up.
Vectors are any 2 or 3 numbers (default z: 0) and are returned as `Vec3`. docs/conventions.md has the rules.
"""

from iota import starting as starting  # noqa: I001  # first: the other imports take time

from collections.abc import Sequence
from importlib import import_module
from types import ModuleType
from typing import TYPE_CHECKING

from iota import arguments, builder, elsewhere, looks, types
from iota._core import (
    AngleSpring,
    Articulate,
    Body,
    BodyArray,
    Bond,
    BondArray,
    Box,
    Capsule,
    Cone,
    Constraint,
    ContactPoint,
    CosmeticBond,
    Cylinder,
    Ellipsoid,
    Emitter,
    Field,
    Grip,
    Group,
    HalfSpace,
    Impact,
    JointArray,
    Law,
    Material,
    Mesh,
    PairForce,
    Particle,
    ParticleArray,
    Shape,
    Sphere,
    System,
    Torus,
    Vec3,
)
from iota._core import version as __version__
from iota.errors import (
    BondError,
    ConstraintError,
    ForceError,
    ForceWarning,
    PageMissingError,
    StaleIdError,
    WrongThreadError,
)
from iota.simulator import SimulatedBody, SimulatedGrip, SimulatedParticle, Simulator
from iota.solvers import Problem, solve, solver, solver_names
from iota.sweeping import step_all, sweep
from iota.world import Camera, Event, Server, View, World

if TYPE_CHECKING:
    from iota import effects as effects
    from iota import film as film
    from iota import implicit as implicit
    from iota import shapelib as shapelib
    from iota import testing as testing

_LATER = ("effects", "film", "implicit", "shapelib", "testing")

Sequence.register(Vec3)

__all__ = [
    "AngleSpring",
    "Articulate",
    "Body",
    "BodyArray",
    "Bond",
    "BondArray",
    "BondError",
    "Box",
    "Camera",
    "Capsule",
    "Cone",
    "Constraint",
    "ConstraintError",
    "ContactPoint",
    "CosmeticBond",
    "Cylinder",
    "Ellipsoid",
    "Emitter",
    "Event",
    "Field",
    "ForceError",
    "ForceWarning",
    "Grip",
    "Group",
    "HalfSpace",
    "Impact",
    "JointArray",
    "Law",
    "Material",
    "Mesh",
    "PageMissingError",
    "PairForce",
    "Particle",
    "ParticleArray",
    "Problem",
    "Server",
    "Shape",
    "SimulatedBody",
    "SimulatedGrip",
    "SimulatedParticle",
    "Simulator",
    "Sphere",
    "StaleIdError",
    "System",
    "Torus",
    "Vec3",
    "View",
    "World",
    "WrongThreadError",
    "__version__",
    "builder",
    "looks",
    "solve",
    "solver",
    "solver_names",
    "step_all",
    "sweep",
    "types",
]

elsewhere.explain()
for _module in (builder.__name__, looks.__name__, types.__name__, __name__):
    arguments.explain_module(_module)


def __getattr__(name: str) -> ModuleType:
    """Parts that take long to import, or need more packages, when they are first used."""
    if name in _LATER:
        return import_module(f"iota.{name}")
    if name in elsewhere.OF_MODULE:
        raise AttributeError(f"module 'iota' has no attribute {name!r}: it is {elsewhere.OF_MODULE[name]}")
    raise AttributeError(f"module 'iota' has no attribute {name!r}", name=name, obj=import_module("iota"))
