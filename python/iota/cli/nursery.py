# SPDX-License-Identifier: Apache-2.0
"""The process of `iota.rooms.nursery`, with the command line that its copies run. What they need is loaded once, for all of them."""

from __future__ import annotations

import socket
import sys

from iota import builder, studies
from iota.cli.main import main as command_line
from iota.journal import reader, writer
from iota.rooms import nursery, room

assert all((builder, studies, reader, writer, room))


def main() -> None:
    nursery.serve(socket.socket(fileno=int(sys.argv[1])), command_line)
