# SPDX-License-Identifier: Apache-2.0
"""Rooms and sweeps on several machines, which die. The machines are nodes of Ray on this one."""

from __future__ import annotations

import importlib.util
import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any
from urllib.error import HTTPError
from urllib.parse import urlencode, urlsplit
from urllib.request import urlopen

import pytest
from page_client import PageClient
from pages import needs_browser, open_page
from test_rooms import change, join, running, time_of_return, wait_until
from test_sweeps import sometimes, swing
from websockets.exceptions import ConnectionClosed, InvalidMessage

import iota
from iota.rooms import Cluster, Rooms
from iota.world.page import page_copy

pytestmark = pytest.mark.skipif(importlib.util.find_spec("ray") is None, reason="Ray is not installed")

LOSS = 0.2  # s
BACK = 20.0  # s, on a machine that is busy
MEMORY = 100e6  # bytes of a room


class Machines:
    """A cluster whose head has no room for rooms. alive: the others by their addresses."""

    def __init__(self) -> None:
        from ray.cluster_utils import Cluster as RayCluster

        self._cluster = RayCluster(initialize_head=True, head_node_args={"num_cpus": 0, "include_dashboard": False})
        self.address = self._cluster.address
        self.alive: dict[str, Any] = {}
        self._last = 1
        self.add()

    def add(self) -> str:
        self._last += 1
        host = f"127.0.0.{self._last}"
        self.alive[host] = self._cluster.add_node(
            num_cpus=1, memory=10 * MEMORY, object_store_memory=80 << 20, node_ip_address=host
        )
        return host

    def kill(self, host: str, rooms: Rooms) -> None:
        """All that runs there at once, as a machine that loses its power."""
        there = [room for name, room in rooms.rooms.items() if host_of(rooms, name) == host]
        processes = [room.told.process for room in there]
        nurseries = [parent_of(process) for process in processes]
        everybody = [*map(parent_of, nurseries), *nurseries, *processes]
        for process in everybody:
            os.kill(process, signal.SIGSTOP)  # none sees another one end
        for process in everybody:
            os.kill(process, signal.SIGKILL)
        self.lose(host)

    def lose(self, host: str) -> None:
        self._cluster.remove_node(self.alive.pop(host), allow_graceful=False)

    def close(self) -> None:
        import ray

        ray.shutdown()
        self._cluster.shutdown()


def parent_of(process: int) -> int:
    return int(Path(f"/proc/{process}/stat").read_text().rsplit(")", 1)[1].split()[1])


@pytest.fixture(scope="module")
def machines() -> Iterator[Machines]:
    with pytest.MonkeyPatch.context() as patch:  # a dead machine is known after 3 s instead of 15
        patch.setenv("RAY_health_check_period_ms", "500")
        patch.setenv("RAY_health_check_failure_threshold", "3")
        found = Machines()
        try:
            yield found
        finally:
            found.close()


@contextmanager
def gateway(place: Path, machines: Machines, page: Path | None = None) -> Iterator[Rooms]:
    cluster = Cluster.connect(machines.address, 0.1, MEMORY)
    with running(place, page, cluster=cluster) as rooms:
        yield rooms


def where(rooms: Rooms, name: str, token: str) -> dict[str, Any]:
    base = rooms.url.split("/?")[0]
    return dict(
        json.loads(urlopen(f"{base}/rooms/where?{urlencode({'room': name, 'token': token})}", timeout=20).read())
    )


def enter(rooms: Rooms, name: str, token: str, visitor: str) -> PageClient:
    """As a page does: asks where the room is, and goes there."""
    end = time.monotonic() + 60
    while True:
        try:
            if url := where(rooms, name, token)["url"]:
                return PageClient(url, visitor)
        except (OSError, EOFError, ConnectionClosed, InvalidMessage):
            pass
        assert time.monotonic() < end, where(rooms, name, token)
        time.sleep(0.05)


def host_of(rooms: Rooms, name: str) -> str:
    room = rooms.rooms[name]
    assert room._report is not None
    return room._report.host


def test_rooms_of_a_machine_that_dies_come_back_on_another_with_their_worlds_and_their_clients(
    machines: Machines, tmp_path: Path
) -> None:
    machines.add()
    with gateway(tmp_path / "rooms", machines) as rooms:
        tokens = {
            name: change(rooms, do="make", room=name, source="cradle")["tokens"]["guest"] for name in ("one", "two")
        }  # without functions of forces, which a chain has once it has fallen apart
        pages = {name: enter(rooms, name, token, "Ada") for name, token in tokens.items()}
        wait_until(lambda: all(rooms.rooms[name].people == [("Ada", "guest")] for name in tokens))
        assert {host_of(rooms, name) for name in tokens} == set(machines.alive), "Ray spreads them"
        for page in pages.values():
            page.wait_for(lambda page=page: page.last["poses"]["step"] > 60)
        lost = host_of(rooms, "one")
        machines.kill(lost, rooms)
        began = time.monotonic()
        pages["one"].wait_for(pages["one"].closed.is_set)
        seen = pages["one"].last["poses"]["time"]
        with enter(rooms, "one", tokens["one"], "Ada") as back:
            took = time.monotonic() - began
            wait_until(lambda: rooms.rooms["one"].people == [("Ada", "guest")])
            loss = seen - time_of_return(rooms, "one")
            print(f"back on the other machine after {took:.2f} s; lost {loss:.2f} s")
            assert host_of(rooms, "one") == host_of(rooms, "two") != lost
            assert loss < LOSS + 0.02 and took < BACK
            assert back.last["welcome"]["world"] == "default" and rooms.rooms["one"].restarts == 1
        assert not pages["two"].closed.is_set() and rooms.rooms["two"].restarts == 0
        pages["two"].close()
    assert all(json.loads((tmp_path / "rooms" / name / "state.json").read_text())["is_over"] for name in tokens)


def test_rooms_on_machines_outlive_iota_rooms_and_the_next_one_finds_them(machines: Machines, tmp_path: Path) -> None:
    command = [sys.executable, "-m", "iota", "rooms", str(tmp_path / "rooms"), "--port", "0", "--no-open"]
    words = [*command, "--ray", machines.address, "--room-memory", str(MEMORY / 1e6)]
    first = subprocess.Popen(words, stdout=subprocess.PIPE, text=True)
    assert first.stdout is not None
    with first:
        url = first.stdout.readline().split()[-1]
        made = urlopen(url.replace("/?", "/rooms/change?do=make&room=one&source=chain&"), data=b"", timeout=20)
        token = json.loads(made.read())["rooms"][0]["tokens"]["host"]
        asked = f"{url.split('/?')[0]}/rooms/where?room=one&token={token}"
        wait_until(lambda: json.loads(urlopen(asked, timeout=20).read())["url"])
        page = join(json.loads(urlopen(asked, timeout=20).read())["url"], "Ada")
        first.kill()
    with page:
        step = page.last["poses"]["step"]
        page.wait_for(lambda: page.last["poses"]["step"] > step + 60)
        with gateway(tmp_path / "rooms", machines) as rooms:
            wait_until(lambda: rooms.rooms["one"].people == [("Ada", "host")])
            assert not page.closed.is_set()


def test_a_link_leads_to_its_own_room_and_a_closed_one_does_not_start(machines: Machines, tmp_path: Path) -> None:
    with gateway(tmp_path / "rooms", machines) as rooms:
        one = change(rooms, do="make", room="one", source="chain")
        for name, token in (("one", rooms.tokens[2]), ("one", ""), ("two", one["tokens"]["host"])):
            with pytest.raises(HTTPError, match="403"):
                where(rooms, name, token)
        change(rooms, do="close", room="one")
        assert where(rooms, "one", one["tokens"]["viewer"]) == {"url": "", "state": "closed", "trouble": ""}
        change(rooms, do="open", room="one")
        with enter(rooms, "one", one["tokens"]["host"], "Ada") as page:
            page.wait_for(lambda: page.last["poses"]["step"] > 60)
            assert change(rooms, do="begin_anew", room="one")["state"] == "asleep"
            page.wait_for(page.closed.is_set)
        with enter(rooms, "one", one["tokens"]["host"], "Ada") as page:
            assert page.last["poses"]["step"] < 60
        change(rooms, do="delete", room="one")
        assert list(rooms._folder.glob("deleted/one-1/journal/aside-1/*.journal"))


def test_a_room_that_no_machine_has_memory_for_waits_and_says_so(
    machines: Machines, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("iota.rooms.cluster.SCARCE", 0.5)
    cluster = Cluster.connect(machines.address, 0.1, 1e14)
    with running(tmp_path / "rooms", cluster=cluster) as rooms:
        token = change(rooms, do="make", room="one", source="chain")["tokens"]["host"]
        wait_until(lambda: where(rooms, "one", token)["trouble"], seconds=60)
        told = where(rooms, "one", token)
        assert told["state"] == "starting" and told["trouble"].startswith(
            "it waits for a machine with 0.1 cores and 100000000 MB"
        )


def test_without_a_cluster_it_says_what_to_start(tmp_path: Path) -> None:
    words = [sys.executable, "-m", "iota", "rooms", str(tmp_path / "rooms"), "--no-open", "--ray", "127.0.0.1:1"]
    done = subprocess.run(words, capture_output=True, text=True, timeout=60)
    assert done.returncode == 1 and done.stderr.splitlines() == [
        "iota: there is no Ray cluster at 127.0.0.1:1 (Connection refused). Try: ray start --head"
    ]


def test_more_memory_than_ray_can_count_is_refused(machines: Machines) -> None:
    with pytest.raises(ValueError, match=r"at most 1e\+14 cores and 1e\+14 bytes, not 0.1 and 1e\+15"):
        Cluster.connect(machines.address, 0.1, 1e15)


@needs_browser
def test_a_page_follows_its_room_to_another_machine_by_itself(machines: Machines, tmp_path: Path) -> None:
    with (
        page_copy("rooms.html") as place,
        gateway(tmp_path / "rooms", machines, Path(place)) as rooms,
        open_page(500, 400) as page,
    ):
        page.goto(rooms.url)
        change(rooms, do="make", room="one", source="chain")
        page.get_by_label("Enter one").click()
        page.wait_for_function("() => globalThis.iota?.connected && iota.step > 0", timeout=60_000)
        wait_until(lambda: rooms.rooms["one"].people)
        lost = host_of(rooms, "one")
        assert urlsplit(page.url).hostname == lost
        machines.add()
        machines.kill(lost, rooms)
        page.wait_for_url(
            lambda url: urlsplit(url).hostname not in (lost, urlsplit(rooms.url).hostname), timeout=60_000
        )
        page.wait_for_function("() => globalThis.iota?.connected && iota.step > 0", timeout=60_000)
        assert urlsplit(page.url).hostname in machines.alive


def test_a_sweep_on_machines_has_the_rows_of_one_here_and_survives_them(machines: Machines, tmp_path: Path) -> None:
    grid = {"stiffness": [10.0, 1000 / 3], "seed": range(40)}
    here = iota.sweep(swing, grid, tmp_path / "here.csv", processes=0)
    for _ in range(2 - len(machines.alive)):
        machines.add()
    doomed = next(iter(machines.alive))

    def progress(done: int, all: int, failed: int) -> None:
        if done == 20:
            machines.lose(doomed)

    assert iota.sweep(swing, grid, tmp_path / "there.csv", progress=progress, ray=machines.address) == here
    assert (tmp_path / "there.csv").read_bytes() == (tmp_path / "here.csv").read_bytes()


def test_a_run_on_a_machine_that_dies_twice_is_a_row_with_its_inputs(machines: Machines) -> None:
    if not machines.alive:
        machines.add()
    rows = iota.sweep(sometimes, {"stiffness": [1.5], "seed": [1, 2, 3, 4]}, ray=machines.address)
    assert [(row["seed"], row["result"], row["error"]) for row in rows] == [
        (1, 1.5, ""),
        (2, None, "ValueError: not this one"),
        (3, None, "its process died 2 times, at last by WorkerCrashedError"),
        (4, 6.0, ""),
    ]
    with pytest.raises(ValueError, match="processes or ray, not both"):
        iota.sweep(sometimes, {"stiffness": [1.5], "seed": [1]}, processes=1, ray=machines.address)
