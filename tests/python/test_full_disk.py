# SPDX-License-Identifier: Apache-2.0
"""Saving to a disk that is full: a message with the file and the reason, the older file as it was, and the world untouched."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

resource = pytest.importorskip("resource", reason="limits the size of files, as a full disk does")

# A world of some hundred kilobytes; `save` is what is tried. Files may have 4 kB.
SCRIPT = """
import resource
import iota

system = iota.System()
chain = iota.builder.chain(links=400, length=4).realize(system)
system.start_recording()
for _ in range(50):
    system.step(1 / 120)
    chain.points[-1].velocity = (1, 0, 0)
recording = system.stop_recording()
before = system.state_hash()
resource.setrlimit(resource.RLIMIT_FSIZE, (4096, 4096))
try:
    {save}
except OSError as error:
    print("refused:", error)
assert system.state_hash() == before and system.validate() == []
system.step(1 / 120)
"""


def run(folder: Path, script: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run([sys.executable, "-c", script], cwd=folder, capture_output=True, text=True, timeout=120)


def test_a_recording_that_does_not_fit_leaves_the_older_one(tmp_path: Path) -> None:
    old = tmp_path / "run.replay"
    old.write_bytes(b"an older one")
    done = run(tmp_path, SCRIPT.format(save="recording.save('run.replay')"))
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith("refused:") and "run.replay" in done.stdout
    assert old.read_bytes() == b"an older one" and list(tmp_path.iterdir()) == [old]


def test_a_structure_that_does_not_fit_leaves_the_older_one(tmp_path: Path) -> None:
    old = tmp_path / "ball.json"
    old.write_text("an older one")
    limited = "import resource, sys; resource.setrlimit(resource.RLIMIT_FSIZE, (4096, 4096)); from iota.cli.main import main; "
    done = run(
        tmp_path, limited + "sys.exit(main(['import', 'fullerene 240', '--kind', 'soft', '--save', 'ball.json']))"
    )
    assert done.returncode != 0
    (line,) = done.stderr.strip().splitlines()
    assert "ball.json" in line and "Traceback" not in line
    assert old.read_text() == "an older one" and list(tmp_path.iterdir()) == [old]


def test_a_playground_that_does_not_fit_leaves_the_older_one_and_says_so(tmp_path: Path) -> None:
    old = tmp_path / "playground.json"
    old.write_text("an older one")
    script = """
import resource
from pathlib import Path
import iota
from iota.studies import playground
world = playground.build(Path())
cards = []
world._state.notices.show = lambda client, level, title, text, *more, **rest: cards.append(text)
save = next(thing for thing in world.drawings.things if getattr(thing, "label", "") == "save")
before = world.system.state_hash()
resource.setrlimit(resource.RLIMIT_FSIZE, (1024, 1024))
save.take(1.0, "", iota.Event(world.system, "save"), world._guard)
assert world.system.state_hash() == before
print(cards)
"""
    done = run(tmp_path, script)
    assert done.returncode == 0, done.stderr
    assert "playground.json cannot be written: File too large" in done.stdout
    assert old.read_text() == "an older one" and list(tmp_path.iterdir()) == [old]
