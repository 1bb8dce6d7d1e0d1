# SPDX-License-Identifier: Apache-2.0
"""A questionnaire on the page: visitors answer if they agree, and their answers are rows of a CSV file."""

from __future__ import annotations

import csv
import io
import os
import secrets
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from datetime import datetime, timezone
from functools import partial
from pathlib import Path
from typing import Any

from iota.arguments import SHORT, is_number
from iota.world.callbacks import Guard, Hook
from iota.world.clients import Clients
from iota.world.controls import Controls
from iota.world.event import Event
from iota.world.events import Events
from iota.world.notices import Notices
from iota.world.parts import Part
from iota.world.widgets import Checkbox, Choice, Slider, TextField, Widget

NO_ANSWER = "-"
FIRST = ("time", "visit", "world")  # columns before those of the questions
LONGEST = 2000  # characters of an answer
MOST = 100_000  # answers in a run
AGREE = "I agree that my answers are kept"
KEPT = "Kept are your answers, the time and a random number; not your name. Nothing is kept before you send it."
FORMULAS = ("=", "+", "-", "@", "\t", "\r")  # with which a table program would begin to calculate

Question = str | Sequence[str] | tuple[float, float]


class Survey(Part):
    """Questions and their answers; made by `Users.ask`. file: the CSV file. answers: of this run, by question, in order. `destroy()`
    removes the questions from all pages; the file stays."""

    def __init__(
        self,
        questions: Mapping[str, Any],
        file: str | Path,
        purpose: str,
        title: str,
        controls: Controls,
        events: Events,
        clients: Clients,
        notices: Notices,
        guard: Guard,
        on_answer: Callable[..., Any] | None,
    ) -> None:
        self._questions = checked(questions)
        self._file, self._purpose, self._title = Path(file), purpose, title
        self._controls, self._events, self._clients = controls, events, clients
        self._notices, self._guard = notices, guard
        self._hook = None if on_answer is None else Hook.of(on_answer)
        self._forms: dict[int, list[Widget]] = {}
        self._moved: set[Widget] = set()
        self._answers: list[dict[str, str]] = []
        with locked(self._file) as handle:
            begin(handle, self._file, [*FIRST, *self._questions])
        events.on_join(self._join)
        events.on_leave(self._leave)
        for client in clients.by_id.values():
            self._show(client.id)

    @property
    def file(self) -> Path:
        """With a row for each visitor who has answered."""
        return self._file

    @property
    def answers(self) -> list[dict[str, str]]:
        """The answers of this run, in the order in which they came."""
        return [dict(answer) for answer in self._answers]

    def destroy(self) -> None:
        """Removes the questions from all pages; the file stays."""
        for function in (self._join, self._leave):
            self._events.forget(function)
        for client in list(self._forms):
            self._hide(client)

    def _join(self, event: Event) -> None:
        self._show(event.client)

    def _leave(self, event: Event) -> None:
        self._hide(event.client)

    def _show(self, client: int) -> None:
        told = f"{self._purpose} {KEPT}".strip()
        agrees = self._controls.checkbox(AGREE, help=told)
        agrees.on_change(lambda: self._notices.send("What is kept", told, client=client) if agrees.value else None)
        fields = [self._field(text, kind) for text, kind in self._questions.items()]
        send = self._controls.button("send my answers", help=KEPT)(self._send)
        self._forms[client] = [agrees, *fields, send]
        for widget in self._forms[client]:
            widget.client = client
            if isinstance(widget, Slider):  # one that nobody has moved is no answer
                widget.on_change(partial(self._moved.add, widget))
        self._notices.send("May we ask you something?", f"The questions are among the controls. {told}", client=client)

    def _field(self, text: str, kind: Any) -> Widget:
        if kind is str:
            return self._controls.text(text)
        if isinstance(kind, list):
            return self._controls.choice(text, [NO_ANSWER, *kind])
        low, high = kind
        return self._controls.slider(text, low, high, (low + high) / 2)

    def _answer(self, field: Widget) -> str:
        """Returns the answer of a visitor as text; empty without one."""
        if isinstance(field, Slider):
            return f"{field.value:g}" if field in self._moved else ""
        assert isinstance(field, TextField | Choice)
        value = field.value.strip()[:LONGEST]
        return "" if isinstance(field, Choice) and value == NO_ANSWER else value

    @staticmethod
    def _is_cut(field: Widget) -> bool:
        return isinstance(field, TextField) and len(field.value.strip()) > LONGEST

    def _hide(self, client: int) -> None:
        for widget in self._forms.pop(client, ()):
            self._moved.discard(widget)
            widget.destroy()

    def _send(self, event: Event) -> None:
        """Keeps the answers of one visitor, once."""
        form = self._forms.get(event.client)
        if form is None:
            return
        agrees, *fields, _ = form
        assert isinstance(agrees, Checkbox)
        if not agrees.value:
            event.notice("Nothing was sent", f"First agree: {AGREE!r}.")
            return
        given = {text: self._answer(field) for text, field in zip(self._questions, fields, strict=True)}
        if not any(given.values()):
            event.notice("Nothing was sent", "No question is answered yet.")
            return
        if len(self._answers) >= MOST:
            event.notice("No more answers are taken", f"There are {MOST} already.")
            return
        row = [
            datetime.now(timezone.utc).isoformat(timespec="seconds"),
            secrets.token_hex(4),
            self._title,
            *given.values(),
        ]
        try:
            append(self._file, [*FIRST, *self._questions], row)
        except OSError as error:
            event.notice(
                "Your answers could not be kept", str(error), "Please tell who runs this world.", level="error"
            )
            return
        self._answers.append(given)
        self._hide(event.client)
        cut = [text for text, field in zip(self._questions, fields, strict=True) if self._is_cut(field)]
        told = "".join(f" Of {text!r} the first {LONGEST} characters." for text in cut)
        event.notice("Thank you", f"Your answers are kept.{told}")
        if self._hook is not None:
            arguments = (event,) if self._hook.takes_event else ()
            self._guard.call(f"on_answer ({self._hook.name})", self._hook.function, *arguments)


def checked(questions: Mapping[str, Any]) -> dict[str, Any]:
    """The kind of each answer: str, a list of choices, or a range. Raises ValueError and TypeError."""
    if not isinstance(questions, Mapping) or not questions:
        raise TypeError(f'questions must be a dict, as in {{"How was it?": str}}, not {SHORT.repr(questions)}')
    found: dict[str, Any] = {}
    for text, kind in questions.items():
        if not isinstance(text, str) or not text.strip() or text in FIRST:
            raise ValueError(f"a question must be a text other than {', '.join(FIRST)}, not {SHORT.repr(text)}")
        if kind is str:
            found[text] = str
        elif isinstance(kind, tuple) and len(kind) == 2 and all(map(is_number, kind)) and kind[0] < kind[1]:
            found[text] = (float(kind[0]), float(kind[1]))
        elif isinstance(kind, list | tuple) and len(kind) >= 2 and all(isinstance(each, str) for each in kind):
            found[text] = list(kind)
        else:
            raise ValueError(
                f"{text!r}: the answer is str, a list of two choices or more, or a range (low, high), not {SHORT.repr(kind)}"
            )
    return found


def append(file: Path, columns: list[str], row: list[str]) -> None:
    """Adds a row: all of it or nothing, also beside other processes. Raises OSError."""
    with locked(file) as handle:
        begin(handle, file, columns)
        size = os.lseek(handle, 0, os.SEEK_END)
        line = line_of([f"'{cell}" if cell.startswith(FORMULAS) else cell for cell in row])
        try:
            if os.write(handle, line) < len(line):
                raise OSError(f"{file} cannot be written: the disk is full")
            os.fsync(handle)
        except OSError as error:
            with suppress(OSError):
                os.ftruncate(handle, size)
            raise OSError(f"{file} cannot be written: {error.strerror or error}") from None


def begin(handle: int, file: Path, columns: list[str]) -> None:
    """Writes the names of the columns into an empty file. Raises ValueError if the file has others."""
    head = line_of(columns)
    if os.lseek(handle, 0, os.SEEK_END) == 0:
        os.write(handle, head)
        return
    os.lseek(handle, 0, os.SEEK_SET)
    known = b""
    while (part := os.read(handle, 65536)) and len(known) < len(head):
        known += part
    if known[: len(head)] != head:
        raise ValueError(f"{file} has answers to other questions: give another file, or move this one away")


@contextmanager
def locked(file: Path) -> Iterator[int]:
    """The open file, which no other process writes to meanwhile. Raises OSError that names it."""
    try:
        handle = os.open(file, os.O_RDWR | os.O_CREAT | os.O_APPEND, 0o600)
    except OSError as error:
        raise OSError(f"{file} cannot be written: {error.strerror or error}") from None
    try:
        with suppress(ImportError):  # Windows
            import fcntl

            fcntl.flock(handle, fcntl.LOCK_EX)
        yield handle
    finally:
        os.close(handle)


def line_of(cells: list[str]) -> bytes:
    """A line of a CSV file, of UTF-8."""
    out = io.StringIO()
    csv.writer(out, lineterminator="\n").writerow([cell.replace("\r", " ").replace("\n", " ") for cell in cells])
    return out.getvalue().encode()
