# SPDX-License-Identifier: Apache-2.0
"""Files that are written completely or not at all, also if the power fails."""

from __future__ import annotations

import os
import re
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

LEFT_OVER = 3600.0  # s since a file was written to, after which the process that made it was killed


@contextmanager
def replacing(path: Path) -> Iterator[Path]:
    """A new file that replaces `path` at the end; after an error `path` is unchanged. Raises OSError whose text names
    the file and the reason."""
    try:
        handle, fresh = file_beside(path)
        os.close(handle)
        try:
            yield fresh
            put_in_place(fresh, path)
        finally:
            fresh.unlink(missing_ok=True)
    except OSError as error:
        raise OSError(f"{path} cannot be written: {error.strerror or error}") from None


def file_beside(path: Path) -> tuple[int, Path]:
    """A new hidden file in the same folder, open, for `put_in_place`. Those that killed processes left are removed."""
    begin, end = f".{path.stem}-", path.suffix
    name = re.compile(re.escape(begin) + r"[a-z0-9_]{8}" + re.escape(end))  # as tempfile makes them
    with suppress(OSError):
        for other in os.scandir(path.parent):
            if name.fullmatch(other.name) and time.time() - other.stat().st_mtime > LEFT_OVER:
                os.unlink(other.path)
    handle, made = tempfile.mkstemp(dir=path.parent, prefix=begin, suffix=end)
    return handle, Path(made)


def put_in_place(fresh: Path, path: Path) -> None:
    """Renames a file of `file_beside`. Its content is on the disk before its name, which without that may name an empty file after a power cut."""
    fresh.chmod(0o644)
    sync(fresh)
    fresh.replace(path)
    with suppress(OSError):  # a folder that one may write to, but not list; Windows
        sync(path.parent)


def sync(path: Path) -> None:
    """Waits until a file, or the entries of a folder, are on the disk."""
    handle = os.open(path, os.O_RDONLY if path.is_dir() else os.O_RDWR)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)
