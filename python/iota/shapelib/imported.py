# SPDX-License-Identifier: Apache-2.0
"""The result of an importer: a structure, and notes on the file."""

from __future__ import annotations

from dataclasses import dataclass, field

from iota.builder import Structure


@dataclass
class Imported(Structure):
    """A structure that was read from a file or computed from a name. counts: of items in the source, such as atoms and
    bonds. notes: one sentence for each change or omission."""

    title: str = ""
    counts: dict[str, int | float | str] = field(default_factory=dict)
    notes: list[str] = field(default_factory=list)
