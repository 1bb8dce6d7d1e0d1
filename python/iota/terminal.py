# SPDX-License-Identifier: Apache-2.0
"""A world in a terminal, drawn with Braille dots: `iota run NAME --terminal`, for machines without a browser."""

from __future__ import annotations

import os
import select
import shutil
import sys
from collections.abc import Iterator, Sequence
from contextlib import suppress
from functools import lru_cache
from typing import IO, Any

import numpy as np
from numpy.typing import NDArray

from iota._core import Body, Box, Grip, Mesh, Shape, Solid, Vec3
from iota.frames import axes_of
from iota.world.view import View
from iota.world.world import World

Points = NDArray[np.float64]

YAW, PITCH = 0.4, 0.24  # rad: the first view of the page
DOTS = ((0x01, 0x08), (0x02, 0x10), (0x04, 0x20), (0x40, 0x80))  # of a Braille cell, by row and column
PLAIN, MARKED, CLEAR, HOME = "\x1b[0m", "\x1b[38;5;209m", "\x1b[2J", "\x1b[H"
ARROWS = {"\x1b[A": (0, 1), "\x1b[B": (0, -1), "\x1b[C": (1, 0), "\x1b[D": (-1, 0)}
PULL = 0.05  # sizes of the scene that an arrow key moves the hand
NOTICE_FRAMES = 180
KEYS = "tab: next body   arrows: pull it   esc: let go   space: pause   r: reset   q: quit"


class TerminalView(View):
    """Draws bodies as lines and takes keys: those of the script's actions, tab to select a body, arrows to pull it. out:
    where it draws. keys: where keys come from; without a terminal there none are taken."""

    def __init__(self, out: IO[str] | None = None, keys: IO[str] | None = None) -> None:
        self._out, self._keys = out or sys.stdout, keys or sys.stdin
        self._selected: Body | None = None
        self._grip: Grip | None = None
        self._target = Vec3(0, 0, 0)
        self._middle, self._size = np.zeros(3), 0.0
        self._said, self._said_for = "", 0
        self._modes: Any = None

    def open(self, world: World) -> None:
        if self._keys.isatty():
            import termios
            import tty

            self._modes = termios.tcgetattr(self._keys)
            tty.setcbreak(self._keys)
        self._out.write(CLEAR)

    def close(self) -> None:
        if self._modes is not None:
            import termios

            termios.tcsetattr(self._keys, termios.TCSADRAIN, self._modes)
        self._out.write(f"{PLAIN}\n")
        self._out.flush()

    def notice(self, title: str, text: str, hint: str) -> None:
        self._said, self._said_for = " - ".join(filter(None, (title, text, hint))), NOTICE_FRAMES

    def frame(self, world: World) -> None:
        for key in self._pressed():
            self._act(world, key)
        columns, rows = shutil.get_terminal_size()
        lines = [(body, list(lines_of(body))) for body in world.system.bodies if body.kind != "inactive"]
        self._follow([line for _, drawn in lines for line in drawn])
        picture = Picture(columns, max(rows - 3, 1), self._middle, self._size)
        for body, drawn in lines:
            for line in drawn:
                picture.draw(line, is_marked=body == self._selected)
        self._said_for -= 1
        actions = "   ".join(f"{action.key}: {action.label}" for action in world.controls.actions if action.key)
        state = f"{world.title}   {world.system.time:.1f} s{'   paused' if world.clock.paused else ''}   {actions}"
        below = (state, KEYS, self._said if self._said_for > 0 else "")
        text = "\r\n".join([*picture.rows(), *(line[:columns].ljust(columns) for line in below)])
        with suppress(BlockingIOError):  # a slow terminal misses a picture
            self._out.write(HOME + text)
            self._out.flush()

    def _pressed(self) -> Iterator[str]:
        """Keys since the last frame; those of several characters as one."""
        if self._modes is None or not select.select([self._keys], [], [], 0)[0]:
            return
        text = os.read(self._keys.fileno(), 1024).decode(errors="ignore")
        while text:
            key = next((arrow for arrow in ARROWS if text.startswith(arrow)), text[0])
            text = text[len(key) :]
            yield key

    def _act(self, world: World, key: str) -> None:
        action = next((action for action in world.controls.actions if action.key == key), None)
        if action is not None:
            world.controls.act(action.name, self._selected if action.on == "body" else None)
        elif key == "q":
            world.stop()
        elif key == " ":
            world.clock.paused = not world.clock.paused
        elif key == "r":
            world.reset()
            self._let_go()
        elif key == "\t":
            self._let_go()
            self._select_next([body for body in world.system.bodies if body.kind == "dynamic" and not body.is_spark])
        elif key == "\x1b":
            self._let_go()
        elif key in ARROWS and self._selected is not None and self._selected.alive:
            self._pull(world, *ARROWS[key])

    def _select_next(self, bodies: Sequence[Body]) -> None:
        after = [body for body in bodies if self._selected is not None and body.slot > self._selected.slot]
        self._selected = next(iter(after or bodies), None)

    def _pull(self, world: World, right: float, up: float) -> None:
        body = self._selected
        assert body is not None
        if self._grip is None or not self._grip.alive:
            self._target = body.center_of_mass
            self._grip = world.system.grip(body, (0, 0, 0), self._target, client=0, hold=0)
        across, above, _ = view_axes()
        self._target = self._target + Vec3(*((right * across + up * above) * PULL * self._size))
        self._grip.move(self._target)

    def _let_go(self) -> None:
        if self._grip is not None and self._grip.alive:
            self._grip.destroy()
        self._grip = None

    def _follow(self, lines: Sequence[Points]) -> None:
        """Keeps the first view until something leaves it."""
        if not lines:
            return
        points = np.concatenate(lines)
        low, high = points.min(axis=0), points.max(axis=0)
        size = max(float(np.linalg.norm(high - low)), 1e-9)
        away = np.abs((low + high) / 2 - self._middle).max()
        if size > 1.5 * self._size or size < 0.4 * self._size or away > 0.4 * self._size:
            self._middle, self._size = (low + high) / 2, size


class Picture:
    """Dots in cells of 2 x 4. middle: world, m. size: of the scene, m."""

    def __init__(self, columns: int, rows: int, middle: Points, size: float) -> None:
        self._cells = np.zeros((rows, columns), np.uint8)
        self._marks = np.zeros((rows, columns), bool)
        self._middle = middle
        self._scale = min(2 * columns, 4 * rows) / (1.1 * size) if size > 0 else 1.0

    def draw(self, line: Points, is_marked: bool) -> None:
        """Straight pieces through points, (n, 3), m."""
        across, above, _ = view_axes()
        rows, columns = self._cells.shape
        x = columns + (line - self._middle) @ across * self._scale
        y = 2 * rows - (line - self._middle) @ above * self._scale
        for begin in range(max(len(line) - 1, 1)):
            end = min(begin + 1, len(line) - 1)
            count = int(min(max(abs(x[end] - x[begin]), abs(y[end] - y[begin])), 4096)) + 1
            for dot_x, dot_y in zip(
                np.linspace(x[begin], x[end], count + 1).astype(int),
                np.linspace(y[begin], y[end], count + 1).astype(int),
                strict=True,
            ):
                if 0 <= dot_x < 2 * columns and 0 <= dot_y < 4 * rows:
                    self._cells[dot_y // 4, dot_x // 2] |= DOTS[dot_y % 4][dot_x % 2]
                    self._marks[dot_y // 4, dot_x // 2] |= is_marked

    def rows(self) -> Iterator[str]:
        """Lines of text; what is marked is colored."""
        for cells, marks in zip(self._cells, self._marks, strict=True):
            row = ""
            for number, (cell, mark) in enumerate(zip(cells, marks, strict=True)):
                if mark != (marks[number - 1] if number else False):
                    row += MARKED if mark else PLAIN
                row += chr(0x2800 + int(cell)) if cell else " "
            yield row + PLAIN


def view_axes() -> tuple[Points, Points, Points]:
    """To the right, up, and towards the viewer: unit vectors of the world."""
    across = np.array([np.cos(YAW), 0, -np.sin(YAW)])
    toward = np.array([np.sin(YAW) * np.cos(PITCH), np.sin(PITCH), np.cos(YAW) * np.cos(PITCH)])
    return across, np.cross(toward, across), toward


def lines_of(body: Body) -> Iterator[Points]:
    """The outline of a body: the outlines of its solids, or else a line through its particles. World, m."""
    if body.solids:
        for solid in body.solids:
            yield from outline(solid)
    elif body.particles:
        yield np.array([list(particle.position) for particle in body.particles])


def support_points(shape: Shape, directions: Points) -> Points:
    """The points of a bounded shape, or of its convex hull, that are farthest in some directions, in its frame: (n, 3), m."""
    # The point nearest to a far place is the farthest in its direction.
    far = 1e3 * max(abs(number) for number in shape.numbers)
    return np.array([tuple(shape.closest(tuple(far * direction))) for direction in directions])


@lru_cache(maxsize=256)
def silhouettes(shape: Shape) -> list[Points]:
    """The outlines of a shape, or of its convex hull, seen along each axis of its frame; none of an endless shape. m."""
    if not np.isfinite(shape.bounds).all():
        return []
    turn = np.linspace(0, 2 * np.pi, 25)
    circle = np.stack([0 * turn, np.cos(turn), np.sin(turn)], axis=1)
    return [support_points(shape, np.roll(circle, axis, axis=1)) for axis in range(3)]


def outline(solid: Solid) -> Iterator[Points]:
    shape = solid.shape
    if isinstance(shape, Box):
        corners = np.array([[x, y, z] for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)]) * list(
            shape.size
        )
        local = [corners[[a, b]] for a in range(8) for b in range(a + 1, 8) if (a ^ b).bit_count() == 1]
    elif isinstance(shape, Mesh):
        local = [np.asarray(shape.vertices)[[*corners, corners[0]]] for corners in np.asarray(shape.triangles)[:500]]
    else:
        local = silhouettes(shape)
    axes = axes_of(solid.orientation)
    for line in local:
        yield line @ axes.T + list(solid.position)
