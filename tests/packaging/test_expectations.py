# SPDX-License-Identifier: Apache-2.0
"""docs/expectations.md names tests that are there."""

from __future__ import annotations

import re
from pathlib import Path

ROOT = Path(__file__).parents[2]
ROW = re.compile(r"^\| (\d+) \| (.+?) \| (.+?) \| (.*?) ?\|$", re.MULTILINE)
NAMED = re.compile(r"`([^`]+)`((?:(?!`).)*)")


def test_each_expectation_names_tests_that_exist() -> None:
    rows = ROW.findall((ROOT / "docs" / "expectations.md").read_text())
    assert [int(number) for number, *_ in rows] == list(range(1, 29))
    for number, _, state, shown in rows:
        named = NAMED.findall(shown)
        assert named or not state.startswith("yes"), f"row {number} says yes, but names no test"
        for file, names in named:
            text = (ROOT / file).read_text()
            for name in filter(None, (part.strip(" :;") for part in names.split(";"))):
                assert name in text, f"row {number}: {file} has no test {name!r}"
