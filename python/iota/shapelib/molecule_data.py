# SPDX-License-Identifier: Apache-2.0
"""A molecule as data, and the perception of bonds for files without them."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from iota.shapelib.chemistry import Element
from iota.shapelib.files import FileError, PathLike
from iota.shapelib.nearest import TooManyPairsError, near_pairs

if TYPE_CHECKING:
    from numpy.typing import NDArray

MOST_ATOMS = 100_000
SLACK = 0.45  # angstrom, by which a bond may be longer than the sum of its radii
COLLIDING = 0.4  # angstrom: less than the distance of any two nuclei
DRAWN = 0.01  # angstrom: less than that of any two atoms in a drawing


@dataclass
class Molecule:
    """Atoms and bonds. position: (n, 3), angstrom. bonds: (k, 2). orders: (k,), 1.5 for aromatic ones, 1 if unknown.
    names: for messages, such as "CA of ARG 27". charge: of all atoms, elementary charges. is_plane: the coordinates are those of a
    drawing."""

    title: str
    elements: list[Element]
    position: NDArray[np.float64]
    bonds: NDArray[np.int64]
    orders: NDArray[np.float64]
    names: list[str] = field(default_factory=list)
    residues: int = 0
    notes: list[str] = field(default_factory=list)
    charge: int = 0
    is_plane: bool = False

    def formula(self) -> str:
        """C and H first, then the others by name (Hill 1900)."""
        count = Counter(element.symbol for element in self.elements)
        first = [symbol for symbol in ("C", "H") if "C" in count and symbol in count]
        listed = first + sorted(count.keys() - set(first))
        return "".join(symbol + (str(count[symbol]) if count[symbol] > 1 else "") for symbol in listed)


def check_count(count: int, path: PathLike, line: int | None = None) -> None:
    """Raises FileError for more atoms than can be simulated."""
    if count > MOST_ATOMS:
        raise FileError(path, f"has more than {MOST_ATOMS} atoms; cut out what you need", line)


def check_places(molecule: Molecule, path: PathLike) -> None:
    """Raises FileError if two atoms coincide; in a drawing, atoms may be near each other."""
    least = DRAWN if molecule.is_plane else COLLIDING
    if not len(molecule.elements):
        raise FileError(path, "has no atoms")
    try:
        pairs, distances = near_pairs(molecule.position, least)
    except TooManyPairsError:
        raise FileError(path, f"nearly all of its atoms are within {least} angstrom of many others") from None
    except ValueError as error:
        raise FileError(path, str(error)) from None
    if len(pairs):
        (p, q), distance = pairs[0].tolist(), distances[0]
        more = f", and {len(pairs) - 1} more such pairs" if len(pairs) > 1 else ""
        name = molecule.names or [f"{e.symbol}{number}" for number, e in enumerate(molecule.elements, 1)]
        raise FileError(path, f"the atoms {name[p]} and {name[q]} are {distance:.3g} angstrom apart{more}")


def perceive_bonds(elements: list[Element], position: NDArray[np.float64]) -> NDArray[np.int64]:
    """Bonds between atoms with a distance of at most the sum of their covalent radii and a slack; hydrogen only to its
    nearest atom. (k, 2)"""
    radius = np.array([element.bond_radius for element in elements])
    pairs, distances = near_pairs(position, 2 * radius.max() + SLACK)
    is_bond = distances < radius[pairs[:, 0]] + radius[pairs[:, 1]] + SLACK
    pairs, distances = pairs[is_bond], distances[is_bond]
    is_hydrogen = np.array([element.symbol == "H" for element in elements])
    keep = np.ones(len(pairs), bool)
    taken: set[int] = set()
    for number in np.argsort(distances, kind="stable").tolist():
        ends = [end for end in pairs[number].tolist() if is_hydrogen[end]]
        keep[number] = not taken.intersection(ends)
        if keep[number]:
            taken.update(ends)
    kept: NDArray[np.int64] = pairs[keep]
    return kept
