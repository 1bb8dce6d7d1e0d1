# SPDX-License-Identifier: Apache-2.0
"""The script that guards the architecture finds what it is there to find."""

import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


def graph_of(tree: Path, files: dict[str, str]) -> subprocess.CompletedProcess[str]:
    for name, text in files.items():
        path = tree / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    script = ROOT / "tools" / "folder_graph.py"
    return subprocess.run([sys.executable, script, tree], capture_output=True, text=True)


def test_folders_in_one_direction_are_fine(tmp_path: Path) -> None:
    done = graph_of(tmp_path, {"step/a.h": '#include "model/b.h"\n', "model/b.h": "#include <vector>\n"})
    assert done.returncode == 0
    assert "step" in done.stdout and "-> model" in done.stdout


def test_two_folders_that_include_each_other_are_found(tmp_path: Path) -> None:
    done = graph_of(tmp_path, {"step/a.h": '#include "model/b.h"\n', "model/b.h": '  #  include "step/a.h"\n'})
    assert done.returncode == 1
    assert "model -> step -> model" in done.stderr


def test_a_cycle_through_a_third_folder_is_found(tmp_path: Path) -> None:
    files = {"a/x.h": '#include "b/x.h"\n', "b/x.h": '#include "c/x.h"\n', "c/x.h": '#include "../a/x.h"\n'}
    done = graph_of(tmp_path, files)
    assert done.returncode == 1
    assert "a -> b -> c -> a" in done.stderr


def test_a_solver_that_sees_the_model_is_found(tmp_path: Path) -> None:
    done = graph_of(tmp_path, {"solver/sparse/a.h": '#include "model/b.h"\n', "model/b.h": "\n"})
    assert done.returncode == 1
    assert "solver must not see model" in done.stderr


def test_two_folders_of_the_page_that_use_each_other_are_found(tmp_path: Path) -> None:
    app, ui = 'import { make } from "../ui/dom.ts";\n', 'import type { Page } from "../app/page.ts";\n'
    done = graph_of(tmp_path, {"app/page.ts": app, "ui/dom.ts": ui, "ui/late.ts": 'await import("./dom.ts");\n'})
    assert done.returncode == 1
    assert "app -> ui -> app" in done.stderr


def test_two_folders_of_the_package_that_use_each_other_are_found(tmp_path: Path) -> None:
    package = tmp_path / "iota"
    world = "from typing import TYPE_CHECKING\n\nif TYPE_CHECKING:\n    from iota import builder\n"
    done = graph_of(package, {
        "__init__.py": "from iota.world import World\n", "world/__init__.py": "World = 1\n", "world/world.py": world,
        "builder/__init__.py": "from iota.world.world import name\n",
    })  # fmt: skip
    assert done.returncode == 1
    assert "builder -> world -> builder" in done.stderr


def test_the_package_itself_is_made_of_its_folders_and_may_be_used_by_those_above(tmp_path: Path) -> None:
    package = tmp_path / "iota"
    done = graph_of(package, {
        "__init__.py": "from iota.world import World\n", "world/__init__.py": "World = 1\n",
        "studies/chain.py": "import iota\nfrom iota import World\nfrom iota._core import Body\n",
        "__main__.py": "from iota.studies import chain\n",
    })  # fmt: skip
    assert done.returncode == 0
    assert "studies                  -> iota" in done.stdout


def test_the_trees_of_this_repository_are_fine() -> None:
    done = subprocess.run([sys.executable, ROOT / "tools" / "folder_graph.py"], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    for tree in ("src:", "web/src:", "python/iota:"):
        assert tree in done.stdout
