# SPDX-License-Identifier: Apache-2.0
"""The test runner counts what the suites' own runners say, and is not fooled by a suite that says nothing."""

import json
import sys
from collections.abc import Callable
from pathlib import Path
from types import ModuleType

import pytest

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture
def runner(load_tool: Callable[[str], ModuleType], tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    module = load_tool("run_tests")
    monkeypatch.setattr(module, "ROOT", tmp_path)
    monkeypatch.setattr(module, "RESULTS", tmp_path / "results")
    monkeypatch.setattr(module, "LOGS", tmp_path / "logs")
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


def test_a_failed_test_fails_the_run(runner: ModuleType, capsys: pytest.CaptureFixture[str]) -> None:
    made = suite(runner, writes(gtest(PASSED, FAILED)) + "; raise SystemExit(1)", runner.read_gtest)
    assert closing_line(runner, made, capsys) == (1, "1 passed, 1 failed")


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


def repeating(runner: ModuleType, first: object, again: object) -> object:
    """A suite with these results, the second ones if files are named in its arguments."""
    script = f"import sys\nif len(sys.argv) > 1: {writes(again)}\nelse: {writes(first)}"
    return runner.Suite("made-up", [sys.executable, "-c", script], 60, runner.read_vitest, ROOT, repeats=2)


def test_a_file_that_fails_once_is_repeated_and_named(runner: ModuleType, capsys: pytest.CaptureFixture[str]) -> None:
    made = repeating(runner, vitest(a="passed", b="failed"), vitest(b="passed"))
    runner.SUITES = [made]
    assert runner.main([]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[-2] == "  failed once, passed when repeated: made-up: b.test.ts: draws"
    assert lines[-1] == "2 passed, 1 only when repeated, 0 failed"


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
