# SPDX-License-Identifier: Apache-2.0
"""Arguments, and errors as one clear line."""

from __future__ import annotations

import argparse
import os
import re
import signal
import sys
from collections.abc import Sequence
from pathlib import Path
from types import FrameType
from typing import NoReturn

import iota
from iota.arguments import suggestion
from iota.cli import (
    bench,
    bench_forces,
    gallery,
    imports,
    info,
    play,
    profile,
    record,
    rooms,
    run,
    sweep,
    verify,
    watch,
)
from iota.cli.failure import Failure
from iota.world.callbacks import plain

MOST_LINKS = 1_000_000  # some GB


class Parser(argparse.ArgumentParser):
    """Prints an error in one line, without the usage text before it."""

    def error(self, message: str) -> NoReturn:
        text = instead_of(message) or message
        self.exit(2, f"{self.prog}: {text}{'' if text.endswith('?') else '.'} Try: {self.prog} --help\n")


# Commands that people look for under other names.
MEANT = {
    "export": "a page of its own is made by: iota record NAME|FILE.py -o FILE.html",
    "film": "a film is made by: iota record NAME|FILE.py -o FILE.mp4",
    "render": "a film is made by: iota record NAME|FILE.py -o FILE.mp4",
    "serve": "a world is served by: iota run NAME|FILE.py",
    "start": "a world is served by: iota run NAME|FILE.py",
    "show": "a world is shown by: iota run NAME|FILE.py; a file by: iota import FILE --show",
    "open": "a file is shown by: iota import FILE --show; a recording by: iota play FILE.iota",
    "studies": "the studies are listed by: iota list",
    "convert": "a file is read by: iota import FILE; a page is made by: iota record FILE.py -o FILE.html",
}


def instead_of(message: str) -> str | None:
    """For a command that does not exist: what to use, or a near one."""
    found = re.match(r"argument COMMAND: invalid choice: '([^']*)' \(choose from (.*)\)", message)
    if found is None:
        return None
    word, known = found[1], re.findall(r"\w+", found[2])
    if word in MEANT:
        return f"there is no command {word!r}; {MEANT[word]}"
    return f"there is no command {word!r}{suggestion(word, known) or '; there are ' + ', '.join(known)}"


def positive(text: str) -> float:
    value = float(text)
    if not 0 < value < float("inf"):
        raise argparse.ArgumentTypeError(f"must be above 0 and finite, not {text}")
    return value


def count(text: str) -> int:
    value = int(text)
    if value < 1:
        raise argparse.ArgumentTypeError(f"must be 1 or more, not {text}")
    return value


def not_negative(text: str) -> int:
    value = int(text)
    if value < 0:
        raise argparse.ArgumentTypeError(f"must be 0 or more, not {text}")
    return value


def link_count(text: str) -> int:
    value = count(text)
    if value > MOST_LINKS:
        raise argparse.ArgumentTypeError(f"must be at most {MOST_LINKS}, not {text}")
    return value


def port(text: str) -> int:
    value = int(text)
    if not 0 <= value <= 65535:
        raise argparse.ArgumentTypeError(f"must be from 0 to 65535, not {text}")
    return value


def make_parser() -> Parser:
    parser = Parser(prog="iota", description="Jointed bodies that can be grabbed, broken and rejoined while they move.")
    parser.add_argument("--version", action="version", version=f"iota {iota.__version__}")
    commands = parser.add_subparsers(dest="command", required=True, metavar="COMMAND")

    listing = commands.add_parser("list", help="the studies that come with iota")
    listing.set_defaults(function=run.list_studies)

    running = commands.add_parser("run", help="runs a study, or a script of your own, and serves its page")
    running.add_argument("what", metavar="NAME|FILE.py")
    running.add_argument("--links", type=link_count, help="number of links, for scripts with build(links=...)")
    running.add_argument("--port", type=port, help="of the page; 0 for any free one (default: 8080)")
    running.add_argument("--seconds", type=positive, help="stop after this time")
    running.add_argument("--no-open", action="store_true", help="do not open the page in a browser")
    way = running.add_mutually_exclusive_group()
    way.add_argument(
        "--headless", action="store_true", help="serve nothing; run --seconds of simulated time (default: 10)"
    )
    way.add_argument("--watch", action="store_true", help="run the file again whenever it is saved")
    way.add_argument("--prompt", action="store_true", help="a Python prompt on the running world")
    way.add_argument("--terminal", action="store_true", help="show it in this terminal, without a page")
    running.add_argument(
        "--record", type=Path, metavar="FILE.iota", help="write what pages show, with what users do, for iota play"
    )
    running.add_argument("--json", action="store_true", help="print the run's figures as one JSON object at its end")
    running.add_argument(
        "--lan", action="store_true", help="let phones, headsets and other computers in, by https; shows a QR code"
    )
    running.add_argument(
        "--cert", type=Path, metavar="FILE.pem", help="a certificate for --lan, instead of a self-signed one"
    )
    running.add_argument("--key", type=Path, metavar="FILE.pem", help="the key of --cert")
    running.add_argument(
        "--keep", type=Path, metavar="DIR", help="keep the world there: after a crash the next run goes on where it was"
    )
    running.add_argument("--fresh", action="store_true", help="with --keep: begin anew, and put the kept world aside")
    running.add_argument("--handover", type=Path, help=argparse.SUPPRESS)  # from --watch
    running.add_argument("--room", help=argparse.SUPPRESS)  # from iota rooms
    running.set_defaults(function=lambda a: (watch.watch if a.watch else run.run)(a))

    showing = commands.add_parser("gallery", help="serves a page with pictures of all studies, which a click starts")
    showing.add_argument("--port", type=port, help="of the page; 0 for any free one (default: 8080)")
    showing.add_argument("--seconds", type=positive, help="stop after this time")
    showing.add_argument("--no-open", action="store_true", help="do not open the page in a browser")
    showing.set_defaults(function=gallery.run)

    hosting = commands.add_parser("rooms", help="serves a page of worlds for several people, each kept in a folder")
    hosting.add_argument(
        "directory", type=Path, nargs="?", default=Path("rooms"), metavar="DIR", help="(default: rooms)"
    )
    hosting.add_argument("--scripts", type=Path, metavar="FOLDER", help="its scripts can be rooms, beside the studies")
    hosting.add_argument("--port", type=port, help="of the page; rooms take the next ones (default: 8080)")
    hosting.add_argument(
        "--empty",
        type=positive,
        default=10.0,
        metavar="MINUTES",
        help="a room sleeps after so long without visitors (10)",
    )
    hosting.add_argument("--lan", action="store_true", help="let other computers in, by https; shows a QR code")
    hosting.add_argument("--cert", type=Path, metavar="FILE.pem", help="a certificate for --lan")
    hosting.add_argument("--key", type=Path, metavar="FILE.pem", help="the key of --cert")
    hosting.add_argument(
        "--public", metavar="https://NAME", help="the address of a proxy in front, which passes /PORT/ on to that port"
    )
    hosting.add_argument(
        "--ray",
        nargs="?",
        const="auto",
        metavar="ADDRESS",
        help="rooms on the machines of a Ray cluster, without an address the one of this machine; DIR is at the same path on all",
    )
    hosting.add_argument(
        "--room-cores", type=positive, default=0.1, metavar="N", help="with --ray: cores for each room (default: 0.1)"
    )
    hosting.add_argument(
        "--room-memory",
        type=positive,
        default=200.0,
        metavar="MB",
        help="with --ray: memory for each room (default: 200)",
    )
    hosting.add_argument("--seconds", type=positive, help="stop after this time")
    hosting.add_argument("--no-open", action="store_true", help="do not open the page in a browser")
    hosting.set_defaults(function=rooms.run)

    recording = commands.add_parser("record", help="makes a film, or a contact sheet, of a study or a script")
    recording.add_argument("what", metavar="NAME|FILE.py")
    recording.add_argument(
        "-o",
        "--output",
        type=Path,
        metavar="FILM.mp4",
        help="the film; or FILE.html, a page that plays it by itself; or FILE.iota, for iota play",
    )
    recording.add_argument("--sheet", type=Path, metavar="FILE.png|jpg", help="pictures of it side by side")
    recording.add_argument("--seconds", type=positive, default=10.0, help="simulated, from the start (default: 10)")
    recording.add_argument("--rate", type=count, default=30, help="frames a second (default: 30)")
    recording.add_argument(
        "--size", type=record.size, default=(640, 480), metavar="WxH", help="in px (default: 640x480)"
    )
    recording.add_argument("--pictures", type=count, default=12, help="on the sheet (default: 12)")
    recording.add_argument("--columns", type=count, default=4, help="of the sheet (default: 4)")
    recording.add_argument("--plots", action="store_true", help="show the plots of the script in the film")
    recording.set_defaults(function=record.record_film)

    profiling = commands.add_parser("profile", help="runs a study or a script and prints where its time goes")
    profiling.add_argument("what", metavar="NAME|FILE.py")
    profiling.add_argument("--seconds", type=positive, default=10.0, help="simulated (default: 10)")
    profiling.add_argument("--json", action="store_true", help="print the rows as a JSON list")
    profiling.add_argument("--plot", type=Path, metavar="FILE.png", help="draw them as a pie")
    profiling.set_defaults(function=profile.profile)

    sweeping = commands.add_parser("sweep", help="runs a function of a script for many values, on all cores")
    sweeping.add_argument("what", metavar="FILE.py[:FUNCTION]", help="the function is run, unless it is named")
    sweeping.add_argument(
        "--vary",
        action="append",
        required=True,
        metavar="NAME=VALUES",
        help="1,2,5 or 1..50 or 0..1:11 or 1e2..1e5:log:20; once for each argument",
    )
    sweeping.add_argument(
        "-o", "--output", type=Path, metavar="FILE.csv|parquet", help="the table (default: FILE.csv here)"
    )
    sweeping.add_argument("--plot", type=Path, metavar="FILE.png|svg|pdf", help="draw the results over what was varied")
    sweeping.add_argument("--processes", type=not_negative, help="0: in this one (default: one for each core)")
    sweeping.add_argument(
        "--ray",
        nargs="?",
        const="auto",
        metavar="ADDRESS",
        help="on the machines of a Ray cluster, without an address the one of this machine; FILE.py is at the same path on all",
    )
    sweeping.set_defaults(function=sweep.run)

    playing = commands.add_parser("play", help="shows a recording, in a page that needs no server")
    playing.add_argument(
        "file", type=Path, metavar="FILE.iota|DIR", help="made by iota record -o, iota run --record or --keep"
    )
    playing.add_argument("-o", "--output", type=Path, metavar="FILE.html", help="name of the page")
    playing.add_argument("--no-open", action="store_true", help="do not open it in a browser")
    playing.set_defaults(function=play.play)

    telling = commands.add_parser("info", help="tells about a journal of iota run --keep")
    telling.add_argument("directory", type=Path, metavar="DIR")
    telling.add_argument("--json", action="store_true", help="print one JSON object")
    telling.set_defaults(function=info.info)

    token = commands.add_parser("token", help="prints the secret in the page's address, or makes a new one")
    token.add_argument(
        "--renew", action="store_true", help="make a new one: earlier addresses are refused from then on"
    )
    token.set_defaults(function=run.token)

    importing = commands.add_parser("import", help="reads a molecule, polyhedron or mechanism and lists its content")
    importing.add_argument("source", metavar="FILE|NAME|smiles:TEXT")
    importing.add_argument("--kind", choices=["rigid", "soft", "flexible"], help="of molecules and polyhedra")
    importing.add_argument("--scale", type=positive, help="m for an angstrom (molecules) or for a unit of the file")
    importing.add_argument("--json", action="store_true", help="print counts and notes as one JSON object")
    importing.add_argument("--save", metavar="FILE.json", help="write the structure, see docs/builder.md")
    importing.add_argument("--show", action="store_true", help="serve a page where it can be grabbed")
    importing.add_argument("--port", type=port, help="of the page; 0 for any free one (default: 8080)")
    importing.set_defaults(function=imports.run)

    benching = commands.add_parser("bench", help="measures the engine through Python")
    benching.add_argument("what", choices=["chain", "forces"])
    benching.add_argument("--links", type=link_count, nargs="+", default=list(bench.LINKS), help="chain lengths")
    benching.add_argument("--json", action="store_true", help="print one JSON object instead of a table")
    benching.set_defaults(function=lambda a: (bench_forces if a.what == "forces" else bench).run(a))

    verifying = commands.add_parser("verify", help="compares the engine with exact and independent results")
    verifying.add_argument("--list", action="store_true", help="print the names of the verifications")
    verifying.add_argument("--figure", metavar="NAME", nargs="+", help="only these")
    scale = verifying.add_mutually_exclusive_group()
    scale.add_argument("--quick", action="store_const", dest="scale", const="quick", help="smaller sizes, seconds")
    scale.add_argument("--long", action="store_const", dest="scale", const="long", help="longer runs, many minutes")
    verifying.set_defaults(scale="full")
    verifying.add_argument(
        "--out", metavar="FOLDER", help="folder for page and figures (default: docs; none for --quick, --long)"
    )
    verifying.set_defaults(function=verify.run)
    return parser


def _stop(number: int, frame: FrameType | None) -> None:
    raise KeyboardInterrupt


def main(arguments: Sequence[str] | None = None) -> int:
    """Returns the exit code: 0, 1 for failures, 2 for wrong arguments."""
    signal.signal(signal.SIGINT, signal.default_int_handler)  # see iota.starting
    signal.signal(signal.SIGTERM, _stop)  # `kill` ends a server as cleanly as Ctrl-C
    hang_up = getattr(signal, "SIGHUP", None)  # a terminal that closes, too, but not under nohup
    if hang_up is not None and signal.getsignal(hang_up) is not signal.SIG_IGN:
        signal.signal(hang_up, _stop)
    parsed = make_parser().parse_args(arguments)
    try:
        parsed.function(parsed)
    except Failure as failure:
        print(plain(f"iota: {failure}"), file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        print("iota: interrupted", file=sys.stderr)
        return 130
    except BrokenPipeError:  # `iota list | head`
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0
    return 0
