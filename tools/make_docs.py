#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Makes a site with search of all documents: build/docs/site/index.html. `make docs` installs what it needs.

The documents are gathered in build/docs/source, in the folders that they have here, so that their links hold. Files of sources that
they link to come along; links to folders become names. A link to nothing is an error, and so is a page that no list leads to.
"""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
OUT = ROOT / "build" / "docs"
FILMS = ROOT / "build" / "films"
HEADERS = ROOT / "include" / "iota"
FIRST = ["README.md", "CHANGELOG.md", "CONTRIBUTING.md", "SECURITY.md", "protocol/README.md", "web/README.md"]
#: A link or picture, outside of code: its text, its target without an anchor, and the anchor.
LINK = re.compile(r"(!?)\[((?:[^\[\]]|\[[^\]]*\])*)\]\(([^)#\s]+)(#[^)\s]*)?\)")
FENCE = re.compile(r"^(```|~~~)")

DOXYGEN = """
PROJECT_NAME = Iota
INPUT = {headers}
STRIP_FROM_INC_PATH = {include}
OUTPUT_DIRECTORY = {out}
GENERATE_HTML = NO
GENERATE_LATEX = NO
GENERATE_XML = YES
XML_PROGRAMLISTING = NO
EXTRACT_ALL = YES
WARNINGS = NO
QUIET = YES
"""


class BrokenLinkError(Exception):
    """A page links to what is not there; the text names both."""


def pages(root: Path) -> list[Path]:
    """All documents, relative to the root."""
    found = [Path(name) for name in FIRST]
    found += [path.relative_to(root) for path in sorted((root / "docs").rglob("*.md")) if "site" not in path.parts]
    return found


def prose(lines: list[str]) -> Iterator[tuple[int, str]]:
    """The lines outside of code blocks, with their numbers."""
    is_code = False
    for number, line in enumerate(lines):
        if FENCE.match(line.lstrip()):
            is_code = not is_code
        elif not is_code and not line.startswith("    "):
            yield number, line


def gather(root: Path, source: Path) -> list[Path]:
    """Copies the documents and what they link to; returns all pages."""
    waiting, known = pages(root), set(pages(root))
    while waiting:
        page = waiting.pop(0)
        lines = (root / page).read_text().split("\n")
        for number, line in prose(lines):
            lines[number] = LINK.sub(lambda match, page=page: settle(root, source, page, match, waiting, known), line)
        # The site has no drawer of diagrams, which would come from elsewhere: their text can be read.
        lines = [re.sub(r"^```mermaid$", "```text", line) for line in lines]
        target = source / page
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_text("\n".join(lines))
    return sorted(known)


def settle(root: Path, source: Path, page: Path, match: re.Match[str], waiting: list[Path], known: set[Path]) -> str:
    """The text of a link in the copy of a page. Copies its target, or notes it as a page to copy."""
    _, text, target, _ = match.groups()
    if re.match(r"[a-z]+:", target):
        return match[0]
    file = (root / page.parent / target).resolve()
    if not file.exists() or not file.is_relative_to(root):
        raise BrokenLinkError(f"{page} links to {target}, which is not there")
    if file.is_dir():
        return text
    relative = file.relative_to(root)
    if file.suffix == ".md":
        if relative not in known:
            known.add(relative)
            waiting.append(relative)
    else:
        (source / relative).parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(file, source / relative)
    return match[0]


def add_lists(source: Path, made: list[Path]) -> None:
    """Pages that a page of their folder leads to: the studies, and the Python reference."""
    for folder, over in (("docs/studies", "docs/studies.md"), ("docs/api", "docs/api/README.md")):
        names = [page.stem for page in made if page.parent == Path(folder) and page.name != "README.md"]
        up = f"{Path(folder).name}/" if Path(over).parent != Path(folder) else ""
        lines = ["", "```{toctree}", ":hidden:", "", *(up + name for name in names), "```", ""]
        with (source / over).open("a") as file:
            file.write("\n".join(lines))


def add_films(source: Path) -> None:
    """Puts what `make films` has recorded on the page of its study."""
    for film in sorted(FILMS.glob("*.mp4")):
        page = source / "docs" / "studies" / f"{film.stem}.md"
        if not page.is_file():
            continue
        place = source / "_extra" / "films" / film.name
        place.parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(film, place)
        title, rest = page.read_text().split("\n", 1)
        video = f'<video controls preload="none" style="width: 100%" src="../../films/{film.name}"></video>'
        page.write_text(f"{title}\n\n{video}\n{rest}")


def about_file(header: str) -> str:
    """A header whose comments on its namespace are about the file: Doxygen would show them with each file of the namespace."""
    header = re.sub(r"^((?:///[^\n]*\n)+)(?=namespace iota)", r"/// \\file\n\1\n", header, flags=re.MULTILINE)
    header = re.sub(
        r"^/// @name (.*\n)((?:///.*\n)*?)///@\{\n", r"/// \\file\n/// \1///\n\2\n", header, flags=re.MULTILINE
    )
    return re.sub(r"^///@\}\n", "", header, flags=re.MULTILINE)


def add_headers(source: Path) -> None:
    """A page for each public header, by Doxygen and Breathe."""
    folder, staged = source / "cpp", OUT / "headers" / "iota"
    folder.mkdir(parents=True, exist_ok=True)
    shutil.rmtree(staged, ignore_errors=True)
    staged.mkdir(parents=True)
    for header in HEADERS.glob("*.h"):
        (staged / header.name).write_text(about_file(header.read_text()).replace("<name>", "NAME"))
    settings = DOXYGEN.format(headers=staged, include=staged.parent, out=folder)
    subprocess.run(["doxygen", "-"], input=settings, text=True, check=True)
    names = sorted(path.stem for path in HEADERS.glob("*.h"))
    for name in names:
        (folder / f"{name}.md").write_text(f"# iota/{name}.h\n\n```{{doxygenfile}} {name}.h\n```\n")
    listed = "\n".join(names)
    (folder / "index.md").write_text(
        "# The C++ reference\n\nThe public headers; `iota/system.h` includes the others. How to use them: "
        f"[Iota in another program](../docs/embedding.md).\n\n```{{toctree}}\n:maxdepth: 1\n\n{listed}\n```\n"
    )


def stage(source: Path) -> None:
    shutil.rmtree(source, ignore_errors=True)
    for folder in ("_static", "_extra"):
        (source / folder).mkdir(parents=True)
    made = gather(ROOT, source)
    add_lists(source, made)
    add_films(source)
    for name in ("conf.py", "index.md"):
        shutil.copyfile(ROOT / "docs" / "site" / name, source / name)
    shutil.copyfile(ROOT / "web" / "src" / "favicon.svg", source / "_static" / "favicon.svg")


def main() -> int:
    source, site = OUT / "source", OUT / "site"
    try:
        stage(source)
    except BrokenLinkError as error:
        print(error, file=sys.stderr)
        return 1
    add_headers(source)
    shutil.rmtree(site, ignore_errors=True)
    build = [sys.executable, "-m", "sphinx", "-b", "html", "-q", "-W", "--keep-going", "-d", OUT / "doctrees"]
    done = subprocess.run([*map(str, build), str(source), str(site)])
    if done.returncode == 0:
        print(f"{(site / 'index.html').relative_to(ROOT)}")
    return done.returncode


if __name__ == "__main__":
    sys.exit(main())
