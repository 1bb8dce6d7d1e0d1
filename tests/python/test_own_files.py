# SPDX-License-Identifier: Apache-2.0
"""Files as people have them: what is in them is read or told, and what is wrong with them is said with its place."""

from __future__ import annotations

import base64
import json
import math
import struct
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from iota import shapelib
from iota.shapelib import molecule_files
from iota.shapelib.surface import Surface, _cut


def write(folder: Path, name: str, text: str) -> Path:
    path = folder / name
    path.write_text(text)
    return path


def told(path: Path, **options: Any) -> str:
    """The notes of a file."""
    return " / ".join(shapelib.load(path, **options).notes)


def refusal(path: Path | str) -> str:
    with pytest.raises(ValueError) as caught:
        shapelib.load(path)
    assert "\n" not in str(caught.value)
    return str(caught.value)


# --- polygons -----------------------------------------------------------------------------------------------------------


def grid_polygon(generator: np.random.Generator, cells: int) -> list[tuple[int, int]]:
    """The outline of a connected set of unit cells without holes or touching corners, with a corner at each lattice point."""
    filled = {(0, 0)}
    while len(filled) < cells:
        x, y = sorted(filled)[generator.integers(len(filled))]
        step = ((1, 0), (-1, 0), (0, 1), (0, -1))[generator.integers(4)]
        grown = filled | {(x + step[0], y + step[1])}
        if is_simple(grown):
            filled = grown
    follows = {}
    for x, y in filled:
        corners = [(x, y), (x + 1, y), (x + 1, y + 1), (x, y + 1)]
        for side, beyond in enumerate(((x, y - 1), (x + 1, y), (x, y + 1), (x - 1, y))):
            if beyond not in filled:
                follows[corners[side]] = corners[(side + 1) % 4]
    outline = [next(iter(follows))]
    while (following := follows[outline[-1]]) != outline[0]:
        outline.append(following)
    assert len(outline) == len(follows)
    return outline


def is_simple(filled: set[tuple[int, int]]) -> bool:
    begins = [
        corner
        for x, y in filled
        for corner, beyond in (
            ((x, y), (x, y - 1)), ((x + 1, y), (x + 1, y)), ((x + 1, y + 1), (x, y + 1)), ((x, y + 1), (x - 1, y)),
        )
        if beyond not in filled
    ]  # fmt: skip
    if len(begins) != len(set(begins)):
        return False
    x, y = zip(*filled, strict=True)
    empty = {
        (i, j) for i in range(min(x) - 1, max(x) + 2) for j in range(min(y) - 1, max(y) + 2) if (i, j) not in filled
    }
    reached = [(min(x) - 1, min(y) - 1)]
    for i, j in reached:  # grows meanwhile
        reached += [
            near for near in ((i + 1, j), (i - 1, j), (i, j + 1), (i, j - 1)) if near in empty and near not in reached
        ]
    return len(reached) == len(empty)


def turned(corners: list[tuple[int, int]], generator: np.random.Generator) -> np.ndarray[Any, Any]:
    """In a plane of any direction, far from the origin."""
    axes, _ = np.linalg.qr(generator.standard_normal((3, 3)))
    return np.asarray(np.array(corners, float) @ axes[:2] * 0.3 + 2)


@pytest.mark.parametrize("seed", range(60))
def test_a_polygon_with_straight_corners_is_cut_into_triangles_of_its_area(seed: int) -> None:
    """By counting cells, an independent formula; with every corner first."""
    generator = np.random.default_rng(seed)
    cells = int(generator.integers(2, 9))
    corners = grid_polygon(generator, cells)
    if seed % 3 == 0:  # without the straight ones
        corners = [
            b for a, b, c in zip(corners[-1:] + corners, corners, corners[1:] + corners[:1], strict=False)
            if (b[0] - a[0], b[1] - a[1]) != (c[0] - b[0], c[1] - b[1])
        ]  # fmt: skip
    places = turned(corners, generator) if seed % 2 else np.array([(*corner, 0) for corner in corners], float)
    cell = 0.3**2 if seed % 2 else 1.0
    for first in range(len(corners)):
        order = [*range(first, len(corners)), *range(first)]
        surface = Surface(places, _cut(places[order], order))
        assert len(surface.faces) == len(corners) - 2
        assert surface.area() == pytest.approx(cells * cell), (corners, first)


def test_a_concave_face_of_a_file_has_its_area(tmp_path: Path) -> None:
    corners = [(0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2)]
    rows = [f"{x} {y} {z}" for z in (0, 1) for x, y in corners]
    sides = [f"4 {i} {(i + 1) % 6} {(i + 1) % 6 + 6} {i + 6}" for i in range(6)]
    for shift in (0, 3):
        top = [str((i + shift) % 6 + 6) for i in range(6)]
        bottom = [str((i + shift) % 6) for i in reversed(range(6))]
        text = "OFF\n12 8 0\n" + "\n".join([*rows, "6 " + " ".join(top), "6 " + " ".join(bottom), *sides]) + "\n"
        counts = shapelib.polyhedron(write(tmp_path, "l.off", text)).counts
        assert (counts["area"], counts["volume"]) == (pytest.approx(14), pytest.approx(3))


# --- meshes -------------------------------------------------------------------------------------------------------------


def triangle_gltf(**more: Any) -> dict[str, Any]:
    data = np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0)], "<f4").tobytes()
    return {
        "asset": {"version": "2.0"}, "scenes": [{"nodes": [0]}], "scene": 0, "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}],
        "bufferViews": [{"buffer": 0, "byteLength": len(data)}],
        "buffers": [{"byteLength": len(data), "uri": "data:;base64," + base64.b64encode(data).decode()}],
    } | more  # fmt: skip


def test_skins_animations_and_targets_of_gltf_are_told(tmp_path: Path) -> None:
    head = triangle_gltf(skins=[{"joints": [0]}], animations=[{"channels": [], "samplers": []}] * 2)
    head["meshes"][0]["primitives"][0]["targets"] = [{"POSITION": 0}]
    path = write(tmp_path, "a.gltf", json.dumps(head))
    for kind in ("flexible", "soft"):
        assert "1 skin, 2 animations, 1 morph target: left out, the shape is the one at rest" in told(path, kind=kind)


def test_a_short_buffer_of_gltf_is_refused_with_its_number(tmp_path: Path) -> None:
    head = triangle_gltf()
    head["buffers"][0]["byteLength"] = 840
    path = write(tmp_path, "a.gltf", json.dumps(head))
    assert refusal(path) == f"{path}: buffer 0 has 36 bytes, 840 promised: it is truncated"
    head = triangle_gltf(bufferViews=[{"buffer": 0, "byteOffset": 12, "byteLength": 36}])
    assert refusal(write(tmp_path, "a.gltf", json.dumps(head))).endswith(
        "buffer view 0 ends at byte 48 of buffer 0, which has 36"
    )
    head = triangle_gltf(buffers=[{"byteLength": 36, "uri": "none.bin"}])
    assert "buffer 0 cannot be read" in refusal(write(tmp_path, "a.gltf", json.dumps(head)))


def test_values_of_gltf_beyond_their_part_of_a_buffer_are_refused_with_their_number(tmp_path: Path) -> None:
    accessor = {"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}
    for change, reason in (
        ({"count": 4}, "accessor 0 has 4 values, which end at byte 48 of a part of 36"),
        ({"byteOffset": 4}, "accessor 0 has 3 values, which end at byte 40 of a part of 36"),
        ({"bufferView": 7}, "accessor 0 is in buffer view 7; there are 0..0"),
        ({"sparse": {"count": 1}}, "accessor 0 is sparse, which is not read; export it without"),
        ({"type": "VEC7"}, "is not glTF: KeyError: 'VEC7'"),
    ):
        path = write(tmp_path, "a.gltf", json.dumps(triangle_gltf(accessors=[accessor | change])))
        assert refusal(path) == f"{path}: {reason}"


def tetrahedron_stl(size: float = 1.0) -> bytes:
    corners = size * np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)], "<f4")
    rows = b"".join(
        struct.pack("<12fH", 0, 0, 0, *corners[list(face)].ravel(), 0)
        for face in ((0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2))
    )
    return b"made by a program".ljust(80) + struct.pack("<I", 4) + rows


def test_bytes_after_the_triangles_of_a_binary_stl_file_are_told_and_half_files_refused(tmp_path: Path) -> None:
    path = tmp_path / "a.stl"
    path.write_bytes(tetrahedron_stl() + b"COLOR=1")
    assert "7 bytes after its last triangle are left out" in told(path)
    assert shapelib.load(path).counts["volume"] == pytest.approx(1 / 6)
    for data in (tetrahedron_stl()[:-1], tetrahedron_stl() + bytes(5000)):
        path.write_bytes(data)
        assert "it is truncated or not an STL file" in refusal(path)


def test_a_solid_that_was_hardly_made_in_meters_is_told_with_its_size(tmp_path: Path) -> None:
    path = tmp_path / "part.stl"
    path.write_bytes(tetrahedron_stl(120.0))
    assert "it is 120 m large; if its unit is not the meter, give scale, as in scale=0.001" in told(path)
    assert "large" not in told(path, scale=0.001)
    path.write_bytes(tetrahedron_stl(5.0))
    assert "large" not in told(path)


def test_a_corner_counted_backwards_beyond_the_first_is_told_as_it_is_written(tmp_path: Path) -> None:
    path = write(tmp_path, "a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 -9\n")
    assert refusal(path) == f"{path}, line 4: a face uses vertex -9, counted backwards; there are 3 vertices before it"


# --- molecules ----------------------------------------------------------------------------------------------------------

ATOM = "{record:6}{serial:5} {name:4}{other:1}XXX A   1    {x:8.3f}{y:8.3f}{z:8.3f}  1.00  0.00          {symbol:>2}{charge}"


def atom(serial: int, symbol: str, x: float, charge: str = "") -> str:
    name = f" {symbol}{serial}"
    return ATOM.format(
        record="HETATM", serial=serial, name=name, other="", x=x, y=0.5, z=0.0, symbol=symbol, charge=charge
    )


CHAIN = [atom(1, "C", -1.234), atom(2, "C", 0.3), atom(3, "N", 1.8, "1+")]


def test_shifted_columns_of_a_pdb_file_are_told_with_their_line(tmp_path: Path) -> None:
    good = write(tmp_path, "good.pdb", "\n".join([*CHAIN, "END"]))
    assert shapelib.load(good).counts["atoms"] == 3
    left = [line[:11] + line[12:] for line in CHAIN]
    path = write(tmp_path, "left.pdb", "\n".join([*left, "END"]))
    assert refusal(path) == (
        f"{path}, line 1: the columns are shifted: the decimal points of x, y and z stand in columns 34, 42, 50, "
        "not in 35, 43, 51"
    )
    right = [CHAIN[0], *(line[:27] + " " + line[27:] for line in CHAIN[1:])]
    assert "line 2: the columns are shifted" in refusal(write(tmp_path, "right.pdb", "\n".join([*right, "END"])))


def test_a_pdb_file_of_several_models_is_read_to_the_end_of_the_first(tmp_path: Path) -> None:
    models = "\n".join(["MODEL        1", *CHAIN, "ENDMDL", "MODEL        2", *CHAIN, "ENDMDL", "END"])
    path = write(tmp_path, "models.pdb", models)
    assert shapelib.load(path).counts["atoms"] == 3 and "only the first of 2 models is read" in told(path)
    path = write(tmp_path, "ended.pdb", "\n".join([*CHAIN, "END", *CHAIN, *CHAIN, "END"]))
    assert shapelib.load(path).counts["atoms"] == 3 and "6 atoms after the first END are left out" in told(path)


def test_the_first_drawing_of_several_records_is_read_though_its_atoms_are_near(tmp_path: Path) -> None:
    drawn = "drawn\n  iota  2D\n\n  3  2  0  0  0  0  0  0  0  0999 V2000\n" + "".join(
        f"{x:10.4f}{y:10.4f}    0.0000 {symbol:<3} 0  0\n"
        for symbol, x, y in (("C", 0, 0), ("H", 1, 0.2), ("H", 1, -0.1))
    )
    record = drawn + "  1  2  1  0\n  1  3  1  0\nM  CHG  1   1   1\nM  END\n$$$$\n"
    path = write(tmp_path, "three.sdf", record * 3)
    found = shapelib.load(path)
    assert (found.counts["atoms"], found.counts["charge"]) == (3, 1)
    assert "only the first of 3 molecules is read" in told(path) and "plane coordinates of a drawing" in told(path)


def test_charges_and_isotopes_are_told(tmp_path: Path) -> None:
    assert shapelib.load(write(tmp_path, "a.pdb", "\n".join([*CHAIN, "END"]))).counts["charge"] == 1
    heavy, light = (shapelib.molecule(f"[{symbol}]C") for symbol in ("2H", "H"))
    assert "isotopes, with their masses: 1 of 2H" in heavy.notes and "charge" not in heavy.counts
    assert heavy.points.mass.sum() - light.points.mass.sum() == pytest.approx(0.001 * (2.0141 - 1.008), rel=1e-3)
    assert shapelib.molecule("[Fe+3].[O-]C=O").counts["charge"] == 2
    cif = "data_a\nloop_\n_atom_site.type_symbol\n_atom_site.Cartn_x\n_atom_site.Cartn_y\n_atom_site.Cartn_z\nFe3+ 0 0 0\nCl- 3 0 0\n"
    assert shapelib.load(write(tmp_path, "a.cif", cif)).counts["charge"] == 2


def test_a_smi_file_is_its_first_smiles(tmp_path: Path) -> None:
    path = write(tmp_path, "a.smi", "# two\nCCO ethyl alcohol\nC methane\n")
    found = shapelib.load(path)
    assert found.title == "ethyl alcohol" and found.counts["formula"] == "C2H6O"
    assert "only the first of 2 molecules is read" in found.notes
    path = write(tmp_path, "bad.smi", "\nC1CC(\n")
    assert refusal(path).startswith(f"{path}, line 2: the SMILES 'C1CC(' cannot be read")
    assert "has no SMILES" in refusal(write(tmp_path, "empty.smi", "# nothing\n"))


BUCKYBALL = (
    "C12=C3C4=C5C6=C1C7=C8C9=C1C%10=C%11C(=C29)C3=C2C3=C4C4=C5C5=C9C6=C7C6=C7C8=C1C1=C8C%10=C%10C%11=C2C2=C3C3=C4C4=C5C5="
    "C%11C%12=C(C6=C95)C7=C1C1=C%12C5=C%11C4=C3C3=C5C(=C81)C%10=C23"
)


def test_a_cage_for_which_rdkit_finds_no_shape_is_laid_out_by_its_bonds(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(molecule_files, "EMBED_SECONDS", 1)
    monkeypatch.setattr(molecule_files, "RELAX_SECONDS", 1.0)
    began = time.process_time()
    found = molecule_files.parse_smiles(BUCKYBALL)
    assert time.process_time() - began < 10, "it never goes on for minutes"
    assert "its shape is laid out by its bonds: RDKit finds none" in found.notes
    away = np.linalg.norm(found.position - found.position.mean(axis=0), axis=1)
    assert away.min() > 3.3 and away.max() < 3.8, "it is round, as C60"
    lengths = np.linalg.norm(found.position[found.bonds[:, 0]] - found.position[found.bonds[:, 1]], axis=1)
    assert len(lengths) == 90 and lengths.min() > 1.3 and lengths.max() < 1.6


@pytest.mark.parametrize("smiles", ["CN1C=NC2=C1C(=O)N(C(=O)N2C)C", "C1C2CC3CC1CC(C2)C3", "C#CC", "[Na+].[Cl-]", "C"])
def test_a_layout_by_bonds_has_their_lengths_and_keeps_others_apart(
    smiles: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(molecule_files, "_embed", lambda *_: False)
    monkeypatch.setattr(molecule_files, "_relax", lambda *_: None)
    found = molecule_files.parse_smiles(smiles)
    radius = np.array([element.bond_radius for element in found.elements])
    apart = np.linalg.norm(found.position[:, None] - found.position[None], axis=2)
    for p, q in found.bonds.tolist():
        assert apart[p, q] == pytest.approx(radius[p] + radius[q], rel=0.2)
        apart[p, q] = apart[q, p] = math.inf
    np.fill_diagonal(apart, math.inf)
    assert apart.min() > 1.4


# --- mechanisms ---------------------------------------------------------------------------------------------------------

LINK = '<link name="{}"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1"/></inertial></link>'


def test_joints_of_other_namespaces_and_links_without_inertia_are_told(tmp_path: Path) -> None:
    text = "\n".join(
        [
            '<robot name="r" xmlns:drake="http://drake.mit.edu">', LINK.format("a"), LINK.format("b"), '<link name="tool"/>',
            '<drake:joint name="ball" type="ball"><parent link="a"/><child link="b"/></drake:joint>',
            '<joint name="flange" type="fixed"><parent link="a"/><child link="tool"/></joint>',
            '<sensor name="s"/><sensor name="t"/><drake:note/></robot>',
        ]
    )  # fmt: skip
    notes = told(write(tmp_path, "r.urdf", text))
    assert "1 joint is not of URDF and left out, so that links hang on nothing" in notes
    assert "ball (<drake:joint>, line 5)" in notes
    assert "1 link without mass is part of the one that it is fixed to: tool (a)" in notes
    assert "2 <sensor> are left out" in notes and "1 <drake:note> is left out" in notes


def test_a_joint_without_the_limits_that_its_type_needs_is_told(tmp_path: Path) -> None:
    inertia = '<inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'
    links = "".join(f'<link name="{name}">{inertia}</link>' for name in "ab")
    ends = '<parent link="a"/><child link="b"/>'
    for kind, notes in (
        ("revolute", "the joint j has no limits, which its type revolute needs: it moves freely"),
        ("continuous", ""),
    ):
        text = f'<robot name="r">{links}<joint name="j" type="{kind}">{ends}</joint></robot>'
        assert told(write(tmp_path, "r.urdf", text)) == notes


def test_a_missing_include_is_told_with_the_file_and_line_that_names_it(tmp_path: Path) -> None:
    inner = write(tmp_path, "inner.xml", '<mujoco>\n\n<include file="gone.xml"/></mujoco>')
    outer = write(tmp_path, "outer.mjcf.xml", '<mujoco>\n<include file="inner.xml"/></mujoco>')
    assert refusal(outer) == f"{inner}, line 3: <include> names 'gone.xml', which does not exist"


def test_an_actuator_whose_range_of_lengths_mujoco_does_not_find_is_no_reason_to_refuse_a_model(tmp_path: Path) -> None:
    text = """<mujoco><worldbody><site name="w" pos="0 0.3 0"/><body><joint name="j" type="slide" axis="1 0 0"/>
      <geom size="0.1"/><site name="a"/></body></worldbody>
      <tendon><spatial name="t"><site site="a"/><site site="w"/></spatial></tendon>
      <actuator><muscle name="m" tendon="t"/></actuator><option gravity="0 0 0"/></mujoco>"""
    found = shapelib.load(write(tmp_path, "muscle.mjcf.xml", text))
    assert found.counts["actuators"] == 1 and found.counts["degrees of freedom"] == 1
