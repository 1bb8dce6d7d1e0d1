# SPDX-License-Identifier: Apache-2.0
"""The test runner counts what the suites' own runners say, and is not fooled by a suite that says nothing."""

import json
import os
import signal
import sys
import threading
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture
def runner(load_tool: Callable[[str], ModuleType], tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    module = load_tool("run_tests")
    monkeypatch.setattr(module, "ROOT", tmp_path)
    monkeypatch.setattr(module, "RESULTS", tmp_path / "results")
    monkeypatch.setattr(module, "LOGS", tmp_path / "logs")
    monkeypatch.setattr(module, "STAMPS", tmp_path / "stamps")
    monkeypatch.setattr(module, "CORES", 2)
    monkeypatch.setattr(module, "EXPECTED_SKIPS", ("Chain.flies", "t.c"))
    monkeypatch.delenv("IOTA_TEST_ALL", raising=False)  # as `make test-all` sets it
    return module


def suite(runner: ModuleType, script: str, read: object = None, limit_s: int = 60) -> object:
    return runner.Suite("made-up", [sys.executable, "-c", script], limit_s, read, ROOT)


def closing_line(runner: ModuleType, made: object, capsys: pytest.CaptureFixture[str]) -> tuple[int, str]:
    runner.SUITES = [made]
    code = runner.main([])
    return code, capsys.readouterr().out.splitlines()[-1]


def writes(result: object) -> str:
    return f"open('{{result}}', 'w').write({json.dumps(json.dumps(result))})"


def gtest(*tests: dict[str, object]) -> object:
    return {"testsuites": [{"name": "Chain", "testsuite": list(tests)}]}


PASSED = {"name": "hangs", "result": "COMPLETED"}
SKIPPED = {"name": "flies", "result": "SKIPPED"}
FAILED = {"name": "breaks", "result": "COMPLETED", "failures": [{"failure": "no"}]}


def test_passed_and_skipped_tests_are_summed(runner: ModuleType, capsys: pytest.CaptureFixture[str]) -> None:
    made = suite(runner, writes(gtest(PASSED, PASSED, SKIPPED)), runner.read_gtest)
    assert closing_line(runner, made, capsys) == (0, "2 passed, 0 failed, 1 skipped")


def test_a_skip_that_nobody_expects_fails_the_run(runner: ModuleType, capsys: pytest.CaptureFixture[str]) -> None:
    made = suite(runner, writes(gtest(PASSED, {"name": "swims", "result": "SKIPPED"})), runner.read_gtest)
    assert closing_line(runner, made, capsys) == (1, "1 passed, 1 failed")


def test_what_takes_long_runs_with_all_or_by_name(runner: ModuleType) -> None:
    usual, long = runner.Suite("usual", [], 1), runner.Suite("long", [], 1, only_with_all=True)
    runner.SUITES = [usual, long]
    assert runner.chosen([], False) == [usual]
    assert runner.chosen([], True) == [usual, long]
    assert runner.chosen(["long"], False) == [long]


def test_what_a_busy_machine_fails_runs_alone_with_all(runner: ModuleType) -> None:
    draws, other = runner.Suite("draws", [], 1, in_turn=True), runner.Suite("other", [], 1)
    runner.SUITES = [draws, other]
    assert [suite.cores for suite in runner.chosen([], False)] == [1, 1]
    assert [suite.cores for suite in runner.chosen([], True)] == [runner.CORES, 1]


def test_a_failed_test_fails_the_run(runner: ModuleType, capsys: pytest.CaptureFixture[str]) -> None:
    made = suite(runner, writes(gtest(PASSED, FAILED)) + "; raise SystemExit(1)", runner.read_gtest)
    assert closing_line(runner, made, capsys) == (1, "1 passed, 1 failed")
    runner.main([])
    assert capsys.readouterr().out.splitlines()[-3] == "  failed: made-up: Chain.breaks", "the end of a log names it"


def test_a_suite_without_a_test_fails_the_run(runner: ModuleType, capsys: pytest.CaptureFixture[str]) -> None:
    made = suite(runner, writes(gtest()), runner.read_gtest)
    assert closing_line(runner, made, capsys) == (1, "0 passed, 1 failed")


def test_a_suite_that_only_skips_fails_the_run(runner: ModuleType, capsys: pytest.CaptureFixture[str]) -> None:
    made = suite(runner, writes(gtest(SKIPPED)), runner.read_gtest)
    assert closing_line(runner, made, capsys) == (1, "0 passed, 1 failed, 1 skipped")


def test_a_crash_after_good_results_fails_the_run(runner: ModuleType, capsys: pytest.CaptureFixture[str]) -> None:
    made = suite(runner, writes(gtest(PASSED)) + "; import os; os.abort()", runner.read_gtest)
    assert closing_line(runner, made, capsys) == (1, "1 passed, 1 failed")


def test_a_suite_that_hangs_is_ended(runner: ModuleType, capsys: pytest.CaptureFixture[str]) -> None:
    made = suite(runner, "import time; time.sleep(100)", None, limit_s=1)
    assert closing_line(runner, made, capsys) == (1, "0 passed, 1 failed")


def test_the_processes_of_a_suite_keep_what_they_have_compiled(
    runner: ModuleType, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("PYTHONDONTWRITEBYTECODE", "1")
    made = suite(runner, "import sys; sys.exit(sys.dont_write_bytecode)")
    assert closing_line(runner, made, capsys) == (0, "1 passed, 0 failed")


def test_a_program_that_is_not_there_fails_the_run(runner: ModuleType, capsys: pytest.CaptureFixture[str]) -> None:
    made = runner.Suite("made-up", ["/nonexistent/tests"], 10, runner.read_gtest, ROOT)
    assert closing_line(runner, made, capsys) == (1, "0 passed, 1 failed")


def test_unreadable_results_fail_the_run(runner: ModuleType, capsys: pytest.CaptureFixture[str]) -> None:
    made = suite(runner, "open('{result}', 'w').write('{')", runner.read_gtest)
    assert closing_line(runner, made, capsys) == (1, "0 passed, 1 failed")


def test_a_page_test_file_that_cannot_be_loaded_counts_as_a_failure(runner: ModuleType, tmp_path: Path) -> None:
    result = tmp_path / "vitest.json"
    good = {"name": "a.test.ts", "status": "passed", "assertionResults": [{"status": "passed", "fullName": "draws"}]}
    bad = {"name": "b.test.ts", "status": "failed", "message": "no such module", "assertionResults": []}
    result.write_text(json.dumps({"testResults": [good, bad]}))
    count = runner.read_vitest(result)
    assert (count.passed, count.failed) == (1, 1)


def test_python_results_count_errors_as_failures(runner: ModuleType, tmp_path: Path) -> None:
    result = tmp_path / "junit.xml"
    result.write_text(
        "<testsuites><testsuite><testcase classname='t' name='a'/><testcase classname='t' name='b'><error/></testcase>"
        "<testcase classname='t' name='c'><skipped/></testcase></testsuite></testsuites>"
    )
    count = runner.read_junit(result)
    assert (count.passed, count.failed, count.skipped) == (1, 1, 1)


def vitest(**states: str) -> dict[str, object]:
    """Results of one test for each file."""
    return {
        "testResults": [
            {"name": f"{name}.test.ts", "status": state, "assertionResults": [{"status": state, "fullName": "draws"}]}
            for name, state in states.items()
        ]
    }


def repeating(runner: ModuleType, first: object, again: object) -> Any:
    """A suite with these results, the second ones if files are named in its arguments."""
    script = f"import sys\nif len(sys.argv) > 1: {writes(again)}\nelse: {writes(first)}"
    command = [sys.executable, "-c", script]
    return runner.Suite("made-up", command, 60, runner.read_vitest, ROOT, repeats=2, again=runner.files_again)


def test_a_file_that_fails_once_is_repeated_and_named(runner: ModuleType, capsys: pytest.CaptureFixture[str]) -> None:
    made = repeating(runner, vitest(a="passed", b="failed"), vitest(b="passed"))
    runner.SUITES = [made]
    assert runner.main([]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert "  failed once, passed when repeated: made-up: b.test.ts: draws" in lines
    assert lines[-1] == "2 passed, 1 only when repeated, 0 failed"


def test_a_test_that_relies_on_no_other_is_repeated_alone(
    runner: ModuleType, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    made = repeating(runner, vitest(a="passed", b="failed"), vitest(a="skipped", b="passed"))
    given = tmp_path / "given"
    script = f"{made.command[2]}\nopen({str(given)!r}, 'w').write(' '.join(sys.argv[1:]))"
    made = replace(made, again=runner.titles_again, command=[sys.executable, "-c", script])
    assert closing_line(runner, made, capsys) == (0, "2 passed, 1 only when repeated, 0 failed")
    assert given.read_text() == "b.test.ts --testNamePattern=^(draws)$"


def test_a_failed_test_of_python_is_repeated_by_its_name(runner: ModuleType) -> None:
    failures = ["tests.python.test_a.test_swims[test_b.c: 1/2]", "tests.packaging.test_c.test_flies"]
    assert runner.nodes_again(["python", "-m", "pytest", "tests/python", "-q"], failures) == [
        "python", "-m", "pytest",
        "tests/python/test_a.py::test_swims[test_b.c: 1/2]", "tests/packaging/test_c.py::test_flies", "-q",
    ]  # fmt: skip
    assert runner.nodes_again(["pytest", "tests"], [*failures, "did not end within 3 s"]) == []


def test_failed_tests_are_repeated_when_nothing_else_runs(runner: ModuleType, tmp_path: Path) -> None:
    failing = repeating(runner, vitest(b="failed"), vitest(b="passed"))
    began = (
        f"{failing.command[2]}\nimport time; open({str(tmp_path / 'repeated')!r}, 'w').write(f'{{time.monotonic()}}')"
    )
    failing = replace(failing, command=[sys.executable, "-c", began])
    runner.SUITES = [failing, *(sleeper(runner, name, tmp_path) for name in ("a", "b", "c"))]
    assert runner.main([]) == 0
    (repeated,) = spans(tmp_path, "repeated")[0]
    assert all(ended <= repeated for _, ended in spans(tmp_path, "a", "b", "c"))


def test_a_file_that_fails_twice_fails_the_run(runner: ModuleType, capsys: pytest.CaptureFixture[str]) -> None:
    made = repeating(runner, vitest(a="passed", b="failed", c="failed"), vitest(b="failed", c="passed"))
    assert closing_line(runner, made, capsys) == (1, "2 passed, 1 only when repeated, 1 failed")


def test_many_failed_files_are_not_repeated(runner: ModuleType, capsys: pytest.CaptureFixture[str]) -> None:
    made = repeating(runner, vitest(a="failed", b="failed", c="failed"), vitest(a="passed", b="passed", c="passed"))
    assert closing_line(runner, made, capsys) == (1, "0 passed, 3 failed")


def test_a_repetition_that_runs_nothing_changes_nothing(runner: ModuleType, capsys: pytest.CaptureFixture[str]) -> None:
    made = repeating(runner, vitest(a="passed", b="failed"), vitest())
    assert closing_line(runner, made, capsys) == (1, "1 passed, 1 failed")


def test_an_unknown_suite_is_named(runner: ModuleType, capsys: pytest.CaptureFixture[str]) -> None:
    assert runner.main(["no-such-suite"]) == 2
    assert "no-such-suite" in capsys.readouterr().err


def sleeper(runner: ModuleType, name: str, folder: Path, **more: object) -> object:
    """A suite of half a second, which keeps its begin and end."""
    times = f"import time; began = time.monotonic(); time.sleep(0.5); ended = time.monotonic(); {writes(gtest(PASSED))}"
    script = f"{times}; open({str(folder / name)!r}, 'w').write(f'{{began}} {{ended}}')"
    return runner.Suite(name, [sys.executable, "-c", script], 60, runner.read_gtest, ROOT, **more)


def spans(folder: Path, *names: str) -> list[list[float]]:
    return [[float(word) for word in (folder / name).read_text().split()] for name in names]


def test_two_suites_run_beside_each_other_on_two_cores(runner: ModuleType, tmp_path: Path) -> None:
    runner.SUITES = [sleeper(runner, name, tmp_path) for name in ("a", "b")]
    assert runner.main([]) == 0
    (a_began, a_ended), (b_began, b_ended) = spans(tmp_path, "a", "b")
    assert a_began < b_ended and b_began < a_ended


def test_suites_in_turn_and_those_that_need_all_cores_run_one_after_another(runner: ModuleType, tmp_path: Path) -> None:
    for more in ({"in_turn": True}, {"cores": 2}):
        runner.SUITES = [sleeper(runner, name, tmp_path, **more) for name in ("a", "b")]
        assert runner.main([]) == 0
        (a_began, a_ended), (b_began, b_ended) = spans(tmp_path, "a", "b")
        assert a_ended <= b_began or b_ended <= a_began, more


def test_the_longest_suite_begins_first(runner: ModuleType, tmp_path: Path) -> None:
    seconds = {"short": 1, "long": 9, "middle": 5}
    runner.SUITES = [sleeper(runner, name, tmp_path, cores=2, about_s=about) for name, about in seconds.items()]
    assert runner.main([]) == 0
    began = {name: spans(tmp_path, name)[0][0] for name in seconds}
    assert sorted(began, key=began.__getitem__) == ["long", "middle", "short"]


def test_a_suite_in_shards_runs_each_test_once(runner: ModuleType, capsys: pytest.CaptureFixture[str]) -> None:
    tests = [{"name": f"hangs_{number}", "result": "COMPLETED", "time": f"{number}s"} for number in range(5)]
    result = json.dumps({"testsuites": [{"name": "Chain", "testsuite": tests}]})
    script = (
        f"import json, os; result = json.loads({result!r}); (suite,) = result['testsuites']; "
        "total, index = int(os.environ['GTEST_TOTAL_SHARDS']), int(os.environ['GTEST_SHARD_INDEX']); "
        "suite['testsuite'] = suite['testsuite'][index::total]; json.dump(result, open('{result}', 'w'))"
    )
    runner.SUITES = [runner.Suite("cpp", [sys.executable, "-c", script], 60, runner.read_gtest, ROOT, shards=2)]
    assert runner.main(["cpp"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert {line.split()[0]: line.split()[1] for line in lines if line.startswith("cpp-")} == {
        "cpp-1": "3",
        "cpp-2": "2",
    }
    assert lines[-1] == "5 passed, 0 failed"


def test_the_slowest_tests_and_the_time_of_all_are_told(runner: ModuleType, capsys: pytest.CaptureFixture[str]) -> None:
    tests = [{"name": f"hangs_{number}", "result": "COMPLETED", "time": f"{number}.5s"} for number in range(12)]
    assert closing_line(runner, suite(runner, writes(gtest(*tests)), runner.read_gtest), capsys)[0] == 0
    runner.main([])
    lines = capsys.readouterr().out.splitlines()
    told = lines[lines.index("slowest:") + 1 : -2]
    assert [line.split() for line in told] == [[f"{n}.5", "s", f"Chain.hangs_{n}"] for n in range(11, 1, -1)]
    assert lines[-2].startswith("all together: ")


def stamped(runner: ModuleType, tmp_path: Path, script: str) -> Path:
    """A suite that depends on a file only, beside one that runs always. Returns that file."""
    needs = tmp_path / "input"
    needs.write_text("one")
    always = suite(runner, writes(gtest(PASSED)), runner.read_gtest)
    command = [sys.executable, "-c", script]
    runner.SUITES = [always, runner.Suite("seldom", command, 60, runner.read_gtest, ROOT, inputs=lambda: [needs])]
    return needs


def test_a_suite_runs_when_its_inputs_have_changed(
    runner: ModuleType, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    needs = stamped(runner, tmp_path, writes(gtest(PASSED, PASSED)))

    def ran(*arguments: str) -> str:
        assert runner.main(list(arguments)) == 0
        return capsys.readouterr().out

    assert ran().endswith("\n3 passed, 0 failed\n"), "there is no stamp yet"
    again = ran()
    assert again.endswith("\n1 passed, 0 failed\n")
    assert "seldom       passed before, and nothing it depends on has changed\n" in again
    assert ran("seldom").endswith("\n2 passed, 0 failed\n"), "a named suite runs"
    assert ran("--all").endswith("\n3 passed, 0 failed\n")
    assert ran().endswith("\n1 passed, 0 failed\n")
    needs.write_text("two")
    assert ran().endswith("\n3 passed, 0 failed\n")


def test_a_failed_suite_runs_again(runner: ModuleType, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    stamped(runner, tmp_path, writes(gtest(PASSED, FAILED)))
    for _ in range(2):
        assert runner.main([]) == 1
        assert capsys.readouterr().out.endswith("\n2 passed, 1 failed\n")


def test_only_the_run_of_all_asks_for_all_samples(runner: ModuleType) -> None:
    runner.SUITES = [suite(runner, "import os; assert os.environ['IOTA_TEST_ALL'] == '1'")]
    assert runner.main([]) == 1
    assert runner.main(["--all"]) == 0


def test_an_interrupted_run_ends_its_suites(runner: ModuleType, tmp_path: Path) -> None:
    script = f"import os, time; open({str(tmp_path / 'leader')!r}, 'w').write(str(os.getpid())); time.sleep(100)"
    runner.SUITES = [suite(runner, script)]
    leader = tmp_path / "leader"

    def interrupt() -> None:
        while not (leader.exists() and leader.read_text()):
            time.sleep(0.02)
        os.kill(os.getpid(), signal.SIGINT)

    threading.Thread(target=interrupt).start()
    with pytest.raises(KeyboardInterrupt):
        runner.main([])
    with pytest.raises(ProcessLookupError):
        os.kill(int(leader.read_text()), 0)
