# SPDX-License-Identifier: Apache-2.0
"""Publishes a simulator: the engine's own system directly, any other one through its `Simulator` interface."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from typing import Any

from iota._core import Room, System, Vec3
from iota._protocol import Id
from iota.simulator import Simulator
from iota.world import simulated


class Source(ABC):
    """Sends the state of a simulator."""

    @abstractmethod
    def publish(self, room: Room, shows_edits: bool) -> None:
        """Sends present poses and changes, and the effects of edits if they are shown."""

    @abstractmethod
    def bodies_of(self, room: Room, ids: Sequence[Id]) -> list[Any]:
        """The bodies with these ids that still exist, each once."""


class EngineSource(Source):
    """The engine's own system: its data go to the server without Python."""

    def __init__(self, system: System) -> None:
        self._system = system

    def publish(self, room: Room, shows_edits: bool) -> None:
        room.publish(self._system, effects=shows_edits)

    def bodies_of(self, room: Room, ids: Sequence[Id]) -> list[Any]:
        return room.bodies_of(ids, self._system)


class SimulatorSource(Source):
    """A simulator of the script."""

    def __init__(self, simulator: Simulator) -> None:
        self._simulator = simulator
        self._scene_version = -1

    def publish(self, room: Room, shows_edits: bool) -> None:
        simulator = self._simulator
        for kind, place in simulator.take_edits():
            if shows_edits:
                room.effect(kind, place)
        is_changed = room.needs_all or simulator.scene_version != self._scene_version
        self._scene_version = simulator.scene_version
        slots, places = simulator.poses()
        room.publish_simulated(
            simulated.describe(simulator) if is_changed else None,
            slots,
            places,
            [(c, h, b, Vec3(*point), Vec3(*target), f) for c, h, b, point, target, f in simulator.holds()],
            step=simulator.step_count,
            time=simulator.time,
            structure_version=simulator.structure_version,
            energy=simulator.energy,
            gap=simulator.worst_gap,
            extent=simulated.extent(simulator) if is_changed else 0.0,
        )

    def bodies_of(self, room: Room, ids: Sequence[Id]) -> list[Any]:
        bodies = [self._simulator.body_at(slot) for slot in room.slots_of(ids)]
        return [body for body in bodies if body is not None]


def source_of(system: System | Simulator) -> Source:
    return EngineSource(system) if isinstance(system, System) else SimulatorSource(system)
