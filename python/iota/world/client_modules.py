# SPDX-License-Identifier: Apache-2.0
"""JavaScript modules of a script, which its page loads."""

from __future__ import annotations

import secrets
import shutil
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from urllib.parse import quote

from iota.world.page import page_folder

MOST_BYTES = 4 << 20
FOLDER = "modules"  # of the page


def add_module(modules: list[Path], file: Path) -> None:
    """Raises FileNotFoundError, and ValueError for a file that is not a module or whose name is taken."""
    found = file if file.is_absolute() else script_folder() / file
    if file.suffix not in (".js", ".mjs"):
        raise ValueError(f"a client module must end in .js or .mjs, not {file.name!r}")
    if not found.is_file():
        raise FileNotFoundError(f"there is no client module {found}")
    if found.stat().st_size > MOST_BYTES:
        raise ValueError(f"the client module {found} has more than {MOST_BYTES >> 20} MiB")
    if any(other.name == found.name and other != found for other in modules):
        raise ValueError(f"there is a client module {found.name!r} already")
    if found not in modules:
        modules.append(found)


def script_folder() -> Path:
    """The folder of the running script; the current folder in a notebook or at a prompt."""
    file = getattr(sys.modules.get("__main__"), "__file__", None)
    return Path.cwd() if file is None else Path(file).resolve().parent


@contextmanager
def page_with(modules: Sequence[Path]) -> Iterator[tuple[Path, list[str]]]:
    """A copy of the built page with these modules, and their paths in it, which nobody can guess: the server tells them to
    its clients. Removed at the end."""
    with TemporaryDirectory(prefix="iota-page-") as made:
        folder = Path(made, "page")
        shutil.copytree(page_folder(), folder)
        secret = f"{FOLDER}/{secrets.token_hex(16)}"
        (folder / secret).mkdir(parents=True)
        for module in modules:
            shutil.copy(module, folder / secret / module.name)
        yield folder, [f"{secret}/{quote(module.name)}" for module in modules]
