# SPDX-License-Identifier: Apache-2.0
"""From file to structure. Every file here is made by its test."""

from __future__ import annotations

import io
import json
import math
import os
import struct
import sys
from collections.abc import Callable, Sequence
from itertools import combinations
from pathlib import Path
from types import SimpleNamespace
from typing import Literal

import numpy as np
import pytest

import iota
from iota import shapelib
from iota.shapelib import cif, files, mjcf_notes
from iota.shapelib.convex import dual
from iota.shapelib.johnson import johnson
from iota.shapelib.mechanism_data import to_structure
from iota.shapelib.molecule_files import read_molecule
from iota.shapelib.named import named_polyhedron
from iota.shapelib.nearest import near_pairs
from iota.shapelib.surface import Surface
from iota.shapelib.uniform import SNUB, UNIFORM, uniform
from iota.shapelib.urdf import read_urdf

WATER_XYZ = "3\nwater\nO 0 0 0\nH 0.96 0 0\nH -0.24 0.93 0\n"

ETHANOL_PDB = """\
TITLE     ETHANOL
ATOM      1  C1  EOH A   1      -0.888   0.181   0.000  1.00  0.00           C
ATOM      2  C2  EOH A   1       0.463  -0.511   0.000  1.00  0.00           C
ATOM      3  O   EOH A   1       1.437   0.548   0.000  1.00  0.00           O
HETATM    4  O   HOH A   2       6.000   0.000   0.000  1.00  0.00           O
END
"""

# Ethane-like, with one atom in two places.
ALTERNATES_PDB = """\
ATOM      1  C1  XXX A   1       0.000   0.000   0.000  1.00  0.00           C
ATOM      2  C2 AXXX A   1       1.500   0.000   0.000  0.50  0.00           C
ATOM      3  C2 BXXX A   1       1.400   0.500   0.000  0.50  0.00           C
END
"""

CARBON_MONOXIDE_MOL = """\
carbon monoxide
  iota

  2  1  0  0  0  0  0  0  0  0999 V2000
    0.0000    0.0000    0.0000 C   0  0
    1.1300    0.0000    0.5000 O   0  0
  1  2  3  0
M  END
"""

V3000_MOL = """\
ethane without hydrogens
  iota

  0  0  0     0  0            999 V3000
M  V30 BEGIN CTAB
M  V30 COUNTS 2 1 0 0 0
M  V30 BEGIN ATOM
M  V30 1 C 0 0 0 0
M  V30 2 C 1.5 0 0.1 0
M  V30 END ATOM
M  V30 BEGIN BOND
M  V30 1 1 1 2
M  V30 END BOND
M  V30 END CTAB
M  END
"""

GLYCINE_CIF = """\
data_gly
loop_
_atom_site.group_PDB
_atom_site.type_symbol
_atom_site.label_atom_id
_atom_site.label_alt_id
_atom_site.label_comp_id
_atom_site.label_asym_id
_atom_site.label_seq_id
_atom_site.Cartn_x
_atom_site.Cartn_y
_atom_site.Cartn_z
ATOM N N   . GLY A 1 0.0 0.0 0.0
ATOM C CA  . GLY A 1 1.46 0.0 0.0
ATOM C C   . GLY A 1 2.0 1.42 0.0
ATOM O 'O' . GLY A 1 1.25 2.4 0.0
ATOM O "O''" . GLY A 1 3.3 1.6 0.0
"""

SALT_CIF = """\
data_salt
_cell_length_a 5.64(1)
_cell_length_b 5.64
_cell_length_c 5.64
_cell_angle_alpha 90
_cell_angle_beta 90
_cell_angle_gamma 60
_description
;two atoms in
a slanting cell
;
loop_
_atom_site_label
_atom_site_fract_x
_atom_site_fract_y
_atom_site_fract_z
Na1 0 0 0
Cl1 0.5(1) 0.5 0
"""

CUBE_OFF = """\
OFF # a comment
8 6 0
0 0 0
1 0 0
1 1 0
0 1 0
0 0 1
1 0 1
1 1 1 # another one
0 1 1
4 3 2 1 0
4 4 5 6 7 0.5 0.5 0.5 1
4 0 1 5 4
4 1 2 6 5
4 2 3 7 6
4 3 0 4 7
"""


@pytest.fixture
def write(tmp_path: Path) -> Callable[[str, str | bytes], Path]:
    def make(name: str, contents: str | bytes) -> Path:
        path = tmp_path / name
        path.write_bytes(contents if isinstance(contents, bytes) else contents.encode())
        return path

    return make


Write = Callable[[str, "str | bytes"], Path]


def fails(source: Path | str, *parts: str, load: Callable[..., object] = shapelib.load, at: str | None = None) -> None:
    """Refused in one line that names the file, or another one beside it, and holds all parts."""
    with pytest.raises(shapelib.FileError) as caught:
        load(source)
    text = str(caught.value)
    assert text.startswith(str(source if at is None else Path(source).parent / at)) and "\n" not in text
    for part in parts:
        assert part in text, text


# --- molecules --------------------------------------------------------------------------------------------------------


def test_a_pdb_file_gives_its_atoms_bonds_and_residues(write: Write) -> None:
    found = shapelib.molecule(write("ethanol.pdb", ETHANOL_PDB))
    assert found.title == "Ethanol"
    assert found.counts == {"atoms": 4, "bonds": 2, "pieces": 2, "residues": 2, "formula": "C2O2"}
    assert len(found.bodies) == 1 and sorted(map(sorted, found.lines)) == [[0, 1], [1, 2]]
    # A nanometer is 1 m and a dalton a gram.
    length = np.linalg.norm(found.points.position[0] - found.points.position[1])
    assert length == pytest.approx(0.1 * math.dist((-0.888, 0.181), (0.463, -0.511)), abs=1e-12)
    assert found.points.mass.sum() == pytest.approx(0.001 * (2 * 12.011 + 2 * 15.999))
    assert found.points.mass @ found.points.position == pytest.approx(np.zeros(3), abs=1e-12)


def test_of_an_atom_in_two_places_the_first_is_taken(write: Write) -> None:
    found = shapelib.molecule(write("two.pdb", ALTERNATES_PDB))
    assert (found.counts["atoms"], found.counts["bonds"]) == (2, 1)
    assert found.notes == ["1 alternate places of atoms are left out"]


def test_the_first_model_of_several_is_taken(write: Write) -> None:
    model = "".join(line for line in ETHANOL_PDB.splitlines(True) if line[:4] in ("ATOM", "HETA"))
    found = shapelib.molecule(write("m.pdb", f"MODEL 1\n{model}ENDMDL\nMODEL 2\n{model}ENDMDL\nEND\n"))
    assert found.counts["atoms"] == 4 and found.notes == ["only the first of 2 models is read"]


def test_a_molfile_keeps_its_bonds(write: Write) -> None:
    for name in ("co.mol", "co.sdf"):
        found = shapelib.molecule(write(name, CARBON_MONOXIDE_MOL + ("$$$$\n" if name.endswith("sdf") else "")))
        assert (found.title, found.counts["atoms"], found.counts["bonds"]) == ("carbon monoxide", 2, 1)


def test_an_xyz_file_has_its_bonds_guessed(write: Write) -> None:
    found = shapelib.molecule(write("water.xyz", WATER_XYZ))
    assert found.counts["formula"] == "H2O" and found.counts["bonds"] == 2
    assert "guessed" in found.notes[0]
    padded = "3\n  water   \n O 0 0 0  1 2 3\n H 0.96 0 0  2 1\n 1 -0.24 0.93 0 3 1\n\n"
    assert shapelib.molecule(write("padded.xyz", padded)).counts["bonds"] == 2


def test_a_cif_file_of_a_protein_and_one_of_a_crystal(write: Write) -> None:
    glycine = shapelib.molecule(write("gly.cif", GLYCINE_CIF))
    assert glycine.counts == {"atoms": 5, "bonds": 4, "pieces": 1, "residues": 1, "formula": "C2NO2"}
    salt = shapelib.molecule(write("salt.cif", SALT_CIF), scale=1)
    place = salt.points.position
    assert place[1] - place[0] == pytest.approx([0.75 * 5.64, 0.5 * 5.64 * math.sin(math.pi / 3), 0], abs=1e-9)


def test_a_smiles_string_gets_hydrogens_and_a_shape() -> None:
    found = shapelib.molecule("CCO", kind="flexible")
    assert found.counts["formula"] == "C2H6O" and found.counts["joints"] == 2
    again = shapelib.molecule("CCO", kind="flexible")
    assert (found.points.position == again.points.position).all()


def test_parts_of_a_smiles_without_a_bond_between_them_are_beside_each_other() -> None:
    found = shapelib.molecule("[Na+].[Cl-].CCO", scale=1.0)
    places = found.points.position
    assert found.counts["pieces"] == 3 and len(places) == 2 + 9
    assert min(np.linalg.norm(places[p] - places[q]) for p in range(2, 11) for q in (0, 1)) > 3.9
    assert np.linalg.norm(places[0] - places[1]) > 3.9


def test_a_flexible_molecule_turns_about_its_bonds_and_keeps_all_lengths_and_angles() -> None:
    chain = shapelib.molecule("CCCC", kind="flexible", at=(0, 2, 0))
    atoms = int(chain.counts["atoms"])
    assert chain.counts["joints"] == 3 and len(chain.bodies) == 4
    before = chain.points.position[:atoms].copy()
    system = iota.System()
    made = chain.realize(system)
    made.points[0].nail()
    made.points[atoms - 1].velocity = (0, 0, 3)
    for _ in range(240):
        assert system.step(1 / 240).unconverged == 0
    after = np.array([tuple(point.position) for point in made.points[:atoms]])
    bonds, _ = near_pairs(before, 0.16)
    angles = {(a, b) for p, q in bonds for r, s in bonds if len({p, q, r, s}) == 3 for a, b in [({p, q} ^ {r, s})]}
    for p, q in [*map(tuple, bonds), *angles]:
        assert np.linalg.norm(after[p] - after[q]) == pytest.approx(np.linalg.norm(before[p] - before[q]), abs=1e-7)
    first, last = np.linalg.norm(before[0] - before[3]), np.linalg.norm(after[0] - after[3])
    assert abs(first - last) > 1e-4  # the ends of the chain come nearer as it turns


def test_amides_and_rings_do_not_turn() -> None:
    amide = shapelib.molecule("CC(=O)NC", kind="flexible")
    assert amide.counts["joints"] == 2  # two methyl groups
    assert shapelib.molecule("c1ccccc1", kind="flexible").counts["joints"] == 0


def test_a_soft_molecule_hangs_longer_than_a_rigid_one() -> None:
    lengths = []
    for kind in ("rigid", "soft"):
        system = iota.System(damping=2.0)
        made = shapelib.molecule("CCCCCC", kind=kind).realize(system)  # type: ignore[arg-type]
        made.points[0].nail()
        for _ in range(1200):
            system.step(1 / 120)
        lengths.append(max(made.points[0].position.y - point.position.y for point in made.points))
    assert lengths[1] > 1.05 * lengths[0]


def test_atoms_are_drawn_as_the_callback_says() -> None:
    found = shapelib.molecule("O", atom_look=lambda symbol: (0.2 if symbol == "O" else 0.1, (0.5, 0, 0)))
    assert found.points.radius.tolist() == [0.2, 0.1, 0.1] and found.points.color[0].tolist() == [0.5, 0, 0]


@pytest.mark.parametrize("smiles", ["c1ccccc", "X(", "C(C)(C)(C)(C)C", ""])
def test_a_smiles_that_cannot_be_read_is_refused_in_one_line(smiles: str, capfd: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(ValueError, match="the SMILES") as caught:
        shapelib.molecule(smiles)
    assert "\n" not in str(caught.value)
    assert capfd.readouterr().err == ""


def test_damaged_molecules_are_refused_with_file_and_line(write: Write) -> None:
    fails(write("a.pdb", ""), "is empty")
    fails(write("a.xyz", b"\0\1\2"), "not a text file")
    fails(write("b.pdb", "HEADER\nEND\n"), "no ATOM")
    fails(write("c.pdb", ETHANOL_PDB.replace("0.463", "xxxxx")), "line 3", "x must be a number")
    fails(write("v.pdb", ETHANOL_PDB.replace("ATOM      2", "ATOM      é")), "RDKit cannot read it")
    fails(write("d.pdb", ETHANOL_PDB[:150]), "line 3", "ends before its coordinates")
    fails(write("e.pdb", ETHANOL_PDB.replace("           O\nHET", "          Qq\nHET")), "line 4", "not an element")
    fails(write("f.xyz", "3\nwater\nO 0 0 0\nH 1 0 0\n"), "line 4", "2 of 3 atoms")
    fails(write("g.xyz", WATER_XYZ.replace("H 0.96", "Zz 0.96")), "line 4", "'Zz' is not an element")
    fails(write("h.xyz", WATER_XYZ.replace("0.96", "nan")), "line 4", "finite")
    fails(write("w.xyz", WATER_XYZ.replace("0.96", "9" * 5000)), "line 4", f"finite, not {'9' * 40}")
    fails(write("i.xyz", WATER_XYZ.replace("0.96", "0.01")), "O1 and H2 are 0.01 angstrom apart")
    fails(write("j.xyz", "1000000\n\n"), "more than 100000 atoms")
    fails(write("k.mol", CARBON_MONOXIDE_MOL.replace("  1  2  3", "  1  7  3")), "line 7", "atom 7")
    fails(write("l.mol", CARBON_MONOXIDE_MOL.replace("M  END\n", "")), "truncated")
    fails(write("m.mol", CARBON_MONOXIDE_MOL[:80]), "ends before")
    fails(write("n.mol", "a picture\n"), "four lines")
    fails(write("u.mol", CARBON_MONOXIDE_MOL.replace("C   0  0", "C   0  é")), "RDKit cannot read it")
    fails(write("o.cif", GLYCINE_CIF.replace(" 1.6 0.0\n", " 1.6\n")), "line 17", "9 values for 10 names")
    fails(write("p.cif", GLYCINE_CIF.replace("data_gly\n", "")), "line 1", "data_")
    fails(write("q.cif", SALT_CIF.replace("slanting cell\n;", "slanting cell\n")), "line 9", "no end")
    fails(write("r.cif", SALT_CIF.replace("gamma 60", "gamma 0")), "unit cell")
    fails(write("s.cif", "data_x\n_a 'b\n"), "line 2", "quote without an end")
    fails("nothing/here.pdb", "no such file")
    fails(write("t.docx", "x"), "files that end in '.docx' are not read")


def test_a_file_of_a_million_atoms_is_refused_before_it_is_read_through(
    write: Write, monkeypatch: pytest.MonkeyPatch
) -> None:
    rows = "".join(f"C {i % 100} {i // 100 % 100} {i // 10000}\n" for i in range(100_001))
    fails(write("big.xyz", f"100001\n\n{rows}"), "more than 100000 atoms")
    fails(write("big.mol", V3000_MOL.replace("COUNTS 2", "COUNTS 1000000")), "line 6", "more than 100000 atoms")
    monkeypatch.setattr(cif, "MOST_ROWS", 100)
    atoms = "data_x\nloop_\n_atom_site.group_PDB\n" + "ATOM \n" * 60 + "HETATM \n" * 41
    with monkeypatch.context() as unread:
        unread.setattr(cif, "_tokens", None)
        fails(write("atoms.cif", atoms), "line 104", "more than 100 rows", load=read_molecule)
    other = write("big.cif", "data_x\nloop_\n_other.a\n" + "1\n" * 101)
    fails(other, "line 104", "more than 100 rows", load=read_molecule)


def test_a_terminal_shows_how_far_the_reading_of_a_large_file_is(write: Write, monkeypatch: pytest.MonkeyPatch) -> None:
    rows = "".join(f"C {4 * i} 0 0\n" for i in range(4000))
    terminal = io.StringIO()
    monkeypatch.setattr(terminal, "isatty", lambda: True, raising=False)
    monkeypatch.setattr(sys, "stderr", terminal)
    for seconds, shown in ((1.0, ["25 %", "50 %", "75 %"]), (0.1, [])):  # from one look at the clock to the next
        looks = iter(seconds * look for look in range(9999))
        monkeypatch.setattr(files, "time", SimpleNamespace(monotonic=looks.__next__))
        terminal.seek(0)
        terminal.truncate()
        assert len(read_molecule(write("long.xyz", f"4000\n\n{rows}")).elements) == 4000
        *lines, last = terminal.getvalue().split("\r")
        assert lines[1:] == [f"reading atoms: {share}" for share in shown]
        assert last == ("\x1b[K" if shown else ""), "the line is gone"


def test_bonds_that_a_molfile_cannot_have_are_refused_with_their_line(write: Write) -> None:
    assert shapelib.molecule(write("a.mol", V3000_MOL)).counts["bonds"] == 1
    fails(write("b.mol", V3000_MOL.replace("1 1 1 2", "1 1 1 9")), "line 12", "atom 9; there are 1..2")
    fails(write("c.mol", V3000_MOL.replace("C 1.5", "C one")), "line 9", "x must be a number")
    fails(write("d.mol", V3000_MOL.replace("2 C", "2 Zz")), "line 9", "'Zz' is not an element")
    fails(write("e.mol", V3000_MOL.replace("M  V30 1 1 1 2", "M  V30 1 1 1")), "line 12", "ends before its atoms")
    fails(write("f.mol", CARBON_MONOXIDE_MOL.replace("  1  2  3", "  2  2  3")), "line 7", "atom 2 at both ends")
    twice = CARBON_MONOXIDE_MOL.replace("  2  1  0", "  2  2  0", 1).replace("M  END", "  2  1  1\nM  END")
    fails(write("g.mol", twice), "line 8", "a bond already, in line 7")


def test_atoms_on_top_of_each_other_and_far_away_are_refused_at_once(write: Write) -> None:
    fails(write("heap.xyz", "60000\n\n" + "C 0 0 0\n" * 60_000), "within 0.4 angstrom")
    fails(write("far.xyz", "2\n\nC 0 0 0\nC 1e15 0 0\n"), "point 1 (of 2)", "smaller scale")
    fails(write("python.xyz", WATER_XYZ.replace("0.96", "1_0")), "line 4", "'1_0'")


def test_omissions_of_a_molecule_are_noted(write: Write) -> None:
    symmetry = "loop_\n_symmetry_equiv_pos_as_xyz\n'x,y,z'\n'-x,-y,z'\n"
    for more, words in (
        (symmetry, "2 operations of symmetry"),
        ("_symmetry_space_group_name_H-M 'F m -3 m'\n", "F m -3 m"),
        ("_symmetry_space_group_name_H-M 'P 1'\n", ""),
    ):
        notes = shapelib.molecule(write("a.cif", SALT_CIF.replace("loop_\n", more + "loop_\n"))).notes
        assert [note for note in notes if "images in the crystal" in note] == [
            f"only the listed atoms are read, not their images in the crystal ({found})"
            for found in [words if "oper" in words else f"space group {words}"] if words
        ]  # fmt: skip
    second = GLYCINE_CIF + GLYCINE_CIF.partition("\n")[2]
    fails(write("b.cif", second), "line 18", "this is the second")
    lost = shapelib.molecule(write("c.pdb", ETHANOL_PDB.replace("END\n", "CONECT    1    2\nCONECT    1   77\nEND\n")))
    assert "1 CONECT lines name atoms that the file does not have" in lost.notes


def test_a_pipe_is_not_read(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "water.xyz")
    fails(tmp_path / "water.xyz", "a pipe or device")


def test_near_pairs_are_those_of_a_search_through_all() -> None:
    random = np.random.default_rng(3)
    for count, reach in ((2, 0.5), (200, 0.2), (300, 0.05)):
        places = random.random((count, 3)) * [1, 0.3, 1]
        pairs, distances = near_pairs(places, reach)
        slow = [(i, j) for i, j in combinations(range(count), 2) if np.linalg.norm(places[i] - places[j]) < reach]
        assert [tuple(pair) for pair in pairs] == slow
        assert distances == pytest.approx([np.linalg.norm(places[i] - places[j]) for i, j in slow])


# --- polyhedra --------------------------------------------------------------------------------------------------------


def faces_of(surface: Surface) -> dict[int, int]:
    """How many faces have so many corners."""
    sizes = [len(face) for face in surface.faces]
    return {size: sizes.count(size) for size in sorted(set(sizes))}


def assert_regular(surface: Surface) -> None:
    """All edges are 1 long, all faces regular polygons; closed, convex, of Euler's number 2."""
    places, edges = surface.vertices, surface.edges()
    lengths = np.linalg.norm(places[edges[:, 0]] - places[edges[:, 1]], axis=1)
    assert np.abs(lengths - 1).max() < 1e-9
    for face in surface.faces:
        corners = places[face]
        radii = np.linalg.norm(corners - corners.mean(axis=0), axis=1)
        assert np.abs(radii - 1 / (2 * math.sin(math.pi / len(face)))).max() < 1e-9
        normal = np.cross(corners[1] - corners[0], corners[2] - corners[1])
        assert ((places - corners[0]) @ normal < 1e-9).all()
    surface.check("")
    assert len(places) - len(edges) + len(surface.faces) == 2


def test_uniform_polyhedra_have_regular_faces_and_one_kind_of_corner() -> None:
    shapes = set()
    for name in [*UNIFORM, *SNUB]:
        solid = uniform(name)
        assert_regular(solid)
        radii = np.linalg.norm(solid.vertices, axis=1)
        assert np.ptp(radii) < 1e-9
        shapes.add((len(solid.vertices), *faces_of(solid).items()))
        assert len(dual(solid).faces) == len(solid.vertices)
    assert len(shapes) == 18
    assert faces_of(uniform("truncated icosidodecahedron")) == {4: 30, 6: 20, 10: 12}
    assert faces_of(uniform("snub dodecahedron")) == {3: 80, 5: 12}


def test_johnson_solids_have_regular_faces_and_no_two_are_alike() -> None:
    known = {uniform_signature(uniform(name)) for name in [*UNIFORM, *SNUB]}
    assert len(known) == 18
    for number in range(1, 93):
        solid = johnson(number)
        assert_regular(solid)
        known.add(uniform_signature(solid))
    assert len(known) == 18 + 92
    assert faces_of(johnson(5)) == {3: 5, 4: 5, 5: 1, 10: 1}
    # The last ones, of roots of equations, have the faces that their names say (Johnson 1966, table III).
    for number, faces in {
        84: {3: 12}, 85: {3: 24, 4: 2}, 86: {3: 12, 4: 2}, 87: {3: 16, 4: 1}, 88: {3: 16, 4: 2}, 89: {3: 18, 4: 3},
        90: {3: 20, 4: 4}, 91: {3: 8, 4: 2, 5: 4}, 92: {3: 13, 4: 3, 5: 3, 6: 1},
    }.items():  # fmt: skip
        assert faces_of(johnson(number)) == faces
    with pytest.raises(ValueError, match="J1 to J92, not J93"):
        johnson(93)


def uniform_signature(solid: Surface) -> tuple[float, ...]:
    """Two different ones have different distances between corners."""
    p, q = np.triu_indices(len(solid.vertices), 1)
    distances = np.sort(np.linalg.norm(solid.vertices[p] - solid.vertices[q], axis=1))
    weights = np.arange(1, len(distances) + 1) ** 0.5
    return (len(solid.vertices), round(float(distances.sum()), 5), round(float((distances * weights).sum()), 4))


def test_geodesic_balls_and_fullerenes() -> None:
    ball = named_polyhedron("geodesic 3")
    assert (len(ball.vertices), len(ball.faces)) == (92, 180)
    ball.check("")
    for atoms in (20, 60, 80, 140, 180, 240):
        cage = named_polyhedron(f"fullerene {atoms}")
        assert len(cage.vertices) == atoms and faces_of(cage) == {5: 12} | ({6: atoms // 2 - 10} if atoms > 20 else {})
        lengths = [np.linalg.norm(cage.vertices[p] - cage.vertices[q]) for p, q in cage.edges()]
        assert max(lengths) < 1.25 * min(lengths)
        cage.check("")
    with pytest.raises(ValueError, match=r"have 20, 60, 80, .* atoms, not 70"):
        shapelib.polyhedron("C70")


def test_every_name_gives_a_polyhedron() -> None:
    names = shapelib.polyhedron_names()
    assert len(names) == len(set(names)) and "Rhombic-Triacontahedron".lower().replace("-", " ") in names
    for name in names:
        if not name.startswith("J"):
            solid = shapelib.polyhedron(name.replace(" N", " 5") if "fuller" not in name else "C 60".replace(" ", ""))
            assert solid.counts["volume"] > 0 and solid.problems() == []  # type: ignore[operator]
    with pytest.raises(ValueError, match="did you mean 'icosahedron'"):
        shapelib.polyhedron("icosahedrn")


STL = """\
solid Left half
facet normal 0 0 -1\nouter loop\nvertex 0 0 0\nvertex 0 1 0\nvertex 1 0 0\nendloop\nendfacet
facet normal 0 -1 0\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 0 1\nendloop\nendfacet
facet normal -1 0 0\nouter loop\nvertex 0 0 0\nvertex 0 0 1\nvertex 0 1 0\nendloop\nendfacet
facet normal 1 1 1\nouter loop\nvertex 1 0 0\nvertex 0 1 0\nvertex 0 0 1\nendloop\nendfacet
endsolid Left half
"""


def triangles_of(text: str) -> bytes:
    """A text STL as a binary one, without its names."""
    rows = [list(map(float, line.split()[1:])) for line in text.splitlines() if line.startswith("vertex")]
    body = b"".join(
        struct.pack("<12fH", 0, 0, 0, *rows[i], *rows[i + 1], *rows[i + 2], 0) for i in range(0, len(rows), 3)
    )
    return b"solid? no: binary".ljust(80) + struct.pack("<I", len(rows) // 3) + body


def gltf(vertices: list[list[float]], triangles: list[list[int]], moved: list[float]) -> str:
    import base64

    data = np.array(vertices, "<f4").tobytes() + np.array(triangles, "<u2").tobytes()
    split = 12 * len(vertices)
    return json.dumps(
        {
            "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
            "nodes": [{"mesh": 0, "translation": moved}],
            "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
            "buffers": [{
                "byteLength": len(data), "uri": "data:application/octet-stream;base64," + base64.b64encode(data).decode()
            }],
            "bufferViews": [
                {"buffer": 0, "byteOffset": 0, "byteLength": split},
                {"buffer": 0, "byteOffset": split, "byteLength": len(data) - split},
            ],
            "accessors": [
                {"bufferView": 0, "componentType": 5126, "count": len(vertices), "type": "VEC3"},
                {"bufferView": 1, "componentType": 5123, "count": 3 * len(triangles), "type": "SCALAR"},
            ],
        }
    )  # fmt: skip


TETRAHEDRON = ([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
PLY = (
    "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
    "element face 4\nproperty list uchar int vertex_indices\nend_header\n"
    "0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n"
)
OBJ = "o thing\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\ng a\nf 1 3 2\nf 1/1 2/1 4/2\ng b\nf 1//1 4//1 3//1\nf -3 -2 -1\n"


def test_one_tetrahedron_in_every_format(write: Write) -> None:
    off = "OFF\n4 4 6\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n"
    files = [
        write("a.off", off), write("a.obj", OBJ), write("a.stl", STL), write("b.stl", triangles_of(STL)),
        write("a.ply", PLY), write("a.gltf", gltf(*TETRAHEDRON, moved=[5.0, 0, 0])),
    ]  # fmt: skip
    for path in files:
        found = shapelib.polyhedron(path, at=(0, 1, 0))
        assert found.notes == []
        counts = {name: found.counts[name] for name in ("welded vertices", "edges", "faces", "triangles", "pieces")}
        assert list(counts.values()) == [4, 6, 4, 4, 1], (path, counts)
        assert found.counts["volume"] == pytest.approx(1 / 6) and found.counts["area"] == pytest.approx(
            1.5 + math.sqrt(3) / 2
        )
        system = iota.System()
        (body,) = found.realize(system).bodies
        assert body.mass == pytest.approx(1000 / 6, rel=1e-5)
        assert tuple(body.center_of_mass) == pytest.approx((0, 1, 0), abs=1e-6)


def test_endings_may_be_in_capitals(write: Write) -> None:
    files = {
        "A.PDB": ETHANOL_PDB, "A.MOL": CARBON_MONOXIDE_MOL, "A.XYZ": WATER_XYZ, "A.OBJ": OBJ, "A.STL": STL, "B.STL": triangles_of(STL),
        "A.PLY": PLY, "A.GLTF": gltf(*TETRAHEDRON, moved=[0.0, 0, 0]), "A.URDF": PENDULUM_URDF, "A.XML": MJCF, "A.MJCF": MJCF,
    }  # fmt: skip
    for name, contents in files.items():
        large, small = shapelib.load(write(name, contents)), shapelib.load(write(name.lower(), contents))
        assert large.counts == small.counts and large.counts, name
    text = gltf(*TETRAHEDRON, moved=[0.0, 0, 0]).encode()
    text += b" " * (-len(text) % 4)
    head = struct.pack("<4sIIII", b"glTF", 2, 20 + len(text), len(text), 0x4E4F534A)
    for path in (write("C.GLB", head + text), write("C.GLTF", text)):
        assert len(shapelib.read_model(path)[0].faces) == 4
    assert shapelib.molecule(str(write("D.XYZ", WATER_XYZ))).counts["atoms"] == 3
    assert shapelib.polyhedron(str(write("D.OBJ", OBJ))).counts["faces"] == 4


def test_a_truncated_ply_file_of_text_is_refused_with_its_first_short_row(write: Write) -> None:
    lines = PLY.splitlines()
    first = lines.index("end_header") + 2  # line of the first vertex
    for end, line, what in (
        (first + 1, first + 1, "vertex 3 (of 4) is missing"),
        (first + 5, first + 5, "face 3 (of 4)"),
    ):
        fails(write("a.ply", "\n".join(lines[:end])), f"line {line}: {what}")
    short = "\n".join([*lines[:first], lines[first].split()[0]])
    fails(write("b.ply", short), f"line {first + 1}: vertex 2 (of 4) has 1 of 3 values")
    short = "\n".join([*lines[: first + 3], "3 0 2"])
    fails(write("c.ply", short), f"line {first + 4}: face 1 (of 4) has 3 of 4 values")


def test_a_ply_file_with_a_damaged_header_is_refused_with_its_line(write: Write) -> None:
    fails(write("a.ply", PLY.replace("vertex 4\nproperty", "vertex 4property")), "line 3", "a name and a number")
    fails(write("b.ply", PLY.replace("float z\nelement", "float z\nproperty\nelement")), "line 7", "a type and a name")
    fails(write("c.ply", PLY.replace("3 1 2 3", "\xb2 1 2").encode("latin-1")), "c.ply")
    fails(write("d.ply", PLY.replace("face 4", "face -1")), "line 7", "the number of face is -1")


@pytest.mark.parametrize("order", ["little", "big"])
def test_a_binary_ply_file_with_a_wrong_list_length_is_refused_with_its_face(write: Write, order: str) -> None:
    head = PLY[: PLY.index("0 0 0")].replace("ascii", f"binary_{order}_endian").encode()
    sign = "<" if order == "little" else ">"
    places, faces = TETRAHEDRON

    def file(name: str, lengths: tuple[int, ...]) -> Path:
        rows = [struct.pack(sign + "B3i", length, *face) for length, face in zip(lengths, faces, strict=True)]
        return write(name, head + b"".join(struct.pack(sign + "3f", *place) for place in places) + b"".join(rows))

    assert shapelib.polyhedron(file("a.ply", (3, 3, 3, 3))).counts["faces"] == 4
    wrong = file("b.ply", (3, 3, 7, 3))
    fails(wrong, "b.ply", "face 3 (of 4) has a list of 7, the first one of 3")
    with pytest.raises(shapelib.FileError, match="face 3"):
        iota.Mesh.load(wrong)
    fails(file("c.ply", (4, 3, 3, 3)), "c.ply")


def test_polygons_stay_polygons_and_pieces_become_bodies(write: Write) -> None:
    cube = shapelib.polyhedron(write("cube.off", CUBE_OFF))
    assert (cube.counts["faces"], cube.counts["triangles"], cube.counts["edges"]) == (6, 12, 12)
    far = "\n".join(
        f"vertex {float(line.split()[1]) + 5} {' '.join(line.split()[2:])}" if line.startswith("vertex") else line
        for line in STL.replace("Left", "RIGHT").splitlines()
    )
    two = shapelib.polyhedron(write("two.stl", STL + far + "\n"))
    assert [body.name for body in two.bodies] == ["Left half", "RIGHT half"]
    assert two.counts["pieces"] == 2 and two.counts["triangles"] == 8
    distance = np.asarray(two.bodies[1].position) - np.asarray(two.bodies[0].position)
    assert distance == pytest.approx([5, 0, 0])


def test_a_concave_face_is_cut_into_triangles_within_it(write: Write) -> None:
    arrow = [(0, 0), (2, 1), (4, 0), (2, 4)]  # the second corner points inwards
    rows = [f"{x} {y} {z}" for z in (0, 1) for x, y in arrow]
    sides = [f"4 {i} {(i + 1) % 4} {(i + 1) % 4 + 4} {i + 4}" for i in range(4)]
    text = "OFF\n8 6 0\n" + "\n".join([*rows, "4 3 2 1 0", "4 4 5 6 7", *sides]) + "\n"
    found = shapelib.polyhedron(write("arrow.off", text))
    assert found.counts["volume"] == pytest.approx(6.0)
    perimeter = 2 * math.hypot(2, 1) + 2 * math.hypot(2, 4)
    assert found.counts["area"] == pytest.approx(12 + perimeter)


def test_a_surface_that_is_inside_out_is_turned_and_says_so(write: Write) -> None:
    rows = CUBE_OFF.splitlines()
    turned = rows[:10] + [" ".join([row.split()[0], *row.split()[4:0:-1]]) for row in rows[10:]]
    found = shapelib.polyhedron(write("inside.off", "\n".join(turned)))
    assert found.counts["volume"] == pytest.approx(1) and found.notes == ["its faces were wound inward and were turned"]


def test_a_cavity_stays_in_its_body(write: Write) -> None:
    outer = CUBE_OFF.splitlines()[2:10]
    shell = [[float(v) for v in row.split()[:3]] for row in outer]
    inner = [[0.25 + 0.5 * v for v in row] for row in shell]
    faces = [row.split()[1:5] for row in CUBE_OFF.splitlines()[10:]]
    hollow = [[str(int(v) + 8) for v in face[::-1]] for face in faces]
    text = "OFF\n16 12 0\n" + "\n".join(
        [" ".join(map(str, row)) for row in shell + inner] + ["4 " + " ".join(face) for face in faces + hollow]
    )
    found = shapelib.polyhedron(write("hollow.off", text))
    assert len(found.bodies) == 1 and found.counts["volume"] == pytest.approx(1 - 0.125)


def test_damaged_surfaces_are_refused_with_file_and_line(write: Write) -> None:
    fails(
        write("a.off", CUBE_OFF.replace("4 2 3 7 6", "4 2 3 8 6")),
        "line 15",
        "face 5 (of 6, line 15) uses vertex 8",
        "0..7",
    )
    fails(write("b.off", "\n".join(CUBE_OFF.splitlines()[:7])), "ends after 5 of 8 vertices")
    fails(write("c.off", "\n".join(CUBE_OFF.splitlines()[:12])), "ends after 2 of 6 faces")
    fails(write("d.off", CUBE_OFF.replace("OFF", "PNG")), "line 1", "begins with OFF")
    fails(write("e.off", "\n".join([*CUBE_OFF.splitlines()[:1], "8 5 0", *CUBE_OFF.splitlines()[2:15]])), "open")
    twice = CUBE_OFF.replace("8 6 0", "8 7 0") + "4 3 0 4 7\n"
    fails(write("f.off", twice), "is in 3 faces")
    fails(write("g.off", CUBE_OFF.replace("4 3 0 4 7", "4 7 4 0 3")), "the same direction", "line 16")
    fails(write("h.off", "OFF\n99999999 1 0\n"), "line 2", "more than 1000000")
    fails(write("i.obj", OBJ.replace("f 1 3 2", "f 1 9 2")), "line 7", "face 1 (of 4, line 7) uses vertex 9", "1..4")
    fails(write("j.obj", OBJ.replace("v 1 0 0", "v 1 zero 0")), "line 3", "'zero'")
    fails(write("k.obj", "<html>\n"), "line 1", "no lines that begin with")
    fails(write("l.stl", STL[:200]), "truncated")
    fails(write("m.stl", triangles_of(STL)[:-7]), "4 triangles need 284 bytes, it has 277")
    fails(write("n.stl", "solid x\nendsolid x\n"), "no faces")
    fails(write("o.stl", STL.replace("vertex 0 1 0\nvertex 1 0 0\nendloop", "vertex 0 1 0\nendloop", 1)), "2 vertices")
    fails(write("p.ply", PLY[: PLY.index("end_header")]), "end_header")
    fails(write("q.ply", "\n".join(PLY.splitlines()[:-1])), "q.ply")
    fails(write("r.ply", PLY.replace("3 1 2 3", "3 1 2 9")), "r.ply")
    fails(write("s.gltf", "{"), "not glTF")
    fails(write("t.glb", b"glTF" + bytes(20)), "truncated")
    fails(write("u.off", CUBE_OFF.replace("1 1 1 #", "inf 1 1 #")), "line 9", "finite")
    fails(write("v.ply", PLY[: PLY.index("element face")] + "end_header\n" + "0 0 0\n" * 4), "points without faces")
    packed = {"asset": {"version": "2.0"}, "extensionsRequired": ["KHR_draco_mesh_compression"]}
    fails(write("w.gltf", json.dumps(packed)), "compressed (KHR_draco_mesh_compression)")


def test_surfaces_of_impossible_size_are_refused_with_advice(write: Write) -> None:
    fails(write("a.off", CUBE_OFF.replace("1 1 1 #", "1 1e12 1 #")), "point 7 (of 8)", "smaller scale")
    with pytest.raises(shapelib.FileError, match=r"b.off: a body of it has 1e-42 kg; give scale"):
        shapelib.polyhedron(write("b.off", CUBE_OFF), scale=1e-15)
    assert len(shapelib.polyhedron(write("c.off", CUBE_OFF), scale=1e-15, mass=1.0).bodies) == 1


def test_an_obj_line_may_go_on_in_the_next_one(write: Write) -> None:
    broken = OBJ.replace("f 1 3 2", "f 1 3 \\\n2")
    assert shapelib.polyhedron(write("a.obj", broken)).counts == shapelib.polyhedron(write("b.obj", OBJ)).counts


def test_a_frame_of_rods_keeps_their_lengths_and_a_soft_one_bounces() -> None:
    frame = shapelib.polyhedron("octahedron", kind="flexible", at=(0, 2, 0))
    system = iota.System()
    made = frame.realize(system)
    made.points[0].nail()
    for _ in range(120):
        assert system.step(1 / 120).worst_gap < 1e-8
    assert len(made.bodies) == 12 and system.articulate_count == 1
    soft = shapelib.polyhedron("octahedron", kind="soft", stiffness=500)
    assert len(soft.bonds) == 12 + 3 and soft.points.mass.sum() == pytest.approx(1)


# --- mechanisms -------------------------------------------------------------------------------------------------------

PENDULUM_URDF = """\
<robot name="pendulum">
  <link name="base"/>
  <link name="arm">
    <inertial><origin xyz="0 0 -0.5"/><mass value="2"/><inertia ixx="0.3" iyy="0.2" izz="0.1"/></inertial>
    <visual><origin xyz="0 0 -0.5"/><geometry><cylinder radius="0.05" length="1"/></geometry>
      <material name="red"><color rgba="1 0 0 1"/></material></visual>
  </link>
  <joint name="shoulder" type="revolute">
    <parent link="base"/><child link="arm"/><origin xyz="0 0 2"/><axis xyz="1 0 0"/>
    <limit lower="-3" upper="3" effort="1" velocity="1"/><dynamics damping="0.0" friction="0"/>
  </joint>
</robot>
"""


def test_a_urdf_pendulum_swings_with_the_period_of_its_inertia(write: Write) -> None:
    found = shapelib.mechanism(write("pendulum.urdf", PENDULUM_URDF))
    assert (found.counts["links"], found.counts["joints"], found.counts["mass"]) == (2, 1, 2.0)
    system = iota.System()
    made = found.realize(system)
    arm, angle = made["arm"], made["shoulder"].angle
    assert tuple(arm.center_of_mass) == pytest.approx((0, 1.5, 0), abs=1e-9)
    assert arm.inertia == pytest.approx(np.diag([0.3, 0.1, 0.2]), abs=1e-4)  # z up becomes y up
    arm.angular_velocity = (0.05, 0, 0)
    crossings, before = [], angle.value
    for step in range(2000):
        system.step(1 / 500)
        if before < 0 <= angle.value:
            crossings.append((step + 1 - angle.value / (angle.value - before)) / 500)
        before = angle.value
    period = 2 * math.pi * math.sqrt((0.3 + 2 * 0.25) / (2 * 9.81 * 0.5))
    assert crossings[1] - crossings[0] == pytest.approx(period, rel=2e-3)


def test_unsupported_parts_of_a_urdf_are_listed(write: Write) -> None:
    more = """
  <link name="finger"/><link name="other"/><link name="cover"><visual><geometry><mesh filename="package://x/lid.stl"/>
  </geometry></visual></link>
  <joint name="slide" type="prismatic"><parent link="arm"/><child link="finger"/><limit lower="-1" upper="2"/></joint>
  <joint name="copy" type="prismatic"><parent link="arm"/><child link="other"/><mimic joint="slide"/></joint>
  <joint name="lid" type="fixed"><parent link="arm"/><child link="cover"/></joint>
  <link name="cover2"/>
  <joint name="lid2" type="fixed"><parent link="arm"/><child link="cover2"/><mimic joint="slide"/></joint>
  <transmission name="t"/>
</robot>"""
    found = shapelib.mechanism(write("more.urdf", PENDULUM_URDF.replace("</robot>", more)))
    assert found.counts["moving joints"] == 3 and found.counts["independent joints"] == 2
    text = " ".join(found.notes)
    for part in (
        "lid2 mimics slide, but lid2 is fixed",
        "1 mesh is missing",
        "package://x/lid.stl",
        "1 <transmission>",
    ):
        assert part in text
    slide = next(joint for joint in found.joints if joint.name == "slide")
    assert slide.kind == "prismatic" and slide.options["limits"] == (-1, 2)


GEARED_URDF = """\
<robot name="geared">
  <link name="base"/>
  <link name="crank"><inertial><origin xyz="0.3 0 0"/><mass value="1"/><inertia ixx="0.1" iyy="0.1" izz="0.1"/></inertial></link>
  <link name="follower"><inertial><origin xyz="0.3 0 0"/><mass value="1"/><inertia ixx="0.1" iyy="0.1" izz="0.1"/></inertial></link>
  <link name="rack"><inertial><mass value="1"/><inertia ixx="0.1" iyy="0.1" izz="0.1"/></inertial></link>
  <joint name="first" type="continuous"><parent link="base"/><child link="crank"/><axis xyz="0 0 1"/></joint>
  <joint name="second" type="revolute"><parent link="base"/><child link="follower"/><origin xyz="1 0 0"/><axis xyz="0 0 2"/>
    <limit lower="-2" upper="0.4"/><mimic joint="first" multiplier="-0.5" offset="0.3"/></joint>
  <joint name="third" type="prismatic"><parent link="base"/><child link="rack"/><origin xyz="0 1 0"/><axis xyz="1 0 0"/>
    <mimic joint="second" multiplier="0.2" offset="-0.1"/></joint>
</robot>
"""


def turn_about_up(body: iota.Body, axle: float = 0.0) -> float:
    """Where its center of mass is, as an angle about an upright axle at x = axle, rad."""
    place = body.center_of_mass
    return math.atan2(-place.z, place.x - axle)


@pytest.mark.parametrize("scale", [1.0, 3.0])
def test_joints_of_a_urdf_that_mimic_others_follow_them(write: Write, scale: float) -> None:
    """Angles and places of the links themselves: second = 0.3 - 0.5 first, third = 0.2 second - 0.1."""
    found = shapelib.mechanism(write("geared.urdf", GEARED_URDF), scale=scale)
    assert found.counts["independent joints"] == 1 and found.notes == []
    system = iota.System(gravity=(0, 0, 0))
    made = found.realize(system)
    crank, follower, rack = (made[name] for name in ("crank", "follower", "rack"))
    assert turn_about_up(follower, scale) == pytest.approx(0.3) and rack.center_of_mass.x == pytest.approx(
        -0.04 * scale
    )
    assert made["second"].angle.limits == pytest.approx((-2.3, 0.1))
    assert made["second mimics first"].kind == "coupling"
    made["first"].angle.motor = (2.0, 50)
    for _ in range(120):
        system.step(1 / 120)
        second = 0.3 - 0.5 * turn_about_up(crank)
        assert turn_about_up(follower, scale) == pytest.approx(second, abs=1e-5)
        assert rack.center_of_mass.x == pytest.approx(scale * (0.2 * second - 0.1), abs=1e-5 * scale)
    assert turn_about_up(crank) > 1.5
    made["first"].angle.motor = (0.0, 1e5)
    system.step(1 / 120)
    made["first"].angle.motor, before = None, turn_about_up(crank)
    for _ in range(12):  # who pushes a follower turns its leader
        rack.apply_force((-100, 0, 0))
        system.step(1 / 120)
    assert turn_about_up(crank) > before + 1e-3


def test_a_planar_joint_of_a_urdf_keeps_its_link_in_a_plane(write: Write) -> None:
    path = write("table.urdf", PENDULUM_URDF.replace('"revolute"', '"planar"'))
    system = iota.System()
    made = shapelib.mechanism(path).realize(system)
    begun = made["arm"].center_of_mass
    for _ in range(60):
        system.step(1 / 120)
    fallen = begun - made["arm"].center_of_mass
    # Its axis is level: it falls freely in an upright plane, and does not leave it.
    assert fallen.y == pytest.approx(9.81 / 2 * 0.5**2, rel=1e-3) and abs(fallen.x) < 1e-9 and abs(fallen.z) < 1e-9


def test_meshes_beside_a_urdf_are_drawn_but_never_ones_outside(write: Write, tmp_path: Path) -> None:
    write("lid.off", CUBE_OFF)
    cover = '<visual><geometry><mesh filename="{}" scale="2 2 2"/></geometry></visual></link>\n  <link name="arm">'
    path = write(
        "a.urdf",
        PENDULUM_URDF.replace(
            '<link name="base"/>\n  <link name="arm">', '<link name="base">' + cover.format("lid.off")
        ),
    )
    found = shapelib.mechanism(path)
    (base,) = (body for body in found.bodies if body.name == "base")
    assert isinstance(base.shape, iota.Mesh) and found.looks["base"][0].shape is None  # type: ignore[index, union-attr]
    (tmp_path / "inner").mkdir()
    path = write("inner/b.urdf", path.read_text().replace('"lid.off"', '"../lid.off"'))
    assert "missing" in " ".join(shapelib.mechanism(path).notes)


def test_damaged_mechanisms_are_refused_with_file_and_line(write: Write) -> None:
    loop = '<joint name="back" type="fixed"><parent link="arm"/><child link="arm"/></joint>\n</robot>'
    fails(write("a.urdf", PENDULUM_URDF.replace("</robot>", loop)), "line 12", "arm has two parents (shoulder, back)")
    ring = (
        '<robot name="r"><link name="a"/><link name="b"/>\n<joint name="x" type="fixed"><parent link="a"/><child link="b"/>'
        '</joint>\n<joint name="y" type="fixed"><parent link="b"/><child link="a"/></joint></robot>'
    )
    fails(write("b.urdf", ring), "loop without a root")
    fails(write("c.urdf", PENDULUM_URDF[:300]), "not XML", "line")
    fails(write("d.urdf", '<!DOCTYPE r [<!ENTITY a "b">]>\n' + PENDULUM_URDF), "line 1", "DTD")
    fails(write("e.urdf", PENDULUM_URDF.replace('"2"', '"heavy"')), "line 4", "'heavy'")
    fails(write("f.urdf", PENDULUM_URDF.replace('child link="arm"', 'child link="leg"')), "line 8", "leg")
    fails(write("g.urdf", PENDULUM_URDF.replace('upper="3"', 'upper="-4"')), "line 10", "limit")
    fails(write("h.urdf", PENDULUM_URDF.replace("<axis xyz=", "<axis xyz='0 0'")), "not XML")
    fails(write("i.urdf", PENDULUM_URDF.replace('xyz="1 0 0"', 'xyz="0 0 0"')), "line 9", "axis")
    fails(write("j.xml", "<html/>"), "neither <robot>")
    wide = PENDULUM_URDF.replace('ixx="0.3" iyy="0.2" izz="0.1"', 'ixx="1e30" iyy="1e30" izz="1e30"')
    fails(write("q.urdf", wide), "line 4", "the inertia of the link arm fits no body")
    wide = MJCF.replace(
        '<body name="lower" pos="0.6 0 0">',
        '<body name="lower"><inertial mass="1" pos="0 0 0" diaginertia="1e30 1e30 1e30"/>',
    )
    fails(write("r.mjcf", wide), "no body can have")
    fails(write("k.urdf", "<robot>" * 300 + "</robot>" * 300), "deep")
    fails(write("l.mjcf", "<mujoco>\n<oops/></mujoco>"), "line 2", "MuJoCo cannot read it")
    fails(write("m.urdf", PENDULUM_URDF.replace('radius="0.05"', 'radius="-1"')), "line 5", "radius")
    mimic = '<mimic joint="elbow"/></joint>'
    fails(
        write("n.urdf", PENDULUM_URDF.replace("</joint>", mimic)), "shoulder mimics elbow, which is not another joint"
    )
    circle = GEARED_URDF.replace("</joint>", '<mimic joint="third"/></joint>', 1)
    fails(write("p.urdf", circle), "line 8", "in a circle: first, third, second, first")
    fails(write("o.urdf", PENDULUM_URDF.replace('link name="arm"', 'link name="${arm}"')), "line 3", "xacro")


def test_an_mjcf_file_that_would_fill_the_memory_is_refused_before_mujoco_builds_it(write: Write) -> None:
    copies = (
        '<mujoco><worldbody>\n<replicate count="1000"><replicate count="1000"><geom size="1"/></replicate></replicate>'
    )
    fails(write("a.xml", copies + "</worldbody></mujoco>"), "line 2", "makes 1000000 copies, more than 10000")
    field = '<mujoco><asset><hfield name="h" nrow="100000" ncol="100000" size="1 1 1 1"/></asset></mujoco>'
    fails(write("b.xml", field), "line 1", "<hfield> has 1e+10 cells")
    write("inner.xml", copies + "</worldbody></mujoco>")
    fails(write("c.xml", '<mujoco><include file="inner.xml"/></mujoco>'), "makes 1000000", at="inner.xml")


def test_an_mjcf_file_includes_neither_itself_nor_files_outside_of_its_folder(write: Write, tmp_path: Path) -> None:
    (tmp_path / "inner").mkdir()
    inner = MJCF.replace('<mujoco model="arm">', "<mujoco>")
    write("inner/arm.xml", inner)
    around = '<mujoco model="m">\n<include file="FILE"/></mujoco>'
    assert shapelib.mechanism(write("a.xml", around.replace("FILE", "inner/arm.xml"))).counts["bodies"] == 2
    fails(write("b.xml", around.replace("FILE", "b.xml")), "line 2", "b.xml includes itself")
    write("d.xml", around.replace("FILE", "c.xml"))
    fails(write("c.xml", around.replace("FILE", "d.xml")), "line 2", "c.xml includes itself", at="d.xml")
    write("secret.xml", inner)
    out = "leads out of the model's folder"
    fails(write("inner/e.xml", around.replace("FILE", "../secret.xml")), "line 2", out)
    fails(write("f.xml", around.replace("FILE", "/etc/passwd")), "line 2", out)
    for part in ('<compiler meshdir="../meshes"/>', '<asset><mesh file="/tmp/part.stl"/></asset>'):
        fails(write("g.xml", f"<mujoco>\n{part}</mujoco>"), "line 2", out)
    fails(
        write("h.xml", around.replace("FILE", "none.xml")), "line 2: <include> names 'none.xml', which does not exist"
    )
    fails(write("i.xml", around.replace("FILE", "inner")), "is a folder", at="inner")


def test_a_file_that_an_mjcf_file_includes_may_have_any_ending_and_lie_beside_the_one_that_includes_it(
    write: Write, tmp_path: Path
) -> None:
    (tmp_path / "inner").mkdir()
    inner = MJCF.replace('<mujoco model="arm">', "<mujoco>")
    around = '<mujoco model="m">\n<include file="FILE"/></mujoco>'
    write("inner/arm.txt", inner)
    for name, via in (
        ("a.xml", "arm.txt"),
        ("b.xml", "inner/arm.txt"),
    ):  # from the folder of the file, and of the model
        write("inner/via.inc", f'<mujoco><include file="{via}"/></mujoco>')
        assert shapelib.mechanism(write(name, around.replace("FILE", "inner/via.inc"))).counts["bodies"] == 2
    write(
        "inner/arm.txt",
        '<mujoco><worldbody>\n<replicate count="20000"><geom size="1"/></replicate></worldbody></mujoco>',
    )
    fails(tmp_path / "b.xml", "line 2", "makes 20000 copies", at="inner/arm.txt")
    write("inner/arm.txt", inner.replace("size=", "sise=", 1))
    fails(tmp_path / "b.xml", "line 3", "unrecognized attribute: 'sise'", at="inner/arm.txt")


def test_warnings_of_mujoco_are_noted_and_not_written_into_a_file(
    write: Write, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    path = write("arm.xml", MJCF.replace("</mujoco>", '<keyframe><key qpos="nan 0 0"/></keyframe></mujoco>'))
    assert any("contains a 'NaN'" in note for note in shapelib.mechanism(path).notes)
    assert [found.name for found in tmp_path.iterdir()] == ["arm.xml"]


MJCF = """\
<mujoco model="arm">
  <compiler angle="radian"/>
  <default><geom type="capsule" size="0.05" density="900"/></default>
  <worldbody>
    <geom type="plane" size="5 5 1"/>
    <body name="upper" pos="0 0 2">
      <joint name="yaw" axis="0 0 1"/><joint name="pitch" axis="0 1 0" damping="0.2"/>
      <geom fromto="0 0 0 0.6 0 0"/>
      <body name="lower" pos="0.6 0 0">
        <joint name="elbow" axis="0 1 0" range="-2 2" limited="true"/>
        <geom fromto="0 0 0 0.5 0 0.1"/>
      </body>
    </body>
  </worldbody>
  <actuator><motor joint="elbow"/></actuator>
</mujoco>
"""


def test_an_mjcf_arm_falls_as_mujoco_lets_it_fall(write: Write) -> None:
    import mujoco

    found = shapelib.mechanism(write("arm.xml", MJCF))
    assert (found.counts["bodies"], found.counts["joints"], found.counts["degrees of freedom"]) == (2, 3, 3)
    system = iota.System()
    made = found.realize(system)
    model = mujoco.MjModel.from_xml_string(MJCF)
    state = mujoco.MjData(model)
    model.opt.timestep = 1 / 4000
    model.opt.integrator = mujoco.mjtIntegrator.mjINT_RK4
    made["yaw"].angle  # noqa: B018
    for _ in range(120):
        system.step(1 / 400)
    mujoco.mj_step(model, state, 1200)
    for number, name in ((1, "upper"), (2, "lower")):
        x, y, z = state.xipos[number]
        assert tuple(made[name].center_of_mass) == pytest.approx((x, z, -y), abs=3e-3)
        assert made[name].mass == pytest.approx(model.body_mass[number], rel=2e-3)  # a thousandth is in the ring
    assert abs(made["lower"].center_of_mass.y - 2) > 0.2
    assert sum(body.mass for body in system.bodies) == pytest.approx(model.body_mass.sum())


def test_mjcf_loops_and_ropes_become_ours(write: Write) -> None:
    more = """
  <equality><connect body1="lower" anchor="0.5 0 0.1"/></equality>
</mujoco>"""
    found = shapelib.mechanism(write("loop.xml", MJCF.replace("</mujoco>", more)))
    ball = found.joints[-1]
    assert ball.kind == "ball" and ball.b is None and ball.options["at"] == pytest.approx((1.1, 2.1, 0))
    system = iota.System()
    found.realize(system)
    for _ in range(60):
        assert system.step(1 / 120).worst_gap < 1e-8
    sites = MJCF.replace('<geom type="plane"', '<site name="p" pos="0 0 3"/><geom type="plane"').replace(
        '<geom fromto="0 0 0 0.5 0 0.1"/>', '<geom fromto="0 0 0 0.5 0 0.1"/><site name="q" pos="0.5 0 0.1"/>'
    )
    rope = '<tendon><spatial limited="true" range="0 1.5"><site site="p"/><site site="q"/></spatial></tendon></mujoco>'
    tied = shapelib.mechanism(write("rope.xml", sites.replace("</mujoco>", rope)))
    assert [(tie.kind, tie.length) for tie in tied.ties] == [("rope", 1.5)]
    assert tied.problems() == []


LINKS = """<mujoco>
  <worldbody>
    <geom type="box" size="0.5 0.5 0.1" pos="3 0 0.1"/>
    <body name="box" pos="0 0 0.5"><freejoint/><geom type="box" size="0.1 0.2 0.05" density="500"/></body>
    <body name="dumbbell" pos="1 0 0.5"><freejoint/>
      <geom type="sphere" size="0.1" pos="-0.2 0 0"/><geom type="sphere" size="0.1" pos="0.2 0 0"/>
      <geom type="capsule" size="0.03" fromto="-0.2 0 0 0.2 0 0"/>
      <geom type="box" size="0.3 0.3 0.3" contype="0" conaffinity="0" mass="0"/>
    </body>
    <body name="on the table" pos="3 0 0.6"><freejoint/>
      <inertial pos="0 0 -0.02" mass="2" diaginertia="0.02 0.03 0.04"/><geom type="cylinder" size="0.1 0.05"/>
    </body>
    <body name="ghost" pos="0 0 0.5"><freejoint/><geom size="0.1" contype="0" conaffinity="0"/></body>
  </worldbody>
</mujoco>"""


def test_links_touch_by_the_shapes_of_their_file_and_have_its_inertia(write: Write) -> None:
    import mujoco

    model = mujoco.MjModel.from_xml_string(LINKS)
    system = iota.System()
    made = shapelib.mechanism(write("links.xml", LINKS)).realize(system)
    for number in range(1, model.nbody):
        body = made[model.body(number).name]
        assert body.mass == pytest.approx(model.body_mass[number], rel=1e-9)
        principal = np.sort(np.linalg.eigvalsh(np.array(body.inertia)))
        assert principal == pytest.approx(np.sort(model.body_inertia[number]), rel=1e-6)
    assert len(made["dumbbell"].solids) == 3, "what is only seen does not touch"
    assert made["ghost"].material == iota.Material(touches="nothing")
    world = iota.World(system, ground=0.0)
    world.advance(360)
    heights = {name: made[name].center_of_mass.y for name in ("box", "dumbbell", "on the table")}
    assert heights == pytest.approx({"box": 0.05, "dumbbell": 0.1, "on the table": 0.23}, abs=1e-4)


def test_links_of_a_urdf_file_touch_by_their_collisions_and_else_by_what_is_seen(write: Write) -> None:
    text = """<robot name="two">
  <link name="a">
    <inertial><origin xyz="0.05 0 0"/><mass value="2"/><inertia ixx="0.02" iyy="0.03" izz="0.04" ixy="0" ixz="0" iyz="0"/></inertial>
    <visual><geometry><box size="1 1 1"/></geometry></visual>
    <collision><geometry><box size="0.4 0.4 0.2"/></geometry></collision>
    <collision><origin xyz="0.3 0 0"/><geometry><sphere radius="0.1"/></geometry></collision>
  </link>
  <link name="ghost"><visual><geometry><sphere radius="0.1"/></geometry></visual></link>
</robot>"""
    seen = text.replace("collision", "hidden").replace("1 1 1", "0.6 0.4 0.3")
    for content, shapes, height in ((text, 2, 0.1), (seen, 1, 0.15)):
        system = iota.System()
        made = shapelib.mechanism(write("two.urdf", content), base="free", at=(0, 1, 0)).realize(system)
        body, ghost = made["a"], made["ghost"]
        assert (ghost.material is None) == (content == seen)
        ghost.position = (5, 5, 5)
        assert len(body.solids) == shapes
        assert tuple(body.center_of_mass) == pytest.approx((0.05, 1, 0), abs=1e-12)
        assert np.array(body.inertia) == pytest.approx(np.diag([0.02, 0.04, 0.03]), abs=1e-9)  # y up
        iota.World(system, ground=0.0).advance(360)
        assert body.center_of_mass.y == pytest.approx(height, abs=1e-4)


def test_an_enlarged_mechanism_moves_as_before(write: Write) -> None:
    """With masses and times kept and gravity as much larger, slides are as much larger and angles the same at all times."""
    text = """<robot name="r"><link name="base"/>
  <link name="cart"><inertial><mass value="2"/><inertia ixx="0.1" iyy="0.1" izz="0.1"/></inertial></link>
  <link name="arm"><inertial><origin xyz="0.3 0 0"/><mass value="1"/><inertia ixx="0.02" iyy="0.03" izz="0.02"/></inertial></link>
  <joint name="lift" type="prismatic"><parent link="base"/><child link="cart"/><axis xyz="0 0 1"/>
    <limit lower="-0.15" upper="0.3"/><dynamics damping="3" friction="0.5"/></joint>
  <joint name="hinge" type="revolute"><parent link="cart"/><child link="arm"/><axis xyz="0 1 0"/>
    <limit lower="-2" upper="2"/><dynamics damping="0.3" friction="0.2"/></joint>
</robot>"""
    path = write("lift.urdf", text)
    ways = []
    for scale in (1.0, 10.0):
        data = read_urdf(path)
        lift, hinge = (next(joint for joint in data.joints if joint.name == name) for name in ("lift", "hinge"))
        lift.options["spring"], hinge.options["spring"] = (50.0, 3.0, 0.2), (2.0, 0.3, -0.1)
        system = iota.System(gravity=(0, -9.81 * scale, 0))
        made = to_structure(data, (0, 0, 0), scale).realize(system)
        way = []
        for _ in range(120):
            system.step(1 / 240)
            way.append((made["lift"].slide.value / scale, made["hinge"].angle.value))
        ways.append(np.array(way))
    assert np.ptp(ways[0], axis=0).min() > 0.1
    assert ways[1] == pytest.approx(ways[0], abs=2e-4)


ONE_LINK = """<robot name="r"><link name="a"><inertial><mass value="1"/><inertia ixx="0.1" iyy="0.1" izz="0.1"/></inertial>
{}</link></robot>"""
CORNER = [(0, 0, 0), (0.3, 0, 0), (0, 0.2, 0), (0, 0, 0.1)]
FACES = [(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)]


def off(triangles: Sequence[Sequence[int]]) -> str:
    rows = [" ".join(map(str, place)) for place in CORNER]
    return "\n".join(["OFF", f"4 {len(triangles)} 0", *rows, *("3 " + " ".join(map(str, each)) for each in triangles)])


def test_mirrored_and_open_meshes_of_a_urdf_are_taken(write: Write) -> None:
    faces = FACES
    write("whole.off", off(faces))
    write("open.off", off(faces[:3]))
    write("reversed.off", off([face[::-1] for face in faces]))
    mesh = '<{0}><geometry><mesh filename="{1}.off" scale="{2}"/></geometry></{0}>'

    def read(*parts: str) -> shapelib.Imported:
        return shapelib.mechanism(write("m.urdf", ONE_LINK.format("".join(parts))), base="free")

    def mesh_in(found: shapelib.Imported) -> iota.Mesh:
        shape = found.bodies[0].shape
        assert isinstance(shape, iota.Mesh)
        return shape

    found = read(mesh.format("collision", "whole", "1 -1 1"))
    made = found.realize(iota.System())["a"]
    assert found.notes == [] and mesh_in(found).mass_properties.volume == pytest.approx(1e-3)
    assert np.array(mesh_in(found).vertices)[:, 1].min() == pytest.approx(-0.2)
    assert tuple(made.center_of_mass) == pytest.approx((0, 0, 0))
    found = read(mesh.format("collision", "reversed", "1 1 1"))
    assert found.notes == ["the mesh reversed.off is inside out, and turned round"]
    found = read(
        mesh.format("visual", "open", "1 1 1"), '<collision><geometry><box size="1 1 1"/></geometry></collision>'
    )
    assert found.notes == [] and isinstance(found.bodies[0].shape, iota.Box)
    look = found.looks["a"]
    look = look[0] if isinstance(look, list) else look
    assert isinstance(look, iota.looks.Look) and isinstance(look.shape, iota.Mesh) and not look.shape.closed
    system = iota.System()
    found.realize(system, iota.World(system, ground=None))
    for kind in ("visual", "collision"):
        found = read(mesh.format(kind, "open", "1 1 1"))
        assert found.notes == ["the link a touches by the convex hull of an open mesh"]
        assert mesh_in(found).mass_properties.volume == pytest.approx(1e-3)
    found = read(mesh.format("collision", "open", "1 1 0"))
    assert "does not touch by one of its shapes" in found.notes[0] and not found.bodies[0].touches
    fixed = ONE_LINK.format(mesh.format("collision", "open", "1 1 1")).replace("inertial", "other")
    found = shapelib.mechanism(write("m.urdf", fixed))
    assert found.bodies[0].kind == "static" and not mesh_in(found).closed


def test_colors_of_a_urdf_have_their_opacity(write: Write) -> None:
    seen = '<visual><geometry><box size="1 1 1"/></geometry><material name="{0}"><color rgba="1 0 0 {1}"/></material></visual>'
    parts = seen.format("glass", 0.2) + seen.format("brick", 1)
    look = shapelib.mechanism(write("c.urdf", ONE_LINK.format(parts)), base="free").looks["a"]
    assert isinstance(look, list)
    assert [each.color for each in look] == ["#ff000033", "#ff0000"]


def test_a_capsule_of_a_urdf_lies_along_z(write: Write) -> None:
    capsule = '<collision><geometry><capsule radius="0.1" length="0.6"/></geometry></collision>'
    system = iota.System()
    found = shapelib.mechanism(write("c.urdf", ONE_LINK.format(capsule)), base="free", at=(0, 1, 0))
    found.realize(system)
    hit = iota.World(system, ground=None).queries.ray((0, 3, 0), (0, -1, 0))
    assert hit is not None and hit.point.y == pytest.approx(1.4)


BARE_ARM = """<robot name="r">
  <link name="base"/><link name="foot"><collision><geometry><box size="0.1 0.1 0.1"/></geometry></collision></link>
  <joint name="stand" type="fixed"><parent link="base"/><child link="foot"/><origin xyz="0 0 -0.2"/></joint>
  <link name="arm"><inertial><origin xyz="0.3 0.1 -0.2"/><mass value="2"/><inertia ixx="1" iyy="0.8" izz="0.6"/></inertial></link>
  <joint name="j" type="continuous"><parent link="base"/><child link="arm"/><origin xyz="1 2 3"/><axis xyz="0 1 0"/>
    <dynamics damping="0.2"/></joint>
  <link name="flange"/><link name="tool0"><visual><geometry><sphere radius="0.05"/></geometry></visual></link>
  <link name="tag"><inertial><mass value="1e-5"/><inertia ixx="1e-9" iyy="1e-9" izz="1e-9"/></inertial></link>
  <joint name="f" type="fixed"><parent link="arm"/><child link="flange"/><origin xyz="0.5 0 0"/></joint>
  <joint name="t" type="fixed"><parent link="flange"/><child link="tool0"/><origin xyz="0 0 -0.5" rpy="0 0 1.5707963267948966"/></joint>
  <joint name="u" type="fixed"><parent link="flange"/><child link="tag"/></joint>
</robot>"""


@pytest.mark.parametrize("mode", ["energy_keeping", "accurate"])
def test_links_without_mass_are_parts_of_what_they_are_fixed_to(
    write: Write, mode: Literal["energy_keeping", "accurate"]
) -> None:
    """A damped pendulum in the right mode of motion: I a'' = -m g arm(a) - c a', where I is about the axis."""
    found = shapelib.mechanism(write("bare.urdf", BARE_ARM))
    assert [(body.name, body.kind) for body in found.bodies] == [("base", "static"), ("arm", "dynamic")]
    assert found.notes == [
        "4 links without mass are parts of those that they are fixed to: foot (base), flange (arm), tool0 (arm), tag (arm)"
    ]
    system = iota.System(mode=mode)
    made = found.realize(system)
    assert made["arm"].mass == pytest.approx(2 + 1e-5)
    tool, foot = made["tool0"], made["foot"]
    assert tool.body == made["arm"] and foot.body == made["base"] and len(made["base"].solids) == 1
    assert tuple(tool.position) == pytest.approx((1.5, 2.5, -2), abs=1e-12)
    assert tuple(foot.position) == pytest.approx((0, -0.2, 0), abs=1e-12)
    end = tool.attachment()
    for _ in range(120):
        assert system.step(1 / 240).substeps_max <= 2 or mode == "accurate"
    inertia, angle, speed, dt = 0.8 + 2 * (0.09 + 0.04), 0.0, 0.0, 1e-5
    for _ in range(50_000):  # about +y of the file, which is -z here
        level = 0.3 * math.cos(angle) - 0.2 * math.sin(angle)
        speed += dt * (2 * 9.81 * level - 0.2 * speed) / inertia
        angle += dt * speed
    assert made["j"].angle.value == pytest.approx(angle, abs=3e-4)
    x, z = 0.5 * math.cos(angle) - 0.5 * math.sin(angle), -0.5 * math.sin(angle) - 0.5 * math.cos(angle)
    assert tuple(tool.position) == pytest.approx((1 + x, 3 + z, -2), abs=3e-4)
    assert tuple(end.position) == pytest.approx(tuple(tool.position), abs=1e-9)
    arm = tuple(tool.position - iota.Vec3(1, 3, -2))
    assert tuple(tool.velocity) == pytest.approx(np.cross((0, 0, -speed), arm), abs=2e-3)
    ahead = iota.frames.turned(tool.orientation, iota.Vec3(1, 0, 0))  # +x of the tool is y of the file, level
    assert tuple(ahead) == pytest.approx((0, 0, -1), abs=1e-6)
    again = iota.builder.Structure.from_json(json.loads(json.dumps(found.to_json())))
    assert (again + (1, 0, 0)).realize(iota.System())["tool0"].position.x == pytest.approx(2.5)
    row = iota.builder.Structure()
    row.merge(found, prefix="a ")
    row.merge(found, prefix="b ")
    assert row.realize(iota.System())["b tool0"].position.x == pytest.approx(1.5)


def test_a_root_without_mass_is_part_of_the_heavy_link_that_it_holds(write: Write) -> None:
    rover = """<robot name="rover"><link name="base_footprint"/>
  <link name="base_link"><inertial><mass value="5"/><inertia ixx="0.05" iyy="0.08" izz="0.1"/></inertial></link>
  <joint name="fp" type="fixed"><parent link="base_footprint"/><child link="base_link"/><origin xyz="0 0 0.1"/></joint>
  <link name="lidar"/><joint name="l" type="fixed"><parent link="base_link"/><child link="lidar"/></joint>
</robot>"""
    bases: tuple[Literal["free", "fixed"], ...] = ("free", "fixed")
    for base in bases:
        found = shapelib.mechanism(write("rover.urdf", rover), base=base)
        assert [body.name for body in found.bodies] == ["base_link"]
        assert [joint.name for joint in found.joints] == ["base_footprint to the world"][: base == "fixed"]
        system = iota.System()
        made = found.realize(system)
        for _ in range(60):
            system.step(1 / 120)
        fallen = 9.81 / 2 * 0.5**2 if base == "free" else 0.0
        assert made["base_footprint"].position.y == pytest.approx(-fallen, rel=1e-2, abs=1e-9)
        assert made["base_link"].position.y == pytest.approx(0.1 - fallen, rel=1e-2)


def test_links_without_mass_between_moving_joints_have_a_share_of_what_they_carry(write: Write) -> None:
    text = """<robot name="r"><link name="base"/><link name="cross"/>
  <link name="arm"><inertial><origin xyz="0 0 -0.3"/><mass value="2"/><inertia ixx="0.1" iyy="0.1" izz="0.05"/></inertial></link>
  <link name="jaw"/>
  <joint name="a" type="continuous"><parent link="base"/><child link="cross"/><axis xyz="1 0 0"/></joint>
  <joint name="b" type="continuous"><parent link="cross"/><child link="arm"/><axis xyz="0 1 0"/></joint>
  <joint name="c" type="continuous"><parent link="arm"/><child link="jaw"/><axis xyz="0 0 1"/></joint></robot>"""
    found = shapelib.mechanism(write("cross.urdf", text))
    assert found.notes == ["2 links have no mass, and a thousandth of a neighbor's: cross (0.002 kg), jaw (0.002 kg)"]
    system = iota.System()
    made = found.realize(system)
    assert made["cross"].mass + made["arm"].mass == pytest.approx(2, rel=1e-12)
    made["arm"].angular_velocity = (0.02, 0, 0)  # about the axis of a: it swings with the arm's whole inertia
    made["cross"].angular_velocity = (0.02, 0, 0)
    made["jaw"].angular_velocity = (0.02, 0, 0)
    crossings, before = [], made["a"].angle.value
    for step in range(1500):
        assert system.step(1 / 500).substeps_max <= 2
        value = made["a"].angle.value
        if before < 0 <= value:
            crossings.append((step + 1 - value / (value - before)) / 500)
        before = value
    period = 2 * math.pi * math.sqrt((0.1 + 2 * 0.09) / (2 * 9.81 * 0.3))
    assert crossings[1] - crossings[0] == pytest.approx(period, rel=2e-3)


def test_bodies_of_an_mjcf_file_without_mass_are_parts_of_what_they_are_fixed_to(write: Write) -> None:
    tool = '<body name="tool" pos="0.5 0 0.1"/><geom fromto="0 0 0 0.5 0 0.1"/>'
    found = shapelib.mechanism(write("tool.xml", MJCF.replace('<geom fromto="0 0 0 0.5 0 0.1"/>', tool)))
    assert "tool" not in [body.name for body in found.bodies]
    made = found.realize(iota.System())
    assert made["tool"].body == made["lower"] and tuple(made["tool"].position) == pytest.approx((1.1, 2.1, 0))


def test_links_that_mujoco_lets_pass_each_other_do_so(write: Write) -> None:
    hand = """<mujoco>
  <worldbody>
    <body name="palm"><freejoint/><geom size="0.1"/>
      <body name="plate"><geom size="0.1"/></body>
      <body name="finger" pos="0.15 0 0"><joint axis="0 1 0"/><joint axis="0 0 1"/><geom size="0.1"/>
        <body name="tip" pos="0.15 0 0"><joint axis="0 1 0"/><geom size="0.1"/></body>
      </body>
    </body>
    <body name="ball" pos="0 0 1"><freejoint/><geom size="0.1"/></body>
    <body name="ghost" pos="0 0 2"><freejoint/><geom size="0.1" contype="2" conaffinity="4"/></body>
  </worldbody>
  <contact><exclude body1="palm" body2="tip"/></contact>
</mujoco>"""
    found = shapelib.mechanism(write("hand.xml", hand))
    pairs = {frozenset((found.bodies[a].name, found.bodies[b].name)) for a, b in found.passing}
    for two in (("palm", "finger"), ("plate", "finger"), ("palm", "tip"), ("ghost", "ball"), ("finger ring 1", "palm")):
        assert frozenset(two) in pairs, two
    for two in (("plate", "tip"), ("ball", "palm"), ("ball", "tip")):
        assert frozenset(two) not in pairs, two
    system = iota.System()
    found.realize(system)
    assert len(system.ignored_contacts) == len(found.passing)


def test_an_mjcf_height_field_is_land_as_mujoco_has_it(write: Write) -> None:
    import mujoco

    land = """<mujoco>
  <asset><hfield name="hills" nrow="3" ncol="4" size="2 1 0.5 0.1" elevation="0 1 2 3  4 0 1 5  2 2 0 9"/></asset>
  <worldbody><geom type="hfield" hfield="hills" pos="0.3 -0.2 0.1" euler="0 0 30"/></worldbody>
</mujoco>"""
    found = shapelib.mechanism(write("land.xml", land))
    assert not any("height" in note for note in found.notes)
    system = iota.System()
    found.realize(system)
    world = iota.World(system, ground=None)
    model = mujoco.MjModel.from_xml_string(land)
    state = mujoco.MjData(model)
    mujoco.mj_forward(model, state)
    rng = np.random.default_rng(1)
    hits = 0
    for x, y in rng.uniform((-1.6, -0.9), (1.6, 0.9), (200, 2)):
        far = mujoco.mj_ray(
            model, state, np.array([x, y, 3.0]), np.array([0.0, 0, -1]), None, 1, -1, np.zeros(1, np.int32)
        )
        hit = world.queries.ray((x, 3.0, -y), (0, -1, 0))
        if hit is None:
            continue  # beside it, or beside the block that MuJoCo has under it
        hits += 1
        assert hit.point.y == pytest.approx(3.0 - far, abs=1e-6), (x, y)
    assert hits > 150


HANDS = """\
<mujoco>
  <compiler angle="radian"/><option gravity="0 0 0"/>
  <worldbody>
    <body name="a"><joint name="a" axis="0 0 1"/><geom type="box" pos=".2 0 0" size=".1 .1 .1"/></body>
    <body name="b" pos="1 0 0"><joint name="b" axis="0 0 1" ref="0.5"/><geom type="box" pos=".2 0 0" size=".1 .1 .1"/></body>
    <body name="c" pos="2 0 0"><joint name="c" type="slide" axis="1 0 0"/><geom type="box" size=".1 .1 .1"/></body>
  </worldbody>
  <tendon>
    <fixed name="sum" limited="true" range="-0.1 0.65"><joint joint="b" coef="1"/><joint joint="c" coef="2"/></fixed>
    <fixed name="turns"><joint joint="a" coef="3"/></fixed>
  </tendon>
  <equality>{}</equality>
</mujoco>
"""


def test_joints_of_an_mjcf_file_that_are_equal_move_together(write: Write) -> None:
    equal = '<joint name="gear" joint1="a" joint2="b" polycoef="0 -2 0 0 0"/>'
    for text in (equal, '<tendon name="gear" tendon1="turns" tendon2="sum" polycoef="0 -2 0 0 0"/>'):
        found = shapelib.mechanism(write("hands.xml", HANDS.format(text).replace("-0.1 0.65", "-100 100")))
        assert found.notes == ["the gravity of the file is left out, as the system has one: system.gravity = (0, 0, 0)"]
        system = iota.System(gravity=(0, 0, 0))
        made = found.realize(system)
        made["b joint"].angle.motor = (1.0, 1e3)
        made["c joint"].slide.motor = (0.25, 1e3)
        for _ in range(60):
            system.step(1 / 120)
            a, b = turn_about_up(made["a"]), turn_about_up(made["b"], 1.0)
            sum_of_other = b if text is equal else b + 2 * (made["c"].center_of_mass.x - 2)
            assert a == pytest.approx(-2 * sum_of_other / (1 if text is equal else 3), abs=1e-6)
        assert b == pytest.approx(0.5, abs=0.01)


def test_limits_of_sums_of_joints_become_ours(write: Write) -> None:
    """-0.1 < b + 2 c < 0.65, where b begins at 0.5: b can turn by 0.15 one way and by 0.6 the other, c helps it."""
    found = shapelib.mechanism(write("hands.xml", HANDS.format("")))
    for speed, end in ((1.0, 0.15), (-1.0, -0.6)):
        system = iota.System(gravity=(0, 0, 0))
        made = found.realize(system)
        made["b joint"].angle.motor = (speed, 5.0)
        made["c joint"].slide.motor = (0.0, 1e4)
        for _ in range(240):
            system.step(1 / 120)
        assert turn_about_up(made["b"], 1.0) == pytest.approx(end, abs=1e-3)


SAID = """<mujoco>
  <option timestep="0.005" density="1000" gravity="0 0 -1.6"><flag contact="disable" energy="enable"/></option>
  <default><geom friction="0.3 0.005 0.0001"/></default>
  <asset><material name="shiny" rgba="1 0 0 1" shininess="0.9"/></asset>
  <worldbody>
    <light/><camera name="eye"/>
    <body name="b" gravcomp="1">
      <joint name="j" axis="0 1 0" stiffness="5 2" armature="0.1" margin="0.01" solreflimit="0.1 1" actuatorfrcrange="-1 1"/>
      <geom name="g" size="0.1" mass="1" pos="0.3 0 0" material="shiny" margin="0.02" condim="6"/><site name="s"/>
      <body name="c" pos="1 0 0">
        <joint name="k" type="ball" stiffness="50" damping="2" frictionloss="0.1" range="0 1" limited="true"/>
        <geom name="h" size="0.1"/>
        <site name="t"/>
      </body>
    </body>
    <body name="f" pos="0 5 0"><joint name="f" type="free" damping="1"/><geom size="0.1"/></body>
    <body name="m" mocap="true"><geom size="0.1"/></body>
  </worldbody>
  <tendon><fixed name="sum" stiffness="3"><joint joint="j" coef="1"/></fixed>
    <spatial name="line" stiffness="100" range="0.2 2" limited="true" frictionloss="2"><site site="s"/><site site="t"/></spatial></tendon>
  <contact><pair geom1="g" geom2="h"/></contact>
  <actuator><motor joint="j"/><position name="thruster" site="s" kp="3"/></actuator>
  <sensor><jointpos joint="j"/></sensor>
  <custom><numeric name="number" data="1"/></custom>
  <visual><global offwidth="10"/></visual>
</mujoco>"""


def test_all_that_an_mjcf_file_says_and_we_do_not_take_is_noted_with_its_line(write: Write) -> None:
    notes = shapelib.mechanism(write("said.xml", SAID)).notes
    assert shapelib.mechanism(write("said.mjcf", SAID)).notes == notes
    for note in (
        "the gravity of the file is left out, as the system has one: system.gravity = (0, -1.6, 0)",
        "the limit of the ball joint k is left out",
        "the least length of the tendon line is left out",
        "mocap of body m, line 17 (true) is left out",
        "stiffness of joint j, line 8, beyond the first coefficient, (5 2); joint k, line 11 (50) is left out",
        "damping of joint k, line 11 (2); joint f, line 16 (1) is left out",
        "frictionloss of joint k, line 11 (0.1) is left out",
        "solreflimit of joint j, line 8 (0.1 1) is left out",
        "margin of geom g, line 9 (0.02) is left out",
        "shininess of material shiny, line 4 (0.9) is left out",
        "stiffness of tendon sum, line 19 (3) is left out",
        "frictionloss of tendon line, line 20 (2) is left out",
        "options are left out: density 1000, line 2; timestep 0.005, line 2",
        "flags of <option> are left out: contact off, energy on",
        "settings of MuJoCo's view are left out: <visual>",
        "1 pair is left out: pair 0, line 21",
        "1 numeric is left out: numeric number, line 24",
        "the actuator thruster drives no joint: left out",
        "1 sensor is left out",
        "1 light is left out",
        "1 camera is left out",
    ):
        assert note in notes, "\n".join([note, "is not in", *notes])
    for taken in ("armature", "friction of geom", "condim", "actuatorfrcrange", "the actuator actuator 0"):
        assert not any(note.startswith(taken) for note in notes)
    assert not any(note.startswith("stiffness of tendon") and "line 20" in note for note in notes)


def test_no_attribute_of_mujoco_is_dropped_silently() -> None:
    """Whatever MuJoCo's elements have, now and later: what the table does not take is noted when it is changed."""
    import mujoco

    changed = 0
    for kind, table in mjcf_notes.TAKEN.items():
        if kind == "Option":
            continue
        names = mjcf_notes._attribute_names(mjcf_notes._usual(spec := mujoco.MjSpec(), kind))
        for name in names:
            if name in mjcf_notes.NO_EFFECT or (name in table and table[name] is None):
                continue
            spec = mujoco.MjSpec()
            element = mjcf_notes._usual(spec, kind)
            if kind == "Joint":
                element.type = mujoco.mjtJoint.mjJNT_BALL
            value = getattr(element, name)
            if isinstance(value, np.ndarray) or (isinstance(value, int | float) and not hasattr(value, "name")):
                try:
                    setattr(element, name, value + 1 if not isinstance(value, bool) else not value)
                except TypeError:
                    continue
                notes = mjcf_notes.left_out(mujoco, spec, [], lambda *_: False)
                called = mjcf_notes.IN_FILES.get(name, name.replace("_", ""))
                assert any(note.startswith(f"{called} of ") for note in notes), (kind, name, notes)
                changed += 1
    assert changed > 40


def test_a_tendon_between_two_places_of_an_mjcf_file_is_a_spring(write: Write) -> None:
    """A mass on a vertical slide: x'' = -g + k (L - rest) / m, upwards where the spring is longer."""
    text = """<mujoco><worldbody><site name="top" pos="0 0 1"/>
      <body name="b"><joint type="slide" axis="0 0 1"/><geom size="0.1" mass="1"/><site name="s"/></body></worldbody>
      <tendon><spatial name="line" stiffness="100" damping="2" {} limited="true" range="0 3"><site site="top"/><site site="s"/></spatial></tendon>
    </mujoco>"""
    for springlength, slack in (("", 0.0), ('springlength="0.2 1.05"', 0.05)):
        found = shapelib.mechanism(write("line.xml", text.format(springlength)))
        assert not any("tendon line" in note for note in found.notes)
        system = iota.System()
        made = found.realize(system)
        for _ in range(240):
            system.step(1 / 480)
        height, speed, dt = 0.0, 0.0, 1e-5
        for _ in range(50_000):
            speed += dt * (-9.81 + 100 * max(-height - slack, 0.0) - 2 * speed)
            height += dt * speed
        assert made["b"].position.y == pytest.approx(height, abs=1e-3)


def test_all_that_a_urdf_file_says_and_we_do_not_take_is_noted_with_its_line(write: Write) -> None:
    text = """<robot name="r" extra="1"><link name="base"><contact/></link>
  <link name="arm"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1"/></inertial><visual><geometry><sphere radius="1"/></geometry>
    <material name="m"><texture filename="a.png"/></material></visual></link>
  <link name="plate"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1"/></inertial></link>
  <joint name="j" type="revolute"><parent link="base"/><child link="arm"/><origin xyz="0 0 0" quat_xyzw="0 0 0 1"/>
    <limit lower="-1" upper="1" effort="10" velocity="0"/><safety_controller k_velocity="1"/></joint>
  <joint name="p" type="planar"><parent link="arm"/><child link="plate"/><axis xyz="0 1 0"/><dynamics damping="3"/></joint>
</robot>"""
    notes = shapelib.mechanism(write("said.urdf", text)).notes
    assert notes == [
        "extra of <robot> is left out (line 1)",
        "<contact> in <link> is left out (line 1)",
        "<texture> in <material> is left out (line 3)",
        "quat_xyzw of <origin> is left out (line 5)",
        "effort of <limit> is left out (line 6)",
        "<safety_controller> in <joint> is left out (line 6)",
        "<dynamics> of planar joints is left out (line 7)",
    ]


def test_couplings_of_an_mjcf_file_that_we_have_not_are_listed(write: Write) -> None:
    bent = '<joint name="bent" joint1="a" joint2="b" polycoef="0 1 0.5 0 0"/>'
    found = shapelib.mechanism(write("bent.xml", HANDS.format(bent)))
    assert [note for note in found.notes if "bent" in note] == ["the equality bent is not linear: left out"]
    assert [coupling.name for coupling in found.couplings] == ["sum longest", "sum shortest"]
    apart = '<joint name="apart" joint1="a" polycoef="0.3 0 0 0 0"/>'  # its initial pose is another
    found = shapelib.mechanism(write("apart.xml", HANDS.format(apart)))
    assert "apart is violated initially" in " ".join(found.notes)


def test_structures_from_files_can_be_saved(write: Write) -> None:
    for source in (
        write("geared.urdf", GEARED_URDF),
        write("a.xyz", WATER_XYZ),
        write("a.urdf", PENDULUM_URDF),
        write("a.off", CUBE_OFF),
    ):
        found = shapelib.load(source)
        again = iota.builder.Structure.from_json(json.loads(json.dumps(found.to_json())))
        assert (again.points.radius == found.points.radius).all() and (again.points.color == found.points.color).all()
        first, second = iota.System(), iota.System()
        found.realize(first)
        again.realize(second)
        assert first.state_hash() == second.state_hash()
