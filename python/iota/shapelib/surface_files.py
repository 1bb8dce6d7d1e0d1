# SPDX-License-Identifier: Apache-2.0
"""Surfaces from OFF, OBJ, STL, PLY and glTF files. The text formats are read here, so that an error names its line; PLY
and glTF by trimesh."""

from __future__ import annotations

import io
import os
import struct
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np

from iota.extras import how_to_get
from iota.shapelib.apart import apart
from iota.shapelib.files import FileError, PathLike, number, read_bytes, read_text, whole, with_progress
from iota.shapelib.gltf import PaintedSurface, read_gltf
from iota.shapelib.surface import MOST_FACES, Surface


@apart()
def read_surface(path: PathLike) -> Surface:
    """By the file's ending, in a process of its own with 4 GiB and three minutes. Vertices are those of the file. Raises
    FileError."""
    ending = Path(path).suffix.lower()
    if ending not in READERS:
        raise FileError(path, f"surfaces are in files that end in {', '.join(READERS)}, not in {ending or 'nothing'!r}")
    surface = READERS[ending](path)
    if not surface.faces:
        raise FileError(path, "has no faces")
    if not np.isfinite(surface.vertices).all():
        raise FileError(path, f"vertex {np.flatnonzero(~np.isfinite(surface.vertices).all(axis=1))[0]} is not finite")
    return surface


def _check_count(count: int, what: str, path: PathLike, line: int | None = None) -> None:
    if count > MOST_FACES:
        raise FileError(path, f"has {count} {what}, more than {MOST_FACES}; make it coarser", line)


# --- OFF --------------------------------------------------------------------------------------------------------------


def _read_off(path: PathLike) -> Surface:
    """Object File Format (Geomview). Numbers after the corners of a face are its color, and ignored."""
    lines = _lines_of(read_text(path))
    at, words = next(lines, (1, [""]))
    head = words[0].upper()
    if not head.endswith("OFF"):
        raise FileError(path, f"an OFF file begins with OFF, not with {words[0][:20]!r}", at)
    if head not in ("OFF", "COFF", "NOFF", "CNOFF", "STOFF"):
        raise FileError(path, f"this kind of OFF file is not read: {words[0][:20]}", at)
    words = words[1:]
    if [word.upper() for word in words[:1]] == ["BINARY"]:
        raise FileError(path, "binary OFF files are not read", at)
    if not words:
        at, words = next(lines, (at, []))
    if len(words) < 2:
        raise FileError(path, "the numbers of vertices and faces are missing", at)
    count = whole(words[0], path, at, "the number of vertices")
    face_count = whole(words[1], path, at, "the number of faces")
    _check_count(count, "vertices", path, at)
    _check_count(face_count, "faces", path, at)
    if count < 1 or face_count < 1:
        raise FileError(path, f"has {count} vertices and {face_count} faces", at)
    vertices = np.empty((count, 3))
    for row in with_progress(range(count), "reading vertices"):
        at, words = next(lines, (at, []))
        if not words:
            raise FileError(path, f"ends after {row} of {count} vertices", at)
        if len(words) < 3:
            raise FileError(path, f"vertex {row} has {len(words)} numbers instead of three", at)
        vertices[row] = [number(word, path, at, f"vertex {row}") for word in words[:3]]
    surface = Surface(vertices, [])
    for row in with_progress(range(face_count), "reading faces"):
        at, words = next(lines, (at, []))
        if not words:
            raise FileError(path, f"ends after {row} of {face_count} faces", at)
        name = f"face {row + 1} (of {face_count}, line {at})"
        corners = whole(words[0], path, at, f"the number of corners of {name}")
        if corners < 3 or len(words) < corners + 1:
            raise FileError(path, f"{name} has {min(corners, len(words) - 1)} corners", at)
        face = [whole(word, path, at, f"a corner of {name}") for word in words[1 : corners + 1]]
        for vertex in face:
            if not 0 <= vertex < count:
                raise FileError(path, f"{name} uses vertex {vertex}; there are 0..{count - 1}", at)
        surface.faces.append(face)
        surface.lines.append(at)
    return surface


def _lines_of(text: str, goes_on: str = "") -> Iterator[tuple[int, list[str]]]:
    """The number and the words of each line that is not empty, without comments. If the last word of a line is `goes_on`,
    the next line continues it."""
    before: list[str] = []
    for at, line in enumerate(text.splitlines(), 1):
        words = before + line.split("#", 1)[0].split()
        before = words[:-1] if goes_on and words[-1:] == [goes_on] else []
        if words and not before:
            yield at, words


# --- Wavefront OBJ ----------------------------------------------------------------------------------------------------


def _read_obj(path: PathLike) -> Surface:
    """Vertices, faces and groups; the rest (normals, materials, curves) is ignored, curves with a note."""
    places: list[list[float]] = []
    surface = Surface(np.empty((0, 3)), [])
    group, passed_over = "", set()
    corners: list[tuple[int, int, list[int]]] = []  # checked when all vertices are known
    for at, words in with_progress(list(_lines_of(read_text(path), goes_on="\\")), "reading faces"):
        if words[0] == "v":
            if len(words) < 4:
                raise FileError(path, f"vertex {len(places) + 1} has {len(words) - 1} numbers instead of three", at)
            places.append([number(word, path, at, f"vertex {len(places) + 1}") for word in words[1:4]])
        elif words[0] == "f":
            face = []
            for word in words[1:]:
                vertex = whole(word.split("/")[0], path, at, "a corner of a face")
                face.append(vertex - 1 if vertex > 0 else len(places) + vertex)
                if vertex == 0:
                    raise FileError(path, "a face uses vertex 0; the first one is 1", at)
                if face[-1] < 0:
                    before = f"there are {len(places)} vertices before it"
                    raise FileError(path, f"a face uses vertex {vertex}, counted backwards; {before}", at)
            if len(face) < 3:
                raise FileError(path, f"a face has {len(face)} corners", at)
            surface.faces.append(face)
            surface.groups.append(group)
            surface.lines.append(at)
            corners.append((at, len(surface.faces), face))
            _check_count(len(places), "vertices", path, at)
            _check_count(len(surface.faces), "faces", path, at)
        elif words[0] in ("g", "o"):
            group = " ".join(words[1:])
        elif words[0] in ("curv", "curv2", "surf", "l", "p"):
            passed_over.add(words[0])
        elif words[0] not in OBJ_WORDS:
            raise FileError(path, f"an OBJ file has no lines that begin with {words[0][:20]!r}", at)
    for at, which, face in corners:
        for vertex in face:
            if not 0 <= vertex < len(places):
                raise FileError(
                    path, f"face {which} (of {len(corners)}, line {at}) uses vertex {vertex + 1}; there are "
                    f"1..{len(places)}", at,
                )  # fmt: skip
    surface.vertices = np.array(places, float).reshape(-1, 3)
    if passed_over:
        surface.notes.append(f"lines, points and free-form pieces are left out: {', '.join(sorted(passed_over))}")
    return surface


OBJ_WORDS = frozenset(
    ("vt", "vn", "vp", "s", "usemtl", "mtllib", "usemap", "maplib", "deg", "bmat", "step", "cstype", "parm", "trim")
    + ("hole", "scrv", "sp", "end", "con", "mg", "bevel", "c_interp", "d_interp", "lod", "shadow_obj", "trace_obj")
    + ("ctech", "stech")
)


MOST_AFTER = 1024
"""Bytes that a program may have written after the triangles of a binary STL file."""

# --- STL --------------------------------------------------------------------------------------------------------------


def _read_stl(path: PathLike) -> Surface:
    """Text with any number of solids, or binary, which is recognized by the length of the file."""
    data = read_bytes(path)
    if len(data) >= 84:
        count = struct.unpack("<I", data[80:84])[0]
        if len(data) == 84 + 50 * count:
            return _from_binary_stl(data, count, path)
    if data.lstrip()[:5].lower() != b"solid" or b"\0" in data[:1024]:
        if len(data) < 84:
            raise FileError(
                path, f"has {len(data)} bytes: neither a text STL, which begins with solid, nor a binary one"
            )
        more = len(data) - 84 - 50 * count
        if count > 0 and 0 < more <= MOST_AFTER:
            surface = _from_binary_stl(data, count, path)
            surface.notes.append(f"{more} bytes after its last triangle are left out")
            return surface
        raise FileError(
            path,
            f"{count} triangles need {84 + 50 * count} bytes, it has {len(data)}: it is truncated or not an STL file",
        )
    return _from_text_stl(read_text(path), path)


def _from_binary_stl(data: bytes, count: int, path: PathLike) -> Surface:
    _check_count(count, "triangles", path)
    row = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
    places = np.frombuffer(data, row, count, 84)["corners"].astype(float).reshape(-1, 3)
    return Surface(places, np.arange(len(places)).reshape(-1, 3).tolist())


def _from_text_stl(text: str, path: PathLike) -> Surface:
    places: list[list[float]] = []
    surface = Surface(np.empty((0, 3)), [])
    solid: str | None = None
    corners, at = 0, 0
    in_facet = False
    for at, line in enumerate(with_progress(text.splitlines(), "reading triangles"), 1):
        words = line.split()
        word = words[0].lower() if words else ""
        if word == "solid":
            solid = line.strip()[5:].strip()
        elif word == "facet":
            if solid is None or in_facet:
                raise FileError(path, "a facet begins within another one, or outside of a solid", at)
            in_facet, corners = True, 0
        elif word == "vertex":
            if len(words) != 4 or not in_facet:
                raise FileError(path, "a vertex is three numbers within a facet", at)
            places.append([number(value, path, at, "a vertex") for value in words[1:]])
            corners += 1
        elif word == "endfacet":
            if corners != 3 or not in_facet:
                raise FileError(path, f"a facet has {corners} vertices instead of three", at)
            in_facet = False
            surface.faces.append([len(places) - 3, len(places) - 2, len(places) - 1])
            surface.groups.append(solid or "")
            surface.lines.append(at)
            _check_count(len(surface.faces), "triangles", path, at)
        elif word == "endsolid":
            solid = None
        elif word not in ("", "outer", "endloop"):
            raise FileError(path, f"an STL file has no lines that begin with {word[:20]!r}", at)
    if solid is not None or in_facet:
        raise FileError(path, f"ends within a {'facet' if in_facet else 'solid'}: it is truncated", at)
    surface.vertices = np.array(places, float).reshape(-1, 3)
    return surface


# --- PLY and glTF -----------------------------------------------------------------------------------------------------


def trimesh() -> Any:
    """Raises ImportError that says how to get it."""
    try:
        import trimesh
    except ImportError:
        raise ImportError(f"PLY and glTF files need trimesh. {how_to_get('shapelib')}") from None
    return trimesh


def _read_ply(path: PathLike) -> Surface:
    data = read_bytes(path)
    head, _, _ = data[:65536].partition(b"end_header")
    lines = head.decode("latin-1").splitlines()
    if not lines or lines[0].strip() != "ply":
        raise FileError(path, "a PLY file begins with ply", 1)
    if b"end_header" not in data[:65536]:
        raise FileError(path, "its header has no end_header", len(lines))
    counts: dict[str, int] = {}
    for at, line in enumerate(lines, 1):
        words = line.split()
        if words[:1] == ["property"] and len(words) < 3:
            raise FileError(path, "a property has a type and a name", at)
        if words[:1] == ["element"]:
            if len(words) != 3:
                raise FileError(path, "an element has a name and a number", at)
            counts[words[1]] = whole(words[2], path, at, f"the number of {words[1]}")
            if counts[words[1]] < 0:
                raise FileError(path, f"the number of {words[1]} is {counts[words[1]]}", at)
            _check_count(counts[words[1]], words[1], path, at)
    if not counts.get("face"):
        raise FileError(path, "has points without faces")
    try:
        mesh = _load(path)
    except FileError:
        _check_rows(data, lines, path)
        raise
    if not hasattr(mesh, "faces"):
        raise FileError(path, "has no faces that trimesh can read")
    if len(mesh.vertices) != counts.get("vertex", 0) or len(mesh.faces) < counts.get("face", 0):
        _check_rows(data, lines, path)
        raise FileError(
            path, f"promises {counts.get('vertex', 0)} vertices and {counts.get('face', 0)} faces, but has "
            f"{len(mesh.vertices)} and {len(mesh.faces)}",
        )  # fmt: skip
    return _from_trimesh(mesh, path)


def _check_rows(data: bytes, head: list[str], path: PathLike) -> None:
    """Raises FileError for the first row of a text PLY file that is missing or too short. head: its lines before end_header."""
    if not any(line.split()[:2] == ["format", "ascii"] for line in head):
        return
    rows = data.decode("latin-1").splitlines()
    at = len(head) + 1
    for element in "\n".join(head).split("\nelement ")[1:]:
        first, *others = element.splitlines()
        kind, count = first.split()[:2]
        properties = [line.split()[1] for line in others if line.split()[:1] == ["property"]]
        for row in range(int(count)):
            words = rows[at].split() if at < len(rows) else []
            needed = 0
            for kind_of in properties:
                has_length = kind_of == "list" and needed < len(words) and words[needed].isdecimal()
                needed += 1 + int(words[needed]) if has_length else 1
            at += 1
            if len(words) < needed:
                found = f"has {len(words)} of {needed} values" if words else "is missing"
                raise FileError(path, f"{kind} {row + 1} (of {count}) {found}: it is truncated", min(at, len(rows)))


@apart()
def read_model(path: PathLike) -> list[PaintedSurface]:
    """The surfaces of a glTF file, one for each material of each mesh, with their colors and images; of another file the
    only one. Reads as `read_surface`. Raises FileError."""
    if Path(path).suffix.lower() in (".gltf", ".glb"):
        return read_gltf(path, lambda data, kind: _load_gltf(data, kind, path))
    surface = read_surface(path)
    return [PaintedSurface(surface.vertices, surface.faces, surface.groups, surface.lines, surface.notes)]


def _read_gltf(path: PathLike) -> Surface:
    """All meshes of the scene, transformed by its nodes."""
    surface = Surface(np.empty((0, 3)), [])
    for part in read_model(path):
        offset = len(surface.vertices)
        surface.vertices = np.concatenate([surface.vertices, part.vertices])
        surface.faces += [[v + offset for v in face] for face in part.faces]
        surface.groups += part.groups
        surface.notes += part.notes
    return surface


def _load_gltf(data: bytes, kind: str, path: PathLike) -> Any:
    resolver = trimesh().resolvers.FilePathResolver(os.fspath(path))
    return _load(path, io.BytesIO(data), file_type=kind, resolver=resolver, force="scene", skip_materials=True)


@apart()
def read_any(path: PathLike) -> tuple[Any, Any]:
    """Vertices (n, 3) and triangles (k, 3) of a file of any format that trimesh knows, for `iota.Mesh.load`. Raises FileError."""
    mesh = _load(path, force="mesh", process=True)
    surface = _from_trimesh(mesh, path)
    _check_count(len(surface.faces), "triangles", path)
    return surface.vertices, mesh.faces


def _load(path: PathLike, source: Any = None, process: bool = False, **options: Any) -> Any:
    """process: merges coincident vertices."""
    library = trimesh()
    try:
        return library.load(Path(path) if source is None else source, process=process, **options)
    except Exception as error:  # trimesh raises any exception for a damaged file
        reason = f"{type(error).__name__}: {error}".split(" — ")[0].removesuffix(": ")
        raise FileError(path, f"trimesh cannot read it: {reason}") from None


def _from_trimesh(mesh: Any, path: PathLike) -> Surface:
    if not hasattr(mesh, "faces"):
        raise FileError(path, "has points without faces")
    _check_lists(mesh, path)
    faces = np.asarray(mesh.faces)
    wrong = np.flatnonzero(((faces < 0) | (faces >= len(mesh.vertices))).any(axis=1))
    if len(wrong):
        raise FileError(path, f"face {wrong[0] + 1} (of {len(faces)}) uses a vertex that does not exist")
    return Surface(np.array(mesh.vertices, float), faces.tolist())


def _check_lists(mesh: Any, path: PathLike) -> None:
    """Raises FileError for a list in a binary PLY file with another length than the first: trimesh takes all to be as long."""
    for element, read in mesh.metadata.get("_ply_raw", {}).items():
        rows = read.get("data")
        for name in (isinstance(rows, np.ndarray) and rows.dtype.names) or ():
            if rows.dtype[name].names != ("f0", "f1"):
                continue
            lengths, most = rows[name]["f0"], rows[name]["f1"].shape[1]
            for row in np.flatnonzero(lengths != most)[:1]:
                what = f"{element} {row + 1} (of {len(rows)}) has a list of {lengths[row]}, the first one of {most}"
                raise FileError(path, f"{what}: it is damaged, or a binary file with lists of several lengths")


READERS: dict[str, Callable[[PathLike], Surface]] = {
    ".off": _read_off, ".obj": _read_obj, ".stl": _read_stl, ".ply": _read_ply, ".gltf": _read_gltf, ".glb": _read_gltf,
}  # fmt: skip
