# SPDX-License-Identifier: Apache-2.0
from __future__ import annotations

import importlib.util
import sys
from pathlib import Path

ROOT = Path(__file__).parents[2]
spec = importlib.util.spec_from_file_location("study_tables", ROOT / "tools" / "study_tables.py")
assert spec is not None and spec.loader is not None
study_tables = importlib.util.module_from_spec(spec)
sys.modules[spec.name] = study_tables  # dataclasses look their module up
spec.loader.exec_module(study_tables)


def test_statements_are_counted_without_blank_lines_comments_and_docstrings(tmp_path: Path) -> None:
    script = tmp_path / "study.py"
    script.write_text(
        '"""A study."""\n\nimport iota\n\nSIZE = 1\n\n\ndef build():\n    """The world."""\n    # why\n    world = iota.World(iota.System())\n'
        "    for _ in range(2):\n        swing()\n    return world\n\n\ndef present(world):\n    world.walk(\n        1,\n    )\n"
    )
    assert study_tables.categories(script) == {"scene setup": 5, "behavior": 2, "presentation": 4}


def test_all_studies_of_the_thesis_take_less_than_half_of_its_lines() -> None:
    *_, last = study_tables.line_table().splitlines()
    ours, theirs = (int(cell.strip(" *")) for cell in last.split("|")[5:7])
    assert theirs == 2235 and 500 < ours < theirs / 2
