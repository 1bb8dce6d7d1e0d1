# SPDX-License-Identifier: Apache-2.0
"""The people in a World."""

from __future__ import annotations

from iota._core import Body
from iota.world.clients import Client, Clients
from iota.world.notices import Notices
from iota.world.parts import Part


class Users(Part):
    """People: their pages, what they hold and select, cards for them.

    if world.users.held() == ball: world.users.notice("You have it")
    """

    def __init__(self, clients: Clients, notices: Notices) -> None:
        self._clients, self._notices = clients, notices

    @property
    def clients(self) -> list[Client]:
        """The open pages."""
        return list(self._clients.by_id.values())

    def held(self, client: int | None = None) -> Body | None:
        """The body that a client holds, or that anyone holds."""
        return self._clients.held(client)

    def selected(self, client: int) -> Body | None:
        """The body that a client has selected."""
        return self._clients.selected(client)

    def notice(self, title: str, text: str = "", hint: str = "", level: str = "info", client: int = 0) -> None:
        """Shows a small card on all pages, or on one client's. level: "info", "warning" or "error"."""
        self._notices.send(title, text, hint, level, client)

    def send_away(self, client: int) -> None:
        """Closes the page of a client. From another machine it does not come back, unless it has the host's address."""
        if self._clients.send_away is not None:
            self._clients.send_away(client)
