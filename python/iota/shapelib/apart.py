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
from functools import wraps
from pathlib import Path
from typing import Any, BinaryIO, ParamSpec, TypeVar

from iota.shapelib.files import FileError, PathLike

Given = ParamSpec("Given")
Result = TypeVar("Result")

MOST_MEMORY = 4 << 30  # bytes
MOST_SECONDS = 180.0  # for one file
ENDING_SECONDS = 5.0  # from its closed output to its end
TRY = "the file is damaged, or made to do harm"
# By a user, or by the system at its end: the file may be good.
STOPPED = {"SIGTERM", "SIGINT", "SIGHUP", "SIGQUIT"}


def apart(
    is_needed: Callable[[PathLike], bool] = lambda source: True,
) -> Callable[[Callable[Given, Result]], Callable[Given, Result]]:
    """Makes a function whose first argument is a source run in the other process, unless is_needed(source) says that this
    one will do. It raises what it raises there, and FileError if it crashes, or takes more than 4 GiB or three minutes."""

    def of(read: Callable[Given, Result]) -> Callable[Given, Result]:
        @wraps(read)
        def call(*given: Given.args, **options: Given.kwargs) -> Result:
            source = _source(given, options)
            if _is_reader or not is_needed(source):
                return read(*given, **options)
            return _reader.call(read, source, given, options)  # type: ignore[no-any-return]

        return call

    return of


class _Reader:
    """The process; started with the first file, and again after it ended."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._process: subprocess.Popen[bytes] | None = None

    def call(self, read: Callable[..., Any], source: PathLike, given: Any, options: Any) -> Any:
        request = pickle.dumps((read.__module__, read.__name__, os.getcwd(), given, options))
        with self._lock:
            process = self._running()
            try:
                assert process.stdin is not None and process.stdout is not None
                _write(process.stdin, request)
                is_raised, answer = pickle.loads(_read(process.stdout, time.monotonic() + MOST_SECONDS))
            except TimeoutError:
                self.end()
                raise FileError(source, f"cannot be read within {MOST_SECONDS:g} s; make it smaller") from None
            except (EOFError, BrokenPipeError):
                reason = _reason(process)
                self.end()
                why = "it was stopped from outside; try again" if reason in STOPPED else TRY
                raise FileError(source, f"its reader ended ({reason}): {why}") from None
            except BaseException:  # Ctrl-C: its answer would be taken for that of the next file
                self.end()
                raise
        if is_raised:
            raise answer
        return answer

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
            words = [sys.executable, "-c", "from iota.shapelib.apart import serve; serve()"]
            # Modules beside the files are not part of it (Python 3.11 and later).
            environment = {**os.environ, "PYTHONPATH": paths, "PYTHONSAFEPATH": "1"}
            self._process = subprocess.Popen(words, stdin=subprocess.PIPE, stdout=subprocess.PIPE, env=environment)
        return self._process


def serve() -> None:
    """Answers requests until the input ends."""
    global _is_reader
    _is_reader = True
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    with contextlib.suppress(ImportError, ValueError, OSError):
        import resource

        resource.setrlimit(resource.RLIMIT_AS, (MOST_MEMORY, MOST_MEMORY))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    # The answer must not be mixed up with the text that a library prints.
    answers = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)
    while True:
        try:
            module, name, folder, given, options = pickle.loads(_read(sys.stdin.buffer))
        except EOFError:
            return
        source = _source(given, options)
        try:
            os.chdir(folder)
            read = getattr(sys.modules.get(module) or __import__(module, fromlist=[name]), name)
            answer = pickle.dumps((False, read(*given, **options)))
        except MemoryError:
            few = FileError(source, f"takes more than {MOST_MEMORY >> 30} GiB of memory; make it smaller")
            answer = pickle.dumps((True, few))
        except Exception as error:
            answer = pickle.dumps((True, error))
        _write(answers, answer)


def _source(given: Any, options: Any) -> Any:
    """The first argument, however it is passed."""
    return next(iter((*given, *options.values())), "")


def _write(pipe: BinaryIO | Any, data: bytes) -> None:
    pipe.write(struct.pack("<Q", len(data)))
    pipe.write(data)
    pipe.flush()


def _read(pipe: BinaryIO | Any, until: float | None = None) -> bytes:
    """until: time.monotonic(). Raises EOFError, TimeoutError."""
    (size,) = struct.unpack("<Q", _take(pipe, 8, until))
    return _take(pipe, size, until)


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
    """Why a process closed its output; it is ending."""
    try:
        code = process.wait(ENDING_SECONDS)
    except subprocess.TimeoutExpired:
        return "it closed its output"
    if code >= 0:
        return f"exit code {code}"
    with contextlib.suppress(ValueError):
        return signal.Signals(-code).name
    return f"signal {-code}"


_is_reader = False
_reader = _Reader()
atexit.register(_reader.end)
