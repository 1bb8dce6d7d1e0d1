# SPDX-License-Identifier: Apache-2.0
"""How much a test tries that samples (random edits, cuts, damaged bytes); tests/cpp/amount.h is the same in C++."""

from __future__ import annotations

import os


def sampled(everything: int) -> int:
    """Where IOTA_TEST_ALL is set, as by `make test-all`, `everything`; else a tenth, with the same seeds from the first on."""
    return everything if os.environ.get("IOTA_TEST_ALL") else everything // 10
