# SPDX-License-Identifier: Apache-2.0
"""A running world's messages to its pages, written to a file while it runs.

A file is gzip over the line "iota stream 1" and, for each message, its time (s, f64), length (u32) and bytes, little-endian.
"""

from __future__ import annotations

import os
import struct
import threading
import zlib
from collections.abc import Callable, Iterable
from pathlib import Path

from iota._core import Room, RoomRecording
from iota.saving import file_beside, put_in_place

MAGIC = b"iota stream 1\n"
POSE_TIME = 1 / 30  # s, between two recorded poses
WRITE_TIME = 0.1  # s, between two writes: what a killed process loses
GZIP = 31  # wbits of zlib


def packed(message: tuple[float, bytes]) -> bytes:
    """A message with its time, s."""
    time, data = message
    return struct.pack("<dI", time, len(data)) + data


class StreamFile:
    """A file that can be read up to its last message at any time, even if the process is killed. It replaces an older
    one with its first messages. Raises OSError."""

    def __init__(self, path: Path) -> None:
        self._path = path
        handle, fresh = file_beside(path)
        self._file = os.fdopen(handle, "wb", buffering=0)
        self._fresh: Path | None = fresh  # until it has its final name
        self._packer = zlib.compressobj(wbits=GZIP)
        self._begin = MAGIC

    def write(self, messages: Iterable[tuple[float, bytes]]) -> None:
        data = b"".join(map(packed, messages))
        if not data:
            return
        self._write(self._packer.compress(self._begin + data) + self._packer.flush(zlib.Z_SYNC_FLUSH))
        self._begin = b""
        if self._fresh is not None:
            put_in_place(self._fresh, self._path)
            self._fresh = None

    def close(self) -> None:
        """Completes the file; nothing is left of one without messages."""
        try:
            if self._fresh is None:
                self._write(self._packer.flush())
                os.fsync(self._file.fileno())
        finally:
            self._file.close()
            if self._fresh is not None:
                self._fresh.unlink(missing_ok=True)

    def _write(self, data: bytes) -> None:
        left = memoryview(data)
        while left:
            left = left[self._file.write(left) :]


class LiveRecording:
    """A file of what pages show of a running world, with what its users do: made by `Pages.record`.

    path: of the file. error: why writing ended early, or None."""

    def __init__(self, path: Path, tell_error: Callable[[str], None]) -> None:
        self.path = path
        self.error: str | None = None
        self._tell_error = tell_error
        self._file = StreamFile(path)
        self._taken: RoomRecording | None = None
        self._stop = threading.Event()
        self._writer = threading.Thread(target=self._write, name="iota-recording", daemon=True)

    def __enter__(self) -> LiveRecording:
        return self

    def __exit__(self, *_: object) -> None:
        self.stop()

    def begin(self, room: Room) -> None:
        """Called by the world when it is served."""
        if self._taken is None and not self._stop.is_set():
            self._taken = room.record(POSE_TIME)
            self._writer.start()

    def stop(self) -> None:
        """Completes the file."""
        if self._stop.is_set():
            return
        self._stop.set()
        if self._taken is None:
            self._file.close()
        else:
            self._writer.join()

    def _write(self) -> None:
        assert self._taken is not None
        try:
            while not self._stop.wait(WRITE_TIME):
                self._file.write(self._taken.take())
            self._file.write(self._taken.take())
        except OSError as error:
            self._failed(error)
        finally:
            self._taken.end()
            try:
                self._file.close()
            except OSError as error:
                self._failed(error)

    def _failed(self, error: OSError) -> None:
        if self.error is None:
            self.error = f"{self.path} cannot be written: {error.strerror or error}"
            self._tell_error(self.error)
