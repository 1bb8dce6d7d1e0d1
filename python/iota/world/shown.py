# SPDX-License-Identifier: Apache-2.0
"""Things without physics: labels, lines, arrows, axes, traces, points, shapes, surfaces, colors. Each is one kind of
the protocol."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import Any, TypeVar, cast

import numpy as np
from numpy.typing import NDArray

from iota._core import Body, Vec3
from iota._protocol import ENTITIES, NO_BODY, NO_COLOR, LightKind
from iota.arguments import SHORT, is_number
from iota.colors import SLACK
from iota.looks import Look
from iota.simulator import SimulatedBody
from iota.textures import Texture, lay_flat, material_name, texture_of
from iota.world.things import (
    FARTHEST,
    Attachable,
    Field,
    Thing,
    Things,
    anchor,
    color,
    ends,
    flag,
    length,
    number,
    numbers,
    place,
    points,
    text,
    unit_quaternion,
    vector,
)
from iota.world.things import color as any_color

MOST_TRACE = 16384
LAMPS = {"point": LightKind.POINT, "spot": LightKind.SPOT, "sun": LightKind.SUN}
MOST_LIGHTS = 8
MOST_SHADOWS = 2  # each is one more picture of the scene in every frame

Rows = TypeVar("Rows")


class Label(Thing):
    """A line of text. at: particle, body, bond (its middle) or a place. offset: world, m. height: of a capital, m; 0: a
    constant size on the screen."""

    kind = "label"
    at, offset, text, height, color = Field(place), Field(vector), Field(text), Field(length), Field(color)

    def _record(self) -> dict[str, Any] | None:
        a, b = ends(self.at)
        return None if a is None or b is None else self._values | {"a": a, "b": b}


def _limited(check: Callable[[Any], Rows], kind: str, field: str) -> Callable[[Any], Rows]:
    """Also refuses more rows than pages take at once."""
    most = next(most for name, _, most, _ in ENTITIES[kind] if name == field)

    def checked(value: Any) -> Rows:
        rows = check(value)
        if isinstance(rows, np.ndarray) and rows.size > most:
            count = most // rows.shape[1]
            raise ValueError(f"may have {count} rows at most, not {len(rows)}; draw them in several parts")
        return rows

    return checked


def _points(value: Any) -> Any:
    """An array, or a list of places."""
    if isinstance(value, str | bytes) or not isinstance(value, Iterable):
        raise TypeError(f"must be places or an array of them, not {SHORT.repr(value)}")
    if isinstance(value, np.ndarray) or not any(isinstance(at, Attachable) for at in value):
        return points(value)
    return [place(at) for at in value]


def _on_bodies(given: Any) -> dict[str, Any] | None:
    """Points as sent to pages; None if one of them is on something that no longer exists."""
    if isinstance(given, np.ndarray):
        return {"bodies": (), "points": given}
    anchors = [anchor(at) for at in given]
    there = [a for a in anchors if a is not None]
    if len(there) < len(anchors):
        return None
    return {"bodies": [a["body"] for a in there], "points": [tuple(a["point"]) for a in there]}


class _Curve(Thing):
    """Through points, each a particle, body or place."""

    points, color, closed = Field(_points), Field(color), Field(flag)

    def _record(self) -> dict[str, Any] | None:
        placed = _on_bodies(self.points)
        return None if placed is None else self._values | placed

    def _is_attached(self) -> bool:
        return not isinstance(self.points, np.ndarray)


class Line(_Curve):
    """Straight pieces through points: each a particle, body or place. radius: m; 0: a few pixels. closed: back to the first."""

    kind = "line"
    radius = Field(length)


class Tube(_Curve):
    """A round tube along a smooth curve through points, see `Line`. radius: m. closed: back to the first."""

    kind = "tube"
    material = Field(text)
    radius = Field(number(1e-15, FARTHEST))


class Arrow(Thing):
    """From `at` to `to`, or without `to` along `vector` (world, m). radius: of the shaft, m; 0: by its length."""

    kind = "arrow"
    at, vector, radius, color = Field(place), Field(vector), Field(length), Field(color)
    to = Field(lambda value: None if value is None else place(value))

    def _record(self) -> dict[str, Any] | None:
        a, b = ends(self.at, self.to)
        return None if a is None or b is None else self._values | {"a": a, "b": b}


class Axes(Thing):
    """Three arrows along x (red), y (green) and z (blue) of a body or the world. length: m."""

    kind = "axes"
    at, length = Field(place), Field(length)
    rotation = Field(unit_quaternion)

    def _record(self) -> dict[str, Any] | None:
        at = anchor(self.at)
        return None if at is None else self._values | {"at": at}


class Trace(Thing):
    """The past path of a point, as recorded by each page; it is cleared when the world goes back in time. seconds: of
    simulated time, 0: the largest number of points."""

    kind = "trace"
    at, seconds, radius, color = Field(place), Field(number(0, 1e6)), Field(length), Field(color)
    capacity = Field(lambda value: int(number(2, MOST_TRACE)(value)))

    def _record(self) -> dict[str, Any] | None:
        at = anchor(self.at)
        return None if at is None else self._values | {"at": at}


def colors(value: Any) -> NDArray[np.uint32]:
    """One color, or one for each. Raises ValueError, TypeError."""
    if isinstance(value, np.ndarray) and value.ndim == 2 and value.dtype.kind in "fiu":
        parts = value.astype(float)
        if parts.shape[1] not in (3, 4) or not ((parts >= -SLACK) & (parts <= 1 + SLACK)).all():
            raise ValueError(f"colors are an array (n, 3) of numbers from 0 to 1, not {SHORT.repr(value)}")
        parts = np.round(255 * np.clip(parts, 0, 1)).astype(np.uint32)
        clear = 255 - parts[:, 3] if parts.shape[1] == 4 else np.uint32(0)
        return np.asarray(clear << 24 | parts[:, 0] << 16 | parts[:, 1] << 8 | parts[:, 2], np.uint32)
    if not (value is None or isinstance(value, str | int | Sequence | np.ndarray)):
        raise TypeError(f"must be a color or a list of them, not {SHORT.repr(value)}")
    is_one = value is None or isinstance(value, str | int) or _are_parts(value)
    listed: Iterable[Any] = [value] if is_one else cast("Iterable[Any]", value)
    return np.array([any_color(each) for each in listed], np.uint32)


def _are_parts(value: Any) -> bool:
    """Whether these are the numbers of one color: 0xRRGGBB of several are larger."""
    return len(value) in (3, 4) and all(is_number(part) and float(part) <= 1 for part in value)


class Points(Thing):
    """Many balls, set by one array. points: shape (n, 3), m, in the frame of `at`. radius: m, one or n. color: one, or n of
    them: an array of shape (n, 3) from 0 to 1, or a list of n colors."""

    kind = "point_cloud"
    at, points = Field(place), Field(_limited(points, "point_cloud", "points"))

    @staticmethod
    def _radii(value: Any) -> NDArray[np.float32]:
        radii = np.atleast_1d(numbers(value)).astype(np.float32)
        if radii.ndim != 1 or not (radii >= 0).all() or not np.isfinite(radii).all():
            raise ValueError("must be one radius, or one for each point, of 0 m or more")
        return radii

    radius, color = Field(_radii), Field(colors)

    def _record(self) -> dict[str, Any] | None:
        at = anchor(self.at)
        if at is None:
            return None
        for name, values in (("radius", self.radius), ("color", self.color)):
            if len(values) not in (1, len(self.points)):
                raise ValueError(f"{name} must be one, or one for each of the {len(self.points)} points")
        return self._values | {"at": at, "radii": self.radius, "colors": self.color}


def _look(value: Any) -> Look:
    if not isinstance(value, Look) or value.shape is None:
        raise TypeError(f"must be a Look with a shape, not {value!r}")
    return value


def part_of_look(look: Look, color: int = NO_COLOR, **place: Any) -> dict[str, Any]:
    """A look as sent to pages. color: replaces its own. place: replaces its offset and rotation."""
    described = look.describe() | place
    shape = {"kind": described["kind"], "sizes": described["sizes"]}
    shape |= {"vertices": described.get("vertices", ()), "triangles": described.get("triangles", ())}
    own = any_color(described.get("color")) if color == NO_COLOR else color
    part = {"style": "*", "shape": shape, "turn": 0.0, "material": described["material"], "color": own}
    return part | {"offset": described["offset"], "rotation": described["rotation"]}


class Marker(Thing):
    """A look on a body or frame, or in the world. position: of its origin, in that frame or the world, m. rotation:
    in it, as of `Drawings.shape`. color: replaces the look's."""

    kind = "marker"
    position, color, rotation = Field(vector), Field(color), Field(unit_quaternion)

    @staticmethod
    def _on(value: Any) -> Any:
        if value is not None and not isinstance(value, Attachable):
            raise TypeError(f"must be a body, a particle, a frame or None, not {type(value).__name__}")
        return value

    look, on = Field(_look), Field(_on)

    def _texture(self) -> Texture | None:
        return self.look.texture  # type: ignore[no-any-return]

    def _record(self) -> dict[str, Any] | None:
        at = anchor(self.on)
        if at is None:
            return None
        x, y, z = at["point"] if at["body"] != NO_BODY else (0, 0, 0)
        offset = (x + self.position.x, y + self.position.y, z + self.position.z)
        return {"body": at["body"], "part": part_of_look(self.look, self.color, offset=offset, rotation=self.rotation)}


class Strut(Thing):
    """A look from one place to another: its x axis runs along the line, and it is stretched to its length. Its roll
    about the line changes smoothly; it is not drawn if both places coincide."""

    kind = "strut"
    look, at, to, color = Field(_look), Field(place), Field(place), Field(color)

    def _texture(self) -> Texture | None:
        return self.look.texture  # type: ignore[no-any-return]

    def _record(self) -> dict[str, Any] | None:
        a, b = anchor(self.at), anchor(self.to)
        if a is None or b is None:
            return None
        # A fitting look gets about its final length, so that its ends keep their form.
        look = self.look.of_length(_apart(self.at, self.to) or 1.0)
        return {"a": a, "b": b, "part": part_of_look(look, self.color), "length": look.length}


def _present(at: Any) -> Any:
    """A place of the world, m, or something else if it is unknown."""
    return at if isinstance(at, Thing) else getattr(at, "position", getattr(at, "center_of_mass", at))


def _apart(at: Any, to: Any) -> float:
    """Present distance of two places, m; 0 if one is unknown."""
    places = [_present(at), _present(to)]
    return abs(Vec3(*places[0]) - Vec3(*places[1])) if all(isinstance(place, Vec3) for place in places) else 0.0


class Shapes(Thing):
    """Many copies of a look. positions: (n, 3), m, in the frame of `at`. rotations: (n, 4), quaternions x y z w, or
    None. sizes: factors of the look's size, one number, (n,) or (n, 3) along its axes, or None. color: one, n, or an
    array (n, 3) from 0 to 1."""

    kind = "shape_set"
    look, at, positions = Field(_look), Field(place), Field(_limited(points, "shape_set", "places"))

    @staticmethod
    def _rotations(value: Any) -> NDArray[np.float64]:
        rows = np.zeros((0, 4)) if value is None else numbers(value)
        if rows.ndim != 2 or rows.shape[1] != 4 or not (np.linalg.norm(rows, axis=1) > 1e-9).all():
            raise ValueError("must have the shape (n, 4), each row a quaternion that is not zero")
        return rows

    @staticmethod
    def _sizes(value: Any) -> NDArray[np.float64]:
        sizes = np.zeros(0) if value is None else np.atleast_1d(numbers(value))
        if sizes.ndim > 2 or sizes.shape[1:] not in ((), (3,)) or not np.isfinite(sizes).all():
            raise ValueError("must be one number, (n,) or (n, 3), all finite")
        return sizes

    rotations, sizes, color = Field(_rotations), Field(_sizes), Field(colors)

    def _texture(self) -> Texture | None:
        return self.look.texture  # type: ignore[no-any-return]

    def _record(self) -> dict[str, Any] | None:
        at, count = anchor(self.at), len(self.positions)
        if at is None:
            return None
        for name, many in (("rotations", (0, count)), ("sizes", (0, 1, count)), ("color", (1, count))):
            if len(getattr(self, name)) not in many:
                raise ValueError(
                    f"{name} must be {many[-1]}, one for each of the positions, not {len(getattr(self, name))}"
                )
        one = self.color[0] if len(self.color) == 1 else NO_COLOR
        return {
            "at": at,
            "part": part_of_look(self.look, int(one)),
            "places": self.positions,
            "rotations": self.rotations,
            "scales": self.sizes,
            "colors": self.color if len(self.color) > 1 else (),
        }


class Surface(Thing):
    """Triangles, visible from both sides. points: an array (n, 3) in the frame of `at`, m, or particles, bodies and
    places, with which it bends. triangles: (k, 3) indices of points. threads: springs or ropes: a triangle is removed
    with a thread along one of its edges, also when that breaks. texture: an image, see `iota.looks`. coordinates: its place at each point,
    (n, 2), from the lower left corner (0, 0) to (1, 1); None: it is laid once over the points, along their shortest axis,
    where they are when it is assigned."""

    kind = "surface"
    at, points = Field(place), Field(_limited(_points, "surface", "points"))
    color, material = Field(color), Field(text)

    @staticmethod
    def _triangles(value: Any) -> NDArray[np.int64]:
        numbers(value)  # refuses what has rows of several lengths
        rows = np.array(value)
        if rows.size == 0:
            rows = np.zeros((0, 3), np.int64)
        if rows.ndim != 2 or rows.shape[1] != 3 or rows.dtype.kind not in "iu" or rows.min(initial=0) < 0:
            raise ValueError("must have the shape (k, 3), whole numbers of points from 0")
        return rows

    @staticmethod
    def _threads(value: Any) -> list[Any]:
        return list(value)

    @staticmethod
    def _coordinates(value: Any) -> NDArray[np.float32] | None:
        rows = None if value is None else numbers(value).astype(np.float32)
        if rows is not None and (rows.ndim != 2 or rows.shape[1] != 2 or not np.isfinite(rows).all()):
            raise ValueError("must have the shape (n, 2), all finite")
        return rows

    triangles = Field(_limited(_triangles, "surface", "triangles"))
    threads, coordinates = Field(_threads), Field(_coordinates)
    texture = Field(lambda value: None if value is None else texture_of(value))

    def _texture(self) -> Texture | None:
        return self.texture

    def _record(self) -> dict[str, Any] | None:
        at, count = anchor(self.at), len(self.points)
        if self.triangles.max(initial=-1) >= count:
            raise ValueError(f"triangles: name point {self.triangles.max()}, but there are {count}")
        placed = _on_bodies(self.points)
        if at is None or placed is None:
            return None
        shown = {"at": at, "material": material_name(self.material, self.texture), "color": self.color}
        return shown | {"coordinates": self._laid(), "triangles": self._whole()} | placed

    def _laid(self) -> Any:
        """The place of the image at each point."""
        if self.texture is None:
            return ()
        count, given = len(self.points), self.coordinates
        if given is not None and len(given) != count:
            raise ValueError(f"coordinates: must be one for each of the {count} points, not {len(given)}")
        if given is not None:
            return given
        # Once for moving points: otherwise the image would slip over a cloth.
        if self._flat is None or len(self._flat) != count:
            self._flat = lay_flat(np.array([_present(at) for at in self.points], float).reshape(-1, 3))
        return self._flat

    _flat: NDArray[np.float64] | None = None

    def _is_attached(self) -> bool:
        return super()._is_attached() or not isinstance(self.points, np.ndarray)

    def _whole(self) -> NDArray[np.int64]:
        """The triangles except those that have lost a thread along an edge."""
        torn = self._torn()
        if not torn:
            return self.triangles
        edges = ((0, 1), (1, 2), (2, 0))
        kept = [not any(frozenset((row[a], row[b])) in torn for a, b in edges) for row in self.triangles.tolist()]
        return self.triangles[kept]

    def _torn(self) -> set[frozenset[int]]:
        """Edges whose thread no longer exists, is broken or switched off."""
        if isinstance(self.points, np.ndarray) or not self.threads:
            return set()
        if self._edges is None:
            number = {getattr(at, "body", at): index for index, at in enumerate(self.points)}
            ends = (
                (thread, {number[end.body] for end in thread.ends if end.body in number}) for thread in self.threads
            )
            self._edges = [(thread, frozenset(pair)) for thread, pair in ends if len(pair) == 2]
        return {edge for thread, edge in self._edges if not (thread.alive and thread.active)}

    _edges: list[tuple[Any, frozenset[int]]] | None = None


class Paint(Thing):
    """Colors of bodies, instead of those of their materials. color: one, one for each body, or an array (n, 3) from 0
    to 1."""

    kind = "paint"

    @staticmethod
    def _bodies(value: Any) -> list[Any]:
        bodies = [value] if isinstance(value, Body | SimulatedBody) else list(value)
        for body in bodies:
            if not isinstance(body, Body | SimulatedBody):
                raise TypeError(f"must be bodies, not {body!r}")
        return bodies

    bodies, color = Field(_bodies), Field(colors)

    def _record(self) -> dict[str, Any] | None:
        if len(self.color) not in (1, len(self.bodies)):
            raise ValueError(
                f"color must be one, or one for each of the {len(self.bodies)} bodies, not {len(self.color)}"
            )
        there = [index for index, body in enumerate(self.bodies) if body.survivor is not None]
        slots = [self.bodies[index].survivor.slot for index in there]
        return {"bodies": slots, "colors": self.color if len(self.color) == 1 else self.color[there]}

    def _is_attached(self) -> bool:
        return True


class Viewpoint(Thing):
    """A named viewpoint that users go to by a key from 1 to 9 or the page's bar. position, target: places; on a body or
    frame the camera moves with it."""

    kind = "viewpoint"
    name, position, target = Field(text), Field(place), Field(place)

    def _record(self) -> dict[str, Any] | None:
        eye, target = anchor(self.position), anchor(self.target)
        return None if eye is None or target is None else {"name": self.name, "eye": eye, "target": target}


class Stage(Thing):
    """Surroundings instead of the page's own, which are light or dark as in the user's system. Colors: sky: overhead;
    horizon: to which ground and sky fade; ground: of the floor. light: factor for all lamps."""

    kind = "stage"
    sky, horizon, ground = Field(color), Field(color), Field(color)
    light = Field(number(0, 10))

    def __init__(self, things: Things, made: Iterable[Any] = (), **values: Any) -> None:
        """made: what belongs to it."""
        self._made = list(made)
        super().__init__(things, **values)

    def destroy(self) -> None:
        """Removes it, with all that was made for it; further calls do nothing."""
        for each in self._made:
            if each.alive:
                each.destroy()
        super().destroy()

    def _record(self) -> dict[str, Any] | None:
        return self._values


class Light(Thing):
    """A lamp besides the page's own. lamp: "point", "spot" or "sun". at, to: places; a spot and the sun shine from one
    to the other, a spot without `to` straight down, the sun without `to` on the origin. intensity: 1 is as bright at the
    distance `reach` (m; 0: half the diagonal of the scene) as the page's own lamp; the sun is so everywhere. angle: of a
    spot, from its axis to its edge, rad. shadow: things cast shadows in it, not for a point."""

    kind = "light"
    lamp: str
    shadow: bool
    at, color, angle = Field(place), Field(color), Field(number(0.01, 1.5))
    to = Field(lambda value: None if value is None else place(value))
    intensity, reach = Field(number(0, 1000)), Field(length)

    def __init__(self, things: Things, lamp: str, shadow: bool, **values: Any) -> None:
        if lamp not in LAMPS:
            raise ValueError(f"kind: must be one of {', '.join(LAMPS)}, not {lamp!r}")
        if shadow and lamp == "point":
            raise ValueError("shadow: a point casts none, as it would take six pictures of the scene; use a spot")
        others = [thing for thing in things if isinstance(thing, Light)]
        if len(others) >= MOST_LIGHTS:
            raise ValueError(f"a world has at most {MOST_LIGHTS} lights; destroy another one first")
        if shadow and sum(light.shadow for light in others) >= MOST_SHADOWS:
            raise ValueError(f"shadow: at most {MOST_SHADOWS} lights of a world cast shadows")
        self.lamp, self.shadow = lamp, bool(shadow)
        super().__init__(things, **values)

    def _record(self) -> dict[str, Any] | None:
        at = anchor(self.at)
        to = anchor(self.to) if self.to is not None or self.lamp == "sun" else at
        if at is None or to is None:
            return None
        return self._values | {"kind": LAMPS[self.lamp], "at": at, "to": to, "shadow": self.shadow}
