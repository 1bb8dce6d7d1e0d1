# SPDX-License-Identifier: Apache-2.0
"""The server's messages to a page, with times: saved in a file, or embedded in a page that plays them without a server."""

from __future__ import annotations

import base64
import gzip
import html
import os
import stat
import struct
import zlib
from collections.abc import Iterable
from pathlib import Path

from iota._protocol import PROTOCOL_VERSION
from iota.film.files import Failed
from iota.world.page import page_folder
from iota.world.recording import GZIP, MAGIC, packed

MOST_PACKED, MOST_UNPACKED = 256 << 20, 1 << 30  # bytes; an hour of a large world has some ten MiB packed
WELCOME = 64  # type of the message
REPLAY = b"IOTARC"  # begin of a file of Recording.save

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


def pack(messages: Iterable[tuple[float, bytes]]) -> bytes:
    """A file of messages, each with its time, s. See iota.world.recording for its format."""
    return gzip.compress(MAGIC + b"".join(map(packed, messages)), mtime=0)


def read_file(path: Path) -> bytes:
    """A file of `unpack`. Raises Failed for one that is too large, or is no file; OSError."""
    wait_for_no_writer = getattr(os, "O_NONBLOCK", 0)  # of a pipe
    with open(path, "rb", opener=lambda name, flags: os.open(name, flags | wait_for_no_writer)) as file:
        if not stat.S_ISREG(os.fstat(file.fileno()).st_mode):
            raise Failed("it is a pipe or a device, not a file")
        data = file.read(MOST_PACKED + 1)
    if len(data) > MOST_PACKED:
        raise Failed(f"it has more than {MOST_PACKED >> 20} MiB")
    return data


def unpack(file: bytes) -> tuple[list[tuple[float, bytes]], bool]:
    """The messages of a file, and whether it is complete: the recording of a killed process ends after its last whole
    message. Raises Failed for a file of another format, and for one that is too large."""
    if file.startswith(REPLAY):
        raise Failed("it is the recording of a system, which iota.Recording.load reads")
    unpacker = zlib.decompressobj(GZIP)
    try:
        data = unpacker.decompress(file, MOST_UNPACKED)
    except zlib.error as error:
        raise Failed(f"it is not a recording, or damaged: {error}") from None
    if len(data) == MOST_UNPACKED:
        raise Failed(f"it has more than {MOST_UNPACKED >> 20} MiB when it is unpacked")
    if not data.startswith(MAGIC):
        raise Failed("it is not a recording of iota")
    messages, at = [], len(MAGIC)
    while at + 12 <= len(data):
        time, length = struct.unpack_from("<dI", data, at)
        if at + 12 + length > len(data):
            break
        messages.append((time, data[at + 12 : at + 12 + length]))
        at += 12 + length
    if not messages:
        raise Failed("it has no complete message")
    return messages, unpacker.eof and at == len(data)


def check_version(messages: list[tuple[float, bytes]]) -> None:
    """Raises Failed for messages of another version of the protocol, which the player would misread. The first one, a welcome, names it."""
    first = messages[0][1]
    version = struct.unpack_from("<H", first, 1)[0] if len(first) > 2 and first[0] == WELCOME else None
    if version is None:
        raise Failed("it does not begin with a welcome")
    if version != PROTOCOL_VERSION:
        raise Failed(f"it has version {version} of the protocol, and this iota plays version {PROTOCOL_VERSION}")


def player(file: bytes, title: str) -> str:
    """A self-contained page that plays a file. Raises PageMissingError if the page is not built."""
    folder = page_folder()

    def read(name: str, tag: str) -> str:
        return (folder / name).read_text(encoding="utf-8").replace(f"</{tag}", f"<\\/{tag}")

    return PAGE.format(
        title=html.escape(title),
        style=read("player/player.css", "style"),
        licenses=read("licenses.txt", "script"),
        recording=base64.b64encode(file).decode(),
        script=read("player/player.js", "script"),
    )


def write_stream(path: Path, messages: Iterable[tuple[float, bytes]], title: str) -> None:
    """The file itself, or the page that plays it, by its ending: .iota or .html."""
    file = pack(messages)
    path.write_bytes(file if path.suffix.lower() == ".iota" else player(file, title).encode())
