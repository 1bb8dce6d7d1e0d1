# SPDX-License-Identifier: Apache-2.0
"""Files are read in a process of its own: what ends or fills that process is one file's error."""

from __future__ import annotations

import json
import os
import pickle
import struct
import sys
import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

import iota
from iota.shapelib import apart as apart_module
from iota.shapelib.apart import apart as apart_if
from iota.shapelib.files import FileError

apart = apart_if()
OFF = "OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n"


def test_a_file_is_read_by_another_process_which_stays_for_the_next_one() -> None:
    first = apart(eval)("__import__('os').getpid()")
    assert first != os.getpid() and apart(eval)("__import__('os').getpid()") == first
    assert apart(eval)("print('this is no answer')") is None


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("__import__('os').abort()", "its reader ended (SIGABRT)"),
        ("__import__('os')._exit(3)", "its reader ended (exit code 3): the file is damaged"),
        (
            "(o := __import__('os')).kill(o.getpid(), 15) or __import__('time').sleep(9)",
            "(SIGTERM): it was stopped from outside; try again",
        ),
        (
            "[(o := __import__('os')).closerange(3, 20), __import__('time').sleep(0.3), o.abort()]",
            "its reader ended (SIGABRT)",
        ),
        ("bytearray(1 << 40)", "takes more than 4 GiB of memory"),
        ("__import__('time').sleep(60)", "cannot be read within 1 s"),
    ],
    ids=["crash", "exit", "stopped", "crash after its output", "memory", "time"],
)
def test_a_killed_reader_is_one_error_and_the_next_file_is_read(
    text: str, said: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    apart(eval)("1")  # it takes a moment to start
    if "time" in text:
        monkeypatch.setattr(apart_module, "MOST_SECONDS", 1.0)
    with pytest.raises(FileError) as caught:
        apart(eval)(text)
    assert said in str(caught.value)
    monkeypatch.undo()
    assert apart(eval)("6 * 7") == 42


@pytest.mark.skipif(sys.version_info < (3, 11), reason="Python 3.10 takes modules of the working folder first")
def test_the_reader_takes_no_modules_from_the_folder_of_the_files(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "numpy.py").write_text("raise RuntimeError('not this one')")
    monkeypatch.chdir(tmp_path)
    apart_module._reader.end()
    assert apart(eval)("__import__('numpy').__name__") == "numpy"


def test_an_error_of_a_file_keeps_its_name_and_line(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "bad.off").write_text(OFF.replace("3 1 2 3", "3 1 2 9"))
    with pytest.raises(FileError) as caught:
        iota.shapelib.read_surface("bad.off")
    assert caught.value.path == "bad.off" and str(caught.value).startswith("bad.off, line 10: face 4 (of 4")
    (tmp_path / "good.off").write_text(OFF)
    assert len(iota.shapelib.read_surface("good.off").faces) == 4


PDB = """\
ATOM      1  C1  EOH A   1      -0.888   0.181   0.000  1.00  0.00           C
ATOM      2  O   EOH A   1       0.463  -0.511   0.000  1.00  0.00           O
END
"""
MOL = "\n\n\n  1  0  0  0  0  0  0  0  0  0999 V2000\n    0.0000    0.0000    0.0000 O   0  0\nM  END\n"
CIF = "data_x\nloop_\n_atom_site.type_symbol\n_atom_site.Cartn_x\n_atom_site.Cartn_y\n_atom_site.Cartn_z\nO 0 0 0\n"
URDF = '<robot name="arm"><link name="a"><inertial><mass value="1"/></inertial></link></robot>'
MJCF = '<mujoco><worldbody><body><freejoint/><geom size="0.1"/></body></worldbody></mujoco>'
OBJ = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"
FILES = {
    "a.pdb": PDB, "a.sdf": MOL, "a.xyz": "1\n\nO 0 0 0\n", "a.cif": CIF, "a.urdf": URDF, "a.xml": MJCF, "a.off": OFF, "a.obj": OBJ,
}  # fmt: skip


@pytest.mark.parametrize("name", FILES)
def test_no_file_is_opened_by_the_process_of_the_simulation(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for library in ("rdkit", "mujoco"):
        pytest.importorskip(library)
    (tmp_path / name).write_text(FILES[name])
    monkeypatch.setattr(Path, "read_bytes", lambda path: pytest.fail(f"{path} is read here"))
    found = iota.shapelib.load(tmp_path / name)
    assert len(found.bodies) + len(found.points) > 0


def test_a_formula_and_a_mesh_are_read_there_too(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    trimesh = pytest.importorskip("trimesh")
    rdkit = pytest.importorskip("rdkit.Chem")
    (tmp_path / "a.obj").write_text(OBJ)
    monkeypatch.setattr(trimesh, "load", lambda *_, **__: pytest.fail("the mesh is read here"))
    monkeypatch.setattr(rdkit, "MolFromSmiles", lambda *_: pytest.fail("the formula is read here"))
    assert iota.Mesh.load(tmp_path / "a.obj").mass_properties.volume == pytest.approx(1 / 6)
    assert len(iota.shapelib.molecule("O").points) == 3
    with pytest.raises(FileError, match=r"none\.ply"):
        iota.Mesh.load(tmp_path / "none.ply")


def test_all_shapes_and_looks_come_back_as_they_were() -> None:
    mesh = iota.Mesh([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)], [(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)])
    for shape in (iota.Box((1, 2, 3), 0.1), iota.Capsule(0.1, 1 / 3), iota.HalfSpace((0, 1, 0)), mesh):
        look = iota.looks.Look(shape, "steel", "#ff0000", offset=(0.1, 0, 0))
        assert pickle.loads(pickle.dumps(look)) == look


def test_several_threads_get_their_own_files(tmp_path: Path) -> None:
    found: dict[int, int] = {}
    for count in range(1, 9):
        (tmp_path / f"{count}.off").write_text(OFF.replace("4 4 0", f"4 {count} 0", 1) + "3 0 1 2\n" * count)

    def read(count: int) -> None:
        found[count] = len(iota.shapelib.read_surface(tmp_path / f"{count}.off").faces)

    threads = [threading.Thread(target=read, args=(count,)) for count in range(1, 9)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert found == {count: count for count in range(1, 9)}


# --- hostile models ---------------------------------------------------------------------------------------------------


def gltf(**changes: Any) -> dict[str, Any]:
    """A triangle."""
    return {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}],
        "bufferViews": [{"buffer": 0, "byteLength": 36}],
        "buffers": [{"byteLength": 36, "uri": "triangle.bin"}],
        **changes,
    }


def many_times(depth: int) -> dict[str, Any]:
    """Each node has the next one twice, which would be 2^depth triangles."""
    nodes: list[dict[str, Any]] = [{"children": [at + 1, at + 1]} for at in range(depth)]
    return gltf(nodes=[*nodes, {"mesh": 0}])


HOSTILE: dict[str, Callable[[], dict[str, Any]]] = {
    "a million million points": lambda: gltf(accessors=[{"componentType": 5126, "count": 10**12, "type": "VEC3"}]),
    "points beyond the buffer": lambda: gltf(
        accessors=[{"bufferView": 0, "componentType": 5126, "count": 3 << 20, "type": "VEC3"}]
    ),
    "a buffer of another folder": lambda: gltf(buffers=[{"byteLength": 36, "uri": "../secret.bin"}]),
    "a buffer by its whole path": lambda: gltf(buffers=[{"byteLength": 36, "uri": "/etc/passwd"}]),
    "a buffer of the network": lambda: gltf(buffers=[{"byteLength": 36, "uri": "http://127.0.0.1:9/other.bin"}]),
    "nodes in a circle": lambda: gltf(nodes=[{"children": [1], "mesh": 0}, {"children": [0]}]),
    "a node that is its own child": lambda: gltf(nodes=[{"children": [0], "mesh": 0}]),
    "a node many times": lambda: many_times(40),
    "a node that does not exist": lambda: gltf(nodes=[{"children": [99]}]),
    "corners that do not exist": lambda: gltf(
        meshes=[{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        accessors=[
            {"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"},
            {"bufferView": 0, "componentType": 5125, "count": 9, "type": "SCALAR"},
        ],
    ),
    "a negative place in the buffer": lambda: gltf(bufferViews=[{"buffer": 0, "byteOffset": -36, "byteLength": 36}]),
}


@pytest.mark.parametrize("name", HOSTILE)
def test_a_hostile_model_is_an_error_of_one_line_in_seconds(name: str, tmp_path: Path) -> None:
    pytest.importorskip("trimesh")
    triangle = struct.pack("<9f", 0, 0, 0, 1, 0, 0, 0, 1, 0)
    folder = tmp_path / "models"
    folder.mkdir()
    (folder / "triangle.bin").write_bytes(triangle)
    (tmp_path / "secret.bin").write_bytes(triangle)
    good, bad = folder / "good.gltf", folder / "bad.gltf"
    good.write_text(json.dumps(gltf()))
    bad.write_text(json.dumps(HOSTILE[name]()))
    assert len(iota.shapelib.read_model(good)[0].faces) == 1
    began = time.monotonic()
    with pytest.raises(FileError) as caught:
        iota.shapelib.read_model(bad)
    assert time.monotonic() - began < 30
    assert "bad.gltf" in str(caught.value) and "\n" not in str(caught.value) and len(str(caught.value)) < 300
    assert len(iota.shapelib.read_model(good)[0].faces) == 1
