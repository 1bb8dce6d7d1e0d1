# SPDX-License-Identifier: Apache-2.0
"""Sweeps: each run once, whatever dies, with the same numbers from any number of processes."""

from __future__ import annotations

import csv
import os
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import pytest
from waiting import wait_until

import iota
from iota.cli import plot
from iota.cli.failure import Failure
from iota.cli.main import main
from iota.cli.sweep import varied

GRID = {"stiffness": [10.0, 1000 / 3], "seed": [1, 2, 3]}


def swing(stiffness: float, seed: int) -> dict[str, Any]:
    system = iota.System(threads=1)
    anchor = system.body(kind="static").particle((0, 0, 0))
    ball = system.body().particle((0, -1, 0), velocity=(seed, 0, 0))
    system.bond(anchor, ball, "spring", stiffness=stiffness, length=1)
    system.step(1 / 240, 100)
    return {"y": ball.position.y, "hash": f"{system.state_hash():x}", "steps": system.step_count}


def sometimes(stiffness: float, seed: int) -> float:
    if seed == 2:
        raise ValueError("not this one")
    if seed == 3:
        os.kill(os.getpid(), signal.SIGKILL)
    return stiffness * seed


def cells(path: Path) -> list[list[str]]:
    with path.open(newline="") as file:
        return list(csv.reader(file))


def test_rows_are_those_of_the_function_in_the_order_of_the_grid_for_any_number_of_processes(tmp_path: Path) -> None:
    told: list[tuple[int, int, int]] = []
    rows = iota.sweep(swing, GRID, tmp_path / "two.csv", processes=2, progress=lambda *all: told.append(all))
    expected = [
        {"stiffness": stiffness, "seed": seed, **swing(stiffness, seed), "error": ""}
        for stiffness in GRID["stiffness"]
        for seed in GRID["seed"]
    ]
    assert rows == expected
    assert told[0] == (0, 6, 0) and told[-1] == (6, 6, 0) and len(told) == 7
    assert iota.sweep(swing, GRID, tmp_path / "none.csv", processes=0) == expected
    assert (tmp_path / "none.csv").read_bytes() == (tmp_path / "two.csv").read_bytes()
    assert cells(tmp_path / "two.csv")[0] == ["stiffness", "seed", "y", "hash", "steps", "error"]


def test_a_run_that_raises_or_dies_is_a_row_with_its_inputs_and_the_others_are_whole(tmp_path: Path) -> None:
    rows = iota.sweep(sometimes, {"stiffness": [1.5], "seed": [1, 2, 3, 4]}, tmp_path / "t.csv", processes=2)
    assert [(row["seed"], row["result"], row["error"]) for row in rows] == [
        (1, 1.5, ""),
        (2, None, "ValueError: not this one"),
        (3, None, "its process died 2 times, at last by SIGKILL"),
        (4, 6.0, ""),
    ]
    calls: list[int] = []

    def mended(stiffness: float, seed: int) -> float:
        calls.append(seed)
        return stiffness * seed

    rows = iota.sweep(mended, {"stiffness": [1.5], "seed": [1, 2, 3, 4]}, tmp_path / "t.csv", processes=0)
    assert calls == [2, 3], "what failed is tried again, and nothing else"
    assert [row["result"] for row in rows] == [1.5, 3.0, 4.5, 6.0] and not any(row["error"] for row in rows)


SCRIPT = """
import pathlib, time
def run(n, kind):
    while n > 15 and not pathlib.Path("goes_on").exists():
        time.sleep(0.01)
    with open("calls", "a") as calls:
        calls.write(f"{n}{kind}\\n")
    time.sleep(0.02)
    return {"square": n * n}
"""


def test_a_killed_sweep_goes_on_with_no_result_missing_or_doubled(tmp_path: Path) -> None:
    (tmp_path / "squares.py").write_text(SCRIPT)
    words = [sys.executable, "-m", "iota", "sweep", "squares.py", "--vary", "n=1..20", "--vary", "kind=a,b"]
    begun = subprocess.Popen([*words, "--processes", "2"], cwd=tmp_path)
    table = tmp_path / "squares.csv"
    wait_until(lambda: table.exists() and len(cells(table)) > 6)
    begun.kill()
    begun.wait()
    (tmp_path / "goes_on").touch()
    time.sleep(0.1)  # its processes notice it
    done = len(cells(table)) - 1
    assert 5 < done < 40
    with table.open("a") as file:
        file.write("20,b,4")  # as a torn write leaves it
    finished = subprocess.run([*words, "--processes", "1"], cwd=tmp_path, capture_output=True, text=True)
    assert finished.returncode == 0 and finished.stdout == "squares.csv  40 of 40 runs\n", finished.stderr
    assert cells(table)[1:] == [[str(n), kind, str(n * n), ""] for n in range(1, 21) for kind in "ab"]
    calls = (tmp_path / "calls").read_text().split()
    assert len(set(calls)) == 40 and len(calls) <= 40 + 4, "only what was under way is done twice"


def test_a_table_of_another_sweep_is_refused_and_left_alone(tmp_path: Path) -> None:
    path = tmp_path / "t.csv"
    path.write_text("length,y,error\n1,2,\n")
    with pytest.raises(ValueError, match=r"is of another sweep: its columns are length, y, error"):
        iota.sweep(swing, GRID, path, processes=0)
    assert path.read_text() == "length,y,error\n1,2,\n"


def test_bad_sweeps_are_refused_in_words(tmp_path: Path) -> None:
    for function in (lambda stiffness, seed: 1, print.__call__):
        with pytest.raises(TypeError, match="another process cannot find"):
            iota.sweep(function, GRID, processes=1)
    for grid, words in (({}, "needs values"), ({"a": []}, "needs values"), ({"a": [1, 1]}, "same arguments")):
        with pytest.raises(ValueError, match=words):
            iota.sweep(swing, grid, processes=0)
    with pytest.raises(ValueError, match="all runs of a sweep need the same"):
        iota.sweep(swing, [{"a": 1}, {"b": 1}], processes=0)
    (row,) = iota.sweep(lambda a: object(), {"a": [1]}, processes=0)
    assert row["error"].startswith("TypeError: a result is a number or a text, not <object")
    script = tmp_path / "script.py"
    script.write_text("import iota\ndef f(a): return a\nprint(iota.sweep(f, {'a': [1]}, processes=1)[0]['error'])\n")
    done = subprocess.run([sys.executable, str(script)], capture_output=True, text=True)
    assert "put the call under `if __name__ == '__main__':`" in done.stdout


def test_values_of_the_command_line() -> None:
    assert varied("seed=1..4") == ("seed", [1, 2, 3, 4])
    assert varied("a=1,2.5,x") == ("a", [1, 2.5, "x"])
    assert varied("a=0..1:5") == ("a", [0.0, 0.25, 0.5, 0.75, 1.0])
    assert varied("a=1e2..1e5:log:4") == ("a", [100.0, 1000.0, 10000.0, 100000.0])
    for text in ("a", "=1", "a=1..x", "a=0..1:log:3", "a=1..2:1", "a=1..2:lin:3", "2=1"):
        with pytest.raises(Failure, match="--vary"):
            varied(text)


def test_the_command_line_tells_what_failed(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    script = tmp_path / "s.py"
    script.write_text("def run(a):\n    return 1 / a\ndef other(b): return b\n")
    words = ["sweep", str(script), "-o", str(tmp_path / "s.csv"), "--processes", "0"]
    assert main([*words, "--vary", "a=0,1,2"]) == 1
    told = capsys.readouterr()
    assert "s.csv  2 of 3 runs" in told.out
    assert "failed with a = 0: ZeroDivisionError: division by zero" in told.err
    assert main([*words, "--vary", "b=0"]) == 1 and "does not take these arguments" in capsys.readouterr().err
    words[1] += ":other"
    assert main([*words, "--vary", "b=0..1:3"]) == 1 and "of another sweep" in capsys.readouterr().err


def test_a_table_in_parquet_has_the_rows_and_types_of_the_sweep(tmp_path: Path) -> None:
    parquet = pytest.importorskip("pyarrow.parquet")
    path = tmp_path / "swing.parquet"
    rows = iota.sweep(swing, GRID, path, processes=0)
    table = parquet.read_table(path)
    assert table.to_pylist() == rows and str(table.schema.field("seed").type) == "int64"
    assert len(cells(tmp_path / "swing.csv")) == 7, "the table that goes on where it was stopped"
    path.unlink()
    calls: list[int] = []
    assert iota.sweep(swing, GRID, path, 0, lambda done, all, failed: calls.append(done)) == rows and calls == [6]
    mixed = iota.sweep(lambda a: {"b": a if a < 2 else "many"}, {"a": [1, 2]}, tmp_path / "m.parquet", processes=0)
    assert [row["b"] for row in mixed] == [1, "many"]
    assert parquet.read_table(tmp_path / "m.parquet").to_pydict()["b"] == ["1", "many"]


def test_without_pyarrow_a_sweep_in_parquet_is_refused_before_it_begins(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    with pytest.raises(ValueError, match=r"need pyarrow. Try: .* or name a file that ends in .csv"):
        iota.sweep(lambda a: 1 / 0, {"a": [1]}, "t.parquet", processes=0)


def test_a_sweep_is_drawn_over_the_argument_with_the_most_values(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    script = tmp_path / "s.py"
    script.write_text("def run(k, d, seed):\n    return {'y': k * d + seed, 'kind': 'x', 'z': -k}\n")
    words = ["sweep", str(script), "-o", str(tmp_path / "s.csv"), "--processes", "0", "--plot"]
    varied = ["--vary", "k=1e0..1e3:log:4", "--vary", "d=1,2", "--vary", "seed=1..6"]  # no axis, though it has more
    file = tmp_path / "s.svg"
    assert main([*words, str(file), *varied]) == 0
    assert capsys.readouterr().out.splitlines()[-1] == str(file)
    drawn = file.read_text()
    assert drawn.count('<g id="axes_') == 2 and drawn.count('<g id="FillBetweenPolyCollection_') == 4
    assert main([*words, str(tmp_path / "s.gif"), *varied]) == 1
    assert "a plot ends in .png, .svg or .pdf" in capsys.readouterr().err


def test_what_a_plot_shows_is_the_mean_and_the_range_of_runs_that_differ_in_their_seeds() -> None:
    rows = [{"k": k, "d": d, "seed": seed, "y": k + seed} for k in (1, 2) for d in "ab" for seed in (0, 4)]
    found = plot.lines(rows, "k", "d", "y")
    assert found["a"] == found["b"] == {"x": [1, 2], "mean": [3.0, 4.0], "least": [1, 2], "most": [5, 6]}
    assert plot.is_logarithmic([1, 10, 100]) and not plot.is_logarithmic([1, 2, 3])
    assert plot.most_varied(["seed", "k"], rows) == "k" and plot.line_argument(["d", "seed"], rows) == "d"
