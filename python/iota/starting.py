# SPDX-License-Identifier: Apache-2.0
"""Makes Ctrl-C during the start of the command line end with one line, not with a traceback, and numpy start no threads for it.
Imported first; `iota.cli` takes over."""

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
    # Threads of numpy's linear algebra wait busily for work: up to 0.1 s of a start on two cores, and a script's product of matrices
    # takes ten times as long while other processes compute.
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
