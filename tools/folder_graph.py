#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Prints which folders of src/ include which, and fails when two of them include each other.

    python3 tools/folder_graph.py [SRC]

A folder is a path below SRC that holds sources, such as `solver/sparse`; public headers count as `iota`. Exit code 1
when the graph has a cycle, direct or through others, or when the solver sees the model: only `step` knows both.
"""

from __future__ import annotations

import re
import sys
from pathlib import Path

INCLUDE = re.compile(r'^\s*#\s*include\s*[<"]([^>"]+)[>"]', re.MULTILINE)
SUFFIXES = {".h", ".hpp", ".cpp"}
# Rules of the architecture that a graph without cycles could still break: (who, must not see).
FORBIDDEN = [("solver", "model"), ("net", "model"), ("net", "solver"), ("net", "step")]


def read_graph(src: Path) -> dict[str, dict[str, list[str]]]:
    """folder -> folder it includes -> the including files."""
    graph: dict[str, dict[str, list[str]]] = {}
    for path in sorted(p for p in src.rglob("*") if p.suffix in SUFFIXES):
        here = path.parent.relative_to(src).as_posix()
        edges = graph.setdefault(here, {})
        for name in INCLUDE.findall(path.read_text(errors="replace")):
            beside, below = path.parent / name, src / name
            if name.startswith("iota/"):
                target = "iota"
            elif below.is_file():
                target = below.parent.relative_to(src).as_posix()
            elif beside.is_file():
                target = beside.resolve().parent.relative_to(src.resolve()).as_posix()
            else:
                continue  # the standard library, Boost, generated files
            if target != here:
                edges.setdefault(target, []).append(path.name)
    return graph


def find_cycles(graph: dict[str, dict[str, list[str]]]) -> list[list[str]]:
    """One cycle for each folder from which it can be entered first, in order of names."""
    cycles: list[list[str]] = []
    done: set[str] = set()

    def visit(folder: str, path: list[str]) -> None:
        if folder in path:
            cycles.append(path[path.index(folder) :] + [folder])
            return
        if folder in done:
            return
        for target in sorted(graph.get(folder, {})):
            visit(target, [*path, folder])
        done.add(folder)

    for folder in sorted(graph):
        visit(folder, [])
    return cycles


def is_within(folder: str, parent: str) -> bool:
    return folder == parent or folder.startswith(parent + "/")


def main(arguments: list[str]) -> int:
    src = Path(arguments[0]) if arguments else Path(__file__).resolve().parent.parent / "src"
    graph = read_graph(src)
    if not graph:
        print(f"{src} holds no sources", file=sys.stderr)
        return 1
    for folder, edges in graph.items():
        print(f"{folder:24} -> {', '.join(sorted(edges)) or '-'}")
    wrong = [" -> ".join(cycle) for cycle in find_cycles(graph)]
    for folder, edges in graph.items():
        for who, what in FORBIDDEN:
            for target, files in edges.items():
                if is_within(folder, who) and is_within(target, what):
                    wrong.append(f"{who} must not see {what}: {folder}/{{{', '.join(files)}}} -> {target}")
    for line in wrong:
        print(f"wrong: {line}", file=sys.stderr)
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
