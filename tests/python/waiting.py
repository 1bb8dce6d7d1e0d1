# SPDX-License-Identifier: Apache-2.0
"""How tests wait for what happens in another thread or process: for the event itself, as long as a busy machine may need."""

from __future__ import annotations

import time
from collections.abc import Callable

PATIENCE = 60.0  # s


def wait_until(condition: Callable[[], object], seconds: float = PATIENCE) -> None:
    """Until the condition holds. It ends a test that hangs, and measures no speed."""
    end = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < end, f"waited {seconds} s in vain"
        time.sleep(0.01)
