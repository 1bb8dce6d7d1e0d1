# SPDX-License-Identifier: Apache-2.0
"""Builders: structures as plain data, and their realization in a system."""

from iota.builder.actuators import ActuatorOnJoint
from iota.builder.chain import chain
from iota.builder.lines import ring, rope, snake
from iota.builder.parts import Actuator, Coupling, Joint, Place, RigidBody, SoftBond, Tie
from iota.builder.points import Points
from iota.builder.realized import PlaceOnBody, Realized
from iota.builder.sheets import cloth, leaf, net
from iota.builder.solids import bridge, cuboid, ladder, soft_block, tower, tree
from iota.builder.structure import Shift, Structure

__all__ = [
    "Actuator",
    "ActuatorOnJoint",
    "Coupling",
    "Joint",
    "Place",
    "PlaceOnBody",
    "Points",
    "Realized",
    "RigidBody",
    "Shift",
    "SoftBond",
    "Structure",
    "Tie",
    "bridge",
    "chain",
    "cloth",
    "cuboid",
    "ladder",
    "leaf",
    "net",
    "ring",
    "rope",
    "snake",
    "soft_block",
    "tower",
    "tree",
]
