# SPDX-License-Identifier: Apache-2.0
"""Iota: worlds of particles, bonds and exactly jointed bodies that can be restructured while they run.

    import iota

    system = iota.System()
    links = iota.builder.chain(system, links=24)
    world = iota.World(system, title="chain")
    world.run()          # prints the address of a page that shows it

SI units; right-handed, y up. Vectors are any 2 or 3 numbers (z is then 0) and come back as `Vec3`.
"""

from collections.abc import Sequence

from iota import builder, forces, looks
from iota._core import (
    Body,
    Bond,
    BondBatch,
    BondState,
    Box,
    Capsule,
    CBond,
    Constraint,
    Cylinder,
    Diagnosis,
    Edit,
    Ellipsoid,
    Emitter,
    Energy,
    Field,
    Grip,
    Group,
    Law,
    MassProperties,
    Mesh,
    Pairs,
    Part,
    Particle,
    ParticleBatch,
    Plane,
    Recording,
    RestructureReport,
    Solid,
    Sphere,
    StepReport,
    System,
    Torus,
    Vec3,
    combine,
    separate,
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
from iota.profiling import ForceCost, ForceProfile, profile
from iota.simulator import SimulatedBody, SimulatedGrip, SimulatedParticle, Simulator
from iota.solvers import Problem, Solution, solve, solver, solver_names
from iota.world import Camera, Client, Event, RunSummary, World

Sequence.register(Vec3)

__all__ = [
    "Body",
    "Bond",
    "BondBatch",
    "BondError",
    "BondState",
    "Box",
    "CBond",
    "Camera",
    "Capsule",
    "Client",
    "Constraint",
    "ConstraintError",
    "Cylinder",
    "Diagnosis",
    "Edit",
    "Ellipsoid",
    "Emitter",
    "Energy",
    "Event",
    "Field",
    "ForceCost",
    "ForceError",
    "ForceProfile",
    "ForceWarning",
    "Grip",
    "Group",
    "Law",
    "MassProperties",
    "Mesh",
    "PageMissingError",
    "Pairs",
    "Part",
    "Particle",
    "ParticleBatch",
    "Plane",
    "Problem",
    "Recording",
    "RestructureReport",
    "RunSummary",
    "SimulatedBody",
    "SimulatedGrip",
    "SimulatedParticle",
    "Simulator",
    "Solid",
    "Solution",
    "Sphere",
    "StaleIdError",
    "StepReport",
    "System",
    "Torus",
    "Vec3",
    "World",
    "WrongThreadError",
    "__version__",
    "builder",
    "combine",
    "forces",
    "looks",
    "profile",
    "separate",
    "solve",
    "solver",
    "solver_names",
]
