# SPDX-License-Identifier: Apache-2.0
"""Access to RDKit: the periodic table, and reading with its messages as text."""

from __future__ import annotations

import logging
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from typing import Any, NamedTuple

from iota.extras import how_to_get

Color = tuple[float, float, float]

# The colors of Corey, Pauling and Koltun, as in most programs.
COLORS: dict[str, Color] = {
    "H": (0.95, 0.95, 0.95), "C": (0.25, 0.25, 0.27), "N": (0.15, 0.3, 0.9), "O": (0.9, 0.1, 0.1),
    "F": (0.35, 0.85, 0.3), "Cl": (0.2, 0.8, 0.2), "Br": (0.6, 0.15, 0.1), "I": (0.45, 0.1, 0.6),
    "S": (0.95, 0.8, 0.15), "P": (1.0, 0.55, 0.1), "B": (1.0, 0.7, 0.6), "Fe": (0.85, 0.4, 0.15),
}  # fmt: skip
# mass in dalton, covalent radius in angstrom (Cordero et al., Dalton Trans. 2008), so that common ones need no RDKit.
USUAL: dict[str, tuple[float, float]] = {
    "H": (1.008, 0.31), "B": (10.81, 0.84), "C": (12.011, 0.76), "N": (14.007, 0.71), "O": (15.999, 0.66),
    "F": (18.998, 0.57), "Na": (22.990, 1.66), "Mg": (24.305, 1.41), "Si": (28.085, 1.11), "P": (30.974, 1.07),
    "S": (32.06, 1.05), "Cl": (35.45, 1.02), "K": (39.098, 2.03), "Ca": (40.078, 1.76), "Fe": (55.845, 1.32),
    "Zn": (65.38, 1.22), "Br": (79.904, 1.20), "I": (126.904, 1.39),
}  # fmt: skip
OTHERS: Color = (0.8, 0.45, 0.75)


class Element(NamedTuple):
    """mass in dalton, radii in angstrom."""

    symbol: str
    mass: float
    bond_radius: float
    color: Color


def rdkit() -> Any:
    """`rdkit.Chem`. Raises ImportError that says how to get it."""
    try:
        from rdkit import Chem
    except ImportError:
        raise ImportError(f"molecules need RDKit. {how_to_get('shapelib')}") from None
    return Chem


@cache
def element(symbol: str) -> Element | None:
    """By its symbol in any letter case, None if there is no such element. Deuterium is hydrogen of mass 2."""
    name = symbol.strip().capitalize()
    if name in ("D", "T"):
        return Element("H", {"D": 2.014, "T": 3.016}[name], 0.31, COLORS["H"])
    if name in USUAL:
        return Element(name, *USUAL[name], COLORS.get(name, OTHERS))
    if not name.isalpha() or len(name) > 2 or name not in _symbols():
        return None
    table = rdkit().GetPeriodicTable()
    return Element(name, table.GetAtomicWeight(name), table.GetRcovalent(name), COLORS.get(name, OTHERS))


@cache
def isotope(known: Element, number: int) -> Element:
    """The element with the mass of its isotope with this mass number."""
    mass = rdkit().GetPeriodicTable().GetMassForIsotope(known.symbol, number)
    return known._replace(mass=mass or float(number))


@cache
def _symbols() -> frozenset[str]:
    table = rdkit().GetPeriodicTable()
    return frozenset(table.GetElementSymbol(number) for number in range(1, 119))


class _Kept(logging.Handler):
    def __init__(self) -> None:
        super().__init__()
        self.texts: list[str] = []

    def emit(self, record: logging.LogRecord) -> None:
        self.texts.append(record.getMessage().strip())


@contextmanager
def complaints() -> Iterator[list[str]]:
    """Collects messages of RDKit instead of printing them."""
    from rdkit import rdBase

    kept, logger = _Kept(), logging.getLogger("rdkit")
    before = logger.propagate, logger.level, logger.handlers
    logger.propagate, logger.handlers = False, [kept]
    logger.setLevel(logging.WARNING)
    rdBase.LogToPythonLogger()
    try:
        yield kept.texts
    finally:
        rdBase.LogToCppStreams()
        logger.propagate, logger.level, logger.handlers = before
