# SPDX-License-Identifier: Apache-2.0
"""The shared state of the parts of a world."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from iota._core import Body, System
from iota.looks import Looks
from iota.world.actions import Actions
from iota.world.clients import Clients
from iota.world.clock import Clock
from iota.world.costs import Costs
from iota.world.listeners import Listeners
from iota.world.notices import Notices
from iota.world.pictures import Pictures
from iota.world.scene import Camera, Scene, Static
from iota.world.step_costs import StepCosts
from iota.world.things import Things

TIES = ("spring", "rope", "rod")  # drawn between two points, by classes of these names


@dataclass
class State:
    """The state of a world: simulator, looks, timing, clients."""

    system: System
    clock: Clock
    title: str
    style: str | None = None  # of pages at first
    ground: float | None = 0.0  # m
    camera: Camera | None = None
    statics: list[Static] = field(default_factory=list)
    actions: Actions = field(default_factory=Actions)
    things: Things = field(default_factory=Things)
    listeners: Listeners = field(default_factory=Listeners)
    pictures: Pictures = field(default_factory=Pictures)
    notices: Notices = field(default_factory=Notices)
    costs: Costs = field(default_factory=Costs)
    client_modules: list[Path] = field(default_factory=list)
    shows_edits: bool = True  # by effects
    step_ms: float = 0.0  # of a step, smoothed
    is_changed: bool = True  # pages need more than new poses

    _usual_thickness: float | None = None

    def __post_init__(self) -> None:
        self.scene = Scene()
        self.clients = Clients(self.system)
        self.step_costs = StepCosts(self.costs)

    def thickness_of(self, body: Body) -> float:
        """Radius of the look of a body of particles, m; the page's default without a look."""
        thickness = self.scene.thickness_of(body)
        if thickness is not None:
            return thickness
        return self.usual_thickness if len(body.particles) > 1 else 2 * self.usual_thickness

    @property
    def usual_thickness(self) -> float:
        """Radius of rods without a look, m."""
        if self._usual_thickness is None:
            self._usual_thickness = usual_thickness(self.system)
        return self._usual_thickness

    @property
    def styles(self) -> list[str]:
        """The names of styles that looks are given for, in the order of their first use."""
        return list(dict.fromkeys(name for looks in self.scene.classes.values() for name in looks if name != "*"))

    def forget_holds(self) -> None:
        """Call it after the system was restored: ends all holds."""
        self.clients.forget()
        self.listeners.take_away("reset")
        self.is_changed = True

    def class_of(self, looks: Looks) -> str:
        """The name on pages of the class with these looks; creates it if there is none."""
        classes = self.scene.classes
        for name, known in classes.items():
            if known == looks and name not in TIES:
                return name
        name = f"class {len(classes) + 1}"
        classes[name] = looks
        return name


def usual_thickness(system: System) -> float:
    """Default radius of rods of this system, m, as in src/net/presenter.cpp: by their median length or the size of the
    scene."""
    places = system.positions
    lengths = sorted(
        abs(particles[1].position - particles[0].position)
        for body in system.bodies
        if not body.is_spark and len(particles := body.particles) == 2
    )
    middle = lengths[len(lengths) // 2] if lengths else 0.0
    extent = float(np.linalg.norm(np.ptp(places, axis=0))) if len(places) else 0.0
    return 0.06 * middle or 0.02 * extent or 0.03
