# SPDX-License-Identifier: Apache-2.0
"""Worlds with their real server, and pages that speak the real protocol."""

from __future__ import annotations

import os
import re
import struct
import threading
import time
import urllib.error
import urllib.request
from collections.abc import Callable
from pathlib import Path

import pytest
from page_client import NOTHING, PageClient, encode
from waiting import wait_until

import iota
from iota._protocol import ActionTarget, ControlCommand, ControllerButton, Role
from iota.studies import chain as study

Runner = Callable[[iota.World], str]


@pytest.fixture
def world() -> iota.World:
    """The study, without its scripted break."""
    world = study.build()
    world._state.schedule._plan.clear()
    world._state.schedule.rewind()
    return world


def test_a_page_gets_the_scene_and_its_motion(world: iota.World, run_world: Runner) -> None:
    with PageClient(run_world(world)) as page:
        page.wait_for(lambda: {"world_settings", "world_state", "actions"} <= page.last.keys())
        assert page.last["world_state"]["dt"] == 1 / 120
        assert page.last["world_settings"]["title"].startswith("chain: ")
        assert page.last["world_settings"]["styles"] == ["rope", "chain"]
        page.wait_for(lambda: len(page.bodies) == 24)
        assert len({body["visual"] for body in page.bodies.values()}) == 1
        actions = {action["key"]: action for action in page.last["actions"]["actions"]}
        assert actions["b"]["name"] == "break" and actions["b"]["button"] == ControllerButton.B
        assert actions["c"]["on"] == ActionTarget.BODY
        page.wait_for(lambda: len(page.places) >= 24 and page.parts() == 1)
        before = page.places[23]
        page.wait_for(lambda: abs(page.places[23][1] - before[1]) > 0.01)


def test_b_breaks_and_c_rejoins_in_python_and_on_the_page(world: iota.World, run_world: Runner) -> None:
    system = world.system
    with PageClient(run_world(world)) as page:
        page.wait_for(lambda: page.parts() == 1)
        page.send("select", body=page.body(11))
        page.send("action", name="break", body=page.body(11))
        page.wait_for(lambda: page.parts() == 2)
        assert world.call(lambda: system.articulate_count) == 2
        assert page.articulates[10] != page.articulates[11]
        flash = page.wait_for(lambda: [e for e in page.effects if e["kind"] == "break"])
        assert flash[0]["position"][1] > 0
        page.send("action", name="join", body=NOTHING)  # what is selected
        page.wait_for(lambda: page.parts() == 1)
        assert world.call(lambda: system.articulate_count) == 1
        page.wait_for(lambda: [e for e in page.effects if e["kind"] == "join"])
        assert page.notices == []


def test_a_script_that_changes_looks_does_not_send_its_actions_again(world: iota.World, run_world: Runner) -> None:
    with PageClient(run_world(world)) as page:
        page.wait_for(lambda: page.parts() == 1)
        visuals = page.entities["body"][0]["visual"]
        before = page.messages.copy()
        world.call(lambda: world.draw(world.system.bodies[0], iota.looks.solid("steel")))
        page.wait_for(lambda: page.entities["body"][0]["visual"] != visuals)
        for name in ("actions", "world_settings", "listens"):
            assert before[name] >= 1 and page.messages[name] == before[name], name
        world.call(lambda: world.action("wave", key="h", on="world")(lambda: None))
        page.wait_for(lambda: "h" in [action["key"] for action in page.last["actions"]["actions"]])


def test_edits_that_are_a_mechanism_show_no_rings_and_those_that_the_script_chooses_do(
    world: iota.World, run_world: Runner
) -> None:
    world.scene.shows_edits = False
    with PageClient(run_world(world)) as page:
        page.wait_for(lambda: page.parts() == 1)
        page.send("action", name="break", body=page.body(11))
        page.wait_for(lambda: page.parts() == 2)
        world.call(lambda: world.drawings.effect("join", (0, 1, 0)))
        page.wait_for(lambda: page.effects)
        assert [effect["kind"] for effect in page.effects] == ["join"]


def test_a_dragged_link_follows_and_swings_back(world: iota.World, run_world: Runner) -> None:
    with PageClient(run_world(world)) as page:
        page.wait_for(lambda: 23 in page.places)
        page.send("grab_start", hold=1, body=page.body(23), local_point=(0, 0, 0), target=(1.2, 1.2, 1.0))
        page.wait_for(lambda: abs(page.places[23][2] - 1.0) < 0.15)
        (hold,) = page.wait_for(lambda: page.last["poses"]["holds"])
        assert hold["client"] == page.id and hold["hold"] == 1 and hold["body"] == 23 and hold["force"] > 0
        assert world.users.held(page.id) == world.call(lambda: world.users.held()), "from any thread"
        assert world.call(lambda: world.users.held(page.id).slot) == 23
        page.send("grab_move", hold=1, target=(-1.2, 1.2, 0.0))
        page.wait_for(lambda: page.places[23][0] < -0.8)
        page.send("grab_end", hold=1)
        page.wait_for(lambda: not page.last["poses"]["holds"])
        page.wait_for(lambda: page.places[23][0] > -0.3)


def test_two_pages_have_their_own_selections_and_agree_on_the_rest(world: iota.World, run_world: Runner) -> None:
    bodies = world.system.bodies
    url = run_world(world)
    with PageClient(url, "one") as one, PageClient(url, "two") as two:
        one.send("select", body=one.body(3))
        two.send("select", body=two.body(20))
        one.wait_for(lambda: len(one.last["clients"]["clients"]) == 2)
        two.wait_for(lambda: {c["selected"][0] for c in two.last["clients"]["clients"]} == {3, 20})
        for page, slot in ((one, 3), (two, 20)):
            page.wait_for(lambda p=page, s=slot: world.call(lambda: world.users.selected(p.id)) == bodies[s])
        assert sorted(client.name for client in world.call(lambda: world.users.clients)) == ["one", "two"]
        two.send("action", name="break", body=NOTHING)
        one.wait_for(lambda: one.parts() == 2)
        two.wait_for(lambda: two.parts() == 2)
        assert one.articulates == two.articulates


def test_the_forces_of_two_holders_add_up(run_world: Runner) -> None:
    system = iota.System(gravity=(0, 0, 0), damping=1.0)
    body = system.body()
    body.particle((0, 1, 0))
    url = run_world(iota.World(system))
    with PageClient(url) as one, PageClient(url) as two:
        one.send("grab_start", hold=1, body=one.body(0), local_point=(0, 0, 0), target=(1, 1, 0))
        two.send("grab_start", hold=1, body=two.body(0), local_point=(0, 0, 0), target=(0, 2, 0))
        one.wait_for(lambda: len(one.last["poses"]["holds"]) == 2)
        two.wait_for(lambda: two.places[0] == pytest.approx((0.5, 1.5, 0), abs=0.01))


def test_a_page_that_leaves_lets_go_of_its_bodies(world: iota.World, run_world: Runner) -> None:
    url = run_world(world)
    with PageClient(url) as stays:
        with PageClient(url) as leaves:
            leaves.send("grab_start", hold=7, body=leaves.body(5), local_point=(0, 0, 0), target=(0, 2, 2))
            stays.wait_for(lambda: stays.last["poses"]["holds"])
        stays.wait_for(lambda: not stays.last["poses"]["holds"])
        assert len(world.call(lambda: world.users.clients)) == 1


def test_pause_step_speed_and_reset(world: iota.World, run_world: Runner) -> None:
    system = world.system
    with PageClient(run_world(world)) as page:
        page.send("control", command=0, value=0)
        page.wait_for(lambda: page.last["world_state"]["paused"])
        step = world.call(lambda: system.step_count)
        page.send("control", command=2, value=0)
        page.wait_for(lambda: page.last["poses"]["step"] == step + 1)
        page.send("control", command=4, value=0.5)
        page.send("control", command=1, value=0)
        page.wait_for(lambda: page.last["world_state"]["speed"] == 0.5 and not page.last["world_state"]["paused"])
        page.send("action", name="break", body=page.body(9))
        page.wait_for(lambda: page.parts() == 2)
        page.send("grab_start", hold=1, body=page.body(3), local_point=(0, 0, 0), target=(0, 0, 2))
        page.wait_for(lambda: page.last["poses"]["holds"])
        page.send("control", command=3, value=0)
        page.wait_for(lambda: page.parts() == 1 and page.last["poses"]["time"] < 1 and not page.last["poses"]["holds"])
        page.send("grab_move", hold=1, target=(0, 0, 1))  # a hand from before the reset holds nothing
        page.send("grab_end", hold=1)
        page.wait_for(lambda: page.last["poses"]["step"] > 10)
        assert page.notices == []


def test_reset_runs_timed_events_again_and_calls_the_script(run_world: Runner) -> None:
    system = iota.System()
    system.body().particle((0, 1, 0))
    world = iota.World(system)
    calls: list[str] = []
    world.at(0.05)(lambda: calls.append("event"))
    world.on_reset(lambda: calls.append("reset"))
    run_world(world)
    wait_until(lambda: calls == ["event"])
    world.call(world.reset)
    wait_until(lambda: len(calls) == 3)
    assert calls == ["event", "reset", "event"]


def test_an_action_that_raises_is_shown_on_the_page_with_its_line(
    run_world: Runner, capsys: pytest.CaptureFixture[str]
) -> None:
    system = iota.System()
    system.body().particle()
    world = iota.World(system)

    @world.action("burn", key="x", on="world")
    def burn(event: iota.Event) -> None:
        raise RuntimeError("too hot")

    line = burn.__code__.co_firstlineno + 2
    with PageClient(run_world(world)) as page:
        page.send("action", name="burn", body=NOTHING)
        # A busy machine has the world tell that it is slow, too.
        (notice,) = page.wait_for(lambda: [card for card in page.notices if card["level"] == 2])
        assert "'burn' failed" in notice["title"]
        assert notice["text"] == f"RuntimeError: too hot (test_world.py, line {line})"
        assert "continues" in notice["hint"]
        step = page.last["poses"]["step"]
        page.wait_for(lambda: page.last["poses"]["step"] > step + 10)
    assert "RuntimeError: too hot" in capsys.readouterr().err


def test_an_error_is_shown_to_pages_that_open_later_until_reset(run_world: Runner) -> None:
    world = iota.World(iota.System())
    failed = threading.Event()

    @world.every(0.02)
    def tick() -> None:
        failed.set()
        raise RuntimeError("nobody saw it")

    url = run_world(world)
    assert failed.wait(20)
    with PageClient(url) as page:
        (notice,) = page.wait_for(lambda: page.notices)
        assert "nobody saw it" in notice["text"] and notice["level"] == 2
    world.call(lambda: setattr(world.clock, "paused", True))
    world.call(world.reset)
    with PageClient(url) as page:
        page.wait_for(lambda: page.pose_frames > 3)
        assert page.notices == []


def test_a_page_that_opens_while_a_callback_hangs_gets_a_notice(run_world: Runner) -> None:
    system = iota.System()
    system.body().particle()
    world = iota.World(system)
    hangs, go_on = threading.Event(), threading.Event()

    @world.action("ponder", on="world")
    def ponder() -> None:
        hangs.set()
        go_on.wait(60)

    url = run_world(world)
    try:
        with PageClient(url) as page:
            page.send("action", name="ponder", body=NOTHING)
            assert hangs.wait(20)
            page.wait_for(lambda: page.notices)
            with PageClient(url) as late:
                (notice,) = late.wait_for(lambda: late.notices)
                assert "'ponder' is slow" in notice["title"]
            go_on.set()
            step = page.last["poses"]["step"]
            page.wait_for(lambda: page.last["poses"]["step"] > step + 10)
        with PageClient(url) as after:
            after.wait_for(lambda: after.pose_frames > 3)
            assert after.notices == []
    finally:
        go_on.set()


def test_one_pages_bad_hand_is_its_error_alone(world: iota.World, run_world: Runner) -> None:
    with PageClient(run_world(world)) as page, PageClient(world.pages.url or "") as other:
        page.send("grab_start", hold=1, body=page.body(3), local_point=(0, 0, 0), target=(2e9, 0, 0))
        (notice,) = page.wait_for(lambda: page.notices)
        assert "1e9" in notice["text"] and "script" not in notice["hint"]
        page.send("grab_start", hold=2, body=page.body(3), local_point=(9e8, 0, 0), target=(0, 0, 0))
        step = other.last["poses"]["step"]
        other.wait_for(lambda: other.last["poses"]["step"] > step + 20)
        assert other.notices == []


def test_one_page_cannot_run_the_world_for_all(world: iota.World, run_world: Runner) -> None:
    with PageClient(run_world(world)) as page:
        steps = world.call(lambda: world.system.step_count)
        began = time.monotonic()
        for _ in range(4000):
            page.send("control", command=ControlCommand.SINGLE_STEP, value=0)
        page.wait_for(lambda: page.last["world_state"]["paused"])
        time.sleep(0.2)
        taken = world.call(lambda: world.system.step_count) - steps
        assert taken < 130 * (time.monotonic() - began) + 10, "no faster than real time"


def test_an_action_without_a_body_says_what_to_do(world: iota.World, run_world: Runner) -> None:
    url = run_world(world)
    with PageClient(url) as page, PageClient(url) as other:
        page.send("action", name="break", body=NOTHING)
        (notice,) = page.wait_for(lambda: page.notices)
        assert notice["title"] == "Nothing to break" and "Hold or select" in notice["hint"]
        page.send("action", name="dance", body=NOTHING)
        page.wait_for(lambda: "no action 'dance'" in page.notices[-1]["text"])
        page.send("action", name="break", body=(4000, 1))  # no such body
        page.wait_for(lambda: len(page.notices) == 3)
        assert other.notices == [], "told to the one who asked"


def test_a_slow_callback_is_named_while_it_runs_and_stepping_resumes(
    run_world: Runner, capsys: pytest.CaptureFixture[str]
) -> None:
    system = iota.System()
    system.body().particle()
    world = iota.World(system)
    go_on = threading.Event()

    @world.action("ponder", key="p", on="world")
    def ponder() -> None:
        go_on.wait(60)

    with PageClient(run_world(world)) as page:
        page.send("action", name="ponder", body=NOTHING)
        # A busy machine may have another note.
        page.wait_for(lambda: any("'ponder' is slow" in notice["title"] for notice in page.notices))
        assert not go_on.is_set(), "told before it is over"
        go_on.set()
        step = page.last["poses"]["step"]
        page.wait_for(lambda: page.last["poses"]["step"] > step + 10)
    assert re.search(r"'ponder' took \d+\.\d s", capsys.readouterr().err)


def test_a_long_step_is_reported_while_it_lasts(run_world: Runner, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("iota.world.stepper.SLOW_STEP", 1.0)
    system = iota.System()
    p, q = (system.body().particle((x, 1, 0)) for x in (0, 1))
    hangs, go_on = threading.Event(), threading.Event()

    def law(bond: iota.Bond) -> tuple[float, float, float]:
        if hangs.is_set():
            go_on.wait(60)
        return (0, 0, 0)

    system.bond(p, q, law)
    url = run_world(iota.World(system))
    try:
        with PageClient(url) as page:
            hangs.set()
            (notice,) = page.wait_for(lambda: page.notices)
            assert notice["title"] == "A step of the world is slow" and "smaller world" in notice["hint"]
            hangs.clear()
            go_on.set()
            step = page.last["poses"]["step"]
            page.wait_for(lambda: page.last["poses"]["step"] > step + 10)
    finally:
        go_on.set()


def test_garbage_frames_are_refused_with_a_reason_and_the_session_lives(world: iota.World, run_world: Runner) -> None:
    good = encode("grab_start", hold=1, body=(3, 1), local_point=(0, 0, 0), target=(0, 0, 0))
    with PageClient(run_world(world)) as page:
        garbage = [
            b"",
            b"\xff",
            b"\x00" * 50,
            good[:-1],
            good + b"\0",
            good[:-4] + struct.pack("<f", float("nan")),
            b"\x06" + struct.pack("<I", 0xFFFFFFFF),
            b"\x06" + struct.pack("<I", 2) + b"\xff\xfe" + struct.pack("<I", 0),
        ]
        for number, frame in enumerate(garbage):
            page.send_bytes(frame)
            page.wait_for(lambda n=number: len(page.notices) == n + 1)
            assert page.notices[-1]["level"] == 2 and page.notices[-1]["text"]
        page.send("grab_start", hold=1, body=(9999, 1), local_point=(0, 0, 0), target=(0, 0, 0))
        page.send("grab_move", hold=77, target=(0, 0, 0))
        page.send("grab_end", hold=78)
        page.send("select", body=(9999, 1))
        page.send("action", name="break", body=page.body(12))
        page.wait_for(lambda: page.parts() == 2)


def test_a_text_that_is_too_long_ends_that_session_only(world: iota.World, run_world: Runner) -> None:
    url = run_world(world)
    with PageClient(url) as good, PageClient(url) as bad:
        bad.send_bytes(b"\x06" + bytes(70_000))
        assert bad.closed.wait(5)
        step = good.last["poses"]["step"]
        good.wait_for(lambda: good.last["poses"]["step"] > step + 10)


@pytest.mark.parametrize("change", ["token", "origin", "host", "version"])
def test_strangers_are_refused(world: iota.World, run_world: Runner, change: str) -> None:
    from websockets.exceptions import InvalidStatus
    from websockets.sync.client import connect

    url = run_world(world)
    address = url.replace("http://", "ws://").replace("/?", "/ws?")
    if change == "version":
        with connect(address, proxy=None) as socket:
            socket.send(encode("hello", magic=0x41544F49, version=99, world="", role=0, name=""))
            reply = socket.recv(timeout=5)
            assert isinstance(reply, bytes) and reply[0] == 65 and b"version" in reply
        return
    address = address[:-1] + ("0" if address[-1] != "0" else "1") if change == "token" else address
    headers = {"Host": "evil.example"} if change == "host" else {}
    origin = "http://evil.example" if change == "origin" else None
    with (
        pytest.raises(InvalidStatus) as caught,
        connect(address, origin=origin, additional_headers=headers, proxy=None),
    ):
        pass
    assert caught.value.response.status_code in (400, 403)


def test_the_page_and_its_health_are_served(world: iota.World, run_world: Runner) -> None:
    url = run_world(world)
    opener = urllib.request.build_opener(urllib.request.ProxyHandler({}))
    with opener.open(url) as page:
        assert page.status == 200 and b"<html" in page.read().lower()
    with opener.open(url.split("?")[0] + "healthz") as health:
        assert health.read().strip() == b"ok"
    with pytest.raises(urllib.error.HTTPError) as caught:
        opener.open(url.split("?")[0] + "..%2f..%2fetc/passwd")
    assert caught.value.code in (400, 403, 404)


def test_the_token_is_kept_and_secret(world: iota.World, run_world: Runner) -> None:
    first = run_world(world)
    world.stop()
    second = run_world(world)
    assert first.split("token=")[1] == second.split("token=")[1]
    kept = Path(os.environ["XDG_STATE_HOME"]) / "iota" / "token"
    assert kept.stat().st_mode & 0o777 == 0o600


def test_a_taken_port_is_an_os_error(world: iota.World, run_world: Runner) -> None:
    port = int(run_world(world).split(":")[2].split("/")[0])
    other = iota.World(iota.System())
    with pytest.raises(OSError, match=str(port)):
        other.start(port=port)
    assert other.pages.url is None
    other.system.step()  # the system is the caller's again


def test_a_script_may_have_a_loop_of_its_own(world: iota.World) -> None:
    with PageClient(world.serve(port=0)) as page:
        began = time.monotonic()
        for _ in range(60):
            world.step()
        assert time.monotonic() - began > 0.4, "in real time"
        page.wait_for(lambda: page.last["poses"]["step"] >= 55)
    world.close()


def test_structure_changes_reach_the_page_with_the_looks_of_new_bodies(
    system: iota.System, chain: list[iota.Body], run_world: Runner
) -> None:
    world = iota.World(system)
    with PageClient(run_world(world)) as page:
        page.wait_for(lambda: len(page.bodies) == 6)

        def edit() -> None:
            system.body().particle((1, 1, 0))
            chain[-1].destroy()
            chain[0].combine(chain[1])

        world.call(edit)
        page.wait_for(lambda: len(page.bodies) == 5)
        assert page.visual_of(0)["name"] == "(body)"
        assert all(body["visual"] in page.entities["visual"] for body in page.bodies.values())


def test_a_message_about_a_destroyed_body_is_answered_by_a_notice(system: iota.System, run_world: Runner) -> None:
    bodies = [system.body() for _ in range(2)]
    for index, body in enumerate(bodies):
        body.particle((index, 1, 0))
    world, asked = iota.World(system), []

    @world.action("poke")
    def poke(event: iota.Event) -> None:
        asked.append(event.body)

    def replace() -> iota.Body:
        bodies[1].destroy()
        new = system.body()
        new.particle((1, 2, 0))
        return new

    with PageClient(run_world(world)) as page:
        old = page.body(1)
        new = world.call(replace)
        assert new.slot == old[0]
        now = page.wait_for(lambda: (found := page.body(1)) != old and found)
        page.send("grab_start", hold=1, body=old, local_point=(0, 0, 0), target=(0, 5, 0))
        page.send("select", body=old)
        page.send("action", name="poke", body=old)
        page.wait_for(lambda: [n["title"] for n in page.notices] == ["It no longer exists"] * 3)
        assert asked == [] and not page.last["poses"]["holds"]
        assert world.call(lambda: world.users.selected(page.id)) is None
        page.send("action", name="poke", body=now)
        page.wait_for(lambda: asked == [new])


def test_an_action_on_the_world_is_done_although_the_body_under_the_mouse_is_gone(
    system: iota.System, run_world: Runner
) -> None:
    bodies = [system.body() for _ in range(2)]
    for index, body in enumerate(bodies):
        body.particle((index, 1, 0))
    world, asked = iota.World(system), []

    @world.action("look", on="world")
    def look() -> None:
        asked.append("look")

    with PageClient(run_world(world)) as page:
        old = page.body(1)
        world.call(bodies[1].destroy)
        page.send("action", name="look", body=old)  # as of a page that has not been told yet
        page.wait_for(lambda: asked == ["look"])
        assert page.notices == []


def test_worlds_may_share_a_server() -> None:
    server = iota.Server(port=0)
    worlds = {}
    for name, count in (("one", 1), ("two", 2)):
        system = iota.System(gravity=(0, 0, 0))
        for index in range(count):
            system.body().particle((index, 1, 0))
        worlds[name] = iota.World(system, title=name)
    urls = {name: world.start(server=server, id=name) for name, world in worlds.items()}
    try:
        with (
            PageClient(urls["one"], "a") as a,
            PageClient(server.url, "b") as b,  # the first world
            PageClient(urls["two"], "c") as c,
            PageClient(urls["two"], "d", role=Role.VIEWER) as d,
        ):
            for page, name, count in ((a, "one", 1), (b, "one", 1), (c, "two", 2), (d, "two", 2)):
                page.wait_for(lambda p=page, n=count: len(p.bodies) == n <= len(p.places))
                assert page.last["welcome"]["world"] == page.last["world_settings"]["title"] == name
                page.wait_for(lambda p=page: len(p.last["clients"]["clients"]) == 2)
            c.send("grab_start", hold=1, body=c.body(0), local_point=(0, 0, 0), target=(0, 3, 0))
            d.wait_for(lambda: d.places[0][1] > 2)
            assert a.places[0][1] == pytest.approx(1, abs=1e-3), "the other world is not touched"
            d.send("control", command=ControlCommand.PAUSE, value=0)
            d.wait_for(lambda: d.notices)
            worlds["two"].stop()
            assert c.closed.wait(10) and not a.closed.is_set()
            before = a.pose_frames
            a.wait_for(lambda: a.pose_frames > before)
    finally:
        for world in worlds.values():
            world.stop()
        server.close()


def test_bad_actions_are_refused() -> None:
    world = iota.World(iota.System())
    world.action("a", key="k")(lambda: None)
    for arguments in (
        {"name": "a"},
        {"name": "b", "key": "k"},
        {"name": "b", "on": "moon"},
        {"name": "b", "button": "x"},
    ):
        with pytest.raises(ValueError, match=r"taken|already|must be"):
            world.action(**arguments)
    with pytest.raises(ValueError, match="level"):
        world.users.notice("x", level="loud")
