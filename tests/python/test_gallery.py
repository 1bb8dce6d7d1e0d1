# SPDX-License-Identifier: Apache-2.0
"""`iota gallery`: rooms of studies that run only while somebody is there."""

from __future__ import annotations

import json
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from urllib.request import urlopen

import pytest
from page_client import CONSTANTS, SCHEMA, PageClient, decode, encode
from pages import listen_for_complaints, needs_browser, open_page
from websockets.sync.client import connect

from iota import studies
from iota.gallery import serving
from iota.gallery.serving import Gallery, make_folder

NAMES = ["chain", "molecule", "broken"]


@pytest.fixture
def gallery(monkeypatch: pytest.MonkeyPatch) -> Iterator[Gallery]:
    monkeypatch.setattr(serving, "LEAVE", 0.3)
    real = studies.module
    monkeypatch.setattr(studies, "module", lambda name: None if name == "broken" else real(name))
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


def wait_until(condition: Callable[[], object], seconds: float = 20) -> None:
    end = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < end
        time.sleep(0.02)


def test_a_study_runs_from_its_first_visitor_to_some_time_after_its_last(gallery: Gallery) -> None:
    assert gallery.running == []
    with PageClient(gallery.url_of("chain")) as first, PageClient(gallery.url_of("molecule")) as other:
        assert sorted(gallery.running) == ["chain", "molecule"]
        first.wait_for(lambda: first.last["world_settings"]["title"] == "chain: 1.8 m long")
        other.wait_for(lambda: other.last["world_settings"]["title"].startswith("molecule"))
        first.wait_for(lambda: first.last["poses"]["step"] > 60)
    wait_until(lambda: gallery.running == [])
    with PageClient(gallery.url_of("chain")) as again:
        assert again.last["poses"]["step"] < 60, "it begins anew"
        again.wait_for(lambda: again.last["poses"]["step"] > 20)


def test_the_first_visitor_can_take_hold_though_the_study_started_after_it_came(gallery: Gallery) -> None:
    with PageClient(gallery.url_of("chain")) as page:
        page.send("grab_start", hold=1, body=page.body(20), local_point=(0, 0, 0), target=(1, 2, 0))
        page.wait_for(lambda: page.last["poses"]["holds"])


def test_a_study_that_cannot_be_built_says_so_to_its_visitors_and_the_others_go_on(gallery: Gallery) -> None:
    base, query = gallery.url.split("/?")
    with connect(base.replace("http", "ws") + f"/ws?{query}", origin=base, proxy=None) as socket:
        hello = {"magic": CONSTANTS["protocol_magic"], "version": SCHEMA["version"], "role": 0, "name": ""}
        socket.send(encode("hello", world="broken", **hello))
        name = ""
        while name != "notice":
            name, values = decode(socket.recv(20, decode=False))
        assert values["title"] == "broken cannot be shown" and values["text"]
        with PageClient(gallery.url_of("chain")) as page:
            page.wait_for(lambda: page.last["poses"]["step"] > 0)


def test_every_study_has_a_thumbnail_and_a_line(gallery: Gallery) -> None:
    base = gallery.url.split("?")[0]
    listed = json.loads(urlopen(base + "studies.json").read())
    assert sorted(study["name"] for study in listed) == studies.names()
    assert listed[0]["name"] == "chain" and set(serving.FIRST) <= set(studies.names())
    for study in listed:
        assert 20 < len(study["text"]) < 140 and study["text"].endswith("."), study
        assert urlopen(f"{base}studies/{study['name']}.jpg").read().startswith(b"\xff\xd8")
    assert b"gallery" in urlopen(base).read() and b"canvas" in urlopen(base + "world.html").read()


@needs_browser
def test_a_click_leads_to_a_world_and_a_button_back(gallery: Gallery) -> None:
    with open_page(390, 844) as page:
        complaints = listen_for_complaints(page)
        page.goto(gallery.url)
        page.locator("a", has_text="chain").first.wait_for()
        assert page.evaluate(r"!/\d \p{L}/u.test(document.querySelector('main').innerText)"), "units stay with numbers"
        page.locator("a", has_text="chain").first.click()
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
        assert complaints == []
