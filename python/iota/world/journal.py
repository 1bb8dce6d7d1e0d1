# SPDX-License-Identifier: Apache-2.0
"""Keeps a world in a journal while it runs, and brings it back when it starts again: `World.keep`."""

from __future__ import annotations

import atexit
import gc
import hashlib
import json
import math
import struct
import time
from collections.abc import Callable, Iterable
from contextlib import suppress
from pathlib import Path
from types import FunctionType
from typing import Any

from iota._core import Log, System, version
from iota.arguments import SHORT
from iota.errors import WrongThreadError
from iota.journal.folder import Folder
from iota.journal.reader import Found, JournalError, find, recover
from iota.journal.records import FORMAT, Commands, schema_of, without_schema
from iota.journal.writer import HAND_OVER, Content, Writer
from iota.world.callbacks import one_line, print_on_terminal
from iota.world.going_on import ask_to_go_on, people_in
from iota.world.pictures import Portrait
from iota.world.state import State
from iota.world.widgets import Button, Choice, Widget

FIRST = 0.15  # s, at most, that a world, and who joins it, waits for its first state to be on the disk
CHECKPOINT = 1.0  # s of steps, after which a new snapshot is cheaper than to repeat them
GENERATION = (10.0, 60.0)  # s, between two files, at least and at most
MOST_LOG = 64 << 20  # bytes of a file
EARLIER_EVERY, MOST_EARLIER = 1.0, 11  # s of the world, states before the end of the last run
MOST_HISTORY = 16 << 20  # bytes of states of undo in a journal
SHARE = 0.01  # of the time, that quick snapshots take
QUICK_RATE = 0.5e6  # bytes/s of quick snapshots
CUT = 0.9  # of HAND_OVER: when the log is cut by itself
LATEST = 2.0  # of HAND_OVER: when the world hands over if the writer is busy

Call = Callable[[Callable[[], None]], None]  # calls a function on the thread that runs the world


class Journal:
    """The journal of one world. fresh: an older one is put aside, not read. asks: a user at the terminal says whether it goes on. Raises
    BusyError, OSError."""

    def __init__(self, directory: Path, state: State, call: Call, fresh: bool = False, asks: bool = True) -> None:
        if not isinstance(state.system, System):
            raise TypeError(f"a journal keeps a System, not {SHORT.repr(state.system)}")
        self._state, self._call, self._is_fresh, self._asks = state, call, fresh, asks
        self._log = Log(state.system)
        self._folder = Folder(directory)
        self._folder.lock()
        self._found: Found | None = None
        self._why_anew = ""  # told when the world begins
        self.goes_on = False
        """The world is where it was in the run before."""
        self.kept_picture = b""
        """A PNG file with the world that goes on; empty without one."""
        self.portrait = Portrait(self._folder.picture, state.pictures, state.clients)
        self._values: dict[str, Any] = {}  # of the script
        self._writer: Writer | None = None
        self._version: tuple[Any, ...] = ()  # of what `_world_now` tells
        self._values_version = self._functions_version = 0
        self._start: dict[str, str] = {}
        self._names: dict[int, str] = {}  # of functions of the run before
        self._functions: list[tuple[str, int, str, bool]] = []
        self._structure: int | None = None  # of which the functions are known
        self._marks: set[int] = set()  # of the states of undo in the present file
        self._marks_told: tuple[list[int], list[int]] = ([], [])
        self._schema = ""  # of the snapshots of this file
        self.next = 0.0
        """When to hand over, by `perf_counter`: the thread that writes puts it off."""
        self._snapshot_time = 0.0  # of the world, s
        self._is_exact = True  # what came after that snapshot can be repeated
        self._handed_over_at = self._began_at = self._quick_at = 0.0
        self._is_broken = False  # what was taken from the log
        self._is_quick_behind = False  # the last quick snapshot: there were commands since
        self._read()

    # --- what the script keeps ----------------------------------------------------------------------------------------

    def set(self, key: str, value: Any) -> None:
        """Raises TypeError for what cannot be kept."""
        self._values[key] = self._packed(key, value)
        self._values_version += 1

    def get(self, key: str, default: Any) -> Any:
        return self._unpacked(self._values[key]) if key in self._values else default

    def _packed(self, key: str, value: Any) -> Any:
        if value is None or isinstance(value, bool | int | float | str):
            return value
        if isinstance(value, list | tuple):
            return [self._packed(key, each) for each in value]
        if isinstance(value, dict) and all(isinstance(name, str) for name in value):
            return {"of": {name: self._packed(key, each) for name, each in value.items()}}
        if (id := self._log.id_of(value)) is not None:
            return {"id": list(id)}
        raise TypeError(
            f"the state {key!r} must be of numbers, texts, lists, dicts by text, bodies, particles, bonds and constraints, "
            f"not {SHORT.repr(value)}"
        )

    def _unpacked(self, value: Any) -> Any:
        if isinstance(value, list):
            return [self._unpacked(each) for each in value]
        if isinstance(value, dict):
            if "id" in value:
                return self._log.handle_of(*value["id"])
            return {name: self._unpacked(each) for name, each in value["of"].items()}
        return value

    # --- the run before -----------------------------------------------------------------------------------------------

    def _read(self) -> None:
        """Looks for a state to go on from, before the script asks for what it has kept. A journal that cannot be read is put aside later,
        not overwritten."""
        try:
            found = None if self._is_fresh else find(self._folder)
            if self._is_fresh or (found is not None and self._asks and not ask_to_go_on(found)):
                aside = self._folder.put_aside(self._folder.files())
                self._why_anew = f"begins anew; the world before is in {aside}" if aside is not None else ""
                self._is_fresh = True
                return
            self._found = found
        except JournalError as error:
            self._why_anew = f"begins anew: {error}. It is put aside"
            return
        if self._found is not None:
            values = self._found.world.get("state")
            self._values = values if isinstance(values, dict) else {}

    def begin(self, start: bytes, recovers: bool = True) -> str:
        """Brings the world back if its script starts it in the same way, and begins to write. Returns a sentence for users,
        empty for a first run. start: a snapshot. recovers: False if the present state is another one that goes on."""
        system = self._state.system
        self._start = {"structure": structure_of(system, self._log), "state": hashlib.sha256(start).hexdigest()[:32]}
        if not recovers:
            self._found, self._why_anew = None, ""
        told, aside = self._take_back()
        self._log.start(CUT * HAND_OVER)
        files = self._folder.files() if aside else []
        self._writer = Writer(self._folder, self._tell, files, self._cut)
        atexit.register(self._end)  # for loops of a script's own
        self._hand_over()
        # A process that is killed before its first state is written would lose all that it has stepped, however slow its disk is.
        self._writer.flush(FIRST)
        return told

    def _take_back(self) -> tuple[str, bool]:
        """A sentence for users; whether the files of the run before are to be put aside."""
        found, self._found = self._found, None
        if found is None:
            return self._why_anew, bool(self._why_anew) and not self._is_fresh
        start = found.header.get("start")
        start = start if isinstance(start, dict) else {}
        if start.get("structure") != self._start["structure"]:
            self._values = {}
            why = "begins anew: its script starts other bodies, joints or functions than before"
            return f"{why}. The world before is put aside in {self._folder.path}", True
        self._give_functions(found.functions)
        try:
            recovered = recover(self._state.system, found, self._note_earlier)
        except (ValueError, RuntimeError) as error:  # of another version; a recording of the script runs already
            self._values = {}
            return f"begins anew: {error}. The world before is put aside in {self._folder.path}", True
        lost = f"lost at most {math.ceil(recovered.lost * 10) / 10:g} s" if recovered.lost > 0 else "nothing was lost"
        self.goes_on = True
        with suppress(OSError):
            self.kept_picture = self._folder.picture.read_bytes()
        self._set_world(found.world)
        self._state.schedule.skip(recovered.time)
        told = f"goes on where it was: t = {recovered.time:.2f} s, {people_in(found)}, {lost} (r on the page resets it)"
        if start.get("state") != self._start["state"]:
            told += "; its script starts in another way now, which a reset shows"
        if not recovered.is_equal:
            told += "; what came after it could not be repeated to the same state"
        if found.damage:
            told += f"; damaged: {found.damage[0]}" + (f" and {len(found.damage) - 1} more" if found.damage[1:] else "")
            told += ", and a later run is lost" if found.is_older else ""
        if missing := self._missing_functions():
            told += f"; the script has no function {', '.join(missing)} any more, and what used it is switched off"
        return told, bool(found.damage)

    def _note_earlier(self, log: Log) -> None:
        """For those who go back to states before the end of the last run."""
        earlier, now = self._state.history.earlier, self._state.system.time
        while earlier and earlier[-1][0] > now:  # after an undo
            earlier.pop()
        if not earlier or now - earlier[-1][0] >= EARLIER_EVERY:
            earlier.append((now, log.quick_snapshot()))
            del earlier[:-MOST_EARLIER]

    def _give_functions(self, uses: dict[int, tuple[str, str]]) -> None:
        """Bonds may use functions that the script gave after its start: those are found by their names. uses: kind and name by key."""
        there = {key for _, key, _, _ in self._log.functions()}
        self._names = {key: name for key, (_, name) in uses.items()}
        missing = {key: name for key, (kind, name) in uses.items() if kind == "bond" and key not in there}
        found = {name: function_called(name) for name in set(missing.values())}
        for key, name in missing.items():
            if (function := found[name]) is not None:
                self._log.give_function(key, function, name)

    def _missing_functions(self) -> list[str]:
        names = [name or self._names.get(key, "") for _, key, name, is_there in self._log.functions() if not is_there]
        return sorted({repr(name or "of a surface") for name in names})

    def _set_world(self, world: dict[str, Any]) -> None:
        """Controls and the clock. What no longer fits stays as the script has it."""
        clock, told = self._state.clock, world.get("clock")
        if isinstance(told, dict):
            clock.paused = bool(told.get("paused", clock.paused))
            clock.speed = float(told.get("speed", clock.speed))
        values = world.get("controls")
        for name, widget in named_widgets(self._state.things):
            if not isinstance(values, dict) or name not in values:
                continue
            value = values[name]
            if isinstance(widget, Choice):
                if value in widget.options:
                    widget.value = value
            elif isinstance(value, str):
                widget._set(0.0, value)
            else:
                widget._set(float(value), "")

    # --- while it runs --------------------------------------------------------------------------------------------------

    def note_cut_step(self) -> None:
        """After a step that the clock cut short, so that it cannot be repeated."""
        self._is_exact = False
        self._log.hold_cuts()
        self.next = min(self.next, self._handed_over_at + HAND_OVER)

    def check(self) -> None:
        """Between steps, at any time: a world that is paused is edited, too."""
        now = time.perf_counter()
        if now >= self.next or (self._state.clock.paused and now >= self._handed_over_at + HAND_OVER):
            self.hand_over()

    def hand_over(self) -> None:
        """Gives what has happened since the last call to the thread that writes. The world goes on whatever happens here."""
        try:
            self._hand_over()
        except Exception as error:
            if self._writer is not None:
                self._stop(self._writer)
            self._tell(f"this world is no longer kept in {self._folder.path}: {one_line(error)}. It goes on without")

    def _cut(self) -> tuple[Commands, float] | None:
        """On the thread that writes: commands that the log has cut, and their age. While there is nothing else to write, this spares the
        thread of the world to hand over, which is most of what a journal would cost a small one."""
        writer = self._writer
        if writer is None or not writer.takes:
            return None
        cut = self._log.take_cut()
        now = time.perf_counter()
        if (
            cut is None
            or (owed := self._owed(cut[1])) >= CHECKPOINT
            or self._is_file_old(writer, now, owed)
            or self._world_version() != self._version
        ):
            self.next = 0.0
        else:
            self.next = now + LATEST * HAND_OVER
        if cut is None:
            return None
        self._is_quick_behind = True
        commands, of_world, hash, seconds, age = cut
        return Commands(of_world, hash, seconds, commands), age

    def _owed(self, of_world: float) -> float:
        """Seconds that it takes to repeat what came after the last snapshot."""
        state = self._state
        steps = abs(of_world - self._snapshot_time) / state.clock.dt
        return steps * state.step_ms * 1e-3 if self._is_exact else CHECKPOINT

    def _hand_over(self) -> None:
        writer = self._writer
        if writer is None or self._log.is_editing:
            return
        now = self._handed_over_at = time.perf_counter()
        self.next = now + LATEST * HAND_OVER
        takes = writer.takes
        owed = self._owed(self._state.system.time)
        begins = self._is_file_old(writer, now, owed) if takes else writer.wants_all
        # Before the log is taken: a snapshot is a command, too, which a way round a damaged one repeats.
        snapshot = self._log.snapshot() if begins or (takes and owed >= CHECKPOINT) else None
        taken = self._log.take()
        assert taken is not None
        commands, is_broken, of_world, hash, seconds = taken
        is_broken, self._is_broken = is_broken or self._is_broken, False
        if not (begins or takes):
            return
        if is_broken and snapshot is None:
            snapshot = self._log.snapshot()
            self._log.take()
        records: list[Content] = []
        if commands and takes and not is_broken:  # the file before leads up to the snapshot
            records.append(("C", Commands(of_world, hash, seconds, commands)))
            self._is_quick_behind = True
        if begins:
            if records:
                writer.put(records)
            self._begin_file(writer, now, snapshot or b"")
            return
        if uses_functions := self._uses_functions():  # see `_quick`
            self._log.hold_cuts()
            self.next = now + HAND_OVER
        if snapshot is not None:
            records += self._checkpoint(snapshot)
        elif uses_functions and self._is_quick_behind and now >= self._quick_at:
            records += self._quick(now)
        if (version := self._world_version()) != self._version:
            self._version = version
            records.append(("W", self._world_now()))
        if records:
            writer.put(records)

    def close(self) -> None:
        """The world has ended in an orderly way: nothing is lost."""
        writer = self._writer
        if writer is None:
            self._folder.unlock()
            return
        self._quick_at = 0.0  # functions of the script may give something else next time
        self._hand_over()
        if not writer.takes:  # its disk is behind, and will have caught up
            writer.flush()
            self._hand_over()
        taken = self._log.take()
        if writer.takes and taken is not None:
            commands, _, of_world, hash, _ = taken
            records: list[Content] = [("C", Commands(of_world, hash, 0.0, commands))] if commands else []
            writer.put([*records, ("E", b"")])
        self._log.stop()
        self._stop(writer)

    def _stop(self, writer: Writer) -> None:
        atexit.unregister(self._end)
        self._writer, self.next = None, math.inf
        writer.close()
        self._folder.unlock()

    def _end(self) -> None:
        """With the process."""
        try:
            self.close()
        except WrongThreadError:  # a thread that hangs owns the system
            if self._writer is not None:
                self._stop(self._writer)

    def _is_file_old(self, writer: Writer, now: float, owed: float) -> bool:
        age = now - self._began_at
        least, most = GENERATION
        return (
            (age > most and owed > 0) or (age > least and owed >= CHECKPOINT) or (age > 1 and writer.bytes > MOST_LOG)
        )

    def _begin_file(self, writer: Writer, now: float, snapshot: bytes) -> None:
        self._began_at = now
        self._uses_functions()
        self._marks.clear()
        self._schema = schema_of(snapshot)
        header = {
            "format": FORMAT,
            "iota": version,
            "schema": self._schema,
            "title": self._state.title,
            "start": self._start,
            "written": time.strftime("%Y-%m-%d %H:%M:%S"),
        }
        self._version = self._world_version()
        about: list[Content] = [("H", json.dumps(header).encode()), ("W", self._world_now())]
        writer.put([*about, *self._checkpoint(snapshot)], begins=True)

    def _checkpoint(self, snapshot: bytes) -> list[Content]:
        """A snapshot from which the commands after it lead to the same bits."""
        self._snapshot_time, self._is_exact = self._state.system.time, True
        return [*self._history(), ("S", without_schema(snapshot, self._schema))]

    def _quick(self, now: float) -> list[Content]:
        """For worlds with functions of the script, whose results may depend on what the script alone knows."""
        began = time.perf_counter()
        records = self._history()
        self._is_quick_behind = False
        snapshot = without_schema(self._log.quick_snapshot(), self._schema)
        records.append(("Q", snapshot))
        took = time.perf_counter() - began
        self._quick_at = now + max(HAND_OVER, took / SHARE, len(snapshot) / QUICK_RATE)
        return records

    def _history(self) -> list[Content]:
        """The states of undo that the file does not have, and their order if it has changed."""
        undo, redo = self._log.history(self._marks)
        records: list[Content] = []
        marks: tuple[list[int], list[int]] = ([], [])
        room = MOST_HISTORY
        for states, list_of_marks in zip((undo, redo), marks, strict=True):
            for mark, state in reversed(states):
                if state is not None:
                    room -= len(state)
                    if room < 0:
                        break
                    records.append(("U", struct.pack("<Q", mark) + state))
                    self._marks.add(mark)
                list_of_marks.insert(0, mark)
        if records or marks != self._marks_told:
            records.append(("Y", json.dumps({"undo": marks[0], "redo": marks[1]}).encode()))
            self._marks_told = marks
        return records

    def _uses_functions(self) -> bool:
        version = self._state.system.structure_version
        if version != self._structure:
            self._structure, functions = version, self._log.functions()
            if functions != self._functions:
                self._functions = functions
                self._functions_version += 1
        return bool(self._functions)

    def _world_version(self) -> tuple[Any, ...]:
        """Another one if `_world_now` may tell something else: that takes long with many things."""
        state, clock = self._state, self._state.clock
        widgets, people = state.things.changes[Widget.kind], tuple(state.clients.by_id)
        return clock.paused, clock.speed, widgets, people, self._values_version, self._functions_version

    def _world_now(self) -> bytes:
        state = self._state
        clock = state.clock
        now = {
            "clock": {"paused": clock.paused, "speed": clock.speed},
            "controls": {name: widget.value for name, widget in named_widgets(state.things)},  # type: ignore[attr-defined]
            "people": [[client.name, client.role] for client in state.clients.by_id.values()],
            "state": self._values,
            "functions": [[kind, key, name] for kind, key, name, _ in self._functions],
        }
        return json.dumps(now).encode()

    def _tell(self, text: str) -> None:
        """On the thread that writes."""
        print_on_terminal(f"iota: {text}\n")
        self._call(lambda: self._state.notices.send("The journal", text, level="warning", keep=True))


def named_widgets(things: Iterable[Any]) -> list[tuple[str, Widget]]:
    """The controls that have a value, each with a name that it has in the next run, too."""
    counts: dict[str, int] = {}
    named = []
    for thing in things:
        if isinstance(thing, Widget) and not isinstance(thing, Button) and thing.client == 0:
            name = f"{type(thing).__name__} {thing.label}"
            counts[name] = counts.get(name, 0) + 1
            named.append((f"{name} {counts[name]}", thing))
    return named


def structure_of(system: System, log: Log) -> str:
    """A digest of what a script has handles of: which bodies, joints and bonds there are, and its functions; not of where
    they are, since a script may start at random."""
    made = hashlib.sha256()
    for body in [*system.bodies, *system.obstacles]:
        made.update(repr((log.id_of(body), body.kind, [log.id_of(p) for p in body.particles])).encode())
    for thing in (*system.bonds, *system.constraints):
        made.update(repr((log.id_of(thing), type(thing).__name__)).encode())
    made.update(repr([use[:3] for use in log.functions()]).encode())
    return made.hexdigest()[:32]


def function_called(name: str) -> FunctionType | None:
    """The function of the script with a qualified name, also within another function, as long as something refers to it. None
    if there is none, or if there are several that may do different things."""
    found = [
        each
        for each in gc.get_objects()
        if type(each) is FunctionType  # isinstance asks proxies, whose object may be gone
        and each.__qualname__ == name
        and is_of_script(each.__module__ or "")
    ]
    is_one = len(found) == 1 or (
        found and all(each.__code__ is found[0].__code__ for each in found) and not found[0].__closure__
    )
    return found[0] if is_one else None


def is_of_script(module: str) -> bool:
    """Whether the functions of a module are those of a script: the package's own may have the same names. A study is a script."""
    return not module.startswith("iota.") or module.startswith("iota.studies.")
