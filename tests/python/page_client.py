# SPDX-License-Identifier: Apache-2.0
"""A page without a browser: speaks the protocol as the files in protocol describe it."""

from __future__ import annotations

import json
import ssl
import struct
import threading
import time
from collections import Counter
from collections.abc import Callable
from contextlib import ExitStack
from itertools import chain
from pathlib import Path
from typing import Any
from urllib.parse import parse_qs, urlsplit

from waiting import PATIENCE
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import connect

PROTOCOL = Path(__file__).resolve().parents[2] / "protocol"
SCHEMA = json.loads((PROTOCOL / "schema.json").read_text())
ENTITIES = {path.stem: json.loads(path.read_text()) for path in (PROTOCOL / "entities").glob("*.json")}
STRUCTS = {entry["name"]: entry["fields"] for entry in SCHEMA["structs"]}
TO_SERVER = {entry["name"]: entry for entry in SCHEMA["client_messages"]}
TO_CLIENT = {entry["type"]: entry for entry in SCHEMA["server_messages"]}
CONSTANTS = {entry["name"]: entry["value"] for entry in SCHEMA["constants"]}
NUMBERS = {"u8": "B", "u16": "H", "u32": "I", "u64": "Q", "f32": "f", "f64": "d", "vec3": "3f", "quat": "4f"}
NUMBERS |= {"bool": "?", "id": "2I"}
GROUPS = ("vec3", "quat", "id")  # come as tuples
NOTHING = (0, 0)  # in place of an id: slot and generation


def encode(name: str, /, **values: Any) -> bytes:
    """One message to the server."""
    message = TO_SERVER[name]
    if name == "grab_start":
        values.setdefault("pointer", "mouse")
    return bytes([message["type"]]) + fields(name, message["fields"], dict(values))


def fields(name: str, described: list[dict[str, Any]], values: dict[str, Any]) -> bytes:
    """Those of a message or of a struct."""
    out = b""
    for field in described:
        kind = field["type"]
        is_array = isinstance(kind, dict) and "array" in kind
        value = values.pop(field["name"], ()) if is_array else values.pop(field["name"])
        if isinstance(kind, dict) and "struct" in kind:
            out += fields(kind["struct"], STRUCTS[kind["struct"]], dict(value))
        elif is_array:
            numbers = chain.from_iterable(value) if kind["array"] in GROUPS else value
            out += struct.pack("<I" + NUMBERS[kind["array"]] * len(value), len(value), *numbers)
        elif kind in ("string", "bytes"):
            text = value.encode() if kind == "string" else value
            out += struct.pack("<I", len(text)) + text
        else:
            out += struct.pack("<" + NUMBERS[kind], *(value if kind in GROUPS else (value,)))
    assert not values, f"{name} has no {', '.join(values)}"
    return out


class Reader:
    """Reads fields off a frame."""

    def __init__(self, data: bytes) -> None:
        self.data, self.at = data, 0

    def field(self, kind: Any) -> Any:
        if isinstance(kind, dict) and "array" in kind:
            return [self.field(kind["array"]) for _ in range(self.field("u32"))]
        if isinstance(kind, dict):
            return self.field(kind["struct"])
        if kind in STRUCTS:
            return self.fields(STRUCTS[kind])
        if kind in ("string", "bytes"):
            size = self.field("u32")
            self.at += size
            data = self.data[self.at - size : self.at]
            return data.decode() if kind == "string" else data
        values = struct.unpack_from("<" + NUMBERS[kind], self.data, self.at)
        self.at += struct.calcsize("<" + NUMBERS[kind])
        return values if kind in GROUPS else values[0]

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


def records(kind: str, data: bytes) -> list[dict[str, Any]]:
    """The entities of one kind whose records these are."""
    reader, out = Reader(data), []
    while reader.at < len(data):
        out.append({"id": reader.field("id"), **reader.fields(ENTITIES[kind]["fields"])})
    return out


class PageClient:
    """Connects, keeps what the server last said of each message and entity, and sends what a user does.

    entities: by kind and slot. told, pose_frames: how many records and frames came so far; messages: how many of each name.
    places: of bodies, by slot."""

    def __init__(self, url: str, name: str = "test", role: int = 0, trust: ssl.SSLContext | None = None) -> None:
        """trust: for https, whose certificates count."""
        parts = urlsplit(url)
        address = f"{parts.scheme.replace('http', 'ws')}://{parts.netloc}/ws?{parts.query}"
        origin = f"{parts.scheme}://{parts.netloc}"
        self._open = ExitStack()
        self.socket = self._open.enter_context(
            connect(address, origin=origin, max_size=None, proxy=None, ssl=trust, open_timeout=PATIENCE)
        )
        self.entities: dict[str, dict[int, dict[str, Any]]] = {kind: {} for kind in ENTITIES}
        self.told = self.pose_frames = 0
        self.places: dict[int, tuple[float, ...]] = {}
        self.last: dict[str, dict[str, Any]] = {}
        self.messages: Counter[str] = Counter()
        self.notices: list[dict[str, Any]] = []
        self.effects: list[dict[str, Any]] = []
        self.closed = threading.Event()
        self.why_closed = ""
        self._changed = threading.Condition()
        world = parse_qs(parts.query).get("world", [""])[0]
        magic, version = CONSTANTS["protocol_magic"], SCHEMA["version"]
        self.send("hello", magic=magic, version=version, world=world, role=role, name=name)
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

    def single_step(self) -> None:
        """Pauses the world, and makes one step of it."""
        before = self.last["poses"]["step"]
        self.send("control", command=2, value=0)
        self.wait_for(lambda: self.last["poses"]["step"] > before)

    def send_bytes(self, data: bytes) -> None:
        self.socket.send(data)

    def wait_for(self, condition: Callable[[], Any], seconds: float = PATIENCE) -> Any:
        """Until a condition on what was received holds; its value."""
        end = time.monotonic() + seconds
        with self._changed:
            while not (value := condition()):
                assert time.monotonic() < end, f"waited {seconds} s in vain"
                self._changed.wait(0.02)
        return value

    @property
    def articulates(self) -> dict[int, int]:
        """Of each body, by slot."""
        return {slot: entity["articulate"] for slot, entity in self.entities["membership"].items()}

    def parts(self) -> int:
        """How many articulates the page knows of."""
        return len(set(self.articulates.values()))

    @property
    def bodies(self) -> dict[int, dict[str, Any]]:
        """Without obstacles, which are of no articulate."""
        return {slot: entity for slot, entity in self.entities["body"].items() if slot in self.articulates}

    def body(self, slot: int) -> tuple[int, int]:
        """Id of the body in a slot."""
        identity: tuple[int, int] = self.wait_for(lambda: self.entities["body"].get(slot))["id"]
        return identity

    def visual_of(self, slot: int) -> dict[str, Any]:
        """How the body in a slot is drawn."""
        return self.entities["visual"][self.entities["body"][slot]["visual"]]

    def _read(self) -> None:
        try:
            while True:
                name, values = decode(self.socket.recv(decode=False))
                with self._changed:
                    self._take(name, values)
                    self._changed.notify_all()
        except ConnectionClosed as end:
            self.why_closed = end.rcvd.reason if end.rcvd else "without a reason"
            self.closed.set()

    def _take(self, name: str, values: dict[str, Any]) -> None:
        self.last[name] = values
        self.messages[name] += 1
        if name == "entities_set":
            for entity in records(values["kind"], values["records"]):
                self.entities[values["kind"]][entity["id"][0]] = entity
                self.told += 1
        elif name == "entities_destroyed":
            for identity in values["ids"]:
                # Of an earlier generation, or none: its slot was used again, or first, and emptied between two messages.
                known = self.entities[values["kind"]].pop(identity[0], None)
                assert known is None or known["id"][1] <= identity[1], (values["kind"], identity, known)
        elif name == "notice":
            self.notices.append(values)
        elif name == "effect":
            self.effects.append(values)
        elif name == "poses":
            self.pose_frames += 1
            low, high = values["box_min"], values["box_max"]
            for body in values["far_bodies"]:
                self.places[body["body"]] = body["position"]
            for body in values["bodies"]:
                raw = (body["x"], body["y"], body["z"])
                place = (a + n / 65535 * (b - a) for a, b, n in zip(low, high, raw, strict=True))
                self.places[body["body"]] = tuple(place)
