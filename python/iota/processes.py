# SPDX-License-Identifier: Apache-2.0
"""Child processes that end in time."""

from __future__ import annotations

import subprocess
from typing import Protocol


class Child(Protocol):
    """As `subprocess.Popen`."""

    def wait(self, timeout: float | None = None) -> int: ...

    def kill(self) -> None: ...


def wait_or_kill(process: Child, seconds: float) -> None:
    """After a process was asked to end: one that hangs is killed."""
    try:
        process.wait(seconds)
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()
