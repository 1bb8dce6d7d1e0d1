# SPDX-License-Identifier: Apache-2.0
"""All rooms of a folder, and the page that lists them."""

from __future__ import annotations

import hmac
import json
import os
import select
import socket
import time
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any
from urllib.parse import parse_qs

from iota import studies
from iota._core import Request, make_token
from iota.gallery.serving import in_order
from iota.journal.folder import BusyError
from iota.metrics import CONTENT_TYPE, Metric, of_process, one, text_of
from iota.rooms.cluster import Cluster, RoomActor
from iota.rooms.folder import RoomFolder, Settings, check_name, owner, try_lock, write_owner
from iota.rooms.nursery import Nursery
from iota.rooms.process import HostOptions, RoomProcess
from iota.world import Server
from iota.world.callbacks import one_line, print_error, print_on_terminal
from iota.world.lan import Lan, address
from iota.world.page import token_for

LOOK = 0.05  # s, between two looks at all rooms
LIST, CHANGE, PICTURE, METRICS = "/rooms.json", "/rooms/change", "/rooms/picture", "/metrics"
WHERE = "/rooms/where"
MOST_PORTS = 1000
MOST_ROOMS = 500
JSON = "application/json"
STATES = ("running", "starting", "ending", "asleep", "closed", "failed", "hanging")


class Refused(ValueError):
    """A wish of a page is not done; the text says why and what to try."""


class Rooms(Server):
    """Serves the page of rooms, and starts their processes. Their visitors go straight to these: if this process is killed,
    they notice nothing, and the next one finds the rooms again.

    folder: of the rooms, made if there is none. page: see `make_folder`. scripts: a folder whose scripts can be rooms, beside
    the studies. leave: s without a visitor, after which a room ends until the next visitor. lan, public_origin: as of
    `Server`. cluster: on whose machines the rooms are; the folder is at the same path on all. Raises BusyError if another process serves the folder, OSError.
    """

    def __init__(
        self,
        folder: Path,
        page: str | Path,
        port: int = 8080,
        scripts: Path | None = None,
        leave: float = 600.0,
        lan: Lan | None = None,
        public_origin: str = "",
        cluster: Cluster | None = None,
    ) -> None:
        self._folder = folder
        self._lock = lock_folder(folder)
        try:
            host = "127.0.0.1" if cluster is None else cluster.host
            super().__init__(host, port, folder=page, lan=lan or False, public_origin=public_origin)
        except BaseException:
            os.close(self._lock)
            raise
        self._scripts = scripts
        self._cluster = cluster
        self._options = HostOptions("0.0.0.0" if lan else host, leave, lan, public_origin)
        if cluster is not None:
            self._options.gateway = public_origin or f"{'https' if lan else 'http'}://{host}:{self.port}"
        self._public_origin = public_origin
        self.rooms: dict[str, RoomProcess | RoomActor] = {}
        self._nursery = Nursery()
        if cluster is None:
            with suppress(OSError):  # such as too many processes: it is tried again with the first visitor
                self._nursery.start()
        self._find()
        self.serve_requests([LIST, CHANGE, PICTURE, METRICS])
        if cluster is not None:
            self.serve_requests([WHERE], is_open=True)

    def run(self, goes_on: Callable[[], bool] = lambda: True) -> None:
        """Runs until `goes_on` returns False; then ends all rooms, whose worlds are kept."""
        try:
            while goes_on():
                try:
                    self.look()
                except Exception as error:  # one of this program: the rooms go on
                    print_error(error)
                    time.sleep(1)
        finally:
            self.stop()

    def look(self, wait: float = LOOK) -> None:
        """Answers the page, and starts the rooms at whose door somebody is. wait: s, for either."""
        for request in self.take_requests():
            self._answer(request)
        now = time.monotonic()
        for room in self.rooms.values():
            room.look(now)
        bells = {bell.fileno(): room for room in self.rooms.values() if (bell := room.bell) is not None}
        poll = select.poll()
        for number in bells:
            poll.register(number, select.POLLIN)
        for number, _ in poll.poll(wait * 1000):
            bells[number].wake()

    def stop(self) -> None:
        self.close()
        for room in self.rooms.values():
            room.ask_to_end()
        for room in self.rooms.values():
            room.end()
        self._nursery.close()
        os.close(self._lock)

    # --- what the page asks for ----------------------------------------------------------------------------------------

    def make(self, name: str, source: str) -> None:
        """A new room of a study or a script. Raises Refused."""
        try:
            check_name(name)
        except ValueError as error:
            raise Refused(str(error)) from None
        folder = RoomFolder(self._folder / name)
        if name in self.rooms or folder.path.exists():
            raise Refused(f"there is a room {name!r} already: choose another name")
        if len(self.rooms) >= MOST_ROOMS:
            raise Refused(f"there are {MOST_ROOMS} rooms: delete one")
        sources = self.sources()
        if source not in sources:
            raise Refused(f"there is no study or script {source!r} here")
        settings = Settings(sources[source][0], self._free_port(), make_token())
        try:
            folder.make(settings)
        except OSError as error:
            raise Refused(f"the room cannot be made: {error.strerror or error}") from None
        self._add(name, folder, settings)

    def _add(self, name: str, folder: RoomFolder, settings: Settings) -> None:
        room: RoomProcess | RoomActor
        if self._cluster is None:
            room = RoomProcess(folder, settings, self._options, self._nursery)
        else:
            room = RoomActor(folder, settings, self._options, self._cluster)
        self.rooms[name] = room
        room.look(time.monotonic())  # visitors may come at once

    def delete(self, name: str) -> None:
        """Ends a room and moves its folder to deleted/. Raises Refused."""
        room = self._room(name)
        room.end()
        try:
            room.folder.put_away()
        except OSError as error:
            raise Refused(f"the room cannot be deleted: {error.strerror or error}") from None
        del self.rooms[name]

    def sources(self) -> dict[str, tuple[str, str]]:
        """The possible rooms by their names on the page: the words for `iota run`, and a sentence."""
        found = {name: (name, studies.description(name)) for name in in_order()}
        if self._scripts is not None:
            with suppress(OSError):
                for path in sorted(self._scripts.glob("*.py")):
                    if not path.name.startswith(("_", ".")):
                        found[path.name] = str(path.resolve()), ""
        return found

    def listing(self) -> dict[str, Any]:
        """The contents of the page."""
        base = self._public_origin or (f"https://{address()}" if self._options.lan is not None else "")
        described = [{"name": name, "text": text} for name, (_, text) in self.sources().items()]
        return {
            "rooms": [self._described(name, room) for name, room in sorted(self.rooms.items())],
            "sources": described,
            "base": base,
            "is_proxied": bool(self._public_origin),
            "is_on_machines": self._cluster is not None,
        }

    def metrics(self) -> list[Metric]:
        rooms = self.rooms.items()
        counts = {state: 0.0 for state in STATES}
        for _, room in rooms:
            counts[room.state] += 1
        serving = [(name, room.told) for name, room in rooms if room.serves and room.told is not None]
        return [
            Metric("iota_rooms", "gauge", "Rooms.", [({"state": state}, count) for state, count in counts.items()]),
            Metric(
                "iota_room_restarts_total",
                "counter",
                "Processes of rooms that ended by mistake, since this start.",
                [({"room": name}, room.restarts) for name, room in rooms],
            ),
            Metric(
                "iota_room_people",
                "gauge",
                "Open pages.",
                [({"room": name}, len(told.people)) for name, told in serving],
            ),
            Metric(
                "iota_room_step_seconds",
                "gauge",
                "Time of a step, smoothed.",
                [({"room": name}, told.step_seconds) for name, told in serving],
            ),
            Metric(
                "iota_room_reached_speed",
                "gauge",
                "The share of its speed that a world reaches; below 1: slow motion.",
                [({"room": name}, told.reached_speed) for name, told in serving],
            ),
            one(
                "iota_refused_requests_total",
                "counter",
                "Wrong token, Host or Origin.",
                self.statistics.upgrades_refused,
            ),
            *of_process(),
        ]

    def _answer(self, request: Request) -> None:
        if request.path == METRICS:
            self.answer(request, text_of(self.metrics()).encode(), CONTENT_TYPE)
            return
        if request.path == WHERE:
            self._tell_where(request)
            return
        if request.role != "host":
            self.answer(request, b"only the host's address leads to the list of rooms", status=403)
            return
        asked = {name: values[0] for name, values in parse_qs(request.query).items()}
        try:
            if request.path == PICTURE:
                self._send_picture(request, asked.get("room", ""))
                return
            if request.path == CHANGE:
                if not request.is_post:
                    raise Refused("a change is asked for by POST")
                self._change(asked)
        except Refused as refused:
            self.answer(request, str(refused).encode(), status=400)
        except OSError as error:  # a full disk
            self.answer(request, one_line(error).encode(), status=500)
        else:
            self.answer(request, json.dumps(self.listing()).encode(), JSON)

    def _tell_where(self, request: Request) -> None:
        """Wakes a room, and tells its address once it has one. Whoever has a link of the room may ask."""
        asked = {name: values[0] for name, values in parse_qs(request.query).items()}
        room, token = self.rooms.get(asked.get("room", "")), asked.get("token", "")
        if not isinstance(room, RoomActor) or not is_token_of(room.settings, token):
            self.answer(request, b"there is no such room, or this link is not of it", status=403)
            return
        room.wake()
        told = {"url": room.url(token), "state": room.state, "trouble": room.trouble}
        self.answer(request, json.dumps(told).encode(), JSON)

    def _change(self, asked: dict[str, str]) -> None:
        what, name = asked.get("do", ""), asked.get("room", "")
        if what == "make":
            self.make(name, asked.get("source", ""))
        elif what == "delete":
            self.delete(name)
        elif what in ("close", "open", "begin_anew"):
            room = self._room(name)
            {"close": room.close, "open": room.open, "begin_anew": room.begin_anew}[what]()
        else:
            raise Refused(f"there is no change {what!r}")

    def _send_picture(self, request: Request, name: str) -> None:
        room = self._room(name)
        for path, kind in (
            (room.folder.picture, "image/png"),
            (studies.PICTURES / f"{room.settings.what}.jpg", "image/jpeg"),
        ):
            with suppress(OSError):
                self.answer(request, path.read_bytes(), kind)
                return
        self.answer(request, b"there is no picture yet", status=404)

    def _described(self, name: str, room: RoomProcess | RoomActor) -> dict[str, Any]:
        told = room.told
        what = room.settings.what
        return {
            "name": name,
            "source": what if what in studies.names() else Path(what).name,
            "title": told.title if told is not None else "",
            "time": told.time if told is not None else 0.0,
            "state": room.state,
            "trouble": room.trouble,
            "picture": self._picture_version(room),
            "people": [{"name": each, "role": role} for each, role in room.people],
            "port": room.settings.port,
            "tokens": tokens_of(room.settings),
        }

    def _picture_version(self, room: RoomProcess | RoomActor) -> str:
        """Another one for another picture; empty without one."""
        with suppress(OSError):
            return str(room.folder.picture.stat().st_mtime_ns)
        return "study" if (studies.PICTURES / f"{room.settings.what}.jpg").is_file() else ""

    def _room(self, name: str) -> RoomProcess | RoomActor:
        room = self.rooms.get(name)
        if room is None:
            raise Refused(f"there is no room {name!r} any more")
        return room

    # --- the folder ----------------------------------------------------------------------------------------------------

    def _find(self) -> None:
        """The rooms of earlier runs, also those whose processes have gone on."""
        for path in sorted(self._folder.iterdir()):
            if not (path / "room.json").exists() or path.name == "deleted":
                continue
            folder = RoomFolder(path)
            try:
                check_name(path.name)
                self._add(path.name, folder, folder.read())
            except (ValueError, OSError) as error:
                print_on_terminal(f"iota: the room in {path} is left out: {error}\n")

    def _free_port(self) -> int:
        """The same range at each start, so that a firewall or a proxy can know it."""
        taken = {room.settings.port for room in self.rooms.values()}
        for port in range(self.port + 1, min(self.port + 1 + MOST_PORTS, 65536)):
            if port in taken:
                continue
            if self._cluster is not None:
                return port
            with suppress(OSError), socket.socket() as probe:
                probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
                probe.bind((self._options.host, port))
                return port
        raise Refused(f"no port from {self.port + 1} on is free")


def tokens_of(settings: Settings) -> dict[str, str]:
    """By role."""
    token = settings.token
    return {"host": token, "guest": token_for("guest", token), "viewer": token_for("viewer", token)}


def is_token_of(settings: Settings, token: str) -> bool:
    return any([hmac.compare_digest(token.encode(), each.encode()) for each in tokens_of(settings).values()])


def lock_folder(folder: Path) -> int:
    """Makes the folder. Raises BusyError, OSError."""
    try:
        folder.mkdir(mode=0o700, parents=True, exist_ok=True)
        lock = try_lock(folder / "lock")
    except OSError as error:
        raise OSError(f"the folder of rooms {folder} cannot be used: {error.strerror or error}") from None
    if lock is None:
        number = owner(folder / "lock")
        raise BusyError(
            f"the rooms in {folder} are served already{f' (process {number})' if number else ''}. "
            "Stop that first, or choose another folder"
        )
    write_owner(lock, os.getpid())
    return lock
