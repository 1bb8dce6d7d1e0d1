# SPDX-License-Identifier: Apache-2.0
"""glTF 2.0 files: their triangles, base colors and images."""

from __future__ import annotations

import base64
import binascii
import json
import os
import struct
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any
from urllib.parse import unquote

import numpy as np

from iota.shapelib.files import FileError, PathLike, read_bytes
from iota.shapelib.surface import MOST_FACES, Surface
from iota.textures import Texture, check_image, size_of

if TYPE_CHECKING:
    from iota.shapelib.surface import Array

MOST_ROUGH = 0.6  # of metal that shines
MOST_PIXELS = 1 << 26  # of all images of a file: 256 MiB on the graphics card
# Bytes of a number, by its type; numbers of a value. A matrix of bytes has gaps and is no part of a mesh.
SIZES = {5120: 1, 5121: 1, 5122: 2, 5123: 2, 5125: 4, 5126: 4}
NUMBERS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT2": 4, "MAT3": 9, "MAT4": 16}
WHOLE = {"b": 127, "B": 255, "h": 32767, "H": 65535}  # 1 in coordinates of whole numbers


@dataclass
class PaintedSurface(Surface):
    """A surface of one material. name: of its mesh. color: of its material, "#rrggbbaa", None: unknown. material: "steel"
    for metal that is not rough, else "paint", as pages have no shades between. coordinates: of
    the texture at each vertex, (n, 2), from the lower left corner (0, 0) to (1, 1)."""

    name: str = ""
    color: str | None = None
    material: str = "paint"
    texture: Texture | None = None
    coordinates: Array | None = None


def read_gltf(path: PathLike, read_mesh: Callable[[bytes, str], Any]) -> list[PaintedSurface]:
    """The surfaces of a scene, one for each material of each mesh at each node, placed by the nodes. read_mesh: makes a
    trimesh scene of a file without materials and of its type, "gltf" or "glb". Images that cannot be used are left out,
    with a note. Raises FileError."""
    head, binary = _split(read_bytes(path), path)
    needed = head.get("extensionsRequired", [])
    if not isinstance(needed, list):
        raise FileError(path, "is not glTF: an object with a list of required extensions must stand here")
    if packed := [name for name in needed if "compression" in str(name)]:
        raise FileError(path, f"its meshes are compressed ({', '.join(packed)}), which is not read; export it without")
    try:
        _check_tree(head.get("nodes", []), path)
        _check_buffers(head, binary, path)
        _check_accessors(head, path)
        materials = _Materials(head, binary, path)
        bare = _without_materials(head)
    except (KeyError, IndexError, TypeError, ValueError, AttributeError, RecursionError) as error:
        if isinstance(error, FileError):
            raise
        raise FileError(path, f"is not glTF: {type(error).__name__}: {error}") from None
    text = json.dumps(bare).encode()
    if binary is None:
        scene = read_mesh(text, "gltf")
    else:
        text += b" " * (-len(text) % 4)
        chunks = struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(binary), b"BIN\0") + binary
        scene = read_mesh(struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks, "glb")
    if not scene.geometry:
        raise FileError(path, "has no meshes")
    found = list(_surfaces(scene, materials, path))
    if not found:
        raise FileError(path, "has no triangles in its scene")
    found[0].notes += materials.notes + _left_out(head)
    return found


def _split(data: bytes, path: PathLike) -> tuple[dict[str, Any], bytes | None]:
    """The description, and the binary part of a .glb file."""
    binary = None
    if Path(path).suffix.lower() == ".glb":
        if len(data) < 20 or data[:4] != b"glTF" or struct.unpack("<I", data[8:12])[0] != len(data):
            raise FileError(path, "is not a binary glTF file, or is truncated")
        end = 20 + struct.unpack("<I", data[12:16])[0]
        binary, data = data[end + 8 :], data[20:end]
    try:
        head = json.loads(data)
    except (ValueError, RecursionError) as error:
        reason = "not a text file" if isinstance(error, UnicodeDecodeError) else error
        raise FileError(path, f"is not glTF: {reason}", getattr(error, "lineno", None)) from None
    if not isinstance(head, dict):
        raise FileError(path, "is not glTF: an object with a list of required extensions must stand here")
    return head, binary


def _check_tree(nodes: list[dict[str, Any]], path: PathLike) -> None:
    """Raises FileError unless each node has one parent at most and none is below itself, as glTF demands."""
    parents: dict[int, int] = {}
    for at, node in enumerate(nodes):
        for child in node.get("children", []):
            if not 0 <= child < len(nodes):
                raise FileError(path, f"node {at} has a child {child}; there are 0..{len(nodes) - 1}")
            if child in parents:
                raise FileError(path, f"node {child} is a child of node {parents[child]}, and again of node {at}")
            parents[child] = at
    found = [at for at in range(len(nodes)) if at not in parents]
    for at in found:  # grows meanwhile
        found += nodes[at].get("children", [])
    if circle := sorted(set(range(len(nodes))) - set(found)):
        raise FileError(path, f"node {circle[0]} is below itself")


def _check_buffers(head: dict[str, Any], binary: bytes | None, path: PathLike) -> None:
    """Raises FileError for a buffer that is shorter than it says, and for a part of one beyond its end."""
    sizes = []
    for at, buffer in enumerate(head.get("buffers", [])):
        promised = int(buffer["byteLength"])
        if "uri" in buffer:
            try:
                data = _read_uri(buffer["uri"], path)
            except ValueError as error:
                raise FileError(path, f"buffer {at} cannot be read: {error}") from None
        elif binary is not None and at == 0:
            data = binary
        else:
            raise FileError(path, f"buffer {at} has no data")
        if len(data) < promised:
            raise FileError(path, f"buffer {at} has {len(data)} bytes, {promised} promised: it is truncated")
        sizes.append(promised)
    for at, view in enumerate(head.get("bufferViews", [])):
        end, size = int(view.get("byteOffset", 0)) + int(view["byteLength"]), sizes[view["buffer"]]
        if end > size:
            raise FileError(path, f"buffer view {at} ends at byte {end} of buffer {view['buffer']}, which has {size}")


def _check_accessors(head: dict[str, Any], path: PathLike) -> None:
    """Raises FileError for values that lie beyond the end of their part of a buffer, or are given as differences."""
    views = head.get("bufferViews", [])
    for at, accessor in enumerate(head.get("accessors", [])):
        if "sparse" in accessor:
            raise FileError(path, f"accessor {at} is sparse, which is not read; export it without")
        view = accessor.get("bufferView")
        if view is None:
            continue
        if not 0 <= view < len(views):
            raise FileError(path, f"accessor {at} is in buffer view {view}; there are 0..{len(views) - 1}")
        count, size = int(accessor["count"]), SIZES[accessor["componentType"]] * NUMBERS[accessor["type"]]
        stride = int(views[view].get("byteStride", size))
        end = int(accessor.get("byteOffset", 0)) + (stride * (count - 1) + size if count > 0 else 0)
        if end > (has := int(views[view]["byteLength"])):
            raise FileError(path, f"accessor {at} has {count} values, which end at byte {end} of a part of {has}")


def _left_out(head: dict[str, Any]) -> list[str]:
    """A note for what is not read: the mesh is as it is without it."""
    targets = sum("targets" in part for mesh in head.get("meshes", []) for part in mesh["primitives"])
    count = {what: len(head.get(what, [])) for what in ("skins", "animations")} | {"morph targets": targets}
    found = [f"{number} {what.removesuffix('s') if number == 1 else what}" for what, number in count.items() if number]
    return [f"{', '.join(found)}: left out, the shape is the one at rest"] if found else []


def _without_materials(head: dict[str, Any]) -> dict[str, Any]:
    """The same scene with a mesh for each primitive, that names the primitive and keeps coordinates as an attribute of its
    own: trimesh decodes no image then, and needs no library for that."""
    bare = {key: value for key, value in head.items() if key not in ("images", "textures", "materials", "samplers")}
    meshes: list[dict[str, Any]] = []
    made: list[list[int]] = []
    for at, mesh in enumerate(head.get("meshes", [])):
        made.append([])
        for part, primitive in enumerate(mesh["primitives"]):
            attributes = {key: value for key, value in primitive["attributes"].items() if key == "POSITION"}
            index = _coordinates_of(head, primitive)
            if index is not None:
                attributes["_COORDINATES"] = index
            kept = {key: primitive[key] for key in ("indices", "mode") if key in primitive}
            made[-1].append(len(meshes))
            meshes.append({"primitives": [kept | {"attributes": attributes}], "extras": {"mesh": at, "part": part}})
    nodes = [dict(node) for node in head.get("nodes", [])]
    for node in list(nodes):
        if "mesh" not in node:
            continue
        first, *others = made[node["mesh"]]
        node["mesh"] = first
        node["children"] = [*node.get("children", []), *range(len(nodes), len(nodes) + len(others))]
        nodes += [{"mesh": other} for other in others]
        if not node["children"]:
            del node["children"]
    return bare | {"meshes": meshes, "nodes": nodes}


def _coordinates_of(head: dict[str, Any], primitive: dict[str, Any]) -> int | None:
    """The accessor with the coordinates of a primitive's base color."""
    used = _texture_of(head, primitive)
    found = None if used is None else primitive["attributes"].get(f"TEXCOORD_{used.get('texCoord', 0)}")
    return None if found is None else int(found)


def _texture_of(head: dict[str, Any], primitive: dict[str, Any]) -> dict[str, Any] | None:
    """The image of the base color of a primitive's material."""
    if "material" not in primitive:
        return None
    material = head["materials"][primitive["material"]]
    found: dict[str, Any] | None = material.get("pbrMetallicRoughness", {}).get("baseColorTexture")
    return found


class _Materials:
    """Colors and images by primitive."""

    def __init__(self, head: dict[str, Any], binary: bytes | None, path: PathLike) -> None:
        self.notes: list[str] = []
        self._head, self._binary, self._path = head, binary, path
        self._images: dict[int, Texture | None] = {}
        self._pixels = 0
        self.parts: dict[tuple[int, int], tuple[str, str | None, str, Texture | None]] = {}
        for at, mesh in enumerate(head.get("meshes", [])):
            for part, primitive in enumerate(mesh["primitives"]):
                name = str(mesh.get("name") or "")
                self.parts[at, part] = (name, self._color(primitive), self._material(primitive), self._image(primitive))

    def _color(self, primitive: dict[str, Any]) -> str | None:
        if "material" not in primitive:
            return None
        material = self._head["materials"][primitive["material"]]
        factor = material.get("pbrMetallicRoughness", {}).get("baseColorFactor", [1, 1, 1, 1])
        rgba = np.clip(np.array(factor, float), 0, 1)
        if rgba.shape != (4,) or not np.isfinite(rgba).all():
            raise FileError(self._path, f"a base color has four numbers from 0 to 1, not {factor}")
        if material.get("alphaMode", "OPAQUE") != "BLEND":
            rgba[3] = 1
        # Factors are linear, colors of pages are as screens take them (IEC 61966-2-1).
        rgb = np.where(rgba[:3] <= 0.0031308, 12.92 * rgba[:3], 1.055 * rgba[:3] ** (1 / 2.4) - 0.055)
        return "#" + "".join(f"{round(255 * value):02x}" for value in (*rgb, rgba[3]))

    def _material(self, primitive: dict[str, Any]) -> str:
        if "material" not in primitive:
            return "paint"
        described = self._head["materials"][primitive["material"]].get("pbrMetallicRoughness", {})
        metal, rough = (described.get(name, 1) for name in ("metallicFactor", "roughnessFactor"))
        for number in (metal, rough):
            if not isinstance(number, int | float) or not 0 <= number <= 1:
                raise FileError(self._path, f"metal and roughness are numbers from 0 to 1, not {number}")
        # An image of both may have any values.
        is_metal = metal >= 0.5 and rough <= MOST_ROUGH and "metallicRoughnessTexture" not in described
        return "steel" if is_metal else "paint"

    def _image(self, primitive: dict[str, Any]) -> Texture | None:
        used = _texture_of(self._head, primitive)
        if used is None or _coordinates_of(self._head, primitive) is None:
            return None
        source = self._head["textures"][used["index"]].get("source")
        if source is None:
            self.note(f"texture {used['index']}: its kind of image is not read; export it as PNG or JPEG")
            return None
        if source not in self._images:
            self._images[source] = self._read(source)
        return self._images[source]

    def _read(self, source: int) -> Texture | None:
        """None, and a note, for an image that cannot be used."""
        image = self._head["images"][source]
        name = image.get("name") or (image.get("uri", "")[:60] if not _is_data(image) else "") or "embedded"
        try:
            data = self._data_of(image)
            check_image(data)
            width, height = size_of(data)
            if self._pixels + width * height > MOST_PIXELS:
                raise ValueError(f"all images together have more than {MOST_PIXELS >> 20} million pixels")
            self._pixels += width * height
            return Texture(data)
        except (OSError, ValueError, KeyError, IndexError, TypeError) as error:
            reason = error.strerror.lower() if isinstance(error, OSError) and error.strerror else error
            self.note(f"image {source} ({name}) is left out: {reason}")
            return None

    def note(self, text: str) -> None:
        """A line that names the file."""
        line = f"{Path(self._path).name}: {text}"
        if line not in self.notes:
            self.notes.append(line)

    def _data_of(self, image: dict[str, Any]) -> bytes:
        if "uri" in image:
            return _read_uri(image["uri"], self._path)
        view = self._head["bufferViews"][image["bufferView"]]
        buffer = self._head["buffers"][view["buffer"]]
        if "uri" in buffer:
            data = _read_uri(buffer["uri"], self._path)
        elif self._binary is not None and view["buffer"] == 0:
            data = self._binary
        else:
            raise ValueError("its buffer has no data")
        begin, length = int(view.get("byteOffset", 0)), int(view["byteLength"])
        if begin < 0 or length < 0 or begin + length > len(data):
            raise ValueError("it lies beyond the end of its buffer")
        return data[begin : begin + length]


def _is_data(image: dict[str, Any]) -> bool:
    return str(image.get("uri", "")).startswith("data:")


def _read_uri(uri: str, path: PathLike) -> bytes:
    """The bytes in a data URI, or of a file in the folder of `path` or below."""
    if uri.startswith("data:"):
        head, _, text = uri.partition(",")
        if not head.endswith(";base64"):
            raise ValueError("its data are not in base64")
        try:
            return base64.b64decode(text, validate=True)
        except binascii.Error as error:
            raise ValueError(f"its data are damaged: {error}") from None
    folder = Path(path).resolve().parent
    file = (folder / unquote(uri)).resolve()
    if not file.is_relative_to(folder):
        raise ValueError("it is outside the folder of the file")
    if os.path.exists(file) and not os.path.isfile(file):
        raise ValueError("it is not a file")
    try:
        return read_bytes(file)
    except FileError as error:
        raise ValueError(error.reason) from None


def _surfaces(scene: Any, materials: _Materials, path: PathLike) -> Iterator[PaintedSurface]:
    count, has_others = 0, False
    for mesh in scene.dump():
        if not hasattr(mesh, "faces"):
            has_others = True
            continue
        faces, places = np.asarray(mesh.faces), np.array(mesh.vertices, float)
        count += len(faces)
        if count > MOST_FACES:
            raise FileError(path, f"has {count} triangles, more than {MOST_FACES}; make it coarser")
        wrong = np.flatnonzero(((faces < 0) | (faces >= len(places))).any(axis=1))
        if len(wrong):
            raise FileError(path, f"triangle {wrong[0] + 1} (of {len(faces)}) uses a vertex that does not exist")
        if not np.isfinite(places).all():
            raise FileError(path, f"vertex {np.flatnonzero(~np.isfinite(places).all(axis=1))[0]} is not finite")
        name, color, material, texture = materials.parts[mesh.metadata["mesh"], mesh.metadata["part"]]
        laid = mesh.vertex_attributes.get("_COORDINATES")
        if texture is not None and (laid is None or laid.shape != (len(places), 2) or not np.isfinite(laid).all()):
            raise FileError(
                path, f"the texture coordinates of mesh {name!r} are not two finite numbers for each vertex"
            )
        coordinates = None
        if texture is not None:
            share = np.array(laid, float) / WHOLE.get(np.asarray(laid).dtype.char, 1)
            coordinates = np.column_stack([share[:, 0], 1 - share[:, 1]])  # glTF counts from the upper left corner
        yield PaintedSurface(
            places,
            faces.tolist(),
            [name] * len(faces),
            name=name,
            color=color,
            material=material,
            texture=texture,
            coordinates=coordinates,
        )
    if has_others:
        materials.note("lines and points are left out")
