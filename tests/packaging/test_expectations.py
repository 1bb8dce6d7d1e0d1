# SPDX-License-Identifier: Apache-2.0
"""docs/expectations.md, docs/interaction.md and docs/attacks.md name tests that are there."""

from __future__ import annotations

import re
from pathlib import Path

ROOT = Path(__file__).parents[2]
ROW = re.compile(r"^\| (\d+) \| (.+?) \| (.+?) \| (.*?) ?\|$", re.MULTILINE)
PART = re.compile(r"^\| ([^|]+?) \| (`[^|]+\.test\.ts`[^|]+|`tests/[^|]+) \|$", re.MULTILINE)
NAMED = re.compile(r"`([^`]+)`((?:(?!`).)*)")


def test_each_expectation_names_tests_that_exist() -> None:
    rows = ROW.findall((ROOT / "docs" / "expectations.md").read_text())
    assert [int(number) for number, *_ in rows] == list(range(1, 29))
    for number, _, state, shown in rows:
        assert NAMED.findall(shown) or not state.startswith("yes"), f"row {number} says yes, but names no test"
        check_names(f"row {number}", shown)


def test_each_part_of_interaction_names_tests_that_exist() -> None:
    table, shown = (ROOT / "docs" / "interaction.md").read_text().split("| part | shown by |")
    rows = PART.findall(shown)
    assert len(rows) == shown.count("\n| ")
    parts = ", ".join(part for part, _ in rows)
    for part, names in rows:
        check_names(part, names)
    for part in re.findall(r"^\| ([a-z][^|]+?) \|", table, re.MULTILINE)[1:]:
        for word in re.split(r", |: ", part)[:1]:
            assert word in parts, f"nothing shows {part!r}"


def test_each_attack_names_tests_that_exist() -> None:
    rows = re.findall(
        r"^\| ([^|]+) \|(?:.*\|)? (?:\* )?(`[^|]+) \|$", (ROOT / "docs" / "attacks.md").read_text(), re.MULTILINE
    )
    assert len(rows) > 85
    makefile, soak = (ROOT / "Makefile").read_text(), (ROOT / "tools" / "soak.py").read_text()
    for attack, shown in rows:
        for goal, run in re.findall(r"`make (\w+)(?: SOAK=(\w+))?`", shown):
            assert f"\n{goal}: " in makefile and (not run or f'"{run}": [' in soak), f"{attack}: make {goal} {run}"
        check_names(attack, re.sub(r"`make [^`]+`", "", shown))


def check_names(row: str, shown: str) -> None:
    for file, names in NAMED.findall(shown):
        text = (ROOT / file).read_text()
        for name in filter(None, (part.strip(" :;") for part in names.split(";"))):
            assert name in text or name.replace(" ", "_") in text, f"{row}: {file} has no test {name!r}"
