# SPDX-License-Identifier: Apache-2.0
"""The pages that show a World: their address, modules of the script, recordings of what they show."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Literal

from iota.world import options as run_options
from iota.world.callbacks import print_on_terminal
from iota.world.client_modules import add_module
from iota.world.lan import Lan
from iota.world.parts import Part
from iota.world.publisher import Publisher
from iota.world.recording import LiveRecording
from iota.world.server import Server
from iota.world.state import State

ROLES = ("host", "guest", "viewer")
Call = Callable[[Callable[[], None]], None]  # calls a function on the thread that runs the world


class Pages(Part):
    """The pages that show the world: their address while it is served, the script's modules, recordings.

    world.pages.client_module("halo.js")
    """

    def __init__(self, state: State, call: Call) -> None:
        self._state, self._call = state, call
        self._publisher: Publisher | None = None  # while the world is served
        self._modules: list[Path] = []
        self._recordings: list[LiveRecording] = []

    @property
    def url(self) -> str | None:
        """The page's address, with its token, while it is served."""
        return None if self._publisher is None else self._publisher.url

    @property
    def lan_url(self) -> str | None:
        """Address of the page for other machines; None while it is not served with lan."""
        return None if self._publisher is None else self._publisher.lan_url

    def link(self, role: Literal["host", "guest", "viewer"], lan: bool = False) -> str | None:
        """An address of the page for somebody. A host may do everything, as with `url`; a guest may touch, but not pause, reset, change
        the speed or send others away; a viewer only watches. lan: for other machines. None while it is not served so.

        print(world.pages.link("guest", lan=True))
        """
        if role not in ROLES:
            raise ValueError(f"role must be {', '.join(ROLES[:-1])} or {ROLES[-1]}, not {role!r}")
        return self._link(role, lan)

    def _link(self, role: str, lan: bool = False) -> str | None:
        url = self.lan_url if lan else self.url
        return None if self._publisher is None or url is None else self._publisher.link(url, role)

    def client_module(self, file: str | Path) -> None:
        """Lets pages load a JavaScript module (.js or .mjs, at most 4 MiB), before the world is served. A relative path is
        searched in the folder of the running script. The module finds the page in `iota`, which web/README.md
        describes. Only pages that know the token can read it. Raises FileNotFoundError, ValueError for other files.

        world.pages.client_module("halo.js")
        """
        if self._publisher is not None:
            raise RuntimeError("pages load modules when they open: call client_module before the world is served")
        add_module(self._modules, Path(file))

    def record(self, file: str | Path) -> LiveRecording:
        """Writes what pages show, with all that users do, to a file while the world is served, until `stop` of the result,
        its with block, or the world ends; `iota play` shows it. The file ends in .iota. If the process is killed, it plays
        up to then. If the disk is full, a card tells so and the world goes on. Raises ValueError for another ending,
        OSError for a file that cannot be written.

        with world.pages.record("lesson.iota"):
            world.run()
        """
        path = Path(file)
        if path.suffix.lower() != ".iota":
            raise ValueError(f"a recording must end in .iota, not {path.name!r}")

        def fail(text: str) -> None:
            print_on_terminal(f"iota: {text}\n")
            self._call(lambda: self._state.notices.send("The recording ended", text, level="warning", keep=True))

        try:
            recording = LiveRecording(path, fail)
        except OSError as error:
            raise OSError(f"{path} cannot be written: {error.strerror or error}") from None
        self._recordings.append(recording)
        if self._publisher is not None:
            recording.begin(self._publisher.room)
        return recording

    def _open(self, port: int, host: str, server: Server | None, id: str, lan: bool | Lan) -> None:
        """Serves the page, see `World.serve`."""
        if server is None:
            options = run_options.current()
            port = port if options.port is None else options.port
            self._publisher = Publisher.open(self._state, host, port, options.lan or lan, self._modules)
            return
        if self._modules:
            raise ValueError("a world with client modules needs a server of its own, as its page loads them")
        self._publisher = Publisher.join(self._state, server, id)

    def _begin_recordings(self) -> None:
        assert self._publisher is not None
        options = run_options.current()
        if options.record is not None:
            file, options.record = options.record, None  # of the first world that is served
            self.record(file)
        for recording in self._recordings:
            recording.begin(self._publisher.room)

    def _frame(self) -> None:
        """Sends what has changed."""
        assert self._publisher is not None
        self._publisher.frame()

    def _wake(self) -> None:
        """Ends the wait of the world's loop for input. May be used on any thread."""
        publisher = self._publisher
        if publisher is not None:
            publisher.room.wake()

    def _close(self) -> None:
        assert self._publisher is not None
        for recording in self._recordings:
            recording.stop()
        self._recordings.clear()
        self._publisher.close()
        self._publisher = None
