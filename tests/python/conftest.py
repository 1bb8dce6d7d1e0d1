# SPDX-License-Identifier: Apache-2.0
from __future__ import annotations

import threading
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

import iota


@pytest.fixture(autouse=True)
def own_state_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Tests keep no token in the user's home."""
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "state"))


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
