# SPDX-License-Identifier: Apache-2.0
"""Sounds of a script: WAV, MP3, Ogg or FLAC files, or arrays of samples."""

from __future__ import annotations

import hashlib
import io
import os
import wave
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from iota.arguments import SHORT

MOST_BYTES = 1 << 20
RATES = (8_000, 96_000)  # samples a second
# The first bytes of a file, and where they are.
STARTS = (
    (b"OggS", 0),
    (b"fLaC", 0),
    (b"ID3", 0),
    (b"WAVE", 8),
    *((bytes([0xFF, second]), 0) for second in (0xFB, 0xF3, 0xF2, 0xFA)),
)


@dataclass(frozen=True)
class SoundFile:
    """A file that browsers decode."""

    data: bytes

    @cached_property
    def name(self) -> str:
        """The same for equal files."""
        return hashlib.sha256(self.data).hexdigest()[:16]


def sound_file(source: Any, rate: float = 44_100) -> SoundFile:
    """source: the path of a WAV, MP3, Ogg or FLAC file of at most 1 MiB, or an array of samples from -1 to 1, (n,) or
    (n, 2) for left and right, `rate` of them a second. Raises ValueError that names a file that cannot be used, and its
    error. How long it lasts is checked by the pages, which play at most a minute."""
    if isinstance(source, np.ndarray):
        return SoundFile(make_wav(source, rate))
    if not isinstance(source, str | os.PathLike):
        raise TypeError(f"a sound is the path of a file, or an array of samples, not {SHORT.repr(source)}")
    try:
        _check_bytes(os.stat(source).st_size)  # before it is read
        data = Path(source).read_bytes()
        _check_bytes(len(data))
        if not any(data[at : at + len(start)] == start for start, at in STARTS):
            raise ValueError("is neither a WAV, MP3, Ogg nor FLAC file")
    except (OSError, ValueError) as error:
        reason = error.strerror.lower() if isinstance(error, OSError) and error.strerror else error
        raise ValueError(f"sound {os.fspath(source)!r}: {reason}") from None
    return SoundFile(data)


def make_wav(samples: np.ndarray[Any, Any], rate: float) -> bytes:
    """A WAV file of 16 bits of an array, see `sound_file`."""
    rows = samples[:, None] if samples.ndim == 1 else samples
    if rows.ndim != 2 or rows.shape[1] not in (1, 2) or len(rows) == 0:
        raise ValueError(f"samples have the shape (n,) or (n, 2), not {samples.shape}")
    if not RATES[0] <= rate <= RATES[1]:
        raise ValueError(f"rate is from {RATES[0]} to {RATES[1]} samples a second, not {rate}")
    if rows.dtype.kind not in "fiu" or not np.isfinite(rows).all():
        raise ValueError("samples are finite numbers from -1 to 1")
    _check_bytes(44 + 2 * rows.size)
    file = io.BytesIO()
    with wave.open(file, "wb") as out:
        out.setnchannels(rows.shape[1])
        out.setsampwidth(2)
        out.setframerate(round(rate))
        out.writeframes(np.round(32767 * np.clip(rows, -1, 1)).astype("<i2").tobytes())
    return file.getvalue()


def _check_bytes(count: int) -> None:
    if count > MOST_BYTES:
        raise ValueError(f"has {count / 2**20:.1f} MiB, more than {MOST_BYTES >> 20}")
