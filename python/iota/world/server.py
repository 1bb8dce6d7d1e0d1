# SPDX-License-Identifier: Apache-2.0
"""A server that several worlds share."""

from __future__ import annotations

from pathlib import Path

from iota import _core
from iota.world import page
from iota.world.lan import Lan, address


class Server(_core.Server):
    """Serves the page for several worlds on one port; pass it to `World.serve` or `World.start`.

    A page chooses a world by `world=ID` in its address, see `Pages.url`; without it, it shows the first. hello_time: s,
    from the upgrade of a connection to its first frame. folder: of the page, None: the built one. lan: for other machines too,
    by https, see `lan_url`; True, or a `Lan` with a certificate of your own. token: of its hosts, None: that of `iota token`.
    listener: a socket that listens already, which is taken over; -1: none. public_origin: the address of a proxy in front of
    it, such as https://worlds.example.org. gateway: the origin of an `iota rooms` that knows where this
    world is when it has moved to another machine. Raises OSError if the port is in use, ValueError for another kind of address.

        server = iota.Server(port=8080)
        for name, world in worlds.items():
            print(world.start(server=server, id=name))
    """

    def __init__(
        self,
        host: str = "127.0.0.1",
        port: int = 8080,
        hello_time: float = 10.0,
        folder: str | Path | None = None,
        lan: bool | Lan = False,
        token: str | None = None,
        listener: int = -1,
        public_origin: str = "",
        gateway: str = "",
    ) -> None:
        folder = page.page_folder() if folder is None else folder
        certificate, key = "", ""
        if lan:
            certificate, key = (lan if isinstance(lan, Lan) else Lan()).certificate()
            host = "0.0.0.0" if host == "127.0.0.1" else host
        token, frame_token = token or page.token(), _core.make_token()
        guest_token, viewer_token = page.token_for("guest", token), page.token_for("viewer", token)
        self.tokens = [guest_token, viewer_token, token]
        """The secrets of guests, viewers and hosts, see `Pages.link`."""
        self._tokens = {"guest": guest_token, "viewer": viewer_token, "host": token, "frame": frame_token}
        super().__init__(
            host=host,
            port=port,
            page_folder=str(folder),
            token=token,
            guest_token=guest_token,
            viewer_token=viewer_token,
            host_tokens=[frame_token],
            hello_time=hello_time,
            certificate=certificate,
            key=key,
            listener=listener,
            public_origin=public_origin,
            gateway=gateway,
        )
        self.fingerprint = _core.fingerprint(certificate) if lan else None
        """SHA-256 of the certificate, as browsers show it; None without lan."""

    def open_card(self, id: str, title: str, text: str) -> _core.Room:
        """A world that only shows a card, until it is closed."""
        room = self.open(id)
        room.set_settings(title=id, styles=[], style="", camera=None, ground=None, modules=[])
        room.notice(0, 2, title, text, "", True)
        return room

    def link(self, url: str, role: str) -> str:
        """An address of this server with the token of a role, in place of the host's; "frame": of a host, until this server ends."""
        return url.replace(self._tokens["host"], self._tokens[role])

    def lan_url(self, world: str = "") -> str | None:
        """Address of a world's page for other machines; None without lan. Without a world: the first one's."""
        return None if self.fingerprint is None else self.url_at(address(), world)
