# SPDX-License-Identifier: Apache-2.0
"""`iota gallery`: rooms of studies that run only while somebody is there."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from typing import Any
from urllib.request import urlopen

import pytest
from page_client import CONSTANTS, SCHEMA, PageClient, decode, encode
from pages import listen_for_complaints, needs_browser, open_page
from waiting import PATIENCE, wait_until
from websockets.exceptions import ConnectionClosed, InvalidMessage
from websockets.sync.client import connect

from iota import studies
from iota.gallery import serving
from iota.gallery.serving import Gallery, make_folder

NAMES = ["chain", "molecule", "broken"]


@pytest.fixture
def gallery(monkeypatch: pytest.MonkeyPatch) -> Iterator[Gallery]:
    monkeypatch.setattr(serving, "LEAVE", 0.3)
    stopped = threading.Event()
    with make_folder() as folder:
        gallery = Gallery(Path(folder), 0, NAMES)
        runner = threading.Thread(target=gallery.run, args=(lambda: not stopped.is_set(),))
        runner.start()
        try:
            yield gallery
        finally:
            stopped.set()
            runner.join(20)
    assert not runner.is_alive()


def test_a_study_runs_from_its_first_visitor_to_some_time_after_its_last(gallery: Gallery) -> None:
    assert gallery.running == []
    with PageClient(gallery.url_of("chain")) as first, PageClient(gallery.url_of("molecule")) as other:
        assert sorted(gallery.running) == ["chain", "molecule"]
        first.wait_for(lambda: first.last["world_settings"]["title"].startswith("chain: "))
        other.wait_for(lambda: other.last["world_settings"]["title"].startswith("molecule"))
        # A busy machine may tell of the next run only after a second.
        first.wait_for(lambda: first.last["poses"]["step"] > 240)
    wait_until(lambda: gallery.running == [])
    with PageClient(gallery.url_of("chain")) as again:
        assert again.last["poses"]["step"] < 240, "it begins anew"
        again.wait_for(lambda: again.last["poses"]["step"] > 20)


def test_the_first_visitor_can_take_hold_though_the_study_started_after_it_came(gallery: Gallery) -> None:
    with PageClient(gallery.url_of("chain")) as page:
        page.send("grab_start", hold=1, body=page.body(20), local_point=(0, 0, 0), target=(1, 2, 0))
        page.wait_for(lambda: page.last["poses"]["holds"])


def first_notice(gallery: Gallery, world: str) -> dict[str, Any]:
    """The card that a page gets, which comes back when its connection ends."""
    base, query = gallery.url.split("/?")
    hello = {"magic": CONSTANTS["protocol_magic"], "version": SCHEMA["version"], "role": 0, "name": ""}
    for _ in range(200):
        with (
            suppress(ConnectionClosed, InvalidMessage, EOFError),
            connect(
                base.replace("http", "ws") + f"/ws?{query}&world={world}",
                origin=base,
                proxy=None,
                open_timeout=PATIENCE,
            ) as socket,
        ):
            socket.send(encode("hello", world=world, **hello))
            while True:
                name, values = decode(socket.recv(PATIENCE, decode=False))
                if name == "notice":
                    return values
        time.sleep(0.05)
    raise AssertionError("no card came")


def test_a_study_that_cannot_be_built_says_so_to_its_visitors_and_the_others_go_on(
    gallery: Gallery, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(serving, "LEAVE", 20.0)
    card = first_notice(gallery, "broken")
    assert card["title"] == "broken cannot be shown" and "No module named" in card["text"]
    with PageClient(gallery.url_of("chain")) as page:
        page.wait_for(lambda: page.last["poses"]["step"] > 0)
    monkeypatch.setattr(serving, "LEAVE", 0.3)
    wait_until(lambda: not gallery._failed)
    assert first_notice(gallery, "broken") == card, "a later visitor tries again"


def test_what_a_process_says_before_it_ends_is_read_though_it_ends_first(monkeypatch: pytest.MonkeyPatch) -> None:
    listen = serving.Study._listen

    def listen_late(study: serving.Study) -> None:
        study._process.wait()
        time.sleep(0.3)
        listen(study)

    monkeypatch.setattr(serving.Study, "_listen", listen_late)
    study = serving.Study("broken")
    wait_until(lambda: study.answer is not None or study.has_ended)
    assert "No module named" in study.answer["error"]
    study.end()


def test_a_study_that_hangs_or_ends_leaves_the_others_alone(gallery: Gallery) -> None:
    with PageClient(gallery.url_of("molecule")) as other, PageClient(gallery.url_of("chain")) as page:
        page.wait_for(lambda: page.last["poses"]["step"] > 10)
        hanging = gallery._studies["chain"].process
        os.kill(hanging, signal.SIGSTOP)
        step = other.last["poses"]["step"]
        other.wait_for(lambda: other.last["poses"]["step"] > step + 60)
        os.kill(hanging, signal.SIGKILL)
        page.wait_for(page.closed.is_set)
        with PageClient(gallery.url_of("chain")) as again:
            again.wait_for(lambda: again.last["poses"]["step"] > 10)
            assert gallery._studies["chain"].process != hanging
            os.kill(gallery._studies["chain"].process, signal.SIGSTOP)  # the gallery ends all the same, see the fixture
        assert not other.closed.is_set()


def test_a_machine_that_cannot_start_one_more_process_goes_on_with_the_others(
    gallery: Gallery, monkeypatch: pytest.MonkeyPatch
) -> None:
    with PageClient(gallery.url_of("molecule")) as page:
        tried: list[str] = []

        def fail(name: str) -> None:
            tried.append(name)
            raise BlockingIOError(11, "Resource temporarily unavailable")

        with monkeypatch.context() as patch:
            patch.setattr(serving, "Study", fail)
            waiting = threading.Thread(target=lambda: PageClient(gallery.url_of("chain")).close())
            waiting.start()
            wait_until(lambda: len(tried) > 2)
        waiting.join(60)
        assert "chain" in gallery.running and not page.closed.is_set()


def test_the_processes_of_studies_end_with_the_gallery_however_that_ends() -> None:
    command = [sys.executable, "-m", "iota", "gallery", "--port", "0", "--no-open"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        url = process.stdout.readline().split()[1]
        with PageClient(f"{url}&world=chain") as page:
            children = Path(f"/proc/{process.pid}/task/{process.pid}/children").read_text().split()
            assert len(children) == 1
            process.kill()
            page.wait_for(page.closed.is_set)
    wait_until(
        lambda: not Path(f"/proc/{children[0]}").exists() or "Z" in Path(f"/proc/{children[0]}/stat").read_text()
    )


@pytest.mark.parametrize("role", ["guest", "viewer"])
def test_a_role_holds_in_the_process_of_a_study_too(gallery: Gallery, role: str) -> None:
    with PageClient(gallery.link(gallery.url_of("chain"), role)) as page:
        page.send("control", command=0, value=0.0)
        page.wait_for(lambda: page.notices)
        assert page.notices[0]["title"] == ("Only the host does that" if role == "guest" else "You only watch")


def test_every_study_has_a_thumbnail_and_a_line(gallery: Gallery) -> None:
    base = gallery.url.split("?")[0]
    listed = json.loads(urlopen(base + "studies.json").read())
    assert [group["group"] for group in listed] == list(serving.GROUPS)
    assert listed[0]["studies"][0]["name"] == "museum" and listed[-1]["studies"][0]["name"] == "appendix-e1"
    shown = [study for group in listed for study in group["studies"]]
    assert sorted(study["name"] for study in shown) == studies.names(), "each study once"
    assert all(study["title"][0].isupper() and "-" not in study["title"] for study in shown)
    for study in shown:
        assert 20 < len(study["text"]) < 140 and study["text"].endswith("."), study
        assert urlopen(f"{base}studies/{study['name']}.jpg").read().startswith(b"\xff\xd8")
    assert b"gallery" in urlopen(base).read() and b"canvas" in urlopen(base + "world.html").read()


@needs_browser
def test_a_click_leads_to_a_world_and_a_button_back(gallery: Gallery) -> None:
    with open_page(390, 844) as page:
        complaints = listen_for_complaints(page)
        page.goto(gallery.url)
        chain = page.locator("a[href$='world=chain']")
        chain.wait_for()
        tops = page.evaluate(
            "[...document.querySelectorAll('main a')].slice(0, 3).map((a) => a.getBoundingClientRect().top)"
        )
        assert tops[0] == tops[1] < tops[2], "two columns on a phone"
        assert page.evaluate("document.querySelector('a[href$=\"world=chain\"] .keys').innerText").startswith(
            ", break it with b"
        )
        assert page.evaluate(r"!/\d \p{L}/u.test(document.querySelector('main').innerText)"), "units stay with numbers"
        chain.click()
        page.wait_for_function(
            "() => globalThis.iota?.connected && iota.bodies().length === 24 && iota.step > 0", timeout=60_000
        )
        page.mouse.move(100, 100)  # controls that faded away since cannot be pressed
        page.mouse.move(200, 200)
        page.locator("#studies").click()
        page.wait_for_function("() => document.querySelectorAll('main a').length > 8")
        page.wait_for_function(
            "() => [...document.images].some((image) => image.complete && image.naturalWidth === 480)", timeout=60_000
        )
        assert page.evaluate("document.documentElement.scrollWidth") == 390
        # A page tries again where a study takes long to start.
        assert [text for text in complaints if "before receiving a handshake response" not in text] == []
