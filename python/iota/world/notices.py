# SPDX-License-Identifier: Apache-2.0
"""Small cards with messages for users."""

from __future__ import annotations

from collections.abc import Callable

LEVELS = ("info", "warning", "error")
MOST_WARNINGS = 100

Show = Callable[
    [int, int, str, str, str, bool], object
]  # client (0: all), number of the level, title, text, hint, keep
Forget = Callable[[str], object]  # a title, or nothing for all


class Notices:
    """Shows cards by `show`, which is set while the world is served.

    The server keeps errors of the script, so that pages that open later show them too."""

    def __init__(self) -> None:
        self.show: Show | None = None
        self.forget: Forget | None = None
        self._warnings: set[str] = set()

    def send(
        self, title: str, text: str = "", hint: str = "", level: str = "info", client: int = 0, keep: bool = False
    ) -> None:
        """Shows a card on all pages, or on one client's. keep: pages that open later show it too. Raises ValueError for
        an unknown level."""
        if level not in LEVELS:
            raise ValueError(f"level must be one of {', '.join(LEVELS)}, not {level!r}")
        if self.show is not None:
            self.show(client, LEVELS.index(level), title, text, hint, keep)

    def error(self, title: str, text: str, hint: str) -> None:
        """An error of the script, kept until `over`."""
        self.send(title, text, hint, "error", keep=True)

    def warning(self, title: str, text: str, hint: str) -> None:
        """A warning about the present state, kept until `over`."""
        self.send(title, text, hint, "warning", keep=True)

    def over(self, title: str = "") -> None:
        """Pages that open from now on do not show the kept cards with a title, or all."""
        if self.forget is not None:
            self.forget(title)

    def warn_once(self, text: str, keep: bool = False) -> None:
        """Shows a text only once. keep: pages that open later show it too, until `over`."""
        if text not in self._warnings and len(self._warnings) < MOST_WARNINGS:
            self._warnings.add(text)
            self.send("Note", text, level="warning", keep=keep)
