# SPDX-License-Identifier: Apache-2.0
"""The folder of a journal: its files, and which process may write there.

000007-000002.journal   the second generation of the seventh process that wrote here
epoch                   "7": a process that finds a higher number than its own writes no more
lock                    locked by the process that writes, until it ends
aside-N                 older journals, which nobody reads any more
picture.png             the world as a page drew it
"""

from __future__ import annotations

import os
import re
from contextlib import suppress
from pathlib import Path
from typing import NamedTuple

from iota.saving import replacing

with suppress(ImportError):  # on Windows only the epoch protects
    import fcntl

NAME = re.compile(r"(\d{6,})-(\d{6,})\.journal")


class BusyError(RuntimeError):
    """Another process writes to this journal."""


class File(NamedTuple):
    """A generation of a journal."""

    epoch: int
    generation: int
    path: Path


class Folder:
    """epoch: of this process, 0 before `claim`."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.epoch = 0
        self._lock: int | None = None
        self._stamp: tuple[int, int] | None = None  # of our epoch's file

    def lock(self) -> None:
        """Makes the folder if there is none. Raises BusyError if another process writes here, OSError if the folder cannot be made."""
        try:
            self.path.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise OSError(f"the journal's folder {self.path} cannot be made: {error.strerror or error}") from None
        if "fcntl" not in globals():
            return
        try:
            handle = os.open(self.path / "lock", os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o644)
        except OSError:  # a full or read-only disk: the writer tells of it, and nobody else can write there either
            return
        try:
            fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            owner = os.read(handle, 20).decode("ascii", "replace").strip()
            os.close(handle)
            raise BusyError(
                f"{self.path} is the journal of a world that runs{f' (process {owner})' if owner else ''}. "
                "Stop it first, or choose another folder"
            ) from None
        with suppress(OSError):
            os.ftruncate(handle, 0)
            os.write(handle, b"%d" % os.getpid())
        self._lock = handle

    def unlock(self) -> None:
        if self._lock is not None:
            os.close(self._lock)
            self._lock = None

    def __del__(self) -> None:
        """Gives the lock back if the world never ran."""
        self.unlock()

    @property
    def picture(self) -> Path:
        return self.path / "picture.png"

    def files(self) -> list[File]:
        """Oldest first. By the numbers in their names: clocks may be set back."""
        found = []
        with suppress(OSError):
            for entry in os.scandir(self.path):
                if (match := NAME.fullmatch(entry.name)) is not None:
                    found.append(File(int(match[1]), int(match[2]), Path(entry.path)))
        return sorted(found)

    def claim(self) -> None:
        """Takes an epoch above all others: no earlier process writes from now on. Raises OSError."""
        highest = max([self._read_epoch(), *(file.epoch for file in self.files())])
        path = self.path / "epoch"
        with replacing(path) as fresh:
            fresh.write_text(f"{highest + 1}")
        status = path.stat()
        self.epoch, self._stamp = highest + 1, (status.st_ino, status.st_mtime_ns)

    def is_ours(self) -> bool:
        """Whether no other process has claimed the folder since. Raises OSError if it is gone."""
        status = (self.path / "epoch").stat()
        return (status.st_ino, status.st_mtime_ns) == self._stamp or self._read_epoch() <= self.epoch

    def file(self, generation: int) -> Path:
        return self.path / f"{self.epoch:06d}-{generation:06d}.journal"

    def prune(self, count: int = 2) -> None:
        """Removes all files but the newest, and what killed processes have left unfinished."""
        for part in self.path.glob("*.part"):
            with suppress(OSError):
                part.unlink()
        for file in self.files()[:-count]:
            with suppress(OSError):
                file.path.unlink()

    def put_aside(self, files: list[File]) -> Path | None:
        """Moves files into a new folder beside them, with the picture. Raises OSError."""
        if not files:
            return None
        number = 1
        while (aside := self.path / f"aside-{number}").exists():
            number += 1
        aside.mkdir()
        for file in files:
            file.path.rename(aside / file.path.name)
        with suppress(FileNotFoundError):
            self.picture.rename(aside / self.picture.name)
        return aside

    def _read_epoch(self) -> int:
        try:
            return int((self.path / "epoch").read_text())
        except (OSError, ValueError):  # none yet, or damaged
            return 0
