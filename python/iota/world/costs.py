# SPDX-License-Identifier: Apache-2.0
"""The time that each part of a world takes: simulator, functions of the script, pages."""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import contextmanager


class Costs:
    """Seconds that each part has taken since the last `clear`, without the parts that it called. Parts of the script
    are named "script: ..."."""

    def __init__(self) -> None:
        self.seconds: dict[str, float] = {}
        self.is_detailed = False  # times the parts of each step of the simulator
        self._inner: list[float] = []

    def clear(self) -> None:
        self.seconds.clear()

    def split(self, part: str, seconds: dict[str, float]) -> None:
        """Counts seconds of a part under the names of its own parts instead: "part: NAME"."""
        self.seconds[part] = self.seconds.get(part, 0.0) - sum(seconds.values())
        for name, s in seconds.items():
            key = f"{part}: {name}"
            self.seconds[key] = self.seconds.get(key, 0.0) + s

    @contextmanager
    def of(self, part: str) -> Iterator[None]:
        """Adds the time of the with block to a part."""
        self._inner.append(0.0)
        began = time.perf_counter()
        try:
            yield
        finally:
            took = time.perf_counter() - began
            self.seconds[part] = self.seconds.get(part, 0.0) + took - self._inner.pop()
            if self._inner:
                self._inner[-1] += took
