#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What a journal costs worlds in real time, and how long they take to come back.

    bench/journal_cost.py [--seconds 6] [STUDY ...]

A world with a journal and one without take turns of half a second in one process: time of the processor for a step, of
all threads. Of the journal, what the thread of the world spends on it, waiting included, and what the thread that writes spends are
measured by themselves, since the difference of the two worlds is smaller than the noise of a shared machine. The world that comes back
lacks functions that the script has given to bonds meanwhile, as that of chain does from 6.5 s on.
"""

from __future__ import annotations

import argparse
import statistics
import tempfile
import time
from pathlib import Path

from iota import studies
from iota._core import Log
from iota.journal.folder import Folder
from iota.journal.reader import find, recover
from iota.world import World
from iota.world.journal import Journal

STUDIES = ("chain", "playground", "stack", "wrecking-ball", "undersea", "weather", "cloth", "shoal")
TURN = 60  # steps
BEGIN = 3.0  # s: by then what comes to rest is there
spent = [0.0]  # s, on the thread of the world


def clock_hand_overs() -> None:
    """Adds up what a journal does on the thread of the world but for the native part, without the time of the clock itself."""
    hand_over = Journal.hand_over

    def call(self: Journal) -> None:
        before, began = time.perf_counter(), time.perf_counter()
        hand_over(self)
        spent[0] += time.perf_counter() - began - (began - before)

    Journal.hand_over = call  # type: ignore[method-assign]


def cut_time(log: Log, does: bool) -> float:
    """Time of the native part, which reads all of the state once in a tenth of a second, after a step that has used the caches, s. does: or
    only of the call of it, which that part does not have."""
    before, began = time.perf_counter(), time.perf_counter()
    _ = log.hash if does else log.is_editing
    return time.perf_counter() - began - (began - before)


def written(world: World) -> float:
    """Processor time of the thread that writes until now, s."""
    journal = world._stepper.journal
    assert journal is not None and journal._writer is not None
    return time.clock_gettime(time.pthread_getcpuclockid(journal._writer._thread.ident or 0))


def turn(world: World, cuts: dict[bool, list[float]] | None = None) -> float:
    """Processor time of a step, s, in real time. cuts: gets what `cut_time` tells."""
    began, due = time.process_time(), time.perf_counter()
    log = Log(world.system)
    for step in range(TURN):
        world.step()
        if cuts is not None and step % 4 == 0:
            does = step % 8 == 0
            cuts[does].append(cut_time(log, does))
        due += world.dt
        time.sleep(max(0.0, due - time.perf_counter()))
    return (time.process_time() - began) / TURN


def measure(name: str, seconds: float) -> None:
    kept, plain = (studies.module(name).build() for _ in range(2))
    with tempfile.TemporaryDirectory(dir=Path.cwd()) as folder:
        kept.keep(folder)
        times: dict[bool, list[float]] = {True: [], False: []}
        while kept.system.time < BEGIN:
            turn(kept), turn(plain)
        turns = max(1, round(seconds / TURN / kept.dt / 2))
        for _ in range(turns):
            times[True].append(turn(kept))
            times[False].append(turn(plain))
        cuts: dict[bool, list[float]] = {True: [], False: []}
        for _ in range(4):
            turn(plain, cuts)
        with_it, without = (statistics.median(times[is_kept]) for is_kept in (True, False))
        turn(kept)  # goes on without a pause, after which a world hands over
        spent[0], wrote = 0.0, written(kept)
        for _ in range(turns):
            turn(kept)
        hands, writes = (1e6 * each / turns / TURN for each in (spent[0], written(kept) - wrote))
        hands += 1e6 * (statistics.mean(cuts[True]) - statistics.mean(cuts[False])) * kept.dt / 0.1
        state = kept.system.state_hash()
        kept.close()
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
    parser.add_argument("--seconds", type=float, default=6.0, help="of each study (default: 6)")
    parser.add_argument("studies", nargs="*", default=STUDIES)
    given = parser.parse_args()
    clock_hand_overs()
    print("a step, us: without  with journal   handing over      %    writing    files, kB  comes back, ms")
    for name in given.studies:
        measure(name, given.seconds)


if __name__ == "__main__":
    main()
