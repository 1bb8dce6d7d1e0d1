# SPDX-License-Identifier: Apache-2.0
"""A page of a world in a headless browser, at little cost."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import pytest

from iota.film.browser import find_browser, open_browser

needs_browser = pytest.mark.skipif(find_browser() is None, reason="there is no Chromium")

# Software takes most of two cores to fill pixels. All else of a page goes on without them.
LEAVE_OUT_DRAWING = """
for (const name of ["clear", "drawArrays", "drawElements", "drawArraysInstanced", "drawElementsInstanced"])
  WebGL2RenderingContext.prototype[name] = () => {};
"""


@contextmanager
def open_page(width: int = 320, height: int = 240, draws: bool = False, offline: bool = False) -> Iterator[Any]:
    """A page of Playwright, whose window has these sizes in CSS pixels. draws: also fills pixels, for tests that look."""
    pytest.importorskip("playwright.sync_api")
    with open_browser("tests") as chromium:
        context = chromium.new_context(
            viewport={"width": width, "height": height}, device_scale_factor=0.5, offline=offline
        )
        if not draws:
            context.add_init_script(LEAVE_OUT_DRAWING)
        yield context.new_page()


def listen_for_complaints(page: Any) -> list[str]:
    """What scripts of the page throw or tell as errors from now on."""
    complaints: list[str] = []
    page.on("pageerror", lambda error: complaints.append(str(error)))
    page.on("console", lambda told: complaints.append(told.text) if told.type == "error" else None)
    return complaints
