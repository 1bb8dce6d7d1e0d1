#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Prints the dependencies of folders in C++, TypeScript and Python, and fails if two folders depend on each other.

    python3 tools/folder_graph.py [TREE ...]

Without arguments: src, web/src and python/iota. A folder is a path below its tree that holds sources, such as
`solver/sparse`; public C++ headers count as `iota`. In Python a module beside the sub-packages counts as a folder, and
`__init__.py`, which imports all others, has the package's name. Imports only for types count as well. Exit code 1 if a
graph has a cycle, direct or indirect, or an arrow of FORBIDDEN.
"""

from __future__ import annotations

import ast
import re
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
TREES = [ROOT / "src", ROOT / "web" / "src", ROOT / "python" / "iota"]
# Rules of the architecture that an acyclic graph could violate: (folder, must not use).
FORBIDDEN = [
    *[("solver", "model"), ("net", "model"), ("net", "solver"), ("net", "edit"), ("net", "system")],
    *[("held", "read"), ("read", "edit"), ("island", "edit"), ("edit", "step"), ("edit", "system"), ("step", "system")],
    *[("contact", "ingredient"), ("contact", "solver")],
]

INCLUDE = re.compile(r'^\s*#\s*include\s*[<"]([^>"]+)[>"]', re.MULTILINE)
TS_IMPORT = re.compile(r'(?:\bfrom|\bimport)\s*\(?\s*"(\.[^"]+)"')

Graph = dict[str, dict[str, list[str]]]


def includes_of(path: Path, tree: Path) -> Iterator[str]:
    for name in INCLUDE.findall(path.read_text(errors="replace")):
        beside, below = path.parent / name, tree / name
        if name.startswith("iota/"):
            yield "iota"
        elif below.is_file():
            yield folder_of(below, tree)
        elif beside.is_file():
            yield folder_of(beside, tree)
        # else: the standard library, Boost, generated files


def ts_imports_of(path: Path, tree: Path) -> Iterator[str]:
    for name in TS_IMPORT.findall(path.read_text()):
        # Its existence is not checked: generated files count too.
        yield folder_of(path.parent / name, tree)


def python_imports_of(path: Path, tree: Path) -> Iterator[str]:
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Import):
            names = [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom) and node.level == 0 and node.module is not None:
            names = [f"{node.module}.{alias.name}" for alias in node.names]
        else:
            continue
        for name in names:
            package, *rest = name.split(".")
            if package == tree.name and not (rest and rest[0].startswith("_")):
                yield module_folder(tree, rest)


def module_folder(tree: Path, parts: list[str]) -> str:
    """The folder of the longest prefix of a dotted name that is a module; the rest are names in it."""
    for count in range(len(parts), 0, -1):
        module = tree.joinpath(*parts[:count])
        for file in (module.with_suffix(".py"), module / "__init__.py"):
            if file.is_file():
                return folder_of(file, tree)
    return folder_of(tree / "__init__.py", tree)


def folder_of(file: Path, tree: Path) -> str:
    if file.parent == tree and file.suffix == ".py":
        return tree.name if file.name == "__init__.py" else file.stem
    return file.resolve().parent.relative_to(tree.resolve()).as_posix()


IMPORTS_OF: dict[str, Callable[[Path, Path], Iterator[str]]] = {
    **dict.fromkeys((".h", ".hpp", ".cpp"), includes_of),
    ".ts": ts_imports_of,
    ".py": python_imports_of,
}


def read_graph(tree: Path) -> Graph:
    """folder -> folder it uses -> the files that use it."""
    graph: Graph = {}
    for path in sorted(p for p in tree.rglob("*") if p.suffix in IMPORTS_OF):
        here = folder_of(path, tree)
        edges = graph.setdefault(here, {})
        for target in IMPORTS_OF[path.suffix](path, tree):
            if target != here and path.name not in edges.setdefault(target, []):
                edges[target].append(path.name)
    return graph


def find_cycles(graph: Graph) -> list[list[str]]:
    """One cycle for each first folder in order of names."""
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


def find_wrongs(graph: Graph) -> list[str]:
    wrong = [" -> ".join(cycle) for cycle in find_cycles(graph)]
    for folder, edges in graph.items():
        for who, what in FORBIDDEN:
            for target, files in edges.items():
                if is_within(folder, who) and is_within(target, what):
                    wrong.append(f"{who} must not see {what}: {folder}/{{{', '.join(files)}}} -> {target}")
    return wrong


def main(arguments: list[str]) -> int:
    failed = False
    for tree in [Path(argument) for argument in arguments] or TREES:
        graph = read_graph(tree)
        if not graph:
            print(f"{tree} holds no sources", file=sys.stderr)
            return 1
        print(f"{tree}:")
        for folder, edges in sorted(graph.items()):
            print(f"  {folder:24} -> {', '.join(sorted(edges)) or '-'}")
        for line in find_wrongs(graph):
            print(f"wrong: {line}", file=sys.stderr)
            failed = True
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
