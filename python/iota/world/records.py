# SPDX-License-Identifier: Apache-2.0
"""Encodes the fields of a script's entities in the format of the protocol."""

from __future__ import annotations

import struct
from collections.abc import Callable, Mapping
from functools import cache
from typing import Any

import numpy as np

from iota._protocol import ENTITIES, STRUCTS

NUMBERS = {"u8": "B", "bool": "?", "u16": "H", "u32": "I", "u64": "Q", "f32": "f", "f64": "d"}
GROUPS = {"vec3": "3f", "quat": "4f", "id": "2I"}
ARRAYS = {"f32": "<f4", "u32": "<u4"}

Write = Callable[[Any], bytes]


def encode(kind: str, values: Mapping[str, Any]) -> bytes:
    """Encodes all fields of a kind except its id. Raises ValueError for text and lists above the protocol's limits."""
    return b"".join(write(values[name]) for name, write in _writers(kind))


@cache
def _writers(kind: str) -> tuple[tuple[str, Write], ...]:
    fields = (field for field in ENTITIES[kind] if field[0] != "id")
    return tuple((name, _writer(f"{kind}.{name}", word, most, most_each)) for name, word, most, most_each in fields)


def _writer(name: str, word: str, most: int, most_each: int) -> Write:
    """Encodes one field. word: its type, as in `iota._protocol`."""
    if word.startswith("array "):
        return _array_writer(name, word.removeprefix("array "), most, most_each)
    if word.startswith("struct "):
        fields = [(n, _writer(f"{name}.{n}", w, m, e)) for n, w, m, e in STRUCTS[word.removeprefix("struct ")]]
        return lambda value: b"".join(write(value[field]) for field, write in fields)
    if word == "string":
        return lambda value: _with_size(name, value.encode(), most)
    if word == "bytes":
        return lambda value: _with_size(name, value, most)
    if word in GROUPS:
        packer = struct.Struct("<" + GROUPS[word])
        return lambda value: packer.pack(*value)
    return struct.Struct("<" + NUMBERS[word]).pack


def _array_writer(name: str, word: str, most: int, most_each: int) -> Write:
    if word in ARRAYS:

        def write_numbers(value: Any) -> bytes:
            numbers = np.asarray(value, ARRAYS[word]).ravel()
            return _count(name, numbers.size, most) + numbers.tobytes()

        return write_numbers
    write = _writer(name, word, most_each, 0)
    return lambda value: _count(name, len(value), most) + b"".join(map(write, value))


def _with_size(name: str, data: bytes, most: int) -> bytes:
    return _count(name, len(data), most) + data


def _count(name: str, count: int, most: int) -> bytes:
    if count > most:
        raise ValueError(f"{name} may have {most} entries at most, not {count}")
    return struct.pack("<I", count)
