# SPDX-License-Identifier: Apache-2.0
"""A headless browser that draws a world's page frame by frame, with a clock that we control."""

from __future__ import annotations

import base64
import logging
import os
import shutil
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from iota.extras import how_to_get
from iota.film.files import Failed

NAMES = ("chromium-headless-shell", "chromium", "chromium-browser", "google-chrome", "google-chrome-stable", "chrome")
FLAGS = (
    "--no-sandbox",
    "--disable-quic",
    "--no-first-run",
    "--ignore-gpu-blocklist",
    "--use-gl=angle",
    "--use-angle=gl-egl",
)
PATIENCE = 30.0  # s, within which the page has to show a state


class FilmPage:
    """The page of a world. Its clock stops between two frames."""

    def __init__(self, page: Any) -> None:
        self._page = page
        self._told: list[bytes] = []
        page.on("websocket", lambda socket: socket.on("framereceived", lambda data: self._told.append(bytes(data))))

    def take_frames(self) -> list[bytes]:
        """The server's messages since the last call."""
        told, self._told[:] = list(self._told), []
        return told

    def pass_time(self, seconds: float) -> None:
        """Pauses drawing in the page."""
        self._page.clock.fast_forward(round(seconds * 1000))

    def wait_for(self, step: int, meanwhile: Callable[[], None] = lambda: None) -> None:
        """Waits until the page has received a step. Raises Failed after PATIENCE seconds."""
        end = time.monotonic() + PATIENCE
        while not self._page.evaluate(f"globalThis.iota?.page.world.poses.count > 0 && iota.step === {step}"):
            if time.monotonic() > end:
                raise Failed("the page does not show the world. Try: open it in a browser by iota run, and look there")
            meanwhile()
            time.sleep(0.002)

    def next_picture(self, seconds: float, plots: bool = False) -> bytes:
        """Advances the clock of the page and begins to draw it. The picture before: a JPEG file, empty if there is none."""
        self.pass_time(seconds)
        return self._decoded(f"iota.nextFilmFrame({str(plots).lower()})")

    def last_picture(self) -> bytes:
        """The picture that was begun last."""
        return self._decoded("iota.lastFilmFrame()")

    def _decoded(self, call: str) -> bytes:
        address: str = self._page.evaluate(call)
        return base64.b64decode(address.partition(",")[2])


@contextmanager
def open_browser(purpose: str = "films") -> Iterator[Any]:
    """A headless browser of Playwright, for one thread. Raises Failed if none can be started."""
    try:
        from playwright.sync_api import Error, sync_playwright
    except ImportError:
        raise Failed(f"{purpose} need the package playwright. {how_to_get('film')}") from None
    environment = {**os.environ, "LIBGL_ALWAYS_SOFTWARE": os.environ.get("LIBGL_ALWAYS_SOFTWARE", "1")}
    with sync_playwright() as playwright:
        program = find_browser() or playwright.chromium.executable_path
        if not Path(program).is_file():
            raise Failed(f"{purpose} need Chromium. Try: apt-get install chromium, or: playwright install chromium")
        try:
            browser = playwright.chromium.launch(executable_path=program, args=list(FLAGS), env=environment)
        except Error as error:
            raise Failed(f"{program} cannot be started: {error.message.splitlines()[0]}") from None
        try:
            yield browser
        except KeyboardInterrupt:
            logging.getLogger(
                "asyncio"
            ).disabled = True  # Ctrl-C also ends Playwright's own process, which would log an error
            raise
        except Error as error:
            raise Failed(f"the browser failed: {error.message.splitlines()[0]}") from None
        finally:
            browser.close()


@contextmanager
def film_page(url: str, width: int, height: int) -> Iterator[FilmPage]:
    """The page at an address with a token, of that size, px. Raises Failed if no browser can be started."""
    with open_browser() as browser:
        page = browser.new_page(viewport={"width": width, "height": height})
        page.clock.install(time=0)
        page.clock.pause_at(1)
        film = FilmPage(page)
        page.goto(f"{url}&film")
        yield film


def find_browser() -> str | None:
    """The one that $CHROMIUM names, or the system's; None: Playwright's own, if installed."""
    return os.environ.get("CHROMIUM") or next(filter(None, map(shutil.which, NAMES)), None)
