# SPDX-License-Identifier: Apache-2.0
"""The places where tools/check_one_more.py adds its lines. The tool itself builds a copy, which takes minutes."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "tools"))

import check_one_more

ROOT = check_one_more.ROOT


def test_each_place_for_one_more_of_a_kind_is_there_once() -> None:
    counts = {
        (name, place): (ROOT / name).read_text().count(place)
        for name, lines in check_one_more.LINES.items()
        for place in lines
    }
    assert {place: count for place, count in counts.items() if count != 1} == {}


def test_one_more_costs_the_files_that_the_architecture_page_says() -> None:
    added = {path.relative_to(check_one_more.ADDED).as_posix() for path in check_one_more.ADDED.rglob("*.*")}
    files = {name for name in {*added, *check_one_more.LINES} if not name.startswith("tests/")}
    shape = {name for name in files if "shape" in name}
    message = {"protocol/schema.json", "python/iota/world/inputs.py", "web/src/ui/overlay.ts"}
    joint = {
        "src/solver/constraints/level.h",
        "src/solver/constraints/constraint_list.h",
        "include/iota/kinds.h",
        "src/ingredient/constraint.h",
        "src/ingredient/pin_form.h",
        "bindings/bind_constraints.cpp",
    }
    assert message < files and joint < files
    handle = files - shape - message - joint
    assert len(handle) == 8, sorted(handle)
