#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Compares `iota.step_all` with a loop over the same systems, in turn, in one run.

    .venv/bin/python bench/step_all.py

The ratio of the shortest times counts, on a machine that does nothing else. On a busy one, only the processor time says
something: what the calling thread takes of it is what is left of a loop.
"""

from __future__ import annotations

import os
import time

import iota

SYSTEMS, LINKS, STEPS, ROUNDS = 64, 16, 100, 30


def make(number: int) -> iota.System:
    system = iota.System(threads=1)
    chain = iota.builder.chain(links=LINKS, length=1.6, top=(0, 2, 0), direction=(1, 0.01 * number, 0))
    chain.realize(system)
    return system


def main() -> None:
    alone, together = [make(n) for n in range(SYSTEMS)], [make(n) for n in range(SYSTEMS)]
    best: dict[str, tuple[float, float, float]] = {}
    for _ in range(ROUNDS):
        for name in ("loop", "step_all"):
            began = time.perf_counter(), time.thread_time(), time.process_time()
            if name == "loop":
                for system in alone:
                    system.step(1 / 240, STEPS)
            else:
                iota.step_all(together, 1 / 240, STEPS)
            ended = time.perf_counter(), time.thread_time(), time.process_time()
            took = tuple(b - a for a, b in zip(began, ended, strict=True))
            best[name] = min(best.get(name, took), took)  # type: ignore[type-var]
    assert all(a.state_hash() == b.state_hash() for a, b in zip(alone, together, strict=True))
    for name, (wall, thread, process) in best.items():
        print(
            f"{name:9} {1e3 * wall:8.1f} ms, of the calling thread {1e3 * thread:8.1f} ms, of all {1e3 * process:8.1f} ms"
        )
    print(f"ratio {best['loop'][0] / best['step_all'][0]:.2f} on {os.cpu_count()} cores, load {os.getloadavg()[0]:.1f}")


if __name__ == "__main__":
    main()
