# SPDX-License-Identifier: Apache-2.0
"""The people in a World."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from iota._core import Body
from iota.world.callbacks import Guard
from iota.world.clients import Client, Clients
from iota.world.controls import Controls
from iota.world.events import Events
from iota.world.notices import Notices, Place
from iota.world.parts import Part
from iota.world.survey import Survey

Call = Callable[[Callable[[], Body | None]], Body | None]


class Users(Part):
    """People: their pages, what they hold and select, cards for them.

    if world.users.held() == ball: world.users.notice("You have it")
    """

    def __init__(
        self,
        clients: Clients,
        notices: Notices,
        controls: Controls,
        events: Events,
        guard: Guard,
        title: str,
        call: Call,
    ) -> None:
        """call: runs a function on the thread that runs the world."""
        self._clients, self._notices, self._call = clients, notices, call
        self._controls, self._events, self._guard, self._title = controls, events, guard, title

    @property
    def clients(self) -> list[Client]:
        """The open pages."""
        return list(self._clients.by_id.values())

    def held(self, client: int | None = None) -> Body | None:
        """The body that a client holds, or that anyone holds. From any thread, as is `selected`."""
        return self._call(lambda: self._clients.held(client))

    def selected(self, client: int) -> Body | None:
        """The body that a client has selected."""
        return self._call(lambda: self._clients.selected(client))

    def notice(
        self,
        title: str,
        text: str = "",
        hint: str = "",
        level: str = "info",
        client: int = 0,
        seconds: float | None = None,
        id: str = "",
        place: Place = "free",
    ) -> None:
        """Shows a small card on all pages, or on one client's.

        level: "info", "warning" or "error". seconds: how long, at most a day; None: as usual for its level, math.inf: until
        its user closes it. id: it replaces the card with the same one, and `close_notice` removes it; without one, that with
        the same title. place: "top", "left", "right" or "bottom" of a flat page, or "free": where it covers no label
        and no control.

            world.users.notice("Question 2", "Which falls first?", id="quiz", seconds=30, place="left")

        Raises ValueError for an unknown level or place, a time that is not above 0, or an id above 64 bytes.
        """
        self._notices.send(title, text, hint, level, client, seconds=seconds, id=id, place=place)

    def close_notice(self, id: str, client: int = 0) -> None:
        """Removes the card with this id from all pages, or from one client's. Raises ValueError for an empty id."""
        self._notices.close(id, client)

    def ask(
        self,
        questions: Mapping[str, Any],
        file: str | Path = "answers.csv",
        purpose: str = "",
        on_answer: Callable[..., Any] | None = None,
    ) -> Survey:
        """Asks each visitor questions, on controls of their own page. Their answers are a row of a CSV file, once they agree and send
        them: the time (UTC), a random number, the title of the world and the answers, but no name. questions: by their text:
        str for a free answer, a list of choices, or a range (low, high). file: rows are added, each complete or not at all, also by
        several worlds. purpose: what the answers are for, shown where visitors agree. on_answer: called after each, with one Event
        or nothing. Raises ValueError for a file with other questions, OSError for one that cannot be written.

            world.ask({"What was your impression of the motion?": str, "Was it plausible?": ["yes", "partly", "no"]})
        """
        given = (self._controls, self._events, self._clients, self._notices, self._guard)
        return Survey(questions, file, purpose, self._title, *given, on_answer)

    def send_away(self, client: int) -> None:
        """Closes the page of a client. From another machine it does not come back, unless it has the host's address."""
        if self._clients.send_away is not None:
            self._clients.send_away(client)
