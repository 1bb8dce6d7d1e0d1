# SPDX-License-Identifier: Apache-2.0
"""Names of keys as browsers have them (KeyboardEvent.key), from the usual ones."""

from __future__ import annotations

from typing import Any

from iota.arguments import SHORT, suggestion

LONG = (
    "Enter",
    "Escape",
    "Tab",
    "Backspace",
    "Delete",
    "Insert",
    "Home",
    "End",
    "PageUp",
    "PageDown",
    "Shift",
    "Control",
    "Alt",
)
ARROWS = ("ArrowUp", "ArrowDown", "ArrowLeft", "ArrowRight")
KNOWN = {name.lower(): name for name in (*LONG, *ARROWS, *(f"F{number}" for number in range(1, 13)))}
KNOWN |= {name.removeprefix("Arrow").lower(): name for name in ARROWS}
KNOWN |= {"space": " ", "return": "Enter", "esc": "Escape", "ctrl": "Control", "del": "Delete"}


def key_name(key: Any) -> str:
    """ " " of "space", "ArrowUp" of "up"; one character is itself. Raises ValueError for what is no key of a page."""
    if isinstance(key, str) and (len(key) == 1 or key.lower() in KNOWN):
        return KNOWN.get(key.lower(), key) if len(key) > 1 else key
    near = suggestion(key.lower(), list(KNOWN)) if isinstance(key, str) else ""
    raise ValueError(
        f"a key is one character, as 'k', or a name, as 'space', 'Enter' or 'ArrowUp', not {SHORT.repr(key)}{near}"
    )
