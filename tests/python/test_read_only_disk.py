# SPDX-License-Identifier: Apache-2.0
"""Saving to a disk that is mounted read-only: a message with the file and the reason, and the world untouched."""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path

import pytest

# Tests may run as root, whom permissions do not stop: a mount does. It is seen by the tested process only.
UNSHARE = ["unshare", "--map-root-user", "--mount", "sh", "-c"]
MOUNT = 'mount --bind "$0" "$0" && mount -o remount,ro,bind "$0" && cd "$0" && exec "$@"'
REASON = "Read-only file system"
# A world in motion; `save` is what is tried.
SCRIPT = """
from pathlib import Path
import iota
from iota.studies import chain, playground
from iota.world.clients import Client

world = {build}
for _ in range(20):
    world.step()
before = world.system.state_hash()
try:
    {save}
except OSError as error:
    print("refused:", error)
assert world.system.state_hash() == before and world.system.validate() == []
world.step()
print("and goes on")
"""
BUTTON = """cards = []
    world._state.notices.show = lambda client, level, title, text, *more, **rest: cards.append(text)
    button = next(thing for thing in world.things if getattr(thing, "label", "") == "{label}")
    button.take(1.0, "", iota.Event(world.system, "{label}"), world._guard)
    print("refused:", *cards)"""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """With an older file of each name."""
    works = shutil.which("unshare") is not None and subprocess.run([*UNSHARE, MOUNT, tmp_path, "true"]).returncode == 0
    if not works:
        pytest.skip("this machine lets nobody mount")
    for name in ("run.iota", "film.iota", "film.html", "playground.json", "playground.py", "ball.json", "now.png"):
        (tmp_path / name).write_text("an older one")
    return tmp_path


def run(folder: Path, *command: str) -> subprocess.CompletedProcess[str]:
    done = subprocess.run(
        [*UNSHARE, MOUNT, folder, sys.executable, *command], capture_output=True, text=True, timeout=300
    )
    assert {file.read_text() for file in folder.iterdir()} == {"an older one"}
    return done


@pytest.mark.parametrize(
    ("file", "build", "save"),
    [
        ("run.iota", "chain.build()", "world.system.start_recording(); world.system.stop_recording().save('run.iota')"),
        ("playground.json", "playground.build()", BUTTON.format(label="save")),
        ("playground.py", "playground.build()", BUTTON.format(label="export script")),
        ("now.png", "chain.build()", "Client(1, take_picture=lambda client, wait: b'a picture').screenshot('now.png')"),
    ],
)
def test_a_running_world_says_which_file_cannot_be_written_and_goes_on(
    folder: Path, file: str, build: str, save: str
) -> None:
    done = run(folder, "-c", SCRIPT.format(build=build, save=save))
    assert done.returncode == 0, done.stderr
    refused, goes_on = done.stdout.strip().splitlines()
    assert refused.startswith("refused:") and file in refused and REASON in refused
    assert goes_on == "and goes on"


@pytest.mark.parametrize(
    ("file", "command"),
    [
        ("film.iota", ("record", "chain", "-o", "film.iota", "--seconds", "0.1")),
        ("film.html", ("record", "chain", "-o", "film.html", "--seconds", "0.1")),
        ("ball.json", ("import", "fullerene 60", "--kind", "soft", "--save", "ball.json")),
    ],
)
def test_a_command_says_in_one_line_which_file_cannot_be_written(
    folder: Path, file: str, command: tuple[str, ...]
) -> None:
    done = run(folder, "-m", "iota", *command)
    assert done.returncode != 0
    (line,) = done.stderr.strip().splitlines()
    assert file in line and REASON in line and "Traceback" not in line
