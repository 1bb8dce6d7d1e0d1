# SPDX-License-Identifier: Apache-2.0
"""Snapshots and journals of earlier tables, which later versions of Iota read."""

from __future__ import annotations

import json
import shutil
import time
import zlib
from pathlib import Path

import numpy as np
import pytest
from make_golden_snapshot import GOLDEN, everything, kept_world

import iota
from iota.journal import records
from iota.journal.folder import Folder
from iota.journal.reader import find
from iota.world import journal as journals

LETTERS = sorted(path.name for path in GOLDEN.iterdir())


def test_there_is_a_snapshot_of_all_tables_that_are_read() -> None:
    """A change of tables adds a folder: J2, J3 ... The letter stays."""
    assert {"I", "J"} <= set(LETTERS) and iota.System().snapshot()[:7] == b"IOTASOJ"


@pytest.mark.parametrize("letter", LETTERS)
def test_a_snapshot_of_earlier_tables_is_the_same_world_and_goes_on(letter: str) -> None:
    facts = json.loads((GOLDEN / letter / "everything.json").read_text())
    system = iota.System(threads=1)
    system.restore(zlib.decompress((GOLDEN / letter / "everything.z").read_bytes()))
    assert system.validate() == [] and system.time == facts["time"]
    assert np.array_equal(system.positions, facts["positions"])
    assert system.energy.total == pytest.approx(facts["energy"], rel=1e-12)
    assert [body.name for body in system.bodies if body.name] == ["upper"] and len(system.contacts) > 0
    for _ in range(5):
        system.step(1 / 120)
    assert system.validate() == []


def test_a_snapshot_of_the_letter_before_has_the_bits_of_its_world() -> None:
    system = iota.System()
    system.restore(zlib.decompress((GOLDEN / "I" / "everything.z").read_bytes()))
    now = everything()
    if np.array_equal(now.positions, system.positions):  # else the physics has changed since
        assert system.state_hash() == now.state_hash()


@pytest.mark.parametrize("letter", LETTERS)
def test_a_journal_of_earlier_tables_goes_on(letter: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    shutil.copytree(GOLDEN / letter / "journal", tmp_path / "kept")
    world = kept_world(tmp_path / "kept")
    world._begin()
    told = capsys.readouterr().err
    assert "goes on where it was" in told and world.system.time > 0, told
    for _ in range(3):
        world.step()
    assert world.system.validate() == []
    world.close()


def test_a_snapshot_tells_its_schema_and_a_damaged_one_is_refused_in_words() -> None:
    system = iota.System()
    system.body().particle((0, 1, 0))
    whole = system.snapshot()
    assert b"\nprevious_in_ring u 4 " in whole
    with pytest.raises(ValueError, match="may have been cut short"):
        system.restore(whole[:-20])
    with pytest.raises(ValueError, match="does not start as one of this version of Iota"):
        system.restore(b"IOTASOF" + whole[7:])


def test_a_journal_has_the_schema_of_its_snapshots_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(journals, "HAND_OVER", 0.0)
    monkeypatch.setattr(journals, "CHECKPOINT", 0.0)
    world = kept_world(tmp_path / "kept")
    world.serve(port=0)
    for _ in range(6):
        world.advance(2)
        world._stepper.check_journal()
        time.sleep(0.01)  # of the thread that writes
    world.close()
    (path,) = (tmp_path / "kept").glob("*.journal")
    kept = [record for record in records.unpack(path.read_bytes()) if record.kind == "S" and record.content is not None]
    assert len(kept) > 1 and path.read_bytes().count(b"previous_in_ring") == 1
    found = find(Folder(tmp_path / "kept"))
    assert found is not None and len(found.snapshot) > len(kept[-1].content or b"")
    iota.System().restore(found.snapshot)


def test_what_is_no_snapshot_without_a_schema_stays_as_it_is() -> None:
    whole = iota.System().snapshot()
    schema = records.schema_of(whole)
    short = records.without_schema(whole, schema)
    assert len(short) == len(whole) - len(schema) and records.with_schema(short, schema) == whole
    for other in (b"", b"x" * 40, whole):
        assert records.with_schema(other, schema) == other
    assert records.without_schema(short, schema) == short


@pytest.mark.parametrize(
    "path", sorted(GOLDEN.glob("*/run-*.replay")), ids=lambda path: f"{path.parent.name}-{path.stem}"
)
def test_a_recording_of_an_earlier_version_is_repeated(path: Path) -> None:
    recording, system = iota.types.Recording.load(path), iota.System()
    assert system.replay(recording) is None and recording.steps == 20
    ball = next(body for body in system.bodies if body.name == "ball")
    assert ball.position.y == pytest.approx(2.903985, abs=1e-6)
