# SPDX-License-Identifier: Apache-2.0
"""docs/api is what the docstrings say now, and has all that is public."""

from __future__ import annotations

import inspect
import re
import runpy
import types
from functools import cache
from pathlib import Path

import pytest

import iota
from iota import builder, effects, shapelib

ROOT = Path(__file__).parents[2]
MAKE_API = runpy.run_path(str(ROOT / "tools" / "make_api.py"))


@cache  # not while tests are collected, which each worker does
def pages() -> dict[Path, str]:
    made: dict[Path, str] = MAKE_API["pages"]()
    return made


@pytest.mark.parametrize("name", [*MAKE_API["CONTENTS"], "README"])
def test_a_page_of_the_reference_is_up_to_date(name: str) -> None:
    path = MAKE_API["PAGES"] / f"{name}.md"
    assert path.is_file() and path.read_text() == pages()[path], "run tools/make_api.py"


def test_all_pages_of_the_reference_are_looked_at() -> None:
    assert {path.stem for path in pages()} == {*MAKE_API["CONTENTS"], "README"}


@pytest.mark.parametrize("module", [iota, iota.types, builder, effects, shapelib], ids=lambda module: module.__name__)
def test_the_reference_has_every_public_class_and_function(module: types.ModuleType) -> None:
    public = [name for name in module.__all__ if callable(getattr(module, name))]
    headings = {heading for text in pages().values() for heading in re.findall(r"^## (\w+)$", text, re.M)}
    # Shape is the union of all shapes.
    assert [name for name in public if name not in headings and name != "Shape"] == []


def test_every_public_class_and_function_has_a_docstring() -> None:
    for module in (iota, iota.types, builder, effects, shapelib):
        for name in module.__all__:
            thing = getattr(module, name)
            if inspect.isclass(thing) or inspect.isroutine(thing):
                assert inspect.getdoc(thing), f"{module.__name__}.{name}"


def test_members_are_those_of_the_living_classes() -> None:
    """Of a class with bases in other files, too."""
    text = pages()[MAKE_API["PAGES"] / "world.md"].split("## World\n")[1].split("\n## ")[0]
    told = set(re.findall(r"^### `(\w+)\(", text, re.M)) | set(re.findall(r"^\| `(\w+)` \|", text, re.M))
    own = {name for name in dir(iota.World) if not name.startswith("_")}
    assert own == told - {"World"}
