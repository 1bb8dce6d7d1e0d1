# SPDX-License-Identifier: Apache-2.0
"""The script that guards the architecture finds what it is there to find."""

import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


def graph_of(src: Path, **files: str) -> subprocess.CompletedProcess[str]:
    for name, text in files.items():
        path = src / name.replace("__", "/").replace("_h", ".h")
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    script = ROOT / "tools" / "folder_graph.py"
    return subprocess.run([sys.executable, script, src], capture_output=True, text=True)


def test_folders_in_one_direction_are_fine(tmp_path: Path) -> None:
    done = graph_of(tmp_path, step__a_h='#include "model/b.h"\n', model__b_h="#include <vector>\n")
    assert done.returncode == 0
    assert "step" in done.stdout and "-> model" in done.stdout


def test_two_folders_that_include_each_other_are_found(tmp_path: Path) -> None:
    done = graph_of(tmp_path, step__a_h='#include "model/b.h"\n', model__b_h='  #  include "step/a.h"\n')
    assert done.returncode == 1
    assert "model -> step -> model" in done.stderr


def test_a_cycle_through_a_third_folder_is_found(tmp_path: Path) -> None:
    done = graph_of(tmp_path, a__x_h='#include "b/x.h"\n', b__x_h='#include "c/x.h"\n', c__x_h='#include "../a/x.h"\n')
    assert done.returncode == 1
    assert "a -> b -> c -> a" in done.stderr


def test_a_solver_that_sees_the_model_is_found(tmp_path: Path) -> None:
    done = graph_of(tmp_path, solver__sparse__a_h='#include "model/b.h"\n', model__b_h="\n")
    assert done.returncode == 1
    assert "solver must not see model" in done.stderr
