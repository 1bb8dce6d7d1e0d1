# SPDX-License-Identifier: Apache-2.0
"""What one person with many connections cannot do to a world; see docs/attacks.md."""

from __future__ import annotations

import subprocess
import sys
import textwrap
import threading
import time
from collections.abc import Callable
from contextlib import suppress

import pytest
from page_client import PageClient, encode
from websockets.exceptions import ConnectionClosed

import iota
from iota.studies import playground

Runner = Callable[[iota.World], str]

HANGING = """
import sys, threading, iota
system = iota.System()
body = system.body()
body.particle((0, 1, 0))
world = iota.World(system)
goes_on = threading.Event()
@world.action("hang", on="world")
def hang(): goes_on.wait()
@world.action("note", on="world")
def note(): pass
print(world.start(port=0), flush=True)
sys.stdin.readline()
goes_on.set()
sys.stdin.readline()
world.stop()
"""


def memory_of(process: int) -> float:
    """MB."""
    with open(f"/proc/{process}/status") as status:
        (line,) = [line for line in status if line.startswith("VmHWM")]
    return float(line.split()[1]) / 1e3


@pytest.mark.skipif(sys.platform != "linux", reason="reads /proc")
def test_clients_that_reconnect_while_a_callback_hangs_fill_no_memory() -> None:
    """130 MB for each connection before; 43 of them took 5.6 GB."""
    large = encode("action", name="note", body=(0, 1), others=[(1, 1)] * 4000)
    with subprocess.Popen(
        [sys.executable, "-c", textwrap.dedent(HANGING)], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    ) as process:
        assert process.stdin is not None and process.stdout is not None
        url = process.stdout.readline().strip()
        with PageClient(url) as page:
            page.send("action", name="hang", body=(0, 0))
            before = memory_of(process.pid)
            for _ in range(12):
                with PageClient(url) as other, suppress(ConnectionClosed):
                    for _ in range(1000):
                        other.send_bytes(large)
            process.stdin.write("\n")
            process.stdin.flush()
            page.wait_for(lambda: page.last["poses"]["step"] > 0)
            filled = memory_of(process.pid) - before
            process.stdin.write("\n")
            process.stdin.flush()
        assert filled < 150


def test_copies_of_all_that_is_there_do_not_stop_a_playground(run_world: Runner) -> None:
    """25 messages a second with up to 400 bodies made a step of 11 s before."""
    world = playground.build()
    url = run_world(world)
    stopped = threading.Event()
    with PageClient(url) as other, PageClient(url) as page:

        def attack() -> None:
            while not stopped.wait(0.04):
                ids = [body["id"] for body in list(page.entities["body"].values())][:400]
                if ids:
                    page.send("action", name="copy", body=ids[0], others=ids[1:])

        thread = threading.Thread(target=attack)
        thread.start()
        try:
            other.wait_for(lambda: other.last["poses"]["step"] > 300)
        finally:
            stopped.set()
            thread.join()
        assert world.call(lambda: len(world.system.bodies)) < 450
        step = other.last["poses"]["step"]
        other.wait_for(lambda: other.last["poses"]["step"] > step + 100)


def test_forty_connections_of_one_person_neither_hurry_a_world_nor_hold_it_at_its_start(run_world: Runner) -> None:
    """Each may have its part of what all together may: one single step a round, ten resets and then one in five seconds."""
    system = iota.System()
    world, resets, steps = iota.World(system), [], []
    world.on_reset(lambda: resets.append(time.monotonic()))
    world.on_step(lambda: steps.append(time.monotonic()))
    rounds: list[int] = []
    world.on_frame(lambda: rounds.append(1))
    url = run_world(world)
    pages = [PageClient(url) for _ in range(20)]
    try:
        for _ in range(30):
            for page in pages:
                page.send("control", command=2, value=0.0)
                page.send("control", command=3, value=0.0)
            time.sleep(0.02)
        pages[0].wait_for(lambda: len(steps) > 5)
    finally:
        for page in pages:
            page.close()
    assert len(resets) <= 2 + (resets[-1] - resets[0]) and len(resets) < 11
    assert len(steps) <= 3 * len(rounds) + 10, "600 requests for steps"
