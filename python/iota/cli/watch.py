# SPDX-License-Identifier: Apache-2.0
"""`iota run --watch`: runs a script in its own process, and again whenever it or a module beside it is saved.

The address stays the same, so open pages show the new world and keep their camera. If the changed script starts its world
in the same state as before, the world goes on where it was. If the script cannot be read, the
previous world continues; if it fails, the next save is waited for.
"""

from __future__ import annotations

import argparse
import os
import signal
import socket
import subprocess
import sys
import time
from pathlib import Path
from tempfile import TemporaryDirectory

from iota.cli import run
from iota.cli.failure import Failure
from iota.processes import wait_or_kill

EVERY = 0.2  # s, between two checks of the files
PATIENCE = 5.0  # s, within which a world has to end
MOST_FILES = 2000
OTHERS = {"__pycache__", "node_modules", "site-packages"}


def watch(arguments: argparse.Namespace) -> None:
    """Runs until Ctrl-C, or until the script ends without an error."""
    path = Path(arguments.what)
    if not os.path.isfile(path):
        raise Failure(f"--watch needs a file, and there is no {arguments.what}")
    if arguments.record is not None:
        raise Failure("--record keeps one run, and --watch begins others: use one of them")
    run.parse(path)
    arguments.port = free_port() if arguments.port == 0 else arguments.port
    with TemporaryDirectory(prefix="iota-watch-") as folder:
        arguments.handover = Path(folder, "world")
        watch_files(arguments, path)


def watch_files(arguments: argparse.Namespace, path: Path) -> None:
    seen = stamps(path)
    child: subprocess.Popen[bytes] | None = start(arguments, is_first=True)
    try:
        while True:
            time.sleep(EVERY)
            now = stamps(path)
            if now != seen:
                seen = now
                child = again(arguments, path, child)
            elif child is not None and child.poll() is not None:
                if child.returncode == 0:
                    return
                say(f"waiting for {path} to be saved")
                child = None
    finally:
        end(child)


def start(arguments: argparse.Namespace, is_first: bool) -> subprocess.Popen[bytes]:
    words = [sys.executable, "-m", "iota", "run", arguments.what]
    for name in ("links", "port", "seconds", "cert", "key", "keep", "handover"):
        value = getattr(arguments, name)
        words += [] if value is None else [f"--{name}", str(value)]
    words += ["--lan"] if arguments.lan else []
    words += ["--fresh"] if arguments.fresh and is_first else []
    words += ["--no-open"] if arguments.no_open or not is_first else []
    return subprocess.Popen(words)


def again(
    arguments: argparse.Namespace, path: Path, child: subprocess.Popen[bytes] | None
) -> subprocess.Popen[bytes] | None:
    """The new world; the previous one if the script cannot be read."""
    try:
        run.parse(path)
    except Failure as failure:
        say(f"{failure}; the world before goes on" if child is not None else str(failure))
        return child
    end(child)
    say(f"{path} was saved: again")
    return start(arguments, is_first=False)


def end(child: subprocess.Popen[bytes] | None) -> None:
    if child is None or child.poll() is not None:
        return
    child.send_signal(signal.SIGTERM)
    wait_or_kill(child, PATIENCE)  # a callback may hang


def stamps(path: Path) -> dict[Path, tuple[int, int]]:
    """Times of the last change of the script and the modules beside it, and their sizes. An editor may replace a file,
    so a missing file is ignored until it exists again."""
    found = {}
    for file in [path, *modules(path.resolve().parent)]:
        try:
            status = file.stat()
        except OSError:
            continue
        found[file] = (status.st_mtime_ns, status.st_size)
    return found


def modules(folder: Path) -> list[Path]:
    """Modules beside the script, and in packages there."""
    found = sorted(folder.glob("*.py"))
    for package in sorted(folder.glob("*/__init__.py")):
        if package.parent.name not in OTHERS and len(found) < MOST_FILES:
            found += sorted(package.parent.rglob("*.py"))
    return found[:MOST_FILES]


def free_port() -> int:
    """One port for all successive worlds."""
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


def say(text: str) -> None:
    print(f"iota: {text}", file=sys.stderr, flush=True)
