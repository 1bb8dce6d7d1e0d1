# SPDX-License-Identifier: Apache-2.0
"""Opens a source of any kind."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

from iota.shapelib.files import FileError, PathLike
from iota.shapelib.imported import Imported
from iota.shapelib.mechanisms import ENDINGS, mechanism
from iota.shapelib.molecule_files import READERS as MOLECULES
from iota.shapelib.molecules import molecule
from iota.shapelib.polyhedra import polyhedron
from iota.shapelib.surface_files import READERS as SURFACES


def load(source: PathLike, **options: Any) -> Imported:
    """A structure from a file by its ending: a molecule, a polyhedron or a mechanism; from the name of a polyhedron, or from a
    SMILES string after "smiles:". options: of `molecule`, `polyhedron` or `mechanism`. Raises as they do.

        iota.shapelib.load("caffeine.sdf", kind="flexible")
        iota.shapelib.load("J27")
        iota.shapelib.load("smiles:CCO")
    """
    if not os.fspath(source):
        raise ValueError("a source must be named: a file, a polyhedron, or smiles: and a text")
    ending = Path(source).suffix.lower()
    if isinstance(source, str) and source.lower().startswith("smiles:"):
        return molecule(source[len("smiles:") :], **options)
    if ending in MOLECULES:
        return molecule(source, **options)
    if ending in ENDINGS:
        return mechanism(source, **options)
    if ending in SURFACES or (isinstance(source, str) and not ending and not os.path.exists(source)):
        return polyhedron(source, **options)
    known = ", ".join([*MOLECULES, *SURFACES, *ENDINGS])
    raise FileError(source, f"files that end in {ending or 'nothing'!r} are not read; these are: {known}")
