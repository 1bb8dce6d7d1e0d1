# SPDX-License-Identifier: Apache-2.0
"""The command line as a user meets it: its own process, exit codes, what is on which stream."""

from __future__ import annotations

import json
import os
import re
import signal
import socket
import subprocess
import sys
import textwrap
from argparse import ArgumentTypeError
from collections.abc import Callable
from pathlib import Path

import pytest
from page_client import PageClient

import iota
from iota import studies
from iota.cli import main
from iota.cli.main import positive

KEYS = [
    "steps",
    "dt_s",
    "simulated_s",
    "cpu_s",
    "worst_gap_m",
    "energy_start_j",
    "energy_end_j",
    "energy_max_j",
    "iterations_mean",
    "iterations_max",
    "fallbacks",
    "articulates",
    "structure_version",
]


def run(*arguments: str | Path, seconds: float = 120) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "iota", *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, timeout=seconds, stdin=subprocess.DEVNULL)


def fails_with_one_line(*arguments: str | Path, code: int = 1) -> str:
    done = run(*arguments)
    assert done.returncode == code, done.stderr
    assert done.stdout == "" and done.stderr.count("\n") == 1, done.stderr
    return done.stderr.strip()


@pytest.fixture
def refused(capsys: pytest.CaptureFixture[str]) -> Callable[..., str]:
    """As fails_with_one_line, in this process, which has iota already: a tenth of the time."""

    def call(*arguments: str | Path, code: int = 1) -> str:
        try:
            ended = main([str(word) for word in arguments])
        except SystemExit as error:  # as argparse ends
            ended = int(error.code or 0)
        said = capsys.readouterr()
        assert ended == code and said.out == "" and said.err.count("\n") == 1, said
        return said.err.strip()

    return call


@pytest.fixture
def script(tmp_path: Path) -> Path:
    path = tmp_path / "mine.py"
    path.write_text(
        textwrap.dedent("""
        import iota
        def build(links=3):
            system = iota.System()
            iota.builder.chain(links=links).realize(system)
            return iota.World(system, title="mine")
        if __name__ == "__main__":
            build().run()
        """)
    )
    return path


def test_list_names_the_studies() -> None:
    done = run("list")
    assert done.returncode == 0 and done.stderr == ""
    assert re.search(r"^chain +A chain on a nail", done.stdout, re.MULTILINE)


def test_version() -> None:
    assert run("--version").stdout == f"iota {iota.__version__}\n"


def test_headless_json_has_the_figures_and_is_the_same_each_time() -> None:
    figures = []
    for _ in range(2):
        done = run("run", "chain", "--headless", "--seconds", "10", "--json")
        assert done.returncode == 0 and done.stderr == ""
        figures.append(json.loads(done.stdout))
    first, second = figures
    assert list(first) == KEYS
    assert first["steps"] == 1200 and first["simulated_s"] == pytest.approx(10)
    # From 4 s on the story's spring jerks the part that fell. A solve may end with a residual of 1e-8 that no step reduces.
    assert first["worst_gap_m"] <= 1e-8 and first["cpu_s"] > 0
    first.pop("cpu_s"), second.pop("cpu_s")
    assert first == second


def test_headless_runs_ten_seconds_by_itself_and_takes_links() -> None:
    done = run("run", "chain", "--headless", "--links", "200", "--seconds", "1", "--json")
    assert json.loads(done.stdout)["steps"] == 120
    assert run("run", "chain", "--headless", "--json").stdout.startswith('{"steps": 1200')


LONG = "n" * 300  # no file system takes such a name


@pytest.mark.parametrize(
    ("arguments", "text", "code"),
    [
        (["run", "chian"], "iota: there is no study 'chian'. Did you mean chain?", 1),
        (
            ["run", "zzz"],
            f"iota: there is no study 'zzz'. There is: {', '.join(studies.names())}; or a file that ends in .py",
            1,
        ),
        (["run", "missing.py"], "iota: there is no file missing.py", 1),
        (["run", LONG], f"iota: there is no study '{LONG}'", 1),
        (["run", f"{LONG}.py"], f"iota: there is no file {LONG}.py", 1),
        (["run", f"{LONG}.py", "--watch"], f"--watch needs a file, and there is no {LONG}.py", 1),
        (["import", LONG], "there is no polyhedron named", 1),
        (["record", "chain", "-o", f"{LONG}.mp4"], f"{LONG}.mp4 cannot be written: File name too long", 1),
        (["run", "chain", "--links", "0"], "argument --links: must be 1 or more, not 0. Try: iota run --help", 2),
        (["run", "chain", "--links", "1000000000"], "--links: must be at most 1000000, not 1000000000", 2),
        (["run", "chain", "--seconds", "-1"], "argument --seconds: must be above 0 and finite, not -1", 2),
        (["run", "chain", "--seconds", "nan"], "must be above 0 and finite, not nan", 2),
        (["run", "chain", "--port", "70000"], "argument --port: must be from 0 to 65535, not 70000", 2),
        (["run", "chain", "--port", "x"], "argument --port: invalid port value: 'x'", 2),
        (
            ["run", "chain", "--cert", "no.pem", "--key", "no.key"],
            "iota: the certificate or key no.pem cannot be read: No such file or directory. Try: --lan alone",
            1,
        ),
        (["run"], "the following arguments are required: NAME|FILE.py", 2),
        (["fly"], "there is no command 'fly'; there are list, run, ", 2),
        (["recrod"], "there is no command 'recrod'; did you mean 'record'? Try: iota --help", 2),
        (
            ["export"],
            "there is no command 'export'; a page of its own is made by: iota record NAME|FILE.py -o FILE.html",
            2,
        ),
        ([], "the following arguments are required: COMMAND", 2),
    ],
)
def test_wrong_arguments_are_one_clear_line(
    refused: Callable[..., str], arguments: list[str], text: str, code: int
) -> None:
    assert text in refused(*arguments, code=code)


def test_a_time_without_end_is_refused() -> None:
    with pytest.raises(ArgumentTypeError, match="finite, not inf"):
        positive("inf")


def test_a_process_with_wrong_arguments_ends_with_their_code() -> None:
    assert "there is no study 'chian'" in fails_with_one_line("run", "chian")
    assert "there is no command 'fly'" in fails_with_one_line("fly", code=2)


def test_a_script_runs_as_main_and_with_links(script: Path) -> None:
    done = run("run", script, "--headless", "--seconds", "0.5", "--json")
    assert json.loads(done.stdout)["steps"] == 60
    done = run("run", script, "--links", "7", "--headless", "--seconds", "0.5", "--json")
    assert done.returncode == 0 and json.loads(done.stdout)["steps"] == 60


def test_a_script_with_only_a_build_runs_too(tmp_path: Path, script: Path) -> None:
    only = tmp_path / "only.py"
    only.write_text(script.read_text().split("if __name__")[0])
    assert json.loads(run("run", only, "--headless", "--seconds", "0.5", "--json").stdout)["steps"] == 60


def test_a_script_with_its_own_loop_stops_by_itself(tmp_path: Path) -> None:
    own = tmp_path / "own.py"
    own.write_text("import iota\nworld = iota.World(iota.System())\nwhile True:\n    world.step()\n")
    done = run("run", own, "--headless", "--seconds", "0.5", "--json")
    assert done.returncode == 0 and json.loads(done.stdout)["steps"] == 60


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("import iota\nsystem = iota.System()\n1 / 0\n", r"iota: ZeroDivisionError: division by zero \(bad.py, line 3\)"),
        ("import iota\niota.System().body().particle(mass=-1)\n", r"mass must be.*above 0 kg, not -1 \(bad.py, line 2\)"),
        ("import nothing_like_this\n", r"ModuleNotFoundError.*\(bad.py, line 1\)"),
        ("def build():\n    return 5\n", r"build\(\) of .*bad.py must return a World, not int"),
        ("import iota\n", "made no World run"),
    ],
)  # fmt: skip
def test_a_script_that_fails_ends_with_one_clear_line(tmp_path: Path, text: str, said: str) -> None:
    path = tmp_path / "bad.py"
    path.write_text(text)
    done = run("run", path, "--headless", "--seconds", "0.1")
    assert done.returncode == 1 and done.stdout == ""
    assert re.search(said, done.stderr.splitlines()[-1]), done.stderr
    assert "runpy" not in done.stderr and "cli/run.py" not in done.stderr, "frames of others are left out"


def test_a_script_that_cannot_be_read_is_one_line(refused: Callable[..., str], tmp_path: Path) -> None:
    path = tmp_path / "bad.py"
    path.write_text("def (:\n")
    assert re.search(r"bad\.py, line 1: invalid syntax", refused("run", path))
    path.write_bytes(b"\x00\xff\xfe")
    assert "bad.py" in refused("run", path)
    path.write_text("import iota\n")
    assert "--links has no effect" in refused("run", path, "--links", "3")


def test_a_taken_port_is_one_line(script: Path) -> None:
    with socket.socket() as other:
        other.bind(("127.0.0.1", 0))
        other.listen()
        port = other.getsockname()[1]
        line = fails_with_one_line("run", "chain", "--no-open", "--port", str(port))
    assert str(port) in line and "Try: --port" in line


def test_a_missing_page_is_one_line(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.setattr(Path, "is_file", lambda path: False)
    assert main(["run", "chain", "--no-open", "--port", "0"]) == 1
    said = capsys.readouterr()
    assert said.out == "" and said.err.count("\n") == 1
    assert "the page is not built" in said.err and "Try: make build" in said.err


def test_run_serves_prints_the_address_and_keys_and_stops_by_itself() -> None:
    done = run("run", "chain", "--no-open", "--port", "0", "--seconds", "1", "--json")
    assert done.returncode == 0 and all("slow motion" in line for line in done.stderr.splitlines())
    lines = done.stdout.splitlines()
    assert re.fullmatch(
        r"chain: 1\.8 m to be pulled, broken and joined: http://127\.0\.0\.1:\d+/\?token=[0-9a-f]{32}", lines[0]
    )
    assert [line.split()[0] for line in lines[1:4]] == ["b", "c", "t"]
    assert 1 <= json.loads(lines[4])["steps"] <= 125 and len(lines) == 5


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="a device that is always full")
def test_a_script_error_does_not_end_the_world_where_the_terminal_cannot_be_written(tmp_path: Path) -> None:
    path = tmp_path / "fails.py"
    path.write_text(
        textwrap.dedent("""
        import time
        import iota
        system = iota.System()
        system.body().particle((0, 1, 0))
        world = iota.World(system)
        @world.every(0.05)
        def fail(): raise RuntimeError("no")
        @world.at(0.1)
        def slow(): time.sleep(0.7)
        summary = world.run()
        assert summary.steps > 20
        """)
    )
    for redirect in ("2>/dev/full", "2>&-"):
        command = f"{sys.executable} -m iota run {path} --port 0 --seconds 2 --no-open {redirect}"
        done = subprocess.run(["sh", "-c", command], capture_output=True, text=True, timeout=60)
        assert done.returncode == 0, redirect


def test_watch_runs_a_script_anew_when_it_is_saved_and_pages_find_it(tmp_path: Path) -> None:
    path = tmp_path / "mine.py"
    text = textwrap.dedent("""
        import iota, other
        system = iota.System()
        system.body().particle((0, 1, 0))
        iota.World(system, title=other.TITLE).run()
        """)
    path.write_text(text)
    (tmp_path / "other.py").write_text("TITLE = 'first'")
    words = [sys.executable, "-m", "iota", "run", str(path), "--watch", "--port", "0", "--no-open"]
    with subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None and process.stderr is not None
        try:

            def url_of(title: str) -> str:
                said = process.stdout.readline() if process.stdout else ""
                assert said.startswith(f"{title}: http"), said
                return said.split(": ", 1)[1].strip()

            first = url_of("first")
            with PageClient(first) as page:
                path.write_text(text + "this is no Python")
                assert "mine.py, line" in process.stderr.readline()
                step = page.last["poses"]["step"]
                page.wait_for(lambda: page.last["poses"]["step"] > step + 5)
                path.write_text(text)
                assert "was saved" in process.stderr.readline()
                assert page.closed.wait(20)
            assert url_of("first") == first
            (tmp_path / "other.py").write_text("TITLE = 1 / 0")
            for _ in range(20):
                if "waiting" in process.stderr.readline():
                    break
            (tmp_path / "other.py").write_text("TITLE = 'second'")
            assert url_of("second") == first, "the address stays"
        finally:
            process.send_signal(signal.SIGINT)
            process.wait(20)


def test_a_saved_script_goes_on_where_it_was_if_it_starts_its_world_the_same_way(tmp_path: Path) -> None:
    path = tmp_path / "mine.py"
    text = textwrap.dedent("""
        import iota
        system = iota.System(gravity=(0, 0, 0))
        ball = system.body().particle((0, 1, 0), velocity=(1, 0, 0))
        world = iota.World(system, title="TITLE")
        @world.at(0.1)
        def once(): print("once", flush=True)
        @world.on_step
        def say():
            if system.step_count % 12 == 0: print("at", ball.position.x, flush=True)
        CUT
        world.run()
        """)
    path.write_text(text.replace("CUT", ""))
    words = [sys.executable, "-m", "iota", "run", str(path), "--watch", "--port", "0", "--no-open"]
    with subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True) as process:
        assert process.stdout is not None
        lines = process.stdout
        try:

            def until(wanted: Callable[[str], bool]) -> list[str]:
                """The lines up to that one."""
                said: list[str] = []
                while not (said and wanted(said[-1])):
                    said.append(lines.readline())
                    assert said[-1], said
                return said

            def place(line: str) -> float:
                return float(line.split()[1])

            begun = until(lambda line: line.startswith("at") and place(line) > 0.5)
            assert "once\n" in begun
            for change, goes_on in (("TITLE", True), ("(0, 1, 0)", False)):
                now = text.replace("CUT", "").replace(change, {"TITLE": "other", "(0, 1, 0)": "(0, 2, 0)"}[change])
                path.write_text(now)
                until(lambda line: "token=" in line)
                after = until(lambda line: line.startswith("at"))
                assert (place(after[-1]) > 0.4) == goes_on, after
                assert not goes_on or "once\n" not in after, "an event before now has been"
                until(lambda line: line.startswith("at") and place(line) > 0.5)
        finally:
            process.send_signal(signal.SIGINT)
            process.wait(20)


def test_a_prompt_acts_on_the_running_world(tmp_path: Path) -> None:
    path = tmp_path / "mine.py"
    path.write_text(
        textwrap.dedent("""
        import iota
        system = iota.System(gravity=(0, 0, 0))
        ball = system.body().particle((0, 1, 0))
        world = iota.World(system, title="mine")
        world.run()
        """)
    )
    command = [sys.executable, "-m", "iota", "run", "--prompt", "--port", "0"]
    with subprocess.Popen([*command, path], stdin=-1, stdout=-1, stderr=-1, text=True) as process:
        assert process.stdin and process.stdout and process.stderr
        with PageClient(process.stdout.readline().removeprefix("mine: ").strip()) as page:
            process.stdin.write("1 / 0\nball.velocity = (2, 0, 0)\nball.destroy\n")
            process.stdin.flush()
            page.wait_for(lambda: page.places[0][0] > 0.1)
            process.stdin.close()
            assert page.closed.wait(20)
        assert process.wait(20) == 0
        said = process.stderr.read()
        assert "ZeroDivisionError" in said and "WrongThreadError" not in said
    done = subprocess.run(
        [*command, "chain"], input="build.__name__\nexit()\n", capture_output=True, text=True, timeout=60
    )
    assert done.returncode == 0 and "'build'" in done.stdout
    done = subprocess.run([*command, "chain", "--watch"], capture_output=True, text=True, timeout=60)
    assert done.returncode == 2 and "--prompt" in done.stderr


def test_a_statement_without_end_is_ended_by_its_time_or_by_ctrl_c_and_the_world_goes_on(tmp_path: Path) -> None:
    path = tmp_path / "mine.py"
    path.write_text(
        "import iota\nsystem = iota.System(gravity=(0, 0, 0))\nball = system.body().particle((0, 1, 0))\n"
        "iota.World(system, title='mine').run()\n"
    )
    start = "import sys; from iota.cli import main, prompt; prompt.LONGEST = 2; sys.exit(main(sys.argv[1:]))"
    command = [sys.executable, "-c", start, "run", "--prompt", "--port", "0", str(path)]
    with subprocess.Popen(command, stdin=-1, stdout=-1, stderr=-1, text=True) as process:
        assert process.stdin and process.stdout and process.stderr
        with PageClient(process.stdout.readline().removeprefix("mine: ").strip()) as page:

            def say(text: str) -> None:
                assert process.stdin
                process.stdin.write(text)
                process.stdin.flush()

            def goes_on() -> None:
                step = page.last["poses"]["step"]
                page.wait_for(lambda: page.last["poses"]["step"] > step + 20)

            for statement in ("while True: pass\n\n", "import time; time.sleep(1000)\n"):
                told = len(page.notices)
                say(statement)
                page.wait_for(lambda told=told: len(page.notices) > told)  # it holds the world
                assert "is slow" in page.notices[-1]["title"]
                goes_on()
            say("prompt_limit = __import__('iota.cli.prompt').cli.prompt; prompt_limit.LONGEST = 100\n")
            told = len(page.notices)
            say("while True: pass\n\n")
            page.wait_for(lambda: len(page.notices) > told)
            process.send_signal(signal.SIGINT)
            goes_on()
            process.send_signal(signal.SIGINT)  # between two statements
            say("ball.velocity = (2, 0, 0)\n")
            page.wait_for(lambda: page.places[0][0] > 0.1)
            process.stdin.close()
            assert page.closed.wait(20)
        assert process.wait(20) == 0
        said = process.stderr.read()
        assert said.count("StatementEnded: it was ended after 2 s") == 2
        assert said.count("\nKeyboardInterrupt") == 1 and "Ctrl-D ends the world" in said


def test_the_token_can_be_renewed() -> None:
    first = run("token").stdout
    assert re.fullmatch("[0-9a-f]{32}\n", first) and run("token").stdout == first
    renewed = run("token", "--renew")
    assert renewed.stdout not in ("", first) and run("token").stdout == renewed.stdout
    assert "running keep the old token until they are started again" in renewed.stderr


def test_an_interrupt_while_starting_is_one_line() -> None:
    script = "import os, signal, sys, time; sys.argv = ['iota']; import iota; os.kill(os.getpid(), signal.SIGINT); time.sleep(9)"
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, timeout=60)
    assert (done.returncode, done.stdout, done.stderr) == (130, "", "iota: interrupted\n")


@pytest.mark.parametrize(
    "loop", ["world.serve(port=0)\nfor _ in range(3):\n    world.step()\n", "world.start(port=0)\n"]
)
def test_a_script_that_ends_without_close_leaves_nothing_on_the_terminal(tmp_path: Path, loop: str) -> None:
    path = tmp_path / "loop.py"
    path.write_text(f"import iota\nworld = iota.World(iota.System())\n{loop}")
    done = subprocess.run([sys.executable, path], capture_output=True, text=True, timeout=60)
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")


@pytest.mark.parametrize("asked", ["", "2"])
def test_numpy_has_one_thread_in_a_command_unless_its_user_asks_for_more(asked: str) -> None:
    script = "import os, sys; sys.argv = ['iota']; import iota, numpy; print(os.environ['OPENBLAS_NUM_THREADS'])"
    script += "; print(len(os.listdir('/proc/self/task')) if os.path.isdir('/proc/self/task') else 1)"
    others = {name: value for name, value in os.environ.items() if name != "OPENBLAS_NUM_THREADS"}
    environment = {**others, **({"OPENBLAS_NUM_THREADS": asked} if asked else {})}
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, timeout=60, env=environment)
    number, threads = done.stdout.split()
    assert number == (asked or "1") and (asked or threads == "1"), done.stderr


@pytest.mark.skipif(sys.platform == "win32", reason="has no such signal")
def test_a_world_that_nohup_started_outlives_its_terminal() -> None:
    script = "import os, signal; signal.signal(signal.SIGHUP, signal.SIG_IGN); os.execvp('{0}', ['{0}', '-c', {1!r}])"
    hang_up = "import os, signal, sys; from iota.cli.main import main; import iota; "
    hang_up += "iota.World.run = lambda self, *_, **__: os.kill(os.getpid(), signal.SIGHUP); "
    hang_up += "main(['run', 'chain', '--headless'])"
    for begin, code in ((hang_up, 130), (script.format(sys.executable, hang_up), 1)):
        done = subprocess.run([sys.executable, "-c", begin], capture_output=True, text=True, timeout=60)
        assert ("interrupted" in done.stderr) == (code == 130), done.stderr


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="a device that is always full")
@pytest.mark.parametrize("out", ["1>&-", ">/dev/full"])
def test_a_world_runs_without_anything_to_print_on(tmp_path: Path, out: str) -> None:
    path = tmp_path / "mine.py"
    path.write_text(
        "import iota\nworld = iota.World(iota.System())\nworld.run()\nprint('%.1f' % world.system.time, file=open('time', 'w'))\n"
    )
    command = f"{sys.executable} -m iota run mine.py --no-open --port 0 --seconds 1 {out}"
    done = subprocess.run(command, shell=True, stderr=subprocess.PIPE, text=True, timeout=60, cwd=tmp_path)
    assert "Traceback" not in done.stderr and (tmp_path / "time").read_text() != "0.0\n"


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_it_ends_cleanly_on_request(number: signal.Signals) -> None:
    command = [sys.executable, "-m", "iota", "run", "chain", "--no-open", "--port", "0"]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=os.environ)
    assert process.stdout is not None and process.stderr is not None
    with PageClient(process.stdout.readline().rpartition(" ")[2].strip()) as page:
        step = page.last["poses"]["step"]
        page.wait_for(lambda: page.last["poses"]["step"] > step)
    process.send_signal(number)
    try:
        assert process.wait(60) == 0
    finally:  # `nohup` lets it ignore a hang-up, and it would run for ever
        process.kill()
    assert [line for line in process.stderr if "slow motion" not in line] == []  # a busy machine may be too slow
    process.stdout.close(), process.stderr.close()


def test_bench_prints_json_rows() -> None:
    done = run("bench", "chain", "--links", "8", "64", "--json")
    assert done.returncode == 0, done.stderr
    cases = json.loads(done.stdout)["cases"]
    assert len(cases) == 2 * 2 * 2 * 2
    assert {(case["links"], case["kind"], case["mode"], round(1 / case["dt_s"])) for case in cases} == {
        (links, kind, mode, rate)
        for links in (8, 64)
        for kind in ("two_point", "rod")
        for mode in ("robust", "energy_keeping")
        for rate in (60, 120)
    }
    assert all(case["us_per_link_step"] > 0 and case["worst_gap_m"] < 1e-6 for case in cases)


def test_bench_forces_prints_a_row_for_every_way_of_writing_a_force(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["bench", "forces", "--json"]) == 0
    rows = json.loads(capsys.readouterr().out)["forces"]
    assert [row["force"] for row in rows][:3] == ["predefined", "expression", "compiled code"] and len(rows) == 9
    assert all(row["ns"] > 0 for row in rows)


def test_import_lists_the_contents_of_a_file_and_saves_it(tmp_path: Path) -> None:
    water = tmp_path / "water.xyz"
    water.write_text("3\nwater\nO 0 0 0\nH 0.96 0 0\nH -0.24 0.93 0\n")
    done = run("import", water, "--json", "--save", tmp_path / "out.json")
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout)["counts"]["formula"] == "H2O"
    saved = iota.builder.Structure.from_json(json.loads((tmp_path / "out.json").read_text()))
    assert len(saved.points) == 3
    assert "edges: 12" in run("import", "cube").stdout


def test_import_reports_an_error_in_one_line(
    refused: Callable[..., str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    broken = tmp_path / "broken.off"
    broken.write_text("OFF\n1 1 0\n0 0 0\n3 0 1 2\n")
    assert refused("import", broken) == (f"iota: {broken}, line 4: face 1 (of 1, line 4) uses vertex 1; there are 0..0")
    assert "no such file" in refused("import", tmp_path / "none.pdb")
    assert "did you mean 'cube'" in refused("import", "cubee")
    assert "the SMILES 'C(' cannot be read" in refused("import", "smiles:C(")
    assert "unexpected keyword argument 'kind'" in refused("import", tmp_path / "a.urdf", "--kind", "soft")
    assert main(["import", "cube", "--save", str(tmp_path / "nowhere" / "x.json")]) == 1
    assert "cannot be written" in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == [broken]


def test_names_in_a_file_do_not_steer_the_terminal(refused: Callable[..., str], tmp_path: Path) -> None:
    red, shown = "\x1b[31mred\x1b]0;title\x07\u202e", r"\x1b[31mred\x1b]0;title\x07\u202e"
    water = tmp_path / "water.xyz"
    water.write_text(f"3\n{red}\nO 0 0 0\nH 0.96 0 0\nH -0.24 0.93 0\n")
    assert run("import", water).stdout.splitlines()[0] == shown
    water.write_text(f"3\nwater\n{red} 0 0 0\nH 0.96 0 0\nH -0.24 0.93 0\n")
    assert "\x1b" not in refused("import", water)
    assert "\x1b" not in refused("run", red)


def test_profile_shows_the_times_of_the_parts_of_a_step(tmp_path: Path) -> None:
    path = tmp_path / "slow.py"
    path.write_text(
        textwrap.dedent("""
        import time
        import iota
        def build():
            system = iota.System()
            iota.builder.chain(links=4).realize(system)
            world = iota.World(system)
            world.on_step(lambda: time.sleep(0.004))
            return world
        """)
    )
    rows = {row["part"]: row for row in json.loads(run("profile", path, "--seconds", "1", "--json").stdout)}
    dawdling = rows["script: on_step (build.<locals>.<lambda>)"]
    assert 4.0 <= dawdling["ms"] < 20 and dawdling["share"] == max(row["share"] for row in rows.values())
    assert rows["simulator"]["ms"] > 0 and rows["pages"]["ms"] > 0
    assert sum(row["share"] for row in rows.values()) == pytest.approx(1, abs=0.01)
    table = run("profile", path, "--seconds", "0.1").stdout
    assert "ms a step" in table and "all of a step" in table


def test_profile_draws_a_pie(tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    pie = tmp_path / "pie.png"
    assert run("profile", "cradle", "--seconds", "0.2", "--plot", pie).returncode == 0
    assert pie.read_bytes().startswith(b"\x89PNG")
