# SPDX-License-Identifier: Apache-2.0
"""The examples, run as they are."""

from __future__ import annotations

import runpy
from pathlib import Path

import pytest

from iota.world.options import RunOptions, use

EXAMPLES = Path(__file__).resolve().parents[2] / "examples" / "python"


@pytest.mark.parametrize("path", sorted(EXAMPLES.glob("*.py")), ids=lambda path: path.name)
def test_every_example_runs(path: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)  # some write a file
    with use(RunOptions(headless=True, seconds=0.5)) as options:
        runpy.run_path(str(path), run_name="__main__")
    assert options.summary is not None and options.summary.simulated_s == pytest.approx(0.5)
