#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Many rooms with visitors on this machine: processor time, memory, how long joining takes, and `iota rooms` gone for a minute.

    .venv/bin/python bench/rooms_load.py                  # 200 rooms of 4 visitors
    .venv/bin/python bench/rooms_load.py --rooms 20 --gone 5

Each room is an idle world at 10 Hz. A visitor is a socket with the protocol of the page, which asks for the round trip every 2 s. The first one wakes
the room; the others join when all rooms are awake. A spin of 10 ms of processor time beside them, again and again, tells how much of the delay is
the machine's: the same quantile of how long it took.
"""

from __future__ import annotations

import argparse
import asyncio
import json
import os
import signal
import subprocess
import sys
import tempfile
import time
from contextlib import suppress
from pathlib import Path
from typing import Any
from urllib.request import Request, urlopen

from websockets.asyncio.client import ClientConnection, connect
from websockets.exceptions import ConnectionClosed, InvalidMessage

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
PING, TICKS = 2.0, os.sysconf("SC_CLK_TCK")


class Visitor:
    """joined: s from the first packet to the first poses. refusals: of the server, before that."""

    joined = 0.0
    refusals = 0
    is_dropped = False

    async def join(self, url: str) -> None:
        """Tries again as a page does where the machine is too busy for the server's time limits."""
        began = time.perf_counter()
        while True:
            with suppress(OSError, EOFError, InvalidMessage, ConnectionClosed):
                await self._try_to_join(url)
                break
            self.refusals += 1
        self.joined = time.perf_counter() - began
        self.tasks = [asyncio.create_task(self._read()), asyncio.create_task(self._ping())]

    async def _try_to_join(self, url: str) -> None:
        address = url.replace("http:", "ws:").replace("/?", "/ws?")
        self.socket: ClientConnection = await connect(
            address, origin=url.split("/?")[0], max_size=None, proxy=None, compression=None, open_timeout=120
        )  # type: ignore[arg-type]
        await self.socket.send(
            encode("hello", magic=CONSTANTS["protocol_magic"], version=SCHEMA["version"], world="", role=0, name="v")
        )
        while (await self.socket.recv(decode=False))[0] != POSES:
            pass

    async def _read(self) -> None:
        try:
            async for _ in self.socket:
                pass
        finally:
            self.is_dropped = True

    async def _ping(self) -> None:
        while not self.is_dropped:
            await asyncio.sleep(PING)
            with suppress(Exception):
                await self.socket.send(encode("ping", client_time=time.perf_counter()))


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


def quantiles(seconds: list[float]) -> str:
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


async def measure(rooms: int, visitors: int, gone: float) -> None:
    with tempfile.TemporaryDirectory(prefix="iota-load-") as place:
        scripts, folder = Path(place) / "scripts", Path(place) / "rooms"
        scripts.mkdir()
        (scripts / "idle.py").write_text(SCRIPT)
        hosting, url = start(folder, scripts)
        try:
            for number in range(rooms):
                change = f"/rooms/change?do=make&room=r{number}&source=idle.py&"
                urlopen(Request(url.replace("/?", change), method="POST"), timeout=60).read()
            links = [f"http://127.0.0.1:{room['port']}/?token={room['tokens']['guest']}" for room in listed(url)]
            first = [Visitor() for _ in links]
            for visitor, link in zip(first, links, strict=True):
                await visitor.join(link)
            print(f"{rooms} rooms woken one by one: {quantiles([visitor.joined for visitor in first])}", flush=True)
            until: list[bool] = []
            spun: list[float] = []
            spinning = asyncio.create_task(asyncio.to_thread(spin, until, spun))
            others = []
            try:
                for link in links:
                    for _ in range(visitors - 1):
                        others.append(Visitor())
                        await others[-1].join(link)
            finally:
                until.append(True)
                await spinning
            refusals = sum(visitor.refusals for visitor in others)
            print(
                f"{len(others)} joins, one by one: {quantiles([visitor.joined for visitor in others])}; {refusals} tried again"
            )
            print(f"10 ms of processor time meanwhile: {quantiles(spun)}", flush=True)
            everybody = first + others
            processes = [json.loads(file.read_text())["process"] for file in folder.glob("*/state.json")]
            before, began = [processor_time(each) for each in (*processes, hosting.pid)], time.perf_counter()
            await asyncio.sleep(30)
            spent = [processor_time(each) - was for each, was in zip((*processes, hosting.pid), before, strict=True)]
            seconds = time.perf_counter() - began
            print(
                f"{len(everybody)} visitors: {sum(spent[:-1]) / seconds:.3f} cores for {len(processes)} rooms, {spent[-1] / seconds:.3f} for iota rooms; "
                f"{sum(map(memory, processes)) / len(processes):.1f} MB a room, {memory(hosting.pid):.0f} MB iota rooms"
            )
            hosting.send_signal(signal.SIGKILL)
            hosting.wait()
            await asyncio.sleep(gone)
            dropped = sum(visitor.is_dropped for visitor in everybody)
            print(f"iota rooms gone for {gone:.0f} s: {dropped} of {len(everybody)} visitors dropped", flush=True)
            hosting, url = start(folder, scripts)
            await asyncio.sleep(5)
            found = listed(url)
            people = sum(len(room["people"]) for room in found)
            print(
                f"the next one found {sum(room['state'] == 'running' for room in found)} rooms with {people} visitors; load {os.getloadavg()[0]:.1f}"
            )
            for visitor in everybody:
                for task in visitor.tasks:
                    task.cancel()
        finally:
            hosting.terminate()
            hosting.wait(120)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--rooms", type=int, default=200)
    parser.add_argument("--visitors", type=int, default=4)
    parser.add_argument("--gone", type=float, default=60, help="s without iota rooms")
    arguments = parser.parse_args()
    asyncio.run(measure(arguments.rooms, arguments.visitors, arguments.gone))


if __name__ == "__main__":
    main()
