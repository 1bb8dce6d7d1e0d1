# SPDX-License-Identifier: Apache-2.0
"""What the engine offers to Python, as its stub file tells it, changes only on purpose."""

from __future__ import annotations

import difflib
from pathlib import Path

import pytest

import iota

STUB = Path(iota.__file__).parent / "_core.pyi"
GOLDEN = Path(__file__).parent / "golden" / "core_stub.txt"
SHOWN = 60  # lines


def test_the_stub_is_the_golden_one() -> None:
    now, then = STUB.read_text().splitlines(), GOLDEN.read_text().splitlines()
    changes = list(difflib.unified_diff(then, now, str(GOLDEN), str(STUB), lineterm=""))
    if changes:
        more = ["..."] if len(changes) > SHOWN else []
        pytest.fail("\n".join([*changes[:SHOWN], *more, f"If that is meant: cp {STUB} {GOLDEN}"]), pytrace=False)
