# SPDX-License-Identifier: Apache-2.0
"""`iota run --watch`: a world goes on where the one before it ended, if its script starts it in the same state."""

from __future__ import annotations

import hashlib
from pathlib import Path

from iota.saving import replacing


def keep(file: Path, start: bytes, now: bytes) -> None:
    """Writes the state of a world that ends. start: its snapshot when it began. Raises OSError."""
    with replacing(file) as fresh:
        fresh.write_bytes(hashlib.sha256(start).digest() + now)


def take(file: Path, start: bytes) -> bytes | None:
    """The kept state, which is then removed; None without one, or if that world began in another state."""
    try:
        kept = file.read_bytes()
        file.unlink()
    except OSError:
        return None
    digest = hashlib.sha256(start).digest()
    return kept.removeprefix(digest) if kept.startswith(digest) else None
