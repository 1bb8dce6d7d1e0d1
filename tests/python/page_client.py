# SPDX-License-Identifier: Apache-2.0
"""A page without a browser: speaks the protocol as protocol/schema.json describes it."""

from __future__ import annotations

import json
import struct
import threading
import time
from collections.abc import Callable
from contextlib import ExitStack
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

from websockets.exceptions import ConnectionClosed
from websockets.sync.client import connect

SCHEMA = json.loads((Path(__file__).resolve().parents[2] / "protocol" / "schema.json").read_text())
STRUCTS = {entry["name"]: entry["fields"] for entry in SCHEMA["structs"]}
TO_SERVER = {entry["name"]: entry for entry in SCHEMA["client_messages"]}
TO_CLIENT = {entry["type"]: entry for entry in SCHEMA["server_messages"]}
CONSTANTS = {entry["name"]: entry["value"] for entry in SCHEMA["constants"]}
NUMBERS = {"u8": "B", "bool": "B", "u16": "H", "u32": "I", "u64": "Q", "f32": "f", "f64": "d", "vec3": "3f"}


def encode(name: str, /, **values: Any) -> bytes:
    """One message to the server."""
    message = TO_SERVER[name]
    out = bytes([message["type"]])
    for field in message["fields"]:
        value, kind = values.pop(field["name"]), field["type"]
        if kind == "string":
            text = value.encode()
            out += struct.pack("<I", len(text)) + text
        else:
            out += struct.pack("<" + NUMBERS[kind], *(value if kind == "vec3" else (value,)))
    assert not values, f"{name} has no {', '.join(values)}"
    return out


class Reader:
    """Reads fields off a frame."""

    def __init__(self, data: bytes) -> None:
        self.data, self.at = data, 0

    def field(self, kind: Any) -> Any:
        if isinstance(kind, dict):
            return [self.fields(STRUCTS[kind["array"]]) for _ in range(self.field("u32"))]
        if kind == "string":
            size = self.field("u32")
            self.at += size
            return self.data[self.at - size : self.at].decode()
        values = struct.unpack_from("<" + NUMBERS[kind], self.data, self.at)
        self.at += struct.calcsize("<" + NUMBERS[kind])
        return values if kind == "vec3" else values[0]

    def fields(self, fields: list[dict[str, Any]]) -> dict[str, Any]:
        return {field["name"]: self.field(field["type"]) for field in fields}


def decode(data: bytes) -> tuple[str, dict[str, Any]]:
    """One message of the server: its name and fields."""
    message = TO_CLIENT[data[0]]
    reader = Reader(data)
    reader.at = 1
    values = reader.fields(message["fields"])
    assert reader.at == len(data), f"{message['name']} has bytes left"
    return message["name"], values


class PageClient:
    """Connects, keeps what the server last said of each kind, and sends what a user does."""

    def __init__(self, url: str, name: str = "test") -> None:
        parts = urlsplit(url)
        address = f"ws://{parts.netloc}/ws?{parts.query}"
        origin = f"http://{parts.netloc}"
        self._open = ExitStack()
        self.socket = self._open.enter_context(connect(address, origin=origin, max_size=None, proxy=None))
        self.scene: dict[str, Any] = {}
        self.articulates: dict[int, int] = {}
        self.places: dict[int, tuple[float, ...]] = {}
        self.last: dict[str, dict[str, Any]] = {}
        self.notices: list[dict[str, Any]] = []
        self.effects: list[dict[str, Any]] = []
        self.closed = threading.Event()
        self._changed = threading.Condition()
        self.send("hello", magic=CONSTANTS["protocol_magic"], version=SCHEMA["version"], world="", name=name)
        self._reader = threading.Thread(target=self._read, daemon=True)
        self._reader.start()
        self.wait_for(lambda: "welcome" in self.last and "poses" in self.last)
        self.id = self.last["welcome"]["client"]

    def __enter__(self) -> PageClient:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        self._open.close()
        self._reader.join(5)

    def send(self, message: str, /, **values: Any) -> None:
        self.socket.send(encode(message, **values))

    def send_bytes(self, data: bytes) -> None:
        self.socket.send(data)

    def wait_for(self, condition: Callable[[], Any], seconds: float = 60.0) -> Any:
        """Until a condition on what was received holds; its value. `seconds` is for machines that are busy."""
        end = time.monotonic() + seconds
        with self._changed:
            while not (value := condition()):
                assert time.monotonic() < end, f"waited {seconds} s in vain"
                self._changed.wait(0.02)
        return value

    def parts(self) -> int:
        """How many articulates the page knows of."""
        return len(set(self.articulates.values()))

    def _read(self) -> None:
        try:
            while True:
                name, values = decode(self.socket.recv(decode=False))
                with self._changed:
                    self._take(name, values)
                    self._changed.notify_all()
        except ConnectionClosed:
            self.closed.set()

    def _take(self, name: str, values: dict[str, Any]) -> None:
        self.last[name] = values
        if name == "scene":
            self.scene[values["key"]] = json.loads(values["json"])
        elif name == "structure":
            self.articulates = {entry["body"]: entry["articulate"] for entry in values["articulates"]}
        elif name == "notice":
            self.notices.append(values)
        elif name == "effect":
            self.effects.append(values)
        elif name == "poses":
            low, high = values["box_min"], values["box_max"]
            for body in values["bodies"]:
                raw = (body["x"], body["y"], body["z"])
                place = (a + n / 65535 * (b - a) for a, b, n in zip(low, high, raw, strict=True))
                self.places[body["body"]] = tuple(place)
