# SPDX-License-Identifier: Apache-2.0
"""No message ends a world: random and extreme ones to every study. IOTA_MESSAGE_SECONDS asks for as long of them, within
the limits of a page; without it some hundred come as fast as the world takes them, without these limits."""

from __future__ import annotations

import os
import time
from collections.abc import Callable
from pathlib import Path

import pytest
from amount import TRIES_ALL
from page_client import PageClient
from random_messages import Sender
from repeatable import REPEATABLE

import iota
from iota import studies
from iota.journal.folder import Folder
from iota.journal.reader import find, recover
from iota.world.pace import Pace

Runner = Callable[[iota.World], str]
SECONDS = float(os.environ.get("IOTA_MESSAGE_SECONDS", "0"))
SEED = int(os.environ.get("IOTA_MESSAGE_SEED", "1"))
COUNT = 4000 if TRIES_ALL else 100
AT_ONCE = 20  # messages, between two looks at the world


def hear_back(world: iota.World, page: PageClient) -> None:
    """Waits until the server has read all that the page has sent, and the world is at it: on a busy machine a page with
    4000 messages at once has given more input than the script can take."""
    echoed = page.messages["pong"]
    page.send("ping", client_time=0.0)
    page.wait_for(lambda: page.messages["pong"] > echoed or page.closed.is_set())
    world.call(lambda: None)


def send_at_random(world: iota.World, page: PageClient, seed: int) -> int:
    """How many were sent."""
    sender, sent, end = Sender(page, seed), 0, time.monotonic() + SECONDS
    while sent < COUNT if not SECONDS else time.monotonic() < end:
        sender.send(AT_ONCE)
        sent += AT_ONCE
        hear_back(world, page)
        assert not page.closed.is_set(), f"after {sent} messages of seed {seed}: {page.why_closed}"
        time.sleep(0.2 if SECONDS else 0.0)
    return sent


@pytest.mark.parametrize("name", studies.names())
def test_no_message_ends_a_study_and_none_is_an_error(
    name: str, run_world: Runner, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.chdir(tmp_path)  # where the playground saves
    if not SECONDS:
        monkeypatch.setattr(Pace, "allows", lambda *_: True)
    world = studies.module(name).build()

    def world_steps() -> int:
        return world.system.step_count

    url = run_world(world)
    with PageClient(url) as page, PageClient(url) as other:
        send_at_random(world, page, SEED)
        for _ in range(2):  # a call comes before the input of its round, so that all is handled after the second one
            world.call(lambda: None)
        other.send("control", command=0, value=0.0)
        other.wait_for(lambda: world.call(lambda: world.clock.paused))
        before = world.call(world_steps)
        other.send("control", command=2, value=0.0)
        other.wait_for(lambda: world.call(world_steps) == before + 1)
        failed = [card for card in [*page.notices, *other.notices] if card["title"].endswith("failed")]
        # What a study asks of bodies that are 1e9 m away, the engine may refuse in words.
        assert [card for card in failed if not card["text"].startswith("ValueError: ")] == []
        assert world.call(world.system.validate) == []
        assert not other.closed.is_set()


# Hands at 1e9 m tear the dolls out of shape, which a restored system measures anew.
PULLED = [name for name in REPEATABLE if name != "ragdolls"] if TRIES_ALL else ["chain", "stack"]


@pytest.mark.parametrize("name", PULLED)
def test_what_random_messages_have_done_is_repeated_to_the_last_bit(
    name: str, run_world: Runner, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """From the journal, as after a kill."""
    monkeypatch.chdir(tmp_path)
    world = studies.module(name).build()
    world.keep(tmp_path / "kept")
    with PageClient(run_world(world)) as page:
        sender = Sender(page, SEED)
        for _ in range(30):
            sender.send(2)
            hear_back(world, page)
            time.sleep(0.05)

        def hand_over() -> None:
            journal = world._stepper.journal
            assert journal is not None and journal._writer is not None
            journal.hand_over()
            journal._writer.flush()

        world.call(hand_over)
        found = find(Folder(tmp_path / "kept"))
        assert found is not None
        recovered = recover(iota.System(), found)
    assert recovered.is_equal
