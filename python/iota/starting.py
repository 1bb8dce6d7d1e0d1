# SPDX-License-Identifier: Apache-2.0
"""Makes Ctrl-C during the start of the command line end with one line, not with a traceback. Imported first; `iota.cli`
takes over."""

from __future__ import annotations

import os
import signal
import sys
from types import FrameType


def _leave(number: int, frame: FrameType | None) -> None:
    os.write(2, b"iota: interrupted\n")
    os._exit(130)


# Python sets "-m" while it imports the package for `python -m iota`.
if os.path.basename(getattr(sys, "argv", [""])[0]) in ("iota", "-m"):
    signal.signal(signal.SIGINT, _leave)
