# SPDX-License-Identifier: Apache-2.0
"""Ctrl-C while the command line starts is one line, not a traceback out of some import. Imported first; `iota.cli` takes over."""

from __future__ import annotations

import os
import signal
import sys
from types import FrameType


def _leave(number: int, frame: FrameType | None) -> None:
    os.write(2, b"iota: interrupted\n")
    os._exit(130)


# "-m" is what Python says while it imports the package for `python -m iota`.
if os.path.basename(getattr(sys, "argv", [""])[0]) in ("iota", "-m"):
    signal.signal(signal.SIGINT, _leave)
