# SPDX-License-Identifier: Apache-2.0
"""The files of rooms.

lock                locked by the `iota rooms` that serves the folder
deleted/NAME-1      a room that was deleted
NAME/room.json      what it runs, its port, the secret of its addresses
NAME/state.json     what its process told last
NAME/lock           locked by its process as long as it lives
NAME/journal        its world and a picture of it, see iota.journal.folder
NAME/log            what its process printed
"""

from __future__ import annotations

import json
import os
import re
import time
from contextlib import suppress
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

from iota.arguments import SHORT
from iota.journal.folder import Folder
from iota.saving import replacing

with suppress(ImportError):  # there are no rooms on Windows
    import fcntl

NAME = re.compile(r"[a-z0-9][a-z0-9-]{0,39}")
OTHERS = ("lock", "deleted")
MOST_LOG = 1 << 20  # bytes


@dataclass
class Settings:
    """what: a study or the path of a script. is_closed: visitors are not let in."""

    what: str
    port: int
    token: str
    is_closed: bool = False


@dataclass
class Told:
    """The latest words of the process of a room. people: name and role of each. is_over: it ended by itself or was asked to."""

    process: int
    title: str = ""
    time: float = 0.0
    people: list[tuple[str, str]] = field(default_factory=list)
    step_seconds: float = 0.0
    reached_speed: float = 1.0
    is_over: bool = False


def check_name(name: str) -> None:
    """Raises ValueError."""
    if name in OTHERS:
        raise ValueError(f"no room can be named {name!r}, which is a file of iota rooms. Try: {name}-1")
    if NAME.fullmatch(name) is None:
        raise ValueError(
            f"the name of a room is of small letters, digits and hyphens, at most 40, not {SHORT.repr(name)}. "
            "Try: physics-101"
        )


def try_lock(path: Path) -> int | None:
    """An open file that is locked until all its copies are closed; None if it is locked already. Raises OSError."""
    handle = os.open(path, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o600)
    try:
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        os.close(handle)
        return None
    except BaseException:
        os.close(handle)
        raise
    return handle


def write_owner(lock: int, process: int) -> None:
    """For messages and for `owner`; a full disk does not matter."""
    with suppress(OSError):
        os.ftruncate(lock, 0)
        os.pwrite(lock, b"%d" % process, 0)


def owner(path: Path) -> int | None:
    """The process that locked the file last."""
    try:
        return int(path.read_text())
    except (OSError, ValueError):
        return None


class RoomFolder:
    """The folder of one room."""

    def __init__(self, path: Path) -> None:
        self.path = path

    @property
    def name(self) -> str:
        return self.path.name

    @property
    def lock(self) -> Path:
        return self.path / "lock"

    @property
    def journal(self) -> Path:
        return self.path / "journal"

    @property
    def picture(self) -> Path:
        return Folder(self.journal).picture

    def read(self) -> Settings:
        """Raises ValueError for a damaged file, OSError."""
        path = self.path / "room.json"
        try:
            settings = Settings(**json.loads(path.read_text()))
            if not (isinstance(settings.what, str) and settings.token and 0 < settings.port < 65536):
                raise ValueError("it lacks something")
        except (ValueError, TypeError) as error:
            raise ValueError(f"{path} is damaged: {error}") from None
        return settings

    def write(self, settings: Settings) -> None:
        """Raises OSError."""
        with replacing(self.path / "room.json") as fresh:
            fresh.write_text(json.dumps(asdict(settings)))

    def make(self, settings: Settings) -> None:
        """Only its owner may read it: it has the secret. Raises OSError, and leaves nothing behind then."""
        self.path.mkdir(mode=0o700)
        try:
            self.write(settings)
        except OSError:
            self.path.rmdir()
            raise

    def put_away(self) -> Path:
        """Moves it where it is no room. Raises OSError."""
        away = self.path.parent / "deleted"
        away.mkdir(mode=0o700, exist_ok=True)
        number = 1
        while (target := away / f"{self.name}-{number}").exists():
            number += 1
        self.path.rename(target)
        return target

    def tell(self, told: Told) -> None:
        """For `iota rooms`, also a later one. Not synced: after a power cut it is of no use. Raises OSError."""
        fresh = self.path / "state.json.part"
        fresh.write_text(json.dumps(asdict(told)))
        fresh.replace(self.path / "state.json")

    def told(self) -> Told | None:
        try:
            content: dict[str, Any] = json.loads((self.path / "state.json").read_text())
            return Told(**content | {"people": [(str(name), str(role)) for name, role in content["people"]]})
        except (OSError, ValueError, TypeError, KeyError):
            return None

    def told_version(self) -> tuple[int, int] | None:
        """Another one if `told` may be new."""
        with suppress(OSError):
            status = (self.path / "state.json").stat()
            return status.st_ino, status.st_mtime_ns
        return None

    def open_log(self) -> int:
        """For the output of a process. The one before is kept if it is long. Raises OSError."""
        path = self.path / "log"
        with suppress(OSError):
            if path.stat().st_size > MOST_LOG:
                path.replace(self.path / "log.1")
        handle = os.open(path, os.O_WRONLY | os.O_APPEND | os.O_CREAT | os.O_CLOEXEC, 0o600)
        with suppress(OSError):
            os.write(handle, f"--- {time.strftime('%Y-%m-%d %H:%M:%S')}\n".encode())
        return handle

    def last_words(self) -> str:
        """The last line of the log, without the name of the program."""
        with suppress(OSError):
            with (self.path / "log").open("rb") as file:
                file.seek(max(0, file.seek(0, os.SEEK_END) - 4096))
                lines = [line for line in file.read().decode("utf-8", "replace").splitlines() if line.strip()]
            if lines and not lines[-1].startswith("--- "):
                return lines[-1].removeprefix("iota: ")
        return ""
