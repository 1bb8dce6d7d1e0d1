#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""A sweep of 1000 runs on all cores: beside plain loops in as many processes, and while its processes are killed.

    .venv/bin/python bench/sweep_cost.py
    .venv/bin/python bench/sweep_cost.py --runs 200

Efficiency is the processor time of plain loops, each over its share of the runs, over that of the sweep, with a table on the disk. Both are measured in
turns, 100 runs at a time, with the start of their processes. What a sweep does not use of the cores at its end is less than a run for each.
"""

from __future__ import annotations

import argparse
import csv
import os
import random
import resource
import signal
import subprocess
import sys
import tempfile
import threading
from pathlib import Path

import iota

STEPS, LINKS, PART = 400, 16, 100
CORES = len(os.sched_getaffinity(0))


def swing(seed: int) -> dict[str, float]:
    """About 20 ms."""
    system = iota.System(threads=1)
    chain = iota.builder.chain(links=LINKS, length=1.6, top=(0, 2, 0), direction=(1, 0.001 * seed, 0)).realize(system)
    system.step(1 / 240, STEPS)
    return {"y": chain.bodies[-1].position.y}


def loop(seeds: str) -> None:
    """In a process of its own."""
    for seed in map(int, seeds.split(",")):
        swing(seed)


def plain_loops(seeds: list[int]) -> None:
    shares = [",".join(map(str, seeds[part::CORES])) for part in range(CORES)]
    for each in [subprocess.Popen([sys.executable, __file__, "--loop", share]) for share in shares]:
        each.wait()


def processor_time() -> float:
    """s, of this process and of its children that have ended."""
    return sum(
        usage.ru_utime + usage.ru_stime
        for usage in (resource.getrusage(resource.RUSAGE_SELF), resource.getrusage(resource.RUSAGE_CHILDREN))
    )


def children() -> list[int]:
    found = []
    for path in Path("/proc").glob("[0-9]*/stat"):
        try:
            fields = path.read_text().rsplit(")", 1)[1].split()
        except OSError:
            continue
        if int(fields[1]) == os.getpid():
            found.append(int(path.parent.name))
    return found


def killed(seeds: list[int], file: Path, every: float) -> int:
    """Kills a process of the sweep again and again. Returns how many. A run whose process dies twice is tried by the next call."""
    is_over, chance, kills = threading.Event(), random.Random(1), 0

    def kill() -> None:
        nonlocal kills
        while not is_over.wait(2 * every * chance.random()):
            if found := children():
                os.kill(chance.choice(found), signal.SIGKILL)
                kills += 1

    killer = threading.Thread(target=kill)
    killer.start()
    rows, calls = iota.sweep(swing, {"seed": seeds}, file), 1
    while any(row["error"] for row in rows):
        rows, calls = iota.sweep(swing, {"seed": seeds}, file), calls + 1
    is_over.set()
    killer.join()
    with file.open(newline="") as table:
        kept = [int(row["seed"]) for row in csv.DictReader(table)]
    chosen = random.Random(2).sample(range(len(seeds)), 10)
    assert kept == seeds, "a run is missing or there twice"
    assert all(rows[place]["y"] == swing(seeds[place])["y"] for place in chosen), "another result"
    print(f"{kills} kills in {len(seeds)} runs and {calls} calls: each run is there once, with its result")
    return kills


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--runs", type=int, default=1000)
    parser.add_argument("--loop", help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.loop:
        loop(arguments.loop)
        return
    seeds = list(range(arguments.runs))
    with tempfile.TemporaryDirectory(prefix="iota-sweep-") as place:
        ratios = []
        for begin in range(0, len(seeds), PART):
            part = seeds[begin : begin + PART]
            times = [processor_time()]
            plain_loops(part)
            times.append(processor_time())
            iota.sweep(swing, {"seed": part}, Path(place) / f"{begin}.csv")
            times.append(processor_time())
            ratios.append((times[1] - times[0]) / (times[2] - times[1]))
        ratios.sort()
        print(
            f"efficiency on {CORES} cores: {ratios[len(ratios) // 2]:.2f} in the median of {len(ratios)} parts, "
            f"{ratios[0]:.2f} to {ratios[-1]:.2f}; load {os.getloadavg()[0]:.1f}"
        )
        killed(seeds, Path(place) / "killed.csv", 0.5)


if __name__ == "__main__":
    main()
