# SPDX-License-Identifier: Apache-2.0
"""Reads files; an error is one line that names the file and the place."""

from __future__ import annotations

import os
import sys
import time
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias, TypeVar

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

PathLike: TypeAlias = str | os.PathLike[str]
Item = TypeVar("Item")

MOST_BYTES = 1 << 28
FARTHEST = 1e9  # m
QUIET_S = 1.0  # shorter tasks show no progress


class FileError(ValueError):
    """A file that cannot be used. The text names the file, the line if known, and the reason."""

    def __init__(self, path: PathLike, reason: str, line: int | None = None) -> None:
        where = os.fspath(path) if line is None else f"{os.fspath(path)}, line {line}"
        super().__init__(f"{where}: {' '.join(reason.split())}")
        self.path, self.reason, self.line = os.fspath(path), reason, line

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.path, self.reason, self.line)


def read_bytes(path: PathLike) -> bytes:
    """The contents of a file of at most 256 MiB that is not empty. Raises FileError."""
    file = Path(path)
    try:
        if file.is_dir():
            raise FileError(path, "is a folder, not a file")
        if file.exists() and not file.is_file():
            raise FileError(path, "is a pipe or device, not a file")
        size = file.stat().st_size
        if size > MOST_BYTES:
            raise FileError(path, f"has {size / 2**20:.0f} MiB, more than {MOST_BYTES >> 20}")
        data = file.read_bytes()
    except OSError as error:
        raise FileError(path, (error.strerror or str(error)).lower()) from None
    if not data.strip():
        raise FileError(path, "is empty")
    return data


def read_text(path: PathLike) -> str:
    """The text of a file. Raises FileError, also for a file that is not text."""
    data = read_bytes(path)
    if b"\0" in data:
        raise FileError(path, "is not a text file", data[: data.index(b"\0")].count(b"\n") + 1)
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError:  # names of authors in older files
        return data.decode("latin-1")


def number(text: str, path: PathLike, line: int, what: str) -> float:
    """A finite number. Raises FileError that names the expected value."""
    try:
        value = float(_plain(text))
    except ValueError:
        raise FileError(path, f"{what} must be a number, not {text.strip()[:40]!r}", line) from None
    if not abs(value) < 1e300:
        raise FileError(path, f"{what} must be finite, not {text.strip()[:40]}", line)
    return value


def whole(text: str, path: PathLike, line: int, what: str) -> int:
    """A whole number. Raises FileError that names the expected value."""
    try:
        return int(_plain(text))
    except ValueError:
        raise FileError(path, f"{what} must be a whole number, not {text.strip()[:40]!r}", line) from None


def check_reach(places: NDArray[np.float64], path: PathLike) -> None:
    """Raises FileError for a place, (n, 3), m, that no body can have."""
    far = np.flatnonzero(~(np.abs(places) <= FARTHEST).all(axis=1))
    if len(far):
        raise FileError(
            path, f"point {far[0] + 1} (of {len(places)}) is more than {FARTHEST:g} m away; give a smaller scale"
        )


def _plain(text: str) -> str:
    """Raises ValueError for what only Python takes for a number: 1_000, digits of other scripts."""
    if not text.isascii() or "_" in text:
        raise ValueError
    return text


def with_progress(items: Sequence[Item], what: str) -> Iterator[Item]:
    """Iterates over items; after a second, a line on the terminal shows the progress until the end."""
    began = shown = time.monotonic()
    is_shown = False
    for done, item in enumerate(items):
        if done % 1000 == 0 and sys.stderr.isatty() and (now := time.monotonic()) - shown > 0.2:
            shown = now
            if now - began > QUIET_S:
                is_shown = True
                print(f"\r{what}: {100 * done // len(items)} %", end="", file=sys.stderr, flush=True)
        yield item
    if is_shown:
        print("\r\x1b[K", end="", file=sys.stderr, flush=True)
