# SPDX-License-Identifier: Apache-2.0
"""Reads files in a process of its own, with limits of memory and time: a damaged or hostile file may end that process, but
not the world."""

from __future__ import annotations

import atexit
import contextlib
import os
import pickle
import selectors
import signal
import struct
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any, BinaryIO, TypeVar

from iota.shapelib.files import FileError, PathLike

Result = TypeVar("Result")

MOST_MEMORY = 4 << 30  # bytes
MOST_SECONDS = 180.0  # for one file
TRY = "the file is damaged, or made to do harm"


def apart(read: Callable[[PathLike], Result], path: PathLike) -> Result:
    """The result of a function of this package for a file, called in the other process. Raises what it raises, and
    FileError if it crashes, or takes more than 4 GiB or three minutes."""
    return _reader.call(read, path)


class _Reader:
    """The process; started with the first file, and again after it ended."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._process: subprocess.Popen[bytes] | None = None

    def call(self, read: Callable[[PathLike], Result], path: PathLike) -> Result:
        with self._lock:
            process = self._running()
            try:
                assert process.stdin is not None and process.stdout is not None
                _write(process.stdin, (read.__module__, read.__name__, os.fspath(path), os.getcwd()))
                is_raised, answer = _read(process.stdout, time.monotonic() + MOST_SECONDS)
            except TimeoutError:
                self.end()
                raise FileError(path, f"cannot be read within {MOST_SECONDS:g} s; make it smaller") from None
            except (EOFError, BrokenPipeError):
                self.end()
                raise FileError(path, f"its reader ended ({_reason(process)}): {TRY}") from None
            except BaseException:  # Ctrl-C: its answer would be taken for that of the next file
                self.end()
                raise
        if is_raised:
            raise answer
        result: Result = answer
        return result

    def end(self) -> None:
        process, self._process = self._process, None
        if process is not None:
            process.kill() if process.poll() is None else None
            process.wait()
            for pipe in (process.stdin, process.stdout):
                with contextlib.suppress(OSError):
                    pipe.close() if pipe is not None else None

    def _running(self) -> subprocess.Popen[bytes]:
        if self._process is None or self._process.poll() is not None:
            self.end()
            here = str(Path(__file__).resolve().parents[2])
            paths = os.pathsep.join([here, *filter(None, [os.environ.get("PYTHONPATH")])])
            words = [sys.executable, "-P", "-c", "from iota.shapelib.apart import serve; serve()"]
            self._process = subprocess.Popen(
                words, stdin=subprocess.PIPE, stdout=subprocess.PIPE, env={**os.environ, "PYTHONPATH": paths}
            )
        return self._process


def serve() -> None:
    """Answers requests until the input ends."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    with contextlib.suppress(ImportError, ValueError, OSError):
        import resource

        resource.setrlimit(resource.RLIMIT_AS, (MOST_MEMORY, MOST_MEMORY))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    # What a library prints must not be taken for an answer.
    answers = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)
    while True:
        try:
            module, name, path, folder = _read(sys.stdin.buffer)
        except EOFError:
            return
        try:
            os.chdir(folder)
            answer = (False, getattr(sys.modules.get(module) or __import__(module, fromlist=[name]), name)(path))
        except MemoryError:
            answer = (True, FileError(path, f"takes more than {MOST_MEMORY >> 30} GiB of memory; make it smaller"))
        except Exception as error:
            answer = (True, error)
        _write(answers, answer)


def _write(pipe: BinaryIO | Any, value: Any) -> None:
    data = pickle.dumps(value)
    pipe.write(struct.pack("<Q", len(data)))
    pipe.write(data)
    pipe.flush()


def _read(pipe: BinaryIO | Any, until: float | None = None) -> Any:
    """until: time.monotonic(). Raises EOFError, TimeoutError."""
    (size,) = struct.unpack("<Q", _take(pipe, 8, until))
    return pickle.loads(_take(pipe, size, until))


def _take(pipe: BinaryIO | Any, size: int, until: float | None) -> bytes:
    if until is None:
        data = pipe.read(size)
    else:
        data = bytearray()
        with selectors.DefaultSelector() as selector:
            selector.register(pipe, selectors.EVENT_READ)
            while len(data) < size:
                if not selector.select(max(0.0, until - time.monotonic())):
                    raise TimeoutError
                more = os.read(pipe.fileno(), min(size - len(data), 1 << 20))
                if not more:
                    break
                data += more
    if len(data) < size:
        raise EOFError
    return bytes(data)


def _reason(process: subprocess.Popen[bytes]) -> str:
    code = process.wait()
    if code >= 0:
        return f"exit code {code}"
    with contextlib.suppress(ValueError):
        return signal.Signals(-code).name
    return f"signal {-code}"


_reader = _Reader()
atexit.register(_reader.end)
