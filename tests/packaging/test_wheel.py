# SPDX-License-Identifier: Apache-2.0
"""Each wheel works in a clean environment of its Python: no compiler, no Node.js, no network, none of this folder's files."""

import importlib.util
import io
import json
import os
import re
import shutil
import socket
import subprocess
import sys
import time
import urllib.error
import urllib.request
import zipfile
from collections.abc import Iterator
from email import message_from_bytes
from pathlib import Path
from types import ModuleType

import pytest

ROOT = Path(__file__).resolve().parents[2]
OWN = "{}.{}".format(*sys.version_info)
TRIES_ALL = bool(os.environ.get("IOTA_TEST_ALL"))


def packed() -> dict[str, Path]:
    """The wheels of build/wheel by their Python, as in "3.12"."""
    found = {}
    for path in sorted((ROOT / "build" / "wheel").glob("iota_worlds-*.whl")):
        tag = re.search(r"-cp3(\d+)-cp3\1-", path.name)
        assert tag, path.name
        found[f"3.{tag[1]}"] = path
    return found


@pytest.fixture(scope="module", params=packed() or [OWN])
def version(request: pytest.FixtureRequest) -> str:
    return str(request.param)


@pytest.fixture(scope="module")
def wheel(version: str) -> Path:
    assert version in packed(), "make wheel leaves one for each Python"
    return packed()[version]


@pytest.fixture(scope="module")
def python(version: str) -> Path:
    """The interpreter for which the wheel is made."""
    if version == OWN:
        return Path(sys.executable)
    found = builder().find_python(version)
    assert found, f"a wheel of Python {version} is here, but not its Python"
    return found


def builder() -> ModuleType:
    """tools/build.py"""
    spec = importlib.util.spec_from_file_location("build_for_wheels", ROOT / "tools" / "build.py")
    assert spec and spec.loader
    module = sys.modules[spec.name] = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_there_is_a_wheel_for_each_python_that_is_supported_and_here() -> None:
    """The everyday test packs that of .venv's Python only."""
    tool = builder()
    here = {version for version in tool.supported_versions() if TRIES_ALL and tool.find_python(version)}
    assert {OWN} | here <= packed().keys()


@pytest.fixture(scope="module")
def environment(python: Path, wheel: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A new virtual environment of its Python with the wheel and NumPy in it, installed from files."""
    folder = tmp_path_factory.mktemp("clean") / "venv"
    subprocess.run([python, "-m", "venv", "--without-pip", folder], check=True)
    depends = ROOT / "build" / "wheel" / "depends"
    # By this environment's pip: one in each of them, and NumPy compiled in advance, take half of the time.
    pip = [sys.executable, "-m", "pip", "--python", folder / "bin" / "python"]
    install = [*pip, "install", "--no-compile", "--no-index", "--find-links", depends, wheel]
    subprocess.run(install, check=True, capture_output=True, env=bare_environment())
    return folder


def bare_environment(**more: str) -> dict[str, str]:
    """No search path: a compiler, a Node.js or this project's .venv cannot be found by accident."""
    kept = {name: value for name, value in os.environ.items() if name in ("LANG", "TMPDIR")}
    return {**kept, "PATH": "/nonexistent", "PIP_DISABLE_PIP_VERSION_CHECK": "1", **more}


def without_network() -> list[str]:
    """A prefix that gives a command a network of its own, with nothing but loopback; empty where that is not allowed."""
    unshare = shutil.which("unshare")
    if unshare and shutil.which("ip") and subprocess.run([unshare, "-rn", "true"], capture_output=True).returncode == 0:
        return [unshare, "-rn", "/bin/sh", "-c", f'{shutil.which("ip")} link set lo up; exec "$0" "$@"']
    return []


def test_the_wheel_holds_engine_page_stub_and_types_once_each(wheel: Path) -> None:
    names = zipfile.ZipFile(wheel).namelist()
    assert len(names) == len(set(names))
    for wanted in ("iota/__init__.py", "iota/__main__.py", "iota/py.typed", "iota/_core.pyi", "iota/page/index.html"):
        assert wanted in names
    assert sum(re.fullmatch(r"iota/_core\..*so", name) is not None for name in names) == 1
    assert any(re.fullmatch(r"iota/page/assets/.*\.js", name) for name in names)
    assert not [
        name for name in names if not re.match(r"(iota|iota_worlds\.libs|iota_worlds-[\d.]+\.dist-info)/", name)
    ]
    assert any(name.endswith("LICENSE") for name in names)


def words(text: str) -> str:
    """A text without its line breaks and marks, so that two copies of one license compare equal."""
    return " ".join(re.findall(r"\w+", text))


def notices_in(wheel: Path) -> dict[str, str]:
    """The license texts beside the package, by the names of their files."""
    archive = zipfile.ZipFile(wheel)
    found = {name: re.search(r"\.dist-info/licenses/LICENSES/(.+)\.txt$", name) for name in archive.namelist()}
    return {match[1]: archive.read(name).decode() for name, match in found.items() if match}


def test_the_wheel_has_the_license_of_each_library_in_the_extension(wheel: Path) -> None:
    archive = zipfile.ZipFile(wheel)
    extension = next(archive.read(name) for name in archive.namelist() if re.fullmatch(r"iota/_core\..*so", name))
    held = {"nanobind", "robin-map"}  # nanobind cannot be built without its hash map
    assert b"nanobind::" in extension
    if any("libtbb" in name for name in archive.namelist()):
        held.add("oneTBB")
    if any("libcrypto" in name for name in archive.namelist()):
        held.add("OpenSSL")
    if b"kinsol_mem" in extension:
        held.add("SUNDIALS")
    assert held <= notices_in(wheel).keys()
    assert "Wenzel Jakob" in notices_in(wheel)["nanobind"]
    assert "Thibaut Goetghebuer-Planchon" in notices_in(wheel)["robin-map"]


def test_the_wheel_has_the_license_of_each_package_in_the_page(wheel: Path) -> None:
    """The bundler writes down what it put into the page: `licenses.txt` is its list and their texts."""
    listed = zipfile.ZipFile(wheel).read("iota/page/licenses.txt").decode()
    bundled = dict(re.findall(r"^## (\S+) - .*?\n(.*?)(?=^## |\Z)", listed, re.MULTILINE | re.DOTALL))
    assert {"three", "iwer"} <= bundled.keys()
    notices = notices_in(wheel)
    assert bundled.keys() <= notices.keys(), "each package in the page has a file in LICENSES"
    for package, text in bundled.items():
        same_as_ours = "Apache License Version 2 0" in words(text) and "LICENSE" in notices[package]
        assert same_as_ours or words(text) in words(notices[package]), f"LICENSES/{package}.txt is another text"
    page = zipfile.ZipFile(wheel).read("iota/page/index.html").decode()
    assert '<link rel="license" href="./licenses.txt">' in page


def test_the_wheel_has_a_tag_that_pypi_takes_and_no_newer_symbols(wheel: Path) -> None:
    if not sys.platform.startswith("linux"):
        pytest.skip("tags of other systems tell nothing of libraries")
    tag = re.search(r"-cp3\d+-cp3\d+-manylinux_(\d+)_(\d+)_\w+\.whl$", wheel.name)
    assert tag, wheel.name
    archive = zipfile.ZipFile(wheel)
    libraries = [archive.read(name) for name in archive.namelist() if re.search(r"\.so(\.|$)", name)]
    used = {(int(a), int(b)) for data in libraries for a, b in re.findall(rb"\0GLIBC_(\d+)\.(\d+)", data)}
    assert max(used) <= (int(tag[1]), int(tag[2]))


# Each Linux that a manylinux tag names has these, by PEP 600.
OF_THE_SYSTEM = r"(libc|libm|libdl|librt|libpthread|libgcc_s|libstdc\+\+|ld-linux-x86-64)\.so\.\d+"


def test_the_wheel_brings_its_own_libraries(environment: Path, tmp_path: Path) -> None:
    if not Path("/proc/self/maps").exists():
        pytest.skip("only Linux tells which libraries a process has loaded")
    code = "import iota; print(*{line.split()[-1] for line in open('/proc/self/maps') if '.so' in line}, sep='\\n')"
    done = subprocess.run(
        [environment / "bin" / "python", "-c", code], cwd=tmp_path, env=bare_environment(), capture_output=True,
        text=True, check=True,
    )  # fmt: skip
    own = {name for name in done.stdout.split() if Path(name).is_relative_to(environment)}
    for library in ("libtbb", "libssl", "libcrypto"):
        assert any(Path(name).name.startswith(library) for name in own), library


def test_the_libraries_of_the_wheel_need_only_each_other_and_those_of_any_linux(wheel: Path) -> None:
    elffile = pytest.importorskip("elftools.elf.elffile")
    archive = zipfile.ZipFile(wheel)
    held = {Path(name).name: name for name in archive.namelist() if re.search(r"\.so(\.|$)", name)}
    for name in held.values():
        dynamic = elffile.ELFFile(io.BytesIO(archive.read(name))).get_section_by_name(".dynamic")
        needed = {tag.needed for tag in dynamic.iter_tags() if tag.entry.d_tag == "DT_NEEDED"}
        others = {each for each in needed - held.keys() if not re.fullmatch(OF_THE_SYSTEM, each)}
        assert needed and not others, f"{name} needs {others}"


def test_the_wheel_says_which_pythons_it_is_for(wheel: Path) -> None:
    archive = zipfile.ZipFile(wheel)
    metadata = message_from_bytes(
        next(archive.read(name) for name in archive.namelist() if name.endswith(".dist-info/METADATA"))
    )
    classifiers = metadata.get_all("Classifier") or []
    named = [match[1] for each in classifiers if (match := re.fullmatch(r".* Python :: (3\.\d+)", each))]
    assert named == builder().supported_versions()
    assert metadata["Requires-Python"] == f">={named[0]}"


def test_the_wheel_runs_the_chain_headless(environment: Path, tmp_path: Path) -> None:
    command = [environment / "bin" / "iota", "run", "chain", "--headless", "--seconds", "1", "--json"]
    done = subprocess.run(
        [*without_network(), *map(str, command)], cwd=tmp_path, env=bare_environment(HOME=str(tmp_path)),
        capture_output=True, text=True, timeout=60,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    result = json.loads(done.stdout)
    assert result["simulated_s"] == pytest.approx(1, abs=2 * result["dt_s"])
    assert result["worst_gap_m"] <= 1e-9


def test_the_wheel_tells_how_to_get_what_is_missing(environment: Path, tmp_path: Path) -> None:
    done = subprocess.run(
        [environment / "bin" / "iota", "verify", "--list"], cwd=tmp_path, env=bare_environment(HOME=str(tmp_path)),
        capture_output=True, text=True, timeout=60,
    )  # fmt: skip
    assert done.returncode == 1 and done.stderr.endswith("Try: pip install 'iota-worlds[verify]'\n"), done.stderr


def test_the_wheel_answers_mistakes_in_words(environment: Path, tmp_path: Path) -> None:
    """They are made of texts of Python, nanobind and argparse, which differ between versions of Python."""
    code = (
        "import iota\n"
        "system = iota.System()\n"
        "for call in (lambda: system.body(masss=1), lambda: setattr(system.body(), 'masss', 1), lambda: iota.Bond()):\n"
        "    try: call()\n"
        "    except Exception as error: print(error)\n"
    )
    done = subprocess.run(
        [environment / "bin" / "python", "-c", code], cwd=tmp_path, env=bare_environment(HOME=str(tmp_path)),
        capture_output=True, text=True, timeout=60, check=True,
    )  # fmt: skip
    assert "incompatible function arguments" not in done.stdout
    for said in ("no argument 'masss'", "did you mean 'mass'", "Bond"):
        assert said.lower() in done.stdout.lower(), done.stdout
    done = subprocess.run(
        [environment / "bin" / "iota", "recrod"], cwd=tmp_path, env=bare_environment(HOME=str(tmp_path)),
        capture_output=True, text=True, timeout=60,
    )  # fmt: skip
    assert (done.returncode, done.stderr) == (
        2, "iota: there is no command 'recrod'; did you mean 'record'? Try: iota --help\n"
    )  # fmt: skip


@pytest.fixture
def served(environment: Path, tmp_path: Path) -> Iterator[tuple[int, subprocess.Popen[str]]]:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1]
    command = [environment / "bin" / "iota", "run", "chain", "--port", str(port), "--no-open", "--seconds", "60"]
    process = subprocess.Popen(
        [str(word) for word in command], cwd=tmp_path, env=bare_environment(HOME=str(tmp_path)),
        stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
    )  # fmt: skip
    try:
        yield port, process
    finally:
        process.terminate()
        process.wait(timeout=10)
        process.stdout.close()


def fetch(url: str, process: subprocess.Popen[str]) -> bytes:
    """What a server answers, asked again until it is up."""
    for _ in range(100):
        try:
            with urllib.request.urlopen(url, timeout=5) as answer:
                return answer.read()
        except (urllib.error.URLError, ConnectionError):
            assert process.poll() is None, process.stdout.read()
            time.sleep(0.1)
    raise AssertionError(f"{url} did not answer")


def test_the_wheel_serves_its_page(served: tuple[int, subprocess.Popen[str]]) -> None:
    port, process = served
    address = f"http://127.0.0.1:{port}"
    assert fetch(f"{address}/healthz", process).strip() == b"ok"
    page = fetch(f"{address}/", process).decode()
    scripts = re.findall(r'src="\.?/?(assets/[^"]+\.js)"', page)
    assert scripts
    for script in scripts:
        assert len(fetch(f"{address}/{script}", process)) > 1000


def test_the_wheel_serves_other_machines_with_its_own_openssl(environment: Path, tmp_path: Path) -> None:
    code = (
        "import os, ssl, urllib.request, iota\n"
        "world = iota.World(iota.System())\n"
        "world.serve(port=0, lan=True)\n"
        "trust = ssl.create_default_context(cafile=os.environ['XDG_STATE_HOME'] + '/iota/certificate.pem')\n"
        "print(urllib.request.urlopen(world.pages.lan_url, context=trust).status)\n"
        "world.close()\n"
    )
    done = subprocess.run(
        [environment / "bin" / "python", "-c", code], cwd=tmp_path, env=bare_environment(XDG_STATE_HOME=str(tmp_path)),
        capture_output=True, text=True, timeout=60,
    )  # fmt: skip
    assert (done.returncode, done.stdout) == (0, "200\n"), done.stderr
