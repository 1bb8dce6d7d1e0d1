#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Bodies that touch, in iota and the packaged engines, in one run: processor time, overlap and what a scene is for.

    .venv/bin/python bench/contact_bench.py                        # all scenes (needs bench/requirements.txt)
    .venv/bin/python bench/contact_bench.py --scenes tower cradle --engines iota Rapier

Each row is a process of its own. Poses are judged, not what an engine reports of itself (peers/contact_scene.py). A row that
takes longer than --cap seconds of processor time is stopped, and says so.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import time
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE / "peers"))

from contact_engines import ENGINES  # noqa: E402
from contact_scene import SCENES, Judge  # noqa: E402

EVERY = 0.25  # s, between two looks at overlaps


def run(scene_name: str, engine_name: str, hz: int, cap: float) -> dict[str, object]:
    """One row."""
    scene = SCENES[scene_name]()
    engine = ENGINES[engine_name](scene, hz)
    judge, steps = Judge(scene), round(scene.seconds * hz)
    judge.look(*engine.poses(), deep=False)
    used, slowest, done = 0.0, 0.0, 0
    for k in range(steps):
        begun = time.process_time()
        engine.step()
        took = time.process_time() - begun
        used, slowest, done = used + took, max(slowest, took), k + 1
        judge.look(*engine.poses(), deep=(k + 1) % round(EVERY * hz) == 0 or k + 1 == steps)
        if used > cap:
            break
    passes, figure = judge.verdict(scene_name, hz) if done == steps else (False, f"stopped after {done / hz:.1f} s")
    return {
        "scene": scene_name, "engine": engine_name, "us": 1e6 * used / (done * len(scene.moving)),
        "slowest_ms": 1e3 * slowest, "overlap_mm": 1e3 * max(0.0, judge.worst), "last_mm": 1e3 * max(0.0, judge.last),
        "passes": passes, "figure": figure,
    }  # fmt: skip


def table(rows: list[dict[str, object]]) -> str:
    lines = [
        "| scene | engine | us a body and step | of iota's | slowest step, ms | worst overlap, mm | |",
        "|---|---|---|---|---|---|---|",
    ]
    ours = {row["scene"]: row["us"] for row in rows if row["engine"] == "iota" and "us" in row}
    for row in rows:
        if "us" not in row:
            lines.append(f"| {row['scene']} | {row['engine']} | | | | | {row['figure']} |")
            continue
        own, us = ours.get(row["scene"]), float(str(row["us"]))
        ratio = f"{us / float(str(own)):.2f}" if own else ""
        lines.append(
            f"| {row['scene']} | {row['engine']} | {us:.1f} | {ratio} | {row['slowest_ms']:.1f} "
            f"| {row['overlap_mm']:.2g} | {'' if row['passes'] else '**fails**, '}{row['figure']} |"
        )
    return "\n".join(lines)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--scenes", nargs="+", default=list(SCENES), choices=list(SCENES), metavar="SCENE")
    parser.add_argument("--engines", nargs="+", default=list(ENGINES), choices=list(ENGINES), metavar="ENGINE")
    parser.add_argument("--hz", type=int, default=60)
    parser.add_argument("--cap", type=float, default=60.0, help="processor time of a row, s")
    parser.add_argument("--row", nargs=2, metavar=("SCENE", "ENGINE"), help=argparse.SUPPRESS)
    chosen = parser.parse_args()
    if chosen.row:
        print(json.dumps(run(*chosen.row, chosen.hz, chosen.cap)))
        return
    rows: list[dict[str, object]] = []
    for scene in chosen.scenes:
        for engine in chosen.engines:
            print(f"{scene}: {engine}", file=sys.stderr)
            words = [sys.executable, __file__, "--row", scene, engine, "--hz", str(chosen.hz), "--cap", str(chosen.cap)]
            done = subprocess.run(words, capture_output=True, text=True)
            lines = done.stdout.strip().splitlines()
            if done.returncode == 0 and lines:
                rows.append(json.loads(lines[-1]))
            else:
                why = done.stderr.strip().splitlines()[-1:] or [f"ended with {done.returncode}"]
                rows.append({"scene": scene, "engine": engine, "figure": f"did not run: {why[0]}"})
    print(table(rows))


if __name__ == "__main__":
    main()
