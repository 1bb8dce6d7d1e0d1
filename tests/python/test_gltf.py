# SPDX-License-Identifier: Apache-2.0
"""glTF files with colors and images: what is read, what is left out, and what pages are sent."""

from __future__ import annotations

import base64
import json
import math
import struct
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from page_client import PageClient

import iota
from iota import shapelib
from iota.textures import MOST_BYTES, PNG, make_png

pytest.importorskip("trimesh")
Runner = Callable[[iota.World], str]
CHECK = make_png(np.array([[1.0, 0.0], [0.0, 1.0]]))
SQUARE = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], "<f4")
CORNERS = np.array([[0, 1], [1, 1], [1, 0], [0, 0]], "<f4")  # from the upper left, as glTF counts


def described(image: dict[str, Any] | None, data: bytes = b"", corners: Any = CORNERS) -> tuple[dict[str, Any], bytes]:
    """Two squares of one mesh, at a node 5 m up: one red, one with an image. The description and its buffer."""
    parts = [SQUARE.tobytes(), corners.tobytes(), np.array([0, 1, 2, 0, 2, 3], "<u2").tobytes(), data]
    views, at = [], 0
    for part in parts:
        views.append({"buffer": 0, "byteOffset": at, "byteLength": len(part)})
        at += len(part)
    kind = {"f": 5126, "B": 5121, "H": 5123}[corners.dtype.char]
    head: dict[str, Any] = {
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0, "translation": [0, 5, 0]}],
        "meshes": [{"name": "wall", "primitives": [
            {"attributes": {"POSITION": 0}, "indices": 2, "material": 0},
            {"attributes": {"POSITION": 0, "TEXCOORD_0": 1}, "indices": 2, "material": 1},
        ]}],
        "materials": [
            {"pbrMetallicRoughness": {"baseColorFactor": [1, 0, 0, 0.5]}, "alphaMode": "BLEND"},
            {"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}, "baseColorFactor": [1, 1, 1, 0.2]}},
        ],
        "textures": [{"source": 0}], "images": [image or {"bufferView": 3, "mimeType": "image/png"}],
        "buffers": [{"byteLength": at}], "bufferViews": views,
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"},
            {"bufferView": 1, "componentType": kind, "count": 4, "type": "VEC2", "normalized": kind != 5126},
            {"bufferView": 2, "componentType": 5123, "count": 6, "type": "SCALAR"},
        ],
    }  # fmt: skip
    return head, b"".join(parts)


def write_glb(path: Path, head: dict[str, Any], buffer: bytes) -> Path:
    text = json.dumps(head).encode()
    text += b" " * (-len(text) % 4)
    buffer += bytes(-len(buffer) % 4)
    chunks = struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(buffer), b"BIN\0") + buffer
    path.write_bytes(struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks)
    return path


def write_gltf(path: Path, head: dict[str, Any], buffer: bytes) -> Path:
    uri = "data:application/octet-stream;base64," + base64.b64encode(buffer).decode()
    path.write_text(json.dumps(head | {"buffers": [{"byteLength": len(buffer), "uri": uri}]}))
    return path


def sources(folder: Path) -> list[Path]:
    """The same scene, with its image in the file, beside it, in its text and in its buffer."""
    (folder / "images").mkdir()
    (folder / "images" / "a check.png").write_bytes(CHECK)
    inline = {"uri": "data:image/png;base64," + base64.b64encode(CHECK).decode()}
    return [
        write_glb(folder / "a.glb", *described(None, CHECK)),
        write_gltf(folder / "b.gltf", *described({"uri": "images/a%20check.png"})),
        write_gltf(folder / "c.gltf", *described(inline)),
        write_gltf(folder / "d.gltf", *described(None, CHECK)),
    ]


def test_each_material_brings_its_color_and_its_image_wherever_that_is(tmp_path: Path) -> None:
    for path in sources(tmp_path):
        red, checked = shapelib.read_model(path)
        assert (red.color, red.texture, red.coordinates) == ("#ff000080", None, None)
        assert checked.color == "#ffffffff", "only what blends is seen through"
        assert checked.texture is not None and checked.texture.image == CHECK
        assert checked.coordinates == pytest.approx(np.array([[0, 0], [1, 0], [1, 1], [0, 1]]))
        for part in (red, checked):
            assert part.vertices == pytest.approx(SQUARE + [0, 5, 0])
            assert part.faces == [[0, 1, 2], [0, 2, 3]] and part.name == "wall" and part.notes == []
        whole = shapelib.read_surface(path)
        assert len(whole.vertices) == 8 and len(whole.faces) == 4


@pytest.mark.parametrize(
    ("factors", "material"),
    [
        ({"metallicFactor": 1, "roughnessFactor": 0.2}, "steel"),
        ({"roughnessFactor": 0.5}, "steel"),  # metal is the default
        ({"metallicFactor": 0.1, "roughnessFactor": 0.2}, "paint"),
        ({"metallicFactor": 1, "roughnessFactor": 0.9}, "paint"),
        ({"metallicFactor": 1}, "paint"),
        ({"roughnessFactor": 0.2, "metallicRoughnessTexture": {"index": 0}}, "paint"),
    ],
)
def test_metal_that_is_not_rough_is_drawn_as_metal(
    tmp_path: Path, factors: dict[str, Any], material: str, run_world: Runner
) -> None:
    head, buffer = described(None, CHECK)
    head["materials"][0]["pbrMetallicRoughness"] |= factors
    red, checked = shapelib.read_model(write_glb(tmp_path / "a.glb", head, buffer))
    assert (red.material, checked.material) == (material, "paint")
    world = iota.World(iota.System())
    world.drawings.model([red])
    with PageClient(run_world(world)) as page:
        page.wait_for(lambda: page.entities["surface"])
        assert page.entities["surface"][0]["material"] == material


@pytest.mark.parametrize("factor", [-0.1, 1.5, math.nan, "much", None])
def test_a_metal_that_is_no_number_from_0_to_1_is_refused(tmp_path: Path, factor: Any) -> None:
    head, buffer = described(None, CHECK)
    head["materials"][0]["pbrMetallicRoughness"]["metallicFactor"] = factor
    with pytest.raises(shapelib.FileError, match="from 0 to 1"):
        shapelib.read_model(write_glb(tmp_path / "a.glb", head, buffer))


def test_coordinates_may_be_whole_numbers(tmp_path: Path) -> None:
    for kind, one in (("B", 255), ("<u2", 65535)):
        path = write_glb(tmp_path / "a.glb", *described(None, CHECK, (one * CORNERS).astype(kind)))
        _, checked = shapelib.read_model(path)
        assert checked.coordinates == pytest.approx(np.array([[0, 0], [1, 0], [1, 1], [0, 1]]), abs=1e-9)


def test_colors_are_converted_from_linear_to_srgb(tmp_path: Path) -> None:
    head, buffer = described(None, CHECK)
    head["materials"][0]["pbrMetallicRoughness"]["baseColorFactor"] = [0.5, 0.0031308, 0.001, 1]
    # IEC 61966-2-1: 0.5 is 188 of 255.
    assert shapelib.read_model(write_glb(tmp_path / "a.glb", head, buffer))[0].color == "#bc0a03ff"


HUGE = PNG + struct.pack(">I", 13) + b"IHDR" + struct.pack(">II", 60000, 60000) + bytes(5)


@pytest.mark.parametrize(
    ("image", "said"),
    [
        ({"uri": "nowhere.png"}, "a.glb: image 0 (nowhere.png) is left out: no such file"),
        ({"uri": "../secret.png"}, "outside the folder"),
        ({"uri": "/etc/passwd"}, "outside the folder"),
        ({"uri": "link.png"}, "outside the folder"),
        ({"uri": "."}, "it is not a file"),
        ({"uri": "http://example.org/a.png"}, "no such file"),
        ({"uri": "data:image/png;base64,@@@"}, "its data are damaged"),
        ({"uri": "data:image/png,abc"}, "not in base64"),
        ({"uri": "data:image/gif;base64," + base64.b64encode(b"GIF89a").decode()}, "neither a PNG nor a JPEG"),
        ({"uri": "data:image/png;base64," + base64.b64encode(HUGE).decode(), "name": "huge"}, "image 0 (huge)"),
        ({"uri": "data:image/png;base64," + base64.b64encode(CHECK[:-9]).decode()}, "truncated PNG"),
        ({"uri": "data:image/png;base64," + base64.b64encode(bytes(MOST_BYTES + 1)).decode()}, "MiB, more than 4"),
        ({"bufferView": 99}, "image 0 (embedded) is left out"),
        ({"bufferView": 0}, "neither a PNG nor a JPEG"),
        ({}, "image 0 (embedded) is left out"),
    ],
)
def test_an_image_that_cannot_be_used_is_left_out_with_one_line(
    tmp_path: Path, image: dict[str, Any], said: str
) -> None:
    (tmp_path / "secret.png").write_bytes(CHECK)
    folder = tmp_path / "assets"
    folder.mkdir()
    (folder / "link.png").symlink_to(tmp_path / "secret.png")
    head, buffer = described(None, CHECK)
    head["images"] = [image]
    parts = shapelib.read_model(write_glb(folder / "a.glb", head, buffer))
    assert len(parts) == 2 and parts[1].texture is None and parts[1].coordinates is None
    (note,) = parts[0].notes
    assert said in note and "\n" not in note and len(note) < 200


def test_all_images_of_a_file_share_a_limit_of_pixels(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("iota.shapelib.gltf.MOST_PIXELS", 7)
    head, buffer = described(None, CHECK)
    head["images"] *= 2
    head["textures"].append({"source": 1})
    second = {"pbrMetallicRoughness": {"baseColorTexture": {"index": 1}}}
    head["materials"][0] = second
    head["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_0"] = 1
    parts = shapelib.read_model.__wrapped__(write_glb(tmp_path / "a.glb", head, buffer))
    assert [part.texture is None for part in parts] == [False, True]
    assert "all images together have more than" in parts[0].notes[0]


@pytest.mark.parametrize(
    "broken",
    [
        lambda head: head["meshes"][0]["primitives"][1].update(material=9),
        lambda head: head["meshes"][0]["primitives"][1]["attributes"].update(TEXCOORD_0=99),
        lambda head: head["meshes"][0]["primitives"][1].update(attributes=None),
        lambda head: head["materials"][1]["pbrMetallicRoughness"]["baseColorTexture"].update(index="a"),
        lambda head: head["materials"][0]["pbrMetallicRoughness"].update(baseColorFactor=[1, 2]),
        lambda head: head["materials"][0]["pbrMetallicRoughness"].update(baseColorFactor="red"),
        lambda head: head["accessors"][1].update(type="VEC3"),
        lambda head: head["accessors"][2].update(count=10**9),
        lambda head: head["meshes"][0].update(primitives=[]),
        lambda head: head["nodes"][0].update(mesh=7),
        lambda head: head.update(materials=None),
        lambda head: head.update(nodes=[{"children": [0]}]),
    ],
)
def test_a_broken_description_is_refused_by_one_line_that_names_the_file(
    tmp_path: Path, broken: Callable[[dict[str, Any]], Any]
) -> None:
    head, buffer = described(None, CHECK)
    broken(head)
    with pytest.raises(shapelib.FileError, match=r"a\.glb: ") as caught:
        shapelib.read_model(write_glb(tmp_path / "a.glb", head, buffer))
    assert "\n" not in str(caught.value)


def test_a_model_is_drawn_with_its_colors_and_images(tmp_path: Path, run_world: Runner) -> None:
    (path, *_) = sources(tmp_path)
    world = iota.World(iota.System())
    surfaces = world.drawings.model(shapelib.read_model(path), at=(0, 0, 2))
    with PageClient(run_world(world)) as page:
        page.wait_for(lambda: len(page.entities["surface"]) == 2 and page.entities["texture"])
        red, checked = (page.entities["surface"][slot] for slot in (0, 1))
        texture = page.entities["texture"][0]
        assert texture["image"] == CHECK and checked["material"] == f"paint#{texture['name']}"
        assert red["material"] == "paint" and red["color"] == 0x7FFF0000
        assert checked["coordinates"] == pytest.approx([0, 0, 1, 0, 1, 1, 0, 1])
        assert red["at"]["point"] == pytest.approx((0, 0, 2))
        world.call(surfaces[1].destroy)
        page.wait_for(lambda: len(page.entities["surface"]) == 1 and not page.entities["texture"])


def test_a_model_without_its_image_is_drawn_and_says_so(tmp_path: Path) -> None:
    path = write_gltf(tmp_path / "b.gltf", *described({"uri": "gone.png"}))
    world = iota.World(iota.System())
    with pytest.warns(UserWarning, match=r"b\.gltf: image 0 \(gone\.png\) is left out: no such file"):
        surfaces = world.drawings.model(shapelib.read_model(path))
    assert len(surfaces) == 2 and surfaces[1].texture is None
