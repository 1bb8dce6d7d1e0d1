# SPDX-License-Identifier: Apache-2.0
"""How much a test tries that samples (random edits, cuts, damaged bytes); tests/cpp/amount.h is the same in C++."""

from __future__ import annotations

import os

TRIES_ALL = bool(os.environ.get("IOTA_TEST_ALL"))  # as set by `make test-all`


def sampled(everything: int) -> int:
    """`everything` where all is tried; else a tenth, with the same seeds from the first on."""
    return everything if TRIES_ALL else everything // 10
