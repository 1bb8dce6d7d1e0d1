#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The long runs, one after the other; the build makes their programs.

    tools/soak.py [NAME ...]      scenes heaps promises edits levels sleep verify ladder studies messages kills rooms page; all without a name

Exit code 0 only if none failed. A failing random scene is printed as the shortest script that still fails.
"""

from __future__ import annotations

import subprocess
import sys
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
RUNS = {
    "scenes": [str(ROOT / "build" / "iota_soak"), "scenes", "10000"],
    "heaps": [str(ROOT / "build" / "iota_soak"), "heaps", "10000"],
    "promises": [str(ROOT / "build" / "iota_soak"), "promises", "10000"],
    "edits": [str(ROOT / "build" / "iota_soak"), "edits", "10000000"],
    "levels": [
        *("env", "IOTA_LEVEL_SCENES=10000", str(ROOT / ".venv" / "bin" / "python"), "-m", "pytest", "-q"),
        str(ROOT / "tests" / "python" / "test_random_levels.py"),
    ],
    "sleep": [
        *("env", "IOTA_SLEEP_SCENES=10000", str(ROOT / ".venv" / "bin" / "python"), "-m", "pytest", "-q"),
        str(ROOT / "tests" / "python" / "test_random_sleep.py"),
    ],
    "verify": [str(ROOT / ".venv" / "bin" / "iota"), "verify", "--long"],
    "ladder": [
        *(
            "env",
            "IOTA_TEST_ALL=1",
            "IOTA_LADDER_MINUTES=10",
            str(ROOT / ".venv" / "bin" / "python"),
            "-m",
            "pytest",
            "-q",
        ),
        *(str(ROOT / "tests" / "python" / "test_study_ladder.py"), "-k", "never_stuck"),
    ],
    "studies": [
        *("env", "IOTA_STUDY_SECONDS=600", str(ROOT / ".venv" / "bin" / "python"), "-m", "pytest", "-q"),
        str(ROOT / "tests" / "python" / "test_studies.py"),
    ],
    "messages": [
        *("env", "IOTA_MESSAGE_SECONDS=60", str(ROOT / ".venv" / "bin" / "python"), "-m", "pytest", "-q"),
        str(ROOT / "tests" / "python" / "test_random_messages.py"),
    ],
    "kills": [
        *("env", "IOTA_KILLS=1000", str(ROOT / ".venv" / "bin" / "python"), "-m", "pytest", "-q", "-s"),
        *(str(ROOT / "tests" / "python" / "test_journal.py"), "-k", "no_kill"),
    ],
    "rooms": [
        *("env", "IOTA_KILLS=1000", str(ROOT / ".venv" / "bin" / "python"), "-m", "pytest", "-q", "-s"),
        *(str(ROOT / "tests" / "python" / "test_rooms.py"), "-k", "is_killed"),
    ],
    "page": [str(ROOT / ".venv" / "bin" / "node"), str(ROOT / "web" / "e2e" / "page_soak.ts")],
}


def main(names: list[str]) -> int:
    for name in names:
        if name not in RUNS:
            print(f"no long run is called {name!r}; there are: {' '.join(RUNS)}", file=sys.stderr)
            return 2
    failed = []
    for name in names or RUNS:
        print(f"--- {name}: {' '.join(RUNS[name][1:])}", flush=True)
        began = time.monotonic()
        if subprocess.run(RUNS[name], cwd=ROOT).returncode != 0:
            failed.append(name)
        print(f"--- {name}: {time.monotonic() - began:.0f} s", flush=True)
    print(f"failed: {' '.join(failed)}" if failed else "nothing failed", flush=True)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
