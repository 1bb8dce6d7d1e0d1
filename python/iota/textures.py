# SPDX-License-Identifier: Apache-2.0
"""Images on shapes and surfaces: PNG or JPEG files, or arrays."""

from __future__ import annotations

import hashlib
import math
import os
import struct
import zlib
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from iota.arguments import SHORT

MOST_BYTES = 4 << 20
MOST_SIDE = 4096  # pixels: the limit of phones
MOST_REPEATS = 10_000.0
PNG = b"\x89PNG\r\n\x1a\n"
JPEG = b"\xff\xd8\xff"


@dataclass(frozen=True)
class Texture:
    """An image, and how often it is beside itself in both directions."""

    image: bytes  #: a PNG or JPEG file
    repeat: tuple[float, float] = (1.0, 1.0)

    @cached_property
    def name(self) -> str:
        """The same for equal textures."""
        return hashlib.sha256(self.image + struct.pack("<2d", *self.repeat)).hexdigest()[:16]


def texture_of(image: Any, repeat: float | Sequence[float] = 1.0) -> Texture:
    """image: the path of a PNG or JPEG file, an array (rows, columns), (rows, columns, 3) or (rows, columns, 4) of
    bytes or of numbers from 0 to 1, the first row above; or a texture, which is returned. Raises ValueError that names
    a file that cannot be used, and its error."""
    if isinstance(image, Texture):
        return image
    times = _repeats(repeat)
    if isinstance(image, np.ndarray):
        return Texture(make_png(image), times)
    if not isinstance(image, str | os.PathLike):
        raise TypeError(f"a texture is the path of a PNG or JPEG file, or an array, not {SHORT.repr(image)}")
    try:
        _check_bytes(os.stat(image).st_size)  # before it is read
        data = Path(image).read_bytes()
        check_image(data)
    except (OSError, ValueError) as error:
        reason = error.strerror.lower() if isinstance(error, OSError) and error.strerror else error
        raise ValueError(f"texture {os.fspath(image)!r}: {reason}") from None
    return Texture(data, times)


def material_name(material: str, texture: Texture | None) -> str:
    """The name of a material with a texture, for pages."""
    return material if texture is None else f"{material}#{texture.name}"


def check_image(data: bytes) -> None:
    """Raises ValueError unless it is a whole PNG or JPEG file of at most 4096 x 4096 pixels and 4 MiB."""
    _check_bytes(len(data))
    _check_size(*size_of(data))


def size_of(data: bytes) -> tuple[int, int]:
    """Width and height of an image, pixels. Raises ValueError unless it is a whole PNG or JPEG file."""
    if data.startswith(PNG):
        return _check_png(data)
    if data.startswith(JPEG):
        return _check_jpeg(data)
    raise ValueError("is neither a PNG nor a JPEG file")


def _check_bytes(count: int) -> None:
    if count > MOST_BYTES:
        raise ValueError(f"has {count / 2**20:.1f} MiB, more than {MOST_BYTES >> 20}")


def _check_size(width: int, height: int) -> None:
    if not (0 < width <= MOST_SIDE and 0 < height <= MOST_SIDE):
        raise ValueError(f"has {width} x {height} pixels; from 1 to {MOST_SIDE} on each side are shown")


def _check_png(data: bytes) -> tuple[int, int]:
    """Width and height, if every chunk is whole (PNG 1.2, chapter 3)."""
    at, size = len(PNG), (0, 0)
    while at + 12 <= len(data):
        length, kind = struct.unpack_from(">I4s", data, at)
        end = at + 12 + length
        if end > len(data):
            break
        if zlib.crc32(data[at + 4 : end - 4]) != struct.unpack_from(">I", data, end - 4)[0]:
            raise ValueError(f"is a damaged PNG file: the checksum at byte {end - 4} is wrong")
        if kind == b"IHDR" and length == 13:
            size = struct.unpack_from(">II", data, at + 8)
        if kind == b"IEND":
            return size
        at = end
    raise ValueError("is a truncated PNG file")


def _check_jpeg(data: bytes) -> tuple[int, int]:
    """Width and height, from the header of its frame (ITU-T T.81, B.2)."""
    at = 2
    while at + 9 <= len(data) and data[at] == 0xFF:
        marker, length = data[at + 1], int.from_bytes(data[at + 2 : at + 4], "big")
        if marker == 0xFF:
            at += 1
            continue
        if 0xC0 <= marker <= 0xCF and marker not in (0xC4, 0xC8, 0xCC):
            if b"\xff\xd9" not in data[at:]:
                break
            height, width = struct.unpack_from(">HH", data, at + 5)
            return width, height
        at += 2 + length
    raise ValueError("is a truncated or damaged JPEG file")


def make_png(pixels: np.ndarray[Any, Any]) -> bytes:
    """A PNG file of an array, see `texture_of`."""
    rows = pixels[:, :, None] if pixels.ndim == 2 else pixels
    if rows.ndim != 3 or rows.shape[2] not in (1, 3, 4):
        raise ValueError(f"a texture has the shape (rows, columns), (rows, columns, 3) or 4, not {pixels.shape}")
    _check_size(rows.shape[1], rows.shape[0])
    if rows.dtype.kind == "f":
        if not np.isfinite(rows).all():
            raise ValueError("the numbers of a texture are finite")
        rows = np.round(255 * np.clip(rows, 0, 1)).astype(np.uint8)
    if rows.dtype != np.uint8:
        raise ValueError(f"a texture is an array of bytes or of numbers from 0 to 1, not of {rows.dtype}")
    height, width, channels = rows.shape
    header = struct.pack(">IIBBBBB", width, height, 8, {1: 0, 3: 2, 4: 6}[channels], 0, 0, 0)
    lines = np.zeros((height, 1 + width * channels), np.uint8)  # each begins with its filter: none
    lines[:, 1:] = rows.reshape(height, -1)
    packed = zlib.compress(lines.tobytes(), 6)
    if len(packed) > MOST_BYTES - 100:
        raise ValueError(
            f"a texture of {width} x {height} pixels has more than {MOST_BYTES >> 20} MiB; make it smaller"
        )
    return PNG + _chunk(b"IHDR", header) + _chunk(b"IDAT", packed) + _chunk(b"IEND", b"")


def _chunk(kind: bytes, data: bytes) -> bytes:
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))


def _repeats(repeat: float | Sequence[float]) -> tuple[float, float]:
    u, v = repeat if isinstance(repeat, Sequence | np.ndarray) else (repeat, repeat)
    times = (float(u), float(v))
    if not all(math.isfinite(number) and 0 < number <= MOST_REPEATS for number in times):
        raise ValueError(f"repeat is one number above 0, or one for each direction, not {repeat}")
    return times


def lay_flat(points: np.ndarray[Any, Any]) -> np.ndarray[Any, Any]:
    """Coordinates of an image that is laid once over points (n, 3), along their shortest axis: (n, 2), upright where
    they stand, with its upper side towards -z where they lie."""
    if len(points) == 0:
        return np.zeros((0, 2))
    low, extent = points.min(axis=0), np.ptp(points, axis=0)
    across, up = {0: (2, 1), 1: (0, 2), 2: (0, 1)}[int(np.argmin(extent))]
    share = (points - low) / np.where(extent > 0, extent, 1)
    u, v = share[:, across], share[:, up]
    return np.column_stack([u, 1 - v if up == 2 else v])
