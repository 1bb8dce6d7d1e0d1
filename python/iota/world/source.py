# SPDX-License-Identifier: Apache-2.0
"""What is published of a simulator: of the engine's own system directly, of any other through its `Simulator` interface."""

from __future__ import annotations

from abc import ABC, abstractmethod

from iota._core import Server, System, Vec3
from iota.simulator import Simulator
from iota.world import ties
from iota.world.clock import Clock


class Source(ABC):
    """Sends what a simulator has to show."""

    @abstractmethod
    def send_structure(self, server: Server) -> None:
        """Which bodies there are and which hang together."""

    @abstractmethod
    def send_poses(self, server: Server, clock: Clock, step_ms: float) -> None:
        """Where everything is now."""

    @abstractmethod
    def ties(self) -> str:
        """JSON text of what ties bodies together."""


class EngineSource(Source):
    """The engine's own system: poses go from it to the server without Python."""

    def __init__(self, system: System) -> None:
        self._system = system

    def send_structure(self, server: Server) -> None:
        server.publish_structure(self._system)

    def send_poses(self, server: Server, clock: Clock, step_ms: float) -> None:
        server.publish(self._system, paused=clock.paused, speed=clock.speed, step_ms=step_ms)

    def ties(self) -> str:
        return ties.describe(self._system)


class SimulatorSource(Source):
    """A simulator of the script."""

    def __init__(self, simulator: Simulator) -> None:
        self._simulator = simulator

    def send_structure(self, server: Server) -> None:
        server.publish_structure(self._simulator.structure_version, list(self._simulator.body_articulates()))

    def send_poses(self, server: Server, clock: Clock, step_ms: float) -> None:
        simulator = self._simulator
        slots, places = simulator.poses()
        holds = [(c, h, b, Vec3(*point), Vec3(*target), f) for c, h, b, point, target, f in simulator.holds()]
        server.publish_poses(
            slots,
            places,
            holds,
            step=simulator.step_count,
            time=simulator.time,
            structure_version=simulator.structure_version,
            energy=simulator.energy,
            gap=simulator.worst_gap,
            paused=clock.paused,
            speed=clock.speed,
            step_ms=step_ms,
        )

    def ties(self) -> str:
        return "[]"


def source_of(system: System | Simulator) -> Source:
    return EngineSource(system) if isinstance(system, System) else SimulatorSource(system)
