# SPDX-License-Identifier: Apache-2.0
"""Who may do what: the address decides."""

from __future__ import annotations

import re
from collections.abc import Callable

import pytest
from page_client import PageClient
from websockets.exceptions import InvalidStatus

import iota
from iota._core import kept_token

Runner = Callable[[iota.World], str]


def link(world: iota.World, role: str) -> str:
    address = world.pages.link(role)  # type: ignore[arg-type]
    assert address is not None
    return address


def test_each_role_has_its_own_address_of_the_same_page(run_world: Runner) -> None:
    world = iota.World(iota.System())
    assert world.pages.link("guest") is None, "it is not served"
    url = run_world(world)
    assert world.pages.link("host") == url and world.pages.link("guest", lan=True) is None
    assert len({link(world, role) for role in ("host", "guest", "viewer")}) == 3
    assert {re.sub("[0-9a-f]{32}", "", link(world, role)) for role in ("host", "guest", "viewer")} == {
        url.replace(kept_token(), "")
    }
    with pytest.raises(ValueError, match="role must be host, guest or viewer, not 'owner'"):
        world.pages.link("owner")  # type: ignore[arg-type]


def test_a_guest_touches_but_does_not_pause_and_a_viewer_watches(run_world: Runner) -> None:
    system = iota.System(gravity=(0, 0, 0))
    system.body().particle((0, 1, 0))
    world, pushed = iota.World(system, ground=None), []
    world.controls.action("push", on="world")(lambda event: pushed.append(event.client))
    run_world(world)
    for role, asked in (("guest", 2), ("viewer", 0)):
        with PageClient(link(world, role), role=asked) as page:
            page.send("action", name="push", body=(0, 0))
            page.send("control", command=0, value=0.0)
            page.wait_for(lambda page=page, role=role: len(page.notices) == (1 if role == "guest" else 2))
            page.wait_for(lambda page=page, role=role: role == "viewer" or page.id in pushed)
            assert not page.last["world_state"]["paused"]
    with PageClient(link(world, "host")) as page:
        page.send("control", command=0, value=0.0)
        page.wait_for(lambda: page.last["world_state"]["paused"])
    assert len(pushed) == 1


def test_a_host_and_the_script_send_others_away(run_world: Runner) -> None:
    world = iota.World(iota.System())
    url = run_world(world)
    with (
        PageClient(url) as host,
        PageClient(link(world, "guest")) as guest,
        PageClient(link(world, "viewer")) as viewer,
    ):
        guest.send("send_away", client=host.id)
        guest.wait_for(lambda: [card["title"] for card in guest.notices] == ["Only the host does that"])
        host.send("send_away", client=guest.id)
        guest.wait_for(guest.closed.is_set)
        assert guest.last["refused"]["reason"] == "the host has sent you away"
        world.call(lambda: world.users.send_away(viewer.id))
        viewer.wait_for(viewer.closed.is_set)
        host.wait_for(lambda: len(host.last["clients"]["clients"]) == 1)


def test_a_notebook_has_a_secret_that_ends_with_the_world(run_world: Runner) -> None:
    worlds = [iota.World(iota.System()) for _ in range(2)]
    urls = [run_world(world) for world in worlds]
    frames = [re.findall('src="([^"]*)"', world._repr_html_())[0].replace("&amp;", "&") for world in worlds]
    for frame, url in zip(frames, urls, strict=True):
        assert kept_token() not in frame
        with PageClient(frame) as page:
            page.single_step()
        assert frame.split("?")[0] == url.split("?")[0]
    with pytest.raises(InvalidStatus, match="403"):
        PageClient(urls[1].replace(kept_token(), frames[0].split("token=")[1]))


def test_the_addresses_of_guests_hold_after_a_restart_and_end_with_a_new_token() -> None:
    servers = [iota.Server(port=0) for _ in range(2)]
    assert servers[0].tokens == servers[1].tokens and len(set(servers[0].tokens)) == 3
    iota._core.renew_token()
    servers.append(iota.Server(port=0))
    assert not set(servers[2].tokens) & set(servers[0].tokens)
    for server in servers:
        server.close()
