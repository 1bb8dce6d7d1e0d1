# SPDX-License-Identifier: Apache-2.0
"""Images on looks and surfaces: what is read, what is refused, and what pages are sent."""

from __future__ import annotations

import struct
import zlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from page_client import PageClient

import iota
from iota import looks
from iota.textures import JPEG, MOST_BYTES, check_image, lay_flat, make_png, texture_of

Runner = Callable[[iota.World], str]
CHECK = np.array([[1.0, 0.0], [0.0, 1.0]])


def pixels_of(png: bytes) -> np.ndarray[Any, Any]:
    """Those of a file of `make_png`."""
    width, height, _, color = struct.unpack(">IIBB", png[16:26])
    length = struct.unpack(">I", png[33:37])[0]
    channels = {0: 1, 2: 3, 6: 4}[color]
    lines = np.frombuffer(zlib.decompress(png[41 : 41 + length]), np.uint8).reshape(height, -1)
    assert (lines[:, 0] == 0).all()
    return lines[:, 1:].reshape(height, width, channels)


@pytest.mark.parametrize("channels", [1, 3, 4])
def test_an_array_becomes_a_whole_png_file_of_its_pixels(channels: int) -> None:
    pixels = np.random.default_rng(1).integers(0, 256, (5, 7, channels), np.uint8)
    png = make_png(pixels)
    check_image(png)
    assert (pixels_of(png) == pixels).all()
    assert (pixels_of(make_png(pixels / 255)) == pixels).all()


def test_a_gray_array_needs_no_third_axis() -> None:
    assert pixels_of(make_png(CHECK))[:, :, 0].tolist() == [[255, 0], [0, 255]]


def jpeg(width: int, height: int) -> bytes:
    """The frame of a JPEG file, without a picture in it."""
    frame = struct.pack(">HBHHB", 11, 8, height, width, 1) + b"\x01\x11\x00"
    return b"\xff\xd8\xff\xe0\x00\x04ab" + b"\xff\xc0" + frame + b"\xff\xda\x00\x02" + b"\xff\xd9"


def test_a_jpeg_file_is_taken_by_its_header(tmp_path: Path) -> None:
    path = tmp_path / "picture.jpg"
    path.write_bytes(jpeg(640, 480))
    assert texture_of(path, (2, 3)).repeat == (2.0, 3.0)


@pytest.mark.parametrize(
    ("data", "said"),
    [
        (None, "no such file"),
        (b"", "neither a PNG nor a JPEG"),
        (b"GIF89a" + bytes(100), "neither a PNG nor a JPEG"),
        (make_png(CHECK)[:-5], "truncated PNG"),
        (make_png(CHECK)[:8], "truncated PNG"),
        (make_png(CHECK).replace(b"IDAT", b"IDAX"), "damaged PNG file: the checksum"),
        (JPEG + bytes(3), "truncated or damaged JPEG"),
        (jpeg(640, 480)[:-2], "truncated or damaged JPEG"),
        (jpeg(5000, 480), "5000 x 480 pixels"),
        (jpeg(0, 480), "0 x 480 pixels"),
        (bytes(MOST_BYTES + 1), "has 4.0 MiB, more than 4"),
    ],
)
def test_a_file_that_cannot_be_used_is_refused_by_its_name(tmp_path: Path, data: bytes | None, said: str) -> None:
    path = tmp_path / "wall.png"
    if data is not None:
        path.write_bytes(data)
    with pytest.raises(ValueError, match=rf"texture '.*wall\.png': .*{said}"):
        looks.box((1, 1, 1), texture=path)


@pytest.mark.parametrize(
    ("image", "repeat", "said"),
    [
        (CHECK, 0, "repeat is one number above 0"),
        (CHECK, (1, float("nan")), "repeat is one number above 0"),
        (np.zeros((2, 2, 2)), 1, r"not \(2, 2, 2\)"),
        (np.zeros((0, 2)), 1, "2 x 0 pixels"),
        (np.full((2, 2), np.nan), 1, "finite"),
        (np.zeros((2, 2), int), 1, "bytes or of numbers from 0 to 1"),
        (7, 1, "path of a PNG or JPEG file, or an array"),
    ],
)
def test_a_bad_image_is_refused_with_the_reason(image: Any, repeat: Any, said: str) -> None:
    with pytest.raises((ValueError, TypeError), match=said):
        looks.sphere(1, texture=image, repeat=repeat)


def test_a_look_with_an_image_is_the_same_after_a_file() -> None:
    look = looks.box((1, 2, 3), texture=CHECK, repeat=(2, 1))
    again = looks.from_json(looks.to_json(look))["*"]
    assert again.texture == look.texture and again.describe() == look.describe()
    with pytest.raises(ValueError):
        looks.from_json({"*": [{**looks.to_json(look)["*"][0], "texture": "/etc/hostname"}]})


def test_an_image_is_laid_upright_and_once_over_points() -> None:
    wall = np.array([(0, 0, 5), (2, 0, 5), (2, 1, 5), (0, 1, 5)], float)
    assert lay_flat(wall).tolist() == [[0, 0], [1, 0], [1, 1], [0, 1]]
    floor = np.array([(0, 7, 0), (2, 7, 0), (2, 7, 3), (0, 7, 3)], float)
    assert lay_flat(floor).tolist() == [[0, 1], [1, 1], [1, 0], [0, 0]]


def test_an_image_is_sent_once_and_gone_with_the_last_that_needs_it(run_world: Runner) -> None:
    world = iota.World(iota.System())
    boxes = [world.drawings.shape(looks.box((1, 1, 1), "wood", texture=CHECK)) for _ in range(3)]
    world.drawings.shape(looks.sphere(1, texture=CHECK, repeat=2))
    with PageClient(run_world(world)) as page:
        page.wait_for(lambda: len(page.entities["texture"]) == 2)
        page.wait_for(lambda: len(page.entities["marker"]) == 4)
        names = {entity["name"]: entity for entity in page.entities["texture"].values()}
        for slot, marker in page.entities["marker"].items():
            base, _, name = marker["part"]["material"].partition("#")
            assert base == ("wood" if slot < 3 else "paint" if slot > 3 else "brass")
            assert names[name]["repeat_u"] == (1 if slot < 3 else 2)
            assert pixels_of(bytes(names[name]["image"]))[0, 0] == 255
        world.call(boxes[0].destroy)
        world.call(lambda: setattr(boxes[1], "look", looks.box((1, 1, 1))))
        world.call(lambda: world.label("done"))
        page.wait_for(lambda: page.entities["label"])
        assert len(page.entities["texture"]) == 2
        world.call(lambda: setattr(boxes[2], "visible", False))
        world.call(boxes[2].destroy)
        page.wait_for(lambda: len(page.entities["texture"]) == 1)


def test_bodies_fixed_shapes_and_surfaces_have_images(run_world: Runner) -> None:
    system = iota.System(gravity=(0, 0, 0))
    world = iota.World(system)
    corners = [
        system.body(shape=iota.Sphere(0.1), mass=1, position=place) for place in ((0, 0, 0), (2, 0, 0), (2, 1, 0))
    ]
    world.draw(corners, looks.solid("steel", texture=CHECK))
    world.add_static(looks.box((9, 1, 9), texture=CHECK, repeat=9), (0, -1, 0))
    sail = world.surface(corners, [(0, 1, 2)], texture=CHECK, repeat=4)
    with PageClient(run_world(world)) as page:
        page.wait_for(lambda: len(page.entities["texture"]) == 3)
        surface = page.wait_for(lambda: page.entities["surface"].get(0))
        assert list(surface["coordinates"]) == [0, 0, 1, 0, 1, 1]
        assert page.visual_of(corners[0].slot)["parts"][0]["material"].startswith("steel#")
        world.call(lambda: setattr(sail, "coordinates", [(0, 0), (3, 0), (3, 3)]))
        page.wait_for(lambda: list(page.entities["surface"][0]["coordinates"]) == [0, 0, 3, 0, 3, 3])
        world.call(lambda: setattr(sail, "texture", None))
        page.wait_for(lambda: len(page.entities["texture"]) == 2)
        assert len(page.entities["surface"][0]["coordinates"]) == 0


def test_several_large_images_arrive(run_world: Runner) -> None:
    world = iota.World(iota.System())
    for seed in range(4):
        noise = np.random.default_rng(seed).integers(0, 256, (1100, 1200, 3), np.uint8)
        world.drawings.shape(looks.box((1, 1, 1), texture=noise))
    with PageClient(run_world(world)) as page:
        page.wait_for(lambda: len(page.entities["texture"]) == 4)
        assert all(len(entity["image"]) > 3_900_000 for entity in page.entities["texture"].values())
