#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Compares two builds of the engine's benchmarks row by row, on one core, in one run.

    python bench/compare.py ../before/build/iota_bench build/iota_bench
    python bench/compare.py BEFORE AFTER --filter 'chain/rod' --runs 7

The two programs take turns (before, after, before, after ...) within each row, so that a drift of the machine's speed
affects both equally. A row is the median of its runs; the last column is after / before. Memory rows compare bytes a
link or box. Exit code 1 if a row is above --limit.
"""

from __future__ import annotations

import argparse
import json
import os
import statistics
import subprocess
import sys
from pathlib import Path

# For steps that allocate or whose median differs from the mean, their own counter is more precise.
COUNTERS = ("us_per_link_step", "step_ms_p50", "bytes_per_link", "bytes_per_box")


def rows_of(program: Path, pattern: str) -> list[str]:
    listed = subprocess.run(
        [program, "--benchmark_list_tests", f"--benchmark_filter={pattern}"], capture_output=True, text=True, check=True
    )
    return listed.stdout.split()


def measure(program: Path, row: str, seconds: float) -> float:
    """The value of a row: its counter if it has one of COUNTERS, else processor time, ns."""
    result = subprocess.run(
        [
            program,
            f"--benchmark_filter=^{row}$",
            "--benchmark_format=json",
            *([] if "/iterations:" in row else [f"--benchmark_min_time={seconds}"]),
        ],
        capture_output=True,
        text=True,
        check=True,
    )
    entry = json.loads(result.stdout)["benchmarks"][0]
    return float(next((entry[name] for name in COUNTERS if name in entry), entry["cpu_time"]))


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("before", type=Path)
    parser.add_argument("after", type=Path)
    parser.add_argument("--filter", default=".", help="which rows, a regular expression (default: all that both have)")
    parser.add_argument("--runs", type=int, default=5)
    parser.add_argument("--seconds", type=float, default=0.2, help="of a run of a row without a fixed number of steps")
    parser.add_argument("--limit", type=float, default=float("inf"), help="largest ratio allowed")
    arguments = parser.parse_args()

    os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})
    known = set(rows_of(arguments.before, arguments.filter))
    rows = [row for row in rows_of(arguments.after, arguments.filter) if row in known]
    if not rows:
        print("no row that both programs have fits the filter", file=sys.stderr)
        return 2
    worst = 0.0
    print("| row | before | after | after / before |\n|---|---|---|---|")
    for row in rows:
        pairs = [
            (measure(arguments.before, row, arguments.seconds), measure(arguments.after, row, arguments.seconds))
            for _ in range(arguments.runs)
        ]
        before, after = (statistics.median(column) for column in zip(*pairs, strict=True))
        ratio = after / before if before else float("nan")
        worst = max(worst, ratio)
        name = row.replace("/process_time", "").replace("/real_time", "").split("/iterations:")[0]
        print(f"| {name} | {before:.4g} | {after:.4g} | {ratio:.3f} |", flush=True)
    return int(worst > arguments.limit)


if __name__ == "__main__":
    sys.exit(main())
