#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Runs the test suites of every language and sums them in one closing line.

    tools/run_tests.py [SUITE ...]

Counts come from each runner's machine-readable results in build/test-results. A suite that crashes, runs out of time or
runs no test counts as one failure. The output of a suite is in build/logs/test-SUITE.log; the end of a failed one is
shown. Exit code 0 only if nothing failed.

A browser test that fails is repeated once with its file, in a fresh browser: it draws in software on a few busy cores,
so that some of its time limits pass by chance. What passed only then is named in the closing lines, and a defect of
that kind is to be found too. With more than a few failed files nothing is repeated.
"""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
import xml.etree.ElementTree as ElementTree
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
RESULTS = ROOT / "build" / "test-results"
LOGS = ROOT / "build" / "logs"
BIN = ROOT / ".venv" / "bin"
SHOWN_LINES = 60


@dataclass
class Count:
    """Numbers of passed, failed and skipped tests, and the names of the failed ones."""

    passed: int = 0
    failed: int = 0
    skipped: int = 0
    failures: list[str] = field(default_factory=list)
    #: Those that failed once and passed when they were repeated.
    repeated: list[str] = field(default_factory=list)

    def add(self, other: Count) -> None:
        self.passed += other.passed
        self.failed += other.failed
        self.skipped += other.skipped
        self.failures += other.failures
        self.repeated += other.repeated

    def fail(self, why: str) -> None:
        self.failed += 1
        self.failures.append(why)


def read_gtest(result: Path) -> Count:
    count = Count()
    for suite in json.loads(result.read_text())["testsuites"]:
        for test in suite["testsuite"]:
            if test.get("failures"):
                count.fail(f"{suite['name']}.{test['name']}")
            elif test.get("result") == "COMPLETED":
                count.passed += 1
            else:
                count.skipped += 1
    return count


def read_junit(result: Path) -> Count:
    count = Count()
    for case in ElementTree.parse(result).getroot().iter("testcase"):
        if case.find("failure") is not None or case.find("error") is not None:
            count.fail(f"{case.get('classname')}.{case.get('name')}")
        elif case.find("skipped") is not None:
            count.skipped += 1
        else:
            count.passed += 1
    return count


def read_vitest(result: Path) -> Count:
    count = Count()
    for file in json.loads(result.read_text())["testResults"]:
        name = Path(file["name"]).name
        states = [(test["status"], test["fullName"]) for test in file["assertionResults"]]
        for state, title in states:
            if state == "failed":
                count.fail(f"{name}: {title}")
            elif state == "passed":
                count.passed += 1
            else:
                count.skipped += 1
        # A file that cannot be loaded, or whose set-up fails, has no failed test.
        if file["status"] == "failed" and not any(state == "failed" for state, _ in states):
            count.fail(f"{name}: {file.get('message', '').strip().splitlines()[:1]}")
    return count


@dataclass(frozen=True)
class Suite:
    """One runner: `{result}` in its command is the path of its results for `read`.

    Without `read` the suite is one test that passes with exit code 0.
    """

    name: str
    command: list[str]
    limit_s: int
    read: Callable[[Path], Count] | None = None
    folder: Path = ROOT
    #: At most so many files with failed tests are run once more, each `FILE: TITLE` in the failures of `read`.
    repeats: int = 0


def pytest(folder: str, *arguments: str) -> list[str]:
    return [str(BIN / "python"), "-m", "pytest", folder, *arguments, "--junitxml={result}", "-q", "--durations=5"]


def vitest(*arguments: str) -> list[str]:
    # Time limits end hanging tests only, as tests may be slow on a small, busy machine.
    limits = ["--testTimeout=180000", "--hookTimeout=180000"]
    reporters = ["--reporter=default", "--reporter=json", "--outputFile.json={result}"]
    return [str(BIN / "npx"), "--no-install", "vitest", "run", *arguments, *limits, *reporters]


SUITES = [
    Suite("folders", [str(BIN / "python"), "tools/folder_graph.py"], 60),
    Suite("cpp", ["build/iota_tests", "--gtest_output=json:{result}"], 900, read_gtest),
    # Most tests keep one core busy; a few are long, so a worker that is done takes over tests of another.
    Suite("python", pytest("tests/python", "-n=auto", "--maxprocesses=4", "--dist=worksteal"), 1200, read_junit),
    Suite("page-types", [str(BIN / "npm"), "run", "check"], 300, None, ROOT / "web"),
    Suite("page", vitest(), 300, read_vitest, ROOT / "web"),
    Suite("browser", vitest("--config", "e2e/vitest.config.ts"), 2400, read_vitest, ROOT / "web", repeats=4),
    Suite("packaging", pytest("tests/packaging"), 900, read_junit),
]


def run(suite: Suite) -> Count:
    """Runs a suite to its end or its time limit and counts its tests."""
    result = RESULTS / f"{suite.name}.{'xml' if suite.read is read_junit else 'json'}"
    result.unlink(missing_ok=True)
    command = [word.replace("{result}", str(result)) for word in suite.command]
    environment = dict(os.environ, PATH=f"{BIN}{os.pathsep}{os.environ.get('PATH', '')}", CI="true", NO_COLOR="1")
    count = Count()
    with (LOGS / f"test-{suite.name}.log").open("w") as log:
        try:
            process = subprocess.Popen(
                command, cwd=suite.folder, env=environment, stdin=subprocess.DEVNULL, stdout=log, stderr=log,
                start_new_session=True,
            )  # fmt: skip
        except OSError as error:
            log.write(f"{error}\n")
            count.fail(f"cannot be started: {error}")
            return count
        try:
            code: int | None = process.wait(timeout=suite.limit_s)
        except subprocess.TimeoutExpired:
            code = None
        finally:
            end_group(process.pid)  # also browsers and servers left by a failed test
    if suite.read and result.is_file():
        try:
            count.add(suite.read(result))
        except (ValueError, KeyError, ElementTree.ParseError) as error:
            count.fail(f"its results cannot be read: {error!r}")
    elif suite.read is None and code == 0:
        count.passed += 1
    if code is None:
        count.fail(f"did not end within {suite.limit_s} s")
    elif code != 0 and count.failed == 0:
        count.fail(f"ended with exit code {code}")
    elif count.passed + count.failed == 0:
        count.fail("ran no test")
    return count


def run_with_repeats(suite: Suite) -> Count:
    """Runs a suite, and its files with failed tests once more if they are few."""
    count = run(suite)
    files = sorted({failure.split(":")[0] for failure in count.failures})
    if not 0 < len(files) <= suite.repeats:
        return count
    again = run(replace(suite, name=f"{suite.name}-again", command=[*suite.command, *files]))
    repeated = [failure for failure in count.failures if failure not in again.failures]
    if again.passed < len(repeated):
        return count
    ran = count.passed + count.failed
    return Count(ran - again.failed, again.failed, count.skipped, again.failures, repeated)


def end_group(leader: int) -> None:
    """Ends the remaining processes of a suite's group."""
    for how, wait_s in ((signal.SIGTERM, 1.0), (signal.SIGKILL, 0.0)):
        try:
            os.killpg(leader, how)
        except ProcessLookupError:
            return
        time.sleep(wait_s)


def show_failure(suite: Suite, count: Count) -> None:
    again = LOGS / f"test-{suite.name}-again.log"
    log = again if suite.repeats and again.is_file() else LOGS / f"test-{suite.name}.log"
    lines = log.read_text(errors="replace").splitlines()
    print(f"--- the end of {log.relative_to(ROOT)} ---", *lines[-SHOWN_LINES:], "---", sep="\n")
    for name in count.failures:
        print(f"  failed: {suite.name}: {name}")


def main(names: list[str]) -> int:
    known = {suite.name: suite for suite in SUITES}
    for name in names:
        if name not in known:
            print(f"no suite is called {name!r}; there are: {' '.join(known)}", file=sys.stderr)
            return 2
    # In the background of a shell, Ctrl-C is ignored by us and our children. Tests that send it need it.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    RESULTS.mkdir(parents=True, exist_ok=True)
    LOGS.mkdir(parents=True, exist_ok=True)
    total = Count()
    for suite in [known[name] for name in names] or SUITES:
        print(f"{suite.name:12} ", end="", flush=True)
        began = time.monotonic()
        (LOGS / f"test-{suite.name}-again.log").unlink(missing_ok=True)
        count = run_with_repeats(suite)
        skipped = f"{count.skipped:4} skipped" if count.skipped else " " * 12
        elapsed = time.monotonic() - began
        print(f"{count.passed:5} passed {count.failed:4} failed {skipped} {elapsed:8.1f} s", flush=True)
        if count.failed:
            show_failure(suite, count)
        for name in count.repeated:
            print(f"  failed once, passed when repeated: {suite.name}: {name}")
        total.add(count)
    skipped = f", {total.skipped} skipped" if total.skipped else ""
    repeated = f", {len(total.repeated)} only when repeated" if total.repeated else ""
    print(f"{total.passed} passed{repeated}, {total.failed} failed{skipped}", flush=True)
    return 1 if total.failed else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
