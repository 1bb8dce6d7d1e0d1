#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Runs the chain in the packaged peers and prints one JSON object a line (bench/requirements.txt and package.json here name
the packages).

    python bench/peers/run.py                                   # defaults, and the cheapest setting known to survive
    python bench/peers/run.py --engines rapier --links 64 --hz 120 --substeps 1 2 4 8
    python bench/peers/run.py --search                          # double the sub-steps until the chain stays whole

Each row is a process of its own, so that a crash or a build without end costs that row only.
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
from pathlib import Path

ENGINES = ("mujoco", "mujoco-tied", "bullet", "rapier", "jolt")
MODULES = {
    "mujoco": "mujoco",
    "mujoco-tied": "mujoco",
    "bullet": "pybullet",
    "rapier": "rapier3d",
    "jolt": "jolt-physics",
}
HERE = Path(__file__).resolve().parent
NODE = str(Path(sys.executable).parent / "node")  # .venv's; Jolt is an npm package
LINKS = (8, 64, 512, 4096, 16384)
HZ = (60, 120)
MOST_SUBSTEPS = 64
"""Where the search gives up."""

SURVIVES = {
    ("mujoco", 8, 60): 8, ("mujoco", 8, 120): 4,
    ("mujoco-tied", 8, 60): 4, ("mujoco-tied", 8, 120): 2,
    ("mujoco-tied", 64, 60): 8, ("mujoco-tied", 64, 120): 4,
    ("bullet", 64, 60): 4, ("bullet", 64, 120): 2,
    ("bullet", 512, 60): 16, ("bullet", 512, 120): 8,
    ("rapier", 64, 60): 2,
    ("rapier", 512, 60): 4, ("rapier", 512, 120): 2,
    ("rapier", 4096, 60): 8, ("rapier", 4096, 120): 4,
    ("rapier", 16384, 60): 8, ("rapier", 16384, 120): 4,
    ("jolt", 512, 120): 8,
}  # fmt: skip
"""(engine, links, hz) -> fewest sub-steps (of 1, 2, 4 ...) with every gap under a link and no made-up energy, as `--search`
found it with 8 s a row. Bullet's at 512 links and Rapier's at 4096 were whole as far as the cap let them go; Rapier's at 16 384
take over those of 4096, since no row got through there. MuJoCo found none at 64 links (tree) and 512 links (either)
up to 64 sub-steps; a stiffer solref did not change that."""

LONGEST = {"mujoco": 512, "mujoco-tied": 512, "bullet": 4096, "rapier": 16384, "jolt": 4096}
"""Links beyond which an engine only wastes the cap: a tree's mass matrix is dense along a chain (160 us a link at 512);
tied bodies run out of memory at 4096; Bullet does not get through its first steps at 16 384."""


def run_here(engine: str, links: int, hz: int, substeps: int, seconds: float, cap: float) -> dict[str, object]:
    """One row, in this process."""
    from chain import Chain, Row, measure

    row = Row(engine, f"sub{substeps}" if substeps > 1 else "default", links, hz)
    # Looking costs as much as stepping where poses are read one by one, so look less often at long chains.
    row.observed_every = max(1, links // (64 * substeps))
    simulation: Chain
    if engine.startswith("mujoco"):
        from mujoco_chain import MujocoChain

        simulation = MujocoChain(links, hz, substeps, tied=engine == "mujoco-tied")
    elif engine == "bullet":
        from bullet_chain import BulletChain

        simulation = BulletChain(links, hz, substeps)
    else:
        from rapier_chain import RapierChain

        simulation = RapierChain(links, hz, substeps)
    measure(simulation, row, seconds, cap)
    return row.as_dict()


def run_apart(engine: str, links: int, hz: int, substeps: int, seconds: float, cap: float) -> dict[str, object]:
    """One row in a new process; a row without numbers and with a note if that fails."""
    numbers = list(map(str, (links, hz, substeps, seconds, cap)))
    if engine == "jolt":
        command = [NODE, str(HERE / "jolt_chain.mjs"), *numbers]
    else:
        command = [sys.executable, str(Path(__file__).resolve()), "--one", engine, *numbers]
    setting = f"sub{substeps}" if substeps > 1 else "default"
    row: dict[str, object] = {"engine": engine, "setting": setting, "links": links, "hz": hz, "us_per_link_step": None}
    try:
        # Building takes a while too; a single step that outlasts all this is no use to anyone.
        with tempfile.TemporaryDirectory() as scratch:  # MuJoCo leaves a log where it runs
            result = subprocess.run(command, capture_output=True, text=True, timeout=cap + 30, cwd=scratch)
    except subprocess.TimeoutExpired:
        return row | {"blew_up": "", "note": f"not done within {cap + 30:.0f} s"}
    for line in result.stdout.splitlines():
        if line.startswith("{"):
            found: dict[str, object] = json.loads(line)
            return found
    reason = result.stderr.strip().splitlines()[-1:] or [f"exit code {result.returncode}"]
    return row | {"blew_up": "", "note": reason[0][:160]}


def rows(engines: Sequence[str], links: Sequence[int], hz: Sequence[int], substeps: Sequence[int], search: bool,
         seconds: float, cap: float) -> Iterator[dict[str, object]]:  # fmt: skip
    """Every row that was asked for, in order of length, so that an engine that cannot go on is not asked again."""
    for engine in engines:
        for rate in hz:
            for count in sorted(links):
                survivor = SURVIVES.get((engine, count, rate), 0)
                settings = list(substeps) or [1] + [survivor] * (survivor > 1)
                if count > LONGEST[engine] and not substeps:
                    continue
                row: dict[str, object] = {}
                for setting in settings:
                    row = run_apart(engine, count, rate, setting, seconds, cap)
                    yield row
                setting = settings[-1]
                while search and row["us_per_link_step"] and row["blew_up"] and setting < MOST_SUBSTEPS:
                    setting *= 2
                    row = run_apart(engine, count, rate, setting, seconds, cap)
                    yield row
                if row["us_per_link_step"] is None:
                    break


def missing(engines: Sequence[str]) -> list[str]:
    """The packages that these engines need and that cannot be imported here."""
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
    """Reads the command line; 0 unless nothing could be run."""
    if sys.argv[1:2] == ["--one"]:
        engine, links, hz, substeps, seconds, cap = sys.argv[2:8]
        # Warnings that engines print go to a file descriptor of theirs; keep standard output for the row.
        print(json.dumps(run_here(engine, int(links), int(hz), int(substeps), float(seconds), float(cap))), flush=True)
        os._exit(0)  # some engines take seconds to put 16 384 bodies away
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--engines", nargs="+", choices=ENGINES, default=list(ENGINES))
    parser.add_argument("--links", nargs="+", type=int, default=list(LINKS))
    parser.add_argument("--hz", nargs="+", type=int, default=list(HZ), help="frames a second")
    parser.add_argument(
        "--substeps", nargs="+", type=int, default=[], help="sub-steps a frame, instead of the known ones"
    )
    parser.add_argument("--seconds", type=float, default=10, help="of simulation")
    parser.add_argument("--cap", type=float, default=8, help="most seconds of wall clock a row")
    parser.add_argument("--search", action="store_true", help="double the sub-steps until the chain stays whole")
    options = parser.parse_args()
    absent = missing(options.engines)
    if absent:
        print(
            f"run.py: not installed: {', '.join(absent)}; try: pip install -r bench/requirements.txt", file=sys.stderr
        )
    engines = [engine for engine in options.engines if MODULES[engine] not in absent]
    for row in rows(engines, options.links, options.hz, options.substeps, options.search, options.seconds, options.cap):
        print(json.dumps(row), flush=True)
    return 0 if engines else 1


if __name__ == "__main__":
    sys.exit(main())
