#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Builds the engine with gcc and clang at -O1 and -O3 and checks that all give the same bits, on 1, 2 and 4 threads.

    tools/check_determinism.py [--compilers g++ clang++] [--levels 1 3]
    tools/check_determinism.py --program build/iota_state_hashes    this program alone, without building
    tools/check_determinism.py --renew                              writes the hashes of the first build

Runs tests/determinism/state_hashes.cpp of each build; exit code 1 with the first scene and tenth that differ, between
the builds or from the kept hashes (tests/determinism/hashes.txt). These are of one C library; another one is told and
not compared. A commit that renews them says why. A compiler that is not installed is skipped with a message.
"""

from __future__ import annotations

import argparse
import os
import platform
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
PROGRAM = "iota_state_hashes"
KEPT = ROOT / "tests" / "determinism" / "hashes.txt"


def build(compiler: str, level: str) -> Path:
    """The program of one compiler and level."""
    folder = ROOT / "build" / "determinism" / f"{compiler}-O{level}"
    configure = [
        "cmake", "-S", str(ROOT), "-B", str(folder), "-G", "Ninja", f"-DCMAKE_CXX_COMPILER={compiler}",
        f"-DCMAKE_CXX_FLAGS=-O{level} -w", "-DCMAKE_BUILD_TYPE=None", "-DIOTA_BUILD_NET=OFF", "-DIOTA_BUILD_PYTHON=OFF",
        "-DIOTA_BUILD_BENCH=OFF",
    ]  # fmt: skip
    jobs = str(len(os.sched_getaffinity(0)))
    for command in (configure, ["cmake", "--build", str(folder), "--parallel", jobs, "--target", PROGRAM]):
        done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        if done.returncode:
            sys.exit(f"{' '.join(command)} failed:\n{done.stdout[-4000:]}")
    return folder / PROGRAM


def run(program: Path) -> dict[str, list[str]]:
    """Scene -> hashes."""
    done = subprocess.run([program], capture_output=True, text=True)
    if done.returncode:
        sys.exit(f"{program} ended with exit code {done.returncode}:\n{done.stderr}")
    return {name: hashes for name, *hashes in (line.split() for line in done.stdout.splitlines())}


def threads_that_differ(hashes: dict[str, list[str]]) -> list[str]:
    """One sentence per NAME@THREADS that is not equal to the first of its name."""
    first: dict[str, list[str]] = {}
    return [
        f"{scene} differs from fewer threads"
        for scene, values in hashes.items()
        if "@" in scene and first.setdefault(scene.split("@")[0], values) != values
    ]


def differences(first: dict[str, list[str]], other: dict[str, list[str]]) -> list[str]:
    """One sentence per scene that differs."""
    if first.keys() != other.keys():
        return ["not the same scenes"]
    found = []
    for scene, hashes in first.items():
        at = next((i for i, (a, b) in enumerate(zip(hashes, other[scene], strict=True)) if a != b), None)
        if at is not None:
            found.append(f"{scene} differs from tenth {at + 1} on")
    return found


def library() -> str:
    """The processor family and the C library, on which the bits depend: "x86_64, glibc 2.36"."""
    return f"{platform.machine()}, {' '.join(platform.libc_ver())}"


def write(hashes: dict[str, list[str]], path: Path, of: str) -> None:
    lines = [f"{scene} {' '.join(values)}" for scene, values in hashes.items()]
    path.write_text("\n".join([of, *lines]) + "\n")


def differences_from_kept(hashes: dict[str, list[str]], path: Path, of: str) -> tuple[list[str], str]:
    """One sentence per scene that differs from the kept hashes, and what was compared."""
    kept_of, *lines = path.read_text().splitlines()
    if kept_of != of:
        return [], f"not compared, they are of {kept_of}"
    kept = {scene: values for scene, *values in (line.split() for line in lines)}
    return differences(kept, hashes), f"{len(kept)} scenes, the same bits"


def main() -> int:
    parser = argparse.ArgumentParser(description="Same bits from every compiler and optimization level.")
    parser.add_argument("--compilers", nargs="+", default=["g++", "clang++"])
    parser.add_argument("--levels", nargs="+", default=["1", "3"])
    parser.add_argument("--program", type=Path, help="a built iota_state_hashes, instead of all builds")
    parser.add_argument("--renew", action="store_true", help="keep the hashes of the first build")
    options = parser.parse_args()
    first: dict[str, list[str]] | None = None
    same = True
    for name, program in [(str(options.program), options.program)] if options.program else builds(options):
        hashes = run(program)
        first = first or hashes
        wrong = differences(first, hashes) + threads_that_differ(hashes)
        same = same and not wrong
        print(f"{name}: {'; '.join(wrong) if wrong else f'{len(hashes)} scenes, the same bits'}")
    if first is None:
        return 1
    if options.renew:
        write(first, KEPT, library())
    wrong, compared = differences_from_kept(first, KEPT, library())
    hint = ". If that is meant: --renew, and say why in the commit"
    print(f"{KEPT.name}: {'; '.join(wrong) + hint if wrong else compared}")
    return 0 if same and not wrong else 1


def builds(options: argparse.Namespace) -> Iterator[tuple[str, Path]]:
    """The name and the program of each compiler and level."""
    for compiler in options.compilers:
        if not shutil.which(compiler):
            print(f"{compiler}: not installed, left out")
            continue
        for level in options.levels:
            yield f"{compiler} -O{level}", build(compiler, level)


if __name__ == "__main__":
    sys.exit(main())
