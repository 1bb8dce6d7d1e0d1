# SPDX-License-Identifier: Apache-2.0
"""Worked studies: each module has a docstring, `build(...) -> World`, and runs by `iota run NAME`."""

from __future__ import annotations

import pkgutil


def names() -> list[str]:
    """The names that `iota run` takes, sorted."""
    return sorted(module.name for module in pkgutil.iter_modules(__path__) if not module.name.startswith("_"))
