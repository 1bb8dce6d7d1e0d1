# SPDX-License-Identifier: Apache-2.0
"""What a World asks of the simulator that it runs: put another one in the place of `System`.

`World` drives anything that derives from `Simulator`: it is stepped, drawn, grabbed, paused and reset like the built-in
one. docs/replaceable.md tells how, with examples/python/explicit_particles.py as the worked example.
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
    """A point of a body, as drawing asks for it."""

    alive = True

    def __init__(self, body: SimulatedBody, position: Vec3) -> None:
        self.body, self.position = body, position


class SimulatedBody:
    """Something that is drawn and can be held. slot: its number on the page, used for one body at a time. generation: tells
    the bodies apart that have the same slot one after the other."""

    generation = 1
    kind = "dynamic"  # or "static", "inactive"
    is_spark = False  # see `Body.is_spark`
    solids: Sequence[Solid] = ()  # shapes that it is drawn as; without them it is drawn by its particles

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
        """Itself, or None once it is gone: what was selected or held is then let go."""
        return self


class SimulatedGrip(ABC):
    """A user's hand on a body."""

    alive = True

    @abstractmethod
    def move(self, target: Vector) -> None:
        """Pull towards a place in the world, m."""

    @abstractmethod
    def destroy(self) -> None:
        """Let go."""


class Simulator(ABC):
    """A simulator for `World`. Four methods and `bodies` are all that one needs; the rest has defaults that do nothing.

    All is called from the thread that runs the world. SI units, right-handed, y up.
    """

    time: float = 0.0  # s, simulated
    step_count: int = 0
    structure_version: int = 0  # raise it when bodies come, go, or change how they are drawn
    cosmetic_lines: Sequence[tuple[Any, Any]] = ()

    @property
    @abstractmethod
    def bodies(self) -> Sequence[SimulatedBody]:
        """What there is, in a fixed order."""

    @abstractmethod
    def step(self, dt: float) -> StepReport:
        """Advance by dt seconds: StepReport(step=..., time=..., dt=..., energy=iota.types.Energy(...), warnings=[...])."""

    @abstractmethod
    def poses(self) -> tuple[NDArray[Any], NDArray[Any]]:
        """Where bodies are drawn: slots (n,), and (n, 7): center of mass (m) and unit quaternion x y z w."""

    @abstractmethod
    def snapshot(self) -> Any:
        """All that `restore` needs to come back to this moment."""

    @abstractmethod
    def restore(self, snapshot: Any) -> None:
        """Back to a snapshot: the page's reset."""

    # --- what may be left as it is --------------------------------------------------------------------------------

    @property
    def energy(self) -> Energy:
        """Shown on the page."""
        return Energy()

    @property
    def scene_version(self) -> int:
        """What a page's list of bodies depends on: see `System.scene_version`."""
        return self.structure_version

    @property
    def worst_gap(self) -> float:
        """m; shown on the page."""
        return 0.0

    def body_at(self, slot: int) -> SimulatedBody | None:
        """The body that a user points at; None for a slot that is empty."""
        return next((body for body in self.bodies if body.slot == slot), None)

    def grip(self, body: SimulatedBody, local_point: Vector, target: Vector, client: int, hold: int) -> SimulatedGrip:
        """A hand takes a body at a point of its drawn frame."""
        raise NotImplementedError(f"{type(self).__name__} has no hands")

    def holds(self) -> Iterable[tuple[int, int, int, Vector, Vector, float]]:
        """Hands to be drawn: client, hold, the body's slot, where it is held (m), where the hand is (m), force (N)."""
        return ()

    def body_articulates(self) -> Iterable[tuple[int, int]]:
        """(slot, number of its articulate) of each body: equal for bodies that hang together."""
        return ((body.slot, body.slot) for body in self.bodies)

    @property
    def articulate_count(self) -> int:
        return len({articulate for _, articulate in self.body_articulates()})

    @property
    def positions(self) -> NDArray[np.float64]:
        """(n, 3), m: all particles, for the first camera."""
        return np.array([p.position for body in self.bodies for p in body.particles], float).reshape(-1, 3)

    def adopt(self) -> None:  # noqa: B027
        """The calling thread takes over."""

    def take_edits(self) -> Sequence[tuple[str, Vec3]]:
        """Flashes since the last call: kind ("join" or "break") and place."""
        return ()


Simulator.register(System)

__all__ = ["SimulatedBody", "SimulatedGrip", "SimulatedParticle", "Simulator"]
