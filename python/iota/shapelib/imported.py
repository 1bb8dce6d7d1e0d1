# SPDX-License-Identifier: Apache-2.0
"""What an importer gives: a structure, and what became of the file."""

from __future__ import annotations

from dataclasses import dataclass, field

from iota.builder import Structure


@dataclass
class Imported(Structure):
    """A structure that was read from a file or computed from a name. counts: of what the source holds, such as atoms
    and bonds. notes: one sentence for each thing that was changed or left out."""

    title: str = ""
    counts: dict[str, int | float | str] = field(default_factory=dict)
    notes: list[str] = field(default_factory=list)
