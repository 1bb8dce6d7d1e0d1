# SPDX-License-Identifier: Apache-2.0
"""Rooms on the machines of a Ray cluster: `iota rooms --ray`.

An awake room is an actor of Ray, which runs its process on one of the machines. Ray places it by its processor time and memory, sees that
it or its machine has died, and starts it again on another one, where the journal in the shared folder has its world. The
actor is detached: it does not need `iota rooms`, and the next one finds it by its name.
"""

from __future__ import annotations

import hashlib
import select
import threading
import time
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any
from urllib.parse import urlencode

from iota.arguments import SHORT
from iota.journal.folder import Folder
from iota.machines import NAMESPACE, ray_at
from iota.rooms.folder import RoomFolder, Settings, Told
from iota.rooms.nursery import Nursery
from iota.rooms.process import CARD, HostOptions, RoomProcess

LOOK = 0.05  # s, between two looks of an actor at its process
ASK = 0.25  # s, between two questions to an actor
RELAXED = 1.0  # s, between them while the room runs
SILENT = 2.0  # s, after which an actor that does not answer is taken for one that Ray starts again
SCARCE = 10.0  # s, after which an actor that has no machine is told of
IDLE = 20.0  # s, after which the actor of a room that sleeps or has failed is ended
PATIENCE = 15.0  # s, for the actor to end its process in
MOST = 1e14  # cores, and bytes, of a room: Ray counts ten-thousandths in 64 bits, and places whatever overflows


@dataclass
class Cluster:
    """A connection to Ray. cores, memory: of one room, in cores and bytes, by which Ray places it."""

    cores: float
    memory: float
    host: str
    """This machine's address in the cluster."""

    @classmethod
    def connect(cls, address: str, cores: float, memory: float) -> Cluster:
        """address: of a Ray cluster, "auto": the one that this machine belongs to. Raises ConnectionError, ValueError."""
        if max(cores, memory) > MOST:
            raise ValueError(f"a room takes at most {MOST:g} cores and {MOST:g} bytes, not {cores:g} and {memory:g}")
        ray = ray_at(address)
        return cls(cores, memory, ray.util.get_node_ip_address())


@dataclass
class Report:
    """An actor tells this of its room. host: of the machine that it is on."""

    state: str
    serves: bool
    is_listening: bool
    told: Told | None
    trouble: str
    restarts: int
    host: str


class Keeper:
    """The actor: runs the process of a room on its machine."""

    def __init__(self, path: str, options: HostOptions) -> None:
        import ray

        self._host = ray.util.get_node_ip_address()
        folder = RoomFolder(Path(path))
        self._nursery = Nursery()  # a room that was killed comes back without loading the package
        options = replace(options, host="0.0.0.0" if options.lan else self._host)
        self._room = RoomProcess(folder, folder.read(), options, self._nursery)
        self._lock = threading.Lock()
        self._is_over = False
        self._thread = threading.Thread(target=self._run, name="iota-keeper", daemon=True)
        self._thread.start()

    def report(self) -> Report:
        with self._lock:
            room = self._room
            return Report(
                room.state,
                room.serves,
                room.is_listening,
                room.told if room.serves else None,
                room.trouble,
                room.restarts,
                self._host,
            )

    def end(self) -> None:
        """Ends the process in an orderly way."""
        with self._lock:
            self._is_over = True
            self._room.end()
            self._nursery.close()

    def _run(self) -> None:
        is_wanted = True  # it is made for a visitor, or made again by Ray after its machine has died
        while not self._is_over:
            with self._lock:
                room = self._room
                room.look(time.monotonic())
                if is_wanted and room.bell is not None:
                    room.wake()
                    is_wanted = not (room.has_process or room.trouble)
                bell = room.bell
            if bell is None:
                time.sleep(LOOK)
                continue
            with suppress(OSError, ValueError):  # closed meanwhile
                if select.select([bell], [], [], LOOK)[0]:
                    with self._lock:
                        room.wake()
            if is_wanted:
                time.sleep(LOOK)


class RoomActor:
    """A room as `iota rooms --ray` sees it: like `RoomProcess`, but on another machine. trouble: why it does not run."""

    def __init__(self, folder: RoomFolder, settings: Settings, options: HostOptions, cluster: Cluster) -> None:
        import ray

        self.folder, self.settings = folder, settings
        self.trouble = ""
        self._ray: Any = ray
        self._options, self._cluster = options, cluster
        self._report: Report | None = None
        self._answer: Any = None
        self._ending: Any = None
        self._asked_at = self._ask_at = self._since = self._idle_since = 0.0
        self._restarts = 0
        self._actor: Any = None
        with suppress(ValueError):  # there is none
            self._actor = ray.get_actor(self._name, NAMESPACE)
            self._since = time.monotonic()

    @property
    def _name(self) -> str:
        place = hashlib.sha256(str(self.folder.path.resolve()).encode()).hexdigest()[:16]
        return f"room {self.folder.name} {place}"

    # --- what it is ----------------------------------------------------------------------------------------------------

    @property
    def bell(self) -> None:
        """Visitors wake it by its link, which leads to `iota rooms`."""
        return None

    @property
    def serves(self) -> bool:
        return self._report is not None and self._report.serves

    @property
    def told(self) -> Told | None:
        return self.folder.told() if self._report is None else self._report.told

    @property
    def people(self) -> list[tuple[str, str]]:
        told = None if self._report is None else self._report.told
        return [] if told is None else told.people

    @property
    def restarts(self) -> int:
        return self._restarts + (0 if self._report is None else self._report.restarts)

    @property
    def state(self) -> str:
        if self._ending is not None:
            return "ending"
        if self._actor is None:
            return "closed" if self.settings.is_closed else "failed" if self.trouble else "asleep"
        return "starting" if self._report is None else self._report.state

    def url(self, token: str) -> str:
        """The address at which the room serves now; empty if it does not yet."""
        report, options = self._report, self._options
        if report is None or self._ending is not None or not report.is_listening:
            return ""
        port = self.settings.port
        if options.public_origin:
            base = f"{options.public_origin}/{report.host}/{port}/"
        else:
            base = f"{'http' if options.lan is None else 'https'}://{report.host}:{port}/"
        return f"{base}?{urlencode({'token': token, 'rooms': options.gateway, 'room': self.folder.name})}"

    # --- what becomes of it --------------------------------------------------------------------------------------------

    def look(self, now: float) -> None:
        """Takes the answer of the actor, if there is one, and asks again. Never waits."""
        if self._ending is not None:
            self._look_at_end(now)
        elif self._actor is not None:
            if self._answer is not None:
                self._take(now)
            if self._actor is not None and self._answer is None and now >= self._ask_at:
                self._answer = self._actor.report.remote()
                self._asked_at = now
                self._ask_at = now + (RELAXED if self.state == "running" else ASK)

    def wake(self) -> None:
        """Failures are told in `trouble`."""
        now = time.monotonic()
        if self._actor is not None or self._ending is not None or self.settings.is_closed:
            return
        if self.trouble and now - self._since < CARD:
            return
        self.trouble, self._since = "", now
        try:
            self._actor = (
                self._ray.remote(Keeper)
                .options(
                    name=self._name,
                    namespace=NAMESPACE,
                    get_if_exists=True,
                    lifetime="detached",
                    max_restarts=-1,
                    num_cpus=self._cluster.cores,
                    memory=self._cluster.memory,
                    scheduling_strategy="SPREAD",
                    max_concurrency=2,
                )
                .remote(str(self.folder.path.resolve()), replace(self._options, ends_with_parent=True))
            )
        except Exception as error:  # of Ray
            self.trouble = f"Ray does not start it: {SHORT.repr(str(error))}"
            return
        self._ask_at = self._idle_since = 0.0

    def close(self) -> None:
        """Visitors are not let in until `open`. Raises OSError."""
        self._set_closed(True)
        self.ask_to_end()

    def open(self) -> None:
        """Raises OSError."""
        self._set_closed(False)
        self.trouble = ""

    def begin_anew(self) -> None:
        """With the start of its script, at the next visit. The world before is put aside. Raises OSError."""
        self.end()
        self.trouble = ""
        journal = Folder(self.folder.journal)
        journal.lock()
        try:
            journal.put_aside(journal.files())
        finally:
            journal.unlock()

    def ask_to_end(self) -> None:
        if self._actor is not None and self._ending is None:
            self._ending = self._actor.end.remote()
            self._since = time.monotonic()

    def end(self) -> None:
        self.ask_to_end()
        if self._ending is not None:
            self._ray.wait([self._ending], timeout=self._patience())
            self._forget()

    def _set_closed(self, is_closed: bool) -> None:
        if self.settings.is_closed != is_closed:
            changed = replace(self.settings, is_closed=is_closed)
            self.folder.write(changed)
            self.settings = changed

    def _take(self, now: float) -> None:
        ready, _ = self._ray.wait([self._answer], timeout=0)
        if not ready:
            if self._report is not None and now - self._asked_at > SILENT:
                self._lose(now)
            self._tell_of_waiting(now)
            return
        answer, self._answer = self._answer, None
        exceptions = self._ray.exceptions
        try:
            self._report = self._ray.get(answer)
        except exceptions.ActorUnavailableError:  # Ray starts it, or starts it again
            self._lose(now)
            self._tell_of_waiting(now)
        except exceptions.ActorDiedError as error:
            is_coming_back = self._is_there()
            self._lose(now)
            if not is_coming_back:
                self._actor, self._since = None, now
                self.trouble = f"Ray gave it up: {SHORT.repr(str(error))}"
        else:
            self.trouble = self._report.trouble
            self._rest(now)

    def _tell_of_waiting(self, now: float) -> None:
        if self._report is None and now - self._since > SCARCE:
            self.trouble = f"it waits for a machine with {self._cluster.cores:g} cores and {self._cluster.memory / 1e6:.0f} MB to spare"

    def _is_there(self) -> bool:
        try:
            self._ray.get_actor(self._name, NAMESPACE)
        except ValueError:
            return False
        return True

    def _lose(self, now: float) -> None:
        """The actor or its machine has died. Until it is there again, Ray says so to each question."""
        if self._report is not None:
            self._restarts += self._report.restarts + 1
            self._report, self._since = None, now

    def _rest(self, now: float) -> None:
        """Ends the actor of a room in which nothing happens any more."""
        if self.state not in ("asleep", "failed"):
            self._idle_since = 0.0
        elif self._idle_since == 0.0:
            self._idle_since = now
        elif now - self._idle_since > IDLE:
            self.ask_to_end()

    def _look_at_end(self, now: float) -> None:
        ready, _ = self._ray.wait([self._ending], timeout=0)
        if ready or now - self._since > self._patience():
            self._forget()

    def _patience(self) -> float:
        """Seconds that its end may take. An actor that has not been heard of has no process yet."""
        return SILENT if self._report is None else PATIENCE

    def _forget(self) -> None:
        with suppress(Exception):  # it may have died already
            self._ray.kill(self._actor, no_restart=True)
        self._restarts = self.restarts
        self._actor = self._report = self._answer = self._ending = None
