# SPDX-License-Identifier: Apache-2.0
"""Looks of bodies on the page: shapes, their materials, and their places on the body.

Bodies are drawn by a `Look`, by a list of looks that are drawn together, or by those of each style; users switch styles on
the page while it runs. The style "*" is used for every style:

    world.draw(wheel, looks.solid("brass"))
    world.draw(links, {"rope": looks.cylinder(0.012, "rope"), "chain": looks.chain_link(0.1)})

Any shape of iota will do: `Look(iota.Cone(0.1, 0.3), "wood")`. The page draws exactly the engine's shape. The functions
below are shortcuts. Lengths in m, colors by name or as "#rrggbb", materials one of `MATERIALS`. The body's frame has its origin at
the center of mass and +x from its first particle to its last.

A `texture` is a PNG or JPEG file or an array: on each face of a box, around a ball, a cylinder or a cone, and on a mesh as
on the box around it. `repeat` says how often it is beside itself:

    looks.box((2, 0.1, 1), texture="bricks.png", repeat=(4, 2))
    looks.sphere(0.1, "paint", texture=pixels)  # an array (rows, columns, 3)
"""

from __future__ import annotations

import base64
import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, fields, replace
from typing import Any, TypeAlias, get_args

import numpy as np

from iota import shapes
from iota._core import Box, Capsule, Cone, Cylinder, Ellipsoid, Mesh, Shape, Sphere, Torus, unit_quaternion
from iota.arguments import SHORT, is_number, of_type
from iota.colors import NAMES, color_text
from iota.textures import Texture, check_image, material_name, texture_of

MATERIALS = ("steel", "brass", "rubber", "wood", "rope", "glass", "paint")
MOST_TRIANGLES = 50_000


@dataclass(frozen=True, slots=True)
class Look:
    """A drawn shape. Raises ValueError for an unknown material, for a mesh of too many triangles and for an image that
    cannot be used."""

    shape: Shape | None  #: None: the body's own shape, see `solid`
    material: str = "paint"
    color: Any = (
        None  #: "tomato", "#rrggbb" or "#rrggbbaa", 0xRRGGBB, or numbers from 0 to 1; None: that of the material
    )
    offset: Sequence[float] = (0.0, 0.0, 0.0)  #: of the shape's origin, in the body's frame, m
    rotation: Any = (0.0, 0.0, 0.0, 1.0)  #: of the shape's frame: ("z", 30), axis and degrees, or a quaternion x y z w
    turn: float = 0.0  #: of every other body with this look, about the body's x axis, rad
    fits: bool = False  #: has the length of its body or strut
    texture: Any = None  #: path of a PNG or JPEG file, or an array, see `texture_of`; None: that of the material
    repeat: float | Sequence[float] = 1.0  #: how often it is beside itself, in both directions or in each

    def __post_init__(self) -> None:
        if self.texture is not None:
            object.__setattr__(self, "texture", texture_of(self.texture, self.repeat))
        if not (self.shape is None or isinstance(self.shape, get_args(Shape))):
            raise TypeError(
                f"a look is of a shape, as in Look(iota.Sphere(0.1), 'wood'), not of {SHORT.repr(self.shape)}"
            )
        object.__setattr__(self, "offset", _finite("offset", self.offset, (2, 3)))
        object.__setattr__(self, "rotation", tuple(unit_quaternion(self.rotation)))
        object.__setattr__(self, "turn", _finite("turn", (self.turn,), (1,))[0])
        if self.color is not None:
            object.__setattr__(self, "color", color_text(self.color))
        material_of(self.material)
        if isinstance(self.shape, Mesh) and len(self.shape.triangles) > MOST_TRIANGLES:
            raise ValueError(
                f"the page draws meshes of at most {MOST_TRIANGLES} triangles, this one has "
                f"{len(self.shape.triangles)}: make it coarser, or give its body another look"
            )

    @property
    def length(self) -> float:
        """Length of the shape along its x axis, m; for a capsule that of its cylinder."""
        if self.shape is None:
            return 1.0
        low, high = self.shape.bounds
        length: float = getattr(self.shape, "length", high.x - low.x)
        return length if math.isfinite(length) else 1.0

    def of_length(self, length: float) -> Look:
        """The same look with a length (m), if it fits its body."""
        if not self.fits or not isinstance(self.shape, Cylinder | Capsule):
            return self
        return replace(self, shape=type(self.shape)(self.shape.radius, length))

    def describe(self) -> dict[str, Any]:
        """Plain data for the page."""
        described: dict[str, Any] = {"material": material_name(self.material, self.texture)}
        if self.shape is not None:
            described |= {"kind": self.shape.kind, "sizes": list(self.shape.numbers)}
        if isinstance(self.shape, Mesh):
            described["vertices"] = [float(f"{x:.6g}") for vertex in self.shape.vertices for x in vertex]
            described["triangles"] = self.shape.triangles.ravel().tolist()
        if self.color is not None:
            described["color"] = self.color
        if self.turn:
            described["turn"] = self.turn
        return described | {"offset": list(self.offset), "rotation": list(self.rotation)}


def material_of(name: str) -> str:
    """Returns the name. Raises ValueError unless it is a material."""
    if name not in MATERIALS:
        hint = f"; did you mean color={name!r}?" if isinstance(name, str) and name.lower() in NAMES else ""
        raise ValueError(f"material must be one of {', '.join(MATERIALS)}, not {name!r}{hint}")
    return name


def _finite(name: str, values: Any, counts: Sequence[int]) -> tuple[float, ...]:
    """As numbers; without the last of three, that is 0."""
    parts = tuple(values) if isinstance(values, Iterable) else ()
    if len(parts) not in counts or not all(is_number(part) and math.isfinite(part) for part in parts):
        wanted = "a finite number" if counts == (1,) else f"{' or '.join(map(str, counts))} finite numbers"
        raise ValueError(f"{name} must be {wanted}, not {SHORT.repr(values)}")
    return tuple(float(part) for part in parts) + (0.0,) * (max(counts) - len(parts))


Looks: TypeAlias = dict[str, Look | list[Look]]
Drawn: TypeAlias = Look | list[Look] | Looks  # one look, several drawn together, or those of each style


def by_style(look: Drawn) -> Looks:
    """The looks of each style. Raises TypeError for anything else."""
    styles = look if isinstance(look, dict) else {"*": look}
    for looks in styles.values():
        for each in _listed(looks):
            if not isinstance(each, Look):
                raise TypeError(f"a look is made by iota.looks, as in looks.solid('brass'), not {each!r}")
    return styles


def sphere(radius: float, material: str = "brass", **more: Any) -> Look:
    """A ball of `radius` m. `more`, here and below: color, offset, rotation, turn, texture and repeat, see `Look`."""
    return Look(Sphere(radius), material, **more)


def cylinder(radius: float, material: str = "steel", length: float | None = None, **more: Any) -> Look:
    """A cylinder along local x. Without `length` it is as long as the body: from first to last particle."""
    return Look(Cylinder(radius, UNKNOWN if length is None else length), material, fits=length is None, **more)


def capsule(radius: float, material: str = "steel", length: float | None = None, **more: Any) -> Look:
    """A cylinder with half balls at its ends; `length` is that of the cylinder."""
    return Look(Capsule(radius, UNKNOWN if length is None else length), material, fits=length is None, **more)


def torus(radius: float, tube: float, material: str = "steel", stretch: float = 0.0, **more: Any) -> Look:
    """A ring in the local x-y plane: center line `radius`, wire radius `tube`, both halves pulled apart along x by
    `stretch`."""
    return Look(Torus(radius, tube, stretch), material, **more)


def box(size: Sequence[float], material: str = "wood", rounding: float = 0.0, **more: Any) -> Look:
    """A box with edges `size` = (x, y, z), rounded by arcs of `rounding`."""
    return Look(Box(size, rounding), material, **more)


def cone(radius: float, length: float, material: str = "paint", **more: Any) -> Look:
    """Along local x: its base at -length/2, its tip at +length/2."""
    return Look(Cone(radius, length), material, **more)


def arrow(length: float, radius: float | None = None, material: str = "paint", **more: Any) -> Look:
    """Along local x, from its tail in the origin to its tip. radius: of its shaft; default: in proportion to its length."""
    shaft = 0.018 * length if radius is None else radius
    head = length - min(7 * shaft, 0.6 * length)
    return _revolved([(0.0, 0.0), (0.0, shaft), (head, shaft), (head, 2.6 * shaft), (length, 0.0)], 8, material, **more)


def ellipsoid(size: Sequence[float], material: str = "paint", **more: Any) -> Look:
    """Its whole axes are `size` = (x, y, z)."""
    return Look(Ellipsoid(size), material, **more)


def disc(radius: float, thickness: float | None = None, material: str = "paint", **more: Any) -> Look:
    """Normal to local x; default `thickness`: a hundredth of its radius."""
    return Look(Cylinder(radius, radius / 100 if thickness is None else thickness), material, **more)


def pyramid(size: Sequence[float], material: str = "paint", **more: Any) -> Look:
    """Along local x: a base of size (y, z) at -x/2, its tip at +x/2. size: (x, y, z)."""
    if len(size) != 3:
        raise ValueError(f"pyramid: size must be 3 numbers, not {size!r}")
    x, y, z = (side / 2 for side in size)
    vertices = [(-x, -y, -z), (-x, y, -z), (-x, y, z), (-x, -y, z), (x, 0, 0)]
    return mesh(vertices, [(0, 2, 1), (0, 3, 2), (0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4)], material, **more)


def half_sphere(radius: float, material: str = "paint", segments: int = 32, **more: Any) -> Look:
    """Round towards +x, flat at x = 0."""
    if segments < 4:
        raise ValueError(f"half_sphere: segments must be at least 4, not {segments}")
    angles = np.linspace(0, math.pi / 2, segments // 4 + 1)[:-1]
    profile = [(radius * math.sin(a), radius * math.cos(a)) for a in angles]
    return _revolved([(0.0, 0.0), *profile, (radius, 0.0)], segments, material, **more)


def polygon(corners: Sequence[Sequence[float]], thickness: float, material: str = "paint", **more: Any) -> Look:
    """A plate with these corners (x, y), m, in the local x-y plane, in order, without crossings; `thickness` along z.
    Raises ValueError for corners that are not a simple polygon."""
    outline = np.array(corners, float)
    if outline.ndim != 2 or outline.shape[1] != 2 or len(outline) < 3:
        raise ValueError("a polygon needs at least three corners (x, y)")
    if not (math.isfinite(thickness) and thickness > 0):
        raise ValueError(f"the thickness of a polygon must be above 0 m, not {thickness}")
    x, y = outline.T
    if np.dot(x, np.roll(y, -1)) < np.dot(y, np.roll(x, -1)):
        outline = outline[::-1]
    count, half = len(outline), np.full((len(outline), 1), thickness / 2)
    top = [tuple(row) for row in ears(outline)]
    sides = [(i, j, i + count) for i in range(count) for j in [(i + 1) % count]]
    sides += [(j, j + count, i + count) for i in range(count) for j in [(i + 1) % count]]
    bottom = [(a, c, b) for a, b, c in top]
    vertices = np.vstack([np.hstack([outline, -half]), np.hstack([outline, half])])
    return mesh(vertices, bottom + [(a + count, b + count, c + count) for a, b, c in top] + sides, material, **more)


def ears(outline: Any) -> list[tuple[int, int, int]]:
    """Triangles of a simple polygon, corners (n, 2) counter-clockwise, by cutting off ears (Meisters 1975). Raises
    ValueError if there are none: it crosses itself."""

    def turn(a: Any, b: Any, c: Any) -> float:
        return float((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]))

    left, triangles = list(range(len(outline))), []
    while len(left) > 3:
        for place, own in enumerate(left):
            before, after = left[place - 1], left[(place + 1) % len(left)]
            a, b, c = outline[before], outline[own], outline[after]
            others = [outline[k] for k in left if k not in (before, own, after)]
            inside = any(min(turn(a, b, p), turn(b, c, p), turn(c, a, p)) >= 0 for p in others)
            if turn(a, b, c) > 0 and not inside:
                triangles.append((before, own, after))
                del left[place]
                break
        else:
            raise ValueError("the corners are not the outline of a polygon: it crosses or touches itself")
    return [*triangles, (left[0], left[1], left[2])]


def _revolved(profile: Sequence[tuple[float, float]], segments: int, material: str, **more: Any) -> Look:
    """A solid of revolution about local x: a profile of (x, radius) from axis to axis, with +x to the right and the
    outside above."""
    rings = [
        [(x, r * math.cos(a), r * math.sin(a)) for a in np.arange(segments) * 2 * math.pi / segments]
        for x, r in profile[1:-1]
    ]
    vertices = [(profile[0][0], 0.0, 0.0), *(v for ring in rings for v in ring), (profile[-1][0], 0.0, 0.0)]
    last = len(vertices) - 1
    triangles = []
    for k in range(segments):
        j = (k + 1) % segments
        triangles.append((0, 1 + j, 1 + k))
        triangles.append((last, last - segments + k, last - segments + j))
        for ring in range(len(rings) - 1):
            a, b = 1 + ring * segments, 1 + (ring + 1) * segments
            triangles += [(a + k, a + j, b + k), (a + j, b + j, b + k)]
    return mesh(vertices, triangles, material, **more)


def mesh(vertices: Any, triangles: Any, material: str = "paint", **more: Any) -> Look:
    """A closed surface: vertices (n, 3) in m, triangles (k, 3), from outside counter-clockwise, as in `iota.Mesh`.
    Raises ValueError above 50 000 triangles."""
    return Look(Mesh(vertices, triangles), material, **more)


def chain_link(length: float, material: str = "steel") -> Look:
    """A link of a real chain for a body of `length` m: neighbors touch at their hinge, turned by 90 degrees."""
    tube, radius = 0.085 * length, 0.26 * length
    return torus(radius, tube, material, stretch=length + 2 * (tube - radius), turn=math.pi / 2)


def spring(radius: float, wire: float, material: str = "steel", color: str | None = None) -> Look:
    """For springs between bodies, see `World.draw_ties`: a coil of `radius`, of wire of radius `wire`. Its shape is one turn
    of it."""
    return Look(Torus(radius, wire), material, color)


def solid(material: str, color: str | None = None, **more: Any) -> Look:
    """For bodies given by shape: that shape, of a material. In a list, one for each solid of a combined body; the last one is that of all
    further solids, and other looks of the list are drawn beside them, or instead of those of color "#00000000". more: texture and repeat,
    see `Look`."""
    return Look(None, material, color, **more)


def to_json(look: Drawn) -> dict[str, Any]:
    """Looks as plain data for a file."""
    return {style: [_to_json(each) for each in _listed(looks)] for style, looks in by_style(look).items()}


def from_json(data: dict[str, Any]) -> Looks:
    """Reads the result of `to_json`. Raises ValueError that names the error."""
    styles: Looks = {}
    for style, described in of_type(data, dict, "a look").items():
        looks = [_from_json(entry) for entry in of_type(described, list, f"its style {style!r}")]
        styles[style] = looks[0] if len(looks) == 1 else looks
    return styles


def _listed(looks: Look | list[Look]) -> list[Look]:
    return looks if isinstance(looks, list) else [looks]


def _to_json(look: Look) -> dict[str, Any]:
    """Without the fields that have their default value."""
    entry = {f.name: value for f in fields(look) if (value := getattr(look, f.name)) != f.default}
    if look.texture is not None:
        entry |= {"texture": base64.b64encode(look.texture.image).decode(), "repeat": list(look.texture.repeat)}
    return entry | {"shape": look.shape and shapes.to_json(look.shape)}


def _from_json(entry: dict[str, Any]) -> Look:
    shape, image = of_type(entry, dict, "a look").get("shape"), entry.get("texture")
    try:
        if image is not None:
            image = Texture(base64.b64decode(image, validate=True), tuple(entry["repeat"]))
            check_image(image.image)
        return Look(**{**entry, "shape": shape and shapes.from_json(shape), "texture": image})
    except KeyError as error:
        raise ValueError(f"a look has no {error.args[0]}") from None
    except TypeError as error:
        raise ValueError(f"a look is described wrongly: {error}") from None


UNKNOWN = 0.1  # length of a fitting look for a body without one, m
