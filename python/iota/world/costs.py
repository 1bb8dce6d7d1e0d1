# SPDX-License-Identifier: Apache-2.0
"""The time that each part of a world takes: simulator, functions of the script, pages."""

from __future__ import annotations

import time


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

    def of(self, part: str) -> Timed:
        """A with block, whose time is added to a part."""
        return Timed(self, part)


class Timed:
    """See `Costs.of`. A class takes a third of the time of a generator: there are two of these in every step."""

    __slots__ = ("_began", "_costs", "_part")

    def __init__(self, costs: Costs, part: str) -> None:
        self._costs, self._part = costs, part

    def __enter__(self) -> None:
        self._costs._inner.append(0.0)
        self._began = time.perf_counter()

    def __exit__(self, *_: object) -> None:
        took = time.perf_counter() - self._began
        seconds, inner = self._costs.seconds, self._costs._inner
        seconds[self._part] = seconds.get(self._part, 0.0) + took - inner.pop()
        if inner:
            inner[-1] += took
