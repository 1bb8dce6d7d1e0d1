#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What a journal costs worlds in real time, and how long they take to come back.

    bench/journal_cost.py [--seconds 10] [STUDY ...]

A world with a journal and one without take turns of half a second in one process: time of the processor for a step, of
all threads. Of the journal, what the thread of the world spends on it and what the thread that writes spends are measured
by themselves, since the difference of the two worlds is smaller than the noise of a shared machine.
"""

from __future__ import annotations

import argparse
import statistics
import tempfile
import time
from pathlib import Path

from iota import studies
from iota.journal.folder import Folder
from iota.journal.reader import find, recover
from iota.journal.writer import Writer
from iota.world import World
from iota.world.journal import Journal

STUDIES = ("chain", "playground", "stack", "wrecking-ball", "undersea", "weather", "cloth", "shoal")
TURN = 60  # steps
spent = {"hands over": 0.0, "writes": 0.0}  # s


def clocked(kind: type, method: str, name: str) -> None:
    """Adds the time that a method takes on its thread."""
    function = getattr(kind, method)

    def call(self: object) -> None:
        began = time.thread_time()
        function(self)
        spent[name] += time.thread_time() - began

    setattr(kind, method, call)


def turn(world: World) -> float:
    """Processor time of a step, s, in real time."""
    began, due = time.process_time(), time.perf_counter()
    for _ in range(TURN):
        world.step()
        due += world.dt
        time.sleep(max(0.0, due - time.perf_counter()))
    return (time.process_time() - began) / TURN


def measure(name: str, seconds: float) -> None:
    kept, plain = (studies.module(name).build() for _ in range(2))
    with tempfile.TemporaryDirectory(dir=Path.cwd()) as folder:
        kept.keep(folder)
        times: dict[bool, list[float]] = {True: [], False: []}
        turn(kept), turn(plain)
        spent.update(dict.fromkeys(spent, 0.0))
        turns = max(1, round(seconds / TURN / kept.dt / 2))
        for _ in range(turns):
            times[True].append(turn(kept))
            times[False].append(turn(plain))
        with_it, without = (statistics.median(times[is_kept]) for is_kept in (True, False))
        state = kept.system.state_hash()
        kept.close()
        hands, writes = (1e6 * spent[part] / turns / TURN for part in ("hands over", "writes"))
        size = sum(file.stat().st_size for file in Path(folder).glob("*.journal"))
        found = find(Folder(Path(folder)))
        assert found is not None
        other = studies.module(name).build()
        other.system.step(other.dt)
        began = time.perf_counter()
        recovered = recover(other.system, found)
        took = time.perf_counter() - began
        same = "same state" if other.system.state_hash() == state else f"not the same state, at {recovered.time:.2f} s"
    print(
        f"{name:14} {without * 1e6:9.0f} {with_it * 1e6:13.0f} {hands:13.1f} {hands / without * 1e-4:6.1f} {writes:10.1f} "
        f"{size / 1000:12.0f} {took * 1e3:14.0f}   {same}",
        flush=True,
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seconds", type=float, default=10.0, help="of each study (default: 10)")
    parser.add_argument("studies", nargs="*", default=STUDIES)
    given = parser.parse_args()
    clocked(Journal, "hand_over", "hands over")
    clocked(Writer, "_run", "writes")
    print("a step, us: without  with journal   handing over      %    writing    files, kB  comes back, ms")
    for name in given.studies:
        measure(name, given.seconds)


if __name__ == "__main__":
    main()
