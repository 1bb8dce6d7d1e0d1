# SPDX-License-Identifier: Apache-2.0
"""The newest good state in the folder of a journal, and how it gets into a system."""

from __future__ import annotations

import functools
import json
import struct
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Any

from iota._core import Log, System
from iota.journal.folder import File, Folder
from iota.journal.records import ANY_MAGIC, MAGIC, Commands, Record, schema_of, unpack, with_schema

USUAL_LOSS = 0.2  # s: two hand-overs of what the world does, see iota.world.journal


class JournalError(ValueError):
    """The files are no journal, or one of another version, or no snapshot in them is whole."""


@dataclass
class Quick:
    """A snapshot in the midst of commands: the first `place` of them are before it."""

    place: int
    snapshot: bytes
    undo: list[bytes]
    redo: list[bytes]


@dataclass
class Found:
    """A state and what followed it. header: about the file. world: controls, people and so on, the latest. functions: kind and name of
    all that were used until its end, by key: the state and what followed it may use those that are gone at the end. end: the latest time
    of the world that a record names, s. is_orderly: the world ended by itself. is_older: a later process has left nothing that can be read. damage: sentences. quick: the latest of its kind."""

    files: list[File]
    header: dict[str, Any]
    snapshot: bytes
    undo: list[bytes]
    redo: list[bytes]
    pieces: list[Commands] = field(default_factory=list)
    world: dict[str, Any] = field(default_factory=dict)
    functions: dict[int, tuple[str, str]] = field(default_factory=dict)
    quick: Quick | None = None
    end: float = 0.0
    is_orderly: bool = False
    is_older: bool = False
    damage: list[str] = field(default_factory=list)

    @property
    def schema(self) -> str:
        """The schema of the snapshots and states of undo; empty if the header is damaged."""
        schema = self.header.get("schema")
        return schema if isinstance(schema, str) else ""

    @property
    def lag(self) -> float:
        """The longest time in which the latest commands were given, s: as much may have been given afterwards."""
        return max((piece.seconds for piece in self.pieces[-20:]), default=0.0)


@dataclass
class Recovered:
    """time: of the world, s. lost: at most, s. is_equal: it is the last state that was logged."""

    time: float
    lost: float
    is_equal: bool


def find(folder: Folder) -> Found | None:
    """None for a folder without a journal. Raises JournalError if there is one that cannot be used, OSError."""
    all_found = find_all(folder)
    return all_found[-1] if all_found else None


def find_all(folder: Folder) -> list[Found]:
    """As `find`, with the snapshots before, each with the commands up to the next one, oldest first."""
    files = folder.files()
    damage: list[str] = []
    for epoch in sorted({file.epoch for file in files}, reverse=True):
        all_found = find_in([file for file in files if file.epoch == epoch], damage)
        if all_found:
            all_found[-1].files, all_found[-1].is_older = files, epoch < files[-1].epoch
            return all_found
    if files:
        raise JournalError(f"no state in {folder.path} can be read: {'; '.join(damage) or 'its files are empty'}")
    return []


@functools.cache
def own_schema() -> str:
    return schema_of(System().snapshot())


@dataclass
class _Cursor:
    """The latest content of each kind on the way: states of undo, the world. functions: of all worlds until then."""

    header: dict[str, Any] = field(default_factory=dict)
    world: dict[str, Any] = field(default_factory=dict)
    functions: dict[int, tuple[str, str]] = field(default_factory=dict)
    states: dict[int, bytes] = field(default_factory=dict)
    undo: list[int] = field(default_factory=list)
    redo: list[int] = field(default_factory=list)

    def take(self, kind: str, content: bytes) -> None:
        if kind == "H":
            self.header = dict(json.loads(content))
        elif kind == "W":
            self.world = dict(json.loads(content))
            self.functions |= {key: (use, name) for use, key, name in self.world.get("functions", ())}
        elif kind == "U":
            self.states[struct.unpack_from("<Q", content)[0]] = content[8:]
        elif kind == "Y":
            marks = json.loads(content)
            self.undo, self.redo = list(marks["undo"]), list(marks["redo"])

    def whole(self, snapshot: bytes) -> bytes:
        """A snapshot with the schema of its file; with that of this program if the header is damaged."""
        schema = self.header.get("schema")
        return with_schema(snapshot, schema if isinstance(schema, str) else own_schema())

    def history(self) -> tuple[list[bytes], list[bytes]]:
        """The newest states of each; none that is older than one that is damaged."""
        return self._newest(self.undo), self._newest(self.redo)

    def _newest(self, marks: list[int]) -> list[bytes]:
        kept: list[bytes] = []
        for mark in reversed(marks):
            if mark not in self.states:
                break
            kept.append(self.states[mark])
        return kept[::-1]


def find_in(files: list[File], damage: list[str]) -> list[Found]:
    """The states of the files of one process. damage: sentences are added."""
    all_found: list[Found] = []
    found: Found | None = None
    cursor = _Cursor()
    number, is_whole, end, is_orderly = 0, False, 0.0, False
    for record in records_of(files, damage):
        kind, content = record.kind, record.content
        follows = record.number == number + 1
        number = record.number
        is_orderly = kind == "E"
        is_whole = is_whole and follows and not (kind == "C" and content is None)
        if content is None:
            continue
        try:
            cursor.take(kind, content)
            if kind == "S":
                found, is_whole, end = Found([], cursor.header, cursor.whole(content), *cursor.history()), True, 0.0
                all_found.append(found)
            elif kind == "C":
                piece = Commands.from_bytes(content)
                end = piece.time
                if found is not None and is_whole:
                    found.pieces.append(piece)
            elif kind == "Q" and found is not None and is_whole:
                found.quick = Quick(len(found.pieces), cursor.whole(content), *cursor.history())
        except (ValueError, KeyError, TypeError, struct.error) as error:  # a correct checksum over what nobody writes
            damage.append(f"record {record.number}: {error}")
            is_whole = False
        if found is not None and is_whole:
            found.world, found.functions = cursor.world, cursor.functions
    if found is not None:
        found.end, found.is_orderly, found.damage = end, is_orderly and is_whole, damage
    return all_found


def records_of(files: list[File], damage: list[str]) -> Iterator[Record]:
    for file in files:
        data = file.path.read_bytes()
        if not data.startswith(MAGIC):
            kind = "of another version of Iota" if data.startswith(ANY_MAGIC) else "not a journal, or damaged"
            damage.append(f"{file.path.name} is {kind}")
            continue
        for record in unpack(data):
            if record.content is None:
                what = "bytes that are no record" if record.kind == "?" else f"record {record.number} ({record.kind})"
                damage.append(f"{file.path.name}: {what}")
            yield record


def recover(system: System, found: Found, passed: Callable[[Log], object] = lambda log: None) -> Recovered:
    """Brings the state into a system that has the functions of the script: the snapshot, then the commands up to the last
    state whose hash is the logged one. passed: called at each state on the way, which it must not change. Raises ValueError
    for a snapshot of another version; the system is then unchanged."""
    log = Log(system)
    done, is_equal = repeat(system, log, found, len(found.pieces), passed)
    if not is_equal:
        quick = found.quick
        if quick is not None and quick.place > done:
            system.restore(quick.snapshot)
            set_history(log, quick.undo, quick.redo, found.schema)
            is_equal = quick.place == len(found.pieces)
        else:
            repeat(system, log, found, done, lambda log: None)
    log.let_go()
    lost = 0.0 if found.is_orderly else max(USUAL_LOSS, found.lag)
    return Recovered(system.time, lost + max(0.0, found.end - system.time), is_equal)


def repeat(system: System, log: Log, found: Found, count: int, passed: Callable[[Log], object]) -> tuple[int, bool]:
    """Restores the snapshot and repeats so many pieces. Returns how many led to a state with the logged hash, and whether all
    did."""
    system.restore(found.snapshot)
    set_history(log, found.undo, found.redo, found.schema)
    good = 0
    for place, piece in enumerate(found.pieces[:count], 1):
        try:
            log.repeat(piece.commands)
        except ValueError:
            return good, False
        if not piece.leads_to(system):
            return good, False
        good = place
        passed(log)
    return good, True


def set_history(log: Log, undo: list[bytes], redo: list[bytes], schema: str) -> None:
    try:
        log.set_history(undo, redo, schema)
    except ValueError:  # a damaged state: there is no undo, but the world
        log.set_history([], [])
