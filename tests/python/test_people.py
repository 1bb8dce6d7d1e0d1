# SPDX-License-Identifier: Apache-2.0
"""What is of one user alone, and where users are."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

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
        page.send("rename", name="Grace")
        other.wait_for(lambda: {client["name"] for client in other.last["clients"]["clients"]} == {"Grace", "Bo"})
        mine = next(client for client in world.users.clients if client.id == page.id)
        page.wait_for(lambda: mine.name == "Grace")
        assert mine.eye == iota.Vec3(0.5, 1.5, 2.0)
        page.send("presence", stance=stance | {"head": (3e9, 0, 0)})
        page.wait_for(lambda: any("beyond 1e9 m" in notice["text"] for notice in page.notices))
        page.close()
        other.wait_for(lambda: not other.last["people"]["people"])


def test_a_card_has_a_time_an_id_and_a_place(run_world: Runner) -> None:
    world = iota.World(iota.System())
    with PageClient(run_world(world)) as page:
        world.call(lambda: world.users.notice("Question", id="quiz", seconds=2.5, place="left"))
        world.call(lambda: world.users.notice("Answer", id="quiz", seconds=math.inf))
        world.call(lambda: world.users.close_notice("quiz"))
        page.wait_for(lambda: len(page.notices) == 3)
        told = [(card["title"], card["id"], card["seconds"], card["place"]) for card in page.notices]
        assert told == [("Question", "quiz", 2.5, 2), ("Answer", "quiz", -1.0, 0), ("", "quiz", 0.0, 0)]


@pytest.mark.parametrize(
    ("given", "what"),
    [
        ({"place": "middle"}, "place must be one of free, top, left, right, bottom, not 'middle'"),
        ({"seconds": 0}, "seconds must be above 0"),
        ({"seconds": "long"}, "seconds must be above 0"),
        ({"id": 65 * "x"}, "id must be a text of at most 64 bytes"),
        ({"level": "bad"}, "level must be one of"),
    ],
)
def test_a_card_that_cannot_be_shown_is_refused(given: dict[str, Any], what: str) -> None:
    with pytest.raises(ValueError, match=what):
        iota.World(iota.System()).users.notice("Question", **given)


def test_what_is_near_the_user_of_an_open_page_is_simulated_in_full(run_world: Runner) -> None:
    system = iota.System()
    balls = [system.body(shape=iota.Sphere(0.1), mass=1, position=(20.0 * k, 1, 0)) for k in range(3)]
    world = iota.World(system, ground=None, camera=iota.Camera((0, 1, 2), (0, 1, 0)))
    assert world.levels._eyes().tolist() == [[0, 1, 2]]
    world.levels.budget_ms = 4.0
    with PageClient(run_world(world)) as page:
        page.wait_for(lambda: page.last.get("world_state", {}).get("budget_ms") == 4.0)
        assert page.last["world_state"]["levels"] == []
        page.send("presence", stance={"head": (40, 1, 0), "rotation": (0, 0, 0, 1), "scale": 1.0, "hands": ()})
        page.wait_for(lambda: [client.eye for client in world.users.clients] == [iota.Vec3(40, 1, 0)])
        assert world.call(lambda: world.levels._eyes().tolist()) == [[40, 1, 0]]
        page.send("profile", on=True)
        levels = page.wait_for(lambda: page.last["world_state"]["levels"])
        assert sum(level["count"] for level in levels) == 3
        assert sorted(slot for level in levels for slot in level["bodies"]) == [ball.slot for ball in balls]


def test_energy_that_steps_made_is_told_to_the_author_alone(capfd: pytest.CaptureFixture[str]) -> None:
    system = iota.System(gravity=(0, 0, 0))
    rotor = system.body(shape=iota.Box((1, 0.2, 0.1)), mass=1, position=(0, 1, 0))
    rotor.name = "rotor"
    rotor.angular_velocity = (0, 0, 40)
    world = iota.World(system, ground=None)
    shown: list[Any] = []
    world._state.notices.show = lambda *card: shown.append(card)
    take = world._stepper._step_system

    def with_warning(dt: float) -> Any:
        return Warned(take(dt))

    world._stepper._step_system = with_warning  # type: ignore[method-assign]
    for _ in range(2):
        world.step()
    told = capfd.readouterr().err
    assert told.count("gained energy") == 1 and shown == []
    assert "too long for 'rotor', which turns by 19 degrees in it. Try shorter steps: world.clock.dt = 1 / 240" in told


class Warned:
    """A report of a step that made energy."""

    warnings = ("the integration made energy that no force explains (energy.made); try shorter steps",)

    def __init__(self, report: iota.StepReport) -> None:
        self.report = report

    def __getattr__(self, name: str) -> Any:
        return getattr(self.report, name)
