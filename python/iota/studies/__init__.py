# SPDX-License-Identifier: Apache-2.0
"""Worked studies: each module has a docstring, `build(...) -> World`, and runs by `iota run NAME`."""

from __future__ import annotations

import importlib
import inspect
import pkgutil
from pathlib import Path
from types import ModuleType

PICTURES = Path(__file__).with_name("pictures")  # a thumbnail of each, NAME.jpg, made by tools/make_films.py


def names() -> list[str]:
    """The names that `iota run` takes, sorted."""
    modules = (module.name for module in pkgutil.iter_modules(__path__) if not module.name.startswith("_"))
    return sorted(name.replace("_", "-") for name in modules)


def module(name: str) -> ModuleType:
    """The module of a study: `soft-molecule` is soft_molecule.py."""
    return importlib.import_module(f"{__name__}.{name.replace('-', '_')}")


def description(name: str) -> str:
    """The first line of a study's docstring."""
    return (inspect.getdoc(module(name)) or "").partition("\n")[0]
