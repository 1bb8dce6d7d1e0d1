# SPDX-License-Identifier: Apache-2.0
"""Sends a World to its viewers: bodies, looks, poses."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import ExitStack
from functools import partial
from pathlib import Path
from typing import Any

from iota._core import Room, Vec3
from iota._protocol import Id
from iota.metrics import CONTENT_TYPE, of_process, text_of
from iota.world import options as run_options
from iota.world.client_modules import page_with
from iota.world.lan import Lan, announcement
from iota.world.metrics import of_world
from iota.world.scene import Camera
from iota.world.server import Server
from iota.world.source import source_of
from iota.world.state import State

KEPT_PICTURE = "/kept.png"


class Publisher:
    """A world's room on a server. The room sends only changes to viewers."""

    def __init__(self, state: State, server: Server, room: Room, is_alone: bool, modules: Sequence[str] = ()) -> None:
        self._state, self._server, self._is_alone = state, server, is_alone
        self._modules = list(modules)
        self._folder = ExitStack()  # of the page, if it is not the built one
        self._source = source_of(state.system)
        self._told: dict[str, dict[str, Any]] = {}
        self._version: tuple[int, ...] | None = None  # of the state that was told
        self.room = room
        self.url = server.url if is_alone else server.url_of(room.world)
        self.lan_url = server.lan_url("" if is_alone else room.world)
        state.notices.show, state.notices.forget = room.notice, room.forget_notice
        state.clients.send_pulse, state.clients.send_camera = room.pulse, self._tell_camera
        state.clients.send_away = room.send_away
        state.things.effect = room.effect
        state.visuals.tell_anew()
        state.things.tell_anew()

    @classmethod
    def open(cls, state: State, host: str, port: int, lan: bool | Lan, files: Sequence[Path]) -> Publisher:
        """Starts a server. files: modules of the script. Raises OSError if the port is in use, PageMissingError if the page is not built."""
        with ExitStack() as stack:
            folder: Path | None = None
            modules: list[str] = []
            if files:
                folder, modules = stack.enter_context(page_with(files))
            options = run_options.current()
            make_server, options.make_server = options.make_server or Server, None  # of the first world
            server = make_server(host, port, folder=folder, lan=lan)
            server.serve_requests(["/metrics", KEPT_PICTURE])
            publisher = cls(state, server, server.open("default"), is_alone=True, modules=modules)
            publisher._folder = stack.pop_all()
        return publisher

    @classmethod
    def join(cls, state: State, server: Server, id: str) -> Publisher:
        """Opens a world on a server, which may have others. Raises ValueError for an id in use."""
        return cls(state, server, server.open(id), is_alone=False)

    def announce_lan(self, shows_code: bool) -> list[str]:
        """Lines with addresses for other machines; empty if they are not served."""
        if self.lan_url is None or self._server.fingerprint is None:
            return []
        return announcement(self.lan_url, self._server.fingerprint, self._server.port, shows_code)

    def link(self, url: str, role: str) -> str:
        return self._server.link(url, role)

    def close(self) -> None:
        self._state.notices.show = self._state.notices.forget = None
        self._state.clients.send_pulse = self._state.clients.send_camera = self._state.clients.send_away = None
        self._state.things.effect = None
        self.room.close(self._state.system)
        if self._is_alone:
            self._server.close()
        self._folder.close()

    def frame(self) -> None:
        """Sends one frame: changes and poses."""
        state = self._state
        if self._version != state.version:
            self._version = state.version
            self._tell_settings()
        clock = state.clock
        self.room.set_state(
            paused=clock.paused,
            speed=clock.speed,
            step_ms=state.step_ms,
            dt=clock.dt,
            costs=list(state.step_costs.ms.items()),
            **self._budget(),
        )
        state.things.tell(self.room, state.system.structure_version, partial(state.notices.warn_once, keep=True))
        self._source.publish(self.room, state.scene.shows_edits)
        for text in self.room.take_warnings():
            state.notices.warn_once(text)
        self.answer_requests()

    def answer_requests(self) -> None:
        """For figures of the world, and the picture that it was kept with; only those who have a token come this far."""
        for request in self._server.take_requests() if self._is_alone else ():
            if request.path == KEPT_PICTURE:
                picture = self._state.kept_picture
                self._server.answer(request, picture, "image/png", status=200 if picture else 404)
                continue
            figures = of_world(self._state, self._server.statistics) + of_process()
            self._server.answer(request, text_of(figures).encode(), CONTENT_TYPE)

    def _budget(self) -> dict[str, Any]:
        """The budget of a step; for pages that show costs also the levels of things and their latest changes."""
        levels = self._state.levels
        if levels is None or (ms := levels._shown_ms) is None:
            return {}
        if not self._state.clients.is_profiled:
            return {"budget_ms": ms}
        groups, lines = levels._shown()
        return {"budget_ms": ms, "levels": groups, "changes": lines}

    def bodies_of(self, ids: Sequence[Id]) -> list[Any]:
        """The bodies with these ids that still exist, each once."""
        return self._source.bodies_of(self.room, ids)

    def _tell_settings(self) -> None:
        state = self._state
        scene, styles = state.scene, state.visuals.styles
        is_new = self._tell_if_new(
            "set_settings",
            title=state.title,
            styles=styles,
            style=scene.style or (styles[0] if styles else ""),
            camera=places_of(scene.camera),
            ground=scene.ground,
            modules=self._modules,
        )
        for client in state.clients.by_id.values() if is_new else ():
            if client.camera is not None:
                self._tell_camera(client.id, client.camera)
        listeners = state.listeners
        clicks, hovers, moves = (listeners.has(kind) for kind in ("click", "hover", "pointer"))
        self._tell_if_new("set_listens", clicks=clicks, hovers=hovers, moves=moves, keys=list(listeners.keys))
        self._tell_if_new("set_actions", actions=[action.describe() for action in state.actions])
        state.visuals.tell(self.room)
        for texture in state.visuals.textures():
            state.things.images.use(texture.name, texture)

    def _tell_camera(self, client: int, camera: Camera | None) -> None:
        """The settings of all with a client's own camera; None: with that of all."""
        told = self._told.get("set_settings")
        if told is not None:
            own = told if camera is None else told | {"camera": places_of(camera)}
            self.room.set_settings(**own, client=client)

    def _tell_if_new(self, setter: str, **values: Any) -> bool:
        """Whether they are new. Pages make their buttons anew at each message: a script that changes how things are drawn
        would take them away under the mouse."""
        if self._told.get(setter) == values:
            return False
        self._told[setter] = values
        getattr(self.room, setter)(**values)
        return True


def places_of(camera: Camera | None) -> tuple[Vec3, Vec3] | None:
    """The places of the camera and of its target."""
    return None if camera is None else (Vec3(*camera.position), Vec3(*camera.target))
