# SPDX-License-Identifier: Apache-2.0
from __future__ import annotations

import itertools
import threading
from collections.abc import Callable, Iterator

import pytest

import iota

numbers = itertools.count()


@pytest.fixture(autouse=True)
def own_state_folder(tmp_path_factory: pytest.TempPathFactory, monkeypatch: pytest.MonkeyPatch) -> None:
    """Tests keep no token in the user's home. The folder is made by whoever keeps one: `tmp_path` makes one for each test, and looks at
    the names of all that there are."""
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path_factory.getbasetemp() / f"state-{next(numbers)}"))


@pytest.fixture
def system() -> iota.System:
    return iota.System()


@pytest.fixture
def chain(system: iota.System) -> list[iota.Body]:
    """Six links on a nail, hanging askew."""
    return iota.builder.chain(links=6, length=0.6, top=(0, 2, 0), direction=(0.6, -0.8, 0)).realize(system).bodies


Runner = Callable[[iota.World], str]


@pytest.fixture
def run_world() -> Iterator[Runner]:
    """Runs a World in the background on a free port and returns its address; stops it after the test."""
    worlds: list[iota.World] = []

    def run(world: iota.World) -> str:
        worlds.append(world)
        return world.start(port=0)

    yield run
    for world in worlds:
        world.stop()
    left = [thread.name for thread in threading.enumerate() if thread.name.startswith("iota-")]
    assert left == [], "threads outlive their world"
