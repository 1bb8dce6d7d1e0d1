# SPDX-License-Identifier: Apache-2.0
"""`iota rooms`: kept worlds in processes of their own, which come back."""

from __future__ import annotations

import http.client
import json
import os
import random
import re
import signal
import socket
import statistics
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any, cast
from urllib.error import HTTPError
from urllib.parse import urlencode
from urllib.request import Request, urlopen

import pytest
from amount import TRIES_ALL
from page_client import PageClient
from pages import listen_for_complaints, needs_browser, open_page
from waiting import PATIENCE, wait_until
from websockets.exceptions import ConnectionClosed, InvalidMessage, InvalidStatus

from iota.journal.folder import BusyError
from iota.rooms import Rooms, folder, process
from iota.world.page import page_copy, page_folder, token_for

BACK = 3.0  # s, within which a killed room has to be back
LOSS = 0.2  # s
KILLS = int(os.environ.get("IOTA_KILLS", "20" if TRIES_ALL else "6"))


@contextmanager
def running(place: Path, page: Path | None = None, **more: Any) -> Iterator[Rooms]:
    rooms = Rooms(place, page or page_folder(), port=0, **more)
    stopped = threading.Event()
    runner = threading.Thread(target=rooms.run, args=(lambda: not stopped.is_set(),), daemon=True)
    runner.start()
    try:
        yield rooms
    finally:
        stopped.set()
        runner.join(20)
        assert not runner.is_alive()


@pytest.fixture
def rooms(tmp_path: Path) -> Iterator[Rooms]:
    with running(tmp_path / "rooms", scripts=tmp_path) as rooms:
        yield rooms


def ask(rooms: Rooms, path: str, method: str = "GET", token: str | None = None, **query: str) -> bytes:
    query["token"] = token or rooms.tokens[2]
    base = rooms.url.split("/?")[0]
    return bytes(urlopen(Request(f"{base}{path}?{urlencode(query)}", method=method), timeout=20).read())


def change(rooms: Rooms, **query: str) -> dict[str, Any]:
    """The room that was named, as it is then; {} if it is gone."""
    listing = json.loads(ask(rooms, "/rooms/change", "POST", **query))
    return next((room for room in listing["rooms"] if room["name"] == query["room"]), {})


def refusal(rooms: Rooms, **query: str) -> str:
    with pytest.raises(HTTPError) as refused:
        change(rooms, **query)
    return refused.value.read().decode().strip()


def link(room: dict[str, Any], role: str = "host") -> str:
    return f"http://127.0.0.1:{room['port']}/?token={room['tokens'][role]}"


def join(url: str, name: str = "") -> PageClient:
    """As a page does: again and again."""
    end = time.monotonic() + PATIENCE
    while True:
        try:
            return PageClient(url, name)
        except (OSError, ConnectionClosed, InvalidMessage, EOFError):
            assert time.monotonic() < end
            time.sleep(0.05)


def number(rooms: Rooms, name: str) -> int:
    """Of the process of a room: it may answer a page before the list has heard of it."""
    wait_until(lambda: rooms.rooms[name].number is not None)
    return cast(int, rooms.rooms[name].number)


def test_a_room_wakes_with_a_visitor_sleeps_without_one_and_goes_on_where_it_was(tmp_path: Path) -> None:
    with running(tmp_path / "rooms", leave=0.6) as rooms:
        room = change(rooms, do="make", room="one", source="chain")
        assert room["state"] == "asleep" and not rooms.rooms["one"].has_process
        with join(link(room), "Ada") as page:
            page.wait_for(lambda: page.last["poses"]["step"] > 30)
            wait_until(lambda: rooms.rooms["one"].people == [("Ada", "host")])
            assert rooms.rooms["one"].state == "running"
            step = page.last["poses"]["step"]
        wait_until(lambda: rooms.rooms["one"].state == "asleep")
        with join(link(room)) as page:
            assert page.last["poses"]["step"] >= step
        assert rooms.rooms["one"].restarts == 0, "it ended in an orderly way"


def come_back(rooms: Rooms, name: str, url: str, kills: int, seed: int) -> list[tuple[float, float]]:
    """Seconds until the same client is back, and seconds of the world that were lost, for each of so many kills."""
    chance, told = random.Random(seed), []
    page = join(url, f"visitor of {name}")
    try:
        for _ in range(kills):
            time.sleep(0.3 * chance.random())
            killed = number(rooms, name)
            os.kill(killed, signal.SIGKILL)
            began = time.monotonic()
            page.wait_for(page.closed.is_set)
            seen = page.last["poses"]["time"]
            page.close()
            page = join(url, f"visitor of {name}")
            told.append((time.monotonic() - began, seen - time_of_return(rooms, name)))
            assert page.last["welcome"]["world"] == "default" and number(rooms, name) != killed
    finally:
        page.close()
    return told


def time_of_return(rooms: Rooms, name: str) -> float:
    """As the room told it, s. A room that was killed before its first record begins anew, which is told as lost."""
    lines = (rooms.rooms[name].folder.path / "log").read_text().split("--- ")[-1]
    found = re.search(r"goes on where it was: t = ([\d.]+) s", lines)
    assert "could not be repeated" not in lines and "begins anew" not in lines, lines
    return 0.0 if found is None else float(found[1])


def test_a_room_that_is_killed_comes_back_with_its_clients_and_its_world(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(process, "MOST_DEATHS", KILLS)
    kills = KILLS
    results: dict[str, list[tuple[float, float]]] = {}
    began = time.monotonic()
    subprocess.run([sys.executable, "-c", "import iota"], check=True)
    bare = time.monotonic() - began
    with running(tmp_path / "rooms") as rooms:
        urls = {name: link(change(rooms, do="make", room=name, source="chain")) for name in ("one", "two")}

        def kill(name: str) -> None:
            results[name] = come_back(rooms, name, urls[name], kills // 2, seed=len(name))

        threads = [threading.Thread(target=kill, args=(name,)) for name in urls]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        assert [room.restarts for room in rooms.rooms.values()] == [kills // 2] * 2
    told = [each for found in results.values() for each in found]
    median, (most, lost) = statistics.median(back for back, _ in told), map(max, zip(*told, strict=True))
    print(
        f"{len(told)} kills: back after {median:.2f} s in the median, {most:.2f} s at most; lost {lost:.2f} s at most"
    )
    assert len(told) == kills and median < BACK and lost < LOSS + 0.02
    assert most < BACK + 10 * bare, "ten times the start of a bare process, on a machine that is busy"


def start(place: Path) -> tuple[subprocess.Popen[str], str]:
    """`iota rooms`, and the address of its page."""
    command = [sys.executable, "-m", "iota", "rooms", str(place), "--port", "0", "--no-open"]
    started = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
    assert started.stdout is not None
    return started, started.stdout.readline().split()[-1]


def listed(url: str) -> dict[str, dict[str, Any]]:
    listing = json.loads(urlopen(url.replace("/?", "/rooms.json?"), timeout=20).read())
    return {room["name"]: room for room in listing["rooms"]}


def test_no_client_notices_that_iota_rooms_was_killed_and_the_next_one_finds_its_rooms(tmp_path: Path) -> None:
    place = tmp_path / "rooms"
    first, url = start(place)
    make = Request(url.replace("/?", "/rooms/change?do=make&room=one&source=chain&"), method="POST")
    room = json.loads(urlopen(make).read())["rooms"][0]
    with join(link(room), "Ada") as page, first:
        wait_until(lambda: listed(url)["one"]["people"])
        second = subprocess.run([sys.executable, "-m", "iota", "rooms", str(place)], capture_output=True, text=True)
        assert second.returncode == 1 and second.stderr.count("\n") == 1
        assert f"are served already (process {first.pid})" in second.stderr
        first.kill()
        first.wait()
        step = page.last["poses"]["step"]
        page.wait_for(lambda: page.last["poses"]["step"] > step + 60)
        with join(link(room, "guest"), "Ben"):
            again, url = start(place)
            with again:
                wait_until(lambda: len(listed(url)["one"]["people"]) == 2)
                assert listed(url)["one"]["state"] == "running" and not page.closed.is_set()
                alive = json.loads((place / "one" / "state.json").read_text())["process"]
                os.kill(alive, signal.SIGKILL)  # no child of the second one
                page.wait_for(page.closed.is_set)
                with join(link(room), "Ada") as back:
                    assert back.last["poses"]["step"] > step
                    again.terminate()
                    assert again.wait(20) == 0
                    back.wait_for(back.closed.is_set)
    assert json.loads((place / "one" / "state.json").read_text())["is_over"]


def test_a_token_leads_to_its_own_room_in_its_own_role(rooms: Rooms) -> None:
    one = change(rooms, do="make", room="one", source="chain")
    two = change(rooms, do="make", room="two", source="chain")
    with join(link(one, "viewer")) as page:
        page.send("control", command=0, value=0.0)
        page.wait_for(lambda: page.notices)
        assert page.notices[-1]["title"] == "You only watch"
    for token in (one["tokens"]["host"], rooms.tokens[2]):
        with pytest.raises(InvalidStatus, match="403"):
            PageClient(f"http://127.0.0.1:{two['port']}/?token={token}")
    with pytest.raises(HTTPError, match="403"):
        ask(rooms, "/rooms.json", token=one["tokens"]["host"])
    with pytest.raises(HTTPError, match="403"):
        ask(rooms, "/rooms.json", token=rooms.tokens[0])
    assert oct((rooms.rooms["one"].folder.path).stat().st_mode)[-3:] == "700", "it has the secret"


def test_bad_input_is_refused_in_one_line_that_says_what_to_try(rooms: Rooms, monkeypatch: pytest.MonkeyPatch) -> None:
    assert refusal(rooms, do="make", room="../up", source="chain").endswith("not '../up'. Try: physics-101")
    assert refusal(rooms, do="make", room="x" * 5000, source="chain").endswith("Try: physics-101")
    assert "Try: deleted-1" in refusal(rooms, do="make", room="deleted", source="chain")
    assert refusal(rooms, do="make", room="one", source="/etc/passwd").startswith("there is no study or script")
    change(rooms, do="make", room="one", source="chain")
    assert refusal(rooms, do="make", room="one", source="chain").endswith("choose another name")
    assert refusal(rooms, do="open", room="none") == "there is no room 'none' any more"
    assert refusal(rooms, do="burn", room="one") == "there is no change 'burn'"
    with pytest.raises(HTTPError, match="400"):
        ask(rooms, "/rooms/change", do="make", room="two", source="chain")

    def full(path: Path) -> Any:
        raise OSError(28, "No space left on device")

    with monkeypatch.context() as patch:
        patch.setattr(folder, "replacing", full)
        assert (
            refusal(rooms, do="make", room="two", source="chain") == "the room cannot be made: No space left on device"
        )
    assert change(rooms, do="make", room="two", source="chain")["state"] == "asleep"


def test_a_port_that_is_taken_is_told_and_tried_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(process, "AGAIN", 0.1)
    with running(tmp_path / "rooms") as rooms:
        port = change(rooms, do="make", room="one", source="chain")["port"]
    with socket.socket() as other:
        other.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        other.bind(("127.0.0.1", port))
        other.listen()
        with running(tmp_path / "rooms") as rooms:
            assert rooms.rooms["one"].state == "failed"
            assert (
                rooms.rooms["one"].trouble
                == f"port {port} cannot be opened (Address already in use); it is tried again"
            )
            other.close()
            wait_until(lambda: rooms.rooms["one"].state == "asleep")


def test_a_script_that_fails_tells_its_visitors_why_and_begins_once_it_is_mended(
    rooms: Rooms, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    script = tmp_path / "mine.py"
    script.write_text("raise ValueError('the sky is too low')\n")
    room = change(rooms, do="make", room="mine", source="mine.py")
    with suppress(OSError):
        urlopen(link(room), timeout=20).read()
    wait_until(lambda: rooms.rooms["mine"].state == "failed")
    assert rooms.rooms["mine"].trouble == "ValueError: the sky is too low (mine.py, line 1)"
    assert b"canvas" in urlopen(link(room), timeout=20).read(), "the page, which shows a card"
    body = "system.body(shape=iota.Sphere(0.2), position=(0, 1, 0))"
    script.write_text(f"import iota\nsystem = iota.System()\n{body}\niota.World(system, title='mended').run()\n")
    monkeypatch.setattr(process, "CARD", 0.2)
    wait_until(lambda: rooms.rooms["mine"]._card is None)
    with join(link(room)) as page:
        page.wait_for(lambda: page.last["world_settings"]["title"] == "mended")
        wait_until(lambda: rooms.rooms["mine"].state == "running" and not rooms.rooms["mine"].trouble)


def test_a_room_that_dies_too_often_is_left_alone_until_it_is_opened(
    rooms: Rooms, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(process, "MOST_DEATHS", 1)
    room = change(rooms, do="make", room="one", source="chain")
    for _ in range(2):
        with join(link(room)) as page:
            os.kill(number(rooms, "one"), signal.SIGKILL)
            page.wait_for(page.closed.is_set)
    wait_until(lambda: rooms.rooms["one"].state == "failed")
    assert rooms.rooms["one"].trouble == "its process ended 2 times within 10 minutes, at last by SIGKILL"
    change(rooms, do="open", room="one")
    join(link(room)).close()


def test_a_room_is_closed_opened_begun_anew_and_deleted(rooms: Rooms) -> None:
    room = change(rooms, do="make", room="one", source="chain")
    with join(link(room)) as page:
        page.wait_for(lambda: page.last["poses"]["step"] > 60)
        assert change(rooms, do="close", room="one")["state"] == "ending"
        page.wait_for(page.closed.is_set)
    wait_until(lambda: rooms.rooms["one"].state == "closed")
    with pytest.raises(OSError):
        PageClient(link(room))
    change(rooms, do="open", room="one")
    with join(link(room)) as page:
        assert page.last["poses"]["step"] >= 60
    change(rooms, do="close", room="one")
    wait_until(lambda: rooms.rooms["one"].state == "closed")
    change(rooms, do="begin_anew", room="one")
    assert rooms.rooms["one"].state == "closed", "it begins anew when it is opened"
    rooms.rooms["one"].begins_anew = False
    change(rooms, do="open", room="one")
    with join(link(room)) as page:
        change(rooms, do="begin_anew", room="one")
        page.wait_for(page.closed.is_set)
    join(link(room)).close()
    assert "begins anew; the world before is in" in (rooms.rooms["one"].folder.path / "log").read_text()
    assert change(rooms, do="delete", room="one") == {}
    assert (rooms.rooms.keys() == set()) and list(rooms._folder.glob("deleted/one-1/room.json"))
    assert change(rooms, do="make", room="one", source="chain")["port"] == room["port"]


def test_a_world_that_hangs_is_told_and_ends_when_its_room_is_closed(
    rooms: Rooms, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(process, "SILENT", 3.0)
    monkeypatch.setattr(process, "PATIENCE", 0.3)
    room = change(rooms, do="make", room="one", source="chain")
    join(link(room)).close()
    wait_until(lambda: rooms.rooms["one"].state == "running")
    hanging = number(rooms, "one")
    os.kill(hanging, signal.SIGSTOP)
    wait_until(lambda: rooms.rooms["one"].state == "hanging")
    change(rooms, do="close", room="one")
    wait_until(lambda: rooms.rooms["one"].state == "closed")
    assert not Path(f"/proc/{hanging}").exists()


def test_a_damaged_room_is_left_out_and_the_others_are_there(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    place = tmp_path / "rooms"
    with running(place) as rooms:
        change(rooms, do="make", room="one", source="chain")
        change(rooms, do="make", room="two", source="chain")
    (place / "one" / "room.json").write_text('{"what": "chain"')
    with running(place) as rooms:
        assert list(rooms.rooms) == ["two"]
        with pytest.raises(BusyError, match="are served already"):
            Rooms(place, page_folder(), port=0)
    assert "is left out" in capfd.readouterr().err


def test_metrics_tell_of_all_rooms_to_whoever_has_an_address(rooms: Rooms) -> None:
    change(rooms, do="make", room="two", source="chain")
    with join(link(change(rooms, do="make", room="one", source="chain")), "Ada"):
        wait_until(lambda: rooms.rooms["one"].people)
        told = ask(rooms, "/metrics", token=rooms.tokens[1]).decode()
    for line in ('iota_rooms{state="running"} 1', 'iota_rooms{state="asleep"} 1', 'iota_room_people{room="one"} 1'):
        assert line in told.splitlines()


def test_behind_a_proxy_its_name_is_taken_and_no_other(tmp_path: Path) -> None:
    with running(tmp_path / "rooms", public_origin="https://worlds.example.org") as rooms:
        room = change(rooms, do="make", room="one", source="chain")

        def status(port: int, host: str, origin: str = "") -> int:
            connection = http.client.HTTPConnection("127.0.0.1", port, timeout=20)
            headers = {"Host": host} | ({"Origin": origin} if origin else {})
            token = rooms.tokens[2] if port == rooms.port else room["tokens"]["host"]
            connection.request("GET", f"/metrics?token={token}", headers=headers)
            return connection.getresponse().status

        for port in (rooms.port, room["port"]):
            assert status(port, "worlds.example.org", "https://worlds.example.org") == 200
            assert status(port, "worlds.example.org", "https://evil.example") == 403
            assert status(port, "evil.example") == 403
        assert json.loads(ask(rooms, "/rooms.json"))["base"] == "https://worlds.example.org"
    with pytest.raises(ValueError, match="a public address is like"):
        Rooms(tmp_path / "rooms", page_folder(), port=0, public_origin="worlds.example.org")


@needs_browser
def test_a_visitor_makes_a_room_on_the_page_enters_it_and_finds_a_link_for_guests(tmp_path: Path) -> None:
    with (
        page_copy("rooms.html") as place,
        running(tmp_path / "rooms", Path(place)) as rooms,
        open_page(500, 800) as page,
    ):
        complaints = listen_for_complaints(page)
        page.goto(rooms.url)
        page.select_option("#source", "chain")
        assert page.input_value("#name") == "chain"
        page.click("#make button")
        page.locator("article", has_text="a visit wakes it").wait_for()
        assert page.input_value("#name") == "chain-2"
        page.locator("summary").click()
        invitation = page.get_by_label("Link for a guest").input_value()
        token = rooms.rooms["chain"].settings.token
        assert invitation == f"http://127.0.0.1:{rooms.rooms['chain'].settings.port}/?token={token_for('guest', token)}"
        page.get_by_role("button", name="Delete").click()
        assert "chain" in rooms.rooms, "it has to be pressed twice"
        page.get_by_label("Enter chain").click()
        page.wait_for_function("() => globalThis.iota?.connected && iota.step > 0", timeout=60_000)
        wait_until(lambda: rooms.rooms["chain"].people)
        page.goto(rooms.url)
        page.get_by_role("button", name="Delete").click()
        page.get_by_role("button", name="Delete this room?").click()
        page.locator("text=There is no room yet").wait_for()
        assert complaints == []
