# SPDX-License-Identifier: Apache-2.0
"""Sends a World to its viewers: what is there, how it looks, where it is."""

from __future__ import annotations

import json
from dataclasses import dataclass, field

from iota._core import Particle, Server, Vec3
from iota.world import page
from iota.world.scene import fitting_camera
from iota.world.source import source_of
from iota.world.state import State


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

    state: State
    server: Server
    sent: dict[str, str] = field(default_factory=dict)
    scene_version: int = -1
    effects: list[Effect] = field(default_factory=list)

    @classmethod
    def open(cls, state: State, host: str, port: int) -> Publisher:
        """Listens. Raises OSError where the port is taken, PageMissingError where the page is not built."""
        folder = page.page_folder()
        server = Server(host=host, port=port, page_folder=str(folder), token=page.token(), dt=state.clock.dt)
        state.system.watch_edits(True)
        state.notices.show = server.notice
        return cls(state, server)

    def __post_init__(self) -> None:
        self._source = source_of(self.state.system)

    def close(self) -> None:
        self.state.notices.show = None
        self.state.system.watch_edits(False)
        self.state.system.take_edits()

    def scene(self) -> None:
        """Everything but the poses, where it changed."""
        state = self.state
        classes, bodies = state.scene.describe()
        self._set("world", self._describe_world())
        self._set("classes", classes)
        self._set("statics", json.dumps(state.statics))
        self._set("actions", json.dumps([action.describe() for action in state.actions]))
        self._set("bodies", bodies)
        self._set("ties", self._source.ties())
        self._source.send_structure(self.server)
        self.scene_version = state.system.scene_version

    def frame(self) -> None:
        """One frame: poses, and before them what changed in the structure."""
        state = self.state
        if state.is_changed or state.system.scene_version != self.scene_version:
            self.scene()
            state.is_changed = False
        self._send_effects()
        self._source.send_poses(self.server, state.clock, state.step_ms)

    def _send_effects(self) -> None:
        system = self.state.system
        now = system.time
        for kind, place, delay, particle in system.take_edits():
            self.effects.append(Effect(now + delay, kind, place, particle))
        for effect in self.effects:
            if effect.time <= now:
                self.server.effect(effect.kind, effect.position())
        self.effects = [effect for effect in self.effects if effect.time > now]

    def _describe_world(self) -> str:
        state = self.state
        looks = list(dict.fromkeys(name for styles in state.scene.classes.values() for name in styles if name != "*"))
        camera = state.camera or fitting_camera(state.system)
        description = {
            "title": state.title,
            "looks": looks,
            "look": state.style or (looks[0] if looks else None),
            "camera": {"position": list(camera.position), "target": list(camera.target)},
            "ground": state.ground,
            "dt": state.clock.dt,
        }
        # The fitted camera is where the world was first seen from: later structures do not move it.
        state.camera = camera
        return json.dumps(description)

    def _set(self, key: str, text: str) -> None:
        if self.sent.get(key) != text:
            self.server.set_scene(key, text)
            self.sent[key] = text
