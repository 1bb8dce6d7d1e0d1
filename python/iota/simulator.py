# SPDX-License-Identifier: Apache-2.0
"""The interface of a simulator for `World`, to replace `System` by another one.

`World` steps, draws, pauses and resets any class that derives from `Simulator`, and users grab its bodies.
docs/replaceable.md explains it; examples/python/explicit_particles.py is an example.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from iota._core import Energy, Solid, StepReport, System, Vec3

if TYPE_CHECKING:
    from numpy.typing import NDArray

Vector = Sequence[float] | Vec3


class SimulatedParticle:
    """A point of a body, for drawing."""

    alive = True

    def __init__(self, body: SimulatedBody, position: Vec3) -> None:
        self.body, self.position = body, position


class SimulatedBody:
    """A body that is drawn and can be grabbed. slot: its number on the page, unique at a time. generation:
    distinguishes successive bodies of one slot. name: shown on the page, at most 63 bytes."""

    generation = 1
    name = ""
    kind = "dynamic"  # or "static", "inactive"
    is_spark = False  # see `Body.is_spark`
    solids: Sequence[Solid] = ()  # its drawn shapes; without them its particles are drawn

    def __init__(self, system: Simulator, slot: int) -> None:
        self.system, self.slot = system, slot

    @property
    def pose(self) -> list[float]:
        """Center of mass (m) and unit quaternion x y z w: 7 numbers."""
        slots, places = self.system.poses()
        return [float(number) for number in places[list(slots).index(self.slot)]]

    @property
    def center_of_mass(self) -> Vec3:
        return Vec3(*self.pose[:3])

    @property
    def orientation(self) -> Vector:
        return self.pose[3:]

    @property
    def particles(self) -> list[SimulatedParticle]:
        """One is drawn as a sphere, two as a rod from the first to the second, more as rods from each to the next."""
        return [SimulatedParticle(self, self.center_of_mass)]

    @property
    def survivor(self) -> SimulatedBody | None:
        """Itself, or None once it is destroyed: then selections and holds of it end."""
        return self


class SimulatedGrip(ABC):
    """A user's hand on a body."""

    alive = True

    @abstractmethod
    def move(self, target: Vector) -> None:
        """Pulls towards a place in the world, m."""

    @abstractmethod
    def destroy(self) -> None:
        """Releases the body."""


class Simulator(ABC):
    """A simulator for `World`. Only four methods and `bodies` are required; the others have defaults that do nothing.

    All are called on the thread that runs the world. SI units, right-handed, y up.
    """

    time: float = 0.0  # s, simulated
    step_count: int = 0
    structure_version: int = 0  # increase it when bodies are created, destroyed, or change their look
    cosmetic_lines: Sequence[tuple[Any, Any]] = ()

    @property
    @abstractmethod
    def bodies(self) -> Sequence[SimulatedBody]:
        """All bodies, in a fixed order."""

    @abstractmethod
    def step(self, dt: float) -> StepReport:
        """Advances by dt seconds: StepReport(step=..., time=..., dt=..., energy=iota.types.Energy(...),
        warnings=[...])."""

    @abstractmethod
    def poses(self) -> tuple[NDArray[Any], NDArray[Any]]:
        """Drawn poses of bodies: slots (n,), and (n, 7): center of mass (m) and unit quaternion x y z w."""

    @abstractmethod
    def snapshot(self) -> Any:
        """All data that `restore` needs to return to this state."""

    @abstractmethod
    def restore(self, snapshot: Any) -> None:
        """Restores a snapshot: used by the page's reset."""

    # --- optional --------------------------------------------------------------------------------

    @property
    def energy(self) -> Energy:
        """Shown on the page."""
        return Energy()

    @property
    def scene_version(self) -> int:
        """Changes when a page's list of bodies does: see `System.scene_version`."""
        return self.structure_version

    @property
    def worst_gap(self) -> float:
        """m; shown on the page."""
        return 0.0

    def body_at(self, slot: int) -> SimulatedBody | None:
        """The body of a slot; None for an empty slot."""
        return next((body for body in self.bodies if body.slot == slot), None)

    def grip(self, body: SimulatedBody, local_point: Vector, target: Vector, client: int, hold: int) -> SimulatedGrip:
        """A hand grabs a body at a point of its drawn frame."""
        raise NotImplementedError(f"{type(self).__name__} has no hands")

    def holds(self) -> Iterable[tuple[int, int, int, Vector, Vector, float]]:
        """Hands for drawing: client, hold, the body's slot, held place (m), place of the hand (m), force (N)."""
        return ()

    def body_articulates(self) -> Iterable[tuple[int, int]]:
        """(slot, number of its articulate) of each body: equal for connected bodies."""
        return ((body.slot, body.slot) for body in self.bodies)

    @property
    def articulate_count(self) -> int:
        return len({articulate for _, articulate in self.body_articulates()})

    @property
    def positions(self) -> NDArray[np.float64]:
        """(n, 3), m: all particles, for the first camera."""
        return np.array([p.position for body in self.bodies for p in body.particles], float).reshape(-1, 3)

    def adopt(self) -> None:  # noqa: B027
        """Makes the calling thread the owner."""

    def take_edits(self) -> Sequence[tuple[str, Vec3]]:
        """Effects since the last call: kind ("join" or "break") and place."""
        return ()


Simulator.register(System)

__all__ = ["SimulatedBody", "SimulatedGrip", "SimulatedParticle", "Simulator"]
