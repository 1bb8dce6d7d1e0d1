# SPDX-License-Identifier: Apache-2.0
"""Films of a world: `iota record`. Needs the extra `iota-worlds[film]` and a Chromium (docs/films.md)."""

from iota.arguments import explain_module
from iota.film.files import Failed
from iota.film.record import Film, record
from iota.film.stream import check_version, pack, player, read_file, unpack

__all__ = ["Failed", "Film", "check_version", "pack", "player", "read_file", "record", "unpack"]

explain_module(__name__)
