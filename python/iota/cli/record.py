# SPDX-License-Identifier: Apache-2.0
"""`iota record`: a film and a contact sheet of a study or a script."""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager

from iota.cli import run
from iota.cli.failure import Failure
from iota.film import Failed, Film, record
from iota.world import World
from iota.world.options import RunOptions, use

BAR = 30  # characters


def record_film(arguments: argparse.Namespace) -> None:
    """Builds the world, makes the files, prints their paths."""
    width, height = arguments.size
    film = Film(
        arguments.output, arguments.sheet, arguments.seconds, arguments.rate, width, height, arguments.pictures,
        arguments.columns, arguments.plots,
    )  # fmt: skip
    start = run.find(arguments.what)
    bar = Bar(arguments.what)
    with plain(bar):
        film.check()

    def drive(world: World) -> None:
        with plain(bar):
            record(world, film, bar.show)

    options = RunOptions(drive=drive)
    with use(options), run.plain_failures(None):
        start(None)
        if not options.ran:
            raise Failure(
                f"{arguments.what} made no World run: call world.run(), or define build() that returns a World"
            )
    for path in (arguments.output, arguments.sheet):
        if path is not None:
            print(f"{path}  {path.stat().st_size / 1000:.0f} kB")


@contextmanager
def plain(bar: Bar) -> Iterator[None]:
    """Prints an error in one line, below the bar."""
    try:
        yield
    except Failed as failed:
        raise Failure(str(failed)) from None
    finally:
        bar.end()


def size(text: str) -> tuple[int, int]:
    """Reads 640x480."""
    width, _, height = text.partition("x")
    return int(width), int(height)


class Bar:
    """One line on the terminal with the progress; nothing if stderr is not a terminal."""

    def __init__(self, name: str) -> None:
        self._name = name
        self._began = time.monotonic()
        self._is_shown = sys.stderr.isatty()

    def show(self, done: int, all: int) -> None:
        if not self._is_shown:
            return
        left = (time.monotonic() - self._began) * (all - done) / done
        full = BAR * done // all
        print(
            f"\r{self._name} [{'#' * full}{' ' * (BAR - full)}] {done}/{all} frames, {left:.0f} s left ",
            end="",
            file=sys.stderr,
            flush=True,
        )

    def end(self) -> None:
        if self._is_shown:
            print("\r\033[K", end="", file=sys.stderr, flush=True)
