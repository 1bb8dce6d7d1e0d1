# SPDX-License-Identifier: Apache-2.0
"""Molecules from PDB, SDF, MOL, XYZ and CIF files, and from SMILES."""

from __future__ import annotations

import re
import time
from collections import Counter
from collections.abc import Callable, Collection, Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from iota.shapelib import cif
from iota.shapelib.chemistry import Element, complaints, element, isotope, rdkit
from iota.shapelib.files import FileError, PathLike, number, read_text, whole, with_progress
from iota.shapelib.layout import lay_out
from iota.shapelib.molecule_data import Molecule, check_count, check_places, perceive_bonds

EMBED_SECONDS = 5  # for each of two ways to find a shape, which together with the rest take at most 20 s
RELAX_SECONDS = 4.0
GAP = 4.0  # angstrom, between parts of a SMILES that no bond connects


def read_molecule(path: PathLike) -> Molecule:
    """By the file's ending. Raises FileError."""
    ending = Path(path).suffix.lower()
    if ending not in READERS:
        raise FileError(
            path, f"molecules are in files that end in {', '.join(READERS)}, not in {ending or 'nothing'!r}"
        )
    molecule = READERS[ending](read_text(path), path)
    molecule.title = molecule.title or Path(path).stem
    check_places(molecule, path)
    return molecule


def parse_smiles(text: str, seed: int = 1) -> Molecule:
    """A molecule in three dimensions from a SMILES string, hydrogens added: RDKit's distance geometry (ETKDG; Riniker and
    Landrum 2015), relaxed in its force field. Where it finds no shape within some seconds, the atoms are laid out by their
    bonds, with a note. Raises ValueError that names the error in the text."""
    chem = rdkit()
    shown = repr(text if len(text) <= 60 else text[:57] + "...")
    with complaints() as said:
        found = chem.MolFromSmiles(text) if text.strip() else None
        if found is None or found.GetNumAtoms() == 0:
            raise ValueError(f"the SMILES {shown} cannot be read{_reason(said)}")
        if found.GetNumAtoms() > 1000:
            raise ValueError(f"the SMILES has {found.GetNumAtoms()} heavy atoms, more than 1000")
        found = chem.AddHs(found)
        is_embedded = _embed(found, seed)
        if not is_embedded:
            _lay_out(found)
        _relax(found)
    molecule = _from_rdkit(found)
    _put_apart(molecule, chem.GetMolFrags(found))
    molecule.title = text
    if not is_embedded:
        molecule.notes.append("its shape is laid out by its bonds: RDKit finds none")
    check_places(molecule, f"SMILES {shown}")
    return molecule


def _embed(found: Any, seed: int) -> bool:
    """Whether RDKit finds a shape in time."""
    from rdkit.Chem import rdDistGeom as shapes

    for is_random in (False, True):
        way: Any = shapes.ETKDGv3()
        way.randomSeed, way.useRandomCoords, way.timeout = seed, is_random, EMBED_SECONDS
        if shapes.EmbedMolecule(found, way) == 0:
            return True
    return False


def _lay_out(found: Any) -> None:
    from rdkit.Chem.rdchem import Conformer, HybridizationType
    from rdkit.Geometry import Point3D

    count = found.GetNumAtoms()
    straight = {HybridizationType.SP: np.pi, HybridizationType.SP2: 2 * np.pi / 3}
    bonds = np.array([(b.GetBeginAtomIdx(), b.GetEndAtomIdx()) for b in found.GetBonds()], np.int64).reshape(-1, 2)
    radius = np.array([_known(atom.GetSymbol()).bond_radius for atom in found.GetAtoms()])
    angles = np.array([straight.get(atom.GetHybridization(), np.arccos(-1 / 3)) for atom in found.GetAtoms()])
    place = lay_out(count, bonds, radius[bonds].sum(axis=1), angles)
    shape = Conformer(count)
    for at, (x, y, z) in enumerate(place.tolist()):
        shape.SetAtomPosition(at, Point3D(x, y, z))
    found.RemoveAllConformers()
    found.AddConformer(shape, assignId=True)


def _relax(found: Any) -> None:
    """In the force field, if it knows all atoms, and as long as time is left."""
    from rdkit.Chem import rdForceFieldHelpers as fields

    if not fields.MMFFHasAllMoleculeParams(found):
        return
    end = time.monotonic() + RELAX_SECONDS
    field = fields.MMFFGetMoleculeForceField(found, fields.MMFFGetMoleculeProperties(found))
    if field is None:
        return
    field.Initialize()
    for _ in range(20):
        if field.Minimize(maxIts=10) == 0 or time.monotonic() > end:
            return


def _put_apart(molecule: Molecule, parts: Sequence[Sequence[int]]) -> None:
    """Parts without a bond between them, as the ions of a salt, all come about the origin: they are put in a row along x."""
    x = molecule.position[:, 0]
    for before, part in pairwise(map(list, parts)):
        x[part] += x[before].max() + GAP - x[part].min()


def _reason(said: list[str]) -> str:
    """RDKit's first message, without time and log format."""
    for text in said:
        lines = [re.sub(r"^(\[[\d:]+\]\s*)?(SMILES Parse Error:\s*)?", "", line).strip() for line in text.splitlines()]
        plain = next((line for line in lines if line and not set(line) <= set("*~^-")), "")
        if plain:
            return ": " + plain[:200]
    return ""


def _from_rdkit(found: Any) -> Molecule:
    atoms = [_known(atom.GetSymbol()) for atom in found.GetAtoms()]
    heavy = Counter[str]()
    for at, atom in enumerate(found.GetAtoms()):
        if atom.GetIsotope():
            atoms[at] = isotope(atoms[at], atom.GetIsotope())
            heavy[f"{atom.GetIsotope()}{atom.GetSymbol()}"] += 1
    bonds = [(bond.GetBeginAtomIdx(), bond.GetEndAtomIdx()) for bond in found.GetBonds()]
    orders = [bond.GetBondTypeAsDouble() or 1.0 for bond in found.GetBonds()]
    molecule = Molecule(
        "", atoms, np.array(found.GetConformer().GetPositions(), float).reshape(-1, 3),
        np.array(bonds, np.int64).reshape(-1, 2), np.array(orders, float),
    )  # fmt: skip
    molecule.charge = sum(atom.GetFormalCharge() for atom in found.GetAtoms())
    if heavy:
        listed = ", ".join(f"{count} of {name}" for name, count in heavy.items())
        molecule.notes.append(f"isotopes, with their masses: {listed}")
    return molecule


def _known(symbol: str) -> Element:
    known = element(symbol)
    if known is None:
        raise ValueError(f"{symbol!r} is not an element that can be simulated")
    return known


def _element_at(symbol: str, path: PathLike, line: int) -> Element:
    known = element(symbol)
    if known is None:
        raise FileError(path, f"{symbol.strip()[:20]!r} is not an element", line)
    return known


# --- Protein Data Bank ------------------------------------------------------------------------------------------------


def _read_pdb(text: str, path: PathLike) -> Molecule:
    """Reads the first model, and the first of alternative places of atoms. RDKit finds the bonds; lines with wrong
    numbers, which it does not report, are found before."""
    kept: list[str] = []
    names: list[str] = []
    kind_of_residue: dict[str, str] = {}
    seen: set[tuple[str, str]] = set()
    others = models = after = 0
    ended = False
    for at, line in enumerate(with_progress(text.splitlines(), "reading atoms"), 1):
        record = line[:6].strip()
        if record == "MODEL":
            models, ended = models + 1, bool(names)
            continue
        if record not in ("ATOM", "HETATM"):
            if record in ("END", "ENDMDL"):  # RDKit reads no further
                ended = ended or bool(names)
            else:
                kept.append(line)
            continue
        if ended:
            after += 1
            continue
        if len(line) < 54:
            raise FileError(path, "the line of this atom ends before its coordinates", at)
        if shift := _shift(line):
            columns = ", ".join(str(column + shift) for column in POINTS)
            raise FileError(
                path, f"the columns are shifted: the decimal points of x, y and z stand in columns {columns}, not in "
                f"{', '.join(map(str, POINTS))}", at,
            )  # fmt: skip
        for begin, what in ((30, "x"), (38, "y"), (46, "z")):
            number(line[begin : begin + 8], path, at, what)
        residue, kind, name = line[21:27], line[17:20].strip(), line[12:16].strip()
        is_other = (residue, name) in seen or kind_of_residue.setdefault(residue, kind) != kind
        if is_other and line[16] != " ":
            others += 1
            continue
        seen.add((residue, name))
        names.append(f"{name} of {kind} {residue[1:].strip()}")
        check_count(len(names), path, at)
        if line[76:78].strip():
            _element_at(line[76:78], path, at)
        kept.append(line[:16] + " " + line[17:])
    if not names:
        raise FileError(path, "has no ATOM or HETATM lines: it is not a PDB file, or is truncated")
    with complaints() as said:
        try:
            found = rdkit().MolFromPDBBlock("\n".join(kept), sanitize=False, removeHs=False, flavor=0)
        except SystemError:  # its message cuts a letter that is not ASCII in two
            raise FileError(path, "RDKit cannot read it: there are letters where numbers should be") from None
    if found is None:
        raise FileError(path, f"RDKit cannot read it{_reason(said)}")
    if found.GetNumAtoms() != len(names):
        raise FileError(path, f"{found.GetNumAtoms()} of its {len(names)} atoms can be read{_reason(said)}")
    molecule = _from_rdkit(found)
    molecule.names, molecule.residues = names, len(kind_of_residue)
    molecule.title = next((line[10:].strip().title() for line in kept if line.startswith("TITLE ")), "")
    if others:
        molecule.notes.append(f"{others} alternate places of atoms are left out")
    if models > 1:
        molecule.notes.append(f"only the first of {models} models is read")
    elif after:
        molecule.notes.append(f"{after} atoms after the first END are left out")
    serials = {line[6:11] for line in kept if line.startswith(("ATOM", "HETATM"))}
    dangling = sum(
        any(end.strip() and end not in serials for end in (line[place : place + 5] for place in range(6, 31, 5)))
        for line in kept
        if line.startswith("CONECT")
    )
    if dangling and not others and not after:
        molecule.notes.append(f"{dangling} CONECT lines name atoms that the file does not have")
    if not ended:
        molecule.notes.append("the file has no END line: it may be truncated")
    return molecule


POINTS = (35, 43, 51)  # columns, from 1, of the decimal points of x, y and z in an ATOM line


def _shift(line: str) -> int:
    """By how many columns a line of the usual numbers with three decimals is shifted; 0 also for numbers of another form."""
    for shift in (-1, 1, -2, 2):
        ends = [column - 1 + shift for column in POINTS]
        if all(line[at : at + 1] == "." and DECIMALS.match(line, at + 1) for at in ends):
            return shift
    return 0


DECIMALS = re.compile(r"\d{3}(?!\d)")


# --- MDL molfiles -----------------------------------------------------------------------------------------------------


def _read_sdf(text: str, path: PathLike) -> Molecule:
    """Reads the first molecule."""
    lines = text.splitlines()
    if len(lines) < 4:
        raise FileError(path, f"a molfile begins with four lines, this one has {len(lines)}")
    counts = lines[3]
    if "V3000" not in counts and "V2000" not in counts:
        raise FileError(path, "the counts line must name V2000 or V3000: this is not a molfile", 4)
    if "V3000" in counts:
        _check_v3000(lines, path)
    else:
        atoms, bonds = whole(counts[:3], path, 4, "the number of atoms"), whole(counts[3:6], path, 4, "that of bonds")
        check_count(atoms, path, 4)
        if atoms < 1:
            raise FileError(path, "has no atoms", 4)
        if len(lines) < 4 + atoms + bonds:
            raise FileError(path, f"ends before its {atoms} atoms and {bonds} bonds", len(lines))
        for at in range(5, 5 + atoms):
            row = lines[at - 1]
            for begin, what in ((0, "x"), (10, "y"), (20, "z")):
                number(row[begin : begin + 10], path, at, what)
            _element_at(row[31:34], path, at)
        _check_bonds(
            [(at, lines[at - 1][:3], lines[at - 1][3:6]) for at in range(5 + atoms, 5 + atoms + bonds)],
            range(1, atoms + 1),
            path,
        )
    end_at = next((at for at, line in enumerate(lines) if line.startswith("M  END")), None)
    if end_at is None:
        raise FileError(path, "has no 'M  END': it is truncated", len(lines))
    # RDKit cuts long lines for its error messages, also within a character of several bytes.
    block = "\n".join(lines[: end_at + 1]).encode("ascii", "replace").decode()
    with complaints() as said:
        found = rdkit().MolFromMolBlock(block, sanitize=False, removeHs=False)
    if found is None:
        raise FileError(path, f"RDKit cannot read it{_reason(said)}")
    if found.GetNumAtoms() == 0:
        raise FileError(path, "has no atoms")
    check_count(found.GetNumAtoms(), path)
    molecule = _from_rdkit(found)
    molecule.title = lines[0].strip()
    molecule.is_plane = not found.GetConformer().Is3D()
    molecules = sum(line.startswith("M  END") for line in lines)
    if molecules > 1:
        molecule.notes.append(f"only the first of {molecules} molecules is read")
    if molecule.is_plane:
        molecule.notes.append("the file has plane coordinates of a drawing, not a shape in space")
    return molecule


def _check_bonds(rows: list[tuple[int, str, str]], atoms: Collection[int], path: PathLike) -> None:
    """rows: the line of each bond, and its ends. atoms: their numbers. Raises FileError, because RDKit does not say which bond is wrong."""
    first: dict[tuple[int, int], int] = {}
    for at, *ends in rows:
        p, q = sorted(whole(end, path, at, "an end of a bond") for end in ends)
        for end in (p, q):
            if end not in atoms:
                raise FileError(path, f"this bond names atom {end}; there are {min(atoms)}..{max(atoms)}", at)
        if p == q:
            raise FileError(path, f"this bond has atom {p} at both ends", at)
        if first.setdefault((p, q), at) != at:
            raise FileError(path, f"the atoms {p} and {q} have a bond already, in line {first[p, q]}", at)


def _check_v3000(lines: list[str], path: PathLike) -> None:
    """Raises FileError for what RDKit refuses without a line. Lines that go on in the next one are left to it."""
    block, atoms, bonds = "", set[int](), []
    for at, line in enumerate(with_progress(lines, "reading atoms"), 1):
        if line.startswith("M  END"):
            break
        words = line.split()
        if words[:2] != ["M", "V30"] or line.endswith("-"):
            continue
        if words[2:3] == ["COUNTS"]:
            check_count(whole(" ".join(words[3:4]), path, at, "the number of atoms"), path, at)
        elif words[2:3] in (["BEGIN"], ["END"]):
            block = " ".join(words[3:4]) if words[2] == "BEGIN" else ""
        elif block == "ATOM":
            if len(words) < 7:
                raise FileError(path, "the line of this atom ends before its coordinates", at)
            atoms.add(whole(words[2], path, at, "the number of an atom"))
            _element_at(words[3], path, at)
            for word, what in zip(words[4:7], "xyz", strict=True):
                number(word, path, at, what)
        elif block == "BOND":
            if len(words) < 6:
                raise FileError(path, "the line of this bond ends before its atoms", at)
            bonds.append((at, words[4], words[5]))
    if not atoms:
        raise FileError(path, "has no atoms")
    _check_bonds(bonds, atoms, path)


# --- SMILES -----------------------------------------------------------------------------------------------------------


def _read_smi(text: str, path: PathLike) -> Molecule:
    """Reads the first line: a SMILES, and its title behind a space."""
    lines = [
        (at, line.split(None, 1)) for at, line in enumerate(text.splitlines(), 1) if line.strip() and line[0] != "#"
    ]
    if lines and lines[0][1][0].lower() in ("smiles", "canonical_smiles"):  # a head
        del lines[0]
    if not lines:
        raise FileError(path, "has no SMILES")
    at, (smiles, *title) = lines[0]
    try:
        molecule = parse_smiles(smiles)
    except ValueError as error:
        raise FileError(path, str(error), at) from None
    molecule.title = title[0].strip() if title else smiles
    if len(lines) > 1:
        molecule.notes.append(f"only the first of {len(lines)} molecules is read")
    return molecule


# --- XYZ --------------------------------------------------------------------------------------------------------------


def _read_xyz(text: str, path: PathLike) -> Molecule:
    """Reads the first frame and perceives bonds. Columns after x y z are ignored."""
    lines = text.splitlines()
    count = whole(lines[0], path, 1, "the first line of an XYZ file, the number of atoms,")
    if count < 1:
        raise FileError(path, f"the number of atoms must be above 0, not {count}", 1)
    check_count(count, path, 1)
    if len(lines) < count + 2:
        raise FileError(path, f"ends after {max(len(lines) - 2, 0)} of {count} atoms", len(lines))
    atoms, places = [], []
    for at, line in enumerate(with_progress(lines[2 : count + 2], "reading atoms"), 3):
        words = line.split()
        if len(words) < 4:
            raise FileError(path, f"an atom is an element and three numbers, not {line.strip()[:40]!r}", at)
        symbol = words[0]
        if symbol.isdigit():
            table = rdkit().GetPeriodicTable()
            symbol = table.GetElementSymbol(int(symbol)) if 1 <= int(symbol) <= 118 else symbol
        atoms.append(_element_at(symbol, path, at))
        places.append([number(word, path, at, what) for word, what in zip(words[1:4], "xyz", strict=True)])
    molecule = _perceived(lines[1].strip(), atoms, np.array(places), path)
    if any(line.strip() for line in lines[count + 2 :]):
        molecule.notes.append("only the first frame is read")
    return molecule


def _perceived(
    title: str, atoms: list[Element], position: Any, path: PathLike, names: list[str] | None = None
) -> Molecule:
    unbonded = Molecule(title, atoms, position, np.empty((0, 2), np.int64), np.empty(0), names or [])
    check_places(unbonded, path)
    unbonded.bonds = perceive_bonds(atoms, position)
    unbonded.orders = np.ones(len(unbonded.bonds))
    unbonded.notes.append("its bonds are guessed from distances, all of them single")
    return unbonded


# --- CIF --------------------------------------------------------------------------------------------------------------


def _read_cif(text: str, path: PathLike) -> Molecule:
    """Reads the first block. For crystals only the listed atoms are read, without their images under the symmetry."""
    tables = cif.read_first_block(text, path)
    table = tables.get("_atom_site")
    if table is None or not table.rows:
        raise FileError(path, "has no _atom_site table: no atoms")
    elements = table.column("type_symbol")
    symbols = elements or table.column("label")
    if symbols is None:
        raise FileError(path, "_atom_site has neither type_symbol nor label", table.lines[0])
    columns = [table.column(f"cartn_{axis}") for axis in "xyz"]
    cell = np.eye(3)
    if None in columns:
        columns = [table.column(f"fract_{axis}") for axis in "xyz"]
        if None in columns:
            raise FileError(path, "_atom_site has neither Cartn_x, y, z nor fract_x, y, z", table.lines[0])
        cell = _cell(tables.get("_cell"), path)
    alternates = table.column("label_alt_id") or table.column("disorder_group")
    models = table.column("pdbx_pdb_model_num")
    parts = [table.column(name) for name in ("label_asym_id", "label_seq_id", "label_comp_id", "label_atom_id")]
    is_protein = None not in parts
    kind_of_residue: dict[tuple[str, ...], str] = {}
    seen: set[tuple[str, ...]] = set()
    atoms, places, names = [], [], []
    others = other_models = charge = 0
    charges = table.column("pdbx_formal_charge")
    for row, at in enumerate(with_progress(table.lines, "reading atoms")):
        if models and models[row] != models[0]:
            other_models += 1
            continue
        chain, residue, kind, name = (column[row] if column else "" for column in parts)
        key = (chain, residue, name)
        is_other = kind_of_residue.setdefault(key[:2], kind) != kind or key in seen or not is_protein
        if alternates and alternates[row] not in (".", "?", "1") and is_other:
            others += 1
            continue
        seen.add(key)
        symbol = symbols[row] if elements else re.sub(r"[^A-Za-z].*", "", symbols[row])
        atoms.append(_element_at(re.sub(r"\d*[+-]?$", "", symbol), path, at))
        told = re.fullmatch(r"[A-Za-z]+(\d*)([+-])", symbol)  # of an ion, as Fe3+
        charge += int(f"{told[2]}{told[1] or 1}") if told else 0
        if charges and re.fullmatch(r"[+-]?\d+", charges[row]):
            charge += int(charges[row])
        check_count(len(atoms), path, at)
        # A number may have its uncertainty in parentheses: 0.1234(5).
        place = [number(column[row].split("(")[0], path, at, "a coordinate") for column in columns if column]
        places.append(cell @ place)
        names.append(f"{name} of {kind} {residue}" if is_protein else f"{atoms[-1].symbol}{len(atoms)}")
    molecule = _perceived("", atoms, np.array(places), path, names)
    molecule.charge = charge
    if repeated := _symmetry(tables):
        molecule.notes.append(f"only the listed atoms are read, not their images in the crystal ({repeated})")
    molecule.residues = len(kind_of_residue) if is_protein else 0
    if others:
        molecule.notes.append(f"{others} alternate places of atoms are left out")
    if other_models:
        molecule.notes.append("only the first model is read")
    return molecule


def _symmetry(tables: dict[str, cif.Table]) -> str:
    """The symmetry of a crystal in words, "" without one, and for proteins, whose symmetry is in other tables."""
    for category, name in (("_symmetry_equiv", "pos_as_xyz"), ("_space_group_symop", "operation_xyz")):
        operations = tables[category].column(name) if category in tables else None
        if operations is not None:
            return f"{len(operations)} operations of symmetry" if len(operations) > 1 else ""
    for item in ("_symmetry_space_group_name_h-m", "_space_group_name_h-m_alt"):
        if item in tables and (group := tables[item].rows[0][0]).replace(" ", "").upper() not in ("P1", "?", "."):
            return f"space group {group}"
    return ""


def _cell(table: cif.Table | None, path: PathLike) -> Any:
    """The columns are the edges of the unit cell, angstrom."""
    names = ("length_a", "length_b", "length_c", "angle_alpha", "angle_beta", "angle_gamma")
    columns = [table.column(name) if table else None for name in names]
    if table is None or any(column is None for column in columns):
        raise FileError(path, "has coordinates in a unit cell, but not the six numbers of _cell")
    a, b, c, *angles = (number(column[0].split("(")[0], path, table.lines[0], "_cell") for column in columns if column)
    if not (min(a, b, c) > 0 and all(0 < angle < 180 for angle in angles)):
        raise FileError(path, f"no unit cell has edges {a}, {b}, {c} and angles {angles}", table.lines[0])
    alpha, beta, gamma = np.radians(angles)
    along = (np.cos(alpha) - np.cos(beta) * np.cos(gamma)) / np.sin(gamma)
    height = 1 - np.cos(beta) ** 2 - along**2
    if not height > 0:
        raise FileError(path, f"no unit cell has the angles {angles}", table.lines[0])
    return np.array(
        [[a, b * np.cos(gamma), c * np.cos(beta)], [0, b * np.sin(gamma), c * along], [0, 0, c * np.sqrt(height)]]
    )


READERS: dict[str, Callable[[str, PathLike], Molecule]] = {
    ".pdb": _read_pdb, ".ent": _read_pdb, ".sdf": _read_sdf, ".mol": _read_sdf, ".xyz": _read_xyz, ".cif": _read_cif,
    ".mmcif": _read_cif, ".smi": _read_smi, ".smiles": _read_smi,
}  # fmt: skip
