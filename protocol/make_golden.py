#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Write the golden vectors: protocol/golden/NAME.hex and protocol/golden/vectors.json.

    python3 protocol/make_golden.py

This is deliberately an independent encoder that does not read the schema and shares no code with
tools/generate_protocol.py: each frame is written by hand with struct.pack, so that an error in the schema or the
generator shows as a difference. Run it only after a change of the protocol, and check the difference. Floats are exact
in 32 bits.
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


def quat(value: list[float]) -> bytes:
    return pack("<4f", *value)


def array(kind: str, values: list[Any]) -> bytes:
    return pack(f"<I{len(values)}{kind}", len(values), *values)


def identity(slot: int, generation: int) -> bytes:
    return pack("<II", slot, generation)


NOTHING = {"slot": 0, "generation": 0}
NO_COLOR = 0xFFFFFFFF


STANCE = {"head": [0.5, 1.5, 2.0], "rotation": [0.5, 0.5, 0.5, 0.5], "scale": 0.25, "hands": [1.0, 2.0, 3.0]}
STANCE_BYTES = vec3([0.5, 1.5, 2.0]) + quat([0.5, 0.5, 0.5, 0.5]) + pack("<f", 0.25) + array("f", [1, 2, 3])

# name, message, bytes, values
Vector = tuple[str, str, bytes, dict[str, Any]]

CLIENT: list[Vector] = [
    (
        "hello",
        "hello",
        b"\x01" + b"IOTA" + pack("<H", 3) + text("default") + b"\x01" + text("Ada \u00fc\u4e16\U0001f517"),
        {"magic": 0x41544F49, "version": 3, "world": "default", "role": 1, "name": "Ada \u00fc\u4e16\U0001f517"},
    ),
    (
        "hello_empty",
        "hello",
        b"\x01IOTA\x03\x00" + bytes(9),
        {"magic": 0x41544F49, "version": 3, "world": "", "role": 0, "name": ""},
    ),
    ("select", "select", b"\x02" + identity(70000, 3), {"body": {"slot": 70000, "generation": 3}}),
    ("select_none", "select", b"\x02" + bytes(8), {"body": NOTHING}),
    (
        "grab_start",
        "grab_start",
        b"\x03" + pack("<I", 7) + identity(12, 1) + vec3([0.5, -0.25, 0.0]) + vec3([1.5, -2.0, 1024.125]) + text("left"),
        {
            "hold": 7,
            "body": {"slot": 12, "generation": 1},
            "local_point": [0.5, -0.25, 0.0],
            "target": [1.5, -2.0, 1024.125],
            "pointer": "left",
        },
    ),
    (
        "grab_move",
        "grab_move",
        b"\x04" + pack("<I", 7) + vec3([-0.125, 3.0, 0.0625]),
        {"hold": 7, "target": [-0.125, 3.0, 0.0625]},
    ),
    ("grab_end", "grab_end", b"\x05" + pack("<I", 4000000000), {"hold": 4000000000}),
    (
        "action",
        "action",
        b"\x06" + text("break") + identity(5, 2) + pack("<I", 2) + identity(6, 1) + identity(70000, 3),
        {
            "name": "break",
            "body": {"slot": 5, "generation": 2},
            "others": [{"slot": 6, "generation": 1}, {"slot": 70000, "generation": 3}],
        },
    ),
    ("control_pause", "control", b"\x07\x00" + pack("<f", 0.0), {"command": 0, "value": 0.0}),
    ("control_speed", "control", b"\x07\x04" + pack("<f", 0.25), {"command": 4, "value": 0.25}),
    ("ping", "ping", b"\x08" + pack("<d", 1234.5678), {"client_time": 1234.5678}),
    (
        "change",
        "change",
        b"\x09" + identity(3, 1) + pack("<d", 9.81) + text("Ada"),
        {"widget": {"slot": 3, "generation": 1}, "value": 9.81, "text": "Ada"},
    ),
    (
        "pointer",
        "pointer",
        b"\x0a\x01"
        + identity(12, 1)
        + text("mouse")
        + vec3([0.5, 1, 2])
        + vec3([0, 1.5, 4])
        + vec3([0, 0, -1])
        + quat([0, 0, 0, 1])
        + bytes(12),
        {
            "kind": 1,
            "body": {"slot": 12, "generation": 1},
            "name": "mouse",
            "point": [0.5, 1.0, 2.0],
            "origin": [0.0, 1.5, 4.0],
            "direction": [0.0, 0.0, -1.0],
            "rotation": [0.0, 0.0, 0.0, 1.0],
            "buttons": [],
            "axes": [],
            "joints": [],
        },
    ),
    (
        "pointer_move",
        "pointer",
        b"\x0a\x03"
        + bytes(8)
        + text("left hand")
        + vec3([0.5, 1, 2])
        + vec3([0, 1.5, 4])
        + vec3([0, 0, -1])
        + quat([0.5, 0.5, 0.5, 0.5])
        + array("f", [0.25, 1])
        + array("f", [-1, 0.5])
        + array("f", [1, 2, 3]),
        {
            "kind": 3,
            "body": NOTHING,
            "name": "left hand",
            "point": [0.5, 1.0, 2.0],
            "origin": [0.0, 1.5, 4.0],
            "direction": [0.0, 0.0, -1.0],
            "rotation": [0.5, 0.5, 0.5, 0.5],
            "buttons": [0.25, 1.0],
            "axes": [-1.0, 0.5],
            "joints": [1.0, 2.0, 3.0],
        },
    ),
    ("key", "key", b"\x0b" + text("ArrowUp") + b"\x01", {"key": "ArrowUp", "down": True}),
    (
        "picture",
        "picture",
        b"\x0c" + pack("<I", 7) + b"\x01" + pack("<I", 3) + b"PNG",
        {"request": 7, "is_last": True, "data": [80, 78, 71]},
    ),
    ("presence", "presence", b"\x0d" + STANCE_BYTES, {"stance": STANCE}),
    ("profile", "profile", b"\x0e\x01", {"on": True}),
    ("send_away", "send_away", b"\x0f\x02\x01\x00\x00", {"client": 258}),
    ("rename", "rename", b"\x10" + text("Ada"), {"name": "Ada"}),
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
        b"\x40" + pack("<H", 3) + text("default") + pack("<I", 3),
        {"version": 3, "world": "default", "client": 3},
    ),
    ("refused", "refused", b"\x41" + text("no such world"), {"reason": "no such world"}),
    (
        "poses",
        "poses",
        b"\x44"
        + pack("<QdIB", 0x0001_0002_0003_0004, 16.0625, 9, 1)
        + pack("<3f", 2.5, -7.25, 0.0009765625)
        + vec3([-1.0, -2.0, -4.0])
        + vec3([1.0, 2.0, 4.0])
        + pack("<I", 2)
        + pack("<HHHHI", 0, 0, 65535, 32768, 0xDFF7FDFF)
        + pack("<HHHHI", 65535, 1, 2, 3, 0)
        + pack("<I", 1)
        + pack("<I3fI", 70000, 0.0, -4096.5, 8.0, 0xC0000001)
        + pack("<I", 1)
        + vec3([0.25, 0.5, -0.75])
        + pack("<fII", 0.0625, 0xFF8000, 4)
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
            "kinetic": 2.5,
            "potential": -7.25,
            "gap": 0.0009765625,
            "box_min": [-1.0, -2.0, -4.0],
            "box_max": [1.0, 2.0, 4.0],
            "bodies": BODIES,
            "far_bodies": FAR,
            "sparks": [{"position": [0.25, 0.5, -0.75], "radius": 0.0625, "color": 0xFF8000, "set": 4}],
            "holds": HOLDS,
        },
    ),
    (
        "poses_nothing_moved",
        "poses",
        b"\x44" + pack("<QdIB", 5, 0.5, 1, 0) + bytes(3 * 4) + bytes(6 * 4) + bytes(4 * 4),
        {
            "step": 5,
            "time": 0.5,
            "structure_version": 1,
            "keyframe": False,
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
        b"\x45\x02" + text("chain.py") + text("ZeroDivisionError") + text("") + text("run") + pack("<f", 2.5) + b"\x04",
        {
            "level": 2,
            "title": "chain.py",
            "text": "ZeroDivisionError",
            "hint": "",
            "id": "run",
            "seconds": 2.5,
            "place": 4,
        },
    ),
    (
        "effect",
        "effect",
        b"\x46" + text("break") + vec3([0.0, 1.5, -0.5]) + pack("<f", 0.5),
        {"kind": "break", "position": [0.0, 1.5, -0.5], "volume": 0.5},
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
        b"\x48"
        + pack("<I", 2)
        + pack("<I", 1)
        + text("Ada")
        + identity(4, 1)
        + b"\0"
        + pack("<I", 2)
        + text("")
        + bytes(8)
        + b"\1",
        {
            "clients": [
                {"client": 1, "name": "Ada", "selected": {"slot": 4, "generation": 1}, "role": 0},
                {"client": 2, "name": "", "selected": NOTHING, "role": 1},
            ]
        },
    ),
    (
        "entities_set",
        "entities_set",
        b"\x49" + text("body") + pack("<I", 5) + b"\x01\x02\x03\x04\x05",
        {"kind": "body", "records": [1, 2, 3, 4, 5]},
    ),
    (
        "entities_destroyed",
        "entities_destroyed",
        b"\x4a" + text("tie") + pack("<I", 2) + identity(7, 1) + identity(70000, 9),
        {"kind": "tie", "ids": [{"slot": 7, "generation": 1}, {"slot": 70000, "generation": 9}]},
    ),
    (
        "world_settings",
        "world_settings",
        b"\x4b"
        + text("K\u00e4tte")
        + pack("<I", 2)
        + text("rope")
        + text("chain")
        + text("rope")
        + b"\x01"
        + vec3([2.5, 1.5, 3.5])
        + vec3([0.0, 1.25, 0.0])
        + b"\x01"
        + pack("<f", -0.5)
        + pack("<I", 1)
        + text("modules/halo.js"),
        {
            "title": "K\u00e4tte",
            "styles": ["rope", "chain"],
            "style": "rope",
            "has_camera": True,
            "camera_position": [2.5, 1.5, 3.5],
            "camera_target": [0.0, 1.25, 0.0],
            "has_ground": True,
            "ground": -0.5,
            "modules": ["modules/halo.js"],
        },
    ),
    (
        "world_state",
        "world_state",
        b"\x4c\x01"
        + pack("<ffd", 0.5, 0.375, 1 / 120)
        + pack("<I", 1)
        + text("forces")
        + pack("<f", 0.25)
        + pack("<fI", 4.0, 1)
        + text("full")
        + pack("<IIII", 3, 2, 7, 9)
        + pack("<I", 1)
        + text("tower: full to 1/4"),
        {
            "paused": True,
            "speed": 0.5,
            "step_ms": 0.375,
            "dt": 1 / 120,
            "costs": [{"part": "forces", "ms": 0.25}],
            "budget_ms": 4.0,
            "levels": [{"name": "full", "count": 3, "bodies": [7, 9]}],
            "changes": ["tower: full to 1/4"],
        },
    ),
    (
        "actions",
        "actions",
        b"\x4d" + pack("<I", 1) + text("push") + text("p") + text("push it") + text("") + b"\x01\x02",
        {"actions": [{"name": "push", "key": "p", "label": "push it", "help": "", "on": 1, "button": 2}]},
    ),
    (
        "listens",
        "listens",
        b"\x4e\x01\x00\x01" + pack("<I", 2) + text("k") + text(" "),
        {"clicks": True, "hovers": False, "moves": True, "keys": ["k", " "]},
    ),
    ("ask_picture", "ask_picture", b"\x4f" + pack("<I", 7), {"request": 7}),
    (
        "people",
        "people",
        b"\x50" + pack("<II", 1, 2) + STANCE_BYTES,
        {"people": [{"client": 2, "stance": STANCE}]},
    ),
    (
        "pulse",
        "pulse",
        b"\x51" + text("left") + pack("<2f", 0.5, 0.125),
        {"hand": "left", "strength": 0.5, "seconds": 0.125},
    ),
]

PART = {
    "style": "*",
    "shape": {"kind": "torus", "sizes": [0.5, 0.125], "vertices": [], "triangles": []},
    "offset": [0.0, 0.25, 0.0],
    "rotation": [0.5, 0.5, 0.5, 0.5],
    "turn": 1.5,
    "material": "brass",
    "color": NO_COLOR,
}
MESH = {
    "style": "chain",
    "shape": {
        "kind": "mesh",
        "sizes": [],
        "vertices": [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0],
        "triangles": [0, 1, 2],
    },
    "offset": [0.0, 0.0, 0.0],
    "rotation": [0.0, 0.0, 0.0, 1.0],
    "turn": 0.0,
    "material": "paint",
    "color": 0xFF8000,
}


def part(value: dict[str, Any]) -> bytes:
    shape = value["shape"]
    return (
        text(value["style"])
        + text(shape["kind"])
        + array("f", shape["sizes"])
        + array("f", shape["vertices"])
        + array("I", shape["triangles"])
        + vec3(value["offset"])
        + quat(value["rotation"])
        + pack("<f", value["turn"])
        + text(value["material"])
        + pack("<I", value["color"])
    )


ID = {"slot": 70000, "generation": 3}
A = {"body": 12, "point": [0.5, 0.0, -0.25]}
B = {"body": 0xFFFFFFFF, "point": [0.0, 2.0, 0.0]}


def anchor(value: dict[str, Any]) -> bytes:
    return pack("<I", value["body"]) + vec3(value["point"])


# kind, its record, values
ENTITIES: list[tuple[str, bytes, dict[str, Any]]] = [
    (
        "visual",
        text("link") + pack("<I", 2) + part(PART) + part(MESH),
        {"name": "link", "parts": [PART, MESH]},
    ),
    (
        "body",
        b"\x02" + pack("<I", 9) + b"\x01" + pack("<f", 0.125) + pack("<I", 0xFF6347) + text("left \u00e4rm"),
        {"kind": 2, "visual": 9, "odd": True, "length": 0.125, "color": 0xFF6347, "name": "left \u00e4rm"},
    ),
    ("membership", pack("<I", 40000), {"articulate": 40000}),
    (
        "tie",
        b"\x01" + pack("<If", 3, 0.75) + anchor(A) + anchor(B),
        {"kind": 1, "visual": 3, "length": 0.75, "a": A, "b": B},
    ),
    ("nail", anchor(A), {"at": A}),
    ("particle_set", b"\x01" + pack("<I", 1000), {"active": True, "capacity": 1000}),
    (
        "label",
        anchor(A) + anchor(B) + vec3([0.0, 0.5, 0.0]) + text("K\u00e4tte") + pack("<fI", 0.125, 0xFF8000),
        {"a": A, "b": B, "offset": [0.0, 0.5, 0.0], "text": "K\u00e4tte", "height": 0.125, "color": 0xFF8000},
    ),
    (
        "line",
        array("I", [12, 0xFFFFFFFF]) + array("f", [0, 1, 2, 3, 4, 5]) + pack("<fBI", 0.25, 1, NO_COLOR),
        {
            "bodies": [12, 0xFFFFFFFF],
            "points": [0.0, 1.0, 2.0, 3.0, 4.0, 5.0],
            "radius": 0.25,
            "closed": True,
            "color": NO_COLOR,
        },
    ),
    (
        "arrow",
        anchor(A) + anchor(B) + vec3([1.0, 0.0, -0.5]) + pack("<fI", 0.0, 0xFF8000),
        {"a": A, "b": B, "vector": [1.0, 0.0, -0.5], "radius": 0.0, "color": 0xFF8000},
    ),
    (
        "axes",
        anchor(A) + quat([0.5, 0.5, 0.5, 0.5]) + pack("<f", 0.75),
        {"at": A, "rotation": [0.5, 0.5, 0.5, 0.5], "length": 0.75},
    ),
    (
        "trace",
        anchor(A) + pack("<fIfI", 2.5, 1000, 0.0, NO_COLOR),
        {"at": A, "seconds": 2.5, "capacity": 1000, "radius": 0.0, "color": NO_COLOR},
    ),
    (
        "point_cloud",
        anchor(B) + array("f", [0, 1, 2, 3, 4, 5]) + array("f", [0.5]) + array("I", [0xFF8000, 0x80FF]),
        {"at": B, "points": [0.0, 1.0, 2.0, 3.0, 4.0, 5.0], "radii": [0.5], "colors": [0xFF8000, 0x80FF]},
    ),
    ("marker", pack("<I", 12) + part(PART), {"body": 12, "part": PART}),
    (
        "widget",
        b"\x01"
        + text("gravity")
        + text("")
        + text("m/s\u00b2")
        + pack("<4d", 9.81, 0, 20, 0.5)
        + text("")
        + pack("<I", 1)
        + text("one")
        + b"\x01"
        + pack("<I", 3),
        {
            "kind": 1,
            "label": "gravity",
            "help": "",
            "unit": "m/s\u00b2",
            "value": 9.81,
            "minimum": 0.0,
            "maximum": 20.0,
            "step": 0.5,
            "text": "",
            "options": ["one"],
            "enabled": True,
            "client": 3,
        },
    ),
    (
        "plot",
        text("energy")
        + text("J")
        + pack("<fI", 10, 2)
        + text("kinetic")
        + text("potential")
        + array("I", [1, 2])
        + array("f", [0.5, 1])
        + array("f", [1, 2, 3, 4]),
        {
            "label": "energy",
            "unit": "J",
            "seconds": 10.0,
            "curves": ["kinetic", "potential"],
            "colors": [1, 2],
            "times": [0.5, 1.0],
            "values": [1.0, 2.0, 3.0, 4.0],
        },
    ),
    (
        "surface",
        anchor(B)
        + array("I", [12, 0xFFFFFFFF, 0x80000001])
        + array("f", [0, 0, 0, 1, 0, 0, 0, 1, 0])
        + array("I", [0, 1, 2])
        + array("f", [0, 0, 1, 0, 0, 1])
        + text("paint#0a1b")
        + pack("<I", 0x40FF8000),
        {
            "at": B,
            "bodies": [12, 0xFFFFFFFF, 0x80000001],
            "points": [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0],
            "triangles": [0, 1, 2],
            "coordinates": [0.0, 0.0, 1.0, 0.0, 0.0, 1.0],
            "material": "paint#0a1b",
            "color": 0x40FF8000,
        },
    ),
    ("paint", array("I", [12, 13]) + array("I", [0xFF8000]), {"bodies": [12, 13], "colors": [0xFF8000]}),
    (
        "shape_set",
        anchor(A)
        + part(PART)
        + array("f", [0, 1, 2])
        + array("f", [0.5, 0.5, 0.5, 0.5])
        + array("f", [2])
        + array("I", [0x80FF]),
        {
            "at": A,
            "part": PART,
            "places": [0.0, 1.0, 2.0],
            "rotations": [0.5, 0.5, 0.5, 0.5],
            "scales": [2.0],
            "colors": [0x80FF],
        },
    ),
    ("strut", anchor(A) + anchor(B) + part(PART) + pack("<f", 0.75), {"a": A, "b": B, "part": PART, "length": 0.75}),
    (
        "tube",
        array("I", []) + array("f", [0, 1, 2, 3, 4, 5]) + pack("<fB", 0.25, 1) + text("rope") + pack("<I", NO_COLOR),
        {
            "bodies": [],
            "points": [0.0, 1.0, 2.0, 3.0, 4.0, 5.0],
            "radius": 0.25,
            "closed": True,
            "material": "rope",
            "color": NO_COLOR,
        },
    ),
    (
        "stage",
        pack("<3If", 0x0B1020, 0x203040, NO_COLOR, 0.5),
        {"sky": 0x0B1020, "horizon": 0x203040, "ground": NO_COLOR, "light": 0.5},
    ),
    ("viewpoint", text("driver") + anchor(A) + anchor(B), {"name": "driver", "eye": A, "target": B}),
    (
        "texture",
        text("0a1b") + pack("<I", 3) + b"\x89PN" + pack("<2f", 2, 0.5),
        {"name": "0a1b", "image": [0x89, 0x50, 0x4E], "repeat_u": 2.0, "repeat_v": 0.5},
    ),
    (
        "light",
        b"\x01" + anchor(A) + anchor(B) + pack("<IfffB", 0xFF8000, 2, 0.5, 0.25, 1),
        {
            "kind": 1,
            "at": A,
            "to": B,
            "color": 0xFF8000,
            "intensity": 2.0,
            "reach": 0.5,
            "angle": 0.25,
            "shadow": True,
        },
    ),
    (
        "sound",
        text("0a1b") + pack("<I", 3) + b"Ogg" + pack("<f", 0.5),
        {"name": "0a1b", "file": [0x4F, 0x67, 0x67], "reach": 0.5},
    ),
    (
        "custom",
        text("flower") + anchor(A) + quat([0.5, 0.5, 0.5, 0.5]) + text('{"petals":7}'),
        {"class_name": "flower", "at": A, "rotation": [0.5, 0.5, 0.5, 0.5], "values": '{"petals":7}'},
    ),
    ("frame", anchor(A) + quat([0.5, 0.5, 0.5, 0.5]), {"at": A, "rotation": [0.5, 0.5, 0.5, 0.5]}),
]

NAN, INFINITY = float("nan"), float("inf")

# name, who sends it, bytes, a part of the reason that every decoder gives
BAD: list[tuple[str, str, bytes, str]] = [
    ("bad_empty", "client", b"", "the frame is empty"),
    ("bad_type", "client", b"\x3f", "has the type 63"),
    ("bad_direction", "client", b"\x40\x01\x00", "has the type 64"),
    ("bad_short_select", "client", b"\x02\x01\x00\x00", "select.body ends early"),
    ("bad_long_select", "client", b"\x02" + bytes(9), "the frame has 1 bytes too many"),
    ("bad_nan", "client", b"\x04" + pack("<I3f", 1, 0.0, NAN, 0.0), "grab_move.target is not a finite number"),
    ("bad_infinity", "client", b"\x07\x04" + pack("<f", -INFINITY), "control.value is not a finite number"),
    ("bad_nan_double", "client", b"\x08" + pack("<d", NAN), "ping.client_time is not a finite number"),
    ("bad_command", "client", b"\x07\x05" + bytes(4), "control.command has no meaning for the value 5"),
    ("bad_string_length", "client", b"\x06" + pack("<I", 100) + b"break", "action.name ends early"),
    ("bad_string_huge", "client", b"\x06\xff\xff\xff\xff" + b"break", "action.name has 4294967295 entries"),
    ("bad_string_limit", "client", b"\x06" + text("a" * 129) + bytes(12), "action.name has 129 entries"),
    ("bad_utf8", "client", b"\x06" + pack("<I", 2) + b"\xc0\x80" + bytes(12), "action.name is not UTF-8"),
    ("bad_surrogate", "client", b"\x06" + pack("<I", 3) + b"\xed\xa0\x80" + bytes(12), "action.name is not UTF-8"),
    ("bad_count", "server", b"\x4a" + text("tie") + pack("<I", 100000) + bytes(8), "entities_destroyed.ids ends early"),
    (
        "bad_count_huge",
        "server",
        b"\x4a" + text("tie") + pack("<I", 0xFFFFFFFF),
        "entities_destroyed.ids has 4294967295",
    ),
    ("bad_bool", "server", b"\x44" + pack("<QdIB", 5, 0.5, 1, 2) + bytes(52), "poses.keyframe is neither 0 nor 1"),
    ("bad_poses_short", "server", b"\x44" + pack("<QdIB", 5, 0.5, 1, 0) + bytes(51), "poses.holds ends early"),
]


def main() -> None:
    GOLDEN.mkdir(exist_ok=True)
    for old in GOLDEN.iterdir():
        old.unlink()
    good, bad = [], []
    for sender, vectors in (("client", CLIENT), ("server", SERVER)):
        for name, message, data, values in vectors:
            (GOLDEN / f"{name}.hex").write_text(data.hex() + "\n")
            good.append({"name": name, "sender": sender, "message": message, "values": values})
    for name, sender, data, error in BAD:
        (GOLDEN / f"{name}.hex").write_text(data.hex() + "\n")
        bad.append({"name": name, "sender": sender, "error": error})
    entities = []
    for kind, fields, values in ENTITIES:
        data = identity(ID["slot"], ID["generation"]) + fields
        (GOLDEN / f"entity_{kind}.hex").write_text(data.hex() + "\n")
        entities.append({"kind": kind, "values": {"id": ID, **values}})
    vectors_json = json.dumps({"good": good, "bad": bad, "entities": entities}, indent=1, ensure_ascii=True)
    (GOLDEN / "vectors.json").write_text(vectors_json + "\n")


if __name__ == "__main__":
    main()
