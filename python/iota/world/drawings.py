# SPDX-License-Identifier: Apache-2.0
"""Things without physics in a World. Each call returns a handle; assigning an attribute updates the page."""

from __future__ import annotations

import warnings
from collections.abc import Iterable, Mapping, Sequence
from itertools import pairwise
from typing import Any, Literal

import numpy as np

from iota._core import Mesh, Vec3
from iota.arguments import SHORT, is_number
from iota.colors import ColorLike
from iota.looks import Look, material_of
from iota.simulator import SimulatedBody
from iota.sounds import sound_file
from iota.textures import texture_of
from iota.world.custom import Custom, Sound, checked_volume
from iota.world.many import Arrows, Segments
from iota.world.notices import Notices
from iota.world.parts import Part
from iota.world.scene import Scene
from iota.world.shown import (
    Arrow,
    Axes,
    Label,
    Light,
    Line,
    Marker,
    Paint,
    Points,
    Shapes,
    Stage,
    Strut,
    Surface,
    Trace,
    Tube,
    Viewpoint,
)
from iota.world.skins import Skin
from iota.world.stages import STAGES
from iota.world.things import Attachable, Frame, Place, Rotation, Thing, Things, place, vector

EFFECTS = ("break", "join", "grab", "impact")

Color = ColorLike | None  # None: that of the page or the material


def _listed(points: tuple[Any, ...]) -> Any:
    """An array or a list that is given alone, else the places."""
    if len(points) != 1 or isinstance(points[0], Attachable):
        return points
    (only,) = points
    is_place = isinstance(only, Vec3) or (isinstance(only, Sequence) and len(only) > 0 and all(map(is_number, only)))
    return points if is_place else only


def _triangles_of(surface: Any) -> tuple[Any, Any]:
    """Vertices and triangles of an object with vertices and faces."""
    if not hasattr(surface, "vertices") or not hasattr(surface, "faces"):
        raise TypeError(
            "a surface needs triangles besides its points, or vertices and faces, as from iota.shapelib.read_surface"
        )
    return surface.vertices, [(face[0], b, c) for face in surface.faces for b, c in pairwise(face[1:])]


def _joined(parts: Sequence[tuple[Any, Any]]) -> Mesh:
    """One mesh of surfaces, without triangles that are only a line."""
    if not parts:
        raise ValueError("a model without surfaces cannot be solid")
    starts = np.cumsum([0, *(len(points) for points, _ in parts)])
    rows = np.concatenate([np.reshape(own, (-1, 3)) + start for (_, own), start in zip(parts, starts, strict=False)])
    a, b, c = rows.T
    return Mesh(np.concatenate([points for points, _ in parts]), rows[(a != b) & (b != c) & (c != a)], closed=False)


def _in_world(at: Place) -> Vec3:
    found = place(at)
    if not isinstance(found, Vec3):
        raise ValueError(f"a solid model stands at a place of the world, not on {SHORT.repr(at)}")
    return found


class Drawings(Part):
    """Labels, lines, tubes, arrows, axes, traces, points, shapes, struts, surfaces, skins, lights, colors of bodies, frames,
    objects of own classes, sounds.

    A place is a particle, a body, a bond, a frame or a point of the world (m). A thing on one of these moves with it,
    without cost, stays on it when bodies are cut and joined, and ends with it. `handle.destroy()` removes a thing from
    the page, `handle.visible` hides it. Reset does not change them.

        label = world.label("top", at=ball)
        label.text = "still the top"
    """

    def __init__(self, things: Things, notices: Notices, scene: Scene) -> None:
        self._things, self._notices, self._scene = things, notices, scene

    @property
    def things(self) -> list[Thing]:
        """All things made by the functions below, and all controls, in the order of creation."""
        return list(self._things)

    def label(
        self,
        text: object,
        at: Place = None,
        offset: Sequence[float] = (0, 0, 0),
        height: float = 0.0,
        color: Color = None,
    ) -> Label:
        """Text at a place (for a bond its middle); "\\n" begins a new line. offset: world, m. height: of a capital, m; 0: a
        constant size on the screen."""
        return Label(self._things, text=text, at=at, offset=offset, height=height, color=color)

    def line(self, *points: Any, radius: float = 0.0, color: Color = None, closed: bool = False) -> Line:
        """A line through particles, bodies and places, or through an array of shape (n, 3). radius: m; 0: a few pixels."""
        return Line(self._things, points=_listed(points), radius=radius, color=color, closed=closed)

    def arrow(
        self,
        at: Place,
        to: Place = None,
        vector: Sequence[float] = (0, 0, 0),
        radius: float = 0.0,
        color: Color = None,
    ) -> Arrow:
        """An arrow from `at` to `to`, or along `vector` (world, m). radius: of its shaft, m; 0: by its length."""
        return Arrow(self._things, at=at, to=to, vector=vector, radius=radius, color=color)

    def arrows(self, starts: Any, vectors: Any, radius: float = 0.0, color: Any = None, at: Place = None) -> Arrows:
        """Many arrows. starts, vectors: arrays of shape (n, 3), m, in the frame of `at`. radius: of their shafts, m; 0: each by
        its length. color: one, an array of shape (n, 3) from 0 to 1, or a list of n colors. Assigning an array changes
        all of them.

        wind = world.drawings.arrows(places, 0.1 * velocities)
        wind.vectors = 0.2 * velocities
        """
        return Arrows(self._things, starts=starts, vectors=vectors, radius=radius, color=color, at=at)

    def segments(self, starts: Any, ends: Any, radius: float, color: Any = None, at: Place = None) -> Segments:
        """Many straight lines. starts, ends: arrays of shape (n, 3), m, in the frame of `at`. radius: m. color: as of
        `arrows`. Assigning an array changes all of them."""
        return Segments(self._things, starts=starts, ends=ends, radius=radius, color=color, at=at)

    def axes(self, at: Place = None, length: float = 0.2, rotation: Rotation = (0, 0, 0, 1)) -> Axes:
        """x, y and z of a body or of the world as red, green and blue arrows. length: m. rotation: see `Drawings.shape`."""
        return Axes(self._things, at=at, length=length, rotation=rotation)

    def trace(
        self, at: Place, seconds: float = 0.0, radius: float = 0.0, color: Color = None, capacity: int = 2000
    ) -> Trace:
        """The past path of a particle or body, as recorded by each page. seconds: of simulated time, 0: the newest
        `capacity` points."""
        return Trace(self._things, at=at, seconds=seconds, radius=radius, color=color, capacity=capacity)

    def points(self, points: Any, radius: Any = 0.02, color: Any = None, at: Place = None) -> Points:
        """Many balls. points: array of shape (n, 3), m, in the frame of `at`. radius: m, one or n. color: one, an array of shape
        (n, 3) from 0 to 1, or a list of n colors. Assigning an array moves all of them."""
        return Points(self._things, points=points, radius=radius, color=color, at=at)

    def shape(
        self,
        look: Look,
        position: Sequence[float] = (0, 0, 0),
        rotation: Rotation = (0, 0, 0, 1),
        on: Attachable | SimulatedBody | None = None,
        color: Color = None,
    ) -> Marker:
        """A look of `iota.looks` without physics, on a body or in the world. position: m, in the frame of the body or world.
        rotation: in that frame, an axis and an angle in degrees, as in ("z", 30) or ((1, 1, 0), 30), or a quaternion x y z w."""
        return Marker(
            self._things,
            look=look,
            position=position,
            rotation=rotation,
            on=on,
            color=color,
        )

    def shapes(
        self,
        look: Look,
        positions: Any,
        rotations: Any = None,
        sizes: Any = None,
        color: Any = None,
        at: Place = None,
    ) -> Shapes:
        """Thousands of copies of a look. positions: (n, 3), m, in the frame of `at`. rotations: (n, 4), quaternions x y
        z w. sizes: factors of the look's size, one, (n,) or (n, 3) along its axes. color: one, a list of n or an array
        (n, 3) from 0 to 1. Assigning an array changes all of them.

        bricks = world.drawings.shapes(looks.box((0.2, 0.1, 0.1)), places)
        bricks.positions = places + (0, 1, 0)
        """
        return Shapes(
            self._things, look=look, positions=positions, rotations=rotations, sizes=sizes, color=color, at=at
        )

    def strut(self, at: Place, to: Place, look: Look, color: Color = None) -> Strut:
        """A look from one place to another: its x axis runs along the line, and it is stretched to its length.

        world.drawings.strut(piston, crank, looks.cylinder(0.02, "steel"))
        """
        return Strut(self._things, at=at, to=to, look=look, color=color)

    def tube(
        self, *points: Any, radius: float, material: str = "rope", color: Color = None, closed: bool = False
    ) -> Tube:
        """A round tube along a smooth curve through particles, bodies and places, or through an array of shape (n, 3)."""
        return Tube(
            self._things,
            points=_listed(points),
            radius=radius,
            material=material_of(material),
            color=color,
            closed=closed,
        )

    def surface(
        self,
        points: Any,
        triangles: Any = None,
        at: Place = None,
        color: Color = None,
        material: str = "paint",
        threads: Sequence[Any] = (),
        texture: Any = None,
        repeat: float | Sequence[float] = 1.0,
        coordinates: Any = None,
    ) -> Surface:
        """Triangles, visible from both sides. points: an array (n, 3) in the frame of `at`, m; or particles, bodies and
        places, with which it bends; or a result of `iota.shapelib.read_surface` (then without triangles). triangles:
        (k, 3) indices of points. threads: springs or ropes; the triangles along a thread are removed with it. texture:
        a PNG or JPEG file or an array, laid once over the points, or as `coordinates` say, (n, 2) from the lower left
        corner (0, 0) to (1, 1). repeat: how often it is beside itself, one number or one for each direction.

        world.surface(iota.shapelib.read_surface("teapot.obj"), at=body, color="#4c9a52")
        world.surface(knots, triangles, threads=springs, color="#b0303a")
        world.surface(knots, triangles, texture="flag.png")
        """
        if triangles is None:
            points, triangles = _triangles_of(points)
        return Surface(
            self._things,
            points=points,
            triangles=triangles,
            at=at,
            color=color,
            material=material_of(material),
            threads=threads,
            texture=None if texture is None else texture_of(texture, repeat),
            coordinates=coordinates,
        )

    def model(self, surfaces: Iterable[Any], at: Place = None, solid: bool = False) -> list[Surface]:
        """Draws the result of `iota.shapelib.read_model`: each surface in the color of its material, as metal if it is, with its
        image if it has one. at: origin and frame of all. solid: it stands at a place of the world as a static body, at which
        walks end and that `Queries` find; its surfaces are on this body. Warns of what was left out when the file was read.

        world.drawings.model(iota.shapelib.read_model("chair.glb"), at=body)
        world.drawings.model(iota.shapelib.read_model("room.glb"), at=(0, 0, 0), solid=True)
        """
        surfaces = list(surfaces)
        for surface in surfaces:
            if not hasattr(surface, "notes"):
                raise TypeError(f"a model is a result of iota.shapelib.read_model, not of {SHORT.repr(surface)}")
            for note in surface.notes:
                warnings.warn(note, stacklevel=2)
                self._notices.warn_once(note)
        parts = [(np.asarray(points), triangles) for points, triangles in map(_triangles_of, surfaces)]
        if solid:
            at = self._scene._fix("model", _joined(parts), [], _in_world(at))
        shown = []
        for surface, (points, triangles) in zip(surfaces, parts, strict=True):
            image = {"texture": surface.texture, "coordinates": surface.coordinates}
            shown.append(self.surface(points, triangles, at, surface.color, surface.material, **image))
        return shown

    def skin(
        self,
        particles: Any,
        radius: float,
        cell: float | None = None,
        color: Color = None,
        material: str = "paint",
    ) -> Skin:
        """A smooth closed surface around particles or bodies, or around the places (n, 3) that a function returns: it moves,
        splits and merges with them. radius: around a single one, m. cell: of its grid of samples, m; None: a third of
        the radius; a smaller one is smoother and slower. Raises ValueError where the grid would be too large.

        world.drawings.skin(block.points, 0.1, color="#4c9a52cc")
        """
        return Skin(self._things, particles=particles, radius=radius, cell=cell, color=color, material=material)

    def paint(self, bodies: Any, color: Any) -> Paint:
        """Colors of bodies, instead of those of their materials. color: one, one for each body, or an array (n, 3) from
        0 to 1.

        world.drawings.paint(links, "#e8452c")
        """
        return Paint(self._things, bodies=bodies, color=color)

    def frame(self, at: Place = None, rotation: Rotation = (0, 0, 0, 1)) -> Frame:
        """A frame for other things, like a body: they move, hide and end with it. rotation: see `Drawings.shape`.

        hand = world.drawings.frame((0, 1, 0))
        world.drawings.shape(looks.sphere(0.1), on=hand, position=(0.2, 0, 0))
        hand.at = (0, 2, 0)
        """
        return Frame(self._things, at=at, rotation=rotation)

    def viewpoint(self, name: str, position: Place, target: Place) -> Viewpoint:
        """A viewpoint that users go to by a key, 1 for the first, or the page's bar. On a particle, body or frame the
        camera moves with it.

        world.drawings.viewpoint("from above", (0, 8, 0.1), (0, 0, 0))
        world.drawings.viewpoint("driver", car.attachment((0, 1.2, 0)), car.attachment((3, 1, 0)))
        """
        return Viewpoint(self._things, name=name, position=position, target=target)

    def stage(
        self,
        place: Literal["room", "studio", "space"] | None = None,
        sky: Color = None,
        horizon: Color = None,
        ground: Color = None,
        light: float | None = None,
    ) -> Stage:
        """Surroundings instead of the page's own: a place, or colors of the sky overhead, the horizon and the ground, and a factor
        for the light of all lamps, which also change those of a place. None: as the place or the page has it. place: "room": 9 x 7 m
        around the origin with walls that hold things, open to +z; "studio": a backdrop, with two lamps on what is there already;
        "space": stars around what is there already, best with `World(..., ground=None)`. `destroy()` removes all of it.

        world.stage("room")
        world.stage(sky="#05070d", horizon="#141b29", ground="#2a2d33", light=0.5)  # a night
        """
        if place is not None and place not in STAGES:
            raise ValueError(f"place must be one of {', '.join(map(repr, STAGES))}, not {SHORT.repr(place)}")
        given = {"sky": sky, "horizon": horizon, "ground": ground, "light": light}
        colors, made = STAGES[place](self, self._scene) if place is not None else ({}, [])
        values = {"light": 1.0} | colors | {name: value for name, value in given.items() if value is not None}
        try:
            return Stage(self._things, made, **{"sky": None, "horizon": None, "ground": None} | values)
        except BaseException:
            for each in made:
                each.destroy()
            raise

    def light(
        self,
        kind: Literal["point", "spot", "sun"] = "point",
        at: Place = (0, 1, 0),
        to: Place = None,
        color: Color = None,
        intensity: float = 1.0,
        reach: float = 0.0,
        angle: float = 0.5,
        shadow: bool = False,
    ) -> Light:
        """A lamp besides the page's own, at a place or on what moves. A spot and the sun shine from `at` to `to`; without
        `to` a spot shines straight down, the sun on the origin. intensity: 1 is as bright at the distance `reach` (m; 0:
        half the diagonal of the scene) as the page's own lamp; the sun is so everywhere. angle: of a spot, from its axis
        to its edge, rad. shadow: of a spot or the sun. Raises ValueError for a ninth light, and a third with shadows.

        world.drawings.stage(sky="#05070d", horizon="#141b29", ground="#2a2d33", light=0.1)
        world.drawings.light("spot", at=(0, 3, 0), color="#ffd9a0", reach=3, shadow=True)
        world.drawings.light("point", at=firefly, color="#b8ff60", reach=0.3)
        """
        return Light(
            self._things,
            kind,
            shadow,
            at=at,
            to=to,
            color=color,
            intensity=intensity,
            reach=reach,
            angle=angle,
        )

    def custom(
        self,
        class_name: str,
        at: Place = None,
        rotation: Rotation = (0, 0, 0, 1),
        values: Mapping[str, Any] | None = None,
    ) -> Custom:
        """An object of a class of your own: a module of `Pages.client_module` defines how it is drawn, its bounds, what a ray or a
        hand meets, and what happens when it is selected; see web/README.md. On a body it stands for it: a hit holds
        and selects the body. Recordings carry no code and show none of these. rotation: see `Drawings.shape`. values: the
        object's data.

        world.pages.client_module("flower.js")  # has iota.define("flower", {...})
        flower = world.drawings.custom("flower", at=stem, values={"petals": 7})
        flower.values = {"petals": 8}
        """
        return Custom(self._things, class_name=class_name, at=at, rotation=rotation, values=values or {})

    def sound(self, source: Any, rate: float = 44_100, reach: float = 0.0) -> Sound:
        """A sound of your own: a WAV, MP3, Ogg or FLAC file of at most 1 MiB and a minute, or an array of samples from -1 to 1,
        (n,) or (n, 2), `rate` of them a second. reach: distance up to which it is not fainter, m; 0: half the diagonal of
        the scene. Raises ValueError for a file that cannot be used.

        bell = world.drawings.sound("bell.ogg")
        world.on_stop(gong)(lambda event: bell.play(event.stop.position, volume=0.5))
        """
        return Sound(self._things, sound_file(source, rate), reach=reach)

    def effect(
        self, kind: Literal["break", "join", "grab", "impact"], position: Sequence[float], volume: float = 1.0
    ) -> None:
        """The sound and the pulse in users' hands of a break, a join, a grab or an impact at a place (m), on all pages; with a
        ring of light, but for an impact. volume: from 0 to 10. For sounds of your own see `sound`.

            world.on_stop(door_hinge)(lambda event: world.drawings.effect("impact", event.stop.position))
        """
        if kind not in EFFECTS:
            raise ValueError(f"kind must be one of {', '.join(map(repr, EFFECTS))}, not {kind!r}")
        self._things.play(kind, vector(position), checked_volume(volume))
