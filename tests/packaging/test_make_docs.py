# SPDX-License-Identifier: Apache-2.0
"""The site of the documents: every page is in it, every link leads somewhere, and every header has a page."""

import re
from collections.abc import Callable
from pathlib import Path
from types import ModuleType

import pytest

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture
def tool(load_tool: Callable[[str], ModuleType]) -> ModuleType:
    return load_tool("make_docs")


def test_each_link_of_a_gathered_page_leads_to_a_gathered_file(tool: ModuleType, tmp_path: Path) -> None:
    made = tool.gather(ROOT, tmp_path)
    assert len(made) > 50 and Path("bench/README.md") in made, "with pages that others link to"
    links = 0
    for page in made:
        text = re.sub(r"^(```|~~~).*?^\1|^    [^\n]*$|`[^`\n]*`", "", (tmp_path / page).read_text(), flags=re.M | re.S)
        for target in re.findall(r"\]\((?![a-z]+:)([^)#\s]+)", text):
            assert (tmp_path / page.parent / target).is_file(), f"{page}: {target}"
            links += 1
    assert links > 200


def test_each_page_is_in_a_list(tool: ModuleType, tmp_path: Path) -> None:
    tool.stage(tmp_path)
    listed: set[Path] = set()
    for page in tmp_path.rglob("*.md"):
        for block in re.findall(r"^```\{toctree\}\n(.*?)^```", page.read_text(), flags=re.MULTILINE | re.DOTALL):
            entries = [line for line in block.splitlines() if line and not line.startswith(":")]
            names = [re.sub(r".*<(.*)>", r"\1", line) for line in entries]
            listed |= {(page.parent / f"{name}.md").resolve() for name in names}
    assert listed - {tmp_path / "cpp" / "index.md"} == set(tmp_path.rglob("*.md")) - {tmp_path / "index.md"}


@pytest.mark.parametrize("target", ["gone.md", "../other.png", "../../outside.md"])
def test_a_link_to_nothing_is_an_error(tool: ModuleType, tmp_path: Path, target: str) -> None:
    root = tmp_path / "root"
    for name in tool.FIRST:
        (root / name).parent.mkdir(parents=True, exist_ok=True)
        (root / name).write_text("# Title\n")
    (tmp_path / "outside.md").write_text("# Not ours\n")
    (root / "docs").mkdir()
    (root / "docs" / "guide.md").write_text(f"# Guide\n\n    [code]({target}x)\n\n[a link]({target}#part)\n")
    with pytest.raises(tool.BrokenLinkError, match=re.escape(f"docs/guide.md links to {target}")):
        tool.gather(root, tmp_path / "out")


def test_a_link_to_a_source_brings_it_along_and_one_to_a_folder_is_its_name(tool: ModuleType, tmp_path: Path) -> None:
    root = tmp_path / "root"
    for name in [*tool.FIRST, "docs/guide.md", "src/a.h"]:
        (root / name).parent.mkdir(parents=True, exist_ok=True)
        (root / name).write_text("# Title\n")
    (root / "docs" / "guide.md").write_text("# Guide\n\n[a](../src/a.h), [all](../src), [far](https://example.org)\n")
    tool.gather(root, tmp_path / "out")
    assert (tmp_path / "out" / "src" / "a.h").is_file()
    assert (tmp_path / "out" / "docs" / "guide.md").read_text() == (
        "# Guide\n\n[a](../src/a.h), all, [far](https://example.org)\n"
    )


def test_comments_on_a_namespace_are_about_their_header(tool: ModuleType) -> None:
    header = "#pragma once\n/// Laws.\n/// More.\nnamespace iota {\n\n/// @name By name\n/// Text.\n///@{\nint a;\n///@}\n}\n"
    assert tool.about_file(header) == (
        "#pragma once\n/// \\file\n/// Laws.\n/// More.\n\nnamespace iota {\n\n"
        "/// \\file\n/// By name\n///\n/// Text.\n\nint a;\n}\n"
    )


def test_a_film_is_shown_on_the_page_of_its_study(
    tool: ModuleType, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    films = tmp_path / "films"
    films.mkdir()
    for name in ("chain", "of_nothing"):
        (films / f"{name}.mp4").write_bytes(b"a film")
    monkeypatch.setattr(tool, "FILMS", films)
    tool.stage(tmp_path / "out")
    assert [path.name for path in (tmp_path / "out" / "_extra" / "films").iterdir()] == ["chain.mp4"]
    text = (tmp_path / "out" / "docs" / "studies" / "chain.md").read_text()
    assert re.match(r'# [^\n]+\n\n<video controls [^>]*src="\.\./\.\./films/chain\.mp4"></video>\n', text), text[:200]
