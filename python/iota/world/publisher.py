# SPDX-License-Identifier: Apache-2.0
"""Sends a World to its viewers: what is there, how it looks, where it is."""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from iota._core import Particle, Server, System, Vec3
from iota.simulator import Simulator
from iota.world import page, ties
from iota.world.callbacks import Hook
from iota.world.scene import fitting_camera

if TYPE_CHECKING:
    from iota.world.world import World

LEVELS = {"info": 0, "warning": 1, "error": 2}


@dataclass
class Action:
    """What a key, a controller button or the panel does."""

    name: str
    hook: Hook
    key: str | None
    button: str | None
    help: str
    label: str
    on: str

    def describe(self) -> dict[str, str | None]:
        """As the page's scene names it."""
        names = ("name", "key", "label", "help", "on", "button")
        return {name: getattr(self, name) for name in names}


@dataclass
class Effect:
    """A flash that is due at a simulated time: at a particle, or at a place where that is gone."""

    time: float
    kind: str
    place: Vec3
    particle: Particle | None

    def position(self) -> Vec3:
        return self.particle.position if self.particle is not None and self.particle.alive else self.place


@dataclass
class Publisher:
    """A server and what it was told already: only what changed is sent again."""

    world: World
    server: Server
    sent: dict[str, str] = field(default_factory=dict)
    scene_version: int = -1
    effects: list[Effect] = field(default_factory=list)

    @classmethod
    def open(cls, world: World, host: str, port: int) -> Publisher:
        """Listens. Raises OSError where the port is taken, PageMissingError where the page is not built."""
        folder = page.page_folder()
        server = Server(host=host, port=port, page_folder=str(folder), token=page.token(), dt=world.dt)
        world.system.watch_edits(True)
        return cls(world, server)

    def close(self) -> None:
        self.world.system.watch_edits(False)
        self.world.system.take_edits()

    def scene(self) -> None:
        """Everything but the poses, where it changed."""
        world = self.world
        system: System | Simulator = world.system
        classes, bodies = world._scene.describe()
        self._set("world", self._describe_world())
        self._set("classes", classes)
        self._set("statics", json.dumps(world.statics))
        self._set("actions", json.dumps([action.describe() for action in world._actions.values()]))
        self._set("bodies", bodies)
        self._set("ties", ties.describe(system))
        if isinstance(system, System):
            self.server.publish_structure(system)
        else:
            self.server.publish_structure(system.structure_version, list(system.body_articulates()))
        self.scene_version = system.scene_version

    def frame(self, dirty: bool) -> None:
        """One frame: poses, and before them what changed in the structure."""
        world = self.world
        system: System | Simulator = world.system
        if dirty or system.scene_version != self.scene_version:
            self.scene()
        self._send_effects(system)
        if isinstance(system, System):
            self.server.publish(system, paused=world.paused, speed=world.speed, step_ms=world.step_ms)
        else:
            slots, places = system.poses()
            holds = [(c, h, b, Vec3(*point), Vec3(*target), f) for c, h, b, point, target, f in system.holds()]
            self.server.publish_poses(
                slots,
                places,
                holds,
                step=system.step_count,
                time=system.time,
                structure_version=system.structure_version,
                energy=system.energy,
                gap=system.worst_gap,
                paused=world.paused,
                speed=world.speed,
                step_ms=world.step_ms,
            )

    def notice(self, level: str, title: str, text: str, hint: str, client: int) -> None:
        self.server.notice(client, LEVELS[level], title, text, hint)

    def _send_effects(self, system: System | Simulator) -> None:
        now = system.time
        for kind, place, delay, particle in system.take_edits():
            self.effects.append(Effect(now + delay, kind, place, particle))
        for effect in self.effects:
            if effect.time <= now:
                self.server.effect(effect.kind, effect.position())
        self.effects = [effect for effect in self.effects if effect.time > now]

    def _describe_world(self) -> str:
        world = self.world
        looks = list(dict.fromkeys(name for styles in world.classes.values() for name in styles if name != "*"))
        camera = world.camera or fitting_camera(world.system)
        description = {
            "title": world.title,
            "looks": looks,
            "look": world.default_look or (looks[0] if looks else None),
            "camera": {"position": list(camera.position), "target": list(camera.target)},
            "ground": world.ground,
            "dt": world.dt,
        }
        # The fitted camera is where the world was first seen from: later structures do not move it.
        world.camera = camera
        return json.dumps(description)

    def _set(self, key: str, text: str) -> None:
        if self.sent.get(key) != text:
            self.server.set_scene(key, text)
            self.sent[key] = text
