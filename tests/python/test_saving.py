# SPDX-License-Identifier: Apache-2.0
"""Files that are written completely or not at all."""

from __future__ import annotations

import os
import time
from pathlib import Path

import pytest

from iota import saving
from iota.saving import replacing


def test_who_has_the_old_file_open_reads_it_to_its_end(tmp_path: Path) -> None:
    path = tmp_path / "world.replay"
    path.write_text("old" * 1000)
    with path.open("rb", buffering=0) as reader:
        assert reader.read(3) == b"old"
        with replacing(path) as fresh:
            fresh.write_text("new")
            assert path.read_text() == "old" * 1000, "until the new one is complete"
        assert reader.read() == b"old" * 999
    assert path.read_text() == "new"


def test_an_error_leaves_the_old_file_and_nothing_else(tmp_path: Path) -> None:
    path = tmp_path / "world.replay"
    path.write_text("old")
    with pytest.raises(ZeroDivisionError), replacing(path) as fresh:
        fresh.write_text("half of the new")
        raise ZeroDivisionError
    assert path.read_text() == "old"
    assert [p.name for p in tmp_path.iterdir()] == ["world.replay"]


def test_content_is_on_the_disk_before_its_name_and_the_name_before_the_end(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """For a power cut: `fsync` of the file, `rename`, `fsync` of the folder."""
    done: list[str] = []
    monkeypatch.setattr(saving, "sync", lambda path: done.append("folder" if path.is_dir() else path.read_text()))
    rename = Path.replace
    monkeypatch.setattr(Path, "replace", lambda self, to: done.append("rename") or rename(self, to))
    with replacing(tmp_path / "a.json") as fresh:
        fresh.write_text("new")
    assert done == ["new", "rename", "folder"]


def test_what_a_killed_process_left_goes_after_an_hour_and_nothing_else(tmp_path: Path) -> None:
    names = [".film-abcdefgh.mp4", ".film-abcdefgh.png", ".film-a.mp4", ".films-abcdefgh.mp4", "film-abcdefgh.mp4"]
    for name in names:
        (tmp_path / name).write_text("half")
        os.utime(tmp_path / name, (time.time() - 7200,) * 2)
    (tmp_path / ".film-another_.mp4").write_text("a process writes it")
    with replacing(tmp_path / "film.mp4") as fresh:
        fresh.write_text("new")
    left = {".film-another_.mp4", "film.mp4", *names[1:]}
    assert {path.name for path in tmp_path.iterdir()} - {"state"} == left
