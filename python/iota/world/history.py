# SPDX-License-Identifier: Apache-2.0
"""Earlier states of a world."""

from __future__ import annotations

from iota._core import System
from iota.world.clients import Clients
from iota.world.listeners import Listeners


class History:
    """Goes to another state of the system; the holds of users end."""

    def __init__(self, system: System, clients: Clients, listeners: Listeners) -> None:
        self._system, self._clients, self._listeners = system, clients, listeners

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
        """The restored grips belong to no present grab."""
        if is_another:
            self._clients.forget()
            self._listeners.take_away("reset")
        return is_another
