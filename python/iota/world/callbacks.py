# SPDX-License-Identifier: Apache-2.0
"""Calls the script's functions; reports those that raise or are slow, and the world continues."""

from __future__ import annotations

import inspect
import sys
import threading
import time
import traceback
import unicodedata
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType
from typing import Any

from iota.arguments import SHORT, near_attribute
from iota.world.costs import Costs

SLOW = 0.5  # s, of a function
LOOK = 0.25  # s, between two looks at what runs
SLOW_STEP = 2.0  # s; before that, pages see slow motion
ELSEWHERE = "Do long work elsewhere, or in small pieces once a step."
GO_ON = "The world continues. Correct the script and run it again."
MOST_ERRORS = 100  # of iota itself, that are printed
_PACKAGE = str(Path(__file__).parent.parent)  # as in frames, without resolving symbolic links
_STUDIES = str(Path(_PACKAGE, "studies"))

Tell = Callable[[str, str, str], None]  # title, text, hint


def wants_event(function: Callable[..., Any]) -> bool:
    """Whether the function takes an argument; decided when it is registered."""
    if not callable(function):
        raise TypeError(f"a callback is a function, not {SHORT.repr(function)}")
    try:
        signature = inspect.signature(function)
    except (TypeError, ValueError):
        return False
    positional = (inspect.Parameter.POSITIONAL_ONLY, inspect.Parameter.POSITIONAL_OR_KEYWORD)
    needed = [p for p in signature.parameters.values() if p.kind in positional and p.default is p.empty]
    if len(needed) > 1:
        raise TypeError(
            f"{function_name(function)} takes {len(needed)} arguments; a callback gets one event, or nothing"
        )
    return bool(needed)


@dataclass(frozen=True, eq=False)
class Hook:
    """A registered function of the script."""

    function: Callable[..., Any]
    takes_event: bool
    name: str

    @classmethod
    def of(cls, function: Callable[..., Any]) -> Hook:
        return cls(function, wants_event(function), function_name(function))


def add_once(hooks: list[Hook], function: Callable[..., Any], kind: str) -> None:
    """Registers a function. Raises ValueError if it is there already."""
    hook = Hook.of(function)
    if any(each.function == function for each in hooks):
        raise twice(hook, kind)
    hooks.append(hook)


def twice(hook: Hook, kind: str) -> ValueError:
    return ValueError(f"{hook.name} is registered by {kind} already, and would be called twice")


def slow_title(what: str) -> str:
    return f"{what} is slow"


def function_name(function: Callable[..., Any]) -> str:
    return getattr(function, "__qualname__", None) or type(function).__name__


def script_frames(trace: TracebackType | None) -> list[traceback.FrameSummary]:
    """The frames of a traceback that are not iota's own."""
    return [
        frame
        for frame in traceback.extract_tb(trace)
        if not frame.filename.startswith((_PACKAGE, "<frozen ")) or frame.filename.startswith(_STUDIES)
    ]


def one_line(error: BaseException) -> str:
    """'ZeroDivisionError: division by zero (chain.py, line 12)'."""
    text = told(error)
    frames = script_frames(error.__traceback__)
    return f"{text} ({Path(frames[-1].filename).name}, line {frames[-1].lineno})" if frames else text


def told(error: BaseException) -> str:
    """'ZeroDivisionError: division by zero'; with a near name for what a handle of the engine does not have."""
    text = traceback.format_exception_only(type(error), error)[-1].strip()
    if isinstance(error, AttributeError) and type(error.obj).__module__ == "iota._core" and "Did you mean" not in text:
        text += near_attribute(error.name or "", [n for n in dir(type(error.obj)) if n[0] != "_"])
    return text


def print_error(error: BaseException, is_own: bool = False) -> None:
    """The traceback on stderr, without iota's own frames. is_own: with them, for an error of iota itself."""
    frames = list(traceback.extract_tb(error.__traceback__)) if is_own else script_frames(error.__traceback__)
    lines = ["Traceback (most recent call last):\n", *traceback.format_list(frames)] if frames else []
    cause = error.__cause__
    if cause is not None:
        lines = [*traceback.format_exception(type(cause), cause, cause.__traceback__), "\n", *lines]
    lines += [*traceback.format_exception_only(type(error), error)[:-1], f"{told(error)}\n"]
    print_on_terminal("".join(lines))


def print_on_terminal(text: str, is_error: bool = True) -> None:
    """Prints on stderr, or stdout. A closed terminal or a log on a full disk must not end the world: pages show the error
    as well."""
    with suppress(OSError, ValueError, AttributeError):  # disk full or broken pipe, closed, none (a service, pythonw)
        out = sys.stderr if is_error else sys.stdout
        out.write(plain(text))
        out.flush()


def plain(text: str) -> str:
    """The text with its control characters spelled out, but for lines and tabs: names in files and of people may hold some that steer a
    terminal."""
    return "".join(
        c if c in "\n\t" or unicodedata.category(c)[0] != "C" else c.encode("unicode_escape").decode() for c in text
    )


def is_terminal() -> bool:
    """Whether stdout is one."""
    return sys.stdout is not None and not sys.stdout.closed and sys.stdout.isatty()


def is_decorator(use: str, *arguments: object) -> None:
    """Raises TypeError for a function among the arguments of a decorator: it would never be called. use: the decorator's call."""
    if any(callable(argument) for argument in arguments):
        raise TypeError(f"{use} is a decorator: write @{use} above the function, or {use}(function)")


class Running:
    """A with block that the world waits for: since when, the longest time before users are told, s, and a remedy."""

    __slots__ = ("_before", "_guard", "hint", "longest", "since", "what")

    def __init__(self, guard: Guard, what: str, longest: float, hint: str) -> None:
        self._guard, self.what, self.longest, self.hint = guard, what, longest, hint
        self.since = time.monotonic()

    def __enter__(self) -> None:
        self._before, self._guard._running = self._guard._running, self

    def __exit__(self, *_: object) -> None:
        self._guard._running = self._before
        seconds = time.monotonic() - self.since
        if seconds > self.longest:
            print_on_terminal(f"iota: {self.what} took {seconds:.1f} s; the world was stopped meanwhile\n")
            self._guard._over(slow_title(self.what))


class Guard:
    """Calls functions of the script; reports errors and slow functions by `tell(title, text, hint)`, and the return of
    a slow one by `over(title)`. Steps of the simulator are watched the same way.

    A thread reports what is slow while it still runs; the page, served by another thread, continues to draw.
    """

    def __init__(self, tell_error: Tell, tell_slow: Tell, over: Callable[[str], None], costs: Costs) -> None:
        self._tell_error, self._tell_slow, self._over, self._costs = tell_error, tell_slow, over, costs
        self._running: Running | None = None
        self._told: Running | None = None
        self._stop = threading.Event()
        self._watcher: threading.Thread | None = None
        self._printed: set[str] = set()

    def call(self, what: str, function: Callable[..., Any], *arguments: Any, hint: str = GO_ON) -> bool:
        """Calls it; False if it raised, which is reported. KeyboardInterrupt and SystemExit propagate."""
        try:
            with self.watching(what, SLOW, ELSEWHERE), self._costs.of(f"script: {what}"):
                function(*arguments)
        except Exception as error:
            self.failed(what, error, hint)
            return False
        return True

    def outlive(
        self, what: str, work: Callable[[], object], tell: Tell | None = None, hint: str = "The world continues."
    ) -> bool:
        """Does work of iota itself for a world that is served. False if it raised: this is told by `tell` (None: to all
        pages, once) and does not end the world."""
        try:
            work()
        except Exception as error:
            text = one_line(error)
            is_new = text not in self._printed and len(self._printed) < MOST_ERRORS
            if is_new:
                self._printed.add(text)
                print_error(error, is_own=True)
            if tell or is_new:
                (tell or self._tell_error)(f"{what} failed", text, hint)
            return False
        return True

    def watching(self, what: str, longest: float, hint: str) -> Running:
        """A with block that is reported if it takes longer, s."""
        return Running(self, what, longest, hint)

    def failed(self, what: str, error: Exception, hint: str = GO_ON) -> None:
        print_error(error)
        self._tell_error(f"{what} failed", one_line(error), hint)

    def watch(self) -> None:
        """Starts the thread that watches for slow functions."""
        if self._watcher is None:
            self._stop.clear()
            self._watcher = threading.Thread(target=self._watch, name="iota-slow-callbacks", daemon=True)
            self._watcher.start()

    def close(self) -> None:
        self._stop.set()
        if self._watcher is not None:
            self._watcher.join()
            self._watcher = None

    def _watch(self) -> None:
        while not self._stop.wait(LOOK):
            running = self._running
            if running and running is not self._told and time.monotonic() - running.since > running.longest:
                self._told = running
                self._tell_slow(slow_title(running.what), "The world waits for it; the page continues.", running.hint)
