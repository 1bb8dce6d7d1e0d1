# SPDX-License-Identifier: Apache-2.0
from __future__ import annotations

import subprocess
import sys
from pathlib import Path

TOOL = Path(__file__).resolve().parents[2] / "tools" / "make_films.py"


def test_a_study_that_does_not_exist_is_reported_in_one_line() -> None:
    done = subprocess.run([sys.executable, TOOL, "nosuch"], capture_output=True, text=True)
    assert done.returncode == 1
    assert done.stderr.startswith("iota: there is no study 'nosuch'") and done.stderr.count("\n") == 1
