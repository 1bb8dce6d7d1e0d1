# SPDX-License-Identifier: Apache-2.0
from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from types import ModuleType

import pytest


@pytest.fixture
def study_tables(load_tool: Callable[[str], ModuleType]) -> ModuleType:
    return load_tool("study_tables")


def test_statements_are_counted_without_blank_lines_comments_and_docstrings(
    study_tables: ModuleType, tmp_path: Path
) -> None:
    script = tmp_path / "study.py"
    script.write_text(
        '"""A study."""\n\nimport iota\n\nSIZE = 1\n\n\ndef build():\n    """The world."""\n    # why\n    world = iota.World(iota.System())\n'
        "    for _ in range(2):\n        swing()\n    return world\n\n\ndef present(world):\n    world.walk(\n        1,\n    )\n"
    )
    assert study_tables.categories(script) == {"scene setup": 5, "behavior": 2, "presentation": 4}


def test_all_studies_of_the_thesis_take_less_than_half_of_its_lines(study_tables: ModuleType) -> None:
    *_, last = study_tables.line_table().splitlines()
    ours, theirs = (int(cell.strip(" *")) for cell in last.split("|")[5:7])
    assert theirs == 2235 and 500 < ours < theirs / 2
