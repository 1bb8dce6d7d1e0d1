# SPDX-License-Identifier: Apache-2.0
"""Serves every study on one port, each in a process of its own: none can slow the others, or end them. A study begins with
its first visitor, and ends some time after the last one has left."""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any

from iota import studies
from iota._core import Room
from iota.processes import wait_or_kill
from iota.world import Server
from iota.world.callbacks import print_error
from iota.world.page import page_copy

LEAVE = 15.0  # s without a visitor, after which a study ends
GROUPS = {  # on the page, the best first: each study and its title
    "See": {
        "museum": "A museum",
        "lab": "A laboratory",
        "shoal": "A shoal of fish",
        "mechanisms": "Mechanisms",
        "undersea": "Under the sea",
        "ragdolls": "Ragdolls",
        "grasp": "Grippers",
        "wrecking-ball": "Wrecking ball",
        "rigging": "A derrick",
        "evacuation": "Evacuation",
        "marbles": "Marble run",
        "fireworks": "Fireworks",
        "crowd": "A crowd",
        "weather": "Weather",
    },
    "Learn": {
        "physics-class": "Physics class",
        "cradle": "Newton's cradle",
        "cradle-contact": "Cradles of steel and lead",
        "capstan": "Capstan",
        "pour": "Hopper",
        "bucky": "Bucky ball",
        "molecule": "Molecule",
        "soft-molecule": "Soft molecule",
    },
    "Build and break": {
        "playground": "Playground",
        "chain": "Chain",
        "ladder": "Jacob's ladder",
        "stack": "Towers",
        "knot": "A knot",
        "links": "Chain links",
        "cloth": "Cloth",
    },
    "From the thesis": {
        "appendix-e1": "Appendix E.1",
        "appendix-e2": "Appendix E.2",
        "appendix-e3": "Appendix E.3",
    },
}
LOOK = 0.1  # s, between two checks for visitors
PATIENCE = 2.0  # s, within which a study has to end


class Study:
    """The process of a study, and where it serves."""

    def __init__(self, name: str) -> None:
        self.left: float | None = None  # when it was first found without visitors
        self.is_told = False
        self._answer: dict[str, Any] | None = None
        words = [sys.executable, "-m", "iota.gallery.study", name]
        self._process = subprocess.Popen(words, stdin=subprocess.PIPE, stdout=subprocess.PIPE)
        self._listener = threading.Thread(target=self._listen, name="iota-study", daemon=True)
        self._listener.start()

    def _listen(self) -> None:
        assert self._process.stdout is not None
        with suppress(OSError, ValueError):
            self._answer = json.loads(self._process.stdout.readline())

    @property
    def answer(self) -> dict[str, Any] | None:
        """Its port and tokens, or its error; None while it starts."""
        return {"error": "its process ended"} if self.has_ended and self._answer is None else self._answer

    @property
    def process(self) -> int:
        """Its number."""
        return self._process.pid

    @property
    def has_ended(self) -> bool:
        """And what it said last has been read."""
        return self._process.poll() is not None and not self._listener.is_alive()

    def ask_to_end(self) -> None:
        assert self._process.stdin is not None
        with suppress(OSError):
            self._process.stdin.close()

    def end(self) -> None:
        """A study that hangs is killed: its visitors have left, or the gallery ends."""
        assert self._process.stdout is not None
        self.ask_to_end()
        wait_or_kill(self._process, PATIENCE)
        self._process.stdout.close()


class Gallery(Server):
    """A server that passes the visitors of each study on to its process. folder: with the gallery's page, see
    `make_folder`."""

    def __init__(self, folder: str | Path, port: int = 8080, names: list[str] | None = None) -> None:
        super().__init__(port=port, folder=folder)
        self._names = names or studies.names()
        self._studies: dict[str, Study] = {}
        self._failed: dict[str, tuple[Room, float]] = {}  # with a card for visitors, and since when
        for name in self._names:
            self.relay(name)

    @property
    def running(self) -> list[str]:
        """The running studies."""
        return list(self._studies)

    def run(self, goes_on: Callable[[], bool] = lambda: True) -> None:
        """Runs until `goes_on` returns False."""
        try:
            while goes_on():
                try:
                    self.look()
                except OSError as error:  # such as too many processes: the studies that run go on
                    print_error(error)
                time.sleep(LOOK)
        finally:
            self.close()  # lets all visitors go
            for study in self._studies.values():
                study.ask_to_end()
            for name in self.running:
                self._end(name)

    def look(self) -> None:
        """Starts studies with visitors, and ends those without."""
        now = time.monotonic()
        for name in self._names:
            study = self._studies.get(name)
            if study is not None:
                self._look_at(name, study, now)
            elif name in self._failed:
                if now - self._failed[name][1] > LEAVE:  # the next visitor may try again
                    del self._failed[name]  # the room ends with it
                    self.relay(name)
            elif self.visitors(name):
                self._studies[name] = Study(name)

    def _look_at(self, name: str, study: Study, now: float) -> None:
        answer = study.answer
        if answer is not None and "error" in answer:
            self._end(name)
            self._tell_of_failure(name, answer["error"], now)
        elif study.has_ended:  # its visitors' pages come back by themselves, and start it again
            self._end(name)
            self.relay(name)
        else:
            if answer is not None and not study.is_told:
                study.is_told = True
                self.relay(name, answer["port"], answer["tokens"])
            if self.visitors(name):
                study.left = None
            elif study.left is None:
                study.left = now
            elif now - study.left > LEAVE:
                self.relay(name)  # first: who comes now waits for the next process
                self._end(name)

    def _end(self, name: str) -> None:
        self._studies.pop(name).end()

    def _tell_of_failure(self, name: str, text: str, now: float) -> None:
        """Visitors come back to a room that only has a card."""
        self._failed[name] = self.open_card(name, f"{name} cannot be shown", text), now
        self.end_relay(name)


def in_order() -> list[str]:
    """All studies, as the page has them."""
    return [each["name"] for group in grouped() for each in group["studies"]]


def make_folder() -> tempfile.TemporaryDirectory[str]:
    """The page's folder with the gallery as index.html, and the page itself as world.html."""
    folder = page_copy("gallery.html")
    target = Path(folder.name)
    shutil.copytree(studies.PICTURES, target / "studies")
    (target / "studies.json").write_text(json.dumps(grouped()))
    return folder


def grouped() -> list[dict[str, Any]]:
    """The groups of the page, each with its studies: name, title and a sentence. A study of no group ends the first one."""
    listed = {name for group in GROUPS.values() for name in group}
    others = {name: name.replace("-", " ").capitalize() for name in studies.names() if name not in listed}
    groups = {title: group | (others if number == 0 else {}) for number, (title, group) in enumerate(GROUPS.items())}
    return [
        {
            "group": title,
            "studies": [
                {"name": name, "title": words, "text": studies.description(name)} for name, words in group.items()
            ],
        }
        for title, group in groups.items()
    ]
