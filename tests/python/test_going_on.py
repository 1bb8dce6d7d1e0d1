# SPDX-License-Identifier: Apache-2.0
"""A kept world comes back: the question in the terminal with a drawing, the page's card with a picture."""

from __future__ import annotations

import gc
import io
import os
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from urllib.error import HTTPError
from urllib.request import urlopen

import pytest
from page_client import PageClient
from waiting import wait_until

import iota
from iota import _protocol as protocol
from iota.journal.folder import Folder
from iota.studies import chain
from iota.world import going_on, pictures
from iota.world.clients import Client
from iota.world.options import RunOptions, use
from iota.world.pictures import Pictures, Portrait

PICTURE = b"\x89PNG of a ball"


class Asked:
    """In place of a room: the pictures that it was asked for."""

    def __init__(self) -> None:
        self.requests: list[tuple[int, int]] = []

    def ask_picture(self, client: int, number: int) -> None:
        self.requests.append((client, number))


@contextmanager
def typing(text: str) -> Iterator[Callable[[], str]]:
    """stdin and stderr are a terminal, where somebody types the text. Gives what was printed."""
    import pty

    far, near = pty.openpty()
    before = sys.stdin, sys.stderr
    with open(near, closefd=False) as sys.stdin, open(near, "w", closefd=False) as sys.stderr:
        os.write(far, text.encode())

        def printed() -> str:
            sys.stderr.flush()
            os.set_blocking(far, False)
            out = b""
            with suppress(BlockingIOError):
                while True:
                    out += os.read(far, 1 << 16)
            return out.decode()

        try:
            yield printed
        finally:
            sys.stdin, sys.stderr = before
    os.close(far)
    os.close(near)


def run_chain(folder: Path, seconds: float) -> iota.World:
    with use(RunOptions(headless=True, keep=folder)):
        world = chain.build()
        world.run(seconds)
    world.close()
    return world


def test_a_terminal_shows_the_kept_world_and_asks_whether_it_goes_on(tmp_path: Path) -> None:
    end = run_chain(tmp_path / "kept", 0.5).system.time
    with typing("\n") as printed:
        assert run_chain(tmp_path / "kept", 0.1).system.time == pytest.approx(end + 0.1)
        shown = printed()
    assert "Go on where it was? [Y/n]" in shown and "t = 0.50 s, 0 people" in shown
    assert sum(any(0x2801 <= ord(c) <= 0x28FF for c in line) for line in shown.splitlines()) > 5, shown
    with typing("n\n") as printed:
        assert run_chain(tmp_path / "kept", 0.1).system.time == pytest.approx(0.1)
        assert "begins anew; the world before is in" in printed()
    assert len(list((tmp_path / "kept" / "aside-1").glob("*.journal"))) == 2


def test_without_an_answer_or_a_terminal_a_world_goes_on(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    run_chain(tmp_path / "kept", 0.5)
    monkeypatch.setattr(going_on, "WAIT", 0.05)
    with typing(""):
        assert run_chain(tmp_path / "kept", 0.1).system.time == pytest.approx(0.6)
    monkeypatch.setattr(sys, "stdin", io.StringIO("n\n"))
    assert run_chain(tmp_path / "kept", 0.1).system.time == pytest.approx(0.7)


def test_a_script_that_was_saved_under_watch_goes_on_without_a_question(tmp_path: Path) -> None:
    run_chain(tmp_path / "kept", 0.5)
    (tmp_path / "world").write_bytes(b"")
    with use(RunOptions(headless=True, keep=tmp_path / "kept", kept=tmp_path / "world")), typing("n\n") as printed:
        world = chain.build()
        world.run(0.1)
        world.close()
        assert "Go on where it was?" not in printed()
    assert not (tmp_path / "kept" / "aside-1").exists()


def test_a_process_in_the_background_of_a_terminal_goes_on_without_a_question(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    run_chain(tmp_path / "kept", 0.5)
    monkeypatch.setattr(os, "tcgetpgrp", lambda _: os.getpgrp() + 1)
    with typing("n\n") as printed:
        assert run_chain(tmp_path / "kept", 0.1).system.time == pytest.approx(0.6)
        assert "Go on where it was?" not in printed()


def test_a_page_of_a_host_draws_the_kept_world_now_and_then(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(pictures, "FIRST", 0.0)
    taken, clients, room = Pictures(), iota.World(iota.System())._state.clients, Asked()
    portrait = Portrait(tmp_path / "picture.png", taken, clients)
    portrait.look(room)
    assert room.requests == [], "nobody is there"
    clients.by_id = {3: Client(3, role="viewer"), 4: Client(4), 5: Client(5, role="guest")}
    for _ in range(3):
        portrait.look(room)
    ((client, number),) = room.requests
    assert client == 4
    taken.take(3, protocol.Picture(number, True, b"what a viewer wants the host to see"))
    taken.take(4, protocol.Picture(number, False, PICTURE[:5]))
    taken.take(4, protocol.Picture(number, True, PICTURE[5:]))
    portrait.look(room)
    wait_until(lambda: (tmp_path / "picture.png").is_file())
    assert (tmp_path / "picture.png").read_bytes() == PICTURE
    portrait.look(room)
    assert len(room.requests) == 1, "the next one is due in a minute"


def test_a_picture_without_an_end_takes_no_memory(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(pictures, "MOST_BYTES", 1000)
    taken = Pictures()
    number = taken.ask(1)
    for _ in range(3):
        taken.take(1, protocol.Picture(number, False, bytes(600)))
    assert taken.ready(number) == b"", "none could be made"


def test_a_page_gets_the_picture_with_which_the_world_was_kept(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(pictures, "FIRST", 0.0)
    page = tmp_path / "page"
    page.mkdir()
    (page / "index.html").write_text("page")

    def serve() -> iota.World:
        world = iota.World(iota.System(), title="kept")
        world.keep(tmp_path / "kept")
        world.serve(port=0, server=None)
        return world

    monkeypatch.setattr("iota.world.server.page.page_folder", lambda: page)
    first = serve()
    over = threading.Event()
    answering = threading.Thread(target=answer_one_picture, args=(first.pages.url, over))
    answering.start()
    wait_until(lambda: (first.step(), Folder(tmp_path / "kept").picture.is_file())[1])
    over.set()
    answering.join()
    first.close()
    second = serve()
    address = second.pages.url.replace("/?", "/kept.png?")
    got: list[bytes] = []
    asking = threading.Thread(target=lambda: got.append(urlopen(address, timeout=20).read()))
    asking.start()
    wait_until(lambda: (second.step(), got)[1])
    asking.join()
    assert got == [PICTURE]
    with pytest.raises(HTTPError, match="403"):
        urlopen(address.split("?")[0], timeout=20)
    second.close()
    third = iota.World(iota.System(), title="kept")
    third.keep(tmp_path / "kept", fresh=True)
    third.close()
    assert (tmp_path / "kept" / "aside-1" / "picture.png").is_file(), "the picture belongs to the world before"


def answer_one_picture(url: str, over: threading.Event) -> None:
    client = PageClient(url)
    client.wait_for(lambda: "ask_picture" in client.last)
    client.send("picture", request=client.last["ask_picture"]["request"], is_last=True, data=PICTURE)
    over.wait(20)
    client.close()


def test_a_chain_that_was_ended_while_it_was_apart_mends_itself(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    world = run_chain(tmp_path / "kept", 7.0)
    assert world.system.articulate_count == 2 and len(world.system.bonds) == 3
    del world
    gc.collect()  # functions are found by their names among all of the process
    world = run_chain(tmp_path / "kept", 2.0)
    told = capsys.readouterr().err
    assert "goes on where it was: t = 7.00 s" in told and "no function" not in told
    assert world.system.articulate_count == 1 and not world.system.bonds
