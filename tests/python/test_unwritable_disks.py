# SPDX-License-Identifier: Apache-2.0
"""Saving to a disk that is mounted read-only or is full: a message with the file and the reason, the older file as it was, and the world
untouched."""

from __future__ import annotations

import shutil
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

import pytest

# Tests may run as root, whom permissions do not stop: a mount does. It is seen by the tested process only.
UNSHARE = ["unshare", "--map-root-user", "--mount", "sh", "-c"]
NAMES = (
    "run.replay",
    "film.iota",
    "film.html",
    "sheet.png",
    "playground.json",
    "playground.py",
    "ball.json",
    "now.png",
)
OLDER = "an older one"


@dataclass
class Disk:
    """mount: shell commands that mount it at $0; reason: what the system says when something is written there."""

    mount: str
    reason: str


DISKS = {
    "read-only": Disk('mount --bind "$0" "$0" && mount -o remount,ro,bind "$0" && cd "$0"', "Read-only file system"),
    "full": Disk(
        'mount -t tmpfs -o size=64k none "$0" && cd "$0"'
        f" && for name in {' '.join(NAMES)}; do printf '{OLDER}' > $name; done"
        " && { cat /dev/zero > filler 2> /dev/null || true; }",
        "No space left on device",
    ),
}
# After the command: what its folder holds but for the state of the tests, as the last line of the output.
TELL = '; code=$?; rm -f filler 2> /dev/null; echo; for file in $(ls -A -I state); do printf "%s|" "$(cat $file)"; done; exit $code'
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
    button = next(thing for thing in world.drawings.things if getattr(thing, "label", "") == "{label}")
    button.take(1.0, "", iota.Event(world.system, "{label}"), world._guard)
    print("refused:", *cards)"""


@pytest.fixture(params=DISKS)
def disk(request: pytest.FixtureRequest, tmp_path: Path) -> Disk:
    """With an older file of each name."""
    disk = DISKS[request.param]
    if shutil.which("unshare") is None or subprocess.run([*UNSHARE, disk.mount, tmp_path]).returncode != 0:
        pytest.skip("this machine lets nobody mount")
    for name in NAMES:
        (tmp_path / name).write_text(OLDER)
    return disk


def run(disk: Disk, folder: Path, *command: str) -> subprocess.CompletedProcess[str]:
    """Runs Python there, and checks that the older files are as they were and nothing is beside them."""
    done = subprocess.run(
        [*UNSHARE, f'{disk.mount} && "$@"{TELL}', folder, sys.executable, *command],
        capture_output=True,
        text=True,
        timeout=300,
    )
    done.stdout, _, held = done.stdout.rpartition("\n")
    assert held.split("|") == [OLDER] * len(NAMES) + [""], held
    return done


@pytest.mark.parametrize(
    ("file", "build", "save"),
    [
        (
            "run.replay",
            "chain.build()",
            "world.system.start_recording(); world.system.stop_recording().save('run.replay')",
        ),
        ("playground.json", "playground.build()", BUTTON.format(label="save")),
        ("playground.py", "playground.build()", BUTTON.format(label="export script")),
        ("now.png", "chain.build()", "Client(1, take_picture=lambda client, wait: b'a picture').screenshot('now.png')"),
    ],
)
def test_a_running_world_says_which_file_cannot_be_written_and_goes_on(
    disk: Disk, tmp_path: Path, file: str, build: str, save: str
) -> None:
    done = run(disk, tmp_path, "-c", SCRIPT.format(build=build, save=save))
    assert done.returncode == 0, done.stderr
    refused, goes_on = done.stdout.strip().splitlines()
    assert refused.startswith("refused:") and file in refused and disk.reason in refused
    assert goes_on == "and goes on"


@pytest.mark.parametrize(
    ("file", "command"),
    [
        ("film.iota", ("record", "chain", "-o", "film.iota", "--seconds", "0.1")),
        ("film.html", ("record", "chain", "-o", "film.html", "--seconds", "0.1")),
        ("sheet.png", ("record", "chain", "--sheet", "sheet.png", "--seconds", "0.1")),
        ("ball.json", ("import", "fullerene 60", "--kind", "soft", "--save", "ball.json")),
    ],
)
def test_a_command_says_in_one_line_which_file_cannot_be_written(
    disk: Disk, tmp_path: Path, file: str, command: tuple[str, ...]
) -> None:
    done = run(disk, tmp_path, "-m", "iota", *command)
    assert done.returncode != 0
    (line,) = done.stderr.strip().splitlines()
    assert file in line and disk.reason in line and "Traceback" not in line
