#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Write the golden vectors: protocol/golden/NAME.hex and protocol/golden/vectors.json.

    python3 protocol/make_golden.py

This is on purpose a second encoder that never reads schema.json and shares no code with
tools/generate_protocol.py: each frame is put together by hand with struct.pack, so that a
mistake in the schema or the generator shows as a difference. Run it only after a change
of the protocol, and look at the difference it makes. Floats are exact in 32 bits.
"""

from __future__ import annotations

import json
from pathlib import Path
from struct import pack
from typing import Any

GOLDEN = Path(__file__).resolve().parent / "golden"


def text(value: str) -> bytes:
    data = value.encode()
    return pack("<I", len(data)) + data


def vec3(value: list[float]) -> bytes:
    return pack("<3f", *value)


# name, message, bytes, values
Vector = tuple[str, str, bytes, dict[str, Any]]

CLIENT: list[Vector] = [
    (
        "hello",
        "hello",
        b"\x01" + b"IOTA" + pack("<H", 1) + text("default") + text("Ada \u00fc\u4e16\U0001f517"),
        {"magic": 0x41544F49, "version": 1, "world": "default", "name": "Ada \u00fc\u4e16\U0001f517"},
    ),
    (
        "hello_empty",
        "hello",
        b"\x01IOTA\x01\x00" + bytes(8),
        {"magic": 0x41544F49, "version": 1, "world": "", "name": ""},
    ),
    ("select", "select", b"\x02" + pack("<I", 23), {"body": 23}),
    ("select_none", "select", b"\x02\xff\xff\xff\xff", {"body": 0xFFFFFFFF}),
    (
        "grab_start",
        "grab_start",
        b"\x03" + pack("<II", 7, 12) + vec3([0.5, -0.25, 0.0]) + vec3([1.5, -2.0, 1024.125]),
        {"hold": 7, "body": 12, "local_point": [0.5, -0.25, 0.0], "target": [1.5, -2.0, 1024.125]},
    ),
    (
        "grab_move",
        "grab_move",
        b"\x04" + pack("<I", 7) + vec3([-0.125, 3.0, 0.0625]),
        {"hold": 7, "target": [-0.125, 3.0, 0.0625]},
    ),
    ("grab_end", "grab_end", b"\x05" + pack("<I", 4000000000), {"hold": 4000000000}),
    ("action", "action", b"\x06" + text("break") + pack("<I", 5), {"name": "break", "body": 5}),
    ("control_pause", "control", b"\x07\x00" + pack("<f", 0.0), {"command": 0, "value": 0.0}),
    ("control_speed", "control", b"\x07\x04" + pack("<f", 0.25), {"command": 4, "value": 0.25}),
    ("ping", "ping", b"\x08" + pack("<d", 1234.5678), {"client_time": 1234.5678}),
]

BODIES = [
    {"body": 0, "x": 0, "y": 65535, "z": 32768, "rotation": 0xDFF7FDFF},
    {"body": 65535, "x": 1, "y": 2, "z": 3, "rotation": 0},
]
FAR = [{"body": 70000, "position": [0.0, -4096.5, 8.0], "rotation": 0xC0000001}]
HOLDS = [
    {
        "client": 2,
        "hold": 7,
        "body": 12,
        "point": [0.5, 1.0, 1.5],
        "target": [0.5, 1.25, 1.5],
        "force": 12.5,
    }
]

SERVER: list[Vector] = [
    (
        "welcome",
        "welcome",
        b"\x40" + pack("<H", 1) + text("default") + pack("<I", 3) + pack("<d", 1 / 120),
        {"version": 1, "world": "default", "client": 3, "dt": 1 / 120},
    ),
    ("refused", "refused", b"\x41" + text("no such world"), {"reason": "no such world"}),
    (
        "scene",
        "scene",
        b"\x42" + text("world") + text('{"title":"K\u00e4tte"}'),
        {"key": "world", "json": '{"title":"K\u00e4tte"}'},
    ),
    (
        "structure",
        "structure",
        b"\x43" + pack("<I", 9) + pack("<I", 3) + pack("<6I", 0, 0, 1, 0, 2, 70000),
        {
            "structure_version": 9,
            "articulates": [
                {"body": 0, "articulate": 0},
                {"body": 1, "articulate": 0},
                {"body": 2, "articulate": 70000},
            ],
        },
    ),
    (
        "poses",
        "poses",
        b"\x44"
        + pack("<QdIBB", 0x0001_0002_0003_0004, 16.0625, 9, 1, 0)
        + pack("<5f", 1.0, 0.375, 2.5, -7.25, 0.0009765625)
        + vec3([-1.0, -2.0, -4.0])
        + vec3([1.0, 2.0, 4.0])
        + pack("<I", 2)
        + pack("<HHHHI", 0, 0, 65535, 32768, 0xDFF7FDFF)
        + pack("<HHHHI", 65535, 1, 2, 3, 0)
        + pack("<I", 1)
        + pack("<I3fI", 70000, 0.0, -4096.5, 8.0, 0xC0000001)
        + pack("<I", 1)
        + vec3([0.25, 0.5, -0.75])
        + pack("<fI", 0.0625, 0xFF8000)
        + pack("<I", 1)
        + pack("<III", 2, 7, 12)
        + vec3([0.5, 1.0, 1.5])
        + vec3([0.5, 1.25, 1.5])
        + pack("<f", 12.5),
        {
            "step": 0x0001_0002_0003_0004,
            "time": 16.0625,
            "structure_version": 9,
            "keyframe": True,
            "paused": False,
            "speed": 1.0,
            "step_ms": 0.375,
            "kinetic": 2.5,
            "potential": -7.25,
            "gap": 0.0009765625,
            "box_min": [-1.0, -2.0, -4.0],
            "box_max": [1.0, 2.0, 4.0],
            "bodies": BODIES,
            "far_bodies": FAR,
            "sparks": [{"position": [0.25, 0.5, -0.75], "radius": 0.0625, "color": 0xFF8000}],
            "holds": HOLDS,
        },
    ),
    (
        "poses_nothing_moved",
        "poses",
        b"\x44" + pack("<QdIBB", 5, 0.5, 1, 0, 1) + bytes(5 * 4) + bytes(6 * 4) + bytes(4 * 4),
        {
            "step": 5,
            "time": 0.5,
            "structure_version": 1,
            "keyframe": False,
            "paused": True,
            "speed": 0.0,
            "step_ms": 0.0,
            "kinetic": 0.0,
            "potential": 0.0,
            "gap": 0.0,
            "box_min": [0.0, 0.0, 0.0],
            "box_max": [0.0, 0.0, 0.0],
            "bodies": [],
            "far_bodies": [],
            "sparks": [],
            "holds": [],
        },
    ),
    (
        "notice",
        "notice",
        b"\x45\x02" + text("chain.py") + text("ZeroDivisionError") + text(""),
        {"level": 2, "title": "chain.py", "text": "ZeroDivisionError", "hint": ""},
    ),
    (
        "effect",
        "effect",
        b"\x46" + text("break") + vec3([0.0, 1.5, -0.5]),
        {"kind": "break", "position": [0.0, 1.5, -0.5]},
    ),
    (
        "pong",
        "pong",
        b"\x47" + pack("<dQ", 1234.5678, 600),
        {"client_time": 1234.5678, "step": 600},
    ),
    (
        "clients",
        "clients",
        b"\x48" + pack("<I", 2) + pack("<I", 1) + text("Ada") + pack("<II", 4, 2) + text("") + b"\xff" * 4,
        {
            "clients": [
                {"client": 1, "name": "Ada", "selected": 4},
                {"client": 2, "name": "", "selected": 0xFFFFFFFF},
            ]
        },
    ),
]

NAN, INFINITY = float("nan"), float("inf")

# name, who sends it, bytes, a part of the reason that every decoder gives
BAD: list[tuple[str, str, bytes, str]] = [
    ("bad_empty", "client", b"", "the frame is empty"),
    ("bad_type", "client", b"\x09", "has the type 9"),
    ("bad_direction", "client", b"\x40\x01\x00", "has the type 64"),
    ("bad_short_select", "client", b"\x02\x01\x00\x00", "select.body ends early"),
    ("bad_long_select", "client", b"\x02\x01\x00\x00\x00\x00", "the frame has 1 bytes too many"),
    ("bad_nan", "client", b"\x04" + pack("<I3f", 1, 0.0, NAN, 0.0), "grab_move.target is not a finite number"),
    ("bad_infinity", "client", b"\x07\x04" + pack("<f", -INFINITY), "control.value is not a finite number"),
    ("bad_nan_double", "client", b"\x08" + pack("<d", NAN), "ping.client_time is not a finite number"),
    ("bad_command", "client", b"\x07\x05" + bytes(4), "control.command has no meaning for the value 5"),
    ("bad_string_length", "client", b"\x06" + pack("<I", 100) + b"break", "action.name ends early"),
    ("bad_string_huge", "client", b"\x06\xff\xff\xff\xff" + b"break", "action.name has 4294967295 entries"),
    ("bad_string_limit", "client", b"\x06" + text("a" * 129) + bytes(4), "action.name has 129 entries"),
    ("bad_utf8", "client", b"\x06" + pack("<I", 2) + b"\xc0\x80" + bytes(4), "action.name is not UTF-8"),
    ("bad_surrogate", "client", b"\x06" + pack("<I", 3) + b"\xed\xa0\x80" + bytes(4), "action.name is not UTF-8"),
    ("bad_count", "server", b"\x43" + pack("<II", 1, 1000000) + bytes(8), "structure.articulates ends early"),
    ("bad_count_huge", "server", b"\x43" + pack("<II", 1, 0xFFFFFFFF), "structure.articulates has 4294967295"),
    ("bad_bool", "server", b"\x44" + pack("<QdIBB", 5, 0.5, 1, 2, 1) + bytes(60), "poses.keyframe is neither 0 nor 1"),
    ("bad_poses_short", "server", b"\x44" + pack("<QdIBB", 5, 0.5, 1, 0, 1) + bytes(59), "poses.holds ends early"),
]


def main() -> None:
    GOLDEN.mkdir(exist_ok=True)
    good, bad = [], []
    for sender, vectors in (("client", CLIENT), ("server", SERVER)):
        for name, message, data, values in vectors:
            (GOLDEN / f"{name}.hex").write_text(data.hex() + "\n")
            good.append({"name": name, "sender": sender, "message": message, "values": values})
    for name, sender, data, error in BAD:
        (GOLDEN / f"{name}.hex").write_text(data.hex() + "\n")
        bad.append({"name": name, "sender": sender, "error": error})
    vectors_json = json.dumps({"good": good, "bad": bad}, indent=1, ensure_ascii=True)
    (GOLDEN / "vectors.json").write_text(vectors_json + "\n")


if __name__ == "__main__":
    main()
