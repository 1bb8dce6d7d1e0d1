# SPDX-License-Identifier: Apache-2.0
"""`iota sweep`: a function of a script for many values of its arguments."""

from __future__ import annotations

import argparse
import inspect
import math
import runpy
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from iota.cli import plot
from iota.cli.failure import Failure
from iota.cli.run import parse, plain_failures
from iota.sweeping import ERROR, SCRIPT, sweep

BAR = 30  # characters
MOST_TOLD = 5  # failures on the terminal
FUNCTION = "run"


def find(path: Path, name: str) -> Callable[..., Any]:
    sys.path.insert(0, str(path.resolve().parent))
    function: Callable[..., Any] | None = runpy.run_path(str(path), run_name=SCRIPT).get(name)
    if function is None or not callable(function):
        raise Failure(f"{path} has no function {name}(...) that a sweep could call")
    return function


def run(arguments: argparse.Namespace) -> None:
    """Prints the path of the table, and failures."""
    path, _, name = arguments.what.partition(":")
    grid = dict(varied(text) for text in arguments.vary)
    table: Path = arguments.output or Path(Path(path).stem + ".csv")
    if table.suffix.lower() not in (".csv", ".parquet"):
        raise Failure(f"{table} must end in .csv or .parquet")
    if arguments.plot is not None:
        plot.check(arguments.plot)
    parse(Path(path))
    bar = Bar(Path(path).stem)
    with plain_failures(None):
        function = find(Path(path), name or FUNCTION)
        try:
            inspect.signature(function).bind(**dict.fromkeys(grid))
        except TypeError as error:
            raise Failure(f"{name or FUNCTION}() of {path} does not take these arguments: {error}") from None
        try:
            rows = sweep(function, grid, table, arguments.processes, bar.show, arguments.ray)
        except (ValueError, TypeError, OSError) as error:
            raise Failure(str(error)) from None
        finally:
            bar.end()
    failures = [row for row in rows if row[ERROR]]
    for row in failures[:MOST_TOLD]:
        inputs = ", ".join(f"{name} = {row[name]}" for name in grid)
        print(f"iota: failed with {inputs}: {row[ERROR]}", file=sys.stderr)
    if failures[MOST_TOLD:]:
        print(f"iota: and {len(failures) - MOST_TOLD} more, see the column {ERROR} of {table}", file=sys.stderr)
    print(f"{table}  {len(rows) - len(failures)} of {len(rows)} runs")
    if arguments.plot is not None:
        plot.draw(rows, list(grid), Path(path).stem, arguments.plot)
        print(arguments.plot)
    if failures:
        raise Failure(f"{len(failures)} of {len(rows)} runs failed; the same command tries them again")


def varied(text: str) -> tuple[str, list[Any]]:
    """Reads NAME=1,2,5 or NAME=1..50 (whole numbers) or NAME=0..1:11 or NAME=1e2..1e5:log:20."""
    name, has_values, values = text.partition("=")
    try:
        if not (has_values and name.isidentifier()):
            raise ValueError("a name, = and values are needed")
        return name, list(values_of(values))
    except ValueError as error:
        raise Failure(
            f"--vary {text}: {error}. Try: {name or 'NAME'}=1,2,5 or {name or 'NAME'}=1..50 or 0..1:11 or 1e2..1e5:log:20"
        ) from None


def values_of(text: str) -> list[Any]:
    if ".." not in text:
        return [number_or_text(each) for each in text.split(",")]
    ends, *rest = text.split(":")
    first, last = ends.split("..")
    if not rest:
        return list(range(int(first), int(last) + 1))
    count, a, b = int(rest[-1]), float(first), float(last)
    if count < 2 or rest[:-1] not in ([], ["log"]):
        raise ValueError("a range has 2 values or more, evenly or :log")
    if rest[:-1]:
        if a <= 0 or b <= 0:
            raise ValueError("a logarithmic range has ends above 0")
        between = [math.exp(math.log(a) + n / (count - 1) * math.log(b / a)) for n in range(1, count - 1)]
    else:
        between = [a + (b - a) * n / (count - 1) for n in range(1, count - 1)]
    return [a, *(float(f"{value:.12g}") for value in between), b]


def number_or_text(text: str) -> int | float | str:
    for kind in (int, float):
        try:
            return kind(text)
        except ValueError:
            continue
    return text


class Bar:
    """One line on the terminal with the progress; nothing if stderr is not a terminal."""

    def __init__(self, name: str) -> None:
        self._name = name
        self._began = time.monotonic()
        self._first: int | None = None  # that were done before
        self._is_shown = sys.stderr.isatty()

    def show(self, done: int, all: int, failed: int) -> None:
        if not self._is_shown:
            return
        self._first = done if self._first is None else self._first
        new = done - self._first
        left = f", {(time.monotonic() - self._began) * (all - done) / new:.0f} s left" if new else ""
        full = BAR * done // all
        told = f", {failed} failed" if failed else ""
        bar = f"\r{self._name} [{'#' * full}{' ' * (BAR - full)}] {done}/{all}{told}{left} \033[K"
        print(bar, end="", file=sys.stderr, flush=True)

    def end(self) -> None:
        if self._is_shown:
            print("\r\033[K", end="", file=sys.stderr, flush=True)
