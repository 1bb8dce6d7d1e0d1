# SPDX-License-Identifier: Apache-2.0
"""Words of the engine that mean one thing each, as docs/architecture.md lists them: names in its sources that have them."""

import re
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
NOT_CODE = re.compile(r"//[^\n]*|/\*.*?\*/|\"(?:\\.|[^\"\\\n])*\"", re.DOTALL)
NAME = re.compile(r"[A-Za-z_]\w*")

# Names with the word, and the files in which they have its meaning.
RULES = {
    "touch": (
        r"(?i)(^|_)touch_|_touch(ed)?_?$|^touched?_?$",
        r"src/contact/|src/step/contact|src/ingredient/contact|include/iota/contacts",
    ),
    "hold": (r"^[Hh]olding_?[Ee]rror|^hold_offsets|^holds_offsets|^hold_row|^held_(?!force|energy)", r"never"),
    "tie": (r"^(add|make|update)_ties?$|^Ties_?$", r"src/ingredient/model|src/edit/|src/island/"),
    "follow": (
        r"^([a-z]+_)?follow(s|ed)?(_[a-z]+)?$|^Follow",
        r"src/(island|solver|held)/|src/model/(basis|split|structure)|src/edit/(nails|separate)|src/step/contact_watches",
    ),
    "settle": (r"^settle(_[a-z]+)*$", r"src/edit/|src/island/island\."),
    # In lists and tables there are indices, in matrices slots. Nodes have places, by which a dissection divides them.
    "place": (
        r"^places?_?$|^place_|_place_?$|_place_|^Places?$",
        r"(?!src/(base|held|island|neighbors|edit/command|solver/assembly|solver/sparse)"
        r"(?!_structure|/block_pattern|/ordering|/coupling_graph|/pattern_builder))",
    ),
}


def names() -> Iterator[tuple[str, str]]:
    """(file, name) of all names in the engine's code, without comments and texts."""
    for folder in ("src", "include"):
        for path in sorted((ROOT / folder).rglob("*")):
            if path.suffix in (".h", ".cpp"):
                code = NOT_CODE.sub(" ", path.read_text(encoding="utf-8"))
                for name in set(NAME.findall(code)):
                    yield path.relative_to(ROOT).as_posix(), name


@pytest.fixture(scope="module")
def all_names() -> list[tuple[str, str]]:
    return list(names())


@pytest.mark.parametrize("word", RULES)
def test_a_word_of_the_engine_means_one_thing(word: str, all_names: list[tuple[str, str]]) -> None:
    pattern, places = RULES[word]
    found = [f"{file}: {name}" for file, name in all_names if re.search(pattern, name) and not re.match(places, file)]
    assert not found, "\n".join(found)


def test_the_table_of_words_names_each(all_names: list[tuple[str, str]]) -> None:
    table = (ROOT / "docs" / "architecture.md").read_text(encoding="utf-8").partition("### Words")[2]
    listed = re.findall(r"^\| (\w+) \|", table.partition("\n## ")[0], re.MULTILINE)
    assert [word for word in listed if word != "word"] == [*RULES]
