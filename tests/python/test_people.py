# SPDX-License-Identifier: Apache-2.0
"""What is of one user alone, and where users are."""

from __future__ import annotations

from collections.abc import Callable

import pytest
from page_client import PageClient

import iota

Runner = Callable[[iota.World], str]


def test_a_control_of_one_client_cannot_be_changed_by_others(run_world: Runner) -> None:
    world = iota.World(iota.System())
    slider = world.controls.slider("mine", 0, 1)
    with PageClient(run_world(world)) as page, PageClient(world.pages.url or "") as other:
        world.call(lambda: setattr(slider, "client", page.id))
        seen = page.wait_for(lambda: (w := page.entities["widget"].get(0)) and w["client"] and w)
        assert seen["client"] == page.id
        other.send("change", widget=seen["id"], value=0.7, text="")
        page.send("change", widget=seen["id"], value=0.3, text="")
        page.wait_for(lambda: page.entities["widget"][0]["value"] == 0.3)
        other.send("change", widget=seen["id"], value=0.9, text="")
        other.send("ping", client_time=1.0)
        other.wait_for(lambda: "pong" in other.last)
        world.call(lambda: None)
        assert slider.value == 0.3


def test_a_pulse_is_for_one_client_and_its_hand(run_world: Runner) -> None:
    world = iota.World(iota.System())
    with PageClient(run_world(world)) as page, PageClient(world.pages.url or "") as other:
        mine = page.wait_for(lambda: [client for client in world.users.clients if client.id == page.id])[0]
        world.call(lambda: mine.pulse("left", 0.75, 0.25))
        seen = page.wait_for(lambda: page.last.get("pulse"))
        assert seen["hand"] == "left" and (seen["strength"], seen["seconds"]) == (0.75, 0.25)
        world.call(lambda: world.drawings.effect("grab", (0, 0, 0)))
        other.wait_for(lambda: other.effects)
        assert "pulse" not in other.last
        with pytest.raises(ValueError, match="left, right or both"):
            mine.pulse("foot")  # type: ignore[arg-type]
        with pytest.raises(ValueError, match="strength from 0 to 1"):
            mine.pulse(strength=2)


def test_a_camera_is_of_one_client_until_it_is_given_back(run_world: Runner) -> None:
    world = iota.World(iota.System(), camera=iota.Camera((0, 1, 4), (0, 1, 0)))
    with PageClient(run_world(world)) as page, PageClient(world.pages.url or "") as other:
        mine = page.wait_for(lambda: [client for client in world.users.clients if client.id == page.id])[0]

        def is_at(who: PageClient, position: tuple[float, float, float]) -> bool:
            return who.last["world_settings"]["camera_position"] == position

        world.call(lambda: setattr(mine, "camera", iota.Camera((0, 8, 1), (0, 0, 0))))
        page.wait_for(lambda: is_at(page, (0, 8, 1)))
        assert is_at(other, (0, 1, 4))
        world.call(lambda: setattr(world, "camera", iota.Camera((3, 1, 0), (0, 1, 0))))
        other.wait_for(lambda: is_at(other, (3, 1, 0)))
        page.wait_for(lambda: is_at(page, (0, 8, 1)))
        world.call(world.reset)
        other.wait_for(lambda: is_at(other, (0, 1, 4)))
        page.wait_for(lambda: is_at(page, (0, 8, 1)))
        with PageClient(world.pages.url or "") as late:
            late.wait_for(lambda: "world_settings" in late.last)
            assert is_at(late, (0, 1, 4))
        world.call(lambda: setattr(mine, "camera", None))
        page.wait_for(lambda: is_at(page, (0, 1, 4)))
        with pytest.raises(TypeError, match="camera must be a Camera"):
            mine.camera = (1, 2, 3)  # type: ignore[assignment]


def test_users_see_where_the_others_are(run_world: Runner) -> None:
    world = iota.World(iota.System())
    stance = {"head": (0.5, 1.5, 2.0), "rotation": (0.0, 0.0, 0.0, 1.0), "scale": 1.0, "hands": (1.0, 2.0, 3.0)}
    with PageClient(run_world(world), name="Ada") as page, PageClient(world.pages.url or "", name="Bo") as other:
        page.send("presence", stance=stance)
        (person,) = other.wait_for(lambda: other.last.get("people", {}).get("people"))
        assert person["client"] == page.id
        assert person["stance"]["head"] == (0.5, 1.5, 2.0) and list(person["stance"]["hands"]) == [1, 2, 3]
        assert {client["name"] for client in other.last["clients"]["clients"]} == {"Ada", "Bo"}
        page.send("presence", stance=stance | {"head": (3e9, 0, 0)})
        page.wait_for(lambda: any("beyond 1e9 m" in notice["text"] for notice in page.notices))
        page.close()
        other.wait_for(lambda: not other.last["people"]["people"])
