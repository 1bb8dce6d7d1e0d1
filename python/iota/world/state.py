# SPDX-License-Identifier: Apache-2.0
"""The state that the loop of a world, its parts and its pages share."""

from __future__ import annotations

from dataclasses import dataclass, field

from iota._core import System
from iota.world.actions import Actions
from iota.world.clients import Clients
from iota.world.clock import Clock
from iota.world.costs import Costs
from iota.world.history import History
from iota.world.levels import Levels
from iota.world.listeners import Listeners
from iota.world.notices import Notices
from iota.world.pictures import Pictures
from iota.world.scene import Scene
from iota.world.schedule import Schedule
from iota.world.step_costs import StepCosts
from iota.world.things import Things
from iota.world.visuals import Visuals


@dataclass
class State:
    """The objects of a world, each with its own state. step_ms: length of a step, smoothed. kept_picture: of the world that goes
    on after an earlier process, a PNG file; empty without one."""

    system: System
    title: str
    clock: Clock
    scene: Scene
    schedule: Schedule
    visuals: Visuals
    things: Things
    costs: Costs
    actions: Actions = field(default_factory=Actions)
    listeners: Listeners = field(default_factory=Listeners)
    pictures: Pictures = field(default_factory=Pictures)
    notices: Notices = field(default_factory=Notices)
    levels: Levels | None = None
    step_ms: float = 0.0
    kept_picture: bytes = b""

    def __post_init__(self) -> None:
        self.clients = Clients(self.system, self.clock)
        self.history = History(self.system, self.clients)
        self.step_costs = StepCosts(self.costs)

    @classmethod
    def of(cls, system: System, title: str, dt: float, style: str | None, ground: float | None) -> State:
        visuals, things, schedule, costs = Visuals(), Things(), Schedule(), Costs()
        clock = Clock(dt, system, schedule, costs)
        scene = Scene(system, visuals, style, ground)
        return cls(system, title, clock, scene, schedule, visuals, things, costs)

    @property
    def has_news(self) -> bool:
        """Whether the next frame has to be sent although there was neither a step nor an input."""
        return self.things.has_news or self.listeners.has("frame")

    @property
    def version(self) -> tuple[int, ...]:
        """Another one if pages need more than new poses and things."""
        return self.visuals.version, self.actions.version, self.listeners.version
