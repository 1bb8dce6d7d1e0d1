# SPDX-License-Identifier: Apache-2.0
"""The furniture of the study lab: everything in it is made here, of boxes and surfaces of revolution, merged by material."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

import iota
from iota import looks

Array = Any
Place = Sequence[float]  # or a size: x, y, z, m
Key = tuple[str, str]  # material, color
FLOOR, WALL, WHITE = ("wood", "#f3dfc4"), ("paint", "#dfe3e2"), ("paint", "#f4f4f0")
OAK, DARK, METAL = ("wood", "#fff1dc"), ("paint", "#23272b"), ("steel", "#aeb4ba")
GREEN, CLAY, GLASS = ("paint", "#3f7a45"), ("paint", "#a5603f"), ("glass", "#bcd7e4")
CUSHION = ("rubber", "#38506b")
BOOKS = [("paint", color) for color in ("#7a2f2f", "#2f4f7a", "#356b4a", "#b08b3c", "#5c4a72", "#d9d2c0")]
KEYS = (15, 14, 14, 13, 12, 8)  # of a keyboard, row by row
TOP = 0.74  # of a desk, m
WALLS = 3.6  # height, m


class Furniture:
    """Triangles by material and color. detail: of round things, times the usual number of facets around."""

    def __init__(self, detail: int = 1) -> None:
        self._detail = detail
        self._pieces: dict[Key, list[tuple[Array, Array]]] = {}
        self.triangles = 0

    def add(self, key: Key, vertices: Array, triangles: Array) -> None:
        """A closed surface, m."""
        self._pieces.setdefault(key, []).append((np.asarray(vertices, float), np.asarray(triangles, int)))
        self.triangles += len(triangles)

    def box(self, key: Key, center: Place, size: Place, turn: float = 0.0, taper: float = 1.0) -> None:
        """turn: about the vertical, rad. taper: of its upper face."""
        corners = np.array([[x, y, z] for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)]) * size
        corners[corners[:, 1] > 0] *= (taper, 1, taper)
        c, s = math.cos(turn), math.sin(turn)
        quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
        triangles = [t for a, b, d, e in quads for t in ((a, b, d), (a, d, e))]
        self.add(key, corners @ [[c, 0, -s], [0, 1, 0], [s, 0, c]] + np.asarray(center), triangles)

    def turned(self, key: Key, foot: Place, profile: Sequence[tuple[float, float]], around: int = 40) -> None:
        """A surface of revolution about the vertical, closed at both ends. profile: radius and height above `foot`, m, from
        below."""
        around *= self._detail
        angles = 2 * math.pi * np.arange(around) / around
        rings = [(r * np.cos(angles), np.full(around, h), -r * np.sin(angles)) for r, h in profile]
        ends = [(0.0, profile[0][1], 0.0), (0.0, profile[-1][1], 0.0)]
        vertices = np.vstack([*(np.stack(ring, axis=1) for ring in rings), ends]) + np.asarray(foot)
        triangles, bottom, top = [], len(vertices) - 2, len(vertices) - 1
        for i in range(around):
            j = (i + 1) % around
            triangles.append((bottom, j, i))
            for row in range(0, (len(profile) - 1) * around, around):
                triangles += [(row + i, row + j, row + around + j), (row + i, row + around + j, row + around + i)]
            triangles.append((top, (len(profile) - 1) * around + i, (len(profile) - 1) * around + j))
        self.add(key, vertices, triangles)

    def ball(self, key: Key, center: Place, radii: Place, rows: int = 10, around: int = 16) -> None:
        """An ellipsoid with axes along x, y, z."""
        turns = np.linspace(-math.pi / 2, math.pi / 2, self._detail * rows + 2)[1:-1]
        foot = np.asarray(center, float)
        before = len(self._pieces.get(key, []))
        self.turned(key, (0, 0, 0), [(math.cos(turn), math.sin(turn)) for turn in turns], around)
        vertices, triangles = self._pieces[key][before]
        self._pieces[key][before] = (vertices * radii + foot, triangles)

    def show(self, world: iota.World) -> None:
        """In pieces that a page takes."""
        for (material, color), pieces in self._pieces.items():
            batch: list[tuple[Array, Array]] = []
            for piece in [*pieces, None]:
                if piece is None or sum(len(t) for _, t in batch) + len(piece[1]) > looks.MOST_TRIANGLES:
                    starts = np.cumsum([0, *(len(v) for v, _ in batch)])
                    triangles = np.vstack([t + start for (_, t), start in zip(batch, starts, strict=False)])
                    vertices = np.vstack([v for v, _ in batch])
                    world.add_static(looks.mesh(vertices, triangles, material, color=color), (0, 0, 0))
                    batch = []
                if piece is not None:
                    batch.append(piece)


def furnish(world: iota.World, detail: int = 1) -> Furniture:
    """A laboratory of 9 x 7 m, open to the viewer's side, of 65 000 triangles; more with more detail."""
    room, random = Furniture(detail), np.random.default_rng(3)
    shell(room)
    desk(room, -0.2, 0.0)
    for x in (-3.0, -1.0, 1.0):
        desk(room, x, -2.6)
        screen(room, (x - 0.1, TOP, -2.8), 0.56, 0.34)
        keyboard(room, x - 0.1, -2.45)
        chair(room, x, -1.85, random.uniform(-0.6, 0.6))
        tower(room, x + 0.65, -2.7)
    keyboard(room, -0.72, 0.27)
    for z in (-2.2, -0.7, 0.8):
        shelf(room, -4.25, z, random)
    for place in ((3.7, 0, -2.9), (3.8, 0, 0.6)):
        plant(room, place, random)
    board(room)
    lamp(room, (-0.95, TOP, -0.3))
    mug(room, (0.62, TOP, 0.2))
    room.show(world)
    return room


def shell(room: Furniture) -> None:
    """Parquet, three walls with a skirting, three windows, foam that damps the sound, ceiling lamps on wires."""
    for row in range(70):
        for column in range(19):
            x, z = -4.5 + 0.5 * column - (0.25 if row % 2 else 0), -3.5 + 0.1 * row
            left, right = max(x, -4.5), min(x + 0.5, 4.5)  # a plank is cut where the floor ends
            key = FLOOR if (row * 7 + column * 5) % 3 else ("wood", "#e2c7a3")
            if right > left:
                room.box(key, ((left + right) / 2, -0.012, z + 0.05), (right - left - 0.003, 0.04, 0.098))
    room.box(WALL, (0, WALLS / 2, -3.55), (9.1, WALLS, 0.1))
    room.box(WALL, (-4.55, WALLS / 2, 0), (0.1, WALLS, 7.0))
    room.box(WHITE, (0, 0.04, -3.49), (9.0, 0.08, 0.02))
    for z, length in ((-3.3, 0.4), (-1.5, 0.5), (0.5, 0.5), (2.6, 1.8)):
        room.box(WALL, (4.55, WALLS / 2, z), (0.1, WALLS, length))
    for low, high in ((0, 0.9), (2.3, WALLS)):
        room.box(WALL, (4.55, (low + high) / 2, 0), (0.1, high - low, 7.0))
    for z in (-2.4, -0.5, 1.3):
        room.box(GLASS, (4.55, 1.6, z), (0.01, 1.4, 1.5))
        for y in (0.92, 1.6, 2.28):
            room.box(WHITE, (4.53, y, z), (0.06, 0.04, 1.5))
    for x in np.arange(-4.2, -2.2, 0.05):
        for y in np.arange(1.5, 2.6, 0.05):
            pyramid(room, ("rubber", "#4a4f57"), (x, y, -3.5), 0.048, 0.04)
    for x in (-2.5, 0.0, 2.5):
        room.turned(WHITE, (x, 2.45, -0.6), [(0.02, 0.22), (0.05, 0.2), (0.2, 0.0), (0.19, 0.0), (0.045, 0.19)], 64)
        room.box(DARK, (x, (2.65 + WALLS) / 2, -0.6), (0.008, WALLS - 2.65, 0.008))


def pyramid(room: Furniture, key: Key, foot: Place, side: float, height: float) -> None:
    """A pyramid that points out of the back wall."""
    x, y, z = foot
    h = side / 2
    vertices = [(x - h, y - h, z), (x + h, y - h, z), (x + h, y + h, z), (x - h, y + h, z), (x, y, z + height)]
    room.add(key, vertices, [(0, 2, 1), (0, 3, 2), (0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4)])


def desk(room: Furniture, x: float, z: float) -> None:
    """1.8 x 0.8 m, with a drawer unit."""
    room.box(OAK, (x, TOP - 0.015, z), (1.8, 0.03, 0.8))
    for side in (-0.84, 0.84):
        for depth in (-0.34, 0.34):
            leg = [(0.03, 0), (0.03, 0.03), (0.02, 0.05), (0.02, TOP - 0.03)]
            room.turned(METAL, (x + side, 0, z + depth), leg, 24)
    room.box(WHITE, (x + 0.55, 0.4, z), (0.4, 0.56, 0.6))
    for drawer in range(3):
        room.box(OAK, (x + 0.55, 0.22 + 0.18 * drawer, z + 0.305), (0.37, 0.165, 0.012))
        room.box(METAL, (x + 0.55, 0.26 + 0.18 * drawer, z + 0.32), (0.12, 0.012, 0.018))


def screen(room: Furniture, foot: Place, width: float, height: float, lift: float = 0.12) -> None:
    """A monitor on its stand; its front is 2 cm before `foot`."""
    x, y, z = foot
    room.turned(METAL, foot, [(0.13, 0), (0.13, 0.008), (0.12, 0.012)], 48)
    room.box(METAL, (x, y + (lift + 0.1) / 2, z - 0.02), (0.05, lift + 0.1, 0.02))
    room.box(DARK, (x, y + lift + height / 2, z), (width, height, 0.03))
    room.box(("glass", "#0f2230"), (x, y + lift + height / 2, z + 0.0165), (width - 0.03, height - 0.03, 0.005))


def keyboard(room: Furniture, x: float, z: float) -> None:
    """Each key is a frustum."""
    room.box(DARK, (x, TOP + 0.006, z), (0.44, 0.012, 0.15))
    for row, count in enumerate(KEYS[::-1]):
        for key in range(count):
            width = 0.42 / count
            at = (x - 0.21 + width * (key + 0.5), TOP + 0.016, z + 0.06 - 0.024 * row)
            room.box(WHITE, at, (width - 0.003, 0.008, 0.021), taper=0.8)


def chair(room: Furniture, x: float, z: float, turn: float) -> None:
    """On five castors."""
    for spoke in range(5):
        angle = turn + 2 * math.pi * spoke / 5
        cx, cz = math.cos(angle), -math.sin(angle)
        room.box(DARK, (x + 0.15 * cx, 0.09, z + 0.15 * cz), (0.3, 0.03, 0.04), angle)
        room.ball(DARK, (x + 0.29 * cx, 0.03, z + 0.29 * cz), (0.03, 0.03, 0.03), 6, 10)
    room.turned(METAL, (x, 0.08, z), [(0.03, 0), (0.03, 0.2), (0.018, 0.2), (0.018, 0.36)], 32)
    room.ball(CUSHION, (x, 0.47, z), (0.25, 0.045, 0.24), 10, 28)
    back_x, back_z = -math.sin(turn), math.cos(turn)
    room.ball(CUSHION, (x + 0.24 * back_x, 0.82, z + 0.24 * back_z), (0.22, 0.25, 0.05), 12, 28)
    room.box(DARK, (x + 0.25 * back_x, 0.58, z + 0.25 * back_z), (0.05, 0.3, 0.02), turn)


def tower(room: Furniture, x: float, z: float) -> None:
    """A computer with a grille, beside a desk."""
    room.box(DARK, (x + 0.35, 0.24, z), (0.19, 0.46, 0.45))
    for slot in range(24):
        room.box(METAL, (x + 0.35, 0.08 + 0.008 * slot, z + 0.2275), (0.14, 0.004, 0.005))


def shelf(room: Furniture, x: float, z: float, random: np.random.Generator) -> None:
    """Five boards of books."""
    for side in (-0.68, 0.68):
        room.box(OAK, (x, 1.0, z + side), (0.3, 2.0, 0.025))
    for level in range(6):
        room.box(OAK, (x, 0.08 + 0.38 * level, z), (0.3, 0.025, 1.35))
    for level in range(5):
        place = z - 0.65
        while place < z + 0.5:
            thick, height = random.uniform(0.015, 0.05), random.uniform(0.2, 0.32)
            key = BOOKS[random.integers(len(BOOKS))]
            middle = (x + 0.03, 0.093 + 0.38 * level + height / 2, place + thick / 2)
            room.box(key, middle, (0.2, height, thick - 0.001))
            room.box(WHITE, (x + 0.028, *middle[1:]), (0.198, height + 0.001, thick - 0.007))
            place += thick


def plant(room: Furniture, foot: Place, random: np.random.Generator) -> None:
    """Leaves around a pot."""
    x, y, z = foot
    room.turned(CLAY, foot, [(0.14, 0), (0.19, 0.3), (0.21, 0.3), (0.21, 0.34), (0.18, 0.34), (0.17, 0.28)], 48)
    for leaf in range(60):
        angle, rise = 2.4 * leaf, random.uniform(0.1, 0.9)
        reach = 0.08 + 0.35 * math.sin(math.pi * min(rise + 0.15, 1))
        at = (x + reach * math.cos(angle), y + 0.4 + rise, z - reach * math.sin(angle))
        room.ball(GREEN, at, (0.05 + 0.07 * abs(math.cos(angle)), 0.02, 0.05 + 0.07 * abs(math.sin(angle))), 4, 10)
    room.turned(GREEN, (x, y + 0.28, z), [(0.02, 0), (0.012, 0.9)], 16)


def board(room: Furniture) -> None:
    """A white one, with a tray of pens."""
    room.box(WHITE, (1.2, 1.6, -3.47), (2.4, 1.1, 0.02))
    for y in (1.04, 2.16):
        room.box(METAL, (1.2, y, -3.46), (2.44, 0.03, 0.04))
    for x in (-0.01, 2.41):
        room.box(METAL, (x, 1.6, -3.46), (0.03, 1.15, 0.04))
    for pen, key in enumerate(BOOKS[:4]):
        room.box(key, (0.9 + 0.18 * pen, 1.065, -3.43), (0.13, 0.014, 0.014))


def lamp(room: Furniture, foot: Place) -> None:
    """For a desk."""
    x, y, z = foot
    room.turned(METAL, foot, [(0.09, 0), (0.09, 0.012), (0.03, 0.02), (0.008, 0.03), (0.008, 0.42)], 48)
    room.turned(GREEN, (x, y + 0.36, z), [(0.11, 0), (0.1, 0.03), (0.05, 0.11), (0.02, 0.13)], 64)


def mug(room: Furniture, foot: Place) -> None:
    """A mug of coffee, with a handle."""
    x, y, z = foot
    room.turned(WHITE, foot, [(0.036, 0), (0.04, 0.005), (0.04, 0.095), (0.036, 0.095), (0.036, 0.08)], 64)
    room.turned(("paint", "#3a2418"), foot, [(0.036, 0.08), (0.036, 0.084)], 64)
    for at, size in (((0.066, 0.05), (0.008, 0.056)), ((0.05, 0.074), (0.028, 0.008)), ((0.05, 0.026), (0.028, 0.008))):
        room.box(WHITE, (x + at[0], y + at[1], z), (*size, 0.012))
