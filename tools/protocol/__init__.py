# SPDX-License-Identifier: Apache-2.0
"""Generates the C++, Python and TypeScript sides of the protocol; see tools/generate_protocol.py."""

from __future__ import annotations

from pathlib import Path


def fragment(name: str) -> str:
    """Text of a file in this folder that is copied into the generated code."""
    text = (Path(__file__).parent / name).read_text(encoding="utf-8").rstrip("\n")
    # Every source file names its license; the generated file has that line once, from its head.
    return text if name.startswith("head.") else text.removeprefix("// SPDX-License-Identifier: Apache-2.0\n")
