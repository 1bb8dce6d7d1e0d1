# SPDX-License-Identifier: Apache-2.0
"""Another CMake project finds an installed iota and uses its engine."""

import re
import shutil
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]


def run(*command: str | Path) -> str:
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True)
    assert done.returncode == 0, f"{command}\n{done.stdout}\n{done.stderr}"
    return done.stdout


@pytest.fixture(scope="module")
def prefix(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The engine installed into a folder of its own, then moved: what is installed must not name its build tree."""
    first = tmp_path_factory.mktemp("install")
    run("cmake", "--install", ROOT / "build", "--prefix", first, "--component", "engine")
    moved = tmp_path_factory.mktemp("elsewhere") / "iota"
    shutil.move(first, moved)
    return moved


@pytest.fixture(scope="module")
def built(prefix: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    source = tmp_path_factory.mktemp("consumer")
    shutil.copytree(ROOT / "examples" / "cpp", source, dirs_exist_ok=True)
    build = source / "build"
    run(
        "cmake", "-S", source, "-B", build, "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release", f"-DCMAKE_PREFIX_PATH={prefix}"
    )
    run("cmake", "--build", build)
    return build


def test_an_installed_engine_holds_headers_library_and_package_files_only(prefix: Path) -> None:
    files = {path.relative_to(prefix).as_posix() for path in prefix.rglob("*") if path.is_file()}
    assert "include/iota/system.h" in files
    assert any(re.fullmatch(r"lib(/[\w-]+)?/cmake/iota/iotaConfig\.cmake", name) for name in files)
    assert all(name.startswith(("include/iota/", "lib")) for name in files)


def test_installed_package_files_name_no_build_folder(prefix: Path) -> None:
    for path in prefix.rglob("*.cmake"):
        assert str(ROOT) not in path.read_text(), path


def test_the_cpp_example_hangs_cuts_and_joins_a_chain(built: Path) -> None:
    output = run(built / "hanging_chain")
    assert "2 articulates" in output
    assert re.search(r"joined at .*: 1 articulates", output)
    gap = re.search(r"worst gap: (\S+) m", output)
    assert gap is not None and float(gap[1]) < 1e-9


def test_a_version_that_is_not_there_is_refused(prefix: Path, tmp_path: Path) -> None:
    (tmp_path / "CMakeLists.txt").write_text(
        "cmake_minimum_required(VERSION 3.25)\nproject(wants_more LANGUAGES CXX)\nfind_package(iota 99.0 REQUIRED)\n"
    )
    done = subprocess.run(
        ["cmake", "-S", tmp_path, "-B", tmp_path / "build", "-G", "Ninja", f"-DCMAKE_PREFIX_PATH={prefix}"],
        capture_output=True,
        text=True,
    )
    assert done.returncode != 0
    assert "99.0" in done.stderr
