# SPDX-License-Identifier: Apache-2.0
"""Writes films and contact sheets, completely or not at all."""

from __future__ import annotations

import os
from collections.abc import Sequence
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from iota.extras import how_to_get

if TYPE_CHECKING:
    from numpy.typing import NDArray

GAP = 4  # px, between the pictures of a sheet
WIDEST = 1280  # px, a sheet of more than one picture


class Failed(Exception):
    """An error that the user is told in one line."""


def video_library() -> Any:
    """PyAV. Raises Failed if it is not installed."""
    try:
        import av
    except ImportError:
        raise Failed(f"films need the package av. {how_to_get('film')}") from None
    av.logging.set_level(av.logging.PANIC)
    return av


def check_name(path: Path, endings: Sequence[str]) -> None:
    """Raises Failed for a file that cannot be made, before any work is done for it."""
    if path.suffix.lower() not in endings:
        raise Failed(f"{path} must end in {' or '.join(endings)}")
    if os.path.isdir(path) or not os.path.isdir(path.parent):
        raise Failed(
            f"{path} cannot be written: " + ("it is a folder" if os.path.isdir(path) else f"no folder {path.parent}")
        )


class FilmFile:
    """An MP4 file of JPEG pictures, H.264. `rate`: pictures a second."""

    def __init__(self, path: Path, width: int, height: int, rate: int) -> None:
        self._av = video_library()
        self._container = self._av.open(str(path), "w", format="mp4", options={"movflags": "+faststart"})
        self._stream = self._container.add_stream(
            "libx264", rate=Fraction(rate), options={"crf": "23", "preset": "veryfast"}
        )
        self._stream.width, self._stream.height, self._stream.pix_fmt = width, height, "yuv420p"
        self._reader = self._av.CodecContext.create("mjpeg", "r")
        self._count = 0

    def add(self, jpeg: bytes) -> None:
        """Adds the next picture."""
        for picture in self._reader.decode(self._av.Packet(jpeg)):
            frame = picture.reformat(format="yuv420p", src_color_range="JPEG", dst_color_range="MPEG")
            frame.pts, frame.time_base = self._count, Fraction(1, int(self._stream.codec_context.framerate))
            self._container.mux(self._stream.encode(frame))
            self._count += 1

    def close(self) -> None:
        """Writes the remaining data to the file."""
        try:
            self._container.mux(self._stream.encode(None))
        finally:
            self._container.close()


def read_picture(jpeg: bytes, shrink: float = 1.0) -> NDArray[np.uint8]:
    """Its pixels: (height, width, 3)."""
    av = video_library()
    (frame,) = av.CodecContext.create("mjpeg", "r").decode(av.Packet(jpeg))
    width, height = int(frame.width * shrink), int(frame.height * shrink)
    pixels: NDArray[np.uint8] = frame.to_ndarray(format="rgb24", width=width, height=height, interpolation="AREA")
    return pixels


def write_sheet(path: Path, pictures: Sequence[bytes], columns: int, width: int) -> None:
    """A contact sheet of JPEG pictures, row by row. width: of a picture, px; reduced if a row would be too wide.
    path ends in .png or .jpg."""
    tiles = [read_picture(picture, min(1.0, (WIDEST / columns - GAP) / width)) for picture in pictures]
    height, width = tiles[0].shape[:2]
    rows = -(-len(tiles) // columns)
    shape = rows * (height + GAP) - GAP, columns * (width + GAP) - GAP
    sheet = np.full((*shape, 3), 255, np.uint8)
    for number, tile in enumerate(tiles):
        y, x = (number // columns) * (height + GAP), (number % columns) * (width + GAP)
        sheet[y : y + height, x : x + width] = tile
    path.write_bytes(encode_picture(sheet, path.suffix.lower()))


def encode_picture(pixels: NDArray[np.uint8], ending: str) -> bytes:
    """A PNG or JPEG file."""
    av = video_library()
    frame = av.VideoFrame.from_ndarray(pixels, format="rgb24")
    codec: Any = av.CodecContext.create("png" if ending == ".png" else "mjpeg", "w")
    codec.width, codec.height, codec.time_base = pixels.shape[1], pixels.shape[0], Fraction(1, 25)
    if ending == ".png":
        codec.pix_fmt = "rgb24"
    else:
        codec.pix_fmt, codec.qmin, codec.qmax, codec.options = "yuvj420p", 3, 3, {"huffman": "optimal"}
        frame = frame.reformat(format="yuvj420p", dst_color_range="JPEG")
    return b"".join(bytes(packet) for packet in [*codec.encode(frame), *codec.encode(None)])
