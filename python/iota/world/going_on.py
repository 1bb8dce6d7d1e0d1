# SPDX-License-Identifier: Apache-2.0
"""The question whether a kept world goes on where it was, with a drawing of it, for those who start it in a terminal."""

from __future__ import annotations

import os
import select
import shutil
import sys
from contextlib import suppress

from iota._core import System
from iota.journal.reader import Found
from iota.world.braille import drawing
from iota.world.callbacks import plain

WAIT = 10.0  # s, after which the world goes on: nobody may be there
COLUMNS, ROWS = 72, 16  # of the drawing, at most


def ask_to_go_on(found: Found) -> bool:
    """True without an answer, where nobody can be asked, and for a state that this version cannot read."""
    if not (is_open_terminal(sys.stdin) and is_open_terminal(sys.stderr) and is_in_foreground()):
        return True
    system = System()
    try:
        system.restore(found.snapshot)
    except ValueError:
        return True
    columns, rows = shutil.get_terminal_size()
    title, time = found.header.get("title", ""), found.end or system.time
    print(*drawing(system, min(columns, COLUMNS), min(rows - 3, ROWS)), sep="\n", file=sys.stderr)
    question = f"iota: {title}, t = {time:.2f} s, {people_in(found)}. Go on where it was? [Y/n] (yes in {WAIT:g} s) "
    print(plain(question), end="", file=sys.stderr, flush=True)
    with suppress(OSError, ValueError):  # no select on Windows
        if select.select([sys.stdin], [], [], WAIT)[0]:
            return not sys.stdin.readline().strip().lower().startswith("n")
    print(file=sys.stderr)
    return True


def people_in(found: Found) -> str:
    """ "2 people" """
    people = found.world.get("people")
    count = len(people) if isinstance(people, list) else 0
    return f"{count} {'person' if count == 1 else 'people'}"


def is_in_foreground() -> bool:
    """Whether what is typed is for this process: one that is started with & would be stopped as it reads."""
    try:
        return os.tcgetpgrp(sys.stdin.fileno()) == os.getpgrp()
    except (OSError, AttributeError):  # a terminal that controls no processes; Windows
        return True


def is_open_terminal(stream: object) -> bool:
    with suppress(OSError, ValueError, AttributeError):  # closed, none
        return bool(stream.isatty())  # type: ignore[attr-defined]
    return False
