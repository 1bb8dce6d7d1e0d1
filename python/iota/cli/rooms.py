# SPDX-License-Identifier: Apache-2.0
"""`iota rooms`: worlds of several people, kept in a folder."""

from __future__ import annotations

import argparse
import math
import time
import webbrowser
from contextlib import suppress

from iota.cli.failure import Failure
from iota.cli.run import can_show_a_page, lan, plain_failures
from iota.rooms import Cluster, Rooms
from iota.world.callbacks import is_terminal, print_on_terminal
from iota.world.lan import announcement
from iota.world.page import page_copy


def run(arguments: argparse.Namespace) -> None:
    """Serves them until Ctrl-C, or for so many seconds."""
    if arguments.scripts is not None and not arguments.scripts.is_dir():
        raise Failure(f"there is no folder {arguments.scripts}")
    end = time.monotonic() + (math.inf if arguments.seconds is None else arguments.seconds)
    with plain_failures(arguments.port), page_copy("rooms.html") as page:
        try:
            cluster = connect(arguments)
            rooms = Rooms(
                arguments.directory,
                page,
                port=8080 if arguments.port is None else arguments.port,
                scripts=arguments.scripts,
                leave=60 * arguments.empty,
                lan=lan(arguments),
                public_origin=arguments.public or "",
                cluster=cluster,
            )
        except (ValueError, ConnectionError) as error:
            raise Failure(str(error)) from None
        lines = [f"rooms in {arguments.directory}: {rooms.url}"]
        if (url := rooms.lan_url()) is not None and rooms.fingerprint is not None:
            lines += announcement(url, rooms.fingerprint, rooms.port, shows_code=is_terminal())
        if arguments.public:
            lines.append(f"  behind the proxy: {arguments.public}/?{rooms.url.partition('/?')[2]}")
        print_on_terminal("\n".join(lines) + "\n", is_error=False)
        if not arguments.no_open and can_show_a_page():
            webbrowser.open(rooms.url)
        with suppress(KeyboardInterrupt):
            rooms.run(lambda: time.monotonic() < end)


def connect(arguments: argparse.Namespace) -> Cluster | None:
    """Raises ConnectionError, ValueError."""
    if arguments.ray is None:
        return None
    return Cluster.connect(arguments.ray, arguments.room_cores, arguments.room_memory * 1e6)
