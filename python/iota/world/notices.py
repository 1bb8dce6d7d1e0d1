# SPDX-License-Identifier: Apache-2.0
"""Small cards with messages for users."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Literal, get_args

from iota.arguments import SHORT, is_number

LEVELS = ("info", "warning", "error")
Place = Literal["free", "top", "left", "right", "bottom"]
PLACES: tuple[str, ...] = get_args(Place)
MOST_WARNINGS = 100
LONGEST = 86400.0  # s
LONGEST_ID = 64  # bytes

Show = Callable[
    [int, int, str, str, str, bool, str, float, int], object
]  # client (0: all), number of the level, title, text, hint, keep, id, seconds, number of the place
Forget = Callable[[str], object]  # a title, or nothing for all


class Notices:
    """Shows cards by `show`, which is set while the world is served.

    The server keeps errors of the script, so that pages that open later show them too."""

    def __init__(self) -> None:
        self.show: Show | None = None
        self.forget: Forget | None = None
        self._warnings: set[str] = set()

    def send(
        self,
        title: str,
        text: str = "",
        hint: str = "",
        level: str = "info",
        client: int = 0,
        keep: bool = False,
        seconds: float | None = None,
        id: str = "",
        place: Place = "free",
    ) -> None:
        """Shows a card on all pages, or on one client's. keep: pages that open later show it too. Raises ValueError for
        an unknown level or place, a time that is not above 0, or an id above 64 bytes."""
        if level not in LEVELS:
            raise ValueError(f"level must be one of {', '.join(LEVELS)}, not {level!r}")
        if place not in PLACES:
            raise ValueError(f"place must be one of {', '.join(PLACES)}, not {place!r}")
        if seconds is not None and not (is_number(seconds) and (0 < seconds <= LONGEST or seconds == math.inf)):
            raise ValueError(
                f"seconds must be above 0 and at most {LONGEST:g}, math.inf (until it is closed) or None (as usual), "
                f"not {SHORT.repr(seconds)}"
            )
        if not isinstance(id, str) or len(id.encode()) > LONGEST_ID:
            raise ValueError(f"id must be a text of at most {LONGEST_ID} bytes, not {SHORT.repr(id)}")
        if self.show is not None:
            shown = 0.0 if seconds is None else -1.0 if seconds == math.inf else float(seconds)
            self.show(client, LEVELS.index(level), title, text, hint, keep, id, shown, PLACES.index(place))

    def close(self, id: str, client: int = 0) -> None:
        """Removes the card with an id from all pages, or from one client's. Raises ValueError for an empty one."""
        if not id:
            raise ValueError("a card is closed by the id that its notice got")
        self.over(id)
        self.send("", client=client, id=id)

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
