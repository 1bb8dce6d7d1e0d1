# SPDX-License-Identifier: Apache-2.0
"""Earlier states of a world."""

from __future__ import annotations

from iota._core import System
from iota.world.clients import Clients


class History:
    """Goes to another state of the system; the holds of users end, those of then too. earlier: states of the run before, with their times, s."""

    def __init__(self, system: System, clients: Clients) -> None:
        self._system, self._clients = system, clients
        self.earlier: list[tuple[float, bytes]] = []

    def undo(self) -> bool:
        """False if there is nothing to undo."""
        return self._moved(self._system.undo())

    def redo(self) -> bool:
        """False if there is nothing to repeat."""
        return self._moved(self._system.redo())

    def restore(self, snapshot: bytes) -> None:
        self._system.restore(snapshot)
        self._moved(True)

    def _moved(self, is_another: bool) -> bool:
        if is_another:
            self._clients.end_restored()
        return is_another
