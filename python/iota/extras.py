# SPDX-License-Identifier: Apache-2.0
"""The optional packages of pyproject.toml, and how to install them."""

from __future__ import annotations

import sys
from pathlib import Path

# The name that pip knows, as in pyproject.toml. On PyPI, `iota` is a project of other people.
DISTRIBUTION = "iota-worlds"
SOURCES = Path(__file__).resolve().parents[2]  # of a checkout; an installed wheel has no tools/ there


def how_to_get(extra: str) -> str:
    """The end of a message about a missing package: "Try: " and the command that installs it.

    In a checkout, pip does not know the extras, so the command names the file of requirements and this Python.
    """
    requirements = SOURCES / "tools" / f"requirements-{extra}.txt"
    if not requirements.is_file():
        return f"Try: pip install '{DISTRIBUTION}[{extra}]'"
    return f"Try: {_from_here(Path(sys.executable))} -m pip install -r {_from_here(requirements)}"


def _from_here(path: Path) -> Path:
    """The path as one types it in the current folder."""
    here = Path.cwd()
    return path.relative_to(here) if path.is_relative_to(here) else path
