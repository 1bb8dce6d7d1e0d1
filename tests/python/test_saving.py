# SPDX-License-Identifier: Apache-2.0
"""Files that are written completely or not at all."""

from __future__ import annotations

from pathlib import Path

import pytest

from iota.saving import replacing


def test_who_has_the_old_file_open_reads_it_to_its_end(tmp_path: Path) -> None:
    path = tmp_path / "world.iota"
    path.write_text("old" * 1000)
    with path.open("rb", buffering=0) as reader:
        assert reader.read(3) == b"old"
        with replacing(path) as fresh:
            fresh.write_text("new")
            assert path.read_text() == "old" * 1000, "until the new one is complete"
        assert reader.read() == b"old" * 999
    assert path.read_text() == "new"


def test_an_error_leaves_the_old_file_and_nothing_else(tmp_path: Path) -> None:
    path = tmp_path / "world.iota"
    path.write_text("old")
    with pytest.raises(ZeroDivisionError), replacing(path) as fresh:
        fresh.write_text("half of the new")
        raise ZeroDivisionError
    assert path.read_text() == "old"
    assert [p.name for p in tmp_path.iterdir()] == ["world.iota"]
