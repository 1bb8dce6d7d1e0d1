#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes docs/api, the API reference, from the docstrings of python/iota and the stub file of the engine.

    tools/make_api.py [--check]     --check: only checks whether docs/api is up to date; exit code 1 if not

Reads sources and imports nothing, so that it needs only the stub file of a build.
"""

from __future__ import annotations

import argparse
import ast
import re
import sys
import textwrap
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
SOURCES = ROOT / "python"
PAGES = ROOT / "docs" / "api"
Definition = ast.ClassDef | ast.FunctionDef
# Pages: title, and the modules with their public names.
CONTENTS = {
    "engine": ("The engine", ["iota._core", "iota.solvers"]),
    "world": ("Worlds that people enter", ["iota.world", "iota.world.widgets", "iota.world.shown", "iota.world.many"]),
    "fixtures": ("Parts of rigs, furniture", ["iota.fixtures"]),
    "looks": ("How bodies are drawn", ["iota.looks"]),
    "builder": ("Builders", ["iota.builder"]),
    "shapelib": ("From file to world", ["iota.shapelib"]),
    "effects": ("Winds, sparks, soft matter", ["iota.effects"]),
    "film": ("Films", ["iota.film"]),
    "testing": ("Tests without a headset", ["iota.testing"]),
    "sweeping": ("Sweeps", ["iota.sweeping"]),
    "types": ("What calls give back", ["iota.types"]),
    "errors": ("Errors", ["iota.errors"]),
    "simulator": ("A simulator of your own", ["iota.simulator"]),
}
# Names of the engine's module that are not for scripts.
INNER = ("ServerStatistics", "DrawnPart", "Room", "Log", "Server", "Equations")
HEADER = "<!-- Written by tools/make_api.py from the docstrings; change those. -->\n\n"
SHORTER = (  # parts of signatures that readers do not need
    (r"Annotated\[NDArray\[numpy\.(\w+)\], dict\(shape=\(([^()]*)\)[^()]*\)\]", r"array (\2)"),
    (r"Vec3 \| Sequence\[float\] \| (?:numpy\.typing\.)?NDArray\[numpy\.float64\]", "vector"),
    (r"Sequence\[float\] \| (?:numpy\.typing\.)?NDArray\[numpy\.float64\]", "numbers"),
    (r"(?:numpy|np)\.typing\.", ""),
    (r"array \(None, ?", "array (n, "),
    (r"float\('inf'\)", "inf"),
)


@dataclass
class Module:
    """A source file: its definitions, and the modules of its imported names."""

    lines: list[str]
    defined: dict[str, Definition]
    imported: dict[str, tuple[str, str]]
    public: list[str]
    docstring: str


@cache
def module(name: str) -> Module:
    base = SOURCES / name.replace(".", "/")
    files = (base.with_suffix(".pyi"), base.with_suffix(".py"), base / "__init__.py")
    path = next(path for path in files if path.is_file())
    text = path.read_text()
    tree = ast.parse(text)
    defined: dict[str, Definition] = {}
    imported: dict[str, tuple[str, str]] = {}
    listed: list[str] | None = None
    for node in tree.body:
        if isinstance(node, ast.ClassDef | ast.FunctionDef):
            defined.setdefault(node.name, node)
        elif isinstance(node, ast.ImportFrom) and node.module and node.module.split(".")[0] == "iota":
            imported |= {alias.asname or alias.name: (node.module, alias.name) for alias in node.names}
        elif isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Name) and node.targets[0].id == "__all__":
            listed = ast.literal_eval(node.value)
    own = [name for name in defined if not name.startswith("_")]
    return Module(
        text.splitlines(), defined, imported, own if listed is None else listed, ast.get_docstring(tree) or ""
    )


def find(where: str, name: str) -> tuple[str, Definition] | None:
    """The module that defines a name, and the definition; None unless it is a class or function of iota."""
    source = module(where)
    if name in source.defined:
        return where, source.defined[name]
    if name in source.imported:
        other, original = source.imported[name]
        if (SOURCES / other.replace(".", "/")).is_dir() or (SOURCES / (other.replace(".", "/") + ".py")).is_file():
            return find(other, original)
        if other == "iota._core":
            return find(other, original)
    return None


# --- text -------------------------------------------------------------------------------------------------------------


def shorter(text: str) -> str:
    for pattern, by in SHORTER:
        text = re.sub(pattern, by, text)
    return text


def signature(function: ast.FunctionDef, is_method: bool) -> str:
    """Formatted as name(arguments) -> result."""
    given = ast.unparse(function.args)
    if is_method and not any(isinstance(d, ast.Name) and d.id == "staticmethod" for d in function.decorator_list):
        given = re.sub(r"^(self|cls)(, )?(/(, )?)?", "", given)
    result = f" -> {ast.unparse(function.returns)}" if function.returns else ""
    return shorter(f"{function.name}({given}){'' if result == ' -> None' else result}")


def text_of(node: Definition) -> str:
    """Its docstring as Markdown. Examples are code there, too; the formatter takes the indentation of some away."""
    parts = (ast.get_docstring(node) or "").split("\n\n")
    return "\n\n".join(textwrap.indent(part, "    ") if is_code(part) else part for part in parts)


def is_code(text: str) -> bool:
    """Statements of Python that are not indented."""
    try:
        return any(not isinstance(item, ast.Expr) or isinstance(item.value, ast.Call) for item in ast.parse(text).body)
    except SyntaxError:
        return False


def decorators(function: ast.FunctionDef) -> set[str]:
    return {ast.unparse(decorator).split(".")[-1] for decorator in function.decorator_list}


# --- members ----------------------------------------------------------------------------------------------------------


def members(where: str, node: ast.ClassDef) -> Iterator[tuple[str, ast.stmt, str]]:
    """Name, definition and module of the members of a class and its bases in iota; a base's only if the class does not
    override it."""
    seen: set[str] = set()
    queue = [(where, node)]
    while queue:
        here, each = queue.pop(0)
        found: list[tuple[str, ast.stmt]] = []
        for item in each.body:
            if isinstance(item, ast.FunctionDef):
                found.append((item.name, item))
            elif isinstance(item, ast.AnnAssign) and isinstance(item.target, ast.Name):
                found.append((item.target.id, item))
            elif isinstance(item, ast.Assign) and isinstance(item.targets[0], ast.Name) and forwarded(item):
                found.append((item.targets[0].id, item))
        for name, item in found:
            if name not in seen and not name.startswith("_"):
                yield name, item, here
        seen |= {name for name, _ in found}
        for base in each.bases:
            if isinstance(base, ast.Name) and (what := find(here, base.id)) and isinstance(what[1], ast.ClassDef):
                queue.append((what[0], what[1]))


def forwarded(node: ast.Assign) -> str:
    """'scene.draw' of 'draw = forward(Scene.draw)'; empty for other assignments."""
    call = node.value
    is_forward = isinstance(call, ast.Call) and isinstance(call.func, ast.Name) and call.func.id == "forward"
    if not (is_forward and isinstance(call, ast.Call)):
        return ""
    part, _, name = ast.unparse(call.args[0]).partition(".")
    return f"{part.lower()}.{name}"


def comment(where: str, node: ast.stmt) -> str:
    """The text of a field's `#:` comment."""
    _, mark, text = module(where).lines[node.lineno - 1].partition("#:")
    return text.strip() if mark else ""


def class_text(where: str, node: ast.ClassDef) -> str:
    """Its docstring, constructor, attributes and methods."""
    out = [text_of(node)]
    properties: dict[str, str] = {}
    forwards: list[str] = []
    methods: list[str] = []
    made = [item for item in node.body if isinstance(item, ast.FunctionDef) and item.name == "__init__"]
    for init in made:
        text = text_of(init)
        if text or len(init.args.args) + len(init.args.kwonlyargs) > 1:
            call = signature(init, True).replace("__init__", node.name)
            out.append(f"### `{call}`" + (f"\n\n{text}" if text else ""))
    assignable = {
        item.name
        for item in node.body
        if isinstance(item, ast.FunctionDef) and any(d.endswith("setter") for d in decorators(item))
    }
    for name, item, here in members(where, node):
        if isinstance(item, ast.AnnAssign):
            properties[name] = (
                f"| `{name}` | `{cell(shorter(ast.unparse(item.annotation)))}` | {cell(comment(here, item))} |"
            )
        elif isinstance(item, ast.Assign):
            forwards.append(f"| `{name}` | `{node.name.lower()}.{forwarded(item)}` |")
        elif isinstance(item, ast.FunctionDef):
            text = text_of(item)
            marks = decorators(item)
            if "property" in marks:
                kind = shorter(ast.unparse(item.returns)) if item.returns else ""
                note = " Can be assigned." if name in assignable else ""
                properties.setdefault(name, f"| `{name}` | `{cell(kind)}` | {cell(text)}{note} |")
            elif not marks & {"setter", "deleter"}:
                methods.append(f"### `{signature(item, True)}`\n\n{text}".rstrip())
    if properties:
        out.append("\n".join(["| has | type | |", "|---|---|---|", *properties.values()]))
    if forwards:
        out.append("\n".join(["| calls | that of a part |", "|---|---|", *forwards]))
    return "\n\n".join(part for part in [*out, *methods] if part)


def cell(text: str) -> str:
    return re.sub(r"\s*\n\s*", " ", text).replace("|", "\\|")


# --- pages ------------------------------------------------------------------------------------------------------------


def names_of(modules: list[str]) -> Iterator[tuple[str, str, Definition]]:
    """Each public name once, on one page: with its module and definition."""
    seen = set() if modules == CONTENTS["types"][1] else set(module("iota.types").public)
    for where in modules:
        for name in module(where).public:
            what = find(where, name)
            if what is None or name in seen or (where == "iota._core" and is_inner(name, what[1])):
                continue
            seen.add(name)
            yield name, *what


def is_inner(name: str, node: Definition) -> bool:
    """From the engine's own module, only classes are for scripts; `iota` has the other public names."""
    return isinstance(node, ast.FunctionDef) or name in INNER


def page(title: str, modules: list[str]) -> str:
    listed = list(names_of(modules))
    about = "" if modules[0] == "iota._core" else module(modules[0]).docstring
    out = [f"{HEADER}# {title}", about]
    out.append(" · ".join(f"[{name}](#{name.lower()})" for name, _, _ in listed))
    for name, where, node in listed:
        if isinstance(node, ast.ClassDef):
            out.append(f"## {name}\n\n{class_text(where, node)}")
        else:
            out.append(f"## {name}\n\n`{signature(node, False)}`\n\n{text_of(node)}".rstrip())
    return "\n\n".join(part for part in out if part) + "\n"


def pages() -> dict[Path, str]:
    made = {PAGES / f"{name}.md": page(*content) for name, content in CONTENTS.items()}
    rows = [
        f"| [{title}]({name}.md) | {', '.join(f'`{each}`' for each, _, _ in names_of(modules))} |"
        for name, (title, modules) in CONTENTS.items()
    ]
    index = [
        f"{HEADER}# API reference",
        "Vectors are given as any 2 or 3 numbers and come back as `Vec3`; `vector` below stands for those. SI units, y up. "
        "[Conventions](../conventions.md) has the rules, [the tutorial](../tutorial.md) shows how to use it.",
        "\n".join(["| page | names |", "|---|---|", *rows]),
    ]
    return made | {PAGES / "README.md": "\n\n".join(index) + "\n"}


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("--check", action="store_true", help="writes nothing")
    check = parser.parse_args().check
    made = pages()
    there = {path: path.read_text() for path in PAGES.glob("*.md")}
    stale = sorted(path.name for path in made.keys() | there.keys() if made.get(path) != there.get(path))
    if check and stale:
        print(f"docs/api is not up to date: {', '.join(stale)}. Run tools/make_api.py", file=sys.stderr)
        return 1
    if not check:
        PAGES.mkdir(exist_ok=True)
        for path in there.keys() - made.keys():
            path.unlink()
        for path, text in made.items():
            path.write_text(text)
    return 0


if __name__ == "__main__":
    sys.exit(main())
