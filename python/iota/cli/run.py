# SPDX-License-Identifier: Apache-2.0
"""`iota list` and `iota run`."""

from __future__ import annotations

import argparse
import ast
import difflib
import errno
import inspect
import json
import os
import runpy
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager, nullcontext
from pathlib import Path
from types import FunctionType

from iota import studies
from iota._core import kept_token, renew_token
from iota.cli import prompt
from iota.cli.failure import Failure
from iota.errors import PageMissingError
from iota.film.files import Failed, check_name
from iota.journal.folder import BusyError
from iota.rooms.room import RoomHere, RoomOptions
from iota.terminal import TerminalView
from iota.world import World
from iota.world.callbacks import is_terminal, print_error
from iota.world.lan import Lan
from iota.world.options import RunOptions, current, use

NOT_MAIN = "__iota__"  # run name of a script whose build() is called for it


def list_studies(arguments: argparse.Namespace) -> None:
    """Names and first lines of their descriptions."""
    names = studies.names()
    width = max(map(len, names))
    for name in names:
        print(f"{name:{width}}  {studies.description(name)}")


def run(arguments: argparse.Namespace) -> None:
    """Runs a study or a script under the options given; prints figures with --json."""
    options = RunOptions(
        port=arguments.port,
        seconds=arguments.seconds,
        open=not arguments.no_open and not arguments.headless and can_show_a_page(),
        headless=arguments.headless,
        lan=lan(arguments),
        record=arguments.record,
        kept=arguments.handover,
        keep=arguments.keep,
        fresh=arguments.fresh,
        drive=prompt.drive if arguments.prompt else None,
        view=TerminalView() if arguments.terminal else None,
    )
    if arguments.prompt and arguments.seconds is not None:
        raise Failure("--prompt runs a world until the prompt ends, so it takes no --seconds")
    if arguments.record is not None:
        if arguments.headless or arguments.terminal:
            raise Failure(f"--record needs a page. Try: iota record {arguments.what} -o {arguments.record}")
        try:
            check_name(arguments.record, [".iota"])
        except Failed as failed:
            raise Failure(str(failed)) from None
    if arguments.fresh and arguments.keep is None and arguments.room is None:
        raise Failure("--fresh begins a kept world anew, so it needs --keep DIR")
    room = None if arguments.room is None else RoomHere(RoomOptions.from_text(arguments.room))
    if room is not None:
        options.keep, options.make_server, options.on_serve = room.folder.journal, room.make_server, room.begin
    start = find(arguments.what)
    with use(options), plain_failures(arguments.port), nullcontext() if room is None else room.ending_in_order():
        start(arguments.links)
        if not options.ran:
            raise Failure(
                f"{arguments.what} made no World run: call world.run(), or define build() that returns a World"
            )
    if arguments.json and options.summary is not None:
        print(json.dumps(options.summary.as_dict()))


def lan(arguments: argparse.Namespace) -> Lan | None:
    if not (arguments.lan or arguments.cert or arguments.key):
        return None
    try:
        chosen = Lan(arguments.cert, arguments.key)
        if chosen.cert is not None:
            chosen.certificate()  # files that cannot be read are told before the script runs
    except ValueError as error:
        raise Failure(str(error)) from None
    except OSError as error:
        hint = "Try: --lan alone, which makes a certificate"
        raise Failure(f"the certificate or key {error.filename} cannot be read: {error.strerror}. {hint}") from None
    return chosen


def token(arguments: argparse.Namespace) -> None:
    """Prints the kept token; with --renew a new one in its place."""
    try:
        print(renew_token() if arguments.renew else kept_token())
    except OSError as error:
        raise Failure(f"{error.strerror or error}") from None
    if arguments.renew:
        print("iota: worlds that are running keep the old token until they are started again", file=sys.stderr)


def can_show_a_page() -> bool:
    """Whether this machine has a display: without one, Python would look for a browser in the terminal."""
    has_display = sys.platform in ("darwin", "win32") or "DISPLAY" in os.environ or "WAYLAND_DISPLAY" in os.environ
    return has_display and is_terminal()


def find(what: str) -> Callable[[int | None], None]:
    """A function that runs a study by name, or a file."""
    names = studies.names()
    if what in names:
        return lambda links: run_study(what, links)
    path, is_file = Path(what), os.path.isfile(what)  # Path.is_file raises OSError for a name that is too long
    if what.endswith(".py") or is_file:
        if not is_file:
            raise Failure(f"there is no file {what}")
        return lambda links: run_file(path, links)
    near = difflib.get_close_matches(what, names, n=1)
    hint = f"Did you mean {near[0]}?" if near else f"There is: {', '.join(names)}; or a file that ends in .py"
    raise Failure(f"there is no study {what!r}. {hint}")


def run_study(name: str, links: int | None) -> None:
    module = studies.module(name)
    build_and_run(module.build, links, name)


def run_file(path: Path, links: int | None) -> None:
    """Runs a script as Python would. With --links, or if it runs no World itself, its build() is called."""
    tree = parse(path)
    has_build = any(isinstance(node, ast.FunctionDef) and node.name == "build" for node in tree.body)
    if links is not None and not has_build:
        raise Failure(f"{path} has no build(links=...), so --links has no effect")
    sys.argv = [str(path)]
    sys.path.insert(0, str(path.resolve().parent))
    space = runpy.run_path(str(path), run_name="__main__" if links is None else NOT_MAIN)
    if not current().ran and has_build:
        build_and_run(space["build"], links, str(path))


def parse(path: Path) -> ast.Module:
    try:
        return ast.parse(path.read_bytes(), filename=str(path))
    except SyntaxError as error:
        raise Failure(f"{path}, line {error.lineno}: {error.msg}") from None
    except (OSError, ValueError) as error:
        raise Failure(f"{path} cannot be read: {error}") from None


def build_and_run(build: FunctionType, links: int | None, name: str) -> None:
    given: dict[str, int] = {}
    if links is not None:
        if "links" not in inspect.signature(build).parameters:
            raise Failure(f"build() of {name} takes no links")
        given["links"] = links
    current().names = build.__globals__
    world = build(**given)
    if not isinstance(world, World):
        raise Failure(f"build() of {name} must return a World, not {type(world).__name__}")
    world.run()


@contextmanager
def plain_failures(port: int | None) -> Iterator[None]:
    """Prints errors in one line at the end, after the traceback in the user's own file if the script failed."""
    try:
        yield
    except (Failure, KeyboardInterrupt):
        raise
    except BusyError as error:
        raise Failure(str(error)) from None
    except SystemExit as leave:
        if leave.code not in (None, 0):
            raise
    except PageMissingError as error:
        raise Failure(str(error)) from None
    except OSError as error:
        if error.errno in (errno.EADDRINUSE, errno.EACCES, errno.EADDRNOTAVAIL) and error.filename is None:
            other = 8081 if port in (None, 8080) else 0
            raise Failure(f"{error.strerror}. Try: --port {other}") from None
        fail_with_traceback(error)
    except Exception as error:
        fail_with_traceback(error)


def fail_with_traceback(error: Exception) -> None:
    from iota.world.callbacks import one_line

    print_error(error)
    raise Failure(one_line(error)) from None
