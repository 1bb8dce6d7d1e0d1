# SPDX-License-Identifier: Apache-2.0
"""Things that a script adds to the page besides bodies. Each thing is a handle: assigning one of its attributes updates
it."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar, Generic, NoReturn, TypeVar

import numpy as np

from iota import _core
from iota._core import Body, Bond, Particle, Room, Vec3
from iota._protocol import FIRST_FRAME, NO_BODY, NO_COLOR
from iota.arguments import SHORT, refuse_reading, refuse_unknown
from iota.colors import color_number
from iota.frames import into_frame
from iota.simulator import SimulatedBody, SimulatedParticle
from iota.textures import Texture
from iota.world.images import Images
from iota.world.records import encode

Value = TypeVar("Value")
FARTHEST = 1e9  # m
MOST_THINGS = 100_000  # of a world


class Field(Generic[Value]):
    """An attribute of a thing: `check` converts an assigned value, or raises ValueError or TypeError."""

    def __init__(self, check: Callable[[Any], Value]) -> None:
        self._check = check

    def __set_name__(self, owner: type[Thing], name: str) -> None:
        self._name = name

    # No @overload: its registry would keep this module, and with it the engine's types, alive at exit.
    def __get__(self, thing: Thing | None, owner: type[Thing]) -> Value:
        if thing is None:
            raise AttributeError(f"{self._name} is an attribute of each {owner.__name__}")
        return thing._values[self._name]  # type: ignore[no-any-return]

    def __set__(self, thing: Thing, value: Any) -> None:
        try:
            thing._values[self._name] = self._check(value)
        except (ValueError, TypeError) as error:
            raise type(error)(f"{self._name}: {error}") from None
        thing._changed()


class Thing:
    """One entity of a script. visible: pages show it. It disappears when it or the thing that it is on is destroyed."""

    kind: ClassVar[str]

    def __init__(self, things: Things, **values: Any) -> None:
        self._things: Things | None = None
        self._values: dict[str, Any] = {"visible": True}
        for name, value in values.items():
            setattr(self, name, value)
        self._things = things
        things.add(self)

    def __setattr__(self, name: str, value: Any) -> None:
        """A misspelled attribute would change nothing on the page."""
        if name not in type(self).__dict__.get("_assigned", ()):  # as scripts assign thousands a frame
            refuse_unknown(self, name)
        object.__setattr__(self, name, value)

    if not TYPE_CHECKING:  # checkers would take any name

        def __getattr__(self, name: str) -> NoReturn:
            refuse_reading(self, name)

    visible = Field(lambda value: flag(value))

    def __repr__(self) -> str:
        own = {name: value for name, value in self._values.items() if name != "visible"} if self.alive else {}
        told = [f" {name}={text}" for name, value in own.items() if (text := _in_short(name, value))]
        return f"<{type(self).__name__}{''.join(told)}>" if self.alive else f"<{type(self).__name__}: destroyed>"

    @property
    def alive(self) -> bool:
        """False once it was destroyed."""
        return self._things is not None

    def destroy(self) -> None:
        """Removes it from the page; further calls do nothing."""
        if self._things is not None:
            self._things.remove(self)
            self._things = None

    def _changed(self) -> None:
        if self._things is not None:
            self._things.mark(self)

    def _record(self) -> dict[str, Any] | None:
        """Its fields with the names of the protocol; None if it is on something that no longer exists."""
        raise NotImplementedError

    def _texture(self) -> Texture | None:
        """The image that its record names."""
        return None

    def _is_attached(self) -> bool:
        """Whether it is on something of the system, so that an edit may move it to another body."""
        return any(isinstance(value, Attachable) for value in self._values.values())


def _in_short(name: str, value: Any) -> str:
    """Nothing for None, empty texts and functions."""
    if name == "color" and np.size(value) == 1:
        number = int(np.ravel(value)[0])
        return "" if number == NO_COLOR else f"#{number & 0xFFFFFF:06x}"
    if isinstance(value, np.ndarray):
        return f"array of shape {value.shape}" if value.size != 1 else f"{value.item():g}"
    return "" if value is None or value == "" or callable(value) else SHORT.repr(value)


class Frame(Thing):
    """A frame for other things, like a body: they move, hide and end with it. at: its origin, on a body, on another
    frame or in the world. rotation: as of `Drawings.shape`. Things on it have places in its frame; `frame.point((x, y, z))`
    is a place in it for ends of lines and arrows."""

    kind = "frame"

    def _place(self, value: Any) -> Place:
        inner = value
        while isinstance(inner, Frame | FramePoint):
            inner = inner.frame if isinstance(inner, FramePoint) else inner
            if inner is self:
                raise ValueError("a frame cannot be on itself")
            inner = inner.at
        return place(value)

    @property
    def at(self) -> Place:
        return self._values.get("at")

    @at.setter
    def at(self, value: Place) -> None:
        self._values["at"] = self._place(value)
        self._changed()

    rotation = Field(lambda value: unit_quaternion(value))

    def point(self, position: Sequence[float]) -> FramePoint:
        """A place in it, m, for things."""
        return FramePoint(self, vector(position))

    def _record(self) -> dict[str, Any] | None:
        at = anchor(self.at)
        return None if at is None else {"at": at, "rotation": self.rotation}


@dataclass(frozen=True)
class FramePoint:
    """A place in a frame."""

    frame: Frame
    position: Vec3  #: m


Attachable = Particle | Body | Bond | SimulatedBody | SimulatedParticle | Frame | FramePoint
Rotation = Sequence[float] | tuple[str | Vec3 | Sequence[float], float]  # see `unit_quaternion`
Place = Attachable | Vec3 | Sequence[float] | None


class Things:
    """All things of a world. Only those that differ from the last sent state are sent to pages."""

    def __init__(self) -> None:
        self.images = Images()
        self._ids: dict[Thing, tuple[int, int]] = {}
        self._free: dict[str, list[tuple[int, int]]] = {}
        self._counts: dict[str, int] = {}
        self._dirty: dict[Thing, None] = {}
        self._gone: list[tuple[str, int, int]] = []
        self._told: dict[Thing, bytes] = {}
        self._structure = -1
        self._frames: dict[Frame, None] = {}
        self._frames_changed = False
        self._frames_told: set[Frame] = set()  # those that were there
        self.changes: Counter[str] = Counter()  # of each kind: rises when one comes, changes or goes
        self.effect: Callable[[str, Vec3, float], object] | None = None  # while the world is served

    def __iter__(self) -> Iterator[Thing]:
        return iter(self._ids)

    def add(self, thing: Thing) -> None:
        """Raises ValueError for more than pages can draw."""
        if len(self._ids) >= MOST_THINGS:
            raise ValueError(
                f"a world has at most {MOST_THINGS} things of its script; draw many by one array: world.points, world.drawings.shapes"
            )
        free = self._free.get(thing.kind)
        if free:
            slot, generation = free.pop()
        else:
            slot, generation = self._counts.get(thing.kind, 0), 0
            self._counts[thing.kind] = slot + 1
        self._ids[thing] = (slot, generation + 1)
        if isinstance(thing, Frame):
            self._frames[thing] = None
        self.mark(thing)

    def remove(self, thing: Thing) -> None:
        self.changes[thing.kind] += 1
        slot, generation = self._ids.pop(thing)
        self._dirty.pop(thing, None)
        self.images.use(thing, None)
        if self._told.pop(thing, None) is not None:
            self._gone.append((thing.kind, slot, generation))
        self._free.setdefault(thing.kind, []).append((slot, generation))
        if isinstance(thing, Frame):
            del self._frames[thing]
            self._frames_changed = True

    def slot_of(self, thing: Thing) -> int:
        """Its number on pages."""
        return self._ids[thing][0]

    def mark(self, thing: Thing) -> None:
        """Marks it to be sent again."""
        self.changes[thing.kind] += 1
        self._dirty[thing] = None
        self._frames_changed |= isinstance(thing, Frame)

    def mark_attached(self) -> None:
        """Marks things on bodies and frames to be sent again, as edits may have moved or removed them."""
        self._dirty |= dict.fromkeys(thing for thing in self._ids if thing._is_attached())

    def find(self, kind: str, id: tuple[int, int]) -> Thing | None:
        """Finds a thing by its number on pages."""
        return next((thing for thing, known in self._ids.items() if known == id and thing.kind == kind), None)

    def play(self, kind: str, at: Vec3, volume: float) -> None:
        """An effect on all pages, see `Drawings.effect`."""
        if self.effect is not None:
            self.effect(kind, at, volume)

    def tell_anew(self) -> None:
        """Forgets what was sent: the next room is empty."""
        self.images.tell_anew()
        self._told.clear()
        self._gone.clear()
        self._dirty = dict.fromkeys(self._ids)

    @property
    def has_news(self) -> bool:
        """Whether things have changed since pages were told."""
        return bool(self._dirty or self._gone)

    def tell(self, room: Room, structure: int, warn: Callable[[str], None]) -> None:
        """Sends the changes. structure: rises when bodies change, which may move things. warn: called with a text for
        an inconsistent thing, which keeps its former look."""
        if structure != self._structure:
            self._structure = structure
            self._frames_changed = True
            self.mark_attached()
        if self._frames_changed:
            # Pages move things with their frames: these are sent again only if a frame has come, gone, or is hidden.
            self._frames_changed = False
            there = {frame for frame in self._frames if _on_frame(frame, Vec3()) is not None}
            if there != self._frames_told:
                self._frames_told = there
                self.mark_attached()
        for kind, slot, generation in self._gone:
            room.destroy_entity(kind, slot, generation)
        self._gone.clear()
        dirty, self._dirty = self._dirty, {}
        for thing in dirty:
            try:
                self._tell(room, thing)
            except Exception as error:  # also of a value that the protocol's types cannot hold
                warn(f"{type(thing).__name__}: {error}")
        self.images.tell(room)

    def _tell(self, room: Room, thing: Thing) -> None:
        record = thing._record() if thing.visible else None
        slot, generation = self._ids[thing]
        if record is None:
            if self._told.pop(thing, None) is not None:
                room.destroy_entity(thing.kind, slot, generation)
                self._ids[thing] = (slot, generation + 1)
            return
        fields = encode(thing.kind, record)
        self.images.use(thing, thing._texture())
        if self._told.get(thing) != fields:
            room.set_entity(thing.kind, slot, generation, fields)
            self._told[thing] = fields


# --- checks of fields -------------------------------------------------------------------------------------------------


def number(least: float = -math.inf, most: float = math.inf) -> Callable[[Any], float]:
    def check(value: Any) -> float:
        try:
            found = float(value)
        except (TypeError, ValueError, OverflowError):
            found = None
        if found is None or isinstance(value, str | bytes):
            raise TypeError(f"must be a number, not {SHORT.repr(value)}")
        if not (math.isfinite(found) and least <= found <= most):
            bounds = f" from {least:g} to {most:g}" if math.isfinite(least) or math.isfinite(most) else ""
            raise ValueError(f"must be a finite number{bounds}, not {value}")
        return found

    return check


length = number(0, FARTHEST)


def text(value: Any) -> str:
    if callable(value) and not isinstance(value, type):
        raise TypeError(f"must be a text, not the function {getattr(value, '__name__', value)}")
    return str(value)


def flag(value: Any) -> bool:
    if not isinstance(value, bool | np.bool_ | int):
        raise TypeError(f"must be True or False, not {SHORT.repr(value)}")
    return bool(value)


def numbers(value: Any) -> np.ndarray[Any, np.dtype[np.float64]]:
    """An array of them, copied."""
    try:
        return np.array(value, np.float64)
    except (TypeError, ValueError):
        raise TypeError(f"must be numbers, all rows of one length, not {SHORT.repr(value)}") from None


def vector(value: Any) -> Vec3:
    """World, m, or a direction."""
    try:
        parts = tuple(value)
        found = Vec3(*parts)
    except TypeError:
        parts = ()
    if len(parts) not in (2, 3):
        raise TypeError(f"must be 2 or 3 numbers, not {SHORT.repr(value)}")
    if not all(math.isfinite(x) and abs(x) <= FARTHEST for x in (found.x, found.y, found.z)):
        raise ValueError(f"must be finite and within {FARTHEST:g} m, not {found}")
    return found


def place(value: Any) -> Place:
    """A particle, body or bond, or a place in the world (m)."""
    if isinstance(value, Attachable):
        return value
    try:
        return vector((0, 0, 0) if value is None else value)
    except TypeError:
        what = "a particle, a body, a bond, a frame, or 2 or 3 numbers"
        raise TypeError(f"must be {what}, not {SHORT.repr(value)}") from None


def place_of(value: Any) -> Vec3:
    """The present place of a particle, of the center of mass of a body, or of a place, m."""
    found = getattr(value, "position", getattr(value, "center_of_mass", value))
    if isinstance(value, Frame | FramePoint | Bond) or isinstance(found, str):
        raise TypeError(f"must be a particle, a body or a place, not {type(value).__name__}")
    return vector(found)


def color(value: Any) -> int:
    """As sent to pages. value: see `iota.colors.rgba`; None: the page's own."""
    return NO_COLOR if value is None or (isinstance(value, int) and value == NO_COLOR) else color_number(value)


def unit_quaternion(value: Any) -> tuple[float, ...]:
    """x y z w, normalized, of these or of an axis and degrees, as in ("z", 30)."""
    return tuple(_core.unit_quaternion(value))


def points(value: Any) -> np.ndarray[Any, np.dtype[np.float64]]:
    """Shape (n, 2) or (n, 3), m."""
    rows = numbers(value)
    if rows.size == 0:
        rows = rows.reshape(0, 3)
    if rows.ndim != 2 or rows.shape[1] not in (2, 3):
        raise ValueError(f"must have the shape (n, 2) or (n, 3), not {rows.shape}")
    if not (np.abs(rows) <= FARTHEST).all():
        raise ValueError(f"must be finite and within {FARTHEST:g} m")
    return rows if rows.shape[1] == 3 else np.column_stack([rows, np.zeros(len(rows))])


# --- places of things
# ---------------------------------------------------------------------------------------------------


def anchor(at: Place) -> dict[str, Any] | None:
    """A place as sent to pages, at its present body; None if that no longer exists. For a bond its first end."""
    if isinstance(at, Bond):
        return anchor(at.ends[0]) if at.alive else None
    if isinstance(at, Body):
        return None if at.survivor is None else {"body": at.survivor.slot, "point": (0, 0, 0)}
    if isinstance(at, Particle):
        now = at.survivor
        return None if now is None else _on_body(now.body, now.position)
    if isinstance(at, Frame):
        return _on_frame(at, Vec3())
    if isinstance(at, FramePoint):
        return _on_frame(at.frame, at.position)
    if isinstance(at, SimulatedBody):
        return None if at.survivor is None else {"body": at.slot, "point": (0, 0, 0)}
    if isinstance(at, SimulatedParticle):
        return None if at.body.survivor is None else _on_body(at.body, at.position)
    return {"body": NO_BODY, "point": Vec3(*(at or (0, 0, 0)))}


def ends(at: Place, to: Place = None) -> tuple[dict[str, Any] | None, dict[str, Any] | None]:
    """Both ends of a bond; otherwise from one place to another, or twice the same."""
    if isinstance(at, Bond) and to is None:
        return (anchor(at.ends[0]), anchor(at.ends[1])) if at.alive else (None, None)
    first = anchor(at)
    return first, (first if to is None else anchor(to))


def _on_frame(frame: Frame, position: Vec3) -> dict[str, Any] | None:
    if frame._things is None or not frame.visible or anchor(frame.at) is None:
        return None
    return {"body": FIRST_FRAME + frame._things.slot_of(frame), "point": position}


def _on_body(body: Any, position: Any) -> dict[str, Any]:
    orientation = [float(v) for v in body.orientation]
    return {"body": body.slot, "point": into_frame(Vec3(*position), body.center_of_mass, orientation)}
