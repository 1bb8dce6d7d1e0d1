# SPDX-License-Identifier: Apache-2.0
"""Writes a journal on a thread of its own."""

from __future__ import annotations

import os
import threading
import time
from collections import deque
from collections.abc import Callable, Sequence
from contextlib import suppress
from pathlib import Path

from iota.journal.folder import File, Folder
from iota.journal.records import MAGIC, Commands, pack
from iota.saving import sync

HAND_OVER = 0.1  # s, between two pieces of the log of a world that steps: what a killed process loses
LOOK = 0.12  # s after a piece: when the next one is there
SYNC_TIME = 0.08  # s, between two syncs: less than between two hand-overs, so that each is on the disk at once
RETRY_TIME = 5.0  # s, between tries on a disk that cannot be written
MOST_WAITING = 300  # records that wait for a slow disk; then a new generation begins when it is done with them
GAP = 1000  # in the numbers of records, after some that were not written

Content = tuple[str, bytes | Commands]  # kind, content
Item = tuple[Sequence[Content], bool, bool]  # whether it begins a generation, whether others before it were left out


class Writer:
    """Puts records into the files of a folder. It never raises: what cannot be written is told once, by `tell(text)` on
    its thread, and tried again. cut: called there, too, some time after records, once unless it returns some more and their age (s). wants_all:
    the next records must begin a generation. bytes: of the present generation."""

    def __init__(
        self,
        folder: Folder,
        tell: Callable[[str], None],
        aside: Sequence[File] = (),
        cut: Callable[[], tuple[Commands, float] | None] = lambda: None,
    ) -> None:
        self._folder, self._tell, self._aside, self._cut = folder, tell, list(aside), cut
        self._waiting: deque[Item | threading.Event | None] = deque()
        self._order = threading.Lock()  # what is cut is younger than all that waits
        self._wake = threading.Event()
        self._look_at: float | None = None  # s, when to ask for what was cut
        self._file: int | None = None
        self._number = self._generation = self.bytes = 0
        self._retry_at: float | None = 0.0  # s; None while all is well
        self._is_told = self._is_fenced = self._is_dirty = self._is_behind = False
        self._sync_at = 0.0  # s, not before
        self._thread = threading.Thread(target=self._run, name="iota-journal", daemon=True)
        self._thread.start()

    @property
    def wants_all(self) -> bool:
        """Whether a generation has to be begun: at first, and some seconds after an error."""
        if self._is_fenced:
            return False
        if self._is_behind:
            return not self._waiting
        return self._retry_at is not None and time.monotonic() >= self._retry_at

    @property
    def takes(self) -> bool:
        """Whether records are written at present."""
        return self._retry_at is None and not self._is_fenced and not self._is_behind

    def put(self, records: Sequence[Content], begins: bool = False) -> None:
        """From the thread of the world. begins: these are all that a new generation needs."""
        if begins:
            self._retry_at = None  # not again until this one has failed
        elif len(self._waiting) >= MOST_WAITING:
            if not self._is_behind:
                self._tell(
                    f"the disk of {self._folder.path} is too slow: what happens until it has caught up is not kept"
                )
            self._is_behind = True
            return
        has_gap, self._is_behind = self._is_behind, False
        self._ask((records, begins, has_gap))

    def flush(self, longest: float | None = None) -> None:
        """Waits until the thread has written all records, but not longer than that (s)."""
        done = threading.Event()
        self._ask(done)
        done.wait(longest)

    def close(self) -> None:
        """Writes what waits, to the disk."""
        self._ask(None)
        self._thread.join()

    def _ask(self, item: Item | threading.Event | None) -> None:
        with self._order:
            self._waiting.append(item)
        self._wake.set()

    # --- on its thread ------------------------------------------------------------------------------------------------

    def _run(self) -> None:
        while True:
            if not self._waiting:
                self._rest()
                self._look()
                continue
            item = self._waiting.popleft()
            if item is None:
                break
            if isinstance(item, threading.Event):
                item.set()
                continue
            records, begins, has_gap = item
            if has_gap:
                self._forget_file()
            if self._is_fenced:
                continue
            if begins:
                self._begin(records)
            elif self._file is not None:
                self._attempt(lambda records=records: self._append(records))  # type: ignore[misc]
            self._look_at = time.monotonic() + LOOK
        if self._is_dirty:
            self._attempt(self._sync)
        self._forget_file()

    def _rest(self) -> None:
        """Until the next record is due, or what is written has to be on the disk."""
        now = time.monotonic()
        if self._is_dirty and now >= self._sync_at:
            self._attempt(self._sync)
            return
        ends = [self._sync_at] if self._is_dirty else []
        if self._look_at is not None:
            ends.append(self._look_at)
        self._wake.wait(max(0.0, min(ends) - now) if ends else None)
        self._wake.clear()

    def _look(self) -> None:
        """For what was cut, when it is due."""
        if self._look_at is None or (now := time.monotonic()) < self._look_at:
            return
        with self._order:
            if self._waiting:
                return
            cut = self._cut()
        self._look_at = None
        if cut is not None:
            commands, age = cut
            self._look_at = now + max(LOOK - age, 0.0)
            if self._file is not None:
                self._attempt(lambda: self._append([("C", commands)]))

    def _attempt(self, work: Callable[[], None]) -> bool:
        """False if it failed: the present file is then left as it is."""
        try:
            work()
            return True
        except OSError as error:
            self._forget_file()
            self._fail(error)
            return False

    def _fail(self, error: OSError) -> None:
        self._retry_at = time.monotonic() + RETRY_TIME
        if not self._is_told:
            self._is_told = True
            self._tell(
                f"the journal in {self._folder.path} cannot be written: {error.strerror or error}. The world goes on; "
                "what it had kept stays, and it is tried again"
            )

    def _begin(self, records: Sequence[Content]) -> None:
        """A new generation, under its name only when it is complete and on the disk."""
        before, number = self._file, self._number
        part: Path | None = None
        fresh: int | None = None
        try:
            if self._folder.epoch == 0:
                self._folder.claim()
            if not self._check_epoch():
                return
            path = self._folder.file(self._generation + 1)
            part = path.with_suffix(".part")
            fresh = os.open(part, os.O_WRONLY | os.O_CREAT | os.O_TRUNC | os.O_CLOEXEC, 0o644)
            data = MAGIC + packed(records, number)
            write_all(fresh, data)
            os.fsync(fresh)
            part.rename(path)
            with suppress(PermissionError):  # Windows
                sync(self._folder.path)
        except OSError as error:
            if fresh is not None:
                os.close(fresh)
            if part is not None:
                with suppress(OSError):
                    part.unlink()
            if before is None:
                self._number += GAP
                self._fail(error)
            else:  # the file before may still have room, and goes on without a gap
                self._attempt(lambda: self._append([record for record in records if record[0] in "UYW"]))
            return
        if before is not None:
            os.close(before)
        self._file, self._generation, self.bytes = fresh, self._generation + 1, len(data)
        self._number = number + len(records)
        self._is_dirty = False
        if self._is_told:
            self._is_told = False
            self._tell(f"the journal in {self._folder.path} is written again")
        with suppress(OSError):
            self._folder.put_aside(self._aside)
        self._aside = []
        self._folder.prune()

    def _append(self, records: Sequence[Content]) -> None:
        assert self._file is not None
        if not self._check_epoch():
            return
        data = packed(records, self._number)
        write_all(self._file, data)
        self._number += len(records)
        self.bytes += len(data)
        self._is_dirty = True
        if time.monotonic() >= self._sync_at:
            self._sync()

    def _sync(self) -> None:
        self._is_dirty, self._sync_at = False, time.monotonic() + SYNC_TIME
        if self._file is not None:
            (os.fdatasync if hasattr(os, "fdatasync") else os.fsync)(self._file)

    def _check_epoch(self) -> bool:
        """A process that was believed dead must not write: another one goes on with the world."""
        if self._folder.is_ours():
            return True
        self._is_fenced = True
        self._forget_file()
        self._tell(
            f"another process has taken over {self._folder.path}: this world is no longer kept there. It goes on without"
        )
        return False

    def _forget_file(self) -> None:
        """Nothing is appended to what may end in a part of a record."""
        if self._file is not None:
            with suppress(OSError):
                os.close(self._file)
            self._file = None
            self._number += GAP
        self._is_dirty = False


def packed(records: Sequence[Content], number: int) -> bytes:
    """The bytes of records after the one with this number."""
    contents = ((kind, each.to_bytes() if isinstance(each, Commands) else each) for kind, each in records)
    return b"".join(pack(kind, number + n, content) for n, (kind, content) in enumerate(contents, 1))


def write_all(file: int, data: bytes) -> None:
    left = memoryview(data)
    while left:
        left = left[os.write(file, left) :]
