# SPDX-License-Identifier: Apache-2.0
"""Random and extreme messages of a page, by a seed: of every type, with values that no page sends."""

from __future__ import annotations

from collections.abc import Callable
from random import Random
from typing import Any

from page_client import SCHEMA, STRUCTS, TO_SERVER, PageClient, encode

ENUMS = {entry["name"]: [value["value"] for value in entry["values"]] for entry in SCHEMA["enums"]}
F32 = [0.0, -0.0, 1.0, -1.0, 0.5, 1e-38, 1e9, -1e9, 9.9e8, 3.4e38, -3.4e38, 1e-45]
F64 = [*F32, 1e308, -1e308, 1.7976931348623157e308, 5e-324, 2.0**53, -(2.0**63)]
WHOLE = {"u8": 2**8, "u16": 2**16, "u32": 2**32, "u64": 2**64}
TEXTS = [
    "",
    "a",
    "\0",
    "é" * 16,
    "\u202ex",
    "<b>&",
    "{0}%s",
    "-" * 32,
    "1e308",
    "nan",
    "../x",
    "\x1b[31m",
    "\U0001f600" * 8,
]
# Only those that reach the script. A picture does where one was asked for.
KINDS = [name for name, message in TO_SERVER.items() if message.get("for") != "server" and name != "picture"]


class Sender:
    """Makes messages for a page from what it was told."""

    def __init__(self, page: PageClient, seed: int) -> None:
        self._page, self._dice = page, Random(seed)

    def make(self) -> tuple[str, dict[str, Any]]:
        """One message: its name and fields. Half of them name things that exist, with moderate values."""
        name = self._dice.choice([*KINDS, "change", "change", "action", "action"])
        return name, self._fields(TO_SERVER[name]["fields"])

    def send(self, count: int, tell: Callable[[str], None] = lambda text: None) -> None:
        for _ in range(count):
            name, values = self.make()
            tell(f"{name} {values}")
            data = encode(name, **values)
            if len(data) < 1 << 16:
                self._page.send_bytes(data)

    def _fields(self, described: list[dict[str, Any]]) -> dict[str, Any]:
        return {field["name"]: self._value(field) for field in described}

    def _value(self, field: dict[str, Any]) -> Any:
        kind, name, most, dice = field["type"], field["name"], field.get("max", 0), self._dice
        if "enum" in field:
            return dice.choice(ENUMS[field["enum"]])
        if isinstance(kind, dict) and "struct" in kind:
            return self._fields(STRUCTS[kind["struct"]])
        if isinstance(kind, dict):
            length = dice.choice([0, 0, 0, 1, 2, 3, 60, most])
            length = min(length, 300) if kind["array"] in ("id", "vec3") else length
            return [self._value({"type": kind["array"], "name": name}) for _ in range(min(length, most))]
        if kind == "id":
            return self._id("widget" if name == "widget" else "body")
        if kind == "string":
            return self._text(name, most)
        return self._number(kind)

    def _number(self, kind: str) -> Any:
        dice = self._dice
        near = dice.random() < 0.5
        if kind == "bool":
            return dice.random() < 0.5
        if kind in WHOLE:
            return dice.choice([0, 1, 2, 3, WHOLE[kind] - 1, dice.randrange(WHOLE[kind])])
        if kind == "vec3":
            return tuple(dice.uniform(-3, 3) if near else dice.choice(F32[:9]) for _ in range(3))
        if kind == "quat":
            return tuple(dice.uniform(-1, 1) if near else dice.choice(F32) for _ in range(4))
        if near:
            return dice.uniform(-1, 12)
        return dice.choice(F64 if kind == "f64" else F32)

    def _id(self, kind: str) -> tuple[int, int]:
        dice = self._dice
        known = [entity["id"] for entity in list(self._page.entities[kind].values())]
        if known and dice.random() < 0.9:
            return dice.choice(known)  # type: ignore[no-any-return]
        return dice.choice([(0, 0), (0, 1), (2**32 - 1, 2**32 - 1), (dice.randrange(99), dice.randrange(9))])

    def _text(self, name: str, most: int) -> str:
        dice = self._dice
        known: list[str] = []
        if name == "name":
            known = [action["name"] for action in self._page.last.get("actions", {}).get("actions", [])]
        elif name == "key":
            known = [*self._page.last.get("listens", {}).get("keys", []), "k", " "]
        if known and dice.random() < 0.9:
            return dice.choice(known)
        text = dice.choice([*TEXTS, "x" * most])
        while len(text.encode()) > most:
            text = text[:-1]
        return text
