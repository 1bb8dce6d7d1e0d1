#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Measures the cost of a cut in the script: a chain of 10 000 links on a served world, cut repeatedly.

    .venv/bin/python bench/edit_cost.py [links]

Prints the median processor time of the cut itself, of the frame that sends it to viewers, and of a frame without an
edit.
"""

from __future__ import annotations

import statistics
import sys
import time
from collections.abc import Callable

import iota
from iota import _core

CUTS = 41


def milliseconds(work: Callable[[], object]) -> float:
    began = time.thread_time()
    work()
    return 1e3 * (time.thread_time() - began)


def main() -> None:
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 10_000
    system = iota.System(gravity=(0, 0, 0))
    links = iota.builder.chain(links=count, length=0.1 * count).realize(system).bodies
    server = _core.Server(port=0, token="token")
    room = server.open("default")
    whole = milliseconds(lambda: room.publish(system))
    cuts, frames, calm = [], [], []
    for cut in range(1, CUTS + 1):
        place = cut * count // (CUTS + 1)
        left, right = links[place - 1].particles[-1], links[place].particles[0]
        cuts.append(milliseconds(lambda p=left, q=right: p.separate(q)))
        frames.append(milliseconds(lambda: room.publish(system)))
        calm.append(milliseconds(lambda: room.publish(system)))
    room.close(system)
    server.close()
    extra = [edited - still for edited, still in zip(frames, calm, strict=True)]
    print(f"{count} links: first publish of all {whole:.1f} ms")
    for name, times in (("cut", cuts), ("additional time of the next frame", extra), ("frame without an edit", calm)):
        print(f"  {name}: median {statistics.median(times):.3f} ms, worst {max(times):.3f} ms")


if __name__ == "__main__":
    main()
