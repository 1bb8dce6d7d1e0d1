# SPDX-License-Identifier: Apache-2.0
"""The script that compares the hashes of scenes names what differs from the kept ones."""

import sys
from collections.abc import Callable
from pathlib import Path
from types import ModuleType

import pytest


@pytest.fixture
def script(load_tool: Callable[[str], ModuleType]) -> ModuleType:
    return load_tool("check_determinism")


def test_a_hash_that_changed_is_named_with_its_scene_and_time(script: ModuleType, tmp_path: Path) -> None:
    kept = tmp_path / "hashes.txt"
    script.write({"chain": ["a1", "b2", "c3"], "net": ["d4", "e5", "f6"]}, kept, "x86_64, glibc 2.36")
    changed = {"chain": ["a1", "b2", "c3"], "net": ["d4", "00", "00"]}
    wrong, _ = script.differences_from_kept(changed, kept, "x86_64, glibc 2.36")
    assert wrong == ["net differs from tenth 2 on"]
    wrong, compared = script.differences_from_kept(changed, kept, "x86_64, glibc 2.41")
    assert not wrong and compared == "not compared, they are of x86_64, glibc 2.36"


def test_a_program_with_other_hashes_than_the_kept_ones_fails_until_they_are_renewed(
    script: ModuleType, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    program = tmp_path / "program"
    program.write_text("#!/bin/sh\necho chain a1 00 00\n")
    program.chmod(0o755)
    monkeypatch.setattr(script, "KEPT", tmp_path / "hashes.txt")
    script.write({"chain": ["a1", "b2", "c3"]}, script.KEPT, script.library())
    for options, code in (([], 1), (["--renew"], 0), ([], 0)):
        monkeypatch.setattr(sys, "argv", ["check_determinism.py", "--program", str(program), *options])
        assert script.main() == code
    assert capsys.readouterr().out.count("chain differs from tenth 2 on. If that is meant: --renew") == 1
