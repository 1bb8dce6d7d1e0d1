# SPDX-License-Identifier: Apache-2.0
"""The folder of the built page, and the token that browsers need."""

from __future__ import annotations

import hashlib
import hmac
import shutil
import tempfile
from pathlib import Path

from iota._core import kept_token, make_token
from iota.errors import PageMissingError


def page_folder() -> Path:
    """The folder with the page's index.html: inside the package, or in the repository's build."""
    package = Path(__file__).resolve().parent.parent
    candidates = [package / "page", package.parent.parent / "web" / "dist"]
    for folder in candidates:
        if (folder / "index.html").is_file():
            return folder
    raise PageMissingError(f"the page is not built: there is no {candidates[0] / 'index.html'}. Try: make build")


def page_copy(index: str) -> tempfile.TemporaryDirectory[str]:
    """A copy of the page's folder with another of its pages as index.html, and the page of a world as world.html."""
    folder = tempfile.TemporaryDirectory(prefix="iota-page-")
    target = Path(folder.name)
    for file in page_folder().rglob("*"):
        place = target / file.relative_to(page_folder())
        if file.is_dir():
            place.mkdir()
            continue
        for name, other in (("index.html", "world.html"), (index, "index.html")):
            if file.name.startswith(name):
                place = target / file.name.replace(name, other)
                break
        shutil.copyfile(file, place)
    return folder


def token() -> str:
    """The secret in the page's address, kept in $XDG_STATE_HOME/iota or ~/.local/state/iota with mode 0600, so that
    open pages can reconnect to a restarted server; a new one each time if that cannot be written."""
    try:
        return kept_token()
    except OSError:
        return make_token()


def token_for(role: str, token: str) -> str:
    """The secret for a role, made of that of the host: it lasts as long, and does not tell that one."""
    return hmac.new(token.encode(), role.encode(), hashlib.sha256).hexdigest()[:32]
