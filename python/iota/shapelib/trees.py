# SPDX-License-Identifier: Apache-2.0
"""XML as a tree of elements with their lines. Documents that declare types or entities are refused before anything is
expanded; the depth of nesting is limited."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from xml.parsers import expat

from iota.shapelib.files import FileError, PathLike, number, read_bytes

MOST_ELEMENTS = 500_000
DEEPEST = 200
MOST_TEXT = 200  # characters that are kept of a text


@dataclass
class Element:
    """A tag with its attributes and children, the line where it begins, and the text in it."""

    tag: str
    attributes: dict[str, str]
    line: int
    path: PathLike
    children: list[Element] = field(default_factory=list)
    content: str = ""

    def all(self, tag: str) -> Iterator[Element]:
        """Its children of that tag."""
        return (child for child in self.children if child.tag == tag)

    def walk(self) -> Iterator[Element]:
        """It and all elements within it."""
        yield self
        for child in self.children:
            yield from child.walk()

    def first(self, tag: str) -> Element | None:
        """Its first child of that tag, None without one."""
        return next(self.all(tag), None)

    def need(self, tag: str) -> Element:
        """Its first child of that tag. Raises FileError without one."""
        found = self.first(tag)
        if found is None:
            raise self.wrong(f"<{self.tag}> needs a <{tag}>")
        return found

    def text(self, name: str, default: str | None = None) -> str:
        """An attribute. Raises FileError if it is missing and there is no default."""
        value = self.attributes.get(name, default)
        if value is None:
            raise self.wrong(f"<{self.tag}> needs the attribute {name}")
        return value

    def number(self, name: str, default: float | None = None) -> float:
        """An attribute as a finite number."""
        return number(self.text(name, None if default is None else str(default)), self.path, self.line, name)

    def numbers(self, name: str, count: int, default: str | None = None) -> list[float]:
        """An attribute as `count` numbers."""
        words = self.text(name, default).split()
        if len(words) != count:
            raise self.wrong(f"{name} must be {count} numbers, not {' '.join(words)[:60]!r}")
        return [number(word, self.path, self.line, name) for word in words]

    def wrong(self, reason: str) -> FileError:
        """The error to raise for it."""
        return FileError(self.path, reason, self.line)


def read_tree(path: PathLike) -> Element:
    """The root element of an XML file. Raises FileError."""
    data = read_bytes(path)
    parser = expat.ParserCreate()
    open_elements: list[Element] = []
    roots: list[Element] = []
    count = 0

    def begin(tag: str, attributes: dict[str, str]) -> None:
        nonlocal count
        count += 1
        element = Element(tag, attributes, parser.CurrentLineNumber, path)
        if count > MOST_ELEMENTS or len(open_elements) >= DEEPEST:
            raise element.wrong(f"has more than {MOST_ELEMENTS} elements, or nests them more than {DEEPEST} deep")
        (open_elements[-1].children if open_elements else roots).append(element)
        open_elements.append(element)

    def end(tag: str) -> None:
        open_elements.pop()

    def say(text: str) -> None:
        if open_elements and len(open_elements[-1].content) < MOST_TEXT:
            open_elements[-1].content += text

    def refuse(*_: object) -> None:
        raise FileError(path, "document types and entities (DTD) are not allowed", parser.CurrentLineNumber)

    parser.StartElementHandler, parser.EndElementHandler = begin, end
    parser.CharacterDataHandler = say
    parser.StartDoctypeDeclHandler = parser.EntityDeclHandler = refuse
    try:
        parser.Parse(data, True)
    except expat.ExpatError as error:
        raise FileError(path, f"is not XML: {expat.ErrorString(error.code)}", error.lineno) from None
    except (ValueError, LookupError) as error:
        if isinstance(error, FileError):
            raise
        raise FileError(path, f"is not XML: {error}") from None
    return roots[0]
