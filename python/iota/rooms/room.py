# SPDX-License-Identifier: Apache-2.0
"""The process of a room, which is `iota run` with the hidden option --room.

It serves on a socket that `iota rooms` opened, and goes on if that ends. It tells who is there, and ends when nobody
has been there for long.
"""

from __future__ import annotations

import json
import os
import signal
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from iota.rooms.folder import RoomFolder, Told
from iota.world import Server, World
from iota.world.callbacks import print_error

LOOK = 0.5  # s, between two looks at who is there
TELL = 2.0  # s, after which everything is told anew
PATIENCE = 5.0  # s, to end in an orderly way


@dataclass
class RoomOptions:
    """The words of `iota rooms` to the process, as JSON. listener: a socket. leave: s without a visitor, after which it ends.
    public_origin: as of `Server`, with /PORT for the room. gateway: as of `Server`. parent: the end of a pipe; when the other
    end is closed, the room ends; -1: it outlives the process that started it."""

    folder: str
    listener: int
    leave: float
    public_origin: str = ""
    gateway: str = ""
    parent: int = -1

    def to_text(self) -> str:
        return json.dumps(asdict(self))

    @classmethod
    def from_text(cls, text: str) -> RoomOptions:
        return cls(**json.loads(text))


class RoomHere:
    """The room of this process. what: a study or the path of a script."""

    def __init__(self, options: RoomOptions) -> None:
        self.folder = RoomFolder(Path(options.folder))
        self._options, self._settings = options, self.folder.read()
        self._server: Server | None = None
        self._told = Told(os.getpid())
        self._is_over = threading.Event()
        self._watcher = threading.Thread(target=self._watch, name="iota-room", daemon=True)
        if options.parent >= 0:
            threading.Thread(target=self._end_with_parent, name="iota-parent", daemon=True).start()

    @property
    def what(self) -> str:
        return self._settings.what

    def make_server(self, host: str, port: int, **more: Any) -> Server:
        options = self._options
        self._server = Server(
            host,
            self._settings.port,
            **more,
            token=self._settings.token,
            listener=options.listener,
            public_origin=options.public_origin,
            gateway=options.gateway,
        )
        return self._server

    def begin(self, world: World) -> None:
        """The world is served."""
        if self._server is not None and not self._watcher.is_alive():
            self._world = world
            self._told.title = world.title
            self._told.time = world.system.time
            self._tell()
            self._watcher.start()

    @contextmanager
    def ending_in_order(self) -> Iterator[None]:
        """Unless there is an error, nobody has to start the room again."""
        try:
            yield
        except KeyboardInterrupt:
            self._end()
            raise
        self._end()

    def _end(self) -> None:
        self._is_over.set()
        if self._watcher.is_alive():
            self._watcher.join(PATIENCE)
        self._told.is_over, self._told.people = True, []
        self._tell()

    def _watch(self) -> None:
        try:
            self._watch_until_over()
        except Exception as error:  # the world goes on, and nobody knows of its people
            print_error(error)

    def _watch_until_over(self) -> None:
        assert self._server is not None
        looked, empty_since = 0.0, time.monotonic()
        count = 0
        while not self._is_over.wait(LOOK):
            now, clients = time.monotonic(), self._server.statistics.clients
            if clients:
                empty_since = now
            if clients != count or now - looked > TELL:
                count, looked = clients, now
                self._world._inputs.call(self._look)
            if now - empty_since > self._options.leave:
                self._end_process()

    def _end_with_parent(self) -> None:
        with suppress(OSError):
            os.read(self._options.parent, 1)
        self._end_process()

    def _end_process(self) -> None:
        os.kill(os.getpid(), signal.SIGTERM)
        if not self._is_over.wait(PATIENCE):  # a callback hangs; the journal has all until then
            os._exit(1)

    def _look(self) -> None:
        """On the thread of the world."""
        state = self._world._state
        told = self._told
        told.time, told.title = state.system.time, state.title
        told.people = [(client.name, client.role) for client in state.clients.by_id.values()]
        told.step_seconds, told.reached_speed = state.step_ms / 1e3, state.clock.reached_speed
        self._tell()

    def _tell(self) -> None:
        with suppress(OSError):  # a full disk: the journal tells of it
            self.folder.tell(self._told)
