# SPDX-License-Identifier: Apache-2.0
"""From file to world: molecules, polyhedra and mechanisms as structures of `iota.builder`.

    import iota.shapelib

    caffeine = iota.shapelib.molecule("caffeine.sdf", kind="soft", at=(0, 2, 0))
    caffeine.realize(system)

Some formats need the extra `iota-worlds[shapelib]`. docs/shapelib.md is the tutorial.
"""

from iota.arguments import explain_module
from iota.shapelib.files import FileError
from iota.shapelib.imported import Imported
from iota.shapelib.mechanisms import mechanism
from iota.shapelib.molecules import molecule
from iota.shapelib.named import polyhedron_names
from iota.shapelib.opening import load
from iota.shapelib.polyhedra import polyhedron
from iota.shapelib.surface_files import read_model, read_surface

__all__ = [
    "FileError",
    "Imported",
    "load",
    "mechanism",
    "molecule",
    "polyhedron",
    "polyhedron_names",
    "read_model",
    "read_surface",
]

explain_module(__name__)
