# SPDX-License-Identifier: Apache-2.0
"""Things that are only drawn: labels, lines, arrows, axes, traces, points, shapes. Each is one kind of the protocol."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from iota._protocol import NO_BODY, NO_COLOR
from iota.looks import Look
from iota.world.things import (
    Attachable,
    Field,
    Thing,
    anchor,
    color,
    ends,
    length,
    number,
    place,
    points,
    text,
    vector,
)

MOST_TRACE = 16384


class Label(Thing):
    """A line of text. at: particle, body, bond (its middle) or a place. offset: world, m. height: of a capital, m; 0: the same
    on the screen wherever it is."""

    kind = "label"
    at, offset, text, height, color = Field(place), Field(vector), Field(text), Field(length), Field(color)

    def _record(self) -> dict[str, Any] | None:
        a, b = ends(self.at)
        return None if a is None or b is None else self._values | {"a": a, "b": b}


class Line(Thing):
    """Straight pieces through points: each a particle, body or place. radius: m; 0: a few pixels. closed: back to the first."""

    kind = "line"
    radius, color, closed = Field(length), Field(color), Field(bool)

    @staticmethod
    def _points(value: Any) -> Any:
        if isinstance(value, np.ndarray) or not any(isinstance(at, Attachable) for at in value):
            return points(value)
        return [place(at) for at in value]

    points = Field(_points)

    def _record(self) -> dict[str, Any] | None:
        if isinstance(self.points, np.ndarray):
            return self._values | {"bodies": ()}
        anchors = [anchor(at) for at in self.points]
        if None in anchors:
            return None
        rows = [tuple(a["point"]) for a in anchors if a is not None]
        return self._values | {"bodies": [a["body"] for a in anchors if a is not None], "points": rows}

    def _is_attached(self) -> bool:
        return not isinstance(self.points, np.ndarray)


class Arrow(Thing):
    """From `at` to `to`, or along `vector` (world, m) where there is no `to`. radius: of the shaft, m; 0: by its length."""

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
    rotation = Field(lambda value: tuple(float(x) for x in value))

    def _record(self) -> dict[str, Any] | None:
        at = anchor(self.at)
        return None if at is None else self._values | {"at": at}


class Trace(Thing):
    """The path of a point, as each page has seen it; it begins anew when the world goes back in time. seconds: of simulated
    time, 0: as many points as it may have."""

    kind = "trace"
    at, seconds, radius, color = Field(place), Field(number(0, 1e6)), Field(length), Field(color)
    capacity = Field(lambda value: int(number(2, MOST_TRACE)(value)))

    def _record(self) -> dict[str, Any] | None:
        at = anchor(self.at)
        return None if at is None else self._values | {"at": at}


class Points(Thing):
    """Many balls, set by one array. points: shape (n, 3), m, in the frame of `at`. radius: m, one or n. color: one, or n of
    them: an array of shape (n, 3) from 0 to 1, or a list of n colors."""

    kind = "point_cloud"
    at, points = Field(place), Field(points)

    @staticmethod
    def _radii(value: Any) -> NDArray[np.float32]:
        radii = np.atleast_1d(np.array(value, np.float32))
        if radii.ndim != 1 or not (radii >= 0).all() or not np.isfinite(radii).all():
            raise ValueError("must be one radius, or one for each point, of 0 m or more")
        return radii

    @staticmethod
    def _colors(value: Any) -> NDArray[np.uint32]:
        if isinstance(value, np.ndarray) and value.ndim == 2:
            parts = np.round(255 * np.clip(value.astype(float), 0, 1)).astype(np.uint32)
            return np.asarray(parts[:, 0] << 16 | parts[:, 1] << 8 | parts[:, 2], np.uint32)
        is_one = value is None or isinstance(value, str | int) or (len(value) == 3 and isinstance(value[0], float))
        return np.array([color(each) for each in ([value] if is_one else value)], np.uint32)

    radius, color = Field(_radii), Field(_colors)

    def _record(self) -> dict[str, Any] | None:
        at = anchor(self.at)
        if at is None:
            return None
        for name, values in (("radius", self.radius), ("color", self.color)):
            if len(values) not in (1, len(self.points)):
                raise ValueError(f"{name} must be one, or one for each of the {len(self.points)} points")
        return self._values | {"at": at, "radii": self.radius, "colors": self.color}


class Marker(Thing):
    """A look on a body, or in the world. position: of its origin, in the frame of the body or the world, m. rotation:
    quaternion x y z w. color: in place of the look's."""

    kind = "marker"
    position, color = Field(vector), Field(color)
    rotation = Field(lambda value: tuple(float(x) for x in value))

    @staticmethod
    def _look(value: Any) -> Look:
        if not isinstance(value, Look) or value.shape is None:
            raise TypeError(f"must be a Look with a shape, not {value!r}")
        return value

    @staticmethod
    def _on(value: Any) -> Any:
        if value is not None and not isinstance(value, Attachable):
            raise TypeError(f"must be a body, a particle or None, not {type(value).__name__}")
        return value

    look, on = Field(_look), Field(_on)

    def _record(self) -> dict[str, Any] | None:
        at = anchor(self.on)
        if at is None:
            return None
        described = self.look.describe()
        own = color(described.get("color"))
        shape = {"kind": described["kind"], "sizes": described["sizes"]}
        shape |= {"vertices": described.get("vertices", ()), "triangles": described.get("triangles", ())}
        part = {"look": "*", "shape": shape, "turn": 0.0, "material": described["material"]}
        part |= {"color": own if self.color == NO_COLOR else self.color, "rotation": self.rotation}
        x, y, z = at["point"] if at["body"] != NO_BODY else (0, 0, 0)
        part["offset"] = (x + self.position.x, y + self.position.y, z + self.position.z)
        return {"body": at["body"], "part": part}
