# SPDX-License-Identifier: Apache-2.0
"""A page that floods a world, reads nothing of it, or speaks WebSocket wrongly, harms no other page; see docs/attacks.md."""

from __future__ import annotations

import base64
import os
import socket
import struct
import subprocess
import sys
import textwrap
import threading
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, suppress
from typing import Any, BinaryIO, NamedTuple
from urllib.parse import urlsplit

import pytest
from amount import TRIES_ALL
from page_client import CONSTANTS, SCHEMA, PageClient, encode
from test_attacks import memory_of
from websockets.exceptions import ConnectionClosed

SECONDS = 5.0 if TRIES_ALL else 0.3
MEMORY = 150  # MB, for whatever one machine sends or does not read
RATE = 120  # steps in a second, of the world below
SCRIPT = """
import sys, iota
system = iota.System()
iota.builder.chain(links=6).realize(system)
world = iota.World(system, dt=1 / 120)
@world.action("note", key="k", on="world")
def note(): pass
world.controls.slider("height", 0.0, 9.0, step=0.5)
print(world.start(port=0), flush=True)
sys.stdin.readline()
world.stop()
"""


class Served(NamedTuple):
    """A world in a process of its own."""

    url: str
    process: int


@pytest.fixture(scope="module")
def served() -> Iterator[Served]:
    with subprocess.Popen(
        [sys.executable, "-c", textwrap.dedent(SCRIPT)], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    ) as process:
        assert process.stdin is not None and process.stdout is not None
        yield Served(process.stdout.readline().strip(), process.pid)
        process.stdin.write("\n")
        process.stdin.flush()
        assert process.wait(60) == 0


def steps_of(page: PageClient, seconds: float) -> float:
    """How many the world takes in a second, by what a page hears."""
    began, first = time.monotonic(), page.last["poses"]["step"]
    time.sleep(seconds)
    step: int = page.last["poses"]["step"]
    return (step - first) / (time.monotonic() - began)


@pytest.fixture(scope="module")
def usual(served: Served) -> float:
    """Steps in a second of the world without a flood."""
    with PageClient(served.url) as page:
        return steps_of(page, SECONDS)


def flood_of(kind: str, page: PageClient) -> list[bytes]:
    """Messages that are sent in turn, over and over."""
    body, far = page.body(0), (2e9, 0.0, 0.0)
    held = {"hold": 1, "body": body, "local_point": (0, 0, 0), "target": (0, 1, 0)}
    stance = {"head": (0, 1, 2), "rotation": (0, 0, 0, 1), "scale": 1.0, "hands": ()}
    pointed: dict[str, Any] = dict.fromkeys(("point", "origin", "direction"), (0, 0, 1))
    pointed |= dict.fromkeys(("buttons", "axes", "joints"), ())
    widget = next(iter(page.entities["widget"].values()))["id"]
    return {
        "grab far away": [encode("grab_start", **(held | {"target": far}))],
        "shake from afar": [
            encode("grab_start", **held),
            *(encode("grab_move", hold=1, target=(x, 0, 0)) for x in (9.9e8, 9.9e8 - 1e4)),
            encode("grab_end", hold=1),
        ],
        "grab beside the body": [encode("grab_start", **(held | {"local_point": (9e8, 0, 0)})), encode("grab_end", hold=1)],
        "single step": [encode("control", command=2, value=0.0), encode("control", command=1, value=0.0)],
        "unknown control": [encode("control", command=99, value=0.0)],
        "select": [encode("select", body=body), encode("select", body=(0, 0))],
        "action": [encode("action", name="note", body=(0, 0), others=())],
        "key": [encode("key", key="k", down=True), encode("key", key="k", down=False)],
        "change": [encode("change", widget=widget, value=value, text="") for value in (1e308, 0.0)],
        "pointer": [encode("pointer", kind=3, body=body, name="mouse", rotation=(0, 0, 0, 1), **pointed)],
        "presence": [encode("presence", stance=stance | {"head": (x, 1, 2)}) for x in (0, 1)],
        "rename": [encode("rename", name=name) for name in "ab"],
        "profile": [encode("profile", on=True), encode("profile", on=False)],
        "ping": [encode("ping", client_time=0.0)],
        "no message": [b"\xff\xff", b""],
    }[kind]  # fmt: skip


KINDS = [
    "grab far away", "shake from afar", "grab beside the body", "single step", "unknown control", "select", "action", "key", "change",
    "pointer", "presence", "rename", "profile", "ping", "no message",
]  # fmt: skip


@pytest.mark.skipif(sys.platform != "linux", reason="reads /proc")
@pytest.mark.parametrize("kind", KINDS)
def test_a_flood_neither_stops_a_world_nor_is_told_to_others(served: Served, usual: float, kind: str) -> None:
    """As many messages as one page can send; one that is sent away for it comes again."""
    sent, stopped = 0, threading.Event()
    with PageClient(served.url) as other:
        before = memory_of(served.process)

        def attack() -> None:
            nonlocal sent
            while not stopped.is_set():
                with suppress(ConnectionClosed, AssertionError), PageClient(served.url, "attacker") as page:
                    messages = flood_of(kind, page)
                    while not stopped.is_set() and not page.closed.is_set():
                        for message in messages:
                            page.send_bytes(message)
                        sent += len(messages)

        thread = threading.Thread(target=attack)
        thread.start()
        try:
            other.wait_for(lambda: sent > 100)
            during = steps_of(other, SECONDS)
            if during < 0.01 * usual:  # another suite may have held both up
                during = steps_of(other, 10 * SECONDS)
        finally:
            stopped.set()
            thread.join()
        print(f"{kind}: {sent} messages, {during / usual:.2f} of its usual speed")
        if kind == "single step":  # at most one more in each round
            assert during < 2.2 * RATE
            other.send("control", command=1, value=0.0)
        else:
            # A world that stands still takes none. The flood and its world share a core with other suites here: alone they
            # take 0.25 to 1 of them, beside two compilers 0.03.
            assert during > 0.01 * usual
        assert [card for card in other.notices if card["level"] == 2] == []
        assert memory_of(served.process) - before < MEMORY
        step = other.last["poses"]["step"]
        other.wait_for(lambda: other.last["poses"]["step"] > step + 20)


@pytest.mark.skipif(sys.platform != "linux", reason="reads /proc")
def test_pages_that_read_nothing_fill_no_memory(served: Served) -> None:
    hello = encode("hello", magic=CONSTANTS["protocol_magic"], version=SCHEMA["version"], world="", role=0, name="deaf")
    pings = frame(encode("ping", client_time=0.0)) * 2000
    with PageClient(served.url) as other, ExitStack() as deaf:
        before, step = memory_of(served.process), other.last["poses"]["step"]
        for _ in range(20):
            page, _ = deaf.enter_context(websocket(served.url))
            page.settimeout(0.2)  # the server reads no more of who does not read
            with suppress(TimeoutError, ConnectionError):
                page.sendall(frame(hello) + pings)
        other.wait_for(lambda: other.last["poses"]["step"] > step + 60)
        assert memory_of(served.process) - before < MEMORY


@pytest.mark.skipif(sys.platform != "linux", reason="reads /proc")
def test_downloads_that_nobody_reads_fill_no_memory(served: Served) -> None:
    parts = urlsplit(served.url)
    with PageClient(served.url) as other, ExitStack() as deaf:
        before, step = memory_of(served.process), other.last["poses"]["step"]
        for _ in range(100):
            one = deaf.enter_context(socket.create_connection((parts.hostname, parts.port), timeout=20))
            one.sendall(f"GET /licenses.txt HTTP/1.1\r\nHost: {parts.netloc}\r\n\r\n".encode() * 20)
        other.wait_for(lambda: other.last["poses"]["step"] > step + 60)
        assert memory_of(served.process) - before < MEMORY


def frame(payload: bytes, *, first: int = 0x82, masked: bool = True, length: int | None = None) -> bytes:
    """A frame of RFC 6455; first: FIN, RSV and the opcode; length: that it claims."""
    size = len(payload) if length is None else length
    mark = 0x80 if masked else 0
    head = bytes([first, mark | size]) if size < 126 else bytes([first, mark | 127]) + struct.pack(">Q", size)
    return head + (bytes(4) if masked else b"") + payload


@contextmanager
def websocket(url: str) -> Iterator[tuple[socket.socket, BinaryIO]]:
    """A connection that has become a WebSocket, for bytes that no client sends; and what it answers."""
    parts = urlsplit(url)
    key = base64.b64encode(os.urandom(16)).decode()
    with socket.create_connection((parts.hostname, parts.port), timeout=20) as raw, raw.makefile("rb") as answer:
        raw.sendall(
            f"GET /ws?{parts.query} HTTP/1.1\r\nHost: {parts.netloc}\r\nOrigin: http://{parts.netloc}\r\nUpgrade: websocket\r\n"
            f"Connection: Upgrade\r\nSec-WebSocket-Key: {key}\r\nSec-WebSocket-Version: 13\r\n\r\n".encode()
        )
        head = b"".join(iter(answer.readline, b"\r\n")).lower()
        assert b"101" in head.splitlines()[0] and b"deflate" not in head
        yield raw, answer


WRONG = {
    "without a mask": (frame(b"\x02", masked=False), 1002),
    "with a reserved bit": (frame(b"\x02", first=0xC2), 1002),
    "of an unknown kind": (frame(b"\x02", first=0x83), 1002),
    "of an unknown control": (frame(b"", first=0x8B), 1002),
    "that goes on with nothing": (frame(b"\x02", first=0x80), 1002),
    "whose control is in parts": (frame(b"", first=0x09), 1002),
    "whose control is long": (frame(bytes(126), first=0x89), 1002),
    "that is too long by one": (frame(bytes(65537)), 1009),
    "that says 2^40 bytes": (frame(b"", length=2**40), 1009),
    "that says 2^63 bytes": (frame(b"", length=2**63), None),  # refused by one of two rules
    "of a text that is none": (frame(b"\xff\xfe", first=0x81), 1007),
    "that closes with half a code": (frame(b"\x03", first=0x88), 1002),
    "that closes with a code of nobody": (frame(struct.pack(">H", 1005), first=0x88), 1002),
}


@pytest.mark.parametrize("name", WRONG)
def test_a_frame_is_refused_by_the_code_of_the_standard(served: Served, name: str) -> None:
    data, code = WRONG[name]
    with PageClient(served.url) as other, websocket(served.url) as (raw, answer):
        raw.sendall(data)
        with suppress(ConnectionError):
            rest = answer.read()  # to its end: the server closes
            if code is not None and rest:
                assert (rest[0], rest[1]) == (0x88, len(rest) - 2) and struct.unpack(">H", rest[2:4]) == (code,)
        step = other.last["poses"]["step"]
        other.wait_for(lambda: other.last["poses"]["step"] > step)


def test_frames_in_thousands_of_parts_have_no_effect(served: Served) -> None:
    parts = frame(b"\2", first=0x02) + frame(b"\2", first=0x00) * 20_000
    with PageClient(served.url) as other, websocket(served.url) as (raw, _):
        with suppress(ConnectionError):
            raw.sendall(parts)
        step = other.last["poses"]["step"]
        other.wait_for(lambda: other.last["poses"]["step"] > step + 20)


REQUESTS = {
    "with a chunk": ("GET / HTTP/1.1", "Transfer-Encoding: chunked", "0\r\n\r\n", 400),
    "with an encoding of nobody": ("GET / HTTP/1.1", "Transfer-Encoding: xchunked", "0\r\n\r\n", 400),
    "with a length and a chunk": ("GET / HTTP/1.1", "Content-Length: 6\r\nTransfer-Encoding: chunked", "0\r\n\r\nX", 400),
    "with two lengths": ("GET / HTTP/1.1", "Content-Length: 0\r\nContent-Length: 26", "", 400),
    "with another one as its body": ("GET /none HTTP/1.1", "Content-Length: 26", "GET /healthz HTTP/1.1\r\n\r\n", 400),
    "with a length below zero": ("GET / HTTP/1.1", "Content-Length: -1", "", 400),
    "with a length of 20 digits": ("GET / HTTP/1.1", "Content-Length: 99999999999999999999", "", 400),
    "with a second host": ("GET / HTTP/1.1", "Host: evil.example", "", 403),
    "with a space before the colon": ("GET / HTTP/1.1", "X : a", "", 400),
    "with a zero byte": ("GET / HTTP/1.1", "X: a\0b", "", 400),
    "with 5000 headers": ("GET / HTTP/1.1", "\r\n".join(f"X{n}: y" for n in range(5000)), "", 431),
    "of HTTP/2": ("PRI * HTTP/2.0", "X: a", "SM\r\n\r\n", 400),
    "for another server": ("GET http://evil.example/ HTTP/1.1", "X: a", "", 400),
    "for a path of 15 000 letters": (f"GET /{'a' * 15000} HTTP/1.1", "X: a", "", 404),
} | {
    f"to {method}": (f"{method} / HTTP/1.1", "X: a", "", 405)
    for method in ("POST", "PUT", "DELETE", "PATCH", "OPTIONS", "TRACE", "CONNECT", "PROPFIND", "get")
}  # fmt: skip


@pytest.mark.parametrize("name", REQUESTS)
def test_a_wrong_request_gets_one_refusal_and_nothing_of_what_it_hides(served: Served, name: str) -> None:
    """A proxy in front may read such a request in another way, and then take the answer to a hidden one for that to another client."""
    line, header, body, status = REQUESTS[name]
    parts = urlsplit(served.url)
    with socket.create_connection((parts.hostname, parts.port), timeout=20) as raw:
        raw.sendall(f"{line}\r\nHost: {parts.netloc}\r\nConnection: close\r\n{header}\r\n\r\n{body}".encode())
        answer = b""
        with suppress(ConnectionError):
            while received := raw.recv(65536):
                answer += received
    assert answer.startswith(f"HTTP/1.1 {status} ".encode())
    assert answer.count(b"\r\n\r\n") == 1, "one answer"


def test_pages_that_come_and_go_hurry_nobody_and_are_told_of_at_most_once_a_frame(served: Served) -> None:
    """Each join and each leave was a message to all others before: 3600 a second."""
    hello = frame(
        encode("hello", magic=CONSTANTS["protocol_magic"], version=SCHEMA["version"], world="", role=0, name="x")
    )
    with PageClient(served.url) as other:
        step, told, began = other.last["poses"]["step"], other.messages["clients"], time.monotonic()
        came = 0
        while time.monotonic() < began + SECONDS:
            with ExitStack() as passing:
                for _ in range(10):
                    raw, _ = passing.enter_context(websocket(served.url))
                    raw.sendall(hello)
                    came += 1
        seconds = time.monotonic() - began
        other.wait_for(lambda: len(other.last["clients"]["clients"]) == 1)
        print(
            f"{came / seconds:.0f} pages a second came and went; {(other.messages['clients'] - told) / seconds:.0f} lists"
        )
        assert other.messages["clients"] - told < 61 * (seconds + 1)
        assert other.last["poses"]["step"] > step and not other.closed.is_set()
