#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Counts, for each ingredient, shape, joint, message, entity and page command, the source files that name it.

    python3 tools/count_knowers.py                  this checkout
    python3 tools/count_knowers.py --tree DIR       another checkout
    python3 tools/count_knowers.py --against DIR    both side by side, DIR first
    python3 tools/count_knowers.py --list grip      the counted files

A file knows a thing when it names it: in an identifier (also in TypeScript's camelCase), in an included path, in a quoted
name such as "revolute", or in its own name. Comments and sentences in strings do not count, and neither do tests, documents and
generated files. Each thing has several spellings, so that a renaming does not look like an improvement.

The number is an estimate of the files to edit for one more thing of its kind. Files that are named after the thing
(`grips.cpp` for a grip) are its own; a new thing would have such files, too. `strangers` counts the others, which would
have to be edited.
"""

from __future__ import annotations

import argparse
import json
import re
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
SUFFIXES = {".h", ".hpp", ".cpp", ".py", ".pyi", ".ts", ".html", ".json"}
FOLDERS = ["include", "src", "bindings", "python", "web", "protocol"]
SKIPPED = {"node_modules", "dist", "dist.new", "dist.old", "e2e", "test", "tests", "test-results", "golden",
           "__pycache__", "generated.ts", "generated", "package.json", "package-lock.json", "tsconfig.json",
           "make_golden.py"}  # fmt: skip


@dataclass(frozen=True)
class Thing:
    """`spellings`: words in a row of one identifier ("rod spin" finds RodSpin, rod_spins_ and rodSpin), "=Name" for
    exactly this identifier or quoted name, or "Kind::name" and '"name"' as they stand in the text. `folders`: where the
    words mean this thing."""

    name: str
    spellings: tuple[str, ...]
    folders: tuple[str, ...] = tuple(FOLDERS)


ENGINE = ("include", "src", "bindings")

INGREDIENTS = [
    Thing("point masses", ("virtual mass", "damped masses", "add masses", "mass couplings", "point mass", "=masses",
                           "=Masses"), ENGINE),
    Thing("rigid rows", ("rigid row", "pinned row", "rigid rows", "body row"), ENGINE),
    # The page's ties (drawn between two points), and bonds and joints that tie bodies, are other things.
    Thing("tied particles", ("=Tie", "=Ties", "=ties", "=ties_", "tied particle", "=tied_", "affine"), ENGINE),
    Thing("nails", ("nail", "nailed", "is nailed"), ENGINE),
    Thing("closings", ("closing", "closings", "close over"), ENGINE),
    Thing("joints", ("constraint rows", "joint rows", "constraint data", "joint data", "joint", "joints", "pin form",
                     "distance form", "path form", "surface form", "coupling form"), ENGINE),
    Thing("surfaces", ("surface", "surface data", "surface spec", "placed surface"), ENGINE),
    Thing("bonds in the step", ("=spring", "=springs", "spring law", "spring force", "drag", "radial", "radials", "implicit bond"), ENGINE),
    Thing("held laws", ("held force", "held forces", "held law", "held laws", "held bond"), ENGINE),
    Thing("fields", ("=Field", "=fields", "=fields_", "field law", "field id", "create field", "set field", "field data",
                     "field options"), ENGINE),
    Thing("pairs", ("=Pairs", "=pairs", "=pairs_", "pairs id", "create pairs", "set pairs", "pair set", "pair sum",
                    "pair list", "pairs data"), ENGINE),
    Thing("grips", ("grip",), ENGINE),
    # Bodies and oriented particles have a spin, too.
    Thing("rod spins", ("rod spin", "rod spins", "=spins", "spin energy", "spin momentum"), ENGINE),
    Thing("oriented particles", ("orient", "oriented", "particle sets", "turn data", "set turn", "oriented particle"),
          ENGINE),
    Thing("emitters", ("emitter",), ENGINE),
    Thing("angle springs", ("angle spring", "angle springs"), ENGINE),
]  # fmt: skip

SHAPES = [
    Thing("sphere", ("sphere", "ball shape")),
    Thing("box", ("=Box", "=box", "make box", "box shape", "box geometry", "box surface", "shape box", "box mesh")),
    Thing("cylinder", ("cylinder",)),
    Thing("capsule", ("capsule",)),
    Thing("torus", ("torus",)),
    Thing("mesh", ("=Mesh", "=mesh", "mesh shape", "shape mesh"),
          # Elsewhere on the page a mesh is a drawn object of three.js.
          ("include", "src", "bindings", "python", "protocol", "web/src/scene/shape.ts", "web/src/scene/geometry.ts",
           "web/src/scene/mesh.ts", "web/src/scene/shapes")),
    # A cone of multipliers (friction) is another thing.
    Thing("cone", ("=Cone", "cone shape", "shape cone", "cone geometry", "cone mesh", "=cone"), ("include", "src/shape", "bindings", "python", "web", "protocol")),
    Thing("ellipsoid", ("ellipsoid",)),
    Thing("half-space", ("half space", "=Plane", "=plane")),
]  # fmt: skip

# Their names are common words (inside, path, apart): a file names the kind if it has the enumerator or quotes it.
JOINTS = [Thing(name, (f"ConstraintKind::{name}", f'"{name}"'),
                ("include", "src/geometry", "src/shape", "src/model", "src/ingredient", "src/solver", "src/island",
                 "src/edit", "src/read", "src/step", "bindings", "python/iota/__init__.py"))
          for name in ("ball", "universal", "revolute", "cylindrical", "prismatic", "weld", "rod", "rope", "path",
                       "inside", "outside", "touching", "apart")]  # fmt: skip

# The messages are those of the schema. This list only keeps rows for older spellings of the schema.
MESSAGES = ["hello", "select", "grab_start", "grab_move", "grab_end", "action", "control", "welcome", "poses", "notice",
            "clients", "pong", "ping", "scene", "effect"]  # fmt: skip

VIEWERS = ("include/iota/pose_snapshot.h", "include/iota/reports.h", "src/net", "bindings/bind_server.cpp",
           "bindings/bind_world.cpp", "python/iota/world", "protocol", "web/src/app", "web/src/page", "web/src/scene",
           "web/src/world", "web/src/ui")  # fmt: skip

ENTITIES = [
    Thing("body", ("body view", "bodies", "body entity", "describe bodies"), VIEWERS),
    Thing("tie", ("tie", "ties"), VIEWERS),
    Thing("particle set", ("spark", "particle set", "sparks"), VIEWERS),
    Thing("static shape", ("statics", "static shape", "static shapes", "static entity"), VIEWERS),
    Thing("nail", ("nail", "nails", "nailed"), VIEWERS),
    Thing("joint", ("joint", "joints"), VIEWERS),
]

PAGE_COMMANDS = [
    Thing(name, spellings, ("web",))
    for name, spellings in {
        "pause, play": ("toggle pause", "=play", "play pause"),
        "one step": ("single step",),
        "reset": ("commands reset", "=reset", "reset world"),
        "speed": ("set speed", "change speed", "speed key", "faster"),
        "next look": ("next look", "set look", "refresh look"),
        "select next": ("select next",),
        "fly": ("toggle flying", "fly", "flying"),
        "grid": ("toggle grid", "=grid", "grid shown"),
        "sound": ("toggle sound", "=sound", "muted"),
        "help": ("open help", "help open"),
        "first view": ("first view", "=Home", "=home"),
    }.items()
]

# --- names in a file ------------------------------------------------------------------------------------------------

# A comment, a string, or an identifier, whichever comes first.
C_TOKEN = re.compile(
    r"""(?P<comment>//[^\n]*|/\*.*?\*/)|(?P<include>^[ \t]*\#[ \t]*include[ \t]*[<"][^>"\n]+[>"])"""
    r"""|(?P<string>"(?:\\.|[^"\\\n])*"|'(?:\\.|[^'\\\n])*'|`(?:\\.|[^`\\])*`)|(?P<name>[A-Za-z_$][\w$]*)""",
    re.DOTALL | re.MULTILINE,
)
PYTHON_TOKEN = re.compile(
    r"""(?P<comment>\#[^\n]*)|(?P<include>(?!))"""
    r"""|(?P<string>\"\"\".*?\"\"\"|'''.*?'''|"(?:\\.|[^"\\\n])*"|'(?:\\.|[^'\\\n])*')|(?P<name>[A-Za-z_]\w*)""",
    re.DOTALL,
)
HTML_TOKEN = re.compile(
    r"""(?P<comment><!--.*?-->)|(?P<include>(?!))|(?P<string>"[^"\n]*")|(?P<name>(?!))""", re.DOTALL
)
NAME_IN_QUOTES = re.compile(r"[A-Za-z_][\w./-]*")
WORD = re.compile(r"[A-Z]+(?![a-z])|[A-Z]?[a-z]+|\d+")


def token_pattern(path: Path) -> re.Pattern[str]:
    return {".py": PYTHON_TOKEN, ".pyi": PYTHON_TOKEN, ".html": HTML_TOKEN}.get(path.suffix, C_TOKEN)


def names_in(text: str, pattern: re.Pattern[str]) -> Iterator[str]:
    """Identifiers, included paths and quoted names of a source."""
    for found in pattern.finditer(text):
        if found["name"] or found["include"]:
            yield found[0]
        elif found["string"]:
            inner = found["string"].strip("\"'`")
            if NAME_IN_QUOTES.fullmatch(inner):
                yield inner


class File:
    """The names in a source: whole names, and the words of each with blanks around them."""

    def __init__(self, path: Path) -> None:
        self.stem = path.stem
        self.text = path.read_text(errors="replace")
        self.names = {path.stem, *names_in(self.text, token_pattern(path))}
        self.words = "\n".join(f" {' '.join(word.lower() for word in WORD.findall(name))} " for name in self.names)

    def is_of(self, thing: Thing) -> bool:
        """Whether the file is named after the thing."""
        words = f" {' '.join(word.lower() for word in WORD.findall(self.stem))} "
        names = [thing.name, *(spelling.removeprefix("=").lower() for spelling in thing.spellings)]
        return any(f" {name} " in words or f" {name}s " in words for name in names)

    def knows(self, spelling: str) -> bool:
        if spelling.startswith("="):
            return spelling[1:] in self.names
        if spelling.startswith(("ConstraintKind::", '"')):
            return re.search(rf"{spelling}(?!\w)", self.text) is not None
        return f" {spelling} " in self.words or f" {spelling}s " in self.words


def files_of(tree: Path) -> dict[str, File]:
    found: dict[str, File] = {}
    for folder in FOLDERS:
        for path in sorted((tree / folder).rglob("*")):
            parts = path.relative_to(tree).parts
            built = "_core" in path.name or parts[:3] == ("python", "iota", "page")
            if path.suffix in SUFFIXES and path.is_file() and not SKIPPED & set(parts) and not built:
                found["/".join(parts)] = File(path)
    return found


def messages_of(tree: Path) -> list[str]:
    try:
        schema = json.loads((tree / "protocol" / "schema.json").read_text())
        return [m["name"] for side in ("client_messages", "server_messages") for m in schema[side]]
    except (OSError, KeyError, TypeError, ValueError):
        return []


def message(name: str) -> Thing:
    words = name.split("_")
    pascal = "".join(word.title() for word in words)
    camel = pascal[0].lower() + pascal[1:]
    spellings = (f"={name}", f"={pascal}", f"={camel}", f"encode {' '.join(words)}", f"decode {' '.join(words)}")
    # A single word such as `action` has many meanings: only its type and its encoders are this message.
    here = spellings if len(words) > 1 else (f"={pascal}", *spellings[3:])
    return Thing(name, here, ("src/net", "bindings", "python/iota/world", "protocol", "web"))


def table_of(trees: list[Path]) -> dict[str, list[Thing]]:
    messages = list(dict.fromkeys([name for tree in trees for name in messages_of(tree)])) or MESSAGES
    return {
        "ingredient": INGREDIENTS,
        "shape": SHAPES,
        "joint": JOINTS,
        "message": [message(name) for name in messages],
        "entity": ENTITIES,
        "page command": PAGE_COMMANDS,
    }


def knowers(thing: Thing, files: dict[str, File]) -> list[str]:
    return [
        name
        for name, file in files.items()
        if any(name == f or name.startswith(f"{f}/") for f in thing.folders) and any(map(file.knows, thing.spellings))
    ]


# --- printing ---------------------------------------------------------------------------------------------------------


def cells(names: list[str]) -> list[int]:
    return [sum(name.startswith(f"{folder}/") for name in names) for folder in FOLDERS]


def print_one(tree: Path, table: dict[str, list[Thing]]) -> None:
    files = files_of(tree)
    print(f"{'':34}{''.join(f'{folder:>10}' for folder in FOLDERS)}{'all':>8}")
    for kind, things in table.items():
        total = [0] * len(FOLDERS)
        for thing in things:
            row = cells(knowers(thing, files))
            total = [a + b for a, b in zip(total, row, strict=True)]
            print(f"{kind:13} {thing.name:20}{''.join(f'{n or chr(45):>10}' for n in row)}{sum(row):>8}")
        print(f"{kind:13} {'TOTAL':20}{''.join(f'{n or chr(45):>10}' for n in total)}{sum(total):>8}\n")


def print_both(before: Path, after: Path, table: dict[str, list[Thing]]) -> None:
    """Numbers of files in src and in total; a new thing has no earlier number."""
    old, new = files_of(before), files_of(after)
    print(f"{'':34}{'src':>8}{'':>8}{'all':>8}{'':>8}{'strangers in src':>16}")
    print(f"{'':34}{'before':>8}{'after':>8}{'before':>8}{'after':>8}{'before':>8}{'after':>8}")
    for kind, things in table.items():
        total = [0] * 6
        for thing in things:
            a, b = knowers(thing, old), knowers(thing, new)
            src = [[name for name in names if name.startswith("src/")] for names in (a, b)]
            strangers = [
                sum(not files[name].is_of(thing) for name in names)
                for names, files in zip(src, (old, new), strict=True)
            ]
            row = [len(src[0]), len(src[1]), len(a), len(b), *strangers]
            total = [x + y for x, y in zip(total, row, strict=True)]
            print(f"{kind:13} {thing.name:20}{''.join(f'{n or chr(45):>8}' for n in row)}")
        print(f"{kind:13} {'TOTAL':20}{''.join(f'{n or chr(45):>8}' for n in total)}\n")


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(description="Counts the source files that know each thing.")
    parser.add_argument("--tree", type=Path, default=ROOT, help="the checkout to count")
    parser.add_argument("--against", type=Path, help="a checkout from before, printed beside it")
    parser.add_argument("--list", metavar="THING", help="print the files that know it")
    options = parser.parse_args(arguments)
    trees = [tree for tree in (options.against, options.tree) if tree]
    for tree in trees:
        if not (tree / "src").is_dir():
            print(f"{tree} holds no sources", file=sys.stderr)
            return 1
    table = table_of(trees)
    if options.list:
        asked = [
            thing for things in table.values() for thing in things if options.list in (thing.name, thing.name[:-1])
        ]
        if not asked:
            names = ", ".join(thing.name for things in table.values() for thing in things)
            print(f"{options.list!r} is not in the table. It has: {names}", file=sys.stderr)
            return 1
        for thing in asked:
            print(*knowers(thing, files_of(options.tree)), sep="\n")
    elif options.against:
        print_both(options.against, options.tree, table)
    else:
        print_one(options.tree, table)
    return 0


if __name__ == "__main__":
    sys.exit(main())
