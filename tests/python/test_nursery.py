# SPDX-License-Identifier: Apache-2.0
"""The process from which those of rooms are copied."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
from test_rooms import change, join, link, number, running, wait_until

from iota.rooms.nursery import Nursery, Nursling

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="reads /proc")

SCRIPT = """
import json, os, random, sys, time
import numpy
import iota
told = {"process": os.getpid(), "session": os.getsid(0), "place": os.getcwd(), "file": sys.argv, "numbers": [random.random(), numpy.random.rand()],
    "seconds": time.process_time(), "open": [os.readlink(f"/proc/self/fd/{n}") for n in range(64) if os.path.exists(f"/proc/self/fd/{n}")]}
print(json.dumps(told), flush=True)
how = open("how").read()
if how == "hang": time.sleep(60)
if how: sys.exit(int(how))
iota.World(iota.System()).run(seconds=0.1)
"""


@pytest.fixture
def nursery() -> Iterator[Nursery]:
    made = Nursery()
    yield made
    made.close()


def make(nursery: Nursery, place: Path, how: str) -> Nursling:
    place.mkdir()
    (place / "how").write_text(how)
    (place / "script.py").write_text(SCRIPT)
    (place / "other").touch()
    log = os.open(place / "log", os.O_WRONLY | os.O_CREAT)
    other = os.open(place / "other", os.O_RDONLY)
    try:
        made = nursery.make(["run", "script.py", "--headless"], place, place.name, log, [other])
    finally:
        os.close(log), os.close(other)
    assert isinstance(made, Nursling)
    return made


def told(place: Path) -> dict[str, object]:
    wait_until(lambda: (place / "log").read_text().count("\n"))
    found: dict[str, object] = json.loads((place / "log").read_text().splitlines()[0])
    return found


@pytest.mark.parametrize(("how", "code"), [("", 0), ("3", 3)])
def test_the_end_of_a_process_is_told_by_its_code(nursery: Nursery, tmp_path: Path, how: str, code: int) -> None:
    made = make(nursery, tmp_path / "one", how)
    assert made.wait(60) == code, (tmp_path / "one" / "log").read_text()
    assert made.poll() == made.returncode == code


def test_a_process_has_its_own_session_folder_log_files_and_random_numbers(nursery: Nursery, tmp_path: Path) -> None:
    processes = {name: make(nursery, tmp_path / name, "hang") for name in ("one", "two")}
    found = {name: told(tmp_path / name) for name in processes}
    for name, process in processes.items():
        place = str(tmp_path / name)
        assert found[name]["process"] == found[name]["session"] == process.pid
        assert found[name]["place"] == place and found[name]["file"] == ["script.py"]
        assert Path(f"/proc/{process.pid}/comm").read_text() == f"room {name}\n"
        files = found[name]["open"]
        assert isinstance(files, list) and files.count(f"{place}/log") == 2 and files.count(f"{place}/other") == 1
        assert not [file for file in files if file.startswith("socket")], "the link of the nursery is its own"
        assert process.poll() is None
    assert not set(map(str, found["one"]["numbers"])) & set(map(str, found["two"]["numbers"]))  # type: ignore[call-overload]
    with pytest.raises(subprocess.TimeoutExpired):
        processes["two"].wait(0.05)
    processes["one"].kill()
    assert processes["one"].wait(20) == -signal.SIGKILL and processes["two"].poll() is None
    processes["two"].send_signal(signal.SIGTERM)
    assert processes["two"].wait(20) == 130


def test_a_process_begins_with_a_third_of_the_time_of_a_bare_one(nursery: Nursery, tmp_path: Path) -> None:
    make(nursery, tmp_path / "one", "").wait(60)
    seconds = told(tmp_path / "one")["seconds"]
    bare = subprocess.run([sys.executable, "-c", "import iota, time; print(time.process_time())"], capture_output=True)
    print(f"{seconds} s of processor time, alone {bare.stdout.decode().strip()}")
    assert isinstance(seconds, float) and seconds < float(bare.stdout) / 3


def test_a_room_outlives_the_process_from_which_it_was_copied_and_comes_back_from_a_new_one(tmp_path: Path) -> None:
    with running(tmp_path / "rooms") as rooms:
        url = link(change(rooms, do="make", room="one", source="chain"))
        with join(url, "Ada") as page:
            before = number(rooms, "one")
            running_nursery = rooms._nursery._running
            assert running_nursery is not None
            running_nursery._process.kill()
            step = page.last["poses"]["step"]
            page.wait_for(lambda: page.last["poses"]["step"] > step + 60)
            wait_until(lambda: rooms.rooms["one"].people)
            assert number(rooms, "one") == before and rooms.rooms["one"].state == "running"
            os.kill(before, signal.SIGKILL)
            began = time.monotonic()
            page.wait_for(page.closed.is_set)
        with join(url, "Ada") as back:
            assert time.monotonic() - began < 20 and number(rooms, "one") != before
            assert back.last["poses"]["step"] > step and rooms.rooms["one"].restarts == 1
