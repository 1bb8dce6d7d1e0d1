# SPDX-License-Identifier: Apache-2.0
"""What README and tutorial tell people to type is run here."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from built_studies import built

from iota import studies
from iota.world.actions import PAGE_KEYS
from iota.world.options import RunOptions, use

ROOT = Path(__file__).parents[2]


def blocks(page: Path) -> list[str]:
    """The Python blocks of a Markdown page."""
    return re.findall(r"^```python\n(.*?)^```", page.read_text(), re.M | re.S)


def test_every_block_of_the_tutorial_runs() -> None:
    names: dict[str, object] = {}
    found = blocks(ROOT / "docs" / "tutorial.md")
    assert len(found) >= 7
    for number, block in enumerate(found, start=1):
        exec(compile(block, f"docs/tutorial.md, block {number}", "exec"), names)


def test_the_script_in_the_readme_is_the_example_and_at_most_twenty_lines_long() -> None:
    (script,) = blocks(ROOT / "README.md")
    example = (ROOT / "examples" / "python" / "pendulum.py").read_text()
    assert example.removeprefix("# SPDX-License-Identifier: Apache-2.0\n") == script
    assert len(script.splitlines()) <= 20


def test_the_blocks_of_the_page_on_replaceable_parts_run(capsys: pytest.CaptureFixture[str]) -> None:
    for block in blocks(ROOT / "docs" / "replaceable.md"):
        exec(compile(block, "docs/replaceable.md", "exec"), {})
    assert "1.41421356" in capsys.readouterr().out


def test_the_block_of_the_page_on_sweeps_runs() -> None:
    for block in blocks(ROOT / "docs" / "sweeps.md"):
        exec(compile(block, "docs/sweeps.md", "exec"), {"__name__": "__main__"})


def test_the_blocks_of_the_page_on_files_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    names: dict[str, object] = {}
    for block in blocks(ROOT / "docs" / "shapelib.md"):
        exec(compile(block, "docs/shapelib.md", "exec"), names)


def test_the_blocks_of_the_page_on_builders_run() -> None:
    names: dict[str, object] = {}
    for block in blocks(ROOT / "docs" / "builder.md"):
        exec(compile(block, "docs/builder.md", "exec"), names)


@pytest.mark.parametrize("page", sorted((ROOT / "docs" / "tutorials").glob("*.md")), ids=lambda page: page.stem)
def test_a_tutorial_runs_and_has_its_picture(page: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    names: dict[str, object] = {}
    with use(RunOptions(headless=True, seconds=0.5)) as options:
        for number, block in enumerate(blocks(page), start=1):
            exec(compile(block, f"docs/tutorials/{page.name}, block {number}", "exec"), names)
    assert options.summary is not None and options.summary.steps > 0, "it ends in a world that runs"
    keys = {action.key for action in names["world"]._state.actions}  # type: ignore[attr-defined]
    assert keys.isdisjoint(PAGE_KEYS), "the page's own keys stay as they are"
    (picture,) = re.findall(r"!\[.+\]\((.+)\)", page.read_text())
    assert (page.parent / picture).is_file()


STUDY_PAGES = sorted((ROOT / "docs" / "studies").glob("*.md"))


def studies_of(page: Path) -> list[str]:
    """The studies that a page is about."""
    return re.findall(r"`iota run ([\w-]+)`", page.read_text())


@pytest.mark.parametrize("page", STUDY_PAGES, ids=lambda page: page.stem)
def test_the_page_on_a_study_has_its_picture_its_keys_and_things_to_try(page: Path) -> None:
    text = page.read_text()
    actions = [action for name in studies_of(page) for action in built(name)._state.actions]
    keys = {action.key for action in actions if action.key is not None and len(action.key) == 1}
    assert keys <= set(re.findall(r"`([a-z])`", text)) <= keys | set(PAGE_KEYS)
    assert re.search(r"^(Try|What to try|## What to try)", text, re.M)
    assert all((page.parent / picture).is_file() for picture in re.findall(r"!\[.+\]\((.+)\)", text) or ["none"])


def test_every_study_has_a_page() -> None:
    assert sorted(name for page in STUDY_PAGES for name in studies_of(page)) == studies.names()


@pytest.mark.parametrize("page", STUDY_PAGES, ids=lambda page: page.stem)
def test_the_blocks_of_the_page_on_a_study_run(page: Path) -> None:
    names: dict[str, object] = {}
    for number, block in enumerate(blocks(page), start=1):
        exec(compile(block, f"docs/studies/{page.name}, block {number}", "exec"), names)
