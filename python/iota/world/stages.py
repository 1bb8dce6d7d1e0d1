# SPDX-License-Identifier: Apache-2.0
"""Surroundings by name: a room, a studio, space."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from iota import looks
from iota._core import Box, Material, System, Vec3

if TYPE_CHECKING:
    from iota.world.scene import Scene

WIDTH, DEPTH, HEIGHT = 9.0, 7.0, 3.2  # of the room, m
SILL, TOP = 0.9, 2.4  # of its windows, m
WINDOWS = (-2.2, -0.3, 1.6)  # z of their middles, m
PANE = 1.4  # m
LAMPS = (-2.4, 0.0, 2.4)  # x, m
STARS = 900
FIRM = Material(friction=0.6)
WHITE = "#f4f4f0"

Made = list[Any]
Colors = dict[str, Any]


def room(drawings: Any, scene: Scene) -> tuple[Colors, Made]:
    """9 x 7 m, around the origin, open to the viewer's side: parquet, three walls with windows in the right one, lamps."""
    made: Made = []
    ground = scene.ground or 0.0

    def wall(size: Sequence[float], at: Sequence[float], color: str = "#e4e6e2") -> None:
        body = scene._fix("stage", Box(size), looks.solid("paint", color), (at[0], at[1] + ground, at[2]))
        body.name, body.material = "wall", FIRM
        made.append(body)

    def draw(size: Sequence[float], at: Sequence[float], material: str = "paint", color: str = WHITE) -> None:
        made.append(drawings.shape(looks.box(size, material, color=color), position=(at[0], at[1] + ground, at[2])))

    x, z, thick = WIDTH / 2, DEPTH / 2, 0.12
    made.append(
        drawings.surface(
            [(-x, ground + 0.004, z), (x, ground + 0.004, z), (x, ground + 0.004, -z), (-x, ground + 0.004, -z)],
            [(0, 1, 2), (0, 2, 3)],
            texture=parquet(),
            repeat=(WIDTH / 2, DEPTH / 2),
        )
    )
    wall((WIDTH + 2 * thick, HEIGHT, thick), (0, HEIGHT / 2, -z - thick / 2))
    wall((thick, HEIGHT, DEPTH), (-x - thick / 2, HEIGHT / 2, 0))
    right = x + thick / 2
    wall((thick, SILL, DEPTH), (right, SILL / 2, 0))
    wall((thick, HEIGHT - TOP, DEPTH), (right, (HEIGHT + TOP) / 2, 0))
    edges = [-z, *(edge for middle in WINDOWS for edge in (middle - PANE / 2, middle + PANE / 2)), z]
    for low, high in zip(edges[::2], edges[1::2], strict=True):
        wall((thick, TOP - SILL, high - low), (right, (TOP + SILL) / 2, (low + high) / 2))
    for middle in WINDOWS:
        draw((0.01, TOP - SILL, PANE), (right, (TOP + SILL) / 2, middle), "glass", "#d5e6ee40")
        for y in (SILL, (SILL + TOP) / 2, TOP):
            draw((thick + 0.04 if y == SILL else 0.06, 0.04, PANE), (right - 0.01, y, middle))
        for side in (-PANE / 2, 0.0, PANE / 2):
            draw((0.06, TOP - SILL, 0.04), (right - 0.01, (SILL + TOP) / 2, middle + side))
    draw((WIDTH, 0.09, 0.02), (0, 0.045, 0.01 - z))
    for side in (-x + 0.01, x - 0.01):
        draw((0.02, 0.09, DEPTH), (side, 0.045, 0))
    for at in LAMPS:
        shade = looks.cone(0.22, 0.2, color="#3c4248")
        made.append(drawings.shape(shade, (at, ground + HEIGHT - 0.6, -0.8), (0, 0, 0.5**0.5, 0.5**0.5)))
        draw((0.012, 0.6, 0.012), (at, HEIGHT - 0.3, -0.8), "rubber", "#23272b")
    colors = {"sky": "#a8c4d8", "horizon": "#dfe5e6", "ground": "#b9b2a4"}
    return colors, made


def studio(drawings: Any, scene: Scene) -> tuple[Colors, Made]:
    """A backdrop without an edge, a soft key light, and a cool one from behind."""
    size, middle = extent(scene)
    made: Made = [
        drawings.light(
            "spot", middle + Vec3(-1.4, 2.0, 1.8) * size, middle, color="#ffe9cf", intensity=0.7, reach=3 * size, angle=0.7,
        ),
        drawings.light(
            "spot", middle + Vec3(1.6, 1.6, -2.0) * size, middle, color="#cfe2ff", intensity=0.9, reach=3 * size, angle=0.7,
        ),
    ]  # fmt: skip
    return {"sky": "#aab2b8", "horizon": "#c6cbce", "ground": "#b8bcbe", "light": 0.75}, made


def space(drawings: Any, scene: Scene) -> tuple[Colors, Made]:
    """Black, with stars all around and a sun."""
    size, middle = extent(scene)
    random = np.random.default_rng(5)
    ways = random.normal(size=(STARS, 3))
    ways /= np.linalg.norm(ways, axis=1)[:, None]
    light = random.random(STARS) ** 3
    tint = np.array([[0.75, 0.85, 1.0], [1.0, 1.0, 1.0], [1.0, 0.88, 0.7]])[random.integers(3, size=STARS)]
    far = min(11 * size, 5e8)  # pages take places up to 1e9 m
    made: Made = [
        drawings.points(
            np.asarray(middle) + far * ways,
            radius=far * (0.0008 + 0.0016 * light),
            color=tint * (0.5 + 0.5 * light[:, None]),
        )
    ]
    return {"sky": "#020308", "horizon": "#05070f", "ground": "#0b0d13", "light": 0.8}, made


STAGES: dict[str, Callable[[Any, Scene], tuple[Colors, Made]]] = {
    "room": room, "studio": studio, "space": space,
}  # fmt: skip


def extent(scene: Scene) -> tuple[float, Vec3]:
    """Half the diagonal of the box around all particles, at least 1 m for a scene of less than two, and its middle."""
    system: object = scene._system
    places = np.asarray(system.positions if isinstance(system, System) else [])
    if len(places) < 2:
        return 1.0, Vec3(0, 1, 0)
    low, high = places.min(axis=0), places.max(axis=0)
    return max(float(np.linalg.norm(high - low)) / 2, 1e-9), Vec3(*((low + high) / 2))


def parquet() -> Any:
    """An image of 2 x 2 m of planks, 12.5 cm wide and 1 m long."""
    random = np.random.default_rng(7)
    pixels = 512
    image = np.empty((pixels, pixels, 3))
    rows, length = 16, pixels // 2
    grain = random.normal(size=(pixels, 8)).repeat(pixels // 8, axis=1)
    for row in range(rows):
        band = slice(row * pixels // rows, (row + 1) * pixels // rows)
        shift = (row * 5 % 8) * pixels // 8
        for plank in range(2):
            tone = 0.86 + 0.12 * random.random()
            columns = (np.arange(plank * length, (plank + 1) * length) + shift) % pixels
            image[band, columns] = tone * np.array([0.80, 0.62, 0.43])
            image[band, columns[0]] *= 0.62
        image[band] *= 1 + 0.025 * grain[band][:, :, None]
        image[band.start] *= 0.62
    waves = 1 + 0.02 * np.sin(np.arange(pixels) * 2 * math.pi * 3 / pixels)[None, :, None]
    return np.clip(image * waves, 0, 1)
