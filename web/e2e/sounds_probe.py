# SPDX-License-Identifier: Apache-2.0
"""A world with sounds of its own, which keys play, for browser tests."""

from __future__ import annotations

import os
from pathlib import Path
from tempfile import mkdtemp

import numpy as np

import iota
from iota.sounds import make_wav

TONE = np.sin(2 * np.pi * 440 * np.arange(22050) / 22050)


def build() -> iota.World:
    system = iota.System(gravity=(0, 0, 0))
    ball = system.body(shape=iota.Sphere(0.1), mass=1.0, position=(0, 1, 0))
    world = iota.World(system, title="sounds")
    world.camera = iota.Camera(position=(0, 1, 3), target=(0, 1, 0))
    folder = Path(mkdtemp())
    (folder / "tone.wav").write_bytes(make_wav(TONE, 22050))
    (folder / "broken.ogg").write_bytes(b"OggS" + os.urandom(2000))
    tone = world.drawings.sound(folder / "tone.wav", reach=1)
    world.on_key("a")(lambda: tone.play((-3, 1, 3)))
    world.on_key("d")(lambda: tone.play((3, 1, 3)))
    world.on_key("w")(lambda: tone.play((0, 1, -300)))
    world.on_key("s")(lambda: tone.play(ball))
    world.on_key("i")(lambda: world.drawings.effect("impact", (3, 1, 3)))
    world.on_key("x")(lambda: world.drawings.sound(folder / "broken.ogg"))
    world.on_key("y")(lambda: world.drawings.sound(np.zeros(8000 * 65), rate=8000))
    return world
