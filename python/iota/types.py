# SPDX-License-Identifier: Apache-2.0
"""Types of returned values and of arguments of a script's functions: for annotations, and for custom simulators.

def pull(bond: iota.types.BondState) -> iota.Vec3:
    return 50 * (bond.distance - 1) * bond.direction
"""

from iota._core import (
    BondBatch,
    BondState,
    Broken,
    ContactEvent,
    Contacts,
    ContactWatch,
    Diagnosis,
    Edit,
    Energy,
    IslandReport,
    JointCoordinate,
    MassProperties,
    Part,
    ParticleBatch,
    Recording,
    RestructureReport,
    Solid,
    StepReport,
    StepTimes,
    StopEvent,
)
from iota.profiling import ForceCost, ForceProfile
from iota.solvers import Solution
from iota.world import Client, RunSummary
from iota.world.event import Hand

__all__ = [
    "BondBatch",
    "BondState",
    "Broken",
    "Client",
    "ContactEvent",
    "ContactWatch",
    "Contacts",
    "Diagnosis",
    "Edit",
    "Energy",
    "ForceCost",
    "ForceProfile",
    "Hand",
    "IslandReport",
    "JointCoordinate",
    "MassProperties",
    "Part",
    "ParticleBatch",
    "Recording",
    "RestructureReport",
    "RunSummary",
    "Solid",
    "Solution",
    "StepReport",
    "StepTimes",
    "StopEvent",
]
