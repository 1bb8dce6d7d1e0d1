#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Counts the sources of src that read each public header, directly or through other headers: a change compiles them anew.

    python3 tools/count_includes.py                 all public headers
    python3 tools/count_includes.py iota/shapes.h   which headers and sources include it, with the number that read each

Exit code 1 if a header other than those of EVERYWHERE is read by more than a third.
"""

from __future__ import annotations

import re
import sys
from collections import Counter
from functools import cache
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
INCLUDE = re.compile(r'^\s*#\s*include\s*[<"]([^>"]+)[>"]', re.MULTILINE)
# Records of the model have these as members, or are made of vectors: docs/why.md says why.
EVERYWHERE = {
    f"iota/{name}.h" for name in ("vec3", "ids", "kinds", "attributes", "joint_options", "materials", "view_event")
}
LARGEST_SHARE = 1 / 3


@cache
def included(path: Path) -> frozenset[Path]:
    """The headers of ours that a file includes itself."""
    places = (ROOT / "include", ROOT / "src", path.parent)
    names = INCLUDE.findall(path.read_text())
    return frozenset(
        found for name in names if (found := next((p / name for p in places if (p / name).is_file()), None))
    )


def reached(path: Path) -> set[Path]:
    seen: set[Path] = set()
    new = [path]
    while new:
        for header in included(new.pop()) - seen:
            seen.add(header)
            new.append(header)
    return seen


def readers() -> tuple[int, Counter[Path]]:
    """The number of sources, and of those that read each header."""
    sources = sorted((ROOT / "src").rglob("*.cpp"))
    return len(sources), Counter(header for source in sources for header in reached(source))


def counts() -> tuple[int, dict[str, int]]:
    """The number of sources, and of those that read each public header."""
    total, by_header = readers()
    public = sorted((ROOT / "include").rglob("*.h"))
    return total, {str(header.relative_to(ROOT / "include")): by_header[header] for header in public}


def print_includers(name: str) -> int:
    header = ROOT / "include" / name
    if not header.is_file():
        print(f"{name} is not in include. Name it as it is included, such as iota/shapes.h", file=sys.stderr)
        return 1
    _, by_header = readers()
    files = [path for path in (ROOT / "src").rglob("*") if path.suffix in (".h", ".cpp")]
    files += (ROOT / "include").rglob("*.h")
    including = [(by_header[path] or 1, path.relative_to(ROOT)) for path in files if header in included(path)]
    for number, path in sorted(including, key=lambda found: (-found[0], found[1])):
        print(f"{number:5} {path}")
    return 0


def main(arguments: list[str]) -> int:
    if arguments:
        return print_includers(arguments[0])
    total, by_name = counts()
    wide = [name for name, number in by_name.items() if number > LARGEST_SHARE * total and name not in EVERYWHERE]
    print(f"read by, of {total} sources:")
    for name, number in sorted(by_name.items(), key=lambda item: -item[1]):
        print(f"{number:5} {number / total:6.0%} {name}{' (too many)' if name in wide else ''}")
    return int(bool(wide))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
