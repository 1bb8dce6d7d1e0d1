# SPDX-License-Identifier: Apache-2.0
"""`iota record`: films as others see them, decoded again; and what it says when it cannot."""

from __future__ import annotations

import os
import re
import subprocess
import sys
import textwrap
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import iota
from iota.cli.record import Bar
from iota.film import browser, unpack

av = pytest.importorskip("av")
pytest.importorskip("playwright")
needs_browser = pytest.mark.skipif(browser.find_browser() is None, reason="there is no Chromium")

SPEED, RATE, SECONDS = 1.0, 20, 1.5


@pytest.fixture
def script(tmp_path: Path) -> Path:
    """A red ball that crosses the view at a constant speed; its steps are longer than the pictures are apart."""
    path = tmp_path / "ball.py"
    path.write_text(
        textwrap.dedent(f"""
        import iota
        from iota import looks

        def build():
            system = iota.System(gravity=(0, 0, 0))
            ball = system.body().particle((-0.8, 1, 0), velocity=({SPEED}, 0, 0))
            world = iota.World(system, dt=1 / 120, camera=iota.Camera((0, 1, 4), (0, 1, 0)))
            world.draw(ball.body, looks.sphere(0.15, "paint", color="#ff0000"))
            return world
        """)
    )
    return path


def record(*arguments: str | Path, **environment: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "iota", "record", *map(str, arguments)]
    return subprocess.run(
        command,
        capture_output=True,
        text=True,
        timeout=170,
        stdin=subprocess.DEVNULL,
        env={**os.environ, **environment},
    )


def red_center(pixels: Any) -> float:
    """Middle of what is red, px from the left; highlights and what is mirrored at a rim are paler."""
    red, green, blue = (pixels[..., channel].astype(int) for channel in range(3))
    _, x = np.nonzero(red - np.maximum(green, blue) > 40)
    return float(x.mean()) + 0.5


@needs_browser
def test_a_film_opens_where_the_browser_reports_no_paint(monkeypatch: pytest.MonkeyPatch) -> None:
    """As on a busy machine; a page that people look at waits for that."""

    class WithoutPaint(browser.FilmPage):
        def __init__(self, page: Any) -> None:
            page.add_init_script("globalThis.PerformanceObserver = class { observe() {} }")
            super().__init__(page)

    monkeypatch.setattr(browser, "FilmPage", WithoutPaint)
    system = iota.System()
    system.body().particle((0, 1, 0))
    world = iota.World(system)
    with browser.film_page(world.serve(port=0), 64, 48) as page:
        page.wait_for(0, meanwhile=lambda: world.advance(0))
    world.close()


def curve_pixels(frame: Any) -> tuple[int, int]:
    """Those in the color of a plot's first curve, 2f9d92, in the left and in the right half; a film blurs them."""
    red, green, blue = (frame[..., channel].astype(int) for channel in range(3))
    is_curve, middle = (green > red + 40) & (blue > red + 30), frame.shape[1] // 2
    return int(is_curve[:, :middle].sum()), int(is_curve[:, middle:].sum())


@pytest.fixture
def plotted(script: Path) -> Path:
    plot = 'world.controls.plot("up", lambda: system.time, seconds=1); return world'
    script.write_text(script.read_text().replace("return world", plot))
    return script


@needs_browser
def test_a_film_is_smooth_and_in_real_time_on_any_machine_and_shows_no_plots(plotted: Path, tmp_path: Path) -> None:
    film, sheet = tmp_path / "ball.mp4", tmp_path / "ball.png"
    done = record(
        plotted, "-o", film, "--sheet", sheet, "--seconds", str(SECONDS), "--rate", str(RATE), "--size", "240x180",
        "--pictures", "3", "--columns", "2",
    )  # fmt: skip
    assert done.returncode == 0 and done.stderr == "", done.stderr
    with av.open(str(film)) as container:
        stream = container.streams.video[0]
        frames = [frame.to_ndarray(format="rgb24") for frame in container.decode(stream)]
        assert stream.average_rate == RATE
    assert len(frames) == SECONDS * RATE and frames[0].shape == (180, 240, 3)
    places = np.array([red_center(frame) for frame in frames])
    pixels = 90 / (4 * np.tan(np.radians(21)))  # of a meter at the ball, whose distance is 4 m
    assert places[0] == pytest.approx(120 - 0.8 * pixels, abs=1.0)
    assert np.diff(places) == pytest.approx(SPEED * pixels / RATE, abs=0.6)
    assert curve_pixels(frames[-1]) == (0, 0)
    with av.open(str(sheet)) as container:
        pixels_of_sheet = next(container.decode(video=0)).to_ndarray(format="rgb24")
    assert pixels_of_sheet.shape == (2 * 180 + 4, 2 * 240 + 4, 3)
    assert red_center(pixels_of_sheet[:180, 244:]) == pytest.approx(places[15], abs=1.0), "the middle one of three"


@needs_browser
def test_a_film_shows_the_plots_of_the_script_on_request(plotted: Path, tmp_path: Path) -> None:
    plotted.write_text(plotted.read_text().replace("#ff0000", "#000000"))
    film = tmp_path / "film.mp4"
    done = record(plotted, "-o", film, "--seconds", "0.9", "--rate", "5", "--size", "480x360", "--plots")
    assert done.returncode == 0, done.stderr
    with av.open(str(film)) as container:
        *_, last = (frame.to_ndarray(format="rgb24") for frame in container.decode(video=0))
    left, right = curve_pixels(last)
    assert left == 0 and right > 40


@needs_browser
def test_a_failure_leaves_the_old_film_and_nothing_else(script: Path, tmp_path: Path) -> None:
    film = tmp_path / "old.mp4"
    film.write_bytes(b"old")
    script.write_text(script.read_text().replace("return world", "world.at(0.05)(lambda: exit(3)); return world"))
    before = set(tmp_path.iterdir())
    done = record(script, "-o", film, "--sheet", tmp_path / "new.png", "--seconds", "1", "--size", "64x48")
    assert done.returncode != 0
    assert film.read_bytes() == b"old"
    assert set(tmp_path.iterdir()) - before <= {tmp_path / "state"}


def test_a_terminal_shows_how_far_the_film_is(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(sys.stderr, "isatty", lambda: False)
    Bar("chain").show(10, 40)
    assert capsys.readouterr().err == ""
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True)
    bar = Bar("chain")
    bar.show(10, 40)
    assert re.match(r"\rchain \[#{7} {23}\] 10/40 frames, \d+ s left", capsys.readouterr().err)
    bar.end()
    assert capsys.readouterr().err == "\r\033[K"


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ((), "name a film by -o"),
        (("-o", "{}/no/film.mp4"), "no folder {}/no"),
        (("-o", "{}/film.avi"), "must end in .mp4"),
        (("--sheet", "{}/sheet.gif"), "must end in .png or .jpg"),
        (("-o", "{}/film.mp4", "--size", "641x480"), "even"),
    ],
)
def test_bad_requests_are_reported_in_one_line(
    script: Path, tmp_path: Path, arguments: tuple[str, ...], words: str
) -> None:
    done = record(script, *(word.format(tmp_path) for word in arguments))
    assert done.returncode == 1 and done.stderr.count("\n") == 1
    assert words.format(tmp_path) in done.stderr
    assert not list(tmp_path.glob("*.mp4"))


def test_a_page_is_made_without_a_browser_and_without_packages_for_films(script: Path, tmp_path: Path) -> None:
    hidden = tmp_path / "without"
    hidden.mkdir()
    for package in ("av", "playwright", "PIL"):
        (hidden / f"{package}.py").write_text("raise ImportError")
    for name in ("page.html", "stream.iota"):
        done = record(script, "-o", tmp_path / name, "--seconds", "0.5", PYTHONPATH=str(hidden), CHROMIUM="none")
        assert done.returncode == 0, done.stderr
    assert "<html" in (tmp_path / "page.html").read_text()
    messages, is_complete = unpack((tmp_path / "stream.iota").read_bytes())
    assert is_complete and len({time for time, _ in messages}) == 15


def test_a_missing_browser_or_package_is_named_with_advice(script: Path, tmp_path: Path) -> None:
    film = tmp_path / "film.mp4"
    done = record(script, "-o", film, CHROMIUM=str(tmp_path / "none"))
    assert done.returncode == 1 and "apt-get install chromium" in done.stderr
    for package in ("av", "playwright"):
        hidden = tmp_path / f"without_{package}"
        hidden.mkdir()
        (hidden / f"{package}.py").write_text("raise ImportError")
        done = record(script, "-o", film, PYTHONPATH=str(hidden))
        assert (
            done.returncode == 1 and f"the package {package}" in done.stderr and "requirements-film.txt" in done.stderr
        )
    assert not film.exists() and not list(tmp_path.glob(".film*"))
