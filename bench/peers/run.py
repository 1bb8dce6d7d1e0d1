#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Runs the benchmark's scenes in the packaged peers and prints one JSON object a line (bench/requirements.txt and
package.json here name the packages).

    python bench/peers/run.py                                   # defaults, and the cheapest setting known to survive
    python bench/peers/run.py --engines rapier --cases chain/64/120 heavy_end/64/120 --substeps 1 2 4 8
    python bench/peers/run.py --search                          # double the sub-steps until the scene stays whole

Each row is a separate process, so that a crash or an endless build affects only that row.
"""

from __future__ import annotations

import argparse
import importlib
import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

MODULES = {
    "mujoco": "mujoco",
    "mujoco-tied": "mujoco",
    "bullet": "pybullet",
    "rapier": "rapier3d",
    "jolt": "jolt-physics",
}
"""Engine -> the package it comes in."""

HERE = Path(__file__).resolve().parent
NODE = str(Path(sys.executable).parent / "node")  # .venv's; Jolt is an npm package
CASES = [f"chain/{links}/{hz}" for hz in (60, 120) for links in (8, 64, 512, 4096, 16384)]
CASES += ["heavy_end/64/120", "net/32/120", "ragdolls/1000/60"]
"""Scene / size / frames a second."""

MOST_SUBSTEPS = 64
"""Limit of the search."""

SURVIVES = {
    ("mujoco", "chain/8/60"): 8, ("mujoco", "chain/8/120"): 4,
    ("mujoco-tied", "chain/8/60"): 4, ("mujoco-tied", "chain/8/120"): 2,
    ("mujoco-tied", "chain/64/60"): 8, ("mujoco-tied", "chain/64/120"): 4,
    ("bullet", "chain/64/60"): 4, ("bullet", "chain/64/120"): 2,
    ("bullet", "chain/512/60"): 16, ("bullet", "chain/512/120"): 8,
    ("rapier", "chain/64/60"): 2,
    ("rapier", "chain/512/60"): 4, ("rapier", "chain/512/120"): 2,
    ("rapier", "chain/4096/60"): 8, ("rapier", "chain/4096/120"): 4,
    ("rapier", "chain/16384/60"): 8, ("rapier", "chain/16384/120"): 4,
    ("jolt", "chain/512/120"): 8,
    ("mujoco", "heavy_end/64/120"): 16, ("bullet", "heavy_end/64/120"): 16,
    ("rapier", "heavy_end/64/120"): 4, ("jolt", "heavy_end/64/120"): 4,
    ("mujoco-tied", "net/32/120"): 4, ("bullet", "net/32/120"): 4, ("jolt", "net/32/120"): 2,
}  # fmt: skip
"""Fewest sub-steps (of 1, 2, 4 ...) with every gap under a link and no gain of energy, as found by `--search` with 8 s
a row; default 1. Bullet's at 512 links and Rapier's at 4096 stayed whole until the cap; Rapier's at 16 384 is that of
4096, since no row was completed there. MuJoCo found none at 64 links (tree) and 512 links (either) up to 64 sub-steps,
nor for tied bodies with a heavy end; a stiffer solref did not change that."""

LARGEST = {"mujoco": 512, "mujoco-tied": 512, "bullet": 4096, "rapier": 16384, "jolt": 4096}
"""Largest chains for each engine: a tree's mass matrix is dense along a chain (160 us a link at 512); tied bodies run
out of memory at 4096; Bullet does not complete its first steps at 16 384."""


@dataclass(frozen=True)
class Job:
    """One row to run."""

    engine: str
    case: str
    substeps: int
    seconds: float
    cap: float

    @property
    def parts(self) -> tuple[str, int, int]:
        scene, size, hz = self.case.split("/")
        return scene, int(size), int(hz)

    def new_row(self) -> dict[str, object]:
        """A row without numbers."""
        scene, size, hz = self.parts
        setting = f"sub{self.substeps}" if self.substeps > 1 else "default"
        return {"engine": self.engine, "setting": setting, "scene": scene, "size": size, "hz": hz, "links": size,
                "us_per_link_step": None, "steps": 0, "blew_up": "", "note": ""}  # fmt: skip


def run_here(job: Job) -> None:
    """Runs a job in this process and prints its row; for Jolt it runs Node.js."""
    from judge import Peer, Row, measure, quaternions_of
    from scene import GRAVITY, LENGTH, SCENES

    name, size, hz = job.parts
    scene = SCENES[name](size)
    if job.engine == "jolt":
        scene_json = {
            "mass": scene.mass, "inertia": scene.inertia, "center": scene.center, "turn": quaternions_of(scene.rotation),
            "joints": scene.joints, "joint_at": scene.joint_at, "anchors": scene.anchors(),
        }  # fmt: skip
        work = {
            "scene": scene_json, "hz": hz, "substeps": job.substeps, "seconds": job.seconds, "cap": job.cap,
            "available": scene.available(), "gravity": GRAVITY, "longest_gap": LENGTH,
            "row": job.new_row() | {"links": len(scene.mass), "note": "WebAssembly"},
        }  # fmt: skip
        Path("job.json").write_text(json.dumps(work, default=lambda array: array.tolist()))
        os.execv(NODE, [NODE, str(HERE / "jolt_peer.mjs"), str(Path("job.json").resolve())])
    peer: Peer
    if job.engine.startswith("mujoco"):
        from mujoco_peer import MujocoPeer

        peer = MujocoPeer(scene, hz, job.substeps, tied=job.engine == "mujoco-tied")
    elif job.engine == "bullet":
        from bullet_peer import BulletPeer

        peer = BulletPeer(scene, hz, job.substeps)
    else:
        from rapier_peer import RapierPeer

        peer = RapierPeer(scene, hz, job.substeps)
    row = Row(job.engine, str(job.new_row()["setting"]), name, size, hz)
    measure(scene, peer, row, job.seconds, job.cap)
    print(json.dumps(row.as_dict()), flush=True)
    os._exit(0)  # some engines take seconds to destroy 16 384 bodies


def run_apart(job: Job) -> dict[str, object]:
    """One row in a new process; a row without numbers and with a note if that fails."""
    command = [sys.executable, str(Path(__file__).resolve()), "--one", job.engine, job.case]
    command += map(str, (job.substeps, job.seconds, job.cap))
    try:
        # Includes the time to build; a single step that takes longer is useless.
        with tempfile.TemporaryDirectory() as scratch:  # MuJoCo writes a log in its working folder
            result = subprocess.run(command, capture_output=True, text=True, timeout=job.cap + 30, cwd=scratch)
    except subprocess.TimeoutExpired:
        return job.new_row() | {"note": f"not done within {job.cap + 30:.0f} s"}
    for line in result.stdout.splitlines():  # engines print warnings, too
        if line.startswith("{"):
            found: dict[str, object] = json.loads(line)
            return found
    reason = result.stderr.strip().splitlines()[-1:] or [f"exit code {result.returncode}"]
    return job.new_row() | {"note": reason[0][:160]}


def possible(engine: str, scene: str, size: int) -> bool:
    """Whether the engine can build the scene and step it."""
    if scene == "chain":
        return size <= LARGEST[engine]
    return not (engine == "mujoco" and scene == "net")  # a tree has no loops


def rows(options: argparse.Namespace, engines: Sequence[str]) -> Iterator[dict[str, object]]:
    """All requested rows, scene by scene in order of size; after a failure of an engine its larger rows are skipped."""
    for engine in engines:
        stuck: set[tuple[str, int]] = set()
        for case in options.cases:
            scene, size, hz = case.split("/")
            if (scene, hz) in stuck or not (options.substeps or possible(engine, scene, int(size))):
                continue
            survivor = SURVIVES.get((engine, case), 1)
            settings = options.substeps or [1] + [survivor] * (survivor > 1)
            row: dict[str, object] = {}
            for setting in settings:
                row = run_apart(Job(engine, case, setting, options.seconds, options.cap))
                yield row
            setting = settings[-1]
            while options.search and row["us_per_link_step"] and row["blew_up"] and setting < MOST_SUBSTEPS:
                setting *= 2
                row = run_apart(Job(engine, case, setting, options.seconds, options.cap))
                yield row
            if row["us_per_link_step"] is None:
                stuck.add((scene, hz))


def missing(engines: Sequence[str]) -> list[str]:
    """The missing packages of these engines."""
    absent = []
    if "jolt" in engines and not (HERE / "node_modules" / "jolt-physics").is_dir():
        absent.append("jolt-physics")
    for name in dict.fromkeys(MODULES[engine] for engine in engines if engine != "jolt"):
        try:
            importlib.import_module(name)
        except ImportError:
            absent.append(name)
    return absent


def main() -> int:
    """Runs the command line; 0 unless nothing could be run."""
    if sys.argv[1:2] == ["--one"]:
        engine, case, substeps, seconds, cap = sys.argv[2:7]
        run_here(Job(engine, case, int(substeps), float(seconds), float(cap)))
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--engines", nargs="+", choices=MODULES, default=list(MODULES))
    parser.add_argument("--cases", nargs="+", default=CASES, metavar="SCENE/SIZE/HZ", help="smaller sizes first")
    parser.add_argument(
        "--substeps", nargs="+", type=int, default=[], help="sub-steps a frame, instead of the known ones"
    )
    parser.add_argument("--seconds", type=float, default=10, help="of simulation")
    parser.add_argument("--cap", type=float, default=8, help="most seconds of wall clock a row")
    parser.add_argument("--search", action="store_true", help="double the sub-steps until the scene stays whole")
    options = parser.parse_args()
    absent = missing(options.engines)
    if absent:
        print(
            f"run.py: not installed: {', '.join(absent)}; try: pip install -r bench/requirements.txt", file=sys.stderr
        )
    engines = [engine for engine in options.engines if MODULES[engine] not in absent]
    for row in rows(options, engines):
        print(json.dumps(row), flush=True)
    return 0 if engines else 1


if __name__ == "__main__":
    sys.exit(main())
