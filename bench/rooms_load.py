#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Many rooms with visitors on this machine: processor time, memory, how long joining takes, and `iota rooms` gone for a minute.

    .venv/bin/python bench/rooms_load.py                  # 200 rooms of 4 visitors
    .venv/bin/python bench/rooms_load.py --rooms 20 --gone 5

Each room is an idle world at 10 Hz. A visitor is a socket with the protocol of the page, which asks for the round trip every 2 s. The first one wakes
the room; the others join when all rooms are awake. At the end some rooms are killed, and `iota rooms`. A spin of 10 ms of processor time beside them, again and again, tells how much of the delay is
the machine's: the same quantile of how long it took.
"""

from __future__ import annotations

import argparse
import base64
import json
import os
import select
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import time
from collections import deque
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit
from urllib.request import Request, urlopen

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests" / "python"))
from page_client import CONSTANTS, SCHEMA, TO_CLIENT, encode

SCRIPT = """
import iota

system = iota.System(threads=1)
for n in range(5):
    system.body(shape=iota.Box((0.2, 0.2, 0.2)), position=(0.4 * n, 0.1, 0))
iota.World(system, title="idle", dt=0.1).run()
"""
POSES = next(number for number, message in TO_CLIENT.items() if message["name"] == "poses")
KILLED = 20  # rooms
PING, TICKS = 2.0, os.sysconf("SC_CLK_TCK")


def frame(payload: bytes) -> bytes:
    """Of a client, masked by zeros."""
    assert len(payload) < 126
    return bytes([0x82, 0x80 | len(payload)]) + bytes(4) + payload


HELLO = frame(encode("hello", magic=CONSTANTS["protocol_magic"], version=SCHEMA["version"], world="", role=0, name="v"))


class Visitor:
    """joined: s from the first packet to the first poses. refusals: of the server, before that. heard: when something came last, s."""

    joined = 0.0
    refusals = 0
    heard = 0.0
    is_dropped = False

    def join(self, url: str) -> None:
        """Tries again as a page does where the machine is too busy for the server's time limits."""
        began = time.perf_counter()
        while True:
            try:
                self.socket = self._try_to_join(url)
                break
            except OSError:
                self.refusals += 1
        self.joined = time.perf_counter() - began

    def _try_to_join(self, url: str) -> socket.socket:
        parts = urlsplit(url)
        made = socket.create_connection((parts.hostname, parts.port), timeout=120)
        made.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        key = base64.b64encode(os.urandom(16)).decode()
        made.sendall(
            f"GET /ws?{parts.query} HTTP/1.1\r\nHost: {parts.netloc}\r\nOrigin: http://{parts.netloc}\r\nUpgrade: websocket\r\n"
            f"Connection: Upgrade\r\nSec-WebSocket-Key: {key}\r\nSec-WebSocket-Version: 13\r\n\r\n".encode()
        )
        with made.makefile("rb") as heard:
            if b" 101 " not in (head := b"".join(iter(heard.readline, b"\r\n"))):
                made.close()
                raise OSError(head.decode("utf-8", "replace") or "closed")
            made.sendall(HELLO)
            while True:
                kind, size = self._read(heard, 2)
                if size > 125:
                    size = int.from_bytes(self._read(heard, 2 if size == 126 else 8), "big")
                payload = self._read(heard, size)
                if kind == 0x82 and payload[0] == POSES:
                    return made

    @staticmethod
    def _read(heard: Any, count: int) -> bytes:
        data: bytes = heard.read(count)
        if len(data) < count:
            raise OSError("closed")
        return data


class Crowd(threading.Thread):
    """Visitors that read whatever comes, and ask for the round trip now and then: little of the machine's time is theirs."""

    def __init__(self) -> None:
        super().__init__(daemon=True)
        self._poll = select.epoll()
        self._all: dict[int, Visitor] = {}
        self._due: deque[tuple[float, Visitor]] = deque()
        self.is_over = False

    def add(self, visitor: Visitor) -> None:
        visitor.socket.setblocking(False)
        self._all[visitor.socket.fileno()] = visitor
        self._due.append((time.monotonic() + PING, visitor))
        self._poll.register(visitor.socket, select.EPOLLIN)

    def run(self) -> None:
        while not self.is_over:
            for number, _ in self._poll.poll(0.05):
                self._hear(self._all[number])
            now = time.monotonic()
            while self._due and self._due[0][0] < now:
                visitor = self._due.popleft()[1]
                if not visitor.is_dropped:
                    self._ask(visitor, now)

    def _hear(self, visitor: Visitor) -> None:
        try:
            is_open = bool(visitor.socket.recv(1 << 16))
        except OSError:
            is_open = False
        visitor.heard = time.monotonic()
        if not is_open:
            visitor.is_dropped = True
            self._poll.unregister(visitor.socket)

    def _ask(self, visitor: Visitor, now: float) -> None:
        try:
            visitor.socket.send(frame(encode("ping", client_time=now)))
            self._due.append((now + PING, visitor))
        except OSError:
            visitor.is_dropped = True


def start(folder: Path, scripts: Path) -> tuple[subprocess.Popen[str], str]:
    words = [sys.executable, "-m", "iota", "rooms", str(folder), "--scripts", str(scripts), "--port", "0", "--no-open"]
    started = subprocess.Popen(words, stdout=subprocess.PIPE, text=True)
    assert started.stdout is not None
    return started, started.stdout.readline().split()[-1]


def listed(url: str) -> list[dict[str, Any]]:
    found: list[dict[str, Any]] = json.loads(urlopen(url.replace("/?", "/rooms.json?"), timeout=60).read())["rooms"]
    return found


def processor_time(process: int) -> float:
    fields = Path(f"/proc/{process}/stat").read_text().rsplit(")", 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / TICKS


def memory(process: int) -> float:
    """Its share of the memory, MB: what several processes have is divided among them."""
    lines = Path(f"/proc/{process}/smaps_rollup").read_text().splitlines()
    return next(int(line.split()[1]) for line in lines if line.startswith("Pss:")) / 1e3


def quantiles(visitors: list[Visitor]) -> str:
    return quantiles_of([visitor.joined for visitor in visitors])


def quantiles_of(seconds: list[float]) -> str:
    ordered = sorted(seconds)
    at = [ordered[min(len(ordered) - 1, int(q * len(ordered)))] for q in (0.5, 0.99)]
    return f"{at[0]:.3f} s median, {at[1]:.3f} s at 99 %"


def spin(until: list[bool], took: list[float]) -> None:
    """10 ms of processor time, ten times a second, in a process of its own."""
    words = "import time\nwhile True:\n time.sleep(0.1); b = time.perf_counter(); c = time.process_time()\n while time.process_time() < c + 0.01: pass\n print(time.perf_counter() - b, flush=True)"
    with subprocess.Popen([sys.executable, "-c", words], stdout=subprocess.PIPE, text=True) as spinning:
        assert spinning.stdout is not None
        while not until:
            took.append(float(spinning.stdout.readline()))
        spinning.kill()


def measure(rooms: int, visitors: int, gone: float) -> None:
    with tempfile.TemporaryDirectory(prefix="iota-load-") as place:
        scripts, folder = Path(place) / "scripts", Path(place) / "rooms"
        scripts.mkdir()
        (scripts / "idle.py").write_text(SCRIPT)
        hosting, url = start(folder, scripts)
        crowd = Crowd()
        crowd.start()
        try:
            for number in range(rooms):
                change = f"/rooms/change?do=make&room=r{number}&source=idle.py&"
                urlopen(Request(url.replace("/?", change), method="POST"), timeout=60).read()
            links = [f"http://127.0.0.1:{room['port']}/?token={room['tokens']['guest']}" for room in listed(url)]
            began = time.perf_counter()
            first = join_all(links, crowd)
            print(
                f"{rooms} rooms woken one by one in {time.perf_counter() - began:.0f} s: {quantiles(first)}", flush=True
            )
            until: list[bool] = []
            spun: list[float] = []
            spinning = threading.Thread(target=spin, args=(until, spun))
            spinning.start()
            try:
                others = join_all([link for link in links for _ in range(visitors - 1)], crowd)
            finally:
                until.append(True)
                spinning.join()
            refusals = sum(visitor.refusals for visitor in others)
            print(f"{len(others)} joins, one by one: {quantiles(others)}; {refusals} tried again")
            print(f"10 ms of processor time meanwhile: {quantiles_of(spun)}", flush=True)
            everybody = first + others
            processes = [json.loads(file.read_text())["process"] for file in folder.glob("*/state.json")]
            mine = os.getpid()
            before, began = [processor_time(each) for each in (*processes, hosting.pid, mine)], time.perf_counter()
            time.sleep(30)
            after = [processor_time(each) for each in (*processes, hosting.pid, mine)]
            seconds = time.perf_counter() - began
            spent = [(then - was) / seconds for then, was in zip(after, before, strict=True)]
            print(
                f"{len(everybody)} visitors: {sum(spent[:-2]):.3f} cores for {len(processes)} rooms, {spent[-2]:.3f} for iota rooms, {spent[-1]:.3f} for the visitors; "
                f"{sum(map(memory, processes)) / len(processes):.1f} MB a room, {memory(hosting.pid):.0f} MB iota rooms; load {os.getloadavg()[0]:.1f}",
                flush=True,
            )
            reached = [told(file)["reached_speed"] for file in folder.glob("*/state.json")]
            print(
                f"the slowest room reaches {min(reached):.2f} of its speed; {sum(v.is_dropped for v in everybody)} visitors dropped"
            )
            back = [
                kill(process, link) for process, link in list(zip(processes_of(folder), links, strict=True))[:KILLED]
            ]
            print(f"{len(back)} rooms killed one by one, back with a visitor after: {quantiles_of(back)}", flush=True)
            hosting.send_signal(signal.SIGKILL)
            hosting.wait()
            there = [visitor for visitor in everybody if not visitor.is_dropped]
            time.sleep(gone)
            dropped = [visitor for visitor in there if visitor.is_dropped]
            silence = time.monotonic() - min((v.heard for v in there if not v.is_dropped), default=0.0)
            print(
                f"iota rooms gone for {gone:.0f} s: {len(dropped)} of {len(there)} visitors dropped; "
                f"the others heard of their rooms at most {silence:.1f} s before its end",
                flush=True,
            )
            hosting, url = start(folder, scripts)
            time.sleep(5)
            found = listed(url)
            people = sum(len(room["people"]) for room in found)
            print(
                f"the next one found {sum(room['state'] == 'running' for room in found)} rooms with {people} visitors; load {os.getloadavg()[0]:.1f}"
            )
        finally:
            crowd.is_over = True
            hosting.terminate()
            hosting.wait(120)


def join_all(links: list[str], crowd: Crowd) -> list[Visitor]:
    made = []
    for link in links:
        made.append(Visitor())
        made[-1].join(link)
        crowd.add(made[-1])
    return made


def told(file: Path) -> dict[str, Any]:
    found: dict[str, Any] = json.loads(file.read_text())
    return found


def processes_of(folder: Path) -> list[int]:
    """In the order of the list, which is that of names."""
    return [told(file)["process"] for file in sorted(folder.glob("*/state.json"))]


def kill(process: int, link: str) -> float:
    """Seconds until a visitor has poses of the room again."""
    began = time.perf_counter()
    os.kill(process, signal.SIGKILL)
    while Path(f"/proc/{process}").exists():
        time.sleep(0.001)
    Visitor().join(link)
    return time.perf_counter() - began


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--rooms", type=int, default=200)
    parser.add_argument("--visitors", type=int, default=4)
    parser.add_argument("--gone", type=float, default=60, help="s without iota rooms")
    arguments = parser.parse_args()
    measure(arguments.rooms, arguments.visitors, arguments.gone)


if __name__ == "__main__":
    main()
