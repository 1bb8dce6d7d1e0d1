# SPDX-License-Identifier: Apache-2.0
"""A message that a page sends, added by its entry in the schema, its handler and its sender."""

from __future__ import annotations

from pathlib import Path

from page_client import PageClient

import iota


def test_a_wave_reaches_its_handler_as_a_record_and_is_answered(tmp_path: Path) -> None:
    server = iota.Server(port=0, folder=tmp_path)
    world = iota.World(iota.System())
    try:
        with PageClient(world.start(server=server, id="one")) as page:
            page.send("wave", hand="left", times=3)
            page.wait_for(lambda: page.notices)
            assert (page.notices[0]["title"], page.notices[0]["text"]) == ("Wave", "left, 3 times")
    finally:
        world.stop()
        server.close()
