# SPDX-License-Identifier: Apache-2.0
"""What a change of a public header compiles anew."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "tools"))

import count_includes


def test_a_public_header_is_read_by_at_most_a_third_of_the_engine_except_those_of_records() -> None:
    total, by_name = count_includes.counts()
    assert set(by_name) > count_includes.EVERYWHERE
    wide = {name for name, number in by_name.items() if number > count_includes.LARGEST_SHARE * total}
    assert wide <= count_includes.EVERYWHERE, "see tools/count_includes.py NAME"
