# SPDX-License-Identifier: Apache-2.0
"""The records of a journal's file, each with checksums of its own, so that damage stays in one record.

A file is the line "iota journal 1" and records. A record is a head of 24 bytes, little-endian, and its content:
mark "ij", kind (a letter), 0, length of the content (u32), number (u64), CRC-32 of the content, CRC-32 of the head before
it. Nothing is packed, since a snapshot is written faster than it is packed. Numbers rise by one over the files of one process; after records that were not
written a number is left out. The schema of snapshots is in the header, and left out of each of them.

    H  JSON: about the file              W  JSON: controls, people, clock, state of the script
    U  mark (u64), a state of undo       Y  JSON: the marks of the states of undo and redo
    S  the system: what follows starts there     Q  the same, but what follows may lead to other last bits
    C  time of the world after it (f64, s), hash of its state then (u64), seconds (f32) in which they were given, commands
    E  the world ended in an orderly way
"""

from __future__ import annotations

import struct
import zlib
from collections.abc import Iterator
from typing import NamedTuple

from iota._core import Log, System

FORMAT = 1
MAGIC = b"iota journal %d\n" % FORMAT
ANY_MAGIC = b"iota journal "
KINDS = b"HWUYSQCE"
MARK = b"ij"
HEAD = struct.Struct("<2sBBIQII")
COMMANDS = struct.Struct("<dQf")


SCHEMA_LENGTH = struct.Struct("<8xQ8xQ")  # of a snapshot: the length of its content, that of its schema
SCHEMA_AT = 32


def schema_of(snapshot: bytes) -> str:
    """The schema that a snapshot contains, see src/edit/editor.cpp."""
    _, length = SCHEMA_LENGTH.unpack_from(snapshot)
    return snapshot[SCHEMA_AT : SCHEMA_AT + length].decode("ascii")


def without_schema(snapshot: bytes, schema: str) -> bytes:
    """All of a snapshot but its schema, if that is this one."""
    text = schema.encode("ascii")
    has_it = bool(text) and snapshot.startswith(text, SCHEMA_AT)
    return snapshot[:SCHEMA_AT] + snapshot[SCHEMA_AT + len(text) :] if has_it else snapshot


def with_schema(stored: bytes, schema: str) -> bytes:
    """The snapshot of which `without_schema` was made; others stay as they are."""
    if len(stored) < SCHEMA_AT or not schema:
        return stored
    length, of_schema = SCHEMA_LENGTH.unpack_from(stored)
    text = schema.encode("utf-8")
    is_short = len(stored) + len(text) == length + 24 and of_schema == len(text)
    return stored[:SCHEMA_AT] + text + stored[SCHEMA_AT:] if is_short else stored


class Record(NamedTuple):
    """content: None if it is damaged. Of kind "?" are bytes that are no record."""

    kind: str
    number: int
    content: bytes | None


class Commands(NamedTuple):
    """A piece of the log. time: of the world after it, s. hash: of the state then. seconds: in which they were given."""

    time: float
    hash: int
    seconds: float
    commands: bytes

    def to_bytes(self) -> bytes:
        return COMMANDS.pack(self.time, self.hash, self.seconds) + self.commands

    def leads_to(self, system: System) -> bool:
        """Whether a system is in the state after it. Versions before December 2026 logged `System.state_hash`."""
        return self.hash == Log(system).hash or self.hash == system.state_hash()

    @classmethod
    def from_bytes(cls, content: bytes) -> Commands:
        time, hash, seconds = COMMANDS.unpack_from(content)
        return cls(time, hash, seconds, content[COMMANDS.size :])


def pack(kind: str, number: int, content: bytes) -> bytes:
    """The bytes of a record."""
    head = HEAD.pack(MARK, ord(kind), 0, len(content), number, zlib.crc32(content), 0)[:-4]
    return head + struct.pack("<I", zlib.crc32(head)) + content


def unpack(data: bytes) -> Iterator[Record]:
    """The records of a file after its first line, up to an unfinished one."""
    at, is_lost = len(MAGIC), False
    while 0 <= at <= len(data) - HEAD.size:
        mark, kind, _, length, number, checksum, of_head = HEAD.unpack_from(data, at)
        if mark != MARK or kind not in KINDS or zlib.crc32(data[at : at + HEAD.size - 4]) != of_head:
            if not is_lost:
                yield Record("?", 0, None)
            at, is_lost = data.find(MARK, at + 1), True
            continue
        is_lost = False
        at += HEAD.size
        if at + length > len(data):
            return
        content: bytes | None = data[at : at + length]
        at += length
        if zlib.crc32(content or b"") != checksum:
            content = None
        yield Record(chr(kind), number, content)
