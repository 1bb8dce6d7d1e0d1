# SPDX-License-Identifier: Apache-2.0
"""Actions of the script that users can run."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from iota.world.callbacks import Hook

# Keys of the page, which actions may replace: web/src/page/page_commands.ts and web/src/ui.
PAGE_KEYS = {
    " ": "pause", ".": "one step", "r": "reset", "[": "slower", "]": "faster", "l": "next style", "f": "fly", "g": "grid",
    "j": "follow", **dict.fromkeys("123456789", "viewpoint"), "m": "sound", "p": "picture", "i": "profile", ",": "who is here",
    "0": "first view", "Home": "first view", "?": "help", "Escape": "select nothing", "o": "select several",
    "ArrowRight": "select next", "ArrowDown": "select next", "ArrowLeft": "select previous", "ArrowUp": "select previous",
    **dict.fromkeys("wasdqe", "walk"),
}  # fmt: skip


@dataclass
class Action:
    """A function for a key, a controller button or the panel."""

    name: str
    hook: Hook
    key: str | None
    button: str | None
    help: str
    label: str
    on: str

    @property
    def line(self) -> str:
        """For the terminal: its key, its help, and the page's command that it replaces."""
        taken = PAGE_KEYS.get(self.key or "")
        return f"  {self.key}  {self.help or self.label}" + (f"  (instead of the page's: {taken})" if taken else "")

    def describe(self) -> tuple[str, str, str, str, bool, str]:
        """As arguments of a room."""
        return (self.name, self.key or "", self.label, self.help, self.on == "body", self.button or "")


class Actions:
    """By name, in the order of creation. version: rises with each new one."""

    def __init__(self) -> None:
        self.version = 0
        self._by_name: dict[str, Action] = {}

    def check(self, name: str, key: str | None, button: str | None, on: str) -> None:
        """Raises ValueError for invalid or duplicate actions."""
        if on not in ("body", "world"):
            raise ValueError(f"on must be 'body' or 'world', not {on!r}")
        if button not in (None, "a", "b"):
            raise ValueError(f"button must be 'a', 'b' or None, not {button!r}")
        for other in self:
            if other.name == name:
                raise ValueError(f"there is an action {name!r} already")
            if key is not None and other.key == key:
                raise ValueError(f"the key {key!r} is taken by the action {other.name!r}")

    def add(self, action: Action) -> None:
        self._by_name[action.name] = action
        self.version += 1

    def get(self, name: str) -> Action | None:
        return self._by_name.get(name)

    def __getitem__(self, name: str) -> Action:
        return self._by_name[name]

    def __iter__(self) -> Iterator[Action]:
        return iter(self._by_name.values())
