#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Makes the pictures of the tutorials: runs the blocks of each page and takes a picture of the world that it runs.

tools/make_tutorials.py [NAME ...]      docs/tutorials/NAME.md -> docs/pictures/tutorials/NAME.jpg
"""

from __future__ import annotations

import os
import re
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import iota
from iota.film import Film, record
from iota.world.options import RunOptions, use

ROOT = Path(__file__).resolve().parent.parent
PAGES = ROOT / "docs" / "tutorials"
PICTURES = ROOT / "docs" / "pictures" / "tutorials"
MOMENT = {"break-things": 0.7, "first-world": 1.6}  # s, when the picture is taken
USUAL = 1.0


@contextmanager
def another_folder() -> Iterator[None]:
    """Pages write small files."""
    before = Path.cwd()
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        try:
            yield
        finally:
            os.chdir(before)


def make(page: Path) -> None:
    sheet = PICTURES / f"{page.stem}.jpg"
    film = Film(sheet=sheet, seconds=2 * MOMENT.get(page.stem, USUAL), rate=20, width=800, height=450, pictures=1)

    def drive(world: iota.World) -> None:
        record(world, film)

    with use(RunOptions(drive=drive)), another_folder():
        names: dict[str, object] = {}
        for number, block in enumerate(re.findall(r"^```python\n(.*?)^```", page.read_text(), re.M | re.S), start=1):
            exec(compile(block, f"{page.name}, block {number}", "exec"), names)


def main(names: list[str]) -> int:
    PICTURES.mkdir(parents=True, exist_ok=True)
    for page in sorted(PAGES.glob("*.md")):
        if not names or page.stem in names:
            make(page)
            print(page.stem, flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
