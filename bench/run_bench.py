#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Runs the engine's benchmarks and the packaged peers in one go and prints tables of ratios.

    make bench                                       # build first, then this
    python bench/run_bench.py --quick                # 8, 64 and 512 links, short
    python bench/run_bench.py --no-peers --filter 'chain/rod/robust/120/512/'

Everything runs on one core, one program after the other. The engine's chains run first and last, and each case keeps
the faster of the two; their difference is printed, as it is the uncertainty of a ratio. Results go to
build/bench/results.json and build/bench/results.md.
"""

from __future__ import annotations

import argparse
import json
import os
import platform
import re
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent
RESULTS = ROOT / "build" / "bench"
LINKS = (8, 64, 512, 4096, 16384, 100000)
AIM_US = {"robust": 0.3, "energy_keeping": 0.8}
"""Target for a link and step of a chain, microseconds."""

AIMS = (
    ("chain of rods, robust, us/link/step", r"chain/rod/robust/120/", "us_per_link_step", 1, 0.3, "<="),
    (
        "chain of rods, energy-keeping, us/link/step",
        r"chain/rod/energy_keeping/120/",
        "us_per_link_step",
        1,
        0.8,
        "<=",
    ),
    ("general rigid bodies, robust, us/link/step", r"rigid_chain/robust/", "us_per_link_step", 1, 1.5, "<="),
    (
        "general rigid bodies, energy-keeping, us/link/step",
        r"rigid_chain/energy_keeping/",
        "us_per_link_step",
        1,
        4,
        "<=",
    ),
    ("heavy end 1000:1, 64 links, robust, us/link/step", r"heavy_end/robust/", "us_per_link_step", 1, None, "<="),
    ("heavy end 1000:1, 64 links, energy-keeping", r"heavy_end/energy_keeping/", "us_per_link_step", 1, None, "<="),
    ("body with hinges, robust, us/hinge/step", r"hub/robust/", "us_per_link_step", 1, None, "<="),
    ("net 32 x 32, robust, ms a step (median)", r"net/robust/120/32/", "step_ms_p50", 1, 5, "<="),
    ("net 64 x 64, robust, ms a step (median)", r"net/robust/120/64/", "step_ms_p50", 1, None, "<="),
    ("net 100 x 100, robust, ms a step (median)", r"net/robust/120/100/", "step_ms_p50", 1, None, "<="),
    ("cloth of springs 100 x 100, first step, ms", r"first_step/springs/100", "first_step_ms", 1, 500, "<="),
    ("cloth of 100 000 springs, first step, ms", r"first_step/springs/223", "first_step_ms", 1, 2000, "<="),
    ("1000 ragdolls at 60 Hz, robust, ms of two cores a step", r"ragdolls/robust/1000/2/", "core_ms", 1, 16.7, "<="),
    ("1000 ragdolls at 60 Hz, energy-keeping", r"ragdolls/energy_keeping/1000/2/", "core_ms", 1, 16.7, "<="),
    ("1000 pendulums of one rod, robust, us/rod/step", r"pendulums/robust/", "us_per_body_step", 1, None, "<="),
    ("1000 pendulums, energy-keeping", r"pendulums/energy_keeping/", "us_per_body_step", 1, None, "<="),
    ("separate + combine, pairs a second", r"ragdolls/separate_combine", "pairs_per_s", 1, 1e6, ">="),
    ("cut in 10 000 links beyond a step, ms (99 %)", r"restructure/cut_and_rejoin/", "cut_ms_p99", 1, 1, "<="),
    ("rejoin of ends that have moved, beyond a step, ms", r"restructure/cut_and_rejoin/", "rejoin_ms_p99", 1, 1, "<="),
    ("grab in 10 000 links, 99 % beyond 99 % of held steps, ms", r"follow/plain/", "grab_ms_p99", 1, 1, "<="),
    ("cut while held, likewise", r"follow/held/", "cut_ms_p99", 1, 1, "<="),
    ("cut among damped links, likewise", r"follow/damped/", "cut_ms_p99", 1, 1, "<="),
    ("let go, likewise", r"follow/plain/", "let_go_ms_p99", 1, 1, "<="),
    ("begin a closing, likewise", r"follow/plain/", "close_ms_p99", 1, 1, "<="),
    ("interacting particles, steps a second", r"particles/", "particle_steps/s", 1, 5e6, ">="),
    ("100 000 boids of 20 neighbors, steps of one a second", r"boids/100000", "boid_steps/s", 1, None, ">="),
    ("memory of a two-point link, robust, bytes", r"memory/robust/", "bytes_per_link", 1, 1024, "<="),
    ("memory of a two-point link, energy-keeping, bytes", r"memory/energy_keeping/", "bytes_per_link", 1, 1024, "<="),
)
"""Targets: text, cases, counter, factor, target (None: only printed), direction."""

Row = dict[str, Any]


# --- running ---------------------------------------------------------------------------------------------------------


def pin_to_one_core() -> int:
    """Restricts this process and its children to its last core; returns its number, or -1."""
    if not hasattr(os, "sched_setaffinity"):
        return -1
    core = max(os.sched_getaffinity(0))
    os.sched_setaffinity(0, {core})
    return core


ALL_CORES = os.sched_getaffinity(0) if hasattr(os, "sched_getaffinity") else set()


def use_all_cores() -> None:
    """For cases with threads."""
    if ALL_CORES:
        os.sched_setaffinity(0, ALL_CORES)


def run_engine(binary: Path, pattern: str, all_cores: bool = False) -> list[Row]:
    """The cases of Google Benchmark whose names match, in their order."""
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "engine.json"
        subprocess.run(
            [binary, f"--benchmark_filter={pattern}", f"--benchmark_out={out}", "--benchmark_out_format=json",
             "--benchmark_min_time=0.1"],
            check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
            preexec_fn=use_all_cores if all_cores else None,
        )  # fmt: skip
        # Google Benchmark writes nan and inf, which are not JSON.
        cases: list[Row] = json.loads(re.sub(r": -?(nan|inf)\b", ": null", out.read_text()))["benchmarks"]
    return cases


def faster_of(first: list[Row], second: list[Row]) -> tuple[list[Row], float]:
    """The first list with the faster run of each case, and the median of slower / faster."""
    spread, best = [], []
    again = {case["name"]: case for case in second}
    for a in first:
        if a["name"] not in again:
            best.append(a)
            continue
        b = again[a["name"]]
        times = sorted((a["cpu_time"], b["cpu_time"]))
        spread.append(times[1] / times[0] if times[0] > 0 else 1.0)
        best.append(a if a["cpu_time"] <= b["cpu_time"] else b)
    return best, sorted(spread)[len(spread) // 2] if spread else 1.0


def run_peers(cases: Sequence[str], cap: float) -> list[Row]:
    """Every peer's row of these cases, SCENE/SIZE/HZ, with a line of progress for each."""
    command = [sys.executable, str(HERE / "peers" / "run.py"), "--cap", str(cap), "--cases", *cases]
    rows: list[Row] = []
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout
        for line in process.stdout:
            if line.startswith("{"):
                row = json.loads(line)
                rows.append(row)
                show(f"peers: {row['engine']} {row['setting']}, {row['scene']} {row['size']}, {row['hz']} Hz")
    return rows


def show(text: str) -> None:
    """A line of progress."""
    print(f"[bench] {text}", file=sys.stderr, flush=True)


# --- tables ----------------------------------------------------------------------------------------------------------


def engine_row(case: Row) -> Row:
    """One of the engine's cases in the shape of a peer's row: chain/LINK/MODE/HZ/SIZE, ragdolls/MODE/SIZE/THREADS,
    SCENE/MODE/HZ/SIZE."""
    scene, *rest = case["name"].split("/iterations")[0].split("/")
    link = rest.pop(0) if scene == "chain" else "rod"
    mode = rest[0]
    hz, size = (60, int(rest[1])) if scene == "ragdolls" else map(int, rest[1:3])
    warnings = [f"{case[key]:.0f} {key}" for key in ("fallbacks", "unconverged") if case[key]]
    return {
        "engine": "iota", "setting": mode if link == "rod" else f"{mode} {link}", "link": link, "mode": mode,
        "scene": scene, "size": size, "hz": hz,
        "us_per_link_step": case["us_per_link_step"], "worst_gap_m": case["gap_m"],
        "energy_end": case["energy_change"], "energy_gain": case["energy_gain"], "simulated_s": case["simulated_s"],
        "iterations_mean": case["iterations_mean"], "iterations_max": case["iterations_max"],
        "step_ms_p50": case.get("step_ms_p50"), "step_ms_p99": case.get("step_ms_p99"), "blew_up": "",
        "note": ", ".join(warnings),
    }  # fmt: skip


def is_compared(name: str) -> bool:
    """Whether the peers have this case, or the engine's row belongs in their table."""
    return bool(re.match(r"chain/|heavy_end/|net/\w+/120/32/|ragdolls/\w+/1000/1/", name))


def text_of(value: float | None, style: str) -> str:
    """A number for a table; a dash where there is none."""
    return "-" if value is None else format(value, style)


def table(title: str, head: Sequence[str], lines: Sequence[Sequence[str]]) -> str:
    """An aligned Markdown table; nothing without lines."""
    if not lines:
        return ""
    widths = [max(len(row[i]) for row in [head, *lines]) for i in range(len(head))]

    def draw(row: Sequence[str]) -> str:
        return "| " + " | ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)) + " |"

    return "\n".join([f"### {title}", "", draw(head), draw(["-" * width for width in widths]), *map(draw, lines), ""])


TITLES = {
    "chain": "{} links", "heavy_end": "{} links, the last 1000 times as heavy", "net": "net of {0} x {0} knots",
    "ragdolls": "{} ragdolls of 20 bodies",
}  # fmt: skip


def scene_tables(rows: Sequence[Row]) -> list[str]:
    """One table for each scene, size and step: ratios to iota's robust mode with the peers' model."""
    head = [
        "engine",
        "setting",
        "ratio",
        "us/link/step",
        "worst gap m",
        "energy end",
        "gain",
        "Newton",
        "s",
        "stays whole",
    ]
    tables = []
    for scene, size, hz in dict.fromkeys((row["scene"], row["size"], row["hz"]) for row in rows):
        here = [row for row in rows if (row["scene"], row["size"], row["hz"]) == (scene, size, hz)]
        base = next((r["us_per_link_step"] for r in here if r["setting"] == "robust"), None)
        lines = []
        for row in here:
            cost = row["us_per_link_step"]
            newton = f"{row['iterations_mean']:.1f}/{row['iterations_max']:.0f}" if "iterations_mean" in row else "-"
            whole = row.get("blew_up") or ("yes" if row.get("simulated_s", 0) >= 9.99 else "so far" if cost else "")
            whole = ", ".join(part for part in (whole, row.get("note")) if part)
            lines.append([
                row["engine"], row["setting"], text_of(cost / base if cost and base else None, ".2f"),
                text_of(cost, ".3f"), text_of(row.get("worst_gap_m"), ".1e"), text_of(row.get("energy_end"), ".1e"),
                text_of(row.get("energy_gain"), ".0e"), newton, text_of(row.get("simulated_s"), ".1f"), whole,
            ])  # fmt: skip
        tables.append(table(f"{TITLES[scene].format(size)}, 1/{hz} s", head, lines))
    return tables


def summary_table(rows: Sequence[Row]) -> str:
    """The cost of a link compared with the target, for each length of the chain."""
    head = ["mode", "link", "1/h", *map(str, sorted({r["size"] for r in rows})), "longest / 64", "Newton mean/max"]
    lines = []
    for key in dict.fromkeys((r["mode"], r["link"], r["hz"]) for r in rows):
        here = sorted((r for r in rows if (r["mode"], r["link"], r["hz"]) == key), key=lambda r: r["size"])
        cost = {r["size"]: r["us_per_link_step"] for r in here}
        flat = cost[max(cost)] / cost[64] if 64 in cost else None
        lines.append([
            key[0], key[1], str(key[2]),
            *(f"{cost[n]:.3f} ({cost[n] / AIM_US[key[0]]:.2f})" if n in cost else "-" for n in map(int, head[3:-2])),
            text_of(flat, ".2f"),
            f"{max(r['iterations_mean'] for r in here):.1f}/{max(r['iterations_max'] for r in here):.0f}",
        ])  # fmt: skip
    return table(
        "iota: us per link and step (in parentheses: over the aim of 0.3 robust, 0.8 energy-keeping)", head, lines
    )


def frame_table(rows: Sequence[Row]) -> str:
    """A chain of 2000 links against a sixtieth of a second."""
    lines = [
        [r["mode"], r["link"], str(r["hz"]), f"{r['step_ms_p50']:.2f}", f"{r['step_ms_p99']:.2f}",
         f"{r['hz'] / 60 * r['step_ms_p99'] / (1000 / 60):.2f}"]
        for r in rows if r["size"] == 2000
    ]  # fmt: skip
    head = ["mode", "link", "1/h", "step ms median", "99 %", "share of a 60 Hz frame (99 %)"]
    return table("2000 links at 60 frames a second", head, lines)


def other_table(cases: Sequence[Row]) -> str:
    """Edits, building, snapshots: cost a link or edit, and over one step of one link of the same chain."""
    lines = []
    step = next((c["us_per_link_step"] for c in cases if c["name"].startswith("chain/rod/robust/120/64/")), None)
    units = ("us_per_edit", "us_per_link_step", "us_per_link", "us_per_bond")
    for case in cases:
        unit = next((key for key in units if key in case), None)
        if is_compared(case["name"]) or unit is None:
            continue
        ratio = text_of(case[unit] / step if step else None, ".2f")
        note = f"{case['bytes_per_link']:.0f} bytes a link" if "bytes_per_link" in case else ""
        lines.append([case["name"], f"{case[unit]:.3f}", unit, ratio, note])
    return table("Edits and snapshots", ["case", "us", "of", "over a robust rod's step (64 links)", ""], lines)


def aims_table(cases: Sequence[Row]) -> str:
    """Every target and the measured value, with gap, energy and fall-backs."""
    lines = []
    for text, pattern, key, factor, aim, way in AIMS:
        for case in (c for c in cases if re.match(pattern, c["name"]) and key in c):
            value = case[key] * factor
            met = "" if aim is None else "yes" if (value <= aim if way == "<=" else value >= aim) else "no"
            trouble = [f"{case[k]:.0f} {k}" for k in ("fallbacks", "unconverged") if case.get(k)]
            lines.append([
                text, case["name"].split("/iterations")[0], f"{value:.4g}", "-" if aim is None else f"{way} {aim:g}",
                "-" if aim is None else f"{value / aim:.2f}", met, text_of(case.get("gap_m"), ".1e"),
                text_of(case.get("energy_change"), ".1e"), text_of(case.get("energy_gain"), ".0e"), ", ".join(trouble),
            ])  # fmt: skip
    head = ["what", "case", "measured", "aim", "over the aim", "met", "gap m", "energy end", "gain", ""]
    return table("The aims", head, lines)


def main() -> int:
    """Runs the requested cases; 1 if the engine's benchmarks are not built."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--binary", type=Path, default=ROOT / "build" / "iota_bench")
    parser.add_argument("--quick", action="store_true", help="8, 64 and 512 links, peers for at most 2 s a row")
    parser.add_argument("--cap", type=float, default=5, help="most seconds of wall clock a peer's row")
    parser.add_argument("--hz", nargs="+", type=int, help="frames a second; 60 and 120, quick: 120")
    parser.add_argument("--filter", default="", help="of the engine's cases, a regular expression")
    parser.add_argument("--no-peers", action="store_true")
    parser.add_argument("--json", action="store_true", help="print results.json in place of the tables")
    options = parser.parse_args()
    options.hz = options.hz or ([120] if options.quick else [60, 120])
    if not options.binary.is_file():
        print(f"run_bench.py: {options.binary} is not built; try: make bench", file=sys.stderr)
        return 1
    links = LINKS[:3] if options.quick else LINKS
    quick = f"chain/.*/120/({'|'.join(map(str, links))})/|rigid_chain/.*/64/|net/robust/120/32/|heavy_end|ragdolls/sep|cut_and_rejoin|particles"
    pattern = options.filter or (quick if options.quick else ".")
    core, began = pin_to_one_core(), time.time()

    alone = []
    if not options.filter:
        show("memory, and threads on all cores")
        alone = [c for mode in ("robust", "energy_keeping") for c in run_engine(options.binary, f"memory/{mode}")]
        alone += run_engine(options.binary, "ragdolls/.*/1000/", all_cores=True)
    show("engine, first time")
    first = run_engine(options.binary, pattern if pattern != "." else "-memory/|ragdolls/.*/1000/")  # all but those
    compared = [f"chain/{size}/{hz}" for hz in options.hz for size in links if size != 100000]
    compared += ["heavy_end/64/120", "net/32/120"] + ["ragdolls/1000/60"] * (not options.filter)
    peers = [] if options.no_peers else run_peers(compared, 2 if options.quick else options.cap)
    show("engine, second time")
    cases, spread = faster_of(first, run_engine(options.binary, pattern if pattern != "." else "^chain/.*/120/"))
    cases += alone

    own = [engine_row(case) for case in cases if is_compared(case["name"])]
    own = [row for row in own if row["scene"] != "chain" or row["hz"] in options.hz]
    chains = [row for row in own if row["scene"] == "chain"]
    parts = [
        "# Benchmarks\n",
        f"{platform.machine()}, one core ({core}), load {os.getloadavg()[0]:.1f}; the engine's two runs differ by "
        f"{100 * (spread - 1):.0f} % (median): trust ratios no further.\n"
        "Time: processor time inside the step, mean over the run. Energies: over the largest kinetic energy. "
        "`ratio`: to iota's robust rod in the same table.\n",
    ]  # fmt: skip
    parts.append(aims_table(cases))
    if chains:
        parts.append(summary_table([row for row in chains if row["size"] != 2000]))
        parts.append(frame_table(chains))
    parts += scene_tables([row for row in own if row["size"] != 2000] + peers)
    parts.append(other_table(cases))
    text = "\n".join(part for part in parts if part)

    RESULTS.mkdir(parents=True, exist_ok=True)
    result = {
        "when": time.strftime("%Y-%m-%dT%H:%M:%SZ", time.gmtime(began)), "machine": platform.machine(),
        "python": platform.python_version(), "spread": spread, "scenes": own, "peers": peers,
        "other": [case for case in cases if not is_compared(case["name"])],
    }  # fmt: skip
    (RESULTS / "results.json").write_text(json.dumps(result, indent=1) + "\n")
    (RESULTS / "results.md").write_text(text)
    print(json.dumps(result) if options.json else text)
    show(f"{time.time() - began:.0f} s; written to {RESULTS / 'results.json'} and results.md")
    return 0


if __name__ == "__main__":
    sys.exit(main())
