# SPDX-License-Identifier: Apache-2.0
"""Serves every study on one port. A study is built for its first visitor, and ends some time after the last one has
left."""

from __future__ import annotations

import json
import shutil
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from iota import studies
from iota._core import Room
from iota._protocol import Input, Join, Leave
from iota.world import Server, World
from iota.world.callbacks import one_line, print_error
from iota.world.page import page_folder

LEAVE = 15.0  # s without a visitor, after which a study ends
FIRST = ("chain", "ladder", "cradle", "undersea", "cloth", "playground", "physics-class", "fireworks")  # on the page
LOOK = 0.1  # s, between two checks for visitors


class WaitingRoom:
    """The room of a study that is not running yet. It keeps its visitors' input for the world that takes it over."""

    def __init__(self, room: Room) -> None:
        self._room = room
        self._seen: list[tuple[int, Input]] = []

    def __getattr__(self, name: str) -> Any:
        return getattr(self._room, name)

    def has_visitors(self) -> bool:
        self._seen += self._room.take_input()
        left = {client for client, message in self._seen if isinstance(message, Leave)}
        return any(isinstance(message, Join) and client not in left for client, message in self._seen)

    def take_input(self) -> list[tuple[int, Input]]:
        seen, self._seen = self._seen, []
        return seen + self._room.take_input()


class Gallery(Server):
    """A server with a room for each study. folder: with the gallery's page, see `make_folder`."""

    def __init__(self, folder: str | Path, port: int = 8080, names: list[str] | None = None) -> None:
        super().__init__(port=port, folder=folder)
        self._waiting = {name: WaitingRoom(super(Gallery, self).open(name)) for name in names or studies.names()}
        self._worlds: dict[str, World] = {}
        self._left: dict[str, float] = {}  # when a study was first found without visitors

    def open(self, world: str) -> Any:
        """The waiting room of a study."""
        return self._waiting.pop(world)

    @property
    def running(self) -> list[str]:
        """The running studies."""
        return list(self._worlds)

    def run(self, goes_on: Callable[[], bool] = lambda: True) -> None:
        """Runs until `goes_on` returns False."""
        try:
            while goes_on():
                self.look()
                time.sleep(LOOK)
        finally:
            for name in self.running:
                self._worlds.pop(name).stop()
            self.close()

    def look(self) -> None:
        """Starts studies with visitors, and ends those without."""
        for name, room in list(self._waiting.items()):
            if room.has_visitors():
                self._start(name, room)
        now = time.monotonic()
        for name, world in list(self._worlds.items()):
            if world.users.clients:
                self._left.pop(name, None)
            elif now - self._left.setdefault(name, now) > LEAVE:
                self._end(name)

    def _start(self, name: str, room: WaitingRoom) -> None:
        try:
            world = studies.module(name).build()
        except Exception as error:  # such as a missing package: the other studies continue
            print_error(error)
            room.notice(0, 2, f"{name} cannot be shown", one_line(error), "", True)
            room.take_input()
            return
        self._worlds[name] = world
        world.start(server=self, id=name)

    def _end(self, name: str) -> None:
        self._left.pop(name)
        self._worlds.pop(name).stop()
        self._waiting[name] = WaitingRoom(super().open(name))


def make_folder() -> tempfile.TemporaryDirectory[str]:
    """The page's folder with the gallery as index.html, and the page itself as world.html."""
    folder = tempfile.TemporaryDirectory(prefix="iota-gallery-")
    target = Path(folder.name)
    for file in page_folder().rglob("*"):
        place = target / file.relative_to(page_folder())
        if file.is_dir():
            place.mkdir()
            continue
        for name, other in (("index.html", "world.html"), ("gallery.html", "index.html")):
            if file.name.startswith(name):
                place = target / file.name.replace(name, other)
                break
        shutil.copyfile(file, place)
    shutil.copytree(studies.PICTURES, target / "studies")
    names = sorted(studies.names(), key=lambda name: FIRST.index(name) if name in FIRST else len(FIRST))
    described = [{"name": name, "text": studies.description(name)} for name in names]
    (target / "studies.json").write_text(json.dumps(described))
    return folder
