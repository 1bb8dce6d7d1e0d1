# SPDX-License-Identifier: Apache-2.0
"""Molecules as structures: rigid, soft, or rigid with rotatable bonds."""

from __future__ import annotations

import math
import os
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from iota import looks
from iota.builder.parts import RigidBody
from iota.builder.points import Vector
from iota.colors import ColorLike, rgba
from iota.shapelib.apart import apart
from iota.shapelib.files import PathLike, check_reach
from iota.shapelib.graphs import bridges, pieces
from iota.shapelib.imported import Imported
from iota.shapelib.molecule_data import Molecule
from iota.shapelib.molecule_files import READERS, parse_smiles, read_molecule

if TYPE_CHECKING:
    from numpy.typing import NDArray

Kind = Literal["rigid", "soft", "flexible"]
AtomLook = Callable[[str], tuple[float, ColorLike]]

KINDS = ("rigid", "soft", "flexible")
BALL = 0.45  # of the covalent radius: a ball-and-stick model
STICK = 0.12  # angstrom, radius
ANGLE = 0.1  # stiffness between the ends of an angle, relative to that of a bond
UNDRAWN = "energy = 0.5*k*(r - r0)^2; force = -c*v"  # a spring that pages do not show
SAG = 0.1  # stretch of one bond under the total weight, relative to its length


def molecule(
    source: PathLike,
    kind: Kind = "rigid",
    *,
    scale: float = 0.1,
    mass_scale: float = 0.001,
    at: Vector = (0.0, 0.0, 0.0),
    stiffness: float | None = None,
    damping: float = 0.05,
    atom_look: AtomLook | None = None,
    seed: int = 1,
) -> Imported:
    """A molecule from a file that ends in .pdb, .ent, .sdf, .mol, .xyz, .cif, .mmcif or .smi, or from a SMILES string.

    Its points are the atoms, in the order of the source. kind: "rigid", each connected piece is one body, its bonds are
    cosmetic; "soft", each atom is a body, bonds are springs, and weaker springs hold the angles between them; "flexible",
    rigid pieces that turn about the single bonds outside of rings (two hinges each, so that angles and lengths are exact).

    scale: m for an angstrom; by default a nanometer is 1 m. mass_scale: kg for a dalton. at: place of the center of
    mass, m. stiffness: of a bond of kind "soft", N/m; None: the total weight stretches one bond by a tenth. damping:
    damping ratio. atom_look: takes the symbol of an element, returns radius (m) and color.
    seed: for the shape of a SMILES. Raises `FileError` (a ValueError) that names file and line, ValueError for SMILES,
    ImportError without RDKit.

        caffeine = iota.shapelib.molecule("CN1C=NC2=C1C(=O)N(C(=O)N2C)C", kind="soft", at=(0, 2, 0))
    """
    structure, symbols = _read(source, kind, scale, mass_scale, at, stiffness, damping, seed)
    if atom_look is not None:
        _draw(structure, symbols, atom_look)
    return structure


@apart()
def _read(
    source: PathLike,
    kind: Kind,
    scale: float,
    mass_scale: float,
    at: Vector,
    stiffness: float | None,
    damping: float,
    seed: int,
) -> tuple[Imported, list[str]]:
    """The structure, and the symbol of each atom."""
    if kind not in KINDS:
        raise ValueError(f"kind must be one of {', '.join(KINDS)}, not {kind!r}")
    for name, value in (("scale", scale), ("mass_scale", mass_scale)):
        if not 0 < value < math.inf:
            raise ValueError(f"{name} must be above 0, not {value}")
    data = read_molecule(source) if is_file(source) else parse_smiles(os.fspath(source), seed)
    structure = Imported(title=data.title, notes=data.notes)
    mass = np.array([element.mass for element in data.elements]) * mass_scale
    place = data.position * scale
    place += np.asarray(at, float) - mass @ place / mass.sum()
    check_reach(place, source)
    structure.points.add(place, mass)
    symbols = [element.symbol for element in data.elements]
    _draw(structure, symbols, lambda symbol: ball_of(symbol, scale))
    structure.looks["bond"] = looks.capsule(STICK * scale, "paint", color="#9a9aa0")
    piece = pieces(len(mass), data.bonds)
    structure.counts = {
        "atoms": len(mass), "bonds": len(data.bonds), "pieces": int(piece.max()) + 1, "residues": data.residues,
        "formula": data.formula(),
    }  # fmt: skip
    if data.charge:
        structure.counts["charge"] = data.charge
    if kind == "rigid":
        _add_bodies(structure, piece, data.bonds)
    elif kind == "flexible":
        _make_flexible(structure, data)
    else:
        add_springs(structure, data.bonds, stiffness, damping)
    return structure, symbols


def _draw(structure: Imported, symbols: list[str], look: AtomLook) -> None:
    """The atoms, which are the first points."""
    drawn = {symbol: look(symbol) for symbol in set(symbols)}
    structure.points.radius[: len(symbols)] = [drawn[symbol][0] for symbol in symbols]
    structure.points.color[: len(symbols)] = [rgba(drawn[symbol][1])[:3] for symbol in symbols]


def is_file(source: PathLike) -> bool:
    """Whether it names a file rather than a SMILES: it exists, or has the ending of one."""
    if not isinstance(source, str):
        return True
    return Path(source).suffix.lower() in READERS or os.path.exists(source)


def ball_of(symbol: str, scale: float) -> tuple[float, tuple[float, float, float]]:
    """Radius (m) and color of an atom in a ball-and-stick model."""
    from iota.shapelib.chemistry import element

    known = element(symbol)
    assert known is not None
    return BALL * known.bond_radius * scale, known.color


def _add_bodies(structure: Imported, body_of: NDArray[np.int64], bonds: NDArray[np.int64]) -> None:
    """A body for each number in `body_of`; bonds within one are cosmetic. A single atom is a body by default."""
    order = np.argsort(body_of, kind="stable")
    for members in np.split(order, np.flatnonzero(np.diff(body_of[order])) + 1):
        if len(members) > 1:
            structure.bodies.append(RigidBody(members.tolist(), look="bond"))
    within = body_of[bonds[:, 0]] == body_of[bonds[:, 1]]
    structure.lines += [(p, q) for p, q in bonds[within].tolist()]


def rotatable(data: Molecule) -> NDArray[np.bool_]:
    """Rotatable bonds: single, in no ring, not terminal, and not of an amide, which is flat because of its partial
    double bond. (k,)"""
    degree = np.bincount(data.bonds.ravel(), minlength=len(data.elements))
    turns = bridges(len(data.elements), data.bonds) & (data.orders == 1) & (degree[data.bonds] > 1).all(axis=1)
    symbols = [element.symbol for element in data.elements]
    carbonyl = {
        atom
        for pair, order in zip(data.bonds.tolist(), data.orders, strict=True)
        if order == 2 and {symbols[pair[0]], symbols[pair[1]]} == {"C", "O"}
        for atom in pair
        if symbols[atom] == "C"
    }
    for number in np.flatnonzero(turns):
        p, q = data.bonds[number].tolist()
        turns[number] = not any(a in carbonyl and symbols[b] == "N" for a, b in ((p, q), (q, p)))
    return np.asarray(turns, bool)


def _make_flexible(structure: Imported, data: Molecule) -> None:
    """Each piece between rotatable bonds has copies of the atoms beyond them: two hinges are the axis of rotation. An
    atom and its copies coincide and share its mass evenly, which does not change the motion."""
    turns = rotatable(data)
    count = len(structure.points)
    body_of = pieces(count, data.bonds[~turns])
    axes = data.bonds[turns]
    copies: dict[int, list[int]] = {}
    shares: list[list[int]] = [[atom] for atom in range(count)]
    places = structure.points.position.copy()
    for p, q in axes.tolist():
        for own, beyond in ((p, q), (q, p)):
            copy = structure.points.add(places[beyond], 0.0)[0]
            shares[beyond].append(copy)
            copies.setdefault(int(body_of[own]), []).append(copy)
            structure.hinges.append((beyond, copy))
            structure.lines.append((own, copy))
    for atom in np.unique(axes).tolist():
        structure.points.mass[shares[atom]] = structure.points.mass[atom] / len(shares[atom])
    order = np.argsort(body_of, kind="stable")
    for members in np.split(order, np.flatnonzero(np.diff(body_of[order])) + 1):
        points = members.tolist() + copies.get(int(body_of[members[0]]), [])
        if len(points) > 1:
            structure.bodies.append(RigidBody(points, look="bond"))
    within = body_of[data.bonds[:, 0]] == body_of[data.bonds[:, 1]]
    structure.lines += [(p, q) for p, q in data.bonds[within].tolist()]
    structure.counts["joints"] = len(axes)


def add_springs(structure: Imported, bonds: NDArray[np.int64], stiffness: float | None, damping: float) -> None:
    """Springs along bonds between points, (k, 2), and a tenth as stiff between the two ends of each angle. stiffness,
    damping: see `molecule`."""
    if not len(bonds):
        return
    place, mass = structure.points.position, structure.points.mass
    length = np.linalg.norm(place[bonds[:, 0]] - place[bonds[:, 1]], axis=1)
    if stiffness is None:
        stiffness = 9.81 * float(mass.sum()) / (SAG * float(length.mean()))

    def dashpots(pairs: NDArray[np.int64], k: float) -> list[float]:
        p, q = mass[pairs[:, 0]], mass[pairs[:, 1]]
        return (damping * 2 * np.sqrt(k * p * q / (p + q))).tolist()  # type: ignore[no-any-return]

    for (p, q), c in zip(bonds.tolist(), dashpots(bonds, stiffness), strict=True):
        structure.bond(p, q, "spring", stiffness=stiffness, damping=c)
    angles = _angle_ends(len(mass), bonds)
    for (p, q), c in zip(angles.tolist(), dashpots(angles, ANGLE * stiffness), strict=True):
        structure.bond(p, q, UNDRAWN, k=ANGLE * stiffness, r0=None, c=c)
    structure.counts["angle springs"] = len(angles)


def _angle_ends(count: int, bonds: NDArray[np.int64]) -> NDArray[np.int64]:
    """Pairs of atoms with a common neighbor that are not bonded themselves, each once."""
    neighbors: list[list[int]] = [[] for _ in range(count)]
    for p, q in bonds.tolist():
        neighbors[p].append(q)
        neighbors[q].append(p)
    bonded = {tuple(sorted(pair)) for pair in bonds.tolist()}
    ends: set[Any] = {
        (min(a, b), max(a, b)) for around in neighbors for i, a in enumerate(around) for b in around[i + 1 :]
    }
    return np.array(sorted(ends - bonded), np.int64).reshape(-1, 2)
