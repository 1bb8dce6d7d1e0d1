# SPDX-License-Identifier: Apache-2.0
"""Recordings of a running world, with what its users do."""

from __future__ import annotations

import signal
import subprocess
import sys
import textwrap
import time
from pathlib import Path
from typing import Any

import pytest
from page_client import PageClient, decode
from pages import listen_for_complaints, needs_browser, open_page
from waiting import wait_until

import iota
from iota.film.stream import unpack
from iota.world.recording import StreamFile

Told = list[tuple[float, str, dict[str, Any]]]


def read(file: Path) -> tuple[Told, bool]:
    """The messages of a recording by name, and whether it is complete."""
    messages, is_complete = unpack(file.read_bytes())
    return [(at, *decode(data)) for at, data in messages], is_complete


def make_world() -> iota.World:
    system = iota.System(gravity=(0, 0, 0))
    system.body().particle((0, 1, 0), velocity=(0.5, 0, 0))
    system.body(shape=iota.Sphere(0.2), position=(0, 2, 0))
    world = iota.World(system, title="lesson", ground=None)

    @world.action("flash", key="f", on="world")
    def flash() -> None:
        world.drawings.effect("break", (0, 2, 0))

    return world


def test_a_recording_has_the_actions_of_two_users_and_plays_from_any_time(tmp_path: Path) -> None:
    file = tmp_path / "lesson.iota"
    world = make_world()
    began = time.monotonic()
    with world.pages.record(file) as recording:
        url = world.start(port=0)
        with PageClient(url, name="Ada") as ada, PageClient(url, name="Max") as max_:
            ada.wait_for(lambda: len(ada.last["clients"]["clients"]) == 2)
            body = ada.entities["body"][1]["id"]
            ada.send("grab_start", hold=1, body=body, local_point=(0, 0, 0), target=(0, 2, 0))
            ada.send("grab_move", hold=1, target=(1, 2, 0))
            max_.send("select", body=body)
            max_.send("action", name="flash", body=(0, 0))
            ada.wait_for(lambda: ada.places[1][0] > 0.5 and ada.effects)
            early, is_complete = read(file)  # while it is written
            assert early and not is_complete
            world.users.notice("only for Ada", client=ada.id)
            world.users.notice("for all")
            max_.wait_for(lambda: max_.notices)
        world.call(lambda: None)
    lasted = time.monotonic() - began
    assert recording.error is None
    world.stop()
    told, is_complete = read(file)
    assert is_complete and told[: len(early)] == early
    names = [name for _, name, _ in told]
    assert names[0] == "welcome" and told[0][2]["client"] == 0
    users = [{user["name"] for user in values["clients"]} for _, name, values in told if name == "clients"]
    assert users[0] == set() and {"Ada", "Max"} in users, "the recorder is no user"
    selected = [user["selected"] for _, name, values in told if name == "clients" for user in values["clients"]]
    assert body in selected
    poses = [values for _, name, values in told if name == "poses"]
    holds = [hold for each in poses for hold in each["holds"]]
    assert any(hold["body"] == 1 and hold["target"] == pytest.approx((1, 2, 0)) for hold in holds)
    assert poses[0]["keyframe"] and poses[-1]["time"] > 0.3
    assert [values["title"] for _, name, values in told if name == "notice"] == ["for all"]
    assert [values["kind"] for _, name, values in told if name == "effect"].count("break") == 1
    times = [at for at, *_ in told]
    assert times == sorted(times) and times[0] >= 0 and times[-1] < lasted
    assert len(poses) / (times[-1] - times[0]) < 40, "some 30 a second"


SCRIPT = """
import iota
system = iota.System(gravity=(0, 0, 0))
system.body().particle((0, 1, 0), velocity=(0.5, 0, 0))
world = iota.World(system, title="lesson", ground=None)
world.run()
"""


@needs_browser
def test_the_recording_of_a_killed_server_plays_up_to_its_end(tmp_path: Path) -> None:
    script, file, page_file = tmp_path / "mine.py", tmp_path / "mine.iota", tmp_path / "mine.html"
    script.write_text(SCRIPT)
    words = [sys.executable, "-m", "iota", "run", str(script), "--port", "0", "--no-open", "--record", str(file)]
    with subprocess.Popen(words, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        with PageClient(process.stdout.readline().removeprefix("lesson: ").strip(), name="Ada") as page:
            page.wait_for(lambda: page.last["poses"]["time"] > 1.5)
            last = page.last["poses"]["time"]
            process.send_signal(signal.SIGKILL)
            process.wait(20)
    assert sorted(path.name for path in tmp_path.iterdir() if path.is_file()) == ["mine.iota", "mine.py"]
    told, is_complete = read(file)
    assert not is_complete
    assert [values["time"] for _, name, values in told if name == "poses"][-1] > last - 0.5
    # Cut anywhere, it still plays.
    whole = file.read_bytes()
    for length in (len(whole) - 1, len(whole) // 2):
        assert unpack(whole[:length])[0]
    done = subprocess.run(
        [sys.executable, "-m", "iota", "play", str(file), "-o", str(page_file), "--no-open"],
        capture_output=True,
        text=True,
        timeout=60,
    )
    assert done.returncode == 0 and "ends early" in done.stderr and done.stderr.count("\n") == 1
    with open_page(offline=True) as page:
        complaints = listen_for_complaints(page)
        page.goto(page_file.as_uri())
        page.wait_for_function("() => globalThis.iota?.connected && iota.bodyPosition(0)?.[0] > 0.6", timeout=60_000)
        page.wait_for_function("() => iota.page.world.clients.length === 1", timeout=60_000)
        assert complaints == []


def test_a_recording_that_does_not_fit_on_the_disk_ends_and_the_world_goes_on(tmp_path: Path) -> None:
    pytest.importorskip("resource")
    script = tmp_path / "full.py"
    script.write_text(
        textwrap.dedent("""
        import resource, random
        resource.setrlimit(resource.RLIMIT_FSIZE, (20_000, 20_000))
        """)
        + SCRIPT.replace(
            "world = ",
            "for _ in range(200): system.body().particle([random.random() for _ in range(3)], velocity=(0.1, 0, 0))\nworld = ",
        ).replace(
            "world.run()", "recording = world.pages.record('full.iota')\nworld.run(seconds=4)\nprint(recording.error)"
        )
    )
    words = [sys.executable, "-m", "iota", "run", "full.py", "--port", "0", "--no-open"]
    with subprocess.Popen(words, cwd=tmp_path, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None and process.stderr is not None
        with PageClient(process.stdout.readline().removeprefix("lesson: ").strip()) as page:
            page.wait_for(lambda: any(card["title"] == "The recording ended" for card in page.notices))
            step = page.last["poses"]["step"]
            page.wait_for(lambda: page.last["poses"]["step"] > step + 20)
        said, warned = process.communicate(timeout=30)
    assert process.returncode == 0 and "full.iota cannot be written: File too large" in said
    assert warned.count("File too large") == 1 and "Traceback" not in warned
    assert read(tmp_path / "full.iota")[0]


def test_an_older_file_stays_until_there_is_something_to_record(tmp_path: Path) -> None:
    file = tmp_path / "old.iota"
    file.write_bytes(b"an older one")
    StreamFile(file).close()
    recording = make_world().pages.record(file)
    recording.stop()
    recording.stop()
    assert file.read_bytes() == b"an older one" and list(tmp_path.iterdir()) == [file], "nothing else is left"
    world = make_world()
    with world.pages.record(file):
        world.start(port=0)
        wait_until(lambda: file.read_bytes() != b"an older one")
    world.stop()
    assert read(file)[1] and [path for path in tmp_path.iterdir() if path.is_file()] == [file]
    make_world().pages.record(tmp_path / "SHOUTED.IOTA").stop()


def test_files_that_cannot_be_are_refused_in_one_line(tmp_path: Path) -> None:
    world = make_world()
    with pytest.raises(ValueError, match=r"end in \.iota"):
        world.pages.record(tmp_path / "film.mp4")
    with pytest.raises(OSError, match="cannot be written: No such file"):
        world.pages.record(tmp_path / "none" / "film.iota")
    for words, told in (
        (["--record", "x.iota", "--headless"], "needs a page"),
        (["--record", "x.iota", "--terminal"], "needs a page"),
        (["--record", "x.mp4"], "must end in .iota"),
        (["--record", str(tmp_path / "none" / "x.iota")], "no folder"),
    ):
        done = subprocess.run(
            [sys.executable, "-m", "iota", "run", "chain", *words], capture_output=True, text=True, timeout=60
        )
        assert done.returncode == 1 and told in done.stderr and done.stderr.count("\n") == 1, done.stderr
