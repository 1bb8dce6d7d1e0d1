# SPDX-License-Identifier: Apache-2.0
"""Recordings of what the server says, and the page that plays them without one."""

from __future__ import annotations

import gzip
import os
import random
import struct
import subprocess
import sys
import textwrap
import tracemalloc
from pathlib import Path
from typing import Any

import pytest
from pages import listen_for_complaints, needs_browser, open_page

import iota as iota_package
from iota._protocol import PROTOCOL_VERSION
from iota.film import Film, stream
from iota.film.files import Failed
from iota.film.stream import check_version, pack, read_file, unpack, write_stream

SPEED, BREAK = 1.5, 0.5  # m/s; s, when the ball loses its tail


def test_a_stream_is_read_as_it_was_written_and_refused_otherwise() -> None:
    frames = [(0.0, b"one"), (0.5, b""), (0.5, bytes(range(256))), (2.25, b"last")]
    packed = pack(frames)
    assert unpack(packed) == (frames, True) and pack(frames) == packed
    for bad in (b"", b"something else", packed[:20], b"\x1f\x8b" + bytes(20)):
        with pytest.raises(Failed):
            unpack(bad)


def test_a_stream_that_is_cut_is_read_up_to_its_last_whole_message() -> None:
    frames = [(0.1 * number, bytes(random.Random(number).randbytes(500))) for number in range(20)]
    packed = pack(frames)
    for end in range(len(packed) // 4, len(packed), 97):
        messages, is_complete = unpack(packed[:end])
        assert messages == frames[: len(messages)] and not is_complete
        assert len(messages) >= 20 * end // len(packed) - 3


def welcome(version: int) -> bytes:
    return struct.pack("<BH", stream.WELCOME, version) + bytes(8)


def test_a_file_that_grows_beyond_a_limit_is_refused_without_unpacking_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(stream, "MOST_UNPACKED", 1 << 20)
    bomb = gzip.compress(stream.MAGIC + bytes(50 << 20))
    assert len(bomb) < 1 << 17
    tracemalloc.start()
    with pytest.raises(Failed, match="more than 1 MiB when it is unpacked"):
        unpack(bomb)
    assert tracemalloc.get_traced_memory()[1] < 8 << 20
    tracemalloc.stop()
    monkeypatch.setattr(stream, "MOST_PACKED", 1000)
    (tmp_path / "large.iota").write_bytes(bomb)
    with pytest.raises(Failed, match="it has more than"):
        read_file(tmp_path / "large.iota")


@pytest.mark.skipif(sys.platform == "win32", reason="has neither")
def test_a_pipe_or_a_device_is_refused_at_once(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe.iota")
    for path in (tmp_path / "pipe.iota", Path("/dev/zero")):
        with pytest.raises(Failed, match="pipe or a device"):
            read_file(path)


def test_messages_of_another_version_are_refused(tmp_path: Path) -> None:
    check_version([(0.0, welcome(PROTOCOL_VERSION)), (1.0, b"more")])
    (tmp_path / "old.iota").write_bytes(pack([(0.0, welcome(3))]))
    done = iota("play", tmp_path / "old.iota", "--no-open")
    assert (
        done.returncode == 1
        and f"version 3 of the protocol, and this iota plays version {PROTOCOL_VERSION}" in done.stderr
    )
    for first in (b"", b"@", bytes(9)):
        with pytest.raises(Failed, match="does not begin with a welcome"):
            check_version([(0.0, first)])


def test_the_recording_of_a_system_is_told_from_one_of_pages() -> None:
    system = iota_package.System()
    system.start_recording()
    with pytest.raises(Failed, match=r"Recording\.load"):
        unpack(system.stop_recording().to_bytes())


def test_an_ending_in_capitals_is_the_same_ending(tmp_path: Path) -> None:
    frames = [(0.0, b"one"), (0.5, b"two")]
    write_stream(tmp_path / "A.IOTA", frames, "a title")
    assert unpack((tmp_path / "A.IOTA").read_bytes()) == (frames, True)
    assert Film(tmp_path / "A.MP4").is_drawn and not Film(tmp_path / "A.IOTA").is_drawn


def iota(*arguments: str | Path) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "iota", *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, timeout=170, stdin=subprocess.DEVNULL)


def test_a_file_that_cannot_be_played_is_reported_in_one_line(tmp_path: Path) -> None:
    (tmp_path / "bad.iota").write_bytes(b"bad")
    for arguments, words in (
        (["none.iota"], "No such file"),
        ([tmp_path / "bad.iota", "-o", tmp_path / "page.html"], "not a recording"),
        ([tmp_path / "bad.iota", "-o", tmp_path / "page.txt"], "must end in .html"),
        ([tmp_path, "-o", tmp_path / "page.html"], "there is no journal"),
    ):
        done = iota("play", "--no-open", *arguments)
        assert done.returncode == 1 and words in done.stderr and done.stderr.count("\n") == 1, done.stderr
    assert not (tmp_path / "page.html").exists()


@needs_browser
def test_the_page_shows_the_scene_of_any_time_without_a_server(tmp_path: Path) -> None:
    script = tmp_path / "ball.py"
    script.write_text(
        textwrap.dedent(f"""
        import iota
        def build():
            system = iota.System(gravity=(0, 0, 0))
            system.body().particle((-1, 1, 0), velocity=({SPEED}, 0, 0))
            tail = system.body().particle((0, 2, 0))
            world = iota.World(system, title="a <b>ball</b>")
            world.at({BREAK})(lambda: tail.body.destroy())
            return world
        """)
    )
    stream, page_file, direct = tmp_path / "ball.iota", tmp_path / "played.html", tmp_path / "ball.html"
    for arguments in (
        ("record", script, "-o", stream, "--seconds", "1", "--size", "64x48"),
        ("record", script, "-o", direct, "--seconds", "1", "--size", "64x48"),
        ("play", stream, "-o", page_file, "--no-open"),
    ):
        done = iota(*arguments)
        assert done.returncode == 0 and done.stderr == "", done.stderr
    assert {file.suffix for file in tmp_path.iterdir() if file.is_file()} == {".py", ".iota", ".html"}
    for file in (page_file, direct):
        with open_page(offline=True) as page:
            look(page, file)


@needs_browser
def test_the_page_says_that_it_lacks_drawings_by_code_of_the_script(tmp_path: Path) -> None:
    (tmp_path / "flower.js").write_text('iota.define("flower", { make: () => new iota.three.Group() });')
    script = """
        import iota
        def build():
            system = iota.System()
            system.body().particle((0, 1, 0)).nail()
            world = iota.World(system)
            {own}
            return world
        """
    own = f"world.pages.client_module({str(tmp_path / 'flower.js')!r}); world.drawings.custom('flower')"
    with open_page() as page:
        for name, line, told in (("own", own, ["flower.js"]), ("usual", "pass", [])):
            (tmp_path / f"{name}.py").write_text(textwrap.dedent(script).format(own=line))
            file = tmp_path / f"{name}.html"
            done = iota("record", tmp_path / f"{name}.py", "-o", file, "--seconds", "0.2", "--size", "64x48")
            assert done.returncode == 0, done.stderr
            page.goto(file.as_uri())
            page.wait_for_function("() => globalThis.iota?.connected && iota.bodies().length > 0", timeout=60_000)
            shown = page.locator(".note:visible").all_inner_texts()
            assert len(shown) == len(told) and all(word in text for word, text in zip(told, shown, strict=True))


def look(page: Any, file: Path) -> None:
    """Sets the slider to some times, there and back, and compares."""
    complaints = listen_for_complaints(page)
    page.on("request", lambda request: complaints.append(request.url) if request.url.startswith("http") else None)
    page.goto(file.as_uri())
    page.wait_for_function("() => globalThis.iota?.connected && iota.bodies().length > 0", timeout=60_000)
    page.get_by_role("button", name="Pause").click()
    for time in (0.9, 0.2, 0.6, 0.0):
        page.locator("input").evaluate(
            "(slider, time) => { slider.value = time; slider.dispatchEvent(new Event('input')); }", time
        )
        page.wait_for_function(f"() => iota.bodies().length === {1 if time > BREAK else 2}", timeout=20_000)
        expected = -1 + SPEED * (int(time * 30 + 1e-6) / 30)
        page.wait_for_function(f"() => Math.abs(iota.bodyPosition(0)[0] - {expected}) < 0.01", timeout=20_000)
        assert page.evaluate("iota.time") == pytest.approx(int(time * 30 + 1e-6) / 30, abs=0.01)
    if file.stem == "played":
        page.wait_for_timeout(2500)  # longer than between two signs of life
    assert page.evaluate("iota.connected") and complaints == []
    assert file.stem == "played" or page.title() == "a <b>ball</b>"
