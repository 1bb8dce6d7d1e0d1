# SPDX-License-Identifier: Apache-2.0
"""A world in a terminal, drawn with Braille dots: `iota run NAME --terminal`, for machines without a browser."""

from __future__ import annotations

import os
import select
import shutil
import sys
from collections.abc import Iterator, Sequence
from contextlib import suppress
from typing import IO, Any

import numpy as np

from iota._core import Body, Grip, Vec3
from iota.world.braille import PLAIN, Picture, Points, frame_of, lines_of_all, view_axes
from iota.world.view import View
from iota.world.world import World

CLEAR, HOME = "\x1b[2J", "\x1b[H"
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
        lines = lines_of_all(world.system)
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
        middle, size = frame_of(lines)
        away = np.abs(middle - self._middle).max()
        if size > 1.5 * self._size or size < 0.4 * self._size or away > 0.4 * self._size:
            self._middle, self._size = middle, size
