# SPDX-License-Identifier: Apache-2.0
"""Films of a world: `iota record`. Needs the extra `iota-worlds[film]` and a Chromium (docs/films.md)."""

from iota.arguments import explain_module
from iota.film.files import Failed
from iota.film.record import Film, record
from iota.film.stream import pack, player, unpack

__all__ = ["Failed", "Film", "pack", "player", "record", "unpack"]

explain_module(__name__)
