# SPDX-License-Identifier: Apache-2.0
"""A room as `iota rooms` sees it: its socket, its process, and what becomes of them.

The socket outlives the process: who connects while there is none waits in its queue, and wakes the room. A process that was
started by an earlier `iota rooms` has the socket for itself; it is known by its lock, and the socket is opened again when it has ended.
"""

from __future__ import annotations

import os
import signal
import socket
import subprocess
import time
from collections import deque
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from iota import studies
from iota._core import Room as Card
from iota.processes import wait_or_kill
from iota.rooms.folder import RoomFolder, Settings, Told, owner, try_lock, write_owner
from iota.rooms.nursery import Nursery, Nursling
from iota.rooms.room import RoomOptions
from iota.world import Server
from iota.world.lan import Lan

PATIENCE = 5.0  # s, within which a process has to end
START = 60.0  # s, within which it has to serve
CARD = 15.0  # s, for which visitors of a room that cannot begin are told why
AGAIN = 5.0  # s, between two attempts to open a port
MOST_DEATHS, IN_TIME = 30, 600.0  # s; after more deaths than that a room is not started again
SILENT = 15.0  # s, after which a world that tells nothing hangs
QUEUE = 128


@dataclass
class HostOptions:
    """The options of all rooms. host: the address to listen on. leave: s without a visitor, after which a room sleeps. lan: as of
    `iota run`. public_origin: of a proxy. gateway: as of `Server`. ends_with_parent: a room ends with the process that started
    it, as the next one may be on another machine."""

    host: str
    leave: float
    lan: Lan | None = None
    public_origin: str = ""
    gateway: str = ""
    ends_with_parent: bool = False

    def words(self) -> list[str]:
        """For `iota run`."""
        if self.lan is None:
            return []
        files = ["--cert", str(self.lan.cert), "--key", str(self.lan.key)] if self.lan.cert is not None else []
        return ["--lan", *files]


class RoomProcess:
    """trouble: why it does not run, in one line; empty if it could."""

    def __init__(self, folder: RoomFolder, settings: Settings, options: HostOptions, nursery: Nursery) -> None:
        self.folder, self.settings, self._options, self._nursery = folder, settings, options, nursery
        self.told: Told | None = None
        self.trouble = ""
        self.restarts = 0
        self.begins_anew = False
        self._told_version: tuple[int, int] | None = None
        self._told_at = self._began = 0.0
        self._listener: socket.socket | None = None
        self._listen_at = 0.0
        self._process: subprocess.Popen[bytes] | Nursling | None = None
        self._last_process: int | None = None  # that was started here
        self._adopted: int | None = None  # the number of a process of an earlier `iota rooms`
        self._own_end = -1  # of the pipe that ends the process with this one
        self._is_asked = False
        self._deaths: deque[float] = deque()
        self._card: tuple[Server, Card, float] | None = None
        self._adopt()

    # --- what it is ----------------------------------------------------------------------------------------------------

    @property
    def has_process(self) -> bool:
        return self._process is not None or self._adopted is not None

    @property
    def number(self) -> int | None:
        """The number of the process."""
        return self._adopted if self._process is None else self._process.pid

    @property
    def is_listening(self) -> bool:
        """Whether a visitor who connects now is let in, perhaps after a moment."""
        return self._listener is not None and not self.settings.is_closed

    @property
    def serves(self) -> bool:
        told = self.told
        return self.has_process and told is not None and told.process == self.number and not told.is_over

    @property
    def people(self) -> list[tuple[str, str]]:
        return self.told.people if self.serves and self.told is not None else []

    @property
    def state(self) -> str:
        """closed, failed, starting, running, hanging or asleep."""
        if self.has_process:
            if self._is_asked:
                return "ending"
            if not self.serves:
                return "starting"
            return "hanging" if time.monotonic() - self._told_at > SILENT else "running"
        if self.settings.is_closed:
            return "closed"
        return "failed" if self.trouble else "asleep"

    # --- what becomes of it --------------------------------------------------------------------------------------------

    def look(self, now: float) -> None:
        """Between two calls of `wake`."""
        self._read_told(now)
        if self.has_process:
            self._look_at_process(now)
        elif self._card is not None and now - self._card[2] > CARD:
            self._end_card()
        elif self._listener is None and not self.settings.is_closed and now >= self._listen_at:
            self._listen(now)

    @property
    def bell(self) -> socket.socket | None:
        """The socket at which a visitor would wake it."""
        can_wake = not (self.has_process or self.settings.is_closed) and self._card is None
        return self._listener if can_wake else None

    def wake(self) -> None:
        """Starts its process. Failures are told in `trouble`."""
        if self._listener is None or self.has_process:
            return
        try:
            self._start(self._listener)
        except (OSError, RuntimeError) as error:  # such as too many processes, a full disk
            self._fail(str(error))

    def close(self) -> None:
        """Visitors are not let in until `open`. Raises OSError."""
        self._set_closed(True)
        self._end_card()
        self.ask_to_end()
        self._stop_listening()

    def open(self) -> None:
        """Raises OSError."""
        self._set_closed(False)
        self.trouble, self._listen_at = "", 0.0
        self._end_card()
        self._deaths.clear()

    def begin_anew(self) -> None:
        """With the start of its script, at the next visit. The world before is put aside. Raises OSError."""
        self.begins_anew = True
        if not self.settings.is_closed:
            self.open()
        self.ask_to_end()

    def ask_to_end(self) -> None:
        if self.has_process and not self._is_asked:
            self._is_asked = True
            self._signal(signal.SIGTERM)

    def end(self) -> None:
        """A process that hangs is killed."""
        self.ask_to_end()
        end = time.monotonic() + PATIENCE
        self._adopt_lost()
        if self._process is not None:
            wait_or_kill(self._process, PATIENCE)
            self._process = None
        while self._adopted is not None and self._is_locked():
            if time.monotonic() > end:
                self._signal(signal.SIGKILL)
            time.sleep(0.02)
        self._adopted, self._is_asked = None, False
        self._end_card()
        self._stop_listening()

    def _set_closed(self, is_closed: bool) -> None:
        if self.settings.is_closed != is_closed:
            changed = Settings(**{**vars(self.settings), "is_closed": is_closed})
            self.folder.write(changed)
            self.settings = changed

    def _adopt(self) -> None:
        if self._options.ends_with_parent or not self._is_locked():
            return
        self._adopted = owner(self.folder.lock)
        self._began = time.monotonic()

    def _adopt_lost(self) -> None:
        if isinstance(self._process, Nursling) and self._process.is_lost:
            self._adopted, self._process = self._process.pid, None

    def _is_locked(self) -> bool:
        with suppress(OSError):
            handle = try_lock(self.folder.lock)
            if handle is None:
                return True
            os.close(handle)
        return False

    def _read_told(self, now: float) -> None:
        version = self.folder.told_version()
        if version != self._told_version:
            self._told_version, self._told_at = version, now
            self.told = self.folder.told() or self.told
            if self.serves:
                self.trouble = ""

    def _look_at_process(self, now: float) -> None:
        code: int | None = None
        self._adopt_lost()
        if self._process is not None:
            code = self._process.poll()
            is_over = code is not None
        else:
            is_over = not self._is_locked()
        if is_over:
            self._process = self._adopted = None
            self._ended(code, now)
        elif self._is_asked:
            if now - self._began > PATIENCE:
                self._signal(signal.SIGKILL)
        elif not self.serves and now - self._began > START:
            self._fail(f"it served no page within {START:.0f} s")
            self._signal(signal.SIGKILL)

    def _ended(self, code: int | None, now: float) -> None:
        """code: None for one that was not started here."""
        if self._own_end >= 0:
            os.close(self._own_end)
            self._own_end = -1
        self._read_told(now)
        was_asked, self._is_asked = self._is_asked, False
        told = self.told
        if was_asked or code == 0 or (told is not None and told.is_over):
            return
        if self.trouble:
            self._show_card()
            return
        if code is not None and code > 0 and (told is None or told.process != self._last_process):
            self._fail(self.folder.last_words() or f"its process ended with exit code {code}")
            return
        self.restarts += 1
        self._deaths.append(now)
        while self._deaths and now - self._deaths[0] > IN_TIME:
            self._deaths.popleft()
        if len(self._deaths) > MOST_DEATHS:
            self._fail(f"its process ended {len(self._deaths)} times within {IN_TIME / 60:.0f} minutes, {how(code)}")
            self._deaths.clear()
        elif told is not None and told.people:  # they come back by themselves; others wake it
            self._listen(now)
            self.wake()

    def _listen(self, now: float) -> None:
        if self._listener is not None:
            return
        listener = socket.socket(socket.AF_INET, socket.SOCK_STREAM)
        try:
            listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            listener.bind((self._options.host, self.settings.port))
            listener.listen(QUEUE)
        except OSError as error:
            listener.close()
            self.trouble = f"port {self.settings.port} cannot be opened ({error.strerror}); it is tried again"
            self._listen_at = now + AGAIN
            return
        listener.setblocking(False)
        self._listener = listener
        if self.trouble.startswith("port "):
            self.trouble = ""

    def _stop_listening(self) -> None:
        if self._listener is not None:
            self._listener.close()
            self._listener = None

    def _start(self, listener: socket.socket) -> None:
        lock = try_lock(self.folder.lock)
        if lock is None:
            self._adopt()
            return
        try:
            log = self.folder.open_log()
            try:
                self._process = self._spawn(listener.fileno(), lock, log)
            finally:
                os.close(log)
            write_owner(lock, self._process.pid)
        finally:
            os.close(lock)  # the process has it, too
        self._last_process = self._process.pid
        self._began, self.begins_anew, self._is_asked = time.monotonic(), False, False

    def _spawn(self, listener: int, lock: int, log: int) -> subprocess.Popen[bytes] | Nursling:
        what, options = self.settings.what, self._options
        parent, own_end = os.pipe() if options.ends_with_parent else (-1, -1)
        folder = str(self.folder.path.resolve())
        told = RoomOptions(folder, listener, options.leave, options.public_origin, options.gateway, parent)
        words = ["run", what, "--no-open", "--room", told.to_text(), *options.words()]
        words += ["--fresh"] if self.begins_anew else []
        place = (self.folder.path if what in studies.names() else Path(what).parent).resolve()
        files = [listener, lock, *([parent] if parent >= 0 else [])]
        try:
            started = self._nursery.make(words, place, self.folder.name, log, files)
        except BaseException:
            if own_end >= 0:
                os.close(own_end)
            raise
        finally:
            if parent >= 0:
                os.close(parent)
        self._own_end = own_end
        return started

    def _signal(self, number: signal.Signals) -> None:
        if self._process is not None:
            self._process.send_signal(number)
        elif self._adopted is not None and self._is_locked():
            with suppress(ProcessLookupError):
                os.kill(self._adopted, number)
        if number == signal.SIGTERM:
            self._began = time.monotonic()  # from now on it has to end

    def _fail(self, why: str) -> None:
        self.trouble = why
        if not self.has_process:
            self._show_card()

    def _show_card(self) -> None:
        """Tells visitors for a while; the next one after that tries again."""
        if self._listener is None or self._card is not None or self.settings.is_closed:
            return
        options = self._options
        try:
            server = Server(
                options.host,
                self.settings.port,
                lan=options.lan or False,
                token=self.settings.token,
                listener=os.dup(self._listener.fileno()),
                public_origin=options.public_origin,
                gateway=options.gateway,
            )
        except OSError:
            return
        name = self.folder.name
        self._card = server, server.open_card(name, f"{name} cannot be shown", self.trouble), time.monotonic()

    def _end_card(self) -> None:
        if self._card is not None:
            self._card[0].close()
            self._card = None


def how(code: int | None) -> str:
    """How a process ended, as the end of a sentence."""
    if code is None or code >= 0:
        return "at last with an error" if code else "at last for a reason that is not known"
    return f"at last by {signal.Signals(-code).name}"
