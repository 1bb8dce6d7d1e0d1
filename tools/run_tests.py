#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Runs the test suites of every language, some beside each other, and sums them in one closing line.

    tools/run_tests.py [--all] [SUITE ...]

Counts come from each runner's machine-readable results in build/test-results. A suite that crashes, runs out of time or
runs no test counts as one failure. The output of a suite is in build/logs/test-SUITE.log; the end of a failed one is
shown. Exit code 0 only if nothing failed.

Lanes: suites run beside each other on as many cores as each keeps busy, the longest first. The suites that draw, since
software rendering needs several cores, and those that a busy machine fails run one after another; with --all each of them
alone.

Amounts: tests that sample (random scenes, edits, damaged bytes) try a tenth of what they try with --all, which sets
IOTA_TEST_ALL (tests/cpp/amount.h, tests/python/amount.py). A suite with `inputs` runs when one of them has changed since
it passed, when it is named, and with --all; the others run always.

A test that fails in Python or in a browser is repeated once after all other suites, on a quiet machine: browsers draw in
software, and processes answer late, on a few busy cores, so that some time limits pass by chance. Browser tests are
repeated with their file unless they have a page of their own. What passed only then is named in the closing lines, and a
defect of that kind is to be found too. With more than a few failed files nothing is repeated.
"""

from __future__ import annotations

import json
import os
import re
import signal
import subprocess
import sys
import threading
import time
import xml.etree.ElementTree as ElementTree
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from fnmatch import fnmatch
from pathlib import Path

import build

ROOT = Path(__file__).resolve().parent.parent
RESULTS = ROOT / "build" / "test-results"
LOGS = ROOT / "build" / "logs"
BIN = ROOT / ".venv" / "bin"
STAMPS = ROOT / "build" / "stamps"
CORES = len(os.sched_getaffinity(0))
SHOWN_LINES = 60
SHOWN_SLOWEST = 10
#: The end of the name of a suite that repeats failed tests.
AGAIN = "-again"
#: Patterns of tests that may be skipped here; all others run, or fail. Pictures to look at are taken by make test-all.
EXPECTED_SKIPS: tuple[str, ...] = (
    "pictures.test.ts: pictures *",
    "xr.test.ts: pictures for people to look at *",
    "tests.python.test_machines.*",  # there is no wheel of Ray for this Python
)


@dataclass
class Count:
    """Numbers of passed, failed and skipped tests, and the names of the failed ones."""

    passed: int = 0
    failed: int = 0
    skipped: int = 0
    failures: list[str] = field(default_factory=list)
    #: Tests that failed once and passed when they were repeated.
    repeated: list[str] = field(default_factory=list)
    #: Seconds and name of each test.
    durations: list[tuple[float, str]] = field(default_factory=list)

    def add(self, other: Count) -> None:
        self.passed += other.passed
        self.failed += other.failed
        self.skipped += other.skipped
        self.failures += other.failures
        self.repeated += other.repeated
        self.durations += other.durations

    def skip(self, name: str) -> None:
        """Tests would drop out silently if a browser or a package is missing: that is a failure."""
        if any(fnmatch(name, expected) for expected in EXPECTED_SKIPS):
            self.skipped += 1
        else:
            self.fail(f"skipped: {name}")

    def fail(self, why: str) -> None:
        self.failed += 1
        self.failures.append(why)


def read_gtest(result: Path) -> Count:
    count = Count()
    for suite in json.loads(result.read_text())["testsuites"]:
        for test in suite["testsuite"]:
            count.durations.append((float(test.get("time", "0s").rstrip("s")), f"{suite['name']}.{test['name']}"))
            if test.get("failures"):
                count.fail(f"{suite['name']}.{test['name']}")
            elif test.get("result") == "SKIPPED":
                count.skip(f"{suite['name']}.{test['name']}")
            elif test.get("result") == "COMPLETED":
                count.passed += 1
    return count


def read_junit(result: Path) -> Count:
    count = Count()
    for case in ElementTree.parse(result).getroot().iter("testcase"):
        count.durations.append((float(case.get("time", 0)), f"{case.get('classname')}.{case.get('name')}"))
        if case.find("failure") is not None or case.find("error") is not None:
            count.fail(f"{case.get('classname')}.{case.get('name')}")
        elif case.find("skipped") is not None:
            count.skip(f"{case.get('classname')}.{case.get('name')}")
        else:
            count.passed += 1
    return count


def read_vitest(result: Path) -> Count:
    count = Count()
    for file in json.loads(result.read_text())["testResults"]:
        name = Path(file["name"]).name
        count.durations += [
            ((test.get("duration") or 0) / 1000, f"{name}: {test['fullName']}") for test in file["assertionResults"]
        ]
        states = [(test["status"], test["fullName"]) for test in file["assertionResults"]]
        for state, title in states:
            if state == "failed":
                count.fail(f"{name}: {title}")
            elif state == "passed":
                count.passed += 1
            else:
                count.skip(f"{name}: {title}")
        # A file that cannot be loaded, or whose set-up fails, has no failed test.
        if file["status"] == "failed" and not any(state == "failed" for state, _ in states):
            count.fail(f"{name}: {file.get('message', '').strip().splitlines()[:1]}")
    return count


@dataclass(frozen=True)
class Suite:
    """One runner: `{result}` in its command is the path of its results for `read`, and `{cores}` is `cores`.

    Without `read` the suite is one test that passes with exit code 0.
    """

    name: str
    command: list[str]
    limit_s: int
    read: Callable[[Path], Count] | None = None
    folder: Path = ROOT
    #: At most so many files (in Python: tests) that fail are run once more, when nothing else runs.
    repeats: int = 0
    #: The command that repeats failed tests, from the command and their names in the failures of `read`; empty if one of
    #: them can't be repeated.
    again: Callable[[list[str], list[str]], list[str]] | None = None
    #: The results of the run whose failed tests this one repeats.
    first: Count | None = None
    #: About how long it takes on two cores: the longest begins first.
    about_s: float = 1
    #: How many cores it keeps busy.
    cores: int = 1
    #: Never beside another one in turn.
    in_turn: bool = False
    #: It is split into so many parts that run as suites (GoogleTest only).
    shards: int = 1
    #: Takes long and rarely finds anything that the others do not: runs with --all, or when it is named.
    only_with_all: bool = False
    #: All files that it depends on, if it runs only when one of them has changed.
    inputs: Callable[[], list[Path]] | None = None
    environment: dict[str, str] = field(default_factory=dict)


def files_again(command: list[str], failures: list[str]) -> list[str]:
    """Repeats whole files of vitest, as a test in them may rely on those before it. Failures are `FILE: TITLE`."""
    return [*command, *sorted({failure.split(":")[0] for failure in failures})]


def titles_again(command: list[str], failures: list[str]) -> list[str]:
    """Repeats tests of vitest without the others of their files."""
    titles = "|".join(re.escape(failure.partition(": ")[2]) for failure in failures)
    return [*files_again(command, failures), f"--testNamePattern=^({titles})$"]


def nodes_again(command: list[str], failures: list[str]) -> list[str]:
    """Repeats tests of pytest in place of their folder or file. Failures are `FOLDER.MODULE.TEST[CASE]`."""
    parts = [re.fullmatch(r"((?:\w+\.)*?test_\w+)\.(.+)", failure, re.DOTALL) for failure in failures]
    nodes = [f"{part[1].replace('.', '/')}.py::{part[2]}" for part in parts if part]
    where = command.index("pytest") + 1
    return [*command[:where], *nodes, *command[where + 1 :]] if len(nodes) == len(failures) else []


def pytest(folder: str, *arguments: str) -> list[str]:
    return [str(BIN / "python"), "-m", "pytest", folder, *arguments, "--junitxml={result}", "-q", "--durations=5"]


def vitest(*arguments: str) -> list[str]:
    # Time limits end hanging tests only, as tests may be slow on a small, busy machine.
    limits = ["--testTimeout=300000", "--hookTimeout=300000"]
    reporters = ["--reporter=default", "--reporter=json", "--outputFile.json={result}"]
    return [str(BIN / "npx"), "--no-install", "vitest", "run", *arguments, *limits, *reporters]


def built() -> list[Path]:
    """Engine, server and bindings."""
    return sorted(path for path in (ROOT / "build" / "python" / "iota").glob("*") if path.is_file())


def web_sources() -> list[Path]:
    return build.files_under(
        ROOT / "web", skip=["node_modules", "dist", "dist.new", "dist.old", "test", "test-results"]
    )


def drawn_by() -> list[Path]:
    """The files that pictures, studies and packages in a browser depend on."""
    return [*built(), *build.files_under(ROOT / "python" / "iota", skip=["page"]), *web_sources()]


def placed_by() -> list[Path]:
    """The files that rooms and sweeps on several machines depend on, by themselves: a study or a picture changes nothing there."""
    package = ROOT / "python" / "iota"
    folders = [path for name in ("rooms", "journal", "cli") for path in build.files_under(package / name)]
    files = [package / name for name in ("machines.py", "saving.py", "sweeping.py")]
    return [*built(), *folders, *files, ROOT / MACHINES, ROOT / "tests" / "python" / "test_rooms.py"]


def installed_by() -> list[Path]:
    """The files that the wheel is made of and tested with; it is made again when one of its own inputs has changed."""
    return [*build.files_under(ROOT / "build" / "wheel"), ROOT / "tests" / "packaging" / "test_wheel.py"]


WEB = ROOT / "web"
BROWSER = ["--config", "e2e/vitest.config.ts"]
# These files are suites of their own, which run when something has changed.
PICTURES = [f"e2e/{name}.test.ts" for name in ("studies", "first_pictures", "looks")]
PACKAGES = ["e2e/packages.test.ts"]
WHEEL = "tests/packaging/test_wheel.py"
MACHINES = "tests/python/test_machines.py"
DRAWING_CORES = 1 if CORES < 4 else 2
OTHER_CORES = min(4, max(1, CORES - DRAWING_CORES))

SUITES = [
    Suite("folders", [str(BIN / "python"), "tools/folder_graph.py"], 60),
    Suite(
        "cpp", ["build/iota_tests", "--gtest_output=json:{result}"], 900, read_gtest,
        about_s=90, shards=min(4, CORES),
    ),
    # A few tests are long, so a worker that is done takes over tests of another. At least two workers: many tests wait
    # for a process or a browser, and so do those of the suite beside this one.
    Suite(
        "python", pytest("tests/python", f"--ignore={MACHINES}", f"-n={max(2, OTHER_CORES)}", "--dist=worksteal"), 2400, read_junit,
        repeats=4, again=nodes_again, about_s=500, cores=OTHER_CORES,
    ),
    # After what draws, beside short suites: a busy machine answers Ray too late, and is taken for a dead one.
    Suite("machines", pytest(MACHINES), 600, read_junit, repeats=2, again=nodes_again, about_s=55, in_turn=True, inputs=placed_by),
    Suite("page-types", [str(BIN / "npm"), "run", "check"], 300, None, WEB, about_s=10),
    Suite("page", vitest(), 300, read_vitest, WEB, about_s=25),
    Suite(
        "browser", vitest(*BROWSER, *(f"--exclude={name}" for name in PICTURES + PACKAGES)), 2400, read_vitest, WEB,
        repeats=4, again=files_again, about_s=320, cores=DRAWING_CORES, in_turn=True,
    ),
    Suite(
        "pictures", vitest(*BROWSER, *PICTURES), 1200, read_vitest, WEB,
        repeats=2, again=titles_again, about_s=240, cores=DRAWING_CORES, in_turn=True, inputs=drawn_by,
    ),
    Suite(
        "packages", vitest(*BROWSER, *PACKAGES), 600, read_vitest, WEB,
        repeats=1, again=files_again, about_s=30, cores=DRAWING_CORES, in_turn=True, inputs=drawn_by,
    ),
    Suite("packaging", pytest("tests/packaging", f"--ignore={WHEEL}"), 900, read_junit, about_s=38),
    Suite("wheel", pytest(WHEEL), 600, read_junit, about_s=12, inputs=installed_by),
    Suite("lint", ["make", "lint"], 1200, about_s=120, only_with_all=True),
    Suite("docs", ["make", "docs"], 1200, about_s=40, only_with_all=True),
    Suite(
        "determinism",
        ["sh", "-c", "ninja -C build iota_state_hashes && python tools/check_determinism.py --program build/iota_state_hashes"],
        900, about_s=30, only_with_all=True,
    ),
    # With a tenth of the samples, damaged snapshots and recordings among them; `make hostile` tries more.
    Suite(
        "sanitized", ["env", "-u", "IOTA_TEST_ALL", "make", "check-sanitized"], 5400,
        about_s=1500, shards=min(4, CORES), only_with_all=True,
    ),
]  # fmt: skip


def in_shards(suite: Suite) -> list[Suite]:
    """The suites that run: its shards, or itself."""
    if suite.shards == 1:
        return [suite]
    return [
        replace(
            suite, name=f"{suite.name}-{shard + 1}", about_s=suite.about_s / suite.shards, shards=1,
            environment={"GTEST_TOTAL_SHARDS": str(suite.shards), "GTEST_SHARD_INDEX": str(shard)},
        )
        for shard in range(suite.shards)
    ]  # fmt: skip


#: Set when the runs shall end before their time.
stopped = threading.Event()


def run(suite: Suite) -> Count:
    """Runs a suite to its end or its time limit and counts its tests."""
    result = RESULTS / f"{suite.name}.{'xml' if suite.read is read_junit else 'json'}"
    result.unlink(missing_ok=True)
    command = [word.replace("{result}", str(result)).replace("{cores}", str(suite.cores)) for word in suite.command]
    path = f"{BIN}{os.pathsep}{os.environ.get('PATH', '')}"
    environment = dict(os.environ, PATH=path, CI="true", NO_COLOR="1", **suite.environment)
    # Containers set it, and then each of some hundred processes compiles all of iota: two fifths of its start.
    environment.pop("PYTHONDONTWRITEBYTECODE", None)
    # Other threads of numpy wait busily: beside other suites a product of matrices takes ten times as long.
    environment.setdefault("OPENBLAS_NUM_THREADS", "1")
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
            code = wait(process, suite.limit_s)
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
        count.fail("interrupted" if stopped.is_set() else f"did not end within {suite.limit_s} s")
    elif code != 0 and count.failed == 0:
        count.fail(f"ended with exit code {code}")
    elif count.passed + count.failed == 0:
        count.fail("ran no test")
    return count


def wait(process: subprocess.Popen[bytes], limit_s: float) -> int | None:
    """The exit code, or None if the time is over or the runs are stopped before the process ends."""
    end = time.monotonic() + limit_s
    while not stopped.is_set() and time.monotonic() < end:
        try:
            return process.wait(timeout=min(0.2, max(0.0, end - time.monotonic())))
        except subprocess.TimeoutExpired:
            pass
    return process.poll()


def without_skipped(read: Callable[[Path], Count]) -> Callable[[Path], Count]:
    """The tests of a run that was told which ones."""

    def read_ran(result: Path) -> Count:
        count = read(result)
        count.failures = [failure for failure in count.failures if not failure.startswith("skipped: ")]
        count.failed = len(count.failures)
        return count

    return read_ran


def repetition(suite: Suite, count: Count) -> Suite | None:
    """The suite that runs the failed tests of a run once more and alone, if they are few."""
    few = 0 < len({failure.split(":")[0] for failure in count.failures}) <= suite.repeats
    if not (few and suite.read and suite.again and (command := suite.again(suite.command, count.failures))):
        return None
    return replace(
        suite, name=suite.name + AGAIN, command=command, read=without_skipped(suite.read), repeats=0, inputs=None,
        cores=CORES, first=count,
    )  # fmt: skip


def with_repeated(first: Count, again: Count) -> Count:
    """The results of a run and of the repetition of its failed tests."""
    repeated = [failure for failure in first.failures if failure not in again.failures]
    if again.passed < len(repeated):
        return first
    ran = first.passed + first.failed
    return Count(ran - again.failed, again.failed, first.skipped, again.failures, repeated, first.durations)


def end_group(leader: int) -> None:
    """Ends the remaining processes of a suite's group."""
    for how, wait_s in ((signal.SIGTERM, 1.0), (signal.SIGKILL, 0.0)):
        try:
            os.killpg(leader, how)
        except ProcessLookupError:
            return
        time.sleep(wait_s)


def not_well(count: Count) -> list[str]:
    """The names of what failed, for good or once."""
    return [
        *(f"  failed: {name}" for name in count.failures),
        *(f"  failed once, passed when repeated: {name}" for name in count.repeated),
    ]


def end_text(suite: Suite) -> list[str]:
    """The end of the log of a failed suite."""
    log = LOGS / f"test-{suite.name}.log"
    lines = log.read_text(errors="replace").splitlines()
    return [f"--- the end of {log.relative_to(ROOT)} ---", *lines[-SHOWN_LINES:], "---"]


class Lanes:
    """Runs suites beside each other, at most as many as there are cores for, each in a thread."""

    def __init__(self, suites: list[Suite]) -> None:
        self.waiting = sorted(suites, key=lambda suite: -suite.about_s)
        self.running: list[Suite] = []
        self.total = Count()
        self.changed = threading.Condition()

    def next(self) -> Suite | None:
        """The longest waiting suite that there is room for; the first always has room."""
        free = CORES - sum(suite.cores for suite in self.running)
        in_turn = any(suite.in_turn for suite in self.running)
        for suite in self.waiting:
            if not self.running or (suite.cores <= free and not (suite.in_turn and in_turn)):
                return suite
        return None

    def run(self) -> Count:
        threads = []
        try:
            with self.changed:
                while self.waiting or self.running:
                    if suite := self.next():
                        self.waiting.remove(suite)
                        self.running.append(suite)
                        threads.append(threading.Thread(target=self.run_one, args=(suite,)))
                        threads[-1].start()
                    else:
                        self.changed.wait()
        except BaseException:
            stopped.set()
            raise
        finally:
            for thread in threads:
                thread.join()
        return self.total

    def run_one(self, suite: Suite) -> None:
        began = time.monotonic()
        count = Count()
        try:
            before = digest(suite)
            count = run(suite)
            if before and not count.failed:
                build.write_stamp(stamp(suite), before)
        except Exception as error:
            count.fail(f"the runner itself failed: {error!r}")
        elapsed = time.monotonic() - began
        again = repetition(suite, count)
        with self.changed:
            if again:
                print(f"{suite.name:12} {count.failed} failed in {elapsed:.1f} s, to be repeated alone", flush=True)
                self.waiting.append(again)
            else:
                self.finish(suite, with_repeated(suite.first, count) if suite.first else count, elapsed)
            self.running.remove(suite)
            self.changed.notify()

    def finish(self, suite: Suite, count: Count, elapsed: float) -> None:
        """Tells the results of a suite and sums them up."""
        name = suite.name.removesuffix(AGAIN)
        count.failures = [f"{name}: {failure}" for failure in count.failures]
        count.repeated = [f"{name}: {test}" for test in count.repeated]
        self.total.add(count)
        skipped = f"{count.skipped:4} skipped" if count.skipped else " " * 12
        lines = [f"{name:12} {count.passed:5} passed {count.failed:4} failed {skipped} {elapsed:8.1f} s"]
        if count.failed:
            lines += end_text(suite)
        lines += not_well(count)
        print(*lines, sep="\n", flush=True)


def stamp(suite: Suite) -> Path:
    return STAMPS / f"test-{suite.name}"


def digest(suite: Suite) -> str:
    """The digest of the files that the suite depends on and its command; nothing if it runs always."""
    return build.digest(" ".join(suite.command), suite.inputs()) if suite.inputs else ""


def is_unchanged(suite: Suite) -> bool:
    return suite.inputs is not None and not build.is_stale(stamp(suite), digest(suite))


def chosen(names: list[str], all_of_them: bool) -> list[Suite]:
    """The named suites, or those with something new to test; the others are told."""
    if names:
        return [suite for suite in SUITES if suite.name in names]
    if all_of_them:  # there is time: what a busy machine fails runs alone
        return [replace(suite, cores=CORES) if suite.in_turn else suite for suite in SUITES]
    usual = [suite for suite in SUITES if not suite.only_with_all]
    unchanged = [suite for suite in usual if is_unchanged(suite)]
    for suite in unchanged:
        print(f"{suite.name:12} passed before, and nothing it depends on has changed", flush=True)
    return [suite for suite in usual if suite not in unchanged]


def main(arguments: list[str]) -> int:
    names = [name for name in arguments if name != "--all"]
    known = [suite.name for suite in SUITES]
    for name in names:
        if name not in known:
            print(f"no suite is called {name!r}; there are: {' '.join(known)}", file=sys.stderr)
            return 2
    # In the background of a shell, Ctrl-C is ignored by us and our children. Tests that send it need it.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    RESULTS.mkdir(parents=True, exist_ok=True)
    LOGS.mkdir(parents=True, exist_ok=True)
    began = time.monotonic()
    everything = "--all" in arguments
    parts = [part for suite in chosen(names, everything) for part in in_shards(suite)]
    if everything:
        parts = [replace(part, environment={**part.environment, "IOTA_TEST_ALL": "1"}) for part in parts]
    if len(parts) == 1:
        parts = [replace(parts[0], cores=min(4, CORES))]  # nothing else needs them
    total = Lanes(parts).run()
    print("slowest:")
    for seconds, name in sorted(total.durations, reverse=True)[:SHOWN_SLOWEST]:
        print(f"  {seconds:7.1f} s  {name}")
    # Once more here, as the end of a long log is what is kept and read.
    for line in not_well(total):
        print(line)
    print(f"all together: {time.monotonic() - began:.0f} s")
    skipped = f", {total.skipped} skipped" if total.skipped else ""
    repeated = f", {len(total.repeated)} only when repeated" if total.repeated else ""
    print(f"{total.passed} passed{repeated}, {total.failed} failed{skipped}", flush=True)
    return 1 if total.failed else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
