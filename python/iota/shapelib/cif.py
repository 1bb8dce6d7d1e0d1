# SPDX-License-Identifier: Apache-2.0
"""Crystallographic Information Files (Hall, Allen and Brown 1991) as tables, with the line of each row: mmCIF and CIF 1.1."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field

from iota.shapelib.files import FileError, PathLike, with_progress

# A quoted text ends at a quote that a space follows: 'O5'' is O5'.
TOKEN = re.compile(r"""\s+|\#.*|'(.*?)'(?=\s|$)|"(.*?)"(?=\s|$)|([^\s'"\#]\S*)""")

MOST_ROWS = 500_000  # of a loop

Token = tuple[str, bool, int]  # text, whether it was quoted, line


@dataclass
class Table:
    """A loop, or the single items of a category: names in small letters, rows of texts and the line that each begins in."""

    names: list[str] = field(default_factory=list)
    rows: list[list[str]] = field(default_factory=list)
    lines: list[int] = field(default_factory=list)

    def column(self, name: str) -> list[str] | None:
        """The texts of that column, None without one."""
        if name not in self.names:
            return None
        at = self.names.index(name)
        return [row[at] for row in self.rows]


def read_first_block(text: str, path: PathLike) -> dict[str, Table]:
    """The tables of the first data block by their categories, the part of a name before its dot; old names without a
    dot are sorted by their prefix: `_atom_site_fract_x` is in `_atom_site`. Raises FileError."""
    tables: dict[str, Table] = {}
    _check_rows(text, path)
    tokens = _tokens(text, path)
    token = next(tokens, None)
    if token is None or not token[0].lower().startswith("data_"):
        raise FileError(path, "a CIF file begins with data_, this one does not", token[2] if token else None)
    token = next(tokens, None)
    while token is not None:
        word, quoted, line = token
        lower = word.lower()
        if not quoted and lower.startswith("data_"):
            break
        if not quoted and lower == "loop_":
            token = _read_loop(tokens, tables, path, line)
        elif not quoted and word.startswith("_"):
            value = next(tokens, None)
            if value is None or (not value[1] and value[0].startswith("_")):
                raise FileError(path, f"{word} has no value", line)
            category, name = _split(lower)
            table = tables.setdefault(category, Table())
            if not table.rows:
                table.rows.append([])
                table.lines.append(line)
            table.names.append(name)
            table.rows[0].append(value[0])
            token = next(tokens, None)
        else:
            raise FileError(path, f"a name or loop_ must stand here, not {word[:40]!r}", line)
    return tables


def _check_rows(text: str, path: PathLike) -> None:
    """Raises FileError for more atoms in the first block than a loop may have, before they are read, which takes much longer."""
    rows = blocks = 0
    for at, line in enumerate(text.splitlines(), 1):
        rows += line.startswith(("ATOM ", "HETATM "))
        blocks += line.startswith("data_")
        if blocks > 1:
            return
        if rows > MOST_ROWS:
            raise too_long(path, at)


def too_long(path: PathLike, line: int) -> FileError:
    return FileError(path, f"a loop has more than {MOST_ROWS} rows; cut out what you need", line)


def _read_loop(tokens: Iterator[Token], tables: dict[str, Table], path: PathLike, line: int) -> Token | None:
    """Reads a loop; returns the token after it."""
    names: list[str] = []
    token = next(tokens, None)
    while token is not None and not token[1] and token[0].startswith("_"):
        names.append(token[0].lower())
        token = next(tokens, None)
    if not names:
        raise FileError(path, "loop_ is followed by no names", line)
    split = [_split(name) for name in names]
    category = split[0][0]
    if category == "_atom_site" and category in tables:
        raise FileError(path, "a block has one loop of atoms, this is the second", line)
    table = tables[category] = Table([name for _, name in split])
    row: list[str] = []
    while token is not None and (token[1] or not _is_keyword(token[0])):
        if not row:
            table.lines.append(token[2])
        row.append(token[0])
        if len(row) == len(names):
            table.rows.append(row)
            row = []
            if len(table.rows) > MOST_ROWS:
                raise too_long(path, token[2])
        token = next(tokens, None)
    if row:
        raise FileError(path, f"the last row of a loop has {len(row)} values for {len(names)} names", table.lines[-1])
    return token


def _is_keyword(word: str) -> bool:
    lower = word.lower()
    return word.startswith("_") or lower == "loop_" or lower.startswith(("data_", "save_"))


OLD_CATEGORIES = ("_atom_site_aniso", "_atom_site", "_cell", "_symmetry_equiv", "_space_group_symop", "_geom_bond")


def _split(name: str) -> tuple[str, str]:
    if "." in name:
        category, _, rest = name.partition(".")
        return category, rest
    for category in OLD_CATEGORIES:
        if name.startswith(category + "_"):
            return category, name[len(category) + 1 :]
    return name, ""


def _tokens(text: str, path: PathLike) -> Iterator[Token]:
    lines = enumerate(with_progress(text.splitlines(), "reading"), 1)
    for at, line in lines:
        if line.startswith(";"):  # a text field, up to the next line that begins with ;
            parts, last = [line[1:]], ""
            for _, last in lines:
                if last.startswith(";"):
                    break
                parts.append(last)
            else:
                raise FileError(path, "the text that begins here has no end", at)
            yield "\n".join(parts), True, at
            at, line = at + len(parts), last[1:]
        if not any(mark in line for mark in "'\"#"):
            for word in line.split():
                yield word, False, at
            continue
        place = 0
        while place < len(line):
            found = TOKEN.match(line, place)
            if found is None:
                raise FileError(path, f"a quote without an end: {line[place : place + 40]!r}", at)
            place = found.end()
            if found.group(3) is not None:
                yield found.group(3), False, at
            elif found.group(1) is not None or found.group(2) is not None:
                yield found.group(1) if found.group(1) is not None else found.group(2), True, at
