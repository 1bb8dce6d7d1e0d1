# SPDX-License-Identifier: Apache-2.0
"""`iota play`: shows a recording of `iota record -o FILE.iota` or `iota run --record FILE.iota`, or the last seconds
of a journal, in a page that needs no server."""

from __future__ import annotations

import argparse
import sys
import tempfile
import webbrowser
from pathlib import Path

from iota.cli import info
from iota.cli.failure import Failure
from iota.errors import PageMissingError
from iota.film import Failed, pack, player, unpack
from iota.film.journal import messages_of
from iota.film.stream import check_version, read_file
from iota.saving import replacing

ENDS_EARLY = "ends early: its first {:.1f} s are played"
NEEDS_SCRIPT = "stands still where forces of its script are needed, until the next snapshot"


def play(arguments: argparse.Namespace) -> None:
    """Makes the page in the system's temporary folder, or at the path of -o, and opens it."""
    source: Path = arguments.file
    target = arguments.output or Path(tempfile.gettempdir()) / f"iota-{source.stem}.html"
    if target.suffix.lower() != ".html":
        raise Failure(f"{target} must end in .html")
    try:
        if source.is_dir():
            messages, is_complete = messages_of(info.read(source))
            file = pack(messages)
        else:
            file = read_file(source)
            messages, is_complete = unpack(file)
        check_version(messages)
        with replacing(target) as fresh:
            fresh.write_text(player(file if is_complete else pack(messages), source.stem), encoding="utf-8")
    except Failed as failed:
        raise Failure(f"{source} cannot be played: {failed}") from None
    except PageMissingError as error:
        raise Failure(str(error)) from None
    except OSError as error:
        raise Failure(str(error) if error.filename is None else f"{source}: {error.strerror}") from None
    if not is_complete:
        print(
            f"iota: {source} {NEEDS_SCRIPT if source.is_dir() else ENDS_EARLY.format(messages[-1][0])}", file=sys.stderr
        )
    print(target)
    if not arguments.no_open:
        webbrowser.open(target.resolve().as_uri())
