#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Compares `iota.step_all` with a loop over the same systems, with two processes that share nothing, and with two that only count, in one run.

    .venv/bin/python bench/step_all.py

Rounds take some milliseconds, so that on a busy machine some of thousands have both cores for themselves: the shortest one
counts. Two processes, each with a half of the systems, tell how much faster two cores of this machine are than one; two that count, and
use no memory, how much of that is the cores' own.
"""

from __future__ import annotations

import multiprocessing
import os
import time
from collections import defaultdict
from multiprocessing.queues import Queue
from multiprocessing.synchronize import Barrier

import iota

SYSTEMS, LINKS, STEPS, ROUNDS = 64, 16, 10, 2000
COUNT = 100_000
Interval = tuple[float, float]


def make(number: int) -> iota.System:
    system = iota.System(threads=1)
    chain = iota.builder.chain(links=LINKS, length=1.6, top=(0, 2, 0), direction=(1, 0.01 * number, 0))
    chain.realize(system)
    return system


def loop(systems: list[iota.System]) -> Interval:
    began = time.perf_counter()
    for system in systems:
        system.step(1 / 240, STEPS)
    return began, time.perf_counter()


def count() -> Interval:
    began = time.perf_counter()
    sum(range(COUNT))
    return began, time.perf_counter()


def work(part: int, counts: bool, start: Barrier, intervals: Queue[tuple[int, Interval]]) -> None:
    systems = [] if counts else [make(n) for n in range(part, SYSTEMS, 2)]
    for round in range(ROUNDS):
        start.wait()
        intervals.put((round, count() if counts else loop(systems)))


def two_processes(counts: bool) -> float:
    """The shortest time in which both halves are done, s."""
    context = multiprocessing.get_context("spawn")
    start, intervals = context.Barrier(2), context.Queue()
    halves = [context.Process(target=work, args=(part, counts, start, intervals)) for part in range(2)]
    for half in halves:
        half.start()
    rounds: dict[int, list[Interval]] = defaultdict(list)
    for _ in range(2 * ROUNDS):
        round, interval = intervals.get()
        rounds[round].append(interval)
    for half in halves:
        half.join()
    return min(max(end for _, end in pair) - min(began for began, _ in pair) for pair in rounds.values())


def main() -> None:
    alone, together = [make(n) for n in range(SYSTEMS)], [make(n) for n in range(SYSTEMS)]
    best = {"loop": 1e9, "step_all": 1e9}
    for _ in range(ROUNDS):
        began, ended = loop(alone)
        best["loop"] = min(best["loop"], ended - began)
        began = time.perf_counter()
        iota.step_all(together, 1 / 240, STEPS)
        best["step_all"] = min(best["step_all"], time.perf_counter() - began)
    assert all(a.state_hash() == b.state_hash() for a, b in zip(alone, together, strict=True))
    best["two processes"] = two_processes(counts=False)
    for name, wall in best.items():
        print(f"{name:14} {1e3 * wall:6.2f} ms, {best['loop'] / wall:.2f} times as fast as the loop")
    alone_s = min(end - began for began, end in (count() for _ in range(ROUNDS)))
    print(
        f"{'two that count':14} {1e3 * alone_s:6.2f} ms, {2 * alone_s / two_processes(counts=True):.2f} times as fast as one"
    )
    print(f"{os.cpu_count()} cores, load {os.getloadavg()[0]:.1f}")


if __name__ == "__main__":
    main()
