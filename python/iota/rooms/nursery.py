# SPDX-License-Identifier: Apache-2.0
"""A process that has the package in memory and makes those of rooms as copies of itself: each begins with 0.03 s of processor time
instead of 0.4, and shares its memory for code and data that stay.

Each message to it is JSON with open files; it answers with the number of the process, and tells how each one ends. It ends with the
process that started it; its rooms go on.
"""

from __future__ import annotations

import fcntl
import gc
import json
import os
import select
import signal
import socket
import subprocess
import sys
import traceback
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any

PATIENCE = 20.0  # s, for it to load the package and make a process
MOST = 1 << 16  # bytes of a message
MOST_FILES = 8


class Nursery:
    """Starts with the first process that is asked for, or before, with `start`; and again if it was killed. Elsewhere than on Linux each process
    loads the package by itself: macOS has no such sockets, and its libraries do not like to be copied."""

    def __init__(self) -> None:
        self._running: Running | None = None

    def start(self) -> None:
        """Does not wait until it has loaded the package. Raises OSError."""
        if sys.platform == "linux" and (self._running is None or self._running.has_ended):
            self._running = Running()

    def make(
        self, words: list[str], place: Path, name: str, log: int, files: list[int]
    ) -> Nursling | subprocess.Popen[bytes]:
        """Runs the command line with these words in a process with a session of its own. place: its folder. name: for `ps`. log: for its output.
        files: that are open there, too, under the same numbers. Raises OSError."""
        self.start()
        if (running := self._running) is None:
            return subprocess.Popen(
                [sys.executable, "-m", "iota", *words],
                cwd=place,
                stdin=subprocess.DEVNULL,
                stdout=log,
                stderr=log,
                pass_fds=files,
                start_new_session=True,
            )
        told = {"words": words, "place": str(place), "name": name, "files": files}
        return Nursling(running, running.ask(json.dumps(told).encode(), [log, *files]))

    def close(self) -> None:
        if self._running is not None:
            self._running.close()
            self._running = None


class Nursling:
    """A process that a nursery made: like `subprocess.Popen`. is_lost: that has ended, and nobody is told of the end of this one."""

    def __init__(self, maker: Running, pid: int) -> None:
        self.pid = pid
        self.returncode: int | None = None
        self._maker = maker

    @property
    def is_lost(self) -> bool:
        return self.poll() is None and self._maker.has_ended

    def poll(self) -> int | None:
        return self._look(0)

    def wait(self, timeout: float | None = None) -> int:
        """-1, at once, if it is lost. Raises subprocess.TimeoutExpired."""
        code = self._look(timeout)
        if code is None and not self._maker.has_ended:
            raise subprocess.TimeoutExpired("a room", timeout or 0)
        return -1 if code is None else code

    def send_signal(self, number: int) -> None:
        if self.poll() is None:
            with suppress(ProcessLookupError):
                os.kill(self.pid, number)

    def kill(self) -> None:
        self.send_signal(signal.SIGKILL)

    def _look(self, seconds: float | None) -> int | None:
        if self.returncode is None:
            self.returncode = self._maker.code_of(self.pid, seconds)
        return self.returncode


class Running:
    """The process as the one that started it sees it. has_ended: it makes no more, and tells of the end of none."""

    def __init__(self) -> None:
        """Raises OSError."""
        self.has_ended = False
        self._codes: dict[int, int] = {}
        self._link, other = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        try:
            self._process = subprocess.Popen(
                [sys.executable, "-c", "from iota.cli.nursery import main; main()", str(other.fileno())],
                pass_fds=(other.fileno(),),
                stdin=subprocess.DEVNULL,
                stdout=subprocess.DEVNULL,
                stderr=subprocess.DEVNULL,
                start_new_session=True,  # Ctrl-C is not for it
            )
        except OSError:
            self._link.close()
            raise
        finally:
            other.close()

    def ask(self, wish: bytes, files: list[int]) -> int:
        """The number of a process that was made. Raises OSError."""
        with suppress(OSError):
            socket.send_fds(self._link, [wish], files)
            while (answer := self._take(PATIENCE)) is not None:
                if "made" in answer:
                    return int(answer["made"])
                if "error" in answer:
                    raise OSError(answer["error"])
        self.close()
        raise OSError("the process that makes rooms has ended or hangs")

    def code_of(self, pid: int, seconds: float | None) -> int | None:
        """The exit code of a process; None while it runs, after so long at most, or if it is not known."""
        while pid not in self._codes and not self.has_ended and self._take(seconds) is not None:
            pass
        return self._codes.pop(pid, None)

    def close(self) -> None:
        self.has_ended = True
        self._link.close()
        self._process.kill()
        self._process.wait()

    def _take(self, seconds: float | None) -> dict[str, Any] | None:
        """The next message, whose exit code is noted. None if there is none within this time, or any more."""
        try:
            if not select.select([self._link], [], [], seconds)[0]:
                return None
            text = self._link.recv(MOST)
        except (OSError, ValueError):  # it has ended, or was closed
            text = b""
        if not text:
            self.has_ended = True
            return None
        answer: dict[str, Any] = json.loads(text)
        if "ended" in answer:
            self._codes[answer["ended"]] = answer["code"]
        return answer


# --- the process itself -----------------------------------------------------------------------------------------------


def serve(link: socket.socket, run: Callable[[list[str]], int]) -> None:
    """Until the other end is closed."""
    awake, alarm = os.pipe2(os.O_NONBLOCK | os.O_CLOEXEC)
    signal.set_wakeup_fd(alarm, warn_on_full_buffer=False)
    signal.signal(signal.SIGCHLD, lambda *_: None)
    while True:
        ready = select.select([link.fileno(), awake], [], [])[0]
        if awake in ready:
            with suppress(BlockingIOError):
                while os.read(awake, 256):
                    pass
            tell_of_ended(link)
        if link.fileno() not in ready:
            continue
        text, files, _, _ = socket.recv_fds(link, MOST, MOST_FILES)
        if not text:
            return
        try:
            pid = os.fork()
        except OSError as error:
            link.send(json.dumps({"error": error.strerror}).encode())
        else:
            if pid == 0:
                become(json.loads(text), files, [awake, alarm, link.detach()], run)
            link.send(json.dumps({"made": pid}).encode())
        for file in files:
            os.close(file)


def tell_of_ended(link: socket.socket) -> None:
    with suppress(ChildProcessError):
        while (ended := os.waitpid(-1, os.WNOHANG))[0]:
            told = {"ended": ended[0], "code": os.waitstatus_to_exitcode(ended[1])}
            link.send(json.dumps(told).encode())


def become(wish: dict[str, Any], files: list[int], mine: list[int], run: Callable[[list[str]], int]) -> None:
    """Runs the command line in this copy, and ends it. mine: files of the nursery alone."""
    code = 1
    try:
        signal.set_wakeup_fd(-1)
        signal.signal(signal.SIGCHLD, signal.SIG_DFL)
        gc.freeze()  # what was there stays, and is not written to by looking for garbage
        os.setsid()
        for file in mine:
            os.close(file)
        log, *others = (fcntl.fcntl(file, fcntl.F_DUPFD_CLOEXEC, max(2, *wish["files"]) + 1) for file in files)
        for file in files:
            os.close(file)
        for file, number in zip(others, wish["files"], strict=True):
            os.dup2(file, number, inheritable=False)
            os.close(file)
        os.dup2(log, 1), os.dup2(log, 2)
        os.close(log)
        os.chdir(wish["place"])
        sys.path[0] = wish["place"]  # as for `python -m iota`
        with suppress(OSError):
            Path("/proc/self/comm").write_text(f"room {wish['name']}"[:15])
        if "numpy.random" in sys.modules:  # Python's own random numbers are others in each copy anyway
            sys.modules["numpy"].random.seed()
        sys.argv[1:] = wish["words"]
        code = run(wish["words"])
    except SystemExit as end:
        code = end.code if isinstance(end.code, int) else 1
    except BaseException:
        traceback.print_exc()
    finally:
        for stream in (sys.stdout, sys.stderr):
            with suppress(OSError, ValueError):
                stream.flush()
        os._exit(code)
