# SPDX-License-Identifier: Apache-2.0
"""The server's messages to a page, with times: saved in a file, or embedded in a page that plays them without a server.

A file is gzip over the line "iota stream 1" and, for each frame, its time (s, f64), length (u32) and bytes, little-endian.
"""

from __future__ import annotations

import base64
import gzip
import html
import struct
import zlib
from collections.abc import Iterable
from pathlib import Path

from iota.film.files import Failed
from iota.world.page import page_folder

MAGIC = b"iota stream 1\n"
PAGE = """<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1, viewport-fit=cover">
<title>{title}</title>
<style>{style}</style>
</head>
<body>
<canvas id="view" tabindex="0" aria-label="The recorded world: drag to look around"></canvas>
<div id="player" role="toolbar" aria-label="Playback"></div>
<script type="text/plain" id="licenses">{licenses}</script>
<script type="text/plain" id="recording">{recording}</script>
<script>{script}</script>
</body>
</html>
"""


def pack(frames: Iterable[tuple[float, bytes]]) -> bytes:
    """A file of frames, each with its time, s."""
    records = [struct.pack("<dI", time, len(data)) + data for time, data in frames]
    return gzip.compress(MAGIC + b"".join(records), mtime=0)


def unpack(packed: bytes) -> list[tuple[float, bytes]]:
    """The frames of a file. Raises Failed for a file of another format."""
    try:
        data = gzip.decompress(packed)
    except (OSError, EOFError, zlib.error) as error:
        raise Failed(f"it is not a recording, or truncated: {error}") from None
    if not data.startswith(MAGIC):
        raise Failed("it is not a recording of iota")
    frames, at = [], len(MAGIC)
    while at < len(data):
        if at + 12 > len(data):
            raise Failed("it is truncated")
        time, length = struct.unpack_from("<dI", data, at)
        if at + 12 + length > len(data):
            raise Failed("it is truncated")
        frames.append((time, data[at + 12 : at + 12 + length]))
        at += 12 + length
    return frames


def player(packed: bytes, title: str) -> str:
    """A self-contained page that plays a file. Raises PageMissingError if the page is not built."""
    folder = page_folder()

    def read(name: str, tag: str) -> str:
        return (folder / name).read_text(encoding="utf-8").replace(f"</{tag}", f"<\\/{tag}")

    return PAGE.format(
        title=html.escape(title),
        style=read("player/player.css", "style"),
        licenses=read("licenses.txt", "script"),
        recording=base64.b64encode(packed).decode(),
        script=read("player/player.js", "script"),
    )


def write_stream(path: Path, frames: Iterable[tuple[float, bytes]], title: str) -> None:
    """The file itself, or the page that plays it, by its ending: .iota or .html."""
    packed = pack(frames)
    path.write_bytes(packed if path.suffix == ".iota" else player(packed, title).encode())
