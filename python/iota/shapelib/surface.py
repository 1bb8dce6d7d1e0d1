# SPDX-License-Identifier: Apache-2.0
"""A surface of polygons, and its checks."""

from __future__ import annotations

from dataclasses import dataclass, field
from itertools import chain, pairwise
from typing import TYPE_CHECKING

import numpy as np

from iota.shapelib.files import FileError, PathLike
from iota.shapelib.graphs import pieces

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Array = NDArray[np.float64]
    Numbers = NDArray[np.int64]

MOST_FACES = 1_000_000
TOUCHING = 1e-9  # share of its extent, by which a corner may miss the line that it is on


@dataclass
class Surface:
    """vertices: (n, 3). faces: the numbers of their vertices, from outside counter-clockwise. groups: a name for each face,
    "" for none. lines: the line of each face in the file, empty if unknown."""

    vertices: Array
    faces: list[list[int]]
    groups: list[str] = field(default_factory=list)
    lines: list[int] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)

    def place(self, face: int) -> str:
        """ "face 5 (of 6, line 15)" for messages; counted from 1."""
        line = f", line {self.lines[face]}" if self.lines else ""
        return f"face {face + 1} (of {len(self.faces)}{line})"

    def weld(self) -> None:
        """Merges coincident vertices, and removes faces without an area."""
        places, number = np.unique(self.vertices + 0.0, axis=0, return_inverse=True)
        first = np.full(len(places), len(self.vertices))
        number = number.ravel()
        np.minimum.at(first, number, np.arange(len(number)))
        order = np.argsort(first)  # the file's order
        rank = np.empty_like(order)
        rank[order] = np.arange(len(order))
        self.vertices = self.vertices[first[order]]
        new = rank[number].tolist()
        kept, left_out = [], 0
        for at, face in enumerate(self.faces):
            welded = [new[v] for v in face]
            welded = [v for i, v in enumerate(welded) if v != welded[i - 1]]
            if len(welded) < 3:
                left_out += 1
                continue
            kept.append(at)
            self.faces[at] = welded
        if left_out:
            self.notes.append(f"{left_out} faces without area are left out")
        self.faces = [self.faces[at] for at in kept]
        self.groups = [self.groups[at] for at in kept] if self.groups else []
        self.lines = [self.lines[at] for at in kept] if self.lines else []

    def edges(self) -> Numbers:
        """(k, 2), each once, smaller number first, sorted."""
        return self._pairs(np.unique(self._keys(self._sides())))

    def _sides(self) -> Numbers:
        """Every side of every face, in the direction of the face: (k, 2)."""
        sizes = np.fromiter(map(len, self.faces), np.int64, len(self.faces))
        corners = np.fromiter(chain.from_iterable(self.faces), np.int64)
        ends = np.cumsum(sizes)
        following = np.arange(1, len(corners) + 1)
        following[ends - 1] = ends - sizes
        return np.stack([corners, corners[following]], axis=1)

    def _keys(self, sides: Numbers) -> Numbers:
        """A number for each unordered pair of vertices, many times faster to sort than the pairs."""
        low, high = sides.min(axis=1), sides.max(axis=1)
        return np.asarray(low * len(self.vertices) + high, np.int64)

    def _pairs(self, keys: Numbers) -> Numbers:
        return np.stack(np.divmod(keys, len(self.vertices)), axis=1)

    def check(self, path: PathLike) -> None:
        """Raises FileError if the surface does not enclose a volume; names the first edge that is open, is in three
        faces or more, or has the same direction in both faces."""
        sides = self._sides()
        owner = np.repeat(np.arange(len(self.faces)), [len(face) for face in self.faces])
        keys, number, uses = np.unique(self._keys(sides), return_inverse=True, return_counts=True)
        pairs = self._pairs(keys)
        way = np.bincount(number, np.where(sides[:, 0] < sides[:, 1], 1.0, -1.0), len(pairs))
        for wrong, what in (
            (uses > 2, "is in {n} faces, so the surface is not that of a solid"),
            (uses < 2, "is in one face only, so the surface is open"),
            (way != 0, "has the same direction in both faces: one of them is inside out"),
        ):
            found = np.flatnonzero(wrong)
            if len(found):
                edge = int(found[0])
                p, q = pairs[edge].tolist()
                face = int(owner[number == edge][-1])
                more = f"; {len(found)} such edges" if len(found) > 1 else ""
                text = what.format(n=int(uses[edge]))
                line = self.lines[face] if self.lines else None
                raise FileError(
                    path, f"the edge of the vertices {p} and {q}, of {self.place(face)}, {text}{more}", line
                )

    def triangles(self) -> tuple[Numbers, Numbers]:
        """Three vertices each, (k, 3), and the face of each, (k,)."""
        if all(len(face) == 3 for face in self.faces):
            return np.array(self.faces, np.int64).reshape(-1, 3), np.arange(len(self.faces))
        found, owner = [], []
        for at, face in enumerate(self.faces):
            parts = [face] if len(face) == 3 else _cut(self.vertices[face], face)
            found += parts
            owner += [at] * len(parts)
        return np.array(found, np.int64).reshape(-1, 3), np.array(owner, np.int64)

    def volume(self) -> float:
        """The enclosed volume; negative if inside out."""
        triangles, _ = self.triangles()
        a, b, c = (self.vertices[triangles[:, i]] - self.vertices.mean(axis=0) for i in range(3))
        return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6)

    def area(self) -> float:
        """The area of all faces."""
        triangles, _ = self.triangles()
        a, b, c = (self.vertices[triangles[:, i]] for i in range(3))
        return float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2)

    def split(self) -> list[Surface]:
        """Its connected pieces, each with its own vertices."""
        part = pieces(len(self.vertices), self.edges())
        of_face = part[[face[0] for face in self.faces]]
        found = []
        for piece in np.unique(of_face):
            chosen = np.flatnonzero(of_face == piece).tolist()
            used = np.unique(np.concatenate([self.faces[at] for at in chosen]))
            new = dict(zip(used.tolist(), range(len(used)), strict=True))
            found.append(
                Surface(
                    self.vertices[used],
                    [[new[v] for v in self.faces[at]] for at in chosen],
                    [self.groups[at] for at in chosen] if self.groups else [],
                )
            )
        return found


def _cut(places: Array, face: list[int]) -> list[list[int]]:
    """A polygon as triangles, by cutting off ears (Meisters 1975); a convex one becomes a fan."""
    normal = np.cross(places, np.roll(places, -1, axis=0)).sum(axis=0)
    sides = np.roll(places, -1, axis=0) - places
    following = np.roll(sides, -1, axis=0)
    turns = np.cross(sides, following) @ normal
    angles = np.arctan2(turns / (np.linalg.norm(normal) or 1.0), (sides * following).sum(axis=1))
    if (turns > 0).all() and angles.sum() < 3 * np.pi:  # 4 pi for one that goes round twice
        return [[face[0], b, c] for b, c in pairwise(face[1:])]
    flat = normal / (np.linalg.norm(normal) or 1.0)
    left, found = np.arange(len(face)), []
    while len(left) > 3:
        at = _ear(places[left], flat)
        # Without an ear it is flat or crosses itself.
        ear = left[:3] if at is None else left[[at, (at + 1) % len(left), (at + 2) % len(left)]]
        found.append([face[i] for i in ear])
        left = left[left != ear[1]]
    return [*found, [face[i] for i in left]]


def _ear(places: Array, normal: Array) -> int | None:
    """The first of three corners in a row that turn inward, and around which no other corner is. Corners on its sides count as
    within, so that a straight corner stays one of the polygon's, except those at the same place, as at the bridge to a hole.
    Starting at the second corner makes the fan of a convex polygon start at its first. normal: unit."""
    following, after = np.roll(places, -1, axis=0), np.roll(places, -2, axis=0)
    turns = np.cross(following - places, after - following) @ normal
    slack = TOUCHING * float(np.ptp(places, axis=0).max()) ** 2
    for tolerance in (slack, -slack):  # rather an ear with a corner on its side than none
        for at in map(int, np.flatnonzero(turns > slack)):
            corners = np.stack([places[at], following[at], after[at]])
            others = np.delete(places, [at, (at + 1) % len(places), (at + 2) % len(places)], axis=0)
            apart = (others[:, None] != corners).any(axis=2).all(axis=1)
            ends = np.roll(corners, -1, axis=0)
            sides = np.cross(normal, ends - corners)
            inward = ((others[:, None] - ends) * sides).sum(axis=2).min(axis=1)
            if not (apart & (inward > -tolerance)).any():
                return at
    return None
