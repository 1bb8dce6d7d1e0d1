# SPDX-License-Identifier: Apache-2.0
"""Sounds of a script: what is read, what is refused, and what pages are sent."""

from __future__ import annotations

import io
import wave
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from page_client import PageClient

import iota
from iota.sounds import MOST_BYTES, make_wav, sound_file

Runner = Callable[[iota.World], str]
TONE = 0.5 * np.sin(2 * np.pi * 440 * np.arange(2205) / 22050)


@pytest.mark.parametrize("samples", [TONE, np.column_stack([TONE, -TONE])])
def test_an_array_becomes_a_wav_file_of_its_samples(samples: np.ndarray[Any, Any]) -> None:
    with wave.open(io.BytesIO(make_wav(samples, 22050))) as file:
        assert (file.getframerate(), file.getnframes(), file.getsampwidth()) == (22050, len(samples), 2)
        found = np.frombuffer(file.readframes(len(samples)), "<i2").reshape(len(samples), -1) / 32767
    assert found == pytest.approx(samples.reshape(len(samples), -1), abs=1e-4)


@pytest.mark.parametrize(
    ("data", "said"),
    [
        (None, "no such file"),
        (b"", "neither a WAV, MP3, Ogg nor FLAC"),
        (b"\x89PNG\r\n\x1a\n" + bytes(100), "neither a WAV, MP3, Ogg nor FLAC"),
        (b"OggS" + bytes(MOST_BYTES), "has 1.0 MiB, more than 1"),
    ],
)
def test_a_file_that_cannot_be_used_is_refused_by_its_name(tmp_path: Path, data: bytes | None, said: str) -> None:
    path = tmp_path / "bell.ogg"
    if data is not None:
        path.write_bytes(data)
    world = iota.World(iota.System())
    with pytest.raises(ValueError, match=rf"sound '.*bell\.ogg': .*{said}"):
        world.drawings.sound(path)
    assert world.drawings.things == []


@pytest.mark.parametrize(
    ("make", "said"),
    [
        (lambda w: w.drawings.sound(np.zeros((3, 3))), r"\(n,\) or \(n, 2\)"),
        (lambda w: w.drawings.sound(np.zeros(0)), r"\(n,\) or \(n, 2\)"),
        (lambda w: w.drawings.sound(TONE, rate=4), "rate is from"),
        (lambda w: w.drawings.sound(np.full(9, np.nan)), "finite"),
        (lambda w: w.drawings.sound(np.zeros(MOST_BYTES)), "has 2.0 MiB"),
        (lambda w: w.drawings.sound(TONE, reach=-1), "reach: must be"),
        (lambda w: w.drawings.sound(TONE).play((0, 0, 0), volume=11), "volume must be from 0 to 10"),
        (lambda w: w.drawings.effect("impact", (0, 0, 0), volume=float("nan")), "volume must be from 0 to 10"),
        (lambda w: w.drawings.effect("bang", (0, 0, 0)), "kind must be one of"),
        (lambda w: w.drawings.sound(TONE).play((0, float("inf"), 0)), "finite"),
    ],
)
def test_sounds_that_cannot_be_are_refused(make: Callable[[iota.World], Any], said: str) -> None:
    with pytest.raises(ValueError, match=said):
        make(iota.World(iota.System()))


def test_a_sound_is_sent_once_and_played_where_its_body_is(run_world: Runner, tmp_path: Path) -> None:
    system = iota.System(gravity=(0, 0, 0))
    ball = system.body(shape=iota.Sphere(0.1), mass=1.0, position=(1, 2, 3))
    world = iota.World(system, ground=None)
    path = tmp_path / "tone.wav"
    path.write_bytes(make_wav(TONE, 22050))
    bell = world.drawings.sound(path, reach=2)
    with PageClient(run_world(world)) as page:
        told = page.wait_for(lambda: page.entities["sound"].get(0))
        assert told["file"] == path.read_bytes() and told["reach"] == 2
        told_before = page.told
        world.call(
            lambda: [bell.play(ball, volume=0.5), bell.play((0, 1, 0)), world.drawings.effect("impact", (1, 1, 1), 2)]
        )
        page.wait_for(lambda: len(page.effects) == 3)
        assert page.effects[0] == {"kind": f"#{told['name']}", "position": (1, 2, 3), "volume": 0.5}
        assert page.effects[1]["position"] == (0, 1, 0)
        assert page.effects[2] == {"kind": "impact", "position": (1, 1, 1), "volume": 2}
        assert page.told == told_before, "a play sends no file"
        world.call(bell.destroy)
        page.wait_for(lambda: not page.entities["sound"])
    with pytest.raises(RuntimeError, match="destroyed"):
        bell.play(ball)


def test_equal_files_have_one_name() -> None:
    assert sound_file(TONE).name == sound_file(TONE.copy()).name != sound_file(-TONE).name
