#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Formatters and linters of every language.

.venv/bin/python tools/lint.py            checks, changes nothing; exit code 1 for any error
.venv/bin/python tools/lint.py --format   formats C++ and Python in place
.venv/bin/python tools/lint.py --tidy     clang-tidy too (minutes; needs `make build` and `make test` before)
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
BIN = ROOT / ".venv" / "bin"
CPP_FOLDERS = ["include", "src", "bindings", "scenes", "tests/cpp", "tests/one_more", "bench", "examples/cpp"]
PYTHON_FOLDERS = [f for f in ["python", "tests", "tools", "bench", "examples", "scenes"] if (ROOT / f).is_dir()]

SHOWN_LINES = 60


def cpp_files(*suffixes: str) -> list[str]:
    return sorted(str(p) for f in CPP_FOLDERS for p in (ROOT / f).rglob("*") if p.suffix in suffixes)


def run(title: str, *command: str | Path, folder: Path = ROOT) -> bool:
    """Runs one tool; prints its output only on failure."""
    environment = dict(os.environ, PATH=f"{BIN}{os.pathsep}{os.environ.get('PATH', '')}")
    done = subprocess.run(
        [str(word) for word in command], cwd=folder, env=environment, text=True,
        stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
    )  # fmt: skip
    print(f"{title:24} {'ok' if done.returncode == 0 else 'complains'}", flush=True)
    if done.returncode:
        lines = done.stdout.splitlines()
        print(*(f"  {line}" for line in lines[:SHOWN_LINES]), sep="\n")
        if len(lines) > SHOWN_LINES:
            print(f"  ... and {len(lines) - SHOWN_LINES} more lines")
    return done.returncode == 0


def main() -> int:
    parser = argparse.ArgumentParser(description="Formatters and linters of every language.")
    parser.add_argument("--format", action="store_true", help="format in place instead of checking")
    parser.add_argument("--tidy", action="store_true", help="clang-tidy too")
    options = parser.parse_args()
    sources = cpp_files(".h", ".cpp")
    if options.format:
        good = [
            run("clang-format", BIN / "clang-format", "-i", *sources),
            run("ruff check --fix", BIN / "ruff", "check", "--fix-only", *PYTHON_FOLDERS),
            run("ruff format", BIN / "ruff", "format", *PYTHON_FOLDERS),
        ]
        return 0 if all(good) else 1
    good = [
        run("clang-format", BIN / "clang-format", "--dry-run", "-Werror", "--ferror-limit=1", *sources),
        run("ruff check", BIN / "ruff", "check", *PYTHON_FOLDERS),
        run("ruff format", BIN / "ruff", "format", "--check", *PYTHON_FOLDERS),
        run("mypy", BIN / "mypy"),
        run("tsc", BIN / "npm", "run", "check", folder=ROOT / "web"),
        run("oxlint", BIN / "npm", "run", "lint", folder=ROOT / "web"),
    ]
    if options.tidy:
        good.append(run("clang-tidy", BIN / "clang-tidy", "--quiet", "-p", ROOT / "build", *cpp_files(".cpp")))
    good.append(subprocess.run([BIN / "python", ROOT / "tools" / "folder_graph.py"]).returncode == 0)
    return 0 if all(good) else 1


if __name__ == "__main__":
    sys.exit(main())
