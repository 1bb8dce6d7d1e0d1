# SPDX-License-Identifier: Apache-2.0
"""How bodies are drawn, what is fixed beside them, and the first view."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import Any, Literal

from iota._core import Body, HalfSpace, Shape, System, Vec3
from iota.arguments import SHORT
from iota.frames import one_after_another, turn_from_x, turned
from iota.looks import Drawn, Look, Looks, by_style
from iota.simulator import SimulatedBody
from iota.world.ground import MATERIAL
from iota.world.parts import Part
from iota.world.things import Rotation, unit_quaternion, vector
from iota.world.visuals import TIES, Visuals, radius_of

GROUND = "ground"  # the name of its body
UP = HalfSpace((0, 1, 0))


@dataclass(frozen=True)
class Camera:
    """The first view: place of the camera and its target, m."""

    position: Sequence[float] = (2.5, 1.6, 3.5)
    target: Sequence[float] = (0.0, 1.2, 0.0)

    def __post_init__(self) -> None:
        for name in ("position", "target"):
            try:
                object.__setattr__(self, name, tuple(vector(getattr(self, name))))
            except (TypeError, ValueError) as error:
                raise type(error)(f"{name}: {error}") from None
        if self.position == self.target:
            raise ValueError(f"a camera needs a target elsewhere than its position, not {self.position} twice")


def camera_or_none(given: Any) -> Camera | None:
    """Raises TypeError for anything else."""
    if not (given is None or isinstance(given, Camera)):
        raise TypeError(f"camera must be a Camera, as in iota.Camera((3, 2, 3), (0, 1, 0)), not {SHORT.repr(given)}")
    return given


class Scene(Part):
    """How bodies are drawn, what stands fixed beside them, and the first view.

    world.scene.draw(wheel, looks.solid("brass"))
    """

    def __init__(
        self,
        system: System,
        visuals: Visuals | None = None,
        style: str | None = None,
        ground: float | None = None,
    ) -> None:
        self._system = system
        self._visuals = Visuals() if visuals is None else visuals
        self._style, self._height = style, ground
        self._ground: Body | None = None
        self._needs_material = False  # for what has none: the ground was made or sought since `keep_ground`
        self._camera: Camera | None = None
        self._shows_edits = True

    @property
    def camera(self) -> Camera | None:
        """The first view; None: everything is visible."""
        return self._camera

    @camera.setter
    def camera(self, camera: Camera | None) -> None:
        self._camera = camera_or_none(camera)
        self._visuals.version += 1

    @property
    def shows_edits(self) -> bool:
        """Whether joins and breaks show a ring of light, with a sound, by themselves. False where a script's mechanism makes
        them all the time, as that of the study ladder; `Drawings.effect` still shows what users should see."""
        return self._shows_edits

    @shows_edits.setter
    def shows_edits(self, shows: bool) -> None:
        self._shows_edits = shows

    @property
    def style(self) -> str | None:
        """The style that pages start with, as given to `World`; None: the first of `styles`."""
        return self._style

    @property
    def styles(self) -> list[str]:
        """The names of styles that looks are given for, in the order of their first use."""
        return self._visuals.styles

    @property
    def ground(self) -> float | None:
        """Height of the ground, m; None without one, and before the world begins if it was to be found."""
        body = self.ground_body
        return self._height if body is None else body.solids[0].position.y

    @property
    def ground_body(self) -> Body | None:
        """The obstacle that is the ground, a HalfSpace named "ground"; None without one, and for another Simulator. It is made
        when the world begins, or is asked for it if its height is given. One that the system has already is taken as it is."""
        self.find_ground()
        return self._ground

    def keep_ground(self, height: float | None = None) -> None:
        """Makes the ground, and gives what has no material the usual one, if there is none: the script may have restored a state of
        before it. height: m; None: the former."""
        self.find_ground(height)
        if not self._needs_material:  # as in nearly each step
            return
        self._needs_material = False
        system: object = self._system
        if isinstance(system, System):
            system.usual_material = system.usual_material or MATERIAL

    def find_ground(self, height: float | None = None) -> None:
        """Makes the ground, and no more: a question before the world begins does not let its bodies touch. height: m; None: the
        former."""
        system: object = self._system
        if not isinstance(system, System):
            self._height = self._height if height is None else height
            return
        if self._ground is not None and self._ground.alive and self._ground.name == GROUND:  # as in nearly each step
            return
        self._ground = next(filter(_is_ground, system.obstacles), None)
        if self._ground is None and height is not None:
            self._height = height
        if self._ground is None and self._height is not None:
            self._ground = self._fix("ground", UP, [], (0, self._height, 0))
            self._ground.name = GROUND
        if self._ground is not None:
            self._ground.material = self._ground.material or MATERIAL
        self._needs_material = True

    def draw(self, bodies: Body | Iterable[Body], look: Drawn) -> None:
        """Sets the looks of bodies: a look of `iota.looks`, several drawn together, or one for each style, between
        which users switch on the page. Every second body is odd, for looks with a turn. A round look gives its radius, the
        least of several, to bodies of particles as their `Body.radius`, so that they act as they are drawn; but a single
        particle keeps a radius of its own.

            world.draw(wheel, looks.solid("brass"))
            world.draw(links, {"rope": looks.capsule(0.012, "rope"), "chain": looks.chain_link(0.1)})
        """
        drawn = list(bodies) if isinstance(bodies, Iterable) else [bodies]
        for body in drawn:
            if not isinstance(body, Body | SimulatedBody):
                raise TypeError(f"draw: bodies must be a body or several, not {SHORT.repr(body)}")
        looks = by_style(look)
        self._visuals.assign(drawn, self._visuals.name_of(looks))
        radius = radius_of(looks)
        if radius is not None:
            for body in drawn:
                _give_radius(body, radius)

    def look_of(self, body: Body) -> Looks | None:
        """The looks that `draw` gave to a body, for each style; None without one. A body that another one absorbed keeps
        its own."""
        return self._visuals.looks_of(body)

    def draw_ties(self, kind: Literal["spring", "rope", "rod"], look: Drawn) -> None:
        """Sets the looks of springs, ropes or rods between bodies, as `draw`; an empty list hides them. A `looks.spring` is a coil, an
        ellipsoid reaches from end to end; of other shapes the radius counts."""
        if kind not in TIES:
            raise ValueError(f"kind must be one of {', '.join(TIES)}, not {kind!r}")
        self._visuals.assign_ties(kind, by_style(look))

    def add_static(self, look: Look, position: Sequence[float], rotation: Rotation = (0, 0, 0, 1)) -> Body:
        """Adds a static body with the shape of a look: a beam, a stand. Walks end at it, and `Queries` find it; nothing can be
        tied to it, see `System.obstacle`. position: m, and rotation, see `Drawings.shape`: of the frame in which the look has
        its own offset and rotation. For a room from a file see `Drawings.model`. Raises TypeError for a World of another
        Simulator, which has static bodies of its own."""
        if not isinstance(look, Look) or look.shape is None:
            raise TypeError(
                "add_static: look must be a Look with a shape, as in looks.box((1, 1, 1), 'wood'), not "
                f"{SHORT.repr(look)}; a shape alone is for system.obstacle(shape)"
            )
        turn = unit_quaternion(rotation)
        place = vector(position) + turned(turn, Vec3(*look.offset))
        own = replace(look, shape=None, offset=(0, 0, 0), rotation=(0, 0, 0, 1))
        return self._fix("add_static", look.shape, own, place, one_after_another(turn, look.rotation))

    def add_strut(self, start: Sequence[float], end: Sequence[float], look: Look) -> Body:
        """Adds a static body with the shape of a look from `start` to `end` (m): its local x runs along the line, and a cylinder or
        capsule without a length gets that of the line."""
        a, b = Vec3(*start), Vec3(*end)
        length = abs(b - a)
        if not length > 0:
            raise ValueError(f"a strut needs two different ends, not {a} twice")
        direction = (b - a) * (1 / length)
        return self.add_static(look.of_length(length), list((a + b) * 0.5), turn_from_x(direction))

    def _fix(
        self,
        caller: str,
        shape: Shape,
        look: Drawn,
        position: Sequence[float] | Vec3,
        rotation: Rotation = (0, 0, 0, 1),
    ) -> Body:
        """An obstacle that is drawn with a look. caller: for the error of a World of another Simulator."""
        if not isinstance(self._system, System):
            raise TypeError(
                f"{caller} needs a System; this world has a simulator of its own: give it a body of kind static"
            )
        body = self._system.obstacle(shape, position, unit_quaternion(rotation))
        self.draw(body, look)
        return body


def _is_ground(body: Body) -> bool:
    return body.alive and body.name == GROUND and any(isinstance(solid.shape, HalfSpace) for solid in body.solids)


def _give_radius(body: Body | SimulatedBody, radius: float) -> None:
    if not isinstance(body, Body) or not body.alive:
        return
    particles = body.particles
    if len(particles) == 1 and particles[0].has_attributes and particles[0].radius > 0:
        return
    with suppress(ValueError):  # it is given by shape
        body.radius = radius
